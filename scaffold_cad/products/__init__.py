"""What a thing becomes: a B-rep, a mesh, a shape to show."""
