"""slices(): what the package makes, cut into layers without a mesh of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords, described
from scaffold_cad.base.arrays import Floats, as_floats
from scaffold_cad.base.backends import need
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.layers.lattice import RepeatedLattice, lattice_solid
from scaffold_cad.layers.layer import Layers
from scaffold_cad.layers.loops import MeshSections
from scaffold_cad.layers.regions import Region, closed
from scaffold_cad.layers.struts import struts_solid
from scaffold_cad.layers.uniting import Solid
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import SIDES, check_sides
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
    if skin is not None and region is None:
        raise OptionError("skin is given without a region; need one")
    within = None if region is None else Region(closed(region), skin)
    if heights is None:
        step = as_number(thickness, "thickness")
        planes = _middles(solid.bounds if within is None else within.bounds(solid), step)
    else:
        step, planes = 0.0, _heights(heights)
    if within is None:
        return Layers(solid.layers(planes, step), planes, step, solid.box)
    return Layers(within.layers(solid, planes, step), planes, step, within.box(solid))


def _solid(what: Any, sides: int | None) -> Solid | RepeatedLattice:
    """Return what is to be cut."""
    if isinstance(what, Skeleton):
        what = round_struts(what)
    if isinstance(what, PeriodicLattice):
        return lattice_solid(what, _sides(sides))
    if not isinstance(what, RoundStruts):
        if sides is not None:
            raise OptionError(f"sides is for round struts; got {described(what)}")
        return Solid(MeshSections(closed(what)))
    return struts_solid(what, _sides(sides))


def _sides(sides: int | None) -> int:
    number = SIDES if sides is None else sides
    check_sides(number)
    return number


def _heights(heights: ArrayLike) -> Floats:
    planes = as_floats(heights, "heights", OptionError)
    if planes.ndim != 1:
        raise OptionError(f"heights have shape {planes.shape}; need (n,), mm")
    bad = np.flatnonzero(~np.isfinite(planes))
    if len(bad):
        raise OptionError(f"height {bad[0]} is {planes[bad[0]]:g} mm; need finite numbers")
    falling = np.flatnonzero(np.diff(planes) <= 0)
    if len(falling):
        low, high = planes[falling[0] : falling[0] + 2]
        raise OptionError(f"heights go from {low:g} to {high:g} mm; need each above the one before")
    return planes


def _middles(bounds: tuple[float, float], step: float) -> Floats:
    """Return the middles of layers from the lowest point to the highest."""
    low, high = bounds
    count = np.ceil((high - low) / step - ENOUGH)
    if not count <= MOST_LAYERS:
        raise OptionError(
            f"thickness is {step:g} mm for {high - low:g} mm: {count:g} layers; need at most "
            f"{MOST_LAYERS}"
        )
    if 0 < high - low < step / 2:
        raise OptionError(
            f"thickness is {step:g} mm for {high - low:g} mm; need less than {2 * (high - low):g} "
            "mm, so that the middle of a layer is in it"
        )
    return np.asarray(low + step * (np.arange(int(max(count, 0))) + 0.5), dtype=np.float64)
