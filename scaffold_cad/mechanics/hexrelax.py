"""Points near bad hexahedra moved until their scaled Jacobians are large enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import minimize

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.vectors import dot, length, sums_by_row
from scaffold_cad.mechanics.hexquality import NEIGHBORS, scaled_jacobians

ROUNDS = 10
"""Times that the hexahedra around the bad ones are looked for and relaxed."""

STEPS = 600
"""Most steps of the minimizer a round."""

MARGIN = 1.2
"""What is aimed at, in scaled Jacobians asked for."""

HOLD = 1e-4
"""Cost of a move by a radius, in those of a corner whose scaled Jacobian lacks 1."""


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


def relaxed(control: Control, places: Points, goal: float) -> Points:
    """Return the control points, moved so that no scaled Jacobian is below `goal`, if they can.

    The sum over corners of the squares of what their scaled Jacobians lack is minimized, with a
    small cost for moves. Only points of bad hexahedra move.

    Parameters
    ----------
    control : the mesh
    places : (c, 3) float64, mm, control points
    goal : least scaled Jacobian; 0 moves nothing
    """
    if goal <= 0:
        return places
    start = places
    for _ in range(ROUNDS):
        bad = scaled_jacobians(control.weights @ places, control.hexahedra) < goal
        if not bad.any():
            break
        following = _relaxed_once(control, places, start, bad, goal)
        if np.array_equal(following, places):
            break
        places = following
    return places


def _relaxed_once(
    control: Control, places: Points, start: Points, bad: Bools, goal: float
) -> Points:
    point_of = _touched(control.weights, control.hexahedra[bad])
    moving = np.flatnonzero(point_of & control.movable)
    if len(moving) == 0:
        return places
    columns = control.weights[:, moving]
    moved_points = np.diff(columns.indptr) > 0
    cells = control.hexahedra[moved_points[control.hexahedra].any(axis=1)]
    used, local = np.unique(cells, return_inverse=True)
    local = local.reshape(-1, 8)
    matrix = sparse.csr_array(columns[used])
    base = (control.weights @ places)[used] - matrix @ places[moving]
    scale = control.scale[moving, None]
    back = sparse.csr_array(matrix.T)

    def cost(flat: Floats) -> tuple[float, Floats]:
        here = flat.reshape(-1, 3) * scale
        value, pull = _lacking(base + matrix @ here, local, MARGIN * goal)
        shift = (here - start[moving]) / scale
        value += HOLD * float((shift**2).sum())
        slope = (back @ pull) * scale + 2.0 * HOLD * shift
        return value, slope.reshape(-1)

    found = minimize(
        cost,
        (places[moving] / scale).reshape(-1),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": STEPS, "maxfun": 2 * STEPS},
    )
    moved = places.copy()
    moved[moving] = found.x.reshape(-1, 3) * scale
    return moved


def _touched(weights: sparse.csr_array, cells: Ints) -> Bools:
    """Return which control points the points of `cells` depend on, (c,)."""
    rows = weights[np.unique(cells)]
    touched = np.zeros(weights.shape[1], dtype=np.bool_)
    touched[rows.indices] = True
    return touched


def _lacking(points: Points, cells: Ints, goal: float) -> tuple[float, Points]:
    """Return the sum of the squares of what corners lack to `goal`, and its slope by `points`."""
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
        lack = goal - jacobian
        rows = np.flatnonzero(lack > 0)
        value += float((lack[rows] ** 2).sum())
        slope = (normals[rows] - jacobian[rows, None, None] * units[rows]) / sizes[rows]
        slope *= -2.0 * lack[rows, None, None]
        targets = cells[rows][:, others].reshape(-1)
        pull += sums_by_row(slope.reshape(-1, 3), targets, len(pull))
        pull -= sums_by_row(slope.sum(axis=1), origin[rows], len(pull))
    return value, pull
