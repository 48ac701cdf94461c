"""Arrays, arguments, vectors, graphs, boxes, files: what knows nothing of skeletons or meshes."""
