"""Mechanics: beams, homogenised cells, radii sized by stress, hexahedra."""

from scaffold_cad.mechanics.beams import BeamModel, BeamSolution, beam_model
from scaffold_cad.mechanics.loading import Load, Support
from scaffold_cad.mechanics.materials import MATERIALS, Material

__all__ = [
    "MATERIALS",
    "BeamModel",
    "BeamSolution",
    "Load",
    "Material",
    "Support",
    "beam_model",
]
