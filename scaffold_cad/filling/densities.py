"""Radii that give a lattice its relative density, by the formula or as measured on its solid."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator

from scaffold_cad.base.arguments import as_flag, as_number, as_real, checks_keywords
from scaffold_cad.base.arrays import Floats, Points, as_floats, place_text
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import UnitCell
from scaffold_cad.lattice.density import density_of_unit_radius, measured_density
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.struts import round_struts

Density: TypeAlias = float | Callable[[Points], ArrayLike]
"""One relative density, or a function of positions (n, 3) that returns them (n,)."""

MEASURED = 6
"""Radii at which the density is measured for a field of them."""

RANGE = (0.02, 0.95)
"""Least and greatest radius measured, in that at which the formula gives 1."""

DENSITY_ACCURACY = 1e-3
"""Relative difference from the wanted density at which a radius is good enough."""

LEAST_RADIUS = 1e-3
"""Least radius that is tried, as a fraction of the first-order one; the greatest is a cell."""

LARGEST_STEPS = 30
"""Densities measured before the search for a radius is given up."""

JUMP = 1.001
"""Ratio of two radii between which a density is taken to jump, as where voids close."""


@checks_keywords()
def solve_radius(
    cell: str | UnitCell,
    size: ArrayLike,
    relative_density: float,
    *,
    volume: Callable[[Skeleton], float] | None = None,
    measured: bool = False,
) -> float:
    """Return the strut radius that gives a lattice its relative density, mm.

    Parameters
    ----------
    cell : a unit cell or its name
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    relative_density : in (0, 1)
    volume : function that makes the solid of a skeleton and returns its volume, mm³; with it
        the density is that of the inside of a large lattice, within 0.1 %
    measured : whether the density is measured so on the solid that `to_solid` makes, round struts
        and their nodes included; otherwise, and without `volume`, it is that of the first-order
        formula, which counts overlaps at nodes several times

    Raises
    ------
    OptionError
        If the cell is not known, a size is not > 0, the density is not in (0, 1), or no radius
        was found that has it.

    Examples
    --------
    >>> round(solve_radius("bcc", 10.0, 0.1), 3)
    0.678
    """
    if as_flag(measured, "measured") and volume is not None:
        raise OptionError("volume is given with measured=True; need either")
    if not 0 < as_real(relative_density, "relative density") < 1:
        raise OptionError(
            f"relative density is {relative_density:g}; need more than 0, less than 1"
        )
    radius = float(np.sqrt(relative_density / density_of_unit_radius(cell, size)))
    volume = solid_volume if measured else volume
    return (
        radius if volume is None else _measured_radius(cell, size, relative_density, radius, volume)
    )


@checks_keywords()
def graded_radius(
    cell: str | UnitCell, size: ArrayLike, relative_density: Density, *, measured: bool = False
) -> Callable[[Points], Floats]:
    """Return the function of positions that gives a lattice a density that varies over space.

    It may stand wherever a radius may. Where densities change from cell to cell, the density of a
    cell is that of its nodes' mean radius, about.

    Parameters
    ----------
    cell : a unit cell or its name
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    relative_density : in (0, 1): one number, or a function of positions (n, 3) that returns (n,),
        such as a `Field`
    measured : whether densities are measured on solids at six radii, see `solve_radius`, and
        interpolated between

    Raises
    ------
    OptionError
        If an argument is out of its range; a density of the function, when it is called.

    Examples
    --------
    >>> from scaffold_cad import Field, tile
    >>> denser_upwards = Field([[[0.05, 0.2]]], [[0, 0, 0], [0, 0, 40]])
    >>> lattice = tile("bcc", 10.0, 4, radius=graded_radius("bcc", 10.0, denser_upwards))
    >>> bool(lattice.radii.max() == lattice.radii[lattice.nodes[:, 2] == 40].max())
    True
    """
    known = as_cell(cell)
    sizes = cell_size(known, size)
    full = 1 / np.sqrt(known.density_coefficient_of(sizes))
    if as_flag(measured, "measured"):
        tried = full * np.geomspace(*RANGE, MEASURED)
        densities = [
            measured_density(known, sizes, float(radius), solid_volume) for radius in tried
        ]
        between = PchipInterpolator(np.log(densities), np.log(tried), extrapolate=True)

    def radius_at(points: Points) -> Floats:
        wanted = _densities(relative_density, points)
        if not measured:
            radii: Floats = full * np.sqrt(wanted)
            return radii
        return np.asarray(np.exp(between(np.log(wanted))))

    return radius_at


def _measured_radius(
    cell: str | UnitCell,
    size: ArrayLike,
    relative_density: float,
    radius: float,
    volume: Callable[[Skeleton], float],
) -> float:
    """Return the radius whose solid has a relative density, looked for from a first one."""
    least, greatest = LEAST_RADIUS * radius, cell_size(as_cell(cell), size).max()
    # Secant steps on log density against log radius, which is almost a line of slope 2.
    slope, before = 2.0, (np.nan, np.nan)
    # The largest radius tried that is too thin, the least that is too thick, and their densities.
    thin, thick = (least, 0.0), (greatest, np.inf)
    for _ in range(LARGEST_STEPS):
        ratio = measured_density(cell, size, radius, volume) / relative_density
        if abs(ratio - 1) <= DENSITY_ACCURACY:
            return radius
        if ratio < 1:
            thin = max(thin, (radius, ratio))
        else:
            thick = min(thick, (radius, ratio))
        if thin[0] < thick[0] < JUMP * thin[0]:
            raise OptionError(
                f"no radius gives relative density {relative_density:g}: struts of {thin[0]:.5g} "
                f"mm give {thin[1] * relative_density:.3g}, of {thick[0]:.5g} mm "
                f"{thick[1] * relative_density:.3g}"
            )
        here = (np.log(radius), np.log(ratio))
        secant = (here[1] - before[1]) / (here[0] - before[0])
        # Where the solid fills up the slope tends to 0: keep the steps short.
        slope = float(np.clip(secant, 0.5, 4.0)) if np.isfinite(secant) else slope
        following = float(np.clip(np.exp(here[0] - here[1] / slope), least, greatest))
        if not thin[0] < following < thick[0]:  # between what was tried, if both sides were
            halfway = thin[1] > 0 and thick[1] < np.inf
            following = float(np.sqrt(thin[0] * thick[0])) if halfway else following
        if following == radius:
            break
        radius, before = following, here
    raise OptionError(
        f"no radius gives relative density {relative_density:g}: "
        f"the last one tried, {radius:g} mm, is off by {100 * abs(ratio - 1):.2g} %"
    )


def solid_volume(skeleton: Skeleton) -> float:
    """Return the volume of the round struts around a skeleton, nodes included, mm³."""
    return float(to_solid(round_struts(skeleton)).volume())


def _densities(relative_density: Density, points: Points) -> Floats:
    """Return the density at positions (n, 3), shape (n,).

    Raises
    ------
    OptionError
        If one is not in (0, 1); the place is named.
    """
    if not callable(relative_density):
        number = as_number(relative_density, "relative density", unit="")
        values: Floats = np.full(len(points), number)
    else:
        name = "what the function relative_density returned"
        values = as_floats(relative_density(points), name, OptionError)
    if values.shape != (len(points),):
        raise OptionError(
            f"relative_density returned shape {values.shape} for points ({len(points)}, 3); "
            f"need ({len(points)},)"
        )
    bad = np.flatnonzero(~((values > 0) & (values < 1)))
    if len(bad):
        raise OptionError(
            f"relative density is {values[bad[0]]:g} at {place_text(points[bad[0]])}; "
            "need more than 0, less than 1"
        )
    return values
