"""Blends: the smooth surfaces of nodes, how they are fitted and proved."""
