"""One picture: the homography of the scene, the outline of the mark, its circle."""
