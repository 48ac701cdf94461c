"""Points near bad hexahedra moved until their scaled Jacobians are large enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import minimize
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.vectors import dot, sums_by_row
from scaffold_cad.mechanics.hexahedra.control import Control
from scaffold_cad.mechanics.hexahedra.narrowing import narrowed
from scaffold_cad.mechanics.hexahedra.quality import (
    NEIGHBORS,
    SIDE_OF,
    SIDES,
    SIGNS,
    Corners,
    cross,
    scaled_jacobians,
)

TOGETHER, APART = 12, 30
"""Times that the hexahedra around the bad ones are looked for and relaxed: first all at once, then
what is left, node by node."""

STEPS = 60
"""Most steps of the minimizer a round."""

POWER = 4
"""Of what corners lack: high, so that the worst count most."""

MARGIN = 1.2
"""What is aimed at, in scaled Jacobians asked for."""

HOLD = 3e-4
"""Cost of a move by a radius, in those of a corner whose scaled Jacobian is 0."""

SLIDE = 0.02
"""The same of a move along a surface in a round, to begin with."""

RAISE, MOST_AIM = 1.1, 2.0
"""By how much the aim of what is still bad is raised in a round, and to how much at most: so that
the worst count more than their neighbors."""

PROGRESS, PATIENCE = 0.01, 4
"""Part by which what hexahedra lack should fall in a round, and rounds without that after which
points are given up."""

LEAST_SIDE = 1e-6
"""Least length by which moves are measured, in the largest."""

STIFFER, SOFTER = 2.0, 1.3
"""By how much that grows where a round has made things worse, and shrinks where not."""


def relaxed(control: Control, places: Points, goal: float) -> Points:
    """Return the control points, moved so that no scaled Jacobian is below `goal`, if they can.

    The sum over corners of powers of what their scaled Jacobians lack is minimized, with a small
    cost for moves. Only points of bad hexahedra move; those that stay on a surface move along it
    and are put back on it after each round. Where hexahedra stay inverted, nodes are narrowed.

    Parameters
    ----------
    control : the mesh
    places : (c, 3) float64, mm, control points
    goal : least scaled Jacobian; 0 moves nothing
    """
    if goal <= 0:
        return places
    start, slide, idle = places, np.full(len(places), SLIDE), np.zeros(len(places), dtype=np.intp)
    aims = np.full(len(control.hexahedra), MARGIN * goal)
    for turn in range(TOGETHER + APART):
        bad = scaled_jacobians(control.weights @ places, control.hexahedra) < goal
        if not bad.any():
            return places
        if turn > 0:
            aims[bad] = np.minimum(RAISE * aims[bad], MOST_AIM * goal)
        part = _Part.of(control, bad, idle < PATIENCE)
        if part is None:
            break
        if turn == TOGETHER:
            slide[:], idle[:] = SLIDE, 0
        before = places
        for one in [part] if turn < TOGETHER else part.apart(control, bad, idle < PATIENCE):
            had = one.lacks(control, places, aims)
            places = places.copy()
            places[one.moving] = _moved(one, control, places, start, slide, aims)
            lacks = one.lacks(control, places, aims)
            slide[one.moving] *= np.where(lacks > had, STIFFER, 1.0 / SOFTER)
            idle[one.moving] = np.where(lacks > (1.0 - PROGRESS) * had, idle[one.moving] + 1, 0)
        if np.array_equal(before, places):
            break
    return narrowed(control, places, goal)


@dataclass(frozen=True, eq=False)
class _Part:
    """What is relaxed in a round."""

    moving: Ints
    """Control points that move, shape (m,)."""
    rows: Ints
    """Hexahedra with points that move, shape (k,)."""
    cells: Ints
    """Points of these hexahedra, in 0..u-1, shape (k, 8)."""
    used: Ints
    """Points of these, shape (u,)."""
    matrix: sparse.csr_array
    """What takes the moving control points to these points, shape (u, m)."""

    @staticmethod
    def of(control: Control, bad: Bools, trying: Bools) -> _Part | None:
        """Return what is around the bad hexahedra (k,), if anything can move there.

        Parameters
        ----------
        trying : (c,) control points that have not been given up
        """
        point_of = control.touched(control.hexahedra[bad])
        moving = np.flatnonzero(point_of & control.movable & trying)
        if len(moving) == 0:
            return None
        columns = control.weights[:, moving]
        moved_points = np.diff(columns.indptr) > 0
        rows = np.flatnonzero(moved_points[control.hexahedra].any(axis=1))
        used, local = np.unique(control.hexahedra[rows], return_inverse=True)
        return _Part(moving, rows, local.reshape(-1, 8), used, sparse.csr_array(columns[used]))

    def shortest_sides(self, points: Points) -> Floats:
        """Return the shortest side at the points (u,) that each moving one moves, (m,), mm."""
        shortest = np.full(len(points), np.inf)
        sizes = Corners.of(points, self.cells).sizes.T  # (k, 12)
        np.minimum.at(shortest, self.cells[:, SIDES], sizes[..., None])
        columns = sparse.csc_array(self.matrix)
        least = np.minimum.reduceat(shortest[columns.indices], columns.indptr[:-1])
        return np.asarray(np.maximum(least, LEAST_SIDE * least.max()))

    def lacks(self, control: Control, places: Points, aims: Floats) -> Floats:
        """Return what the hexahedra lack of `aims` in all around each moving point, (m,)."""
        label, of_cell = self._labels
        points = (control.weights @ places)[self.used]
        lack = np.maximum(aims[self.rows] - scaled_jacobians(points, self.cells), 0.0)
        sums = np.bincount(of_cell, lack**POWER, int(label.max()) + 1).astype(np.float64)
        return np.asarray(sums[label])

    def apart(self, control: Control, bad: Bools, trying: Bools) -> list[_Part]:
        """Return the parts that share no point that moves.

        Parameters
        ----------
        bad, trying : as for `of`
        """
        of_cell = self._labels[1]
        parts = []
        for one in np.unique(of_cell[bad[self.rows]]).tolist():
            some = np.zeros_like(bad)
            some[self.rows[of_cell == one]] = True
            parts.append(_Part.of(control, some & bad, trying))
        return [part for part in parts if part is not None]

    @property
    def _labels(self) -> tuple[Ints, Ints]:
        """Which of the parts that share no point each moving one and hexahedron is in."""
        count, wide = len(self.cells), len(self.used)
        row = np.repeat(np.arange(count), 8)
        on = sparse.csr_array((np.ones(len(row)), (row, self.cells.reshape(-1))), (count, wide))
        touched = sparse.csr_array(on @ abs(self.matrix))  # (k, m)
        label = connected_components(touched.T @ touched, directed=False)[1].astype(np.intp)
        # All moving points of a hexahedron are in one part.
        return label, label[touched.indices[touched.indptr[:-1]]]


def _moved(
    part: _Part, control: Control, places: Points, start: Points, slide: Floats, aims: Floats
) -> Points:
    """Return the moving control points of a part where it lacks least, (m, 3), mm."""
    moving, matrix = part.moving, part.matrix
    base = (control.weights @ places)[part.used] - matrix @ places[moving]
    scale = control.scale[moving, None]
    unit = part.shortest_sides(base + matrix @ places[moving])[:, None]
    slides = control.sliding[moving]
    normals = np.zeros((len(moving), 3))
    normals[slides] = control.onto(moving[slides], places[moving[slides]])[1]
    hold = np.where(slides, slide[moving], HOLD)[:, None]
    rest = np.where(slides[:, None], places[moving], start[moving])
    back = sparse.csr_array(matrix.T)

    def cost(flat: Floats) -> tuple[float, Floats]:
        here = flat.reshape(-1, 3) * unit
        value, pull = _lacking(base + matrix @ here, part.cells, aims[part.rows])
        shift = (here - rest) / scale
        value += float((hold * shift**2).sum())
        slope = back @ pull + 2.0 * hold * shift / scale
        slope -= dot(slope, normals)[:, None] * normals
        return value, (slope * unit).reshape(-1)

    found = minimize(
        cost,
        (places[moving] / unit).reshape(-1),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": STEPS, "maxfun": 2 * STEPS},
    )
    moved: Points = found.x.reshape(-1, 3) * unit
    moved[slides] = control.onto(moving[slides], moved[slides])[0]
    return moved


def _lacking(points: Points, cells: Ints, aims: Floats) -> tuple[float, Points]:
    """Return the sum of powers of what corners lack to `aims` (k,), and its slope by `points`.

    What a corner with a scaled Jacobian of 0 lacks to the least aim is 1.
    """
    corners = Corners.of(points, cells)
    unit = aims.min()
    lack = (aims - corners.jacobians) / unit
    corner, row = np.nonzero(lack > 0)
    side, some = SIDE_OF[corner].T, lack[corner, row]
    units = SIGNS[corner].T * corners.units[:, side, row]  # (3, 3, q): axis, side
    sizes = corners.sizes[side, row]
    a, b, c = np.moveaxis(units, 1, 0)  # (3, q) each
    normals = np.stack([cross(b, c), cross(c, a), cross(a, b)], axis=1)
    slopes = (normals - corners.jacobians[corner, row] * units) / sizes
    slopes *= -POWER / unit * some ** (POWER - 1)  # (3, 3, q), those of the three sides
    own, others = cells[row, corner], cells[row[:, None], NEIGHBORS[corner]].T  # (q,), (3, q)
    target = np.append(others, own)
    moves = np.concatenate([slopes.reshape(3, -1), -slopes.sum(axis=1)], axis=1)
    return float((some**POWER).sum()), sums_by_row(moves.T, target, len(points))
