"""Quad and triangle meshes: surfaces, their shells, and whether they cross themselves."""
