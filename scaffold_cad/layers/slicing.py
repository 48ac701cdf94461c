"""slices(): what the package makes, cut into layers without a mesh of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.base.arrays import Floats, as_floats
from scaffold_cad.base.backends import need
from scaffold_cad.errors import OptionError
from scaffold_cad.layers.layer import Layer, Layers
from scaffold_cad.layers.loops import Loops, MeshSections
from scaffold_cad.layers.struts import StrutSections
from scaffold_cad.layers.uniting import layer_of, united
from scaffold_cad.mesh.bodies import body_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import triangles_of
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.solid.skins import inside_of
from scaffold_cad.struts import RoundStruts, round_struts

if TYPE_CHECKING:
    from manifold3d import CrossSection

PARTS_AT_ONCE = 2**14
"""Sections of struts and nodes that are made together, about: some layers of a small part, or
one layer of a large one."""

ENOUGH = 1e-6
"""Part of a layer that is left out at the top."""

MOST_LAYERS = 10**7
"""Most layers of one call."""


class _Sections(Protocol):
    """Closed parts that can be cut from the lowest up."""

    @property
    def extents(self) -> tuple[Floats, Floats]:
        """Lowest and highest height of each part, both (k,), mm."""

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest point, mm."""

    @property
    def box(self) -> Floats:
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections of all parts at ascending heights (h,), above those before."""


@checks_keywords()
def slices(
    what: Any,
    heights: ArrayLike | None = None,
    *,
    thickness: float | None = None,
    sides: int | None = None,
    region: Any = None,
    skin: float | None = None,
) -> Layers:
    """Return the sections of `what` from the lowest up, each made when it is asked for.

    Round struts are cut as what they are, cylinders and cones, and only the blends at their nodes
    as triangles: no mesh of the whole is made, and memory does not grow with the layers. Struts
    that overlap are united; at nodes that are crowded, see `RoundStruts`, they are so without
    fillets.

    Parameters
    ----------
    what : RoundStruts; a Skeleton, whose struts are made round; a Scaffold, whose struts are
        square; or a closed surface, see `write`
    heights : of the planes, mm, ascending, shape (n,)
    thickness : of layers, mm, in place of heights: the lowest begins at the lowest point, and each
        is cut in its middle
    sides : of the polygons that stand for the circles of round struts, a multiple of 4; 16 by
        default. Polygons have the area of what they stand for
    region : a closed body; what is outside is left out
    skin : thickness of a wall inside the surface of the region, which is solid too, mm

    Raises
    ------
    OptionError
        If `what` or an option is not of its kind, not one of heights and thickness is given, or
        heights do not ascend.
    SkeletonError, MeshError
        If struts cannot be built on a skeleton, or a surface is not closed.
    MissingBackendError
        If manifold3d is not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, slices
    >>> strut = Skeleton([[0, 0, 0], [12, 0, 0]], [[0, 1]], 2.0)
    >>> layers = list(slices(strut, thickness=0.1))
    >>> round(sum(layer.area * layer.thickness for layer in layers), 1)  # π 2² · 12 = 150.8
    151.0
    """
    if (heights is None) == (thickness is None):
        raise OptionError("need either heights or the thickness of layers, mm")
    need("manifold3d", "layers")
    outer, inner = _parts(what, sides)
    body = None if region is None else _closed(region)
    if skin is not None and body is None:
        raise OptionError("skin is given without a region; need one")
    wall = None if body is None or skin is None else _wall(body, as_number(skin, "skin"))
    whole = None if body is None else MeshSections(body)
    if heights is None:
        step = as_number(thickness, "thickness")
        planes = _middles(outer, whole, wall is not None, step)
    else:
        step, planes = 0.0, _heights(heights)
    made = _layers(planes, step, outer, inner, whole, wall)
    return Layers(made, planes, step, _box(outer, whole, wall is not None))


def _parts(what: Any, sides: int | None) -> tuple[_Sections, _Sections | None]:
    """Return what is solid, and what is hollow in it."""
    if isinstance(what, Skeleton):
        what = round_struts(what)
    if not isinstance(what, RoundStruts):
        if sides is not None:
            raise OptionError(
                f"sides is for RoundStruts and a Skeleton; got a {type(what).__name__}"
            )
        return MeshSections(_closed(what)), None
    number = SIDES if sides is None else sides
    check_sides(number)
    hollow = what.inner
    if hollow is None:
        return StrutSections(what, number), None
    return StrutSections(what, number), StrutSections(hollow, number, is_inside=True)


def _closed(what: Any) -> TriangleMesh:
    """Return the closed surface of a body, its vertices shared."""
    return body_of(triangles_of(what))


def _wall(body: TriangleMesh, skin: float) -> MeshSections:
    """Return what is inside the skin of a body."""
    inside = inside_of(body, manifolds.to_manifold(body), skin)
    return MeshSections(manifolds.manifold_triangles(inside))


def _heights(heights: ArrayLike) -> Floats:
    planes = as_floats(heights, "heights", OptionError)
    if planes.ndim != 1 or not np.isfinite(planes).all():
        raise OptionError(f"heights have shape {planes.shape}; need (n,) finite numbers, mm")
    falling = np.flatnonzero(np.diff(planes) <= 0)
    if len(falling):
        low, high = planes[falling[0] : falling[0] + 2]
        raise OptionError(f"heights go from {low:g} to {high:g} mm; need each above the one before")
    return planes


def _middles(outer: _Sections, whole: _Sections | None, walled: bool, step: float) -> Floats:
    """Return the middles of layers from the lowest point to the highest."""
    low, high = outer.bounds
    if whole is not None:
        bottom, top = whole.bounds
        low, high = (bottom, top) if walled else (max(low, bottom), min(high, top))
    count = np.ceil((high - low) / step - ENOUGH)
    if not count <= MOST_LAYERS:
        raise OptionError(
            f"thickness is {step:g} mm for {high - low:g} mm: {count:g} layers; need at most "
            f"{MOST_LAYERS}"
        )
    return np.asarray(low + step * (np.arange(int(max(count, 0))) + 0.5), dtype=np.float64)


def _box(outer: _Sections, whole: _Sections | None, walled: bool) -> Floats:
    """Return the lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
    box = outer.box
    if whole is None:
        return box
    around = whole.box
    if walled:
        return around
    return np.stack([np.maximum(box[0], around[0]), np.minimum(box[1], around[1])])


