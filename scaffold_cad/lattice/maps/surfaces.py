"""Cells along a surface's normals, and between two surfaces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_real
from scaffold_cad.base.arrays import (
    Floats,
    Frozen,
    Ints,
    Points,
    UnitVectors,
    as_floats,
    place_text,
)
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.maps.cellmap import CellMap

Height: TypeAlias = float | Callable[[Points], ArrayLike]
"""One height above a surface, mm, or a function of positions on it (n, 3) that returns (n,)."""

MATCHING = 5
"""Places along each side of the unit square at which two surfaces are compared."""


SHIFTS = 12
"""Shifts of a surface that closes that are tried at first."""

SAME_SHIFT = 1e-6
"""Difference below which two shifts are the same."""


class Surface(Protocol):
    """A surface over one unit square or several, with its normals."""

    @property
    def wraps(self) -> tuple[bool, bool]:
        """Whether the end along u and along v is the beginning again."""

    @property
    def patches(self) -> int:
        """Number of unit squares."""

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Closed polygons (k, 2) in the unit square that trim it, see `CellMap`."""

    def at(self, places: Floats, patch: Ints) -> tuple[Points, UnitVectors]:
        """Return positions (n, 3) and unit normals (n, 3) at places (n, 2) in patches (n,)."""


@dataclass(frozen=True, eq=False)
class SurfaceMap(Frozen, CellMap):
    """Cells that stand on a surface: u and v run along it, w along its normal.

    The layer begins at height `offset` and is `thickness` high; both are numbers or functions of
    positions on the surface, such as a height field. A negative thickness goes to the back.
    """

    surface: Surface
    thickness: Height
    offset: Height

    def __init__(self, surface: Surface, thickness: Height, offset: Height = 0.0) -> None:
        self._keep(
            surface=surface,
            thickness=_as_height(thickness, "thickness"),
            offset=_as_height(offset, "offset"),
            wraps=(*surface.wraps, False),
            patches=surface.patches,
            loops=surface.loops,
        )
        if not callable(self.thickness) and self.thickness == 0:
            raise OptionError("thickness is 0 mm; need another")

    def positions(self, places: Points, patch: Ints) -> Points:
        """Return where places are; see `CellMap`."""
        foot, normals, of_place = _each_once(self.surface, places, patch)
        low = heights_at(self.offset, foot, "offset")
        high = low + heights_at(self.thickness, foot, "thickness")
        w = places[:, 2]
        height = (1 - w) * low[of_place] + w * high[of_place]
        moved: Points = foot[of_place] + height[:, None] * normals[of_place]
        return moved


@dataclass(frozen=True, eq=False)
class BetweenMap(Frozen, CellMap):
    """Cells between two surfaces: w runs straight from a place of one to that of the other.

    Which side of the second square goes to which of the first is chosen so that the straight
    lines are short.
    """

    lower: Surface
    upper: Surface
    turn: tuple[bool, bool, bool]
    """Whether u and v of the upper surface are exchanged, and then which of them run backwards."""
    shift: tuple[float, float]
    """How far u and v of the upper surface begin further on, where they close, from 0 to 1."""

    def __init__(self, lower: Surface, upper: Surface) -> None:
        """Match two surfaces.

        Raises
        ------
        OptionError
            If one has several patches, or only one of them closes.
        """
        if lower.patches != 1 or upper.patches != 1:
            raise OptionError("a surface has several patches; need one unit square a surface")
        turn, shift = _best_match(lower, upper)
        closes = upper.wraps[::-1] if turn[0] else upper.wraps
        if closes != lower.wraps:
            raise OptionError(
                f"one surface closes along u and v: {lower.wraps}, the other: {closes}; "
                "need both to close, or none"
            )
        self._keep(
            lower=lower,
            upper=upper,
            turn=turn,
            shift=shift,
            wraps=(*lower.wraps, False),
            loops=lower.loops,
        )

    def positions(self, places: Points, patch: Ints) -> Points:
        """Return where places are; see `CellMap`."""
        low, _, of_low = _each_once(self.lower, places, patch)
        flat = _turned(places[:, :2], self.turn, self.shift)
        turned = np.concatenate([flat, places[:, 2:]], axis=1)
        high, _, of_high = _each_once(self.upper, turned, patch)
        w = places[:, 2:]
        moved: Points = (1 - w) * low[of_low] + w * high[of_high]
        return moved


