"""Solids with voids: a solid moved inwards, cut by others, and taken out of a solid.

build123d is imported when the functions are called.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from scaffold_cad.base.backends import need

if TYPE_CHECKING:
    from build123d import Shape, Solid


def moved_inwards(solid: Solid, distance: float) -> list[Solid]:
    """Return what OCCT makes of a solid whose faces are moved inwards, best first; or nothing.

    It may be wrong where the solid is more tightly curved than `distance`, mm.
    """
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtvoids

    return occtvoids.moved_inwards(solid, distance)


def without(solid: Solid, tools: Iterable[Shape]) -> list[Solid]:
    """Return the solids that are left of a solid without `tools`; none where OCCT gives up."""
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtvoids

    return occtvoids.without(solid, tools)


def with_voids(solid: Solid, voids: Iterable[Solid]) -> tuple[Solid, int]:
    """Return a solid with voids inside it, and how many loose pieces in them were left out.

    No boolean: the outer surfaces of the voids, turned inside out, become surfaces of the solid.
    """
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtvoids

    return occtvoids.with_voids(solid, voids)
