"""slices(): what the package makes, cut into layers without a mesh of it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import repeat
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.base.arrays import Floats, as_floats
from scaffold_cad.base.backends import need
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.layers.lattice import RepeatedLattice, lattice_solid
from scaffold_cad.layers.layer import Layer, Layers
from scaffold_cad.layers.loops import MeshSections
from scaffold_cad.layers.struts import struts_solid
from scaffold_cad.layers.uniting import Solid, layer_of
from scaffold_cad.mesh.bodies import body_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import triangles_of
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.solid.skins import inside_of
from scaffold_cad.struts import RoundStruts, round_struts

ENOUGH = 1e-6
"""Part of a layer that is left out at the top."""

MOST_LAYERS = 10**7
"""Most layers of one call."""


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
    that overlap are united; at nodes that are crowded, see `RoundStruts`, fillets are those of the
    field that a mesh has there.

    Parameters
    ----------
    what : RoundStruts; a Skeleton, whose struts are made round; a PeriodicLattice, of which only
        some cells are made; a Scaffold, whose struts are square; or a closed surface, see `write`
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
    solid = _solid(what, sides)
    body = None if region is None else _closed(region)
    if skin is not None and body is None:
        raise OptionError("skin is given without a region; need one")
    whole = None if body is None else Solid(MeshSections(body))
    wall = None if body is None or skin is None else _wall(body, as_number(skin, "skin"))
    if heights is None:
        step = as_number(thickness, "thickness")
        planes = _middles(solid, whole, wall is not None, step)
    else:
        step, planes = 0.0, _heights(heights)
    if whole is None:
        return Layers(solid.layers(planes, step), planes, step, solid.box)
    made = _in_region(planes, step, solid, whole, wall)
    return Layers(made, planes, step, _box(solid, whole, wall is not None))


def _solid(what: Any, sides: int | None) -> Solid | RepeatedLattice:
    """Return what is to be cut."""
    if isinstance(what, Skeleton):
        what = round_struts(what)
    if isinstance(what, PeriodicLattice):
        return lattice_solid(what, _sides(sides))
    if not isinstance(what, RoundStruts):
        if sides is not None:
            raise OptionError(f"sides is for round struts; got a {type(what).__name__}")
        return Solid(MeshSections(_closed(what)))
    return struts_solid(what, _sides(sides))


def _sides(sides: int | None) -> int:
    number = SIDES if sides is None else sides
    check_sides(number)
    return number


def _closed(what: Any) -> TriangleMesh:
    """Return the closed surface of a body, its vertices shared."""
    return body_of(triangles_of(what))


def _wall(body: TriangleMesh, skin: float) -> Solid:
    """Return what is inside the skin of a body."""
    inside = inside_of(body, manifolds.to_manifold(body), skin)
    return Solid(MeshSections(manifolds.manifold_triangles(inside)))


def _heights(heights: ArrayLike) -> Floats:
    planes = as_floats(heights, "heights", OptionError)
    if planes.ndim != 1 or not np.isfinite(planes).all():
        raise OptionError(f"heights have shape {planes.shape}; need (n,) finite numbers, mm")
    falling = np.flatnonzero(np.diff(planes) <= 0)
    if len(falling):
        low, high = planes[falling[0] : falling[0] + 2]
        raise OptionError(f"heights go from {low:g} to {high:g} mm; need each above the one before")
    return planes


def _middles(
    solid: Solid | RepeatedLattice, whole: Solid | None, walled: bool, step: float
) -> Floats:
    """Return the middles of layers from the lowest point to the highest."""
    low, high = solid.bounds
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


def _box(solid: Solid | RepeatedLattice, whole: Solid, walled: bool) -> Floats:
    """Return the lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
    box, around = solid.box, whole.box
    if walled:
        return around
    return np.stack([np.maximum(box[0], around[0]), np.minimum(box[1], around[1])])


def _in_region(
    planes: Floats,
    step: float,
    solid: Solid | RepeatedLattice,
    whole: Solid,
    wall: Solid | None,
) -> Iterator[Layer]:
    """Yield layers of what is in a body, and of the body but for what is inside its wall."""
    insides = repeat(None, len(planes)) if wall is None else wall.sections(planes)
    sections = zip(
        planes.tolist(), solid.sections(planes), whole.sections(planes), insides, strict=True
    )
    for height, section, body, inside in sections:
        cut = section ^ body
        if inside is not None:
            cut = cut + (body - inside)
        yield layer_of(cut, height, step)
