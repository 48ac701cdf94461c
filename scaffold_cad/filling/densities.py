"""Radii that give a lattice its relative density, by the formula or as measured on its solid."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
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
from scaffold_cad.lattice.repetition import further_layers, placed
from scaffold_cad.lattice.tiling import cell_size, tile
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.manifolds import filled_share
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

STEEPEST = 4.0
"""Most that a density grows by, as a power of the radius, but where it jumps, as voids close."""


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
    measured : whether the density is that of the solid that `to_solid` makes, round struts and
        their nodes included, measured in the middle of a block; otherwise, and without `volume`,
        it is that of the first-order formula, which counts overlaps at nodes several times

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
    known = as_cell(cell)
    sizes = cell_size(known, size)
    radius = float(np.sqrt(relative_density / density_of_unit_radius(known, sizes)))
    if volume is None and not measured:
        return radius

    def density(tried: float) -> float:
        if volume is None:
            return solid_density(known, sizes, tried)
        return measured_density(known, sizes, tried, volume)

    return _measured_radius(density, relative_density, radius, float(sizes.max()))


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
        densities = [solid_density(known, sizes, float(radius)) for radius in tried]
        between = PchipInterpolator(np.log(densities), np.log(tried), extrapolate=True)

    def radius_at(points: Points) -> Floats:
        wanted = _densities(relative_density, points)
        if not measured:
            radii: Floats = full * np.sqrt(wanted)
            return radii
        return np.asarray(np.exp(between(np.log(wanted))))

    return radius_at


def _measured_radius(
    density: Callable[[float], float], wanted: float, radius: float, greatest: float
) -> float:
    """Return the radius with the density wanted, looked for from a first one to the greatest."""
    least = LEAST_RADIUS * radius
    # Secant steps on log density against log radius, which is almost a line of slope 2.
    slope, before = 2.0, (np.nan, np.nan)
    # The largest radius tried that is too thin, the least that is too thick, and their densities.
    thin, thick = (least, 0.0), (greatest, np.inf)
    for _ in range(LARGEST_STEPS):
        ratio = density(radius) / wanted
        if abs(ratio - 1) <= DENSITY_ACCURACY:
            return radius
        if ratio < 1:
            thin = max(thin, (radius, ratio))
        else:
            thick = min(thick, (radius, ratio))
        if _is_jumped_over(thin, thick):
            raise OptionError(
                f"no radius gives relative density {wanted:g}: struts of {thin[0]:.5g} mm give "
                f"{thin[1] * wanted:.3g}, of {thick[0]:.5g} mm {thick[1] * wanted:.3g}"
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
        f"no radius gives relative density {wanted:g}: "
        f"the last one tried, {radius:g} mm, is off by {100 * abs(ratio - 1):.2g} %"
    )


def _is_jumped_over(thin: tuple[float, float], thick: tuple[float, float]) -> bool:
    """Return whether a ratio of 1 is so far from those of two radii that none between has it.

    The volume of the union of equal balls grows with at most the third power of their radius
    (Kneser, 1955), but where voids close.

    Parameters
    ----------
    thin, thick : radius, and ratio of its density to that wanted, < 1 and > 1
    """
    if thin[1] == 0 or thick[1] == np.inf:  # not tried yet
        return False
    growth = (thick[0] / thin[0]) ** STEEPEST
    return bool(thin[1] * growth < 1 < thick[1] / growth)


def solid_density(cell: UnitCell, size: Floats, radius: float) -> float:
    """Return the relative density of an endless lattice of round struts, measured on its solid.

    It is that of the middle cell of a block, all of whose neighbors are there.
    """
    around = further_layers(cell.motif)
    corners = np.array(list(product((around, around + 1), repeat=3)), dtype=np.float64)
    block = tile(cell, size, 2 * around + 1, radius=radius)
    return filled_share(to_solid(round_struts(block)), placed(cell, size, corners))


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
