"""Radii sized by stress and buckling: fully stressed first, then at least mass."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import (
    as_count,
    as_flag,
    as_number,
    as_real,
    check_kind,
    checks_keywords,
)
from scaffold_cad.base.arrays import Floats, Frozen, Ints, as_indices
from scaffold_cad.base.summaries import counted, radii_text
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.beams import BeamModel, BeamSolution
from scaffold_cad.mechanics.leastmass import less_mass
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.proportions import thicker_than_long

BELOW = 2e-4
"""How far below 1 the utilization of struts is brought where one is above."""

RUNAWAY = 1e3
"""Radius in lengths of the longest strut beyond which sizing is given up."""

THINNEST = 1e-6
"""Least radius in lengths of the longest strut: stiffness goes with its fourth power."""

SETTLED = 1e-3
"""Relative change of the radii at which they count as settled."""

MOST_VARIABLES = 400
"""Most radii of their own for which the least mass is looked for: each costs a solution."""

FULL_STEPS = 15
"""Steps that change radii by all that the forces ask for."""

HALVINGS = 40
"""Halvings of the interval in which a radius is looked for."""

_log = logging.getLogger(__name__)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Sized(Frozen):
    """Radii by which no strut is overloaded, and how they came about."""

    solution: BeamSolution
    """Forces, stresses and utilizations with these radii."""
    radii: Floats
    """Radius of each strut, shape (m,), mm."""
    masses: Floats
    """Mass before each step, and at last, kg."""
    fully_stressed_steps: int
    """Steps of the first kind; those of the second follow."""
    overloaded: Ints
    """Struts that stay overloaded at the largest radius, shape (k,)."""

    def __str__(self) -> str:
        over = counted(len(self.overloaded), "strut")
        return (
            f"Sized: {counted(len(self.radii), 'strut')}, {radii_text(self.radii)}, "
            f"{self.mass:.4g} kg, {over} overloaded"
        )

    @property
    def mass(self) -> float:
        """Mass of all struts, kg."""
        return self.solution.mass

    @property
    def skeleton(self) -> Skeleton:
        """The skeleton with these radii."""
        return self.solution.model.skeleton.with_edge_radii(self.radii)


@checks_keywords()
def sized(
    model: BeamModel,
    *,
    least_radius: float,
    largest_radius: float = float("inf"),
    groups: ArrayLike | None = None,
    steps: int = 60,
    least_mass: bool = True,
) -> Sized:
    """Return radii of even struts by which none is overloaded, at a small mass.

    First each strut gets the radius that its forces ask for, again and again: fully stressed
    design. Then up to 400 radii are changed together by linear programs, so that the mass falls
    and no strut is overloaded (sequential linear programming): a local optimum, not a proven one.

    Parameters
    ----------
    model : beams with supports and loads; the material needs a strength
    least_radius, largest_radius : what can be printed, or fits, mm
    groups : (m,) whole numbers; struts of one number get one radius, as those of a symmetric part
        must; by default each has its own
    steps : most steps of each kind
    least_mass : whether the second kind of steps is taken

    Raises
    ------
    OptionError
        If an argument is of another kind or out of its range, radii grow without end, the material
        has no strength or no density, or the model cannot be solved.

    References
    ----------
    Haftka, Gurdal, Elements of Structural Optimization, 1992, chapters 6.1 and 9.2.

    Examples
    --------
    A rod of 200 MPa that pulls 5 kN needs 25 mm²:

    >>> from scaffold_cad import Skeleton
    >>> from scaffold_cad.mechanics import Load, Support, beam_model
    >>> rod = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 5.0)
    >>> model = beam_model(rod, "aluminum", Support([0]), Load([1], (5000, 0, 0)))
    >>> result = sized(model, least_radius=0.5)
    >>> print(f"{result.radii[0]:.2f} mm")
    2.82 mm
    """
    check_kind(model, BeamModel)
    low = as_number(least_radius, "least_radius")
    longest = float(model.skeleton.lengths.max())
    if not THINNEST * longest <= low <= RUNAWAY * longest:
        raise OptionError(
            f"least_radius is {low:g} mm; need {THINNEST * longest:.3g} to "
            f"{RUNAWAY * longest:.3g} mm for struts of up to {longest:.4g} mm"
        )
    high = as_real(largest_radius, "largest_radius")
    if not high > low:
        raise OptionError(f"largest_radius is {high:g} mm; need more than {low:g} mm, the least")
    strength, density = model.material.strength, model.material.density
    if not np.isfinite(strength):
        raise OptionError(f"strength is {strength:g} MPa; need a finite one to size struts")
    if density == 0:
        raise OptionError("density is 0 kg/m³; need > 0 to size struts")
    group = _groups(groups, len(model.skeleton.edges))
    most = as_count(steps, "steps", 1)

    radii = np.clip(_by_group(model.edge_radii.max(axis=1), group), low, high)
    solution = model.with_edge_radii(radii).solved()
    masses = [model.mass, solution.mass]
    for step in range(most):
        following = _by_group(needed_radii(solution, low, high), group)
        change = float(np.abs(following / radii - 1.0).max())
        # After a while halfway only: otherwise some struts swap their loads for ever.
        radii = following if step < FULL_STEPS else np.sqrt(radii * following)
        _check_growth(radii, model)
        solution = model.with_edge_radii(radii).solved()
        masses.append(solution.mass)
        if change < SETTLED:
            break
    stressed = step + 1
    solution = _safe(solution, group, low, high)
    if as_flag(least_mass, "least_mass") and group.max() < MOST_VARIABLES:
        solution = less_mass(solution, group, low, high, most, masses)
        solution = _safe(solution, group, low, high)
    masses.append(solution.mass)
    _log.info("radii sized: %.4g kg before, %.4g kg after", masses[0], masses[-1])
    result = Sized(
        solution=solution,
        radii=solution.model.edge_radii[:, 0].copy(),
        masses=np.array(masses),
        fully_stressed_steps=stressed,
        overloaded=np.flatnonzero(solution.utilization > 1.0),
    )
    thick = thicker_than_long(result.skeleton)
    if thick:
        _log.warning("radii sized: %s: check the loads?", thick)
    return result


def _check_growth(radii: Floats, model: BeamModel) -> None:
    """Raise where struts get thicker without end, as under their own weight."""
    edge = int(np.argmax(radii))
    most = RUNAWAY * float(model.skeleton.lengths.max())
    if radii[edge] > most:
        raise OptionError(
            f"edge {edge} would need a radius of {radii[edge]:.3g} mm, {RUNAWAY:g} times the "
            "longest strut and more; need a higher strength, or lower loads"
        )


def needed_radii(solution: BeamSolution, low: float, high: float, allowed: float = 1.0) -> Floats:
    """Return the radius that each strut needs for the forces that it has now, (m,), mm.

    Parameters
    ----------
    allowed : largest utilization
    """
    model, forces = solution.model, solution.end_forces
    count = len(model.skeleton.edges)
    top = min(high, 1e3 * float(model.edge_radii.max()))
    below, above = np.full(count, np.log(low)), np.full(count, np.log(max(top, low)))
    for _ in range(HALVINGS):
        middle = (below + above) / 2.0
        ample = model.with_edge_radii(np.exp(middle)).utilizations(forces) <= allowed
        below, above = np.where(ample, below, middle), np.where(ample, middle, above)
    enough = model.with_edge_radii(np.full(count, low)).utilizations(forces) <= allowed
    radii: Floats = np.where(enough, low, np.exp(above))
    return radii


def _safe(solution: BeamSolution, group: Ints, low: float, high: float) -> BeamSolution:
    """Return the solution with radii raised until no strut is overloaded, if they can be."""
    for _ in range(30):
        if solution.utilization.max() <= 1.0:
            break
        before = solution.model.edge_radii[:, 0]
        needed = needed_radii(solution, low, high, 1.0 - BELOW)
        is_over = solution.utilization > 1.0 - BELOW
        radii = _by_group(np.where(is_over, np.maximum(needed, before), before), group)
        if np.array_equal(radii, before):
            break
        solution = solution.model.with_edge_radii(radii).solved()
    return solution


def _by_group(radii: Floats, group: Ints) -> Floats:
    """Return the largest radius of each strut's group, (m,)."""
    largest = np.zeros(int(group.max()) + 1)
    np.maximum.at(largest, group, radii)
    shared: Floats = largest[group]
    return shared


def _groups(groups: ArrayLike | None, count: int) -> Ints:
    if groups is None:
        return np.arange(count)
    given = as_indices(groups, "groups", OptionError)
    if given.shape != (count,):
        raise OptionError(f"groups has shape {given.shape}; need ({count},), one per strut")
    return np.unique(given, return_inverse=True)[1].reshape(-1)
