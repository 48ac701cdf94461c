"""Round struts: exact cylinders and cones, blends at nodes, and the proof that they are sound."""

from scaffold_cad.struts.builder import round_struts
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import Ends, Nodes, StrutOptions

__all__ = ["Ends", "Nodes", "RoundStruts", "StrutOptions", "round_struts"]
