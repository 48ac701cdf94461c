"""Random points in a region, one per cell of a foam: evenly spread or as dense as sizes ask."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import as_count, as_number, as_real
from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Points, as_floats, as_points
from scaffold_cad.base.placements import BoxLike
from scaffold_cad.base.regions import BoxRegion, Region, as_box
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.maps.grading import sizes_at

LARGEST_REGULARITY = 0.7
"""Beyond it, random points find no room any more."""

MOST_POINTS = 10_000_000
"""Most random points: a foam of that many has some 1e8 struts, see `MOST_STRUTS`."""

KELVIN_SPACING = np.sqrt(3) / 2 * np.cbrt(2)
"""Distance of neighbors in a body-centered cubic lattice of one point a unit of volume."""

SAMPLES = 20_000
"""Places at which the share of a box that a region takes is measured, and its cells' sizes."""

CellSizes = ArrayLike | Callable[[Points], ArrayLike]
"""Side of a cube as large as a cell, mm: one number, or a function of positions (n, 3)."""


@dataclass(frozen=True, eq=False)
class Seeds(Frozen):
    """Points of a foam's cells."""

    points: Points
    """Positions in the region's bounds, shape (k, 3), mm."""
    sizes: Floats | None
    """Wanted size of each cell, shape (k,), mm; None where all are alike."""
    spacing: float
    """Side of a cube as large as a mean cell, mm."""


def random_points(count: int, box: BoxLike, seed: int, regularity: float = 0.0) -> Points:
    """Return random points in a box, none closer to another than their regularity asks.

    Parameters
    ----------
    count : points, ≥ 1
    box : lowest and highest corner, mm
    seed : of numpy's default generator
    regularity : as for `voronoi_foam`

    Returns
    -------
    (count, 3) float64, mm
    """
    bounds = as_box(box)
    count = _as_count(count)
    random = np.random.default_rng(as_count(seed, "seed"))
    least = _regularity(regularity) * KELVIN_SPACING * mean_spacing(bounds, count)
    points = np.zeros((0, 3))
    while len(points) < count:
        more = random.uniform(bounds[0], bounds[1], (count, 3))
        if len(points):
            more = more[cKDTree(points).query(more)[0] >= least]
        clashes = cKDTree(more).query_pairs(least, output_type="ndarray")
        points = np.concatenate([points, np.delete(more, clashes[:, 1], axis=0)])[:count]
    return points


def seeds_in(
    count: int | ArrayLike | None,
    region: Region,
    seed: int,
    regularity: float,
    size: CellSizes | None,
    stretch: Floats,
) -> Seeds:
    """Return points for a foam in a region; those of its bounds outside it are among them.

    Parameters
    ----------
    count : points in the region, or positions of one's own (n, 3), or none where `size` is given
    regularity, size : as for `voronoi_foam`
    stretch : (3,) how much longer cells are along x, y and z; points are spread as if they were
        not, in the region shrunk by as much

    Raises
    ------
    OptionError
        If an argument is out of its range.
    """
    shrunk = region.bounds / stretch
    if count is not None and not isinstance(count, int | np.integer | float):
        own = as_points(count, "points of the foam", OptionError)
        if size is not None:
            raise OptionError("points are given with a size of cells; need either")
        return Seeds(own, None, mean_spacing(region.bounds, max(len(own), 1)))
    random = np.random.default_rng(as_count(seed, "seed"))
    share = 1.0 if isinstance(region, BoxRegion) else _share(region, random)
    if (count is None) == (size is None):
        raise OptionError("need either a count of cells or their size")
    if not callable(size):
        if count is None:
            cell = as_number(size, "size of a cell")
            count = max(
                1, round(share * float((region.bounds[1] - region.bounds[0]).prod()) / cell**3)
            )
        total = _as_count(round(_as_count(count) / share))
        points = random_points(total, shrunk, seed, regularity) * stretch
        return Seeds(points, None, mean_spacing(region.bounds, total))
    return _graded_seeds(region, random, _regularity(regularity), size, stretch)


def mean_spacing(box: Floats, count: int) -> float:
    """Return the side of a cube as large as the part of the box that a point has, mm."""
    return float(np.cbrt((box[1] - box[0]).prod() / count))


def _graded_seeds(
    region: Region,
    random: np.random.Generator,
    regularity: float,
    size: Callable[[Points], ArrayLike],
    stretch: Floats,
) -> Seeds:
    """Return points as dense as a function of position asks.

    They are taken from too many, evenly spread, with a probability of the density wanted there.
    """
    low, high = region.bounds
    volume = float((high - low).prod())
    places = random.uniform(low, high, (SAMPLES, 3))
    density = sizes_at(size, places) ** -3.0
    count = _as_count(max(1, round(volume * float(density.mean()))))
    most = float(density.max()) * 1.05
    points, sizes = np.zeros((0, 3)), np.zeros(0)
    while len(points) < count:
        tries = random.uniform(low, high, (2 * count, 3))
        wanted = sizes_at(size, tries)
        chosen = random.uniform(0.0, most, len(tries)) < wanted**-3.0
        points = np.concatenate([points, tries[chosen]])
        sizes = np.concatenate([sizes, wanted[chosen]])
        if regularity:
            keep = _apart(points / stretch, regularity * KELVIN_SPACING * sizes)
            points, sizes = points[keep], sizes[keep]
    return Seeds(points[:count], sizes[:count], float(np.cbrt(volume / count)))


def _apart(points: Points, least: Floats) -> Bools:
    """Return which points (n, 3) no earlier one is too close to, (n,)."""
    pairs: Edges = cKDTree(points).query_pairs(float(least.max()), output_type="ndarray")
    gaps = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    close = gaps < least[pairs].mean(axis=1)
    keep = np.ones(len(points), dtype=np.bool_)
    keep[pairs[close, 1]] = False
    return keep


def _share(region: Region, random: np.random.Generator) -> float:
    """Return how much of its bounds a region takes, about.

    Raises
    ------
    OptionError
        If no place of many is in it.
    """
    low, high = region.bounds
    inside = region.contains(random.uniform(low, high, (SAMPLES, 3)))
    if not inside.any():
        raise OptionError(
            f"the region takes less than 1/{SAMPLES} of its bounds from {low.tolist()} to "
            f"{high.tolist()} mm; need a tighter box around it"
        )
    return float(inside.mean())


def _as_count(count: int | float | np.integer[Any]) -> int:
    count = as_count(count, "count", least=1)
    if count > MOST_POINTS:
        raise OptionError(f"count is {count}; need at most {MOST_POINTS}")
    return count


def _regularity(value: float) -> float:
    if not 0 <= as_real(value, "regularity") <= LARGEST_REGULARITY:
        raise OptionError(f"regularity is {value:g}; need 0 to {LARGEST_REGULARITY:g}")
    return value


def as_stretch(stretch: ArrayLike) -> Floats:
    """Return how much longer cells are along x, y and z, shape (3,).

    Raises
    ------
    OptionError
        If it is not three numbers > 0.
    """
    factors = as_floats(stretch, "stretch", OptionError)
    if factors.shape != (3,) or not (np.isfinite(factors) & (factors > 0)).all():
        raise OptionError(f"stretch is {factors.tolist()}; need three numbers > 0")
    return factors
