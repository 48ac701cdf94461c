"""Fields: numbers sampled on a grid or at points, looked up anywhere between."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import QhullError, cKDTree

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Points, as_floats, as_points, place_text
from scaffold_cad.base.summaries import counted, size_text
from scaffold_cad.errors import OptionError

if TYPE_CHECKING:
    from scipy.interpolate import LinearNDInterpolator, RegularGridInterpolator


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Field(Frozen):
    """Numbers on a regular grid, linear between its places; outside, those of the nearest one.

    A field is a function of positions, and can be used where one can: for a radius, a density,
    a cell size, a thickness or a region.

    Examples
    --------
    >>> field = Field([[[0.4, 0.4], [0.4, 0.4]], [[0.8, 0.8], [0.8, 0.8]]], [[0, 0, 0], [10, 9, 9]])
    >>> field([[5.0, 1.0, 1.0]]).round(3).tolist()
    [0.6]
    """

    values: Floats
    """Numbers at places along x, y and z, the first and last on the bounds, shape (i, j, k)."""
    bounds: Floats
    """Lowest and highest corner of the grid, shape (2, 3), mm."""

    def __init__(self, values: ArrayLike, bounds: ArrayLike) -> None:
        grid = as_floats(values, "values of the field", OptionError)
        if grid.ndim != 3 or 0 in grid.shape:
            raise OptionError(f"values of the field have shape {grid.shape}; need (i, j, k)")
        bad = np.argwhere(~np.isfinite(grid))
        if len(bad):
            at = bad[0].tolist()
            raise OptionError(f"the field is {grid[tuple(at)]:g} at {at}; need finite numbers")
        corners = as_floats(bounds, "bounds of the field", OptionError)
        if corners.shape != (2, 3) or not np.isfinite(corners).all():
            raise OptionError(f"bounds of the field are {corners.tolist()}; need two corners, mm")
        flat = (corners[1] <= corners[0]) & (np.asarray(grid.shape) > 1)
        if flat.any():
            low, high = corners.tolist()
            raise OptionError(
                f"the field is from {low} to {high} mm; need the first below the second"
            )
        self._keep(values=grid, bounds=corners)

    def __str__(self) -> str:
        counts = " x ".join(map(str, self.values.shape))
        values = f"values {self.values.min():.6g} to {self.values.max():.6g}"
        return f"Field: {counts} values, {size_text(self.bounds)}, {values}"

    def __call__(self, points: ArrayLike) -> Floats:
        """Return the numbers at positions (n, 3), shape (n,)."""
        low, high = self.bounds
        places = np.clip(as_floats(points, "points", OptionError), low, high)
        axes = [axis for axis in range(3) if self.values.shape[axis] > 1]
        if not axes:
            return np.full(len(places), float(self.values.reshape(-1)[0]))
        numbers: Floats = self._between(places[:, axes])
        return numbers

    @cached_property
    def _between(self) -> RegularGridInterpolator:
        from scipy.interpolate import RegularGridInterpolator

        axes = [axis for axis in range(3) if self.values.shape[axis] > 1]
        low, high = self.bounds
        steps = [np.linspace(low[k], high[k], self.values.shape[k]) for k in axes]
        return RegularGridInterpolator(steps, np.squeeze(self.values))


@checks_keywords()
class PointField:
    """Numbers at scattered points, such as a result of finite elements.

    They are linear in the tetrahedra between the points; outside, or where all points lie in a
    plane, those of the nearest point.

    Examples
    --------
    >>> from scaffold_cad import PointField
    >>> stress = PointField([[0, 0, 0], [10, 0, 0]], [1.0, 3.0])
    >>> stress([[9, 1, 0]])  # that of the nearest point: two points span no volume
    array([3.])
    """

    def __init__(self, points: ArrayLike, values: ArrayLike) -> None:
        """Keep points and their values.

        Parameters
        ----------
        points : (n, 3), mm
        values : (n,)

        Raises
        ------
        OptionError
            If the shapes differ, a number is not finite, or a place has two values.
        """
        places = as_points(points, "points of the field", OptionError)
        numbers = as_floats(values, "values of the field", OptionError)
        if len(places) == 0 or numbers.shape != (len(places),):
            raise OptionError(
                f"values of the field have shape {numbers.shape} for points of shape "
                f"{places.shape}; need one per point"
            )
        bad = np.flatnonzero(~np.isfinite(numbers))
        if len(bad):
            place = places[bad[0]].tolist()
            raise OptionError(
                f"the field is {numbers[bad[0]]:g} at {place} mm; need finite numbers"
            )
        _check_single(places, numbers)
        self.points: Points = places
        self.values: Floats = numbers
        self._tree = cKDTree(places)

    def __str__(self) -> str:
        """Return one line: how many points, the size of their box, the range of values."""
        values = f"values {self.values.min():.6g} to {self.values.max():.6g}"
        return (
            f"PointField: {counted(len(self.points), 'point')}, {size_text(self.points)}, {values}"
        )

    def __call__(self, points: ArrayLike) -> Floats:
        """Return the numbers at positions (n, 3), shape (n,)."""
        wanted = as_floats(points, "points", OptionError)
        numbers: Floats = self.values[self._tree.query(wanted)[1]]
        if self._between is not None:
            between = self._between(wanted)
            numbers = np.where(np.isnan(between), numbers, between)
        return numbers

    @cached_property
    def _between(self) -> LinearNDInterpolator | None:
        from scipy.interpolate import LinearNDInterpolator

        try:
            return LinearNDInterpolator(self.points, self.values)
        except (QhullError, ValueError):  # too few points, or all in a plane
            return None


def _check_single(places: Points, numbers: Floats) -> None:
    """Raise if two of the values (n,) differ at one place."""
    order = np.lexsort(places.T)  # equal places are side by side
    one, other = order[:-1], order[1:]
    same = (places[one] == places[other]).all(axis=1)
    bad = np.flatnonzero(same & (numbers[one] != numbers[other]))
    if len(bad):
        first, second = one[bad[0]], other[bad[0]]
        raise OptionError(
            f"the field is {numbers[first]:.9g} and {numbers[second]:.9g} at "
            f"{place_text(places[first])}; need one value at each place"
        )
