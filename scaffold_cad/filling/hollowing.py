"""Bodies to be filled: their surface and solid, and what is inside their skin."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from scaffold_cad.base.arguments import as_number, as_real
from scaffold_cad.base.arrays import Frozen
from scaffold_cad.base.positions import single_steps
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.fill import HasTriangles
from scaffold_cad.mesh.bodies import body_of, check_uncrossed, shells_of
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.products.surfaces import triangles_of
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.skins import inside_of

if TYPE_CHECKING:
    from build123d import Shape
    from manifold3d import Manifold

Body: TypeAlias = "Shape | QuadMesh | TriangleMesh | HasTriangles"
"""A build123d solid, or a closed triangle mesh of any library."""

TOUCHING = 1e-9
"""Depth down to which parts of a body only touch, mm."""

LEAST_STEPS = 64.0
"""Least thickness of a skin, and diameter of a hole, in steps of 32-bit coordinates."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class HollowPart(Frozen):
    """A body, and what is inside its skin."""

    surface: TriangleMesh
    """Its surface."""
    outer: Manifold
    """The same as a solid."""
    inner: Manifold
    """What is inside the skin; the whole body if it has no skin."""
    skin: float | None
    """Thickness of the skin, mm; None for none."""
    drain: float | None
    """Diameter of the holes that go through the skin, mm; None for none."""


def hollowed(body: Body, skin: float | None = None, *, drain: float | None = None) -> HollowPart:
    """Return a body and what is inside its skin, before anything is put there.

    Parameters
    ----------
    skin, drain : as for `lattice_part`

    Raises
    ------
    OptionError
        If `skin` or `drain` is out of its range, cannot be seen in files, or the skin fills the
        body.
    MeshError
        If the body is not closed or crosses itself, or has too many triangles for the skin where it
        is tightly curved.
    """
    if skin is not None and not 0 < as_real(skin, "skin") < np.inf:
        raise OptionError(f"skin is {skin:g} mm; need > 0, or None")
    if skin is None and drain is not None:
        raise OptionError("drain holes are given without a skin; need one")
    surface, outer = _sound(triangles_of(body))
    check_seen(surface, skin=skin, drain=None if drain is None else as_number(drain, "drain"))
    inner = outer if skin is None else inside_of(surface, outer, skin)
    return HollowPart(surface, outer, inner, skin, drain)


def check_seen(surface: TriangleMesh, **lengths: float | None) -> None:
    """Raise if a length cannot be seen in the 32-bit coordinates of files, where the body is."""
    least = LEAST_STEPS * float(single_steps(surface.vertices).max())
    for name, value in lengths.items():
        if value is not None and value < least:
            raise OptionError(
                f"{name} is {value:g} mm; need {least:.2g} mm or more this far from the origin, as "
                "coordinates in files are rounded"
            )


def _sound(mesh: TriangleMesh) -> tuple[TriangleMesh, Manifold]:
    """Return a body's surface and solid; parts of it that overlap are united.

    Raises
    ------
    MeshError
        If the surface is not closed, or a part crosses itself; the place is named in mm.
    """
    surface = body_of(mesh)
    shell = shells_of(surface.triangles, len(surface.vertices))
    bodies = [
        compacted(surface.vertices, surface.triangles[shell == number])
        for number in range(int(shell.max()) + 1)
    ]
    cavities = any(one.signed_volume < 0 for one in bodies)
    crosses = len(self_intersections(surface, tolerance=TOUCHING, limit=1)) > 0
    if not crosses and (len(bodies) == 1 or cavities):
        return surface, manifolds.to_manifold(surface)
    for one in bodies if crosses else []:
        check_uncrossed(one)
    if cavities:
        check_uncrossed(surface)  # a cavity that crosses another shell
    united = manifolds.union([manifolds.to_manifold(one) for one in bodies], [])
    # No faces cross of bodies that are flush, touch with their faces, or are inside of others.
    left = sum(one.volume() > 0 for one in united.decompose())
    if not crosses and left == len(bodies):
        return surface, manifolds.to_manifold(surface)
    _log.info("%d parts of the body overlap or touch; they are united", len(bodies))
    return manifolds.manifold_triangles(united), united
