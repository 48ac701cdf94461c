"""Parts of other people filled with struts."""

from scaffold_cad.filling.fill import fill
from scaffold_cad.filling.parts import lattice_part

__all__ = ["fill", "lattice_part"]
