"""What a field solid takes, told before it is made: cells, memory and time.

The surface of the struts, in cells of the sizes wanted there, less what is inside of others: this
part is measured at some points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.solid.field.lattice import Lattice
from scaffold_cad.solid.field.struts import FieldStruts
from scaffold_cad.solid.field.union import FilletedUnion

STATIONS = 8
"""Places along each strut whose cells are looked at."""

PAIRS = 10_000_000
"""Pairs of point and strut that are looked at."""

MOST_POINTS = 2000
"""Most points that are looked at; half of their number's root in percent is the error."""

FEW_CELLS = 1e6
"""Most cells for which no estimate is needed."""

LEAST_POINTS = 100
"""Least number of points, however many struts there are."""

CELLS_ASIDE = 3.0
"""Cells that are kept for each cell's area of a surface (measured: 2.4 to 3.2)."""

CELL_SECONDS = 6e-6
"""What a cell takes with its triangles, s, on one core (measured: 5e-6 to 7e-6)."""


@dataclass(frozen=True)
class Estimate:
    """What a field solid takes."""

    cells: float
    """Number of cells at the surface."""
    exposed: float
    """Part of the struts' surface that is not inside of others."""

    @property
    def seconds(self) -> float:
        """Time on one core of a usual machine, s."""
        return CELL_SECONDS * self.cells


def estimated(
    union: FilletedUnion, struts: FieldStruts, lattice: Lattice, wanted: Floats
) -> Estimate | None:
    """Return about what a field solid takes, None where that is little.

    Parameters
    ----------
    wanted : (m, 2) largest cells at both ends of each strut, mm
    """
    share = (np.arange(STATIONS) + 0.5) / STATIONS
    sizes = wanted[:, :1] * (1 - share) + wanted[:, 1:] * share  # (m, STATIONS)
    radii = struts.radii[:, :1] * (1 - share) + struts.radii[:, 1:] * share
    levels = np.maximum(np.floor(np.log2(sizes / lattice.cell) + 1e-9), 0.0)
    area = lattice.cell**2 * 4.0**levels
    # Half of a ball, or a disc, at each end, and the side between.
    side = 2.0 * np.pi * radii * struts.lengths[:, None] / STATIONS / area
    ends = np.where(struts.flat, np.pi, 2.0 * np.pi) * struts.radii**2 / area[:, [0, -1]]
    weights = np.concatenate([side, ends], axis=1)
    total = float(weights.sum())
    if CELLS_ASIDE * total < FEW_CELLS:
        return None
    exposed = _exposed(union, struts, weights / total, lattice)
    return Estimate(CELLS_ASIDE * total * exposed, exposed)


def _exposed(union: FilletedUnion, struts: FieldStruts, weights: Floats, lattice: Lattice) -> float:
    """Return what part of the surface is not inside of other struts, by points at random."""
    count = int(np.clip(PAIRS / len(struts.radii), LEAST_POINTS, MOST_POINTS))
    rng = np.random.default_rng(0)
    row = rng.choice(weights.size, size=count, p=weights.reshape(-1))
    strut, station = np.divmod(row, STATIONS + 2)
    points = _points(struts, strut, station, rng) - lattice.origin
    every = np.arange(len(struts.radii))
    hidden = np.zeros(count, dtype=np.bool_)
    for k in range(count):
        distance, _ = union.distances(np.broadcast_to(points[k], (len(every), 3)), every)
        distance[strut[k]] = np.inf
        hidden[k] = bool((distance < 0).any())
    return max(1.0 - float(hidden.mean()), 1.0 / count)


def _points(struts: FieldStruts, strut: Ints, station: Ints, rng: np.random.Generator) -> Points:
    """Return a point of the surface of each of some struts, (k, 3), mm."""
    share = np.where(station < STATIONS, (station + rng.random(len(strut))) / STATIONS, 0.0)
    share = np.where(station == STATIONS + 1, 1.0, share)[:, None]
    start, end = struts.ends[strut, 0], struts.ends[strut, 1]
    size = struts.lengths[strut]
    axis = np.where(
        (size > 0)[:, None], (end - start) / np.where(size > 0, size, 1.0)[:, None], [1.0, 0.0, 0.0]
    )
    x = any_perpendicular(axis)
    y = np.cross(axis, x)
    angle = 2 * np.pi * rng.random((len(strut), 1))
    lift = np.where(station < STATIONS, 0.0, rng.random(len(strut)))[:, None]  # on half a ball
    lift = np.where((station == STATIONS)[:, None], -lift, lift)
    flat = np.where(station < STATIONS + 1, struts.flat[strut, 0], struts.flat[strut, 1])[:, None]
    lift = np.where(flat, 0.0, lift)
    radius = struts.radii[strut, 0][:, None] * (1 - share) + struts.radii[strut, 1][:, None] * share
    around = np.sqrt(1.0 - lift**2) * (np.cos(angle) * x + np.sin(angle) * y) + lift * axis
    return np.asarray(start + share * (end - start) + radius * around)