def _layers(
    planes: Floats,
    step: float,
    outer: _Sections,
    inner: _Sections | None,
    whole: _Sections | None,
    wall: _Sections | None,
) -> Iterator[Layer]:
    for block in _blocks(planes, outer):
        solid = _sections(outer, block)
        hollow, around, inside = (
            None if one is None else _sections(one, block) for one in (inner, whole, wall)
        )
        for height in block.tolist():
            section = next(solid)
            if hollow is not None:
                section = section - next(hollow)
            if around is not None:
                body = next(around)
                section = section ^ body
                if inside is not None:
                    section = section + (body - next(inside))
            yield layer_of(section, height, step)


def _sections(sections: _Sections, heights: Floats) -> Iterator[CrossSection]:
    """Yield what is solid at each of some heights."""
    parts = [loops.by_level(len(heights)) for loops in sections.loops(heights)]
    for lists in zip(*parts, strict=True):
        yield united([loop for some in lists for loop in some])


def _blocks(planes: Floats, outer: _Sections) -> Iterator[Floats]:
    """Yield heights that follow each other, with about `PARTS_AT_ONCE` sections of parts."""
    low, high = (np.sort(ends) for ends in outer.extents)
    there = np.searchsorted(low, planes) - np.searchsorted(high, planes)  # (n,)
    block = np.cumsum(there + 1) // PARTS_AT_ONCE
    yield from np.split(planes, np.flatnonzero(np.diff(block)) + 1) if len(planes) else []
