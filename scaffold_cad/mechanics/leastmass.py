"""Radii changed together so that the mass falls: a linear program per step, solved by HiGHS."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.mechanics.beams import BeamModel, BeamSolution
from scaffold_cad.mechanics.elements import first_by_second, second_end
from scaffold_cad.mechanics.solvers import factor, with_identity

FIRST_MOVE = 0.2
"""Most relative change of a radius in the first step."""

LEAST_MOVE = 1e-3
"""Change below which the steps end."""

STEP = 1e-6
"""Relative difference by which slopes are taken."""

FEASIBLE = 5e-3
"""How far above 1 the largest utilization of an accepted step may be."""

GAIN = 1e-6
"""Relative loss of mass below which a step does not count."""


def less_mass(
    solution: BeamSolution, group: Ints, low: float, high: float, steps: int, masses: list[float]
) -> BeamSolution:
    """Return a solution of less mass in which no strut is overloaded, if one is found.

    Parameters
    ----------
    solution : where the search starts
    group : (m,) intp, struts of one number have one radius
    low, high : least and largest radius, mm
    steps : most steps
    masses : the mass of each step is added to it
    """
    move = FIRST_MOVE
    for _ in range(steps):
        change = _linear_step(solution, group, low, high, move)
        if change is None:
            move /= 2.0
        else:
            radii = solution.model.edge_radii[:, 0] * np.exp(change[group])
            following = solution.model.with_edge_radii(np.clip(radii, low, high)).solved()
            if _better(following, solution):
                solution = following
                masses.append(solution.mass)
                continue
            move /= 2.0
        if move < LEAST_MOVE:
            break
    return solution


def _better(new: BeamSolution, old: BeamSolution) -> bool:
    allowed = max(1.0 + FEASIBLE, float(old.utilization.max()))
    return bool(new.mass < old.mass * (1.0 - GAIN) and new.utilization.max() <= allowed)


def _linear_step(
    solution: BeamSolution, group: Ints, low: float, high: float, move: float
) -> Floats | None:
    """Return the change of the logarithm of each group's radius, (g,), or None for no way."""
    count = int(group.max()) + 1
    slopes = utilization_slopes(solution, group)  # (m, g)
    weight = np.bincount(group, 2.0 * solution.model.masses, minlength=count).astype(np.float64)
    radius = np.zeros(count)
    radius[group] = solution.model.edge_radii[:, 0]
    lowest = np.maximum(np.log(low / radius), -move).tolist()
    highest = np.minimum(np.log(high / radius), move).tolist()
    found = linprog(
        weight,
        A_ub=slopes,
        b_ub=np.maximum(1.0 - solution.utilization, 0.0),
        bounds=list(zip(lowest, highest, strict=True)),
    )
    if found.x is None:
        return None
    change: Floats = found.x
    return change


def utilization_slopes(solution: BeamSolution, group: Ints) -> Floats:
    """Return how each strut's utilization grows with the logarithm of each group's radius, (m, g).

    A strut's own change moves its end forces while the nodes stay; the nodes then follow by one
    solution of the factored equations a group.
    """
    model = solution.model
    count, edges = int(group.max()) + 1, model.skeleton.edges
    freedoms = np.concatenate([solution.displacements, solution.rotations], axis=1)
    thicker, thinner = (_scaled(model, sign * STEP) for sign in (1.0, -1.0))
    own = (thicker.end_forces(freedoms) - thinner.end_forces(freedoms)) / (2.0 * STEP)  # (m, 2, 6)
    rows = (6 * edges[:, :, None] + np.arange(6)).reshape(len(edges), 12)
    size = 6 * len(model.skeleton.nodes)
    push = sums_by_row(-own.reshape(-1, 12), rows * count + group[:, None], size * count)
    push = push.reshape(size, count)
    push[model.fixed.reshape(-1)] = 0.0
    moves = factor(with_identity(model.stiffness_matrix(), model.fixed)).solve(push)  # (6 n, g)

    by_force = _slopes_by_force(model, solution.end_forces)  # (m, 12)
    first, second = moves[rows[:, :6]], moves[rows[:, 6:]]  # (m, 6, g)
    drift = second - first
    spans = model.spans[:, :, None]
    drift[:, :3] -= np.cross(first[:, 3:], spans, axis=1)
    far = second_end(model.skeleton.directions[::2], model.stiffnesses)
    at_second = np.einsum("mi,mij->mj", by_force[:, 6:], far)
    at_first = np.einsum("mi,mij,mjk->mk", by_force[:, :6], first_by_second(model.spans), far)
    slopes: Floats = np.einsum("mj,mjg->mg", at_second + at_first, drift)
    direct = np.einsum("mi,mi->m", by_force, own.reshape(-1, 12))
    direct += (
        thicker.utilizations(solution.end_forces) - thinner.utilizations(solution.end_forces)
    ) / (2.0 * STEP)
    slopes[np.arange(len(edges)), group] += direct
    return slopes


def _scaled(model: BeamModel, change: float) -> BeamModel:
    return model.with_edge_radii(model.edge_radii * np.exp(change))


def _slopes_by_force(model: BeamModel, forces: Floats) -> Floats:
    """Return how each strut's utilization grows with its end forces, (m, 12)."""
    size = np.abs(forces).reshape(len(forces), 2, 2, 3).max(axis=3)  # forces, moments
    step = STEP * np.repeat(np.maximum(size, 1e-9 * size.max()), 3, axis=2).reshape(forces.shape)
    step = np.maximum(step, 1e-300)
    slopes = np.empty((len(forces), 12))
    for k in range(12):
        end, part = divmod(k, 6)
        shift = np.zeros_like(forces)
        shift[:, end, part] = step[:, end, part]
        rise = model.utilizations(forces + shift) - model.utilizations(forces - shift)
        slopes[:, k] = rise / (2.0 * step[:, end, part])
    return slopes
