"""Hexahedra of scaffolds and of round struts, for finite elements."""
