"""Layers of lattices of which only some cells are ever made.

Where all struts of a lattice have one radius and its layers of cells are level, it repeats itself:
a lattice of a few cells along each side is cut, and its polygons are repeated, see `stamps`; at
heights a whole number of cells apart they are the same. Other lattices are made a few layers of
cells at a time.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.lattice.repetition import further_layers
from scaffold_cad.layers.layer import Layer
from scaffold_cad.layers.slabs import runs_of_equals, slabs_solid
from scaffold_cad.layers.stamps import Stamp
from scaffold_cad.layers.struts import StrutSections, sections_of, struts_solid
from scaffold_cad.layers.uniting import Solid, layer_of, united
from scaffold_cad.struts import round_struts

if TYPE_CHECKING:
    from manifold3d import CrossSection

MARGIN = 3
"""Cells, in those that a strut reaches into, on each side of the cell that is repeated. What is
cut in a cell depends on its struts, their neighbors, and how much room those need."""

MOST_KEPT = 256
"""Most layers that are kept to be used again."""

SAME = 1e-9
"""Heights above their cell that agree to this part of it have the same polygons."""


def lattice_solid(lattice: PeriodicLattice, sides: int) -> RepeatedLattice | Solid:
    """Return a lattice to be cut."""
    level = lattice.axes[:2, 2] == 0
    if not (level.all() and lattice.axes[2, 2] > 0):
        return struts_solid(round_struts(lattice.skeleton(), **lattice.strut_options), sides)
    if callable(lattice.radius) or callable(lattice.blend):
        return slabs_solid(lattice, sides)
    found = RepeatedLattice(lattice, sides)
    return found if found.is_told_apart else slabs_solid(lattice, sides)


def _with_counts(lattice: PeriodicLattice, counts: Ints) -> PeriodicLattice:
    """Return the first cells of a lattice."""
    x, y, z = counts.tolist()
    return PeriodicLattice(
        lattice.cell,
        lattice.size,
        (x, y, z),
        radius=lattice.radius,
        origin=lattice.origin,
        axes=lattice.axes,
        **lattice.strut_options,
    )


class RepeatedLattice:
    """A lattice that repeats itself, of which a few cells are made."""

    def __init__(self, lattice: PeriodicLattice, sides: int) -> None:
        """Take a lattice of one radius whose layers of cells are level.

        Parameters
        ----------
        sides : of the polygons that stand for circles, a multiple of 4
        """
        counts = np.array(lattice.counts)
        margin = MARGIN * further_layers(lattice.cell.motif)
        made = np.minimum(counts, 2 * margin + 1)
        steps = lattice.size[:, None] * lattice.axes  # (3, 3), mm
        few = _with_counts(lattice, made).skeleton()
        self._struts = round_struts(few, **lattice.strut_options)
        self._sides = sides
        self._origin, self._rise = float(lattice.origin[2]), steps[2]
        self._margin, self._more = margin, int(counts[2] - made[2])
        reach = further_layers(lattice.cell.motif)
        self._stamp = Stamp(lattice.origin[:2], steps[:2, :2], made[:2], counts[:2], reach)
        self._kept: dict[int, tuple[Floats, Ints]] = {}
        parts, _ = sections_of(self._struts, sides)
        low, high = parts.bounds
        self.bounds = low, high + self._more * float(self._rise[2])
        """Lowest and highest point, mm."""
        shifts = np.array(list(product((0, 1), repeat=3)))
        far = (shifts * (counts - made)) @ steps[:, :2]  # (8, 2)
        self.box: Floats = parts.box + np.stack([far.min(axis=0), far.max(axis=0)])
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""

    @property
    def is_told_apart(self) -> bool:
        """Whether no strut goes on from cell to cell without a node."""
        runs = self._struts.runs
        ends = runs.nodes[runs.edges].reshape(-1, 3)[:, :2]
        return self._stamp.repeated(ends, 2 * np.arange(len(runs.edges) + 1)) is not None

    def layers(self, planes: Floats, thickness: float) -> Iterator[Layer]:
        """Yield what is solid at each of ascending heights as layers."""
        for height, (points, offsets) in zip(planes.tolist(), self._polygons(planes), strict=True):
            yield Layer(height, thickness, points, offsets)

    def sections(self, planes: Floats) -> Iterator[CrossSection]:
        """Yield what is solid at each of ascending heights."""
        for points, offsets in self._polygons(planes):
            yield united(np.split(points, offsets[1:-1]) if len(points) else [])

    def _polygons(self, planes: Floats) -> Iterator[tuple[Floats, Ints]]:
        """Yield the polygons at each of ascending heights."""
        cell = np.floor((planes - self._origin) / self._rise[2]).astype(np.intp)
        above = np.clip(cell - self._margin, 0, self._more)  # cells left out below each height
        for shift, some in runs_of_equals(above):
            yield from self._between(planes[some] - shift * self._rise[2], shift * self._rise[:2])

    def _between(self, planes: Floats, shift: Floats) -> Iterator[tuple[Floats, Ints]]:
        """Yield the polygons at heights of the few cells, moved by `shift` (2,), for all cells."""
        keys = np.rint((planes - self._origin) / (SAME * self._rise[2])).astype(np.int64).tolist()
        known = {key: self._kept[key] for key in keys if key in self._kept}
        fresh = np.array([key not in known for key in keys], dtype=np.bool_)
        made = self._few(planes[fresh])
        parts: list[StrutSections] = []
        for key, plane, is_fresh in zip(keys, planes, fresh.tolist(), strict=True):
            points, offsets = next(made) if is_fresh else known[key]
            if is_fresh:
                self._keep(key, (points, offsets))
            found = self._stamp.repeated(points, offsets)
            if found is None:
                parts = parts or self._parts()
                found = self._united(parts, plane)
            yield (found[0] + shift if shift.any() else found[0]), found[1]

    def _few(self, planes: Floats) -> Iterator[tuple[Floats, Ints]]:
        """Yield the polygons of the few cells at each of ascending heights."""
        if len(planes):
            for layer in struts_solid(self._struts, self._sides).layers(planes, 0.0):
                yield layer.points, layer.offsets

    def _keep(self, key: int, polygons: tuple[Floats, Ints]) -> None:
        """Keep the polygons of a height, and forget the first of too many."""
        if len(self._kept) >= MOST_KEPT:
            self._kept.pop(next(iter(self._kept)))
        self._kept[key] = polygons

    def _parts(self) -> list[StrutSections]:
        """Return the struts, and what is taken out of hollow ones, from the lowest up."""
        return [each for each in sections_of(self._struts, self._sides) if each is not None]

    def _united(self, parts: list[StrutSections], plane: float) -> tuple[Floats, Ints]:
        """Return the polygons at a height where some go on from cell to cell without an end."""
        section = self._repeated(parts[0], plane)
        for hollow in parts[1:]:
            section = section - self._repeated(hollow, plane)
        layer = layer_of(section, plane, 0.0)
        return layer.points, layer.offsets

    def _repeated(self, parts: StrutSections, plane: float) -> CrossSection:
        """Return the sections of parts at a height, repeated one by one and united."""
        loops: list[Floats] = []
        for some in parts.loops(np.array([plane])):
            found = self._stamp.repeated(some.points, some.offsets)
            if found is not None and len(found[0]):  # else one is too wide to be told apart
                loops += np.split(found[0], found[1][1:-1])
        return united(loops)
