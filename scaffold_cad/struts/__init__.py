"""Round struts: exact cylinders and cones, blends at nodes, and the proof that they are sound."""

from scaffold_cad.struts.blending.blend import Blends, Solved, Stars
from scaffold_cad.struts.blending.nodes import blends
from scaffold_cad.struts.builder import round_struts
from scaffold_cad.struts.meshes.sampling import Samples, sampled
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import Bend, Ends, Joints, Nodes, StrutOptions

__all__ = [
    "Bend",
    "Blends",
    "Ends",
    "Joints",
    "Nodes",
    "RoundStruts",
    "Samples",
    "Solved",
    "Stars",
    "StrutOptions",
    "blends",
    "round_struts",
    "sampled",
]
