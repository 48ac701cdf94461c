"""Round struts: exact sections, and blends at the nodes that are solved for node by node."""

from scaffold_cad.struts.blend import Blends, Solved, Stars
from scaffold_cad.struts.nodes import blends
from scaffold_cad.struts.sampling import Samples, sampled

__all__ = ["Blends", "Samples", "Solved", "Stars", "blends", "sampled"]
