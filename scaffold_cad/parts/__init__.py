"""Parts for build123d: skeletons and lattices as objects of its builder and its algebra mode.

::

    from build123d import *
    from scaffold_cad.parts import StrutFrame

    with BuildPart() as bracket:
        Box(40, 40, 4)
        with Locations((0, 0, 10)):
            StrutFrame(skeleton, radius=1.5)

The classes are subclasses of build123d's `BasePartObject`, so that they need build123d to be
defined: they are imported when one of them is asked for, which takes seconds.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from scaffold_cad.base.backends import need
from scaffold_cad.filling.parts import lattice_part
from scaffold_cad.filling.solids import lattice_solid
from scaffold_cad.products.meshshapes import to_mesh_shape

if TYPE_CHECKING:
    from scaffold_cad.parts.lattices import LatticeBox, LatticeFill
    from scaffold_cad.parts.solids import RoundStrutsSolid, ScaffoldSolid, StrutFrame

LATTICES = ("LatticeBox", "LatticeFill")

__all__ = [
    "LatticeBox",
    "LatticeFill",
    "RoundStrutsSolid",
    "ScaffoldSolid",
    "StrutFrame",
    "lattice_part",
    "lattice_solid",
    "to_mesh_shape",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    need("build123d", f"the part object {name}")
    room = "lattices" if name in LATTICES else "solids"
    return getattr(import_module(f"scaffold_cad.parts.{room}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
