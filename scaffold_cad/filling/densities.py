"""Radii that give a lattice its relative density, by the formula or as measured on its solid."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_flag, as_number, as_real, checks_keywords
from scaffold_cad.base.arrays import Floats, Points, as_floats, place_text
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.innercell import Capsules, capsules, solid_density
from scaffold_cad.filling.radiussearch import found_radius
from scaffold_cad.lattice import UnitCell
from scaffold_cad.lattice.density import density_of_unit_radius, measured_density
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.skeleton import Skeleton

Density: TypeAlias = float | Callable[[Points], ArrayLike]
"""One relative density, or a function of positions (n, 3) that returns them (n,)."""

REACH = 2.0
"""How far from a cell struts are made where it alone is measured, in their radii: they have a part
in it up to 1.5 radii away, fillets included. Struts further away change no fillet in it, but may
tell whether nodes there have patches or are part of a field, with other fillets: gyroids of density
0.45 and 0.55 are 0.3 and 0.9 % lighter as a field."""

DENSER = 1.03
"""By what factor struts further away can make a cell denser, at most."""

MEASURED = 6
"""Radii at which the density is measured for a field of them."""

RANGE = (0.02, 0.95)
"""Least and greatest radius measured, in that at which the formula gives 1."""


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
        has it, as voids between struts close below it: the largest density that is reached is
        named, with its radius.

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
    if volume is None and not measured:
        return float(np.sqrt(relative_density / density_of_unit_radius(known, sizes)))

    estimate = capsules(known, sizes)
    if volume is None:
        return _solid_radius(known, sizes, relative_density, estimate)

    def density(tried: float) -> float:
        return measured_density(known, sizes, tried, volume)

    return found_radius(density, relative_density, estimate).radius_or_raise()


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
        from scipy.interpolate import PchipInterpolator

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


def _solid_radius(cell: UnitCell, size: Floats, wanted: float, estimate: Capsules) -> float:
    """Return the radius whose solid has the density wanted, mm.

    It is looked for with the struts near one cell, and seen to be right on a whole block; none is
    made for a density that is out of reach with it too.
    """
    whole = cache(partial(solid_density, cell, size))

    def nearby(radius: float) -> float:
        return solid_density(cell, size, radius, REACH * radius)

    found = found_radius(nearby, wanted, estimate)
    within_reach = found.beyond is None or wanted < DENSER * found.density
    if within_reach and abs(whole(found.radius) / found.density - 1) > found.accuracy:
        found = found_radius(whole, wanted, estimate, found.radius)
    return found.radius_or_raise()


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
