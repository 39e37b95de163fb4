"""Pictures in the order of time: from folders of images and from videos."""
