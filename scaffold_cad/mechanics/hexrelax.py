"""Points near bad hexahedra moved until their scaled Jacobians are large enough."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy import sparse
from scipy.optimize import minimize
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length, sums_by_row
from scaffold_cad.mechanics.hexquality import NEIGHBORS, scaled_jacobians

TOGETHER, APART = 12, 30
"""Times that the hexahedra around the bad ones are looked for and relaxed: first all at once, then
what is left, node by node."""

STEPS = 150
"""Most steps of the minimizer a round."""

POWER = 4
"""Of what corners lack: high, so that the worst count most."""

MARGIN = 1.2
"""What is aimed at, in scaled Jacobians asked for."""

HOLD = 3e-4
"""Cost of a move by a radius, in those of a corner whose scaled Jacobian is 0."""


SLIDE = 0.02
"""The same of a move along a surface in a round, to begin with."""

STIFFER, SOFTER = 2.0, 1.3
"""By how much that grows where a round has made things worse, and shrinks where not."""

Onto: TypeAlias = Callable[[Ints, Points], tuple[Points, UnitVectors]]
"""What puts control points (q,), moved to places (q, 3), back on their surface, with its normals
there, (q, 3)."""


@dataclass(frozen=True, eq=False)
class Control:
    """Points of a mesh as fixed combinations of fewer control points, some of which may move."""

    weights: sparse.csr_array
    """Shape (p, c): each point is a combination of control points."""
    hexahedra: Ints
    """Points of each hexahedron, shape (k, 8)."""
    movable: Bools
    """Which control points may move, shape (c,)."""
    scale: Floats
    """What counts as a large move of each, shape (c,), mm."""
    sliding: Bools
    """Which of those that may move stay on a surface, shape (c,)."""
    onto: Onto
    """Puts them back there."""


def relaxed(control: Control, places: Points, goal: float) -> Points:
    """Return the control points, moved so that no scaled Jacobian is below `goal`, if they can.

    The sum over corners of powers of what their scaled Jacobians lack is minimized, with a small
    cost for moves. Only points of bad hexahedra move; those that stay on a surface move along it
    and are put back on it after each round.

    Parameters
    ----------
    control : the mesh
    places : (c, 3) float64, mm, control points
    goal : least scaled Jacobian; 0 moves nothing
    """
    if goal <= 0:
        return places
    start, slide = places, np.full(len(places), SLIDE)
    for turn in range(TOGETHER + APART):
        bad = scaled_jacobians(control.weights @ places, control.hexahedra) < goal
        part = _Part.of(control, bad)
        if part is None:
            break
        if turn == TOGETHER:
            slide[:] = SLIDE
        before = places
        for one in [part] if turn < TOGETHER else part.apart(control, bad):
            moved = _moved(one, control, places, start, slide, goal)
            worse = one.worse(control, places, moved, goal)
            slide[one.moving] *= np.where(worse, STIFFER, 1.0 / SOFTER)
            places = places.copy()
            places[one.moving] = moved
        if np.array_equal(before, places):
            break
    return places


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
    def of(control: Control, bad: Bools) -> _Part | None:
        """Return what is around the bad hexahedra (k,), if anything can move there."""
        point_of = _touched(control.weights, control.hexahedra[bad])
        moving = np.flatnonzero(point_of & control.movable)
        if len(moving) == 0:
            return None
        columns = control.weights[:, moving]
        moved_points = np.diff(columns.indptr) > 0
        rows = np.flatnonzero(moved_points[control.hexahedra].any(axis=1))
        used, local = np.unique(control.hexahedra[rows], return_inverse=True)
        return _Part(moving, rows, local.reshape(-1, 8), used, sparse.csr_array(columns[used]))

    def worse(self, control: Control, places: Points, moved: Points, goal: float) -> Bools:
        """Return which moving points are among hexahedra that lack more in all than before."""
        label, of_cell = self._labels
        after = places.copy()
        after[self.moving] = moved
        more = np.zeros(int(label.max()) + 1)
        for sign, some in ((1.0, after), (-1.0, places)):
            points = (control.weights @ some)[self.used]
            quality = scaled_jacobians(points, self.cells)
            lack = np.maximum(1.0 - quality / (MARGIN * goal), 0.0) ** POWER
            more += sign * np.bincount(of_cell, lack, len(more))
        grown: Bools = (more > 0)[label]
        return grown

    def apart(self, control: Control, bad: Bools) -> list[_Part]:
        """Return the parts that share no point that moves, for bad hexahedra (k,)."""
        of_cell = self._labels[1]
        parts = []
        for one in np.unique(of_cell[bad[self.rows]]).tolist():
            some = np.zeros_like(bad)
            some[self.rows[of_cell == one]] = True
            parts.append(_Part.of(control, some & bad))
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
    part: _Part, control: Control, places: Points, start: Points, slide: Floats, goal: float
) -> Points:
    """Return the moving control points of a part where it lacks least, (m, 3), mm."""
    moving, matrix = part.moving, part.matrix
    base = (control.weights @ places)[part.used] - matrix @ places[moving]
    scale = control.scale[moving, None]
    slides = control.sliding[moving]
    normals = np.zeros((len(moving), 3))
    normals[slides] = control.onto(moving[slides], places[moving[slides]])[1]
    hold = np.where(slides, slide[moving], HOLD)[:, None]
    rest = np.where(slides[:, None], places[moving], start[moving])
    back = sparse.csr_array(matrix.T)

    def cost(flat: Floats) -> tuple[float, Floats]:
        here = flat.reshape(-1, 3) * scale
        value, pull = _lacking(base + matrix @ here, part.cells, MARGIN * goal)
        shift = (here - rest) / scale
        value += float((hold * shift**2).sum())
        slope = (back @ pull) * scale + 2.0 * hold * shift
        slope -= dot(slope, normals)[:, None] * normals
        return value, slope.reshape(-1)

    found = minimize(
        cost,
        (places[moving] / scale).reshape(-1),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": STEPS, "maxfun": 2 * STEPS},
    )
    moved: Points = found.x.reshape(-1, 3) * scale
    moved[slides] = control.onto(moving[slides], moved[slides])[0]
    return moved


def _touched(weights: sparse.csr_array, cells: Ints) -> Bools:
    """Return which control points the points of `cells` depend on, (c,)."""
    rows = weights[np.unique(cells)]
    touched = np.zeros(weights.shape[1], dtype=np.bool_)
    touched[rows.indices] = True
    return touched


def _lacking(points: Points, cells: Ints, goal: float) -> tuple[float, Points]:
    """Return the sum of powers of what corners lack to `goal`, and its slope by `points`."""
    value = 0.0
    pull = np.zeros_like(points)
    for corner, others in enumerate(NEIGHBORS.tolist()):
        origin = cells[:, corner]
        sides = points[cells[:, others]] - points[origin, None]  # (k, 3, 3)
        sizes = np.maximum(length(sides), 1e-300)[..., None]
        units = sides / sizes
        a, b, c = np.moveaxis(units, 1, 0)
        normals = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
        jacobian = dot(a, normals[:, 0])
        lack = 1.0 - jacobian / goal
        rows = np.flatnonzero(lack > 0)
        value += float((lack[rows] ** POWER).sum())
        slope = (normals[rows] - jacobian[rows, None, None] * units[rows]) / sizes[rows]
        slope *= -POWER / goal * lack[rows, None, None] ** (POWER - 1)
        targets = cells[rows][:, others].reshape(-1)
        pull += sums_by_row(slope.reshape(-1, 3), targets, len(pull))
        pull -= sums_by_row(slope.sum(axis=1), origin[rows], len(pull))
    return value, pull
