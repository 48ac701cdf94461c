"""Solid lattice frames and organic solids from skeletons, for build123d."""

__version__ = "0.1.0"
