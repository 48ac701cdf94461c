"""Skeletons: graphs in space with radii, their repair and thinning, and beam lattices."""

from scaffold_cad.skeleton.beams import BeamLattice
from scaffold_cad.skeleton.checking import check_skeleton
from scaffold_cad.skeleton.skeleton import Cleaning, Skeleton

__all__ = ["BeamLattice", "Cleaning", "Skeleton", "check_skeleton"]
