"""Mechanics: beams, homogenized cells, radii sized by stress, hexahedra."""

from scaffold_cad.mechanics.beamfiles import write_beams
from scaffold_cad.mechanics.beams import BeamModel, BeamSolution, beam_model
from scaffold_cad.mechanics.cells import CellRow, Homogenized, cell_table, homogenized
from scaffold_cad.mechanics.hexahedra.builder import Hexahedra, hexahedra
from scaffold_cad.mechanics.loadfiles import Loading, read_loading
from scaffold_cad.mechanics.loading import Between, Load, Support
from scaffold_cad.mechanics.materials import MATERIALS, Material
from scaffold_cad.mechanics.meshfiles import write_hexahedra
from scaffold_cad.mechanics.page import write_strength_page
from scaffold_cad.mechanics.polar import polar_picture, young_polar
from scaffold_cad.mechanics.sizing import Sized, sized
from scaffold_cad.mechanics.solidcells import homogenized_solid

__all__ = [
    "MATERIALS",
    "BeamModel",
    "BeamSolution",
    "Between",
    "CellRow",
    "Hexahedra",
    "Homogenized",
    "Load",
    "Loading",
    "Material",
    "Sized",
    "Support",
    "beam_model",
    "cell_table",
    "hexahedra",
    "homogenized",
    "homogenized_solid",
    "polar_picture",
    "read_loading",
    "sized",
    "write_beams",
    "write_hexahedra",
    "write_strength_page",
    "young_polar",
]
