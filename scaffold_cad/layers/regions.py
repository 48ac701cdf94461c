"""Bodies that layers are cut to, with a wall inside their surface."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import repeat
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Floats
from scaffold_cad.layers.layer import Layer
from scaffold_cad.layers.loops import MeshSections
from scaffold_cad.layers.uniting import Solid, layer_of
from scaffold_cad.mesh.bodies import body_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import triangles_of
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.skins import inside_of

if TYPE_CHECKING:
    from manifold3d import CrossSection


class Cut(Protocol):
    """What can be cut at heights, such as a `Solid`."""

    box: Floats
    """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest point, mm."""

    def sections(self, planes: Floats) -> Iterator[CrossSection]:
        """Yield what is solid at each of ascending heights; all are asked for only once."""


def closed(what: Any) -> TriangleMesh:
    """Return the closed surface of a body, its vertices shared."""
    return body_of(triangles_of(what))


class Region:
    """A body outside which nothing is solid, and the wall of it that is solid throughout."""

    def __init__(self, body: TriangleMesh, skin: float | None) -> None:
        """Take a closed body, and the thickness of its wall, mm; None for no wall."""
        self._whole = Solid(MeshSections(body))
        self._inside: Solid | None = None
        if skin is not None:
            depth = as_number(skin, "skin")
            inside = inside_of(body, manifolds.to_manifold(body), depth)
            self._inside = Solid(MeshSections(manifolds.manifold_triangles(inside)))

    def bounds(self, struts: Cut) -> tuple[float, float]:
        """Return the lowest and the highest point of what is left of struts and of the wall."""
        bottom, top = self._whole.bounds
        if self._inside is not None:
            return bottom, top
        low, high = struts.bounds
        return max(low, bottom), min(high, top)

    def box(self, struts: Cut) -> Floats:
        """Return the corners of a box that holds all polygons, shape (2, 2), mm."""
        around = self._whole.box
        if self._inside is not None:
            return around
        box = struts.box
        return np.stack([np.maximum(box[0], around[0]), np.minimum(box[1], around[1])])

    def layers(self, struts: Cut, planes: Floats, step: float) -> Iterator[Layer]:
        """Yield layers of the struts in the body, and of its wall, at ascending heights."""
        hollow = self._inside
        insides = repeat(None, len(planes)) if hollow is None else hollow.sections(planes)
        bodies = self._whole.sections(planes)
        sections = zip(planes.tolist(), struts.sections(planes), bodies, insides, strict=True)
        for height, section, body, inside in sections:
            cut = section ^ body
            if inside is not None:
                cut = cut + (body - inside)
            yield layer_of(cut, height, step)