def heights_at(height: Height, points: Points, name: str) -> Floats:
    """Return the height at positions (n, 3), shape (n,), mm.

    Raises
    ------
    OptionError
        If a function returns another shape, or numbers that are not finite.
    """
    if not callable(height):
        return np.full(len(points), float(height))
    values = as_floats(height(points), f"what the function {name} returned", OptionError)
    if values.shape not in {(), (len(points),)}:
        raise OptionError(
            f"{name} returned shape {values.shape} for points ({len(points)}, 3); "
            f"need ({len(points)},)"
        )
    bad = np.flatnonzero(~np.isfinite(np.atleast_1d(values)))
    if len(bad):
        raise OptionError(
            f"{name} is {np.atleast_1d(values)[bad[0]]:g} at {place_text(points[bad[0]])}; "
            "need a finite number"
        )
    return np.broadcast_to(values, (len(points),))


def _as_height(value: Height, name: str) -> Height:
    if callable(value):
        return value
    number = as_real(value, name, hint=", or a function of positions (n, 3) that returns (n,)")
    if not np.isfinite(number):
        raise OptionError(f"{name} is {number:g} mm; need a finite number")
    return number


def _each_once(surface: Surface, places: Points, patch: Ints) -> tuple[Points, UnitVectors, Ints]:
    """Return positions and normals at the distinct (u, v) of places, and which each place has.

    Cells stand above each other: their nodes share their feet.
    """
    order = np.lexsort([places[:, 1], places[:, 0], patch])
    ranked = places[order, :2]
    new = np.ones(len(order), dtype=np.bool_)
    new[1:] = (ranked[1:] != ranked[:-1]).any(axis=1) | (np.diff(patch[order]) != 0)
    of_place = np.empty(len(order), dtype=np.intp)
    of_place[order] = np.cumsum(new) - 1
    feet, normals = surface.at(ranked[new], patch[order][new])
    return feet, normals, of_place


def _turned(
    places: Floats, turn: tuple[bool, bool, bool], shift: tuple[float, float] = (0.0, 0.0)
) -> Floats:
    """Return places (n, 2) of one square in the other, see `BetweenMap`."""
    swapped = places[:, ::-1] if turn[0] else places
    turned = np.where(turn[1:], 1 - swapped, swapped)
    moved = np.asarray(shift) != 0
    # 1 is 0 again where a surface closes.
    return np.where(moved, (turned + shift) % 1.0, turned)


def _best_match(
    lower: Surface, upper: Surface
) -> tuple[tuple[bool, bool, bool], tuple[float, float]]:
    """Return the symmetry of the square, and the shifts, under which two surfaces are closest."""
    steps = (np.arange(MATCHING) + 0.5) / MATCHING
    places = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    patch = np.zeros(len(places), dtype=np.intp)
    low, _ = lower.at(places, patch)

    def gap(turn: tuple[bool, bool, bool], shift: tuple[float, float]) -> float:
        high, _ = upper.at(_turned(places, turn, shift), patch)
        return float(((high - low) ** 2).sum())

    rounds = [np.arange(SHIFTS) / SHIFTS if closes else np.zeros(1) for closes in upper.wraps]
    tries = [
        ((bool(a), bool(b), bool(c)), (float(u), float(v)))
        for a, b, c in product((0, 1), repeat=3)
        for u, v in product(*rounds)
    ]
    turn, shift = min(tries, key=lambda one: gap(*one))
    step = 1 / SHIFTS
    while step > SAME_SHIFT:  # closer and closer around the best one
        near = [
            [(value + k * step) % 1.0 for k in (0, -1, 1)] if closes else [value]
            for value, closes in zip(shift, upper.wraps, strict=True)
        ]
        u, v = min(product(*near), key=lambda one: gap(turn, (one[0], one[1])))
        shift, step = (float(u), float(v)), step / 2
    u, v = (0.0 if min(one, 1 - one) < 2 * SAME_SHIFT else one for one in shift)
    return turn, (u, v)
