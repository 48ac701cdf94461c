"""Sections of lattices that do not repeat themselves, made a few layers of cells at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.lattice.repetition import further_layers
from scaffold_cad.layers.loops import Loops
from scaffold_cad.layers.rounds import swell
from scaffold_cad.layers.struts import StrutSections, sections_of
from scaffold_cad.layers.uniting import Solid
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts

AT_ONCE = 100_000
"""Struts of a slab, about, or of one layer of cells with what is above and below it."""

AROUND = 2
"""Layers of cells, in those that a strut reaches into, above and below those that are cut: what is
cut depends on its struts, their neighbors, and how much room those need."""


def slabs_solid(lattice: PeriodicLattice, sides: int) -> Solid:
    """Return a lattice whose layers of cells are level, to be cut."""
    hollow = None if lattice.wall is None else SlabSections(lattice, sides, is_inside=True)
    return Solid(SlabSections(lattice, sides), hollow)


class SlabSections:
    """The sections of a lattice whose layers of cells are level, from the lowest up."""

    def __init__(self, lattice: PeriodicLattice, sides: int, *, is_inside: bool = False) -> None:
        """Take a lattice; no strut is made yet.

        Parameters
        ----------
        sides : of the polygons that stand for circles, a multiple of 4
        is_inside : whether what is taken out of hollow struts is wanted
        """
        self._is_inside = is_inside
        self._lattice, self._sides = lattice, sides
        self._origin = float(lattice.origin[2])
        self._rise = float(lattice.size[2] * lattice.axes[2, 2])
        self._around = AROUND * further_layers(lattice.cell.motif)
        x, y, _ = lattice.layers
        self._in_layer = lattice.cell.strut_count * x * y
        self._deep = max(1, AT_ONCE // self._in_layer - 2 * self._around)
        self._last = (lattice.counts[2] - 1) // self._deep
        self._number = -1
        self._slab: StrutSections | None = None

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest point, mm."""
        return self._made(0).bounds[0], self._made(self._last).bounds[1]

    @property
    def box(self) -> Floats:
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
        larger = float(swell(np.array(2 * np.pi / self._sides)))
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for number in range(self._last + 1):
            skeleton = self._skeleton(number, 0)
            reach = larger * skeleton.radii[:, None]
            low = np.minimum(low, (skeleton.nodes - reach).min(axis=0))
            high = np.maximum(high, (skeleton.nodes + reach).max(axis=0))
        return np.stack([low, high])[:, :2]

    def count(self, heights: Floats) -> Ints:
        """Return how many parts there are at each height, about, shape (h,)."""
        return np.full(len(heights), self._in_layer)

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections of all parts at ascending heights (h,), above those before."""
        layer = np.floor((heights - self._origin) / self._rise)
        slab = np.clip(layer // self._deep, 0, self._last).astype(np.intp)
        found: list[Loops] = []
        for number, some in runs_of_equals(slab):
            if self._slab is None or number != self._number:
                self._number, self._slab = number, self._made(number)
            found += [
                Loops(loops.points, loops.offsets, loops.levels + some.start)
                for loops in self._slab.loops(heights[some])
            ]
        return found

    def _made(self, number: int) -> StrutSections:
        """Return the sections of a slab, with enough around it."""
        skeleton = self._skeleton(number, self._around)
        struts = round_struts(skeleton, **self._lattice.strut_options)
        outside, inside = sections_of(struts, self._sides)
        return inside if self._is_inside and inside is not None else outside

    def _skeleton(self, number: int, around: int) -> Skeleton:
        """Return the struts of a slab and of some layers of cells above and below it."""
        x, y, top = self._lattice.layers
        low = max(number * self._deep - around, 0)
        high = top if number == self._last else min((number + 1) * self._deep + around, top)
        return self._lattice.part(self._lattice.window((0, 0, low), (x, y, high)))


def runs_of_equals(values: Ints) -> Iterator[tuple[int, slice]]:
    """Yield each run of equal values, and where it is."""
    marks = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1, [len(values)]])
    for first, last in zip(marks[:-1].tolist(), marks[1:].tolist(), strict=True):
        yield int(values[first]), slice(first, last)
