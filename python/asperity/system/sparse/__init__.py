"""Linear systems of finite elements: sparse matrices, contacts of the nodes of a mesh."""
