"""The grid's sizes and places: all of them exact in 32 bits.

A cell has the size m 2^k with m in 4..7, and grid points are multiples of half of it from the
origin of coordinates. A vertex stands at a multiple of 2^-n of its grid edge, with n as the
spacing of 32-bit numbers at that place allows. So every vertex is exactly on its grid edge after
it is rounded to 32 bits, and a surface between tetrahedra stays free of crossings. Far from the
origin, where that spacing is not much less than a cell, m is 4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.errors import OptionError

LEAST_STEPS = 8
"""Least size of a cell, in steps between 32-bit numbers at its place: 4 a half edge."""

FEW_STEPS = 256
"""With fewer steps a cell, sizes are powers of two: then all steps are places for vertices."""

MANTISSA = 24
"""Bits of a 32-bit number's mantissa."""

LEAST_EXPONENT = -149
"""The least 32-bit number is 2^-149."""

KEY_BITS = 21
"""Bits of each coordinate of a grid point, counted in half cells of the finest size."""

MOST_CELLS_ASIDE = 2 ** (KEY_BITS - 2)
"""Most of the finest cells along a side of the whole."""

FINEST_FRACTION = 8
"""Vertices stand at least 2^-8 of their grid edge away from its ends."""


@dataclass(frozen=True, eq=False)
class Lattice(Frozen):
    """A grid of cells whose sizes are doubled from level to level."""

    cell: float
    """Size of the finest cell, mm."""
    corner: Ints
    """Lowest corner of the whole, in half cells from the origin of coordinates, shape (3,)."""
    levels: int
    """The whole is one cell of 2^levels finest ones a side."""

    @property
    def origin(self) -> Floats:
        """Lowest corner of the whole, shape (3,), mm, exact."""
        return np.asarray(self.corner * (self.cell / 2), dtype=np.float64)

    def places(self, halves: NDArray[np.integer]) -> Floats:
        """Return local positions of grid points given in half cells, (..., 3), mm."""
        return np.asarray(halves * (self.cell / 2), dtype=np.float64)


def representable_size(size: float, power: bool) -> float:
    """Return the largest m 2^k <= `size` with m in 4..7, or with m = 4."""
    mantissa, exponent = np.frexp(size)  # size = mantissa 2^exponent, mantissa in [0.5, 1)
    return float(np.ldexp(4.0 if power else np.floor(mantissa * 8), int(exponent) - 3))


def spacing_exponents(coordinates: Floats) -> NDArray[np.int32]:
    """Return k where 32-bit numbers of the size of the largest coordinate are 2^k apart, (n,)."""
    largest = np.abs(coordinates).max(axis=-1)
    exponents = np.frexp(largest)[1] - MANTISSA
    return np.asarray(np.maximum(exponents, LEAST_EXPONENT), dtype=np.int32)


def least_cells(points: Floats) -> Floats:
    """Return the least size of cells at points (..., 3), mm."""
    return np.ldexp(float(LEAST_STEPS), spacing_exponents(points))


def lattice_over(low: Floats, high: Floats, size: float, power: bool) -> Lattice:
    """Return the grid of cells of about `size`, or a power of two, that covers a box.

    Raises
    ------
    OptionError
        If the box has more cells a side than the keys of grid points can hold.
    """
    cell = representable_size(size, power)
    corner = np.floor(low / cell) - 2
    needed = float((np.ceil(high / cell) + 2 - corner).max())
    levels = max(int(np.ceil(np.log2(needed))), 2)
    if levels > KEY_BITS - 2:
        raise OptionError(
            f"cells of {cell:g} mm over {needed * cell:g} mm are {needed:.3g} per side; "
            f"need at most {MOST_CELLS_ASIDE}: take larger cells or radii"
        )
    return Lattice(cell, 2 * corner.astype(np.intp), levels)


def steps_on_edges(lattice: Lattice, start: Ints, end: Ints) -> NDArray[np.int32]:
    """Return n where vertices on edges may stand at multiples of 2^-n, shape (k,).

    Parameters
    ----------
    start, end : (k, 3) grid points in half cells from the grid's corner
    """
    apart = np.abs(end - start)
    least = np.where(apart > 0, apart, apart.max(axis=1)[:, None]).min(axis=1)  # a power of two
    half = lattice.cell / 2
    mantissa, exponent = np.frexp(half)  # half is m 2^k, and m = 8 mantissa
    unit = int(exponent) - (1 if mantissa == 0.5 else 3)
    far = np.maximum(np.abs(start + lattice.corner), np.abs(end + lattice.corner)) * half
    steps = np.log2(least) + unit - spacing_exponents(far)
    whole: NDArray[np.int32] = np.clip(np.floor(steps + 1e-9), 1, 16).astype(np.int32)
    return whole
