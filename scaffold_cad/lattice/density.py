"""How dense a lattice is: the first-order formula, and the density measured on its solid."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size, tile
from scaffold_cad.lattice.unitcell import UnitCell
from scaffold_cad.skeleton import Skeleton


@checks_keywords()
def relative_density(cell: str | UnitCell, size: ArrayLike, radius: float) -> float:
    """Return the volume of thin round struts over that of the space they fill: first order.

    The struts are counted at full length, so that what overlaps at nodes counts several times:
    the true density is lower by a fraction of order radius / strut length.

    Parameters
    ----------
    cell : a unit cell or its name
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    radius : of the struts, mm

    Raises
    ------
    OptionError
        If the cell is not known, a size or the radius is not > 0, or the struts are so thick
        that the formula gives 1 or more, which is not a density.

    Examples
    --------
    >>> from scaffold_cad import relative_density
    >>> 0.0 < relative_density("bcc", 5.0, radius=0.3) < 0.2
    True
    """
    radius = as_number(radius, "radius")
    of_unit_radius = density_of_unit_radius(cell, size)
    density = of_unit_radius * radius**2
    if not density < 1:
        raise OptionError(
            f"radius is {radius:g} mm, which gives relative density {density:.3g}; "
            f"need less than {of_unit_radius**-0.5:.3g} mm for struts in cells of this size"
        )
    return density


def measured_density(
    cell: str | UnitCell, size: ArrayLike, radius: float, volume: Callable[[Skeleton], float]
) -> float:
    """Return the relative density of an endless lattice, measured on solids of finite ones.

    The volumes of lattices of 2 and 3 cells along x, y and z are added and subtracted so that
    outer faces, edges and corners cancel and one cell of the inside is left. This is exact if
    each strut's solid depends on nothing but the struts that it meets.

    Parameters
    ----------
    cell : a unit cell or its name
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    radius : of the struts, mm
    volume : function that makes the solid of a skeleton and returns its volume, mm³
    """
    cell = as_cell(cell)
    inside = 0.0
    for x, y, z in product((2, 3), repeat=3):
        sign = (-1) ** (9 - x - y - z)
        inside += sign * volume(tile(cell, size, (x, y, z), radius=radius))
    return inside / cell.volume(cell_size(cell, size))


def density_of_unit_radius(cell: str | UnitCell, size: ArrayLike) -> float:
    """Return the first-order relative density of struts of radius 1 mm."""
    cell = as_cell(cell)
    return cell.density_coefficient_of(cell_size(cell, size))
