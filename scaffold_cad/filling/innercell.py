"""One cell inside of an endless lattice: how dense it is, as measured and as estimated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Points
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.segments import meet_box
from scaffold_cad.lattice import UnitCell
from scaffold_cad.lattice.density import density_of_unit_radius
from scaffold_cad.lattice.repetition import further_layers, placed
from scaffold_cad.lattice.tiling import tile
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.manifolds import filled_share
from scaffold_cad.struts import round_struts

PLACES = 14
"""Logarithm to base 2 of the number of places in a cell at which distances from axes are taken."""

FIRST = 1000
"""Of the places nearest to axes, the one up to which the estimate is a parabola."""

FULL = 0.97
"""Share of a body beyond which it counts as full."""

SAMPLES = 48
"""Samples along each strut that stand for its axis where distances are taken."""


@dataclass(frozen=True, eq=False)
class Capsules(Frozen):
    """Estimated densities: the union of a lattice's struts as plain capsules, without fillets."""

    distances: Floats
    """From places spread evenly over a cell to the nearest axis, ascending, shape (p,), mm."""

    @property
    def radii(self) -> tuple[float, float]:
        """Least and greatest radius that there are estimates for, mm."""
        return 1e-3 * float(self.distances[-1]), float(self.distances[-1])

    def density(self, radius: float) -> float:
        """Return the share of the places within a radius of an axis, > 0."""
        return float(np.interp(radius, *self._curve))

    def radius(self, density: float) -> float:
        """Return the radius, mm, with an estimated density; the curve's ends beyond it."""
        radii, shares = self._curve
        return float(np.interp(density, shares, radii))

    @cached_property
    def _curve(self) -> tuple[Floats, Floats]:
        """Radii and their densities, ascending: a parabola before the nearest places."""
        shares = (np.arange(len(self.distances)) + 0.5) / len(self.distances)
        nearest = self.distances[FIRST]
        low = np.geomspace(self.radii[0], nearest, FIRST, endpoint=False)
        early = shares[FIRST] * (low / nearest) ** 2
        return np.append(low, self.distances[FIRST:]), np.append(early, shares[FIRST:])


def capsules(cell: UnitCell, size: Floats) -> Capsules:
    """Return the estimated densities of an endless lattice of cells of a size (3,), mm."""
    from scipy.stats.qmc import Sobol  # half a second, of which most calls have no use

    around = further_layers(cell.motif)
    block = tile(cell, size, 2 * around + 1, radius=1.0)
    along = np.linspace(0.0, 1.0, SAMPLES)[:, None, None]
    start, end = block.nodes[block.edges].transpose(1, 0, 2)
    axes = ((1.0 - along) * start + along * end).reshape(-1, 3)
    # Without symmetry: on a grid many places have the same distance, and densities would jump.
    places = around + Sobol(3, scramble=False).random_base2(PLACES)
    distances, _ = cKDTree(axes).query(placed(cell, size, places))
    return Capsules(np.sort(distances))


def is_full(cell: UnitCell, size: Floats, radius: Radius) -> bool:
    """Return whether struts leave next to nothing of a cell of a size (3,) free, mm."""
    if callable(radius) or density_of_unit_radius(cell, size) * radius**2 < 1.0:
        return False
    return capsules(cell, size).density(radius) > FULL


def solid_density(cell: UnitCell, size: Floats, radius: float, reach: float = np.inf) -> float:
    """Return the relative density of an endless lattice of round struts, measured on its solid.

    It is that of the middle cell of a block, all of whose neighbors are there.

    Parameters
    ----------
    reach : how far from that cell struts are made, mm. Far ones have no part in it, but may make
        nodes in it parts of a field, and close voids that begin in it
    """
    around = further_layers(cell.motif)
    corners = placed(cell, size, np.array(list(product((around, around + 1), repeat=3)), float))
    block = tile(cell, size, 2 * around + 1, radius=radius)
    if np.isfinite(reach):
        block = block.with_edges(_near_cell(block, corners, reach))
    return filled_share(to_solid(round_struts(block)), corners)


def _near_cell(block: Skeleton, corners: Points, reach: float) -> Bools:
    """Return the struts that come within a distance, or little more, of a cell, shape (m,).

    Parameters
    ----------
    corners : (8, 3) float64 of the cell, the last three steps of its sides being z, y and x, mm
    """
    sides = corners[[4, 2, 1]] - corners[0]  # (3, 3)
    to_steps = np.linalg.inv(sides)
    steps = (block.nodes - corners[0]) @ to_steps
    margin = reach * np.linalg.norm(to_steps, axis=0)  # of a slanted cell between its faces
    start, end = steps[block.edges].transpose(1, 0, 2)
    return meet_box(start, end, -margin, 1.0 + margin)
