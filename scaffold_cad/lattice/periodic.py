"""PeriodicLattice: a cell, how often it is repeated and how thick its struts are, and no strut.

It is what a lattice too large for memory is known by. Any block of its cells can be made of it,
with the same bits as in the whole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, as_vector, check_choice, checks_keywords
from scaffold_cad.base.arrays import Floats, Frames, Frozen, Ints, Points
from scaffold_cad.base.placements import AxesLike, OriginLike, placed_by
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.summaries import counted
from scaffold_cad.lattice.maps.placing import Counts, three_counts
from scaffold_cad.lattice.maps.solids import as_axes
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.repetition import Window, all_layers, as_counts, placed, window_struts
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.lattice.unitcell import UnitCell
from scaffold_cad.skeleton import Skeleton

ENDS = ("flat", "round", "open")
"""How round struts can end where there is no other, see `round_struts`."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class PeriodicLattice(Frozen):
    """A unit cell repeated along the sides of a block, of which no strut is made yet.

    `write` puts it into a 3MF file a few layers at a time, and `tiles` cuts it into blocks.

    Examples
    --------
    >>> from scaffold_cad import PeriodicLattice
    >>> lattice = PeriodicLattice("bcc", 1.0, 500, radius=0.1)
    >>> lattice.strut_count
    1000000000
    >>> PeriodicLattice("bcc", 8.0, 2, radius=0.5).skeleton().edges.shape
    (64, 2)
    """

    cell: UnitCell
    """What is repeated."""
    size: Floats
    """Of one cell along its sides, shape (3,), mm."""
    counts: tuple[int, int, int]
    """Cells along x, y and z."""
    radius: Radius
    """One number, mm, or a function of positions (n, 3) that returns radii (n,)."""
    origin: Points
    """Lowest corner of the first cell, shape (3,), mm."""
    axes: Frames
    """Unit directions of the sides, rows, shape (3, 3)."""
    blend: Radius | None
    """Fillet radius at the nodes of round struts, mm, or a function of positions; None for half
    the struts' radius."""
    ends: str
    """How round struts end at the lattice's sides where there is no other."""
    wall: float | None
    """Thickness of hollow round struts, mm; None for solid ones."""

    def __str__(self) -> str:
        """Return one line: the cell, how many of which size, struts."""
        counts, size = (" x ".join(f"{n:.6g}" for n in each) for each in (self.counts, self.size))
        struts = counted(self.strut_count, "strut")
        return f"PeriodicLattice: {counts} cells of {self.cell.name}, each {size} mm, {struts}"

    def __init__(
        self,
        cell: str | UnitCell,
        size: ArrayLike,
        counts: Counts,
        radius: Radius,
        *,
        origin: OriginLike | None = None,
        axes: AxesLike | None = None,
        blend: Radius | None = None,
        ends: str = "flat",
        wall: float | None = None,
    ) -> None:
        """Take a lattice.

        Parameters
        ----------
        cell : a unit cell or its name, see `cells`
        size : of one cell, mm: three numbers, or one for a cell that is not distorted
        counts : cells along x, y and z, or one number for all three
        radius : mm; one number, or a function of positions (n, 3) that returns radii (n,). For
            work in several processes it must be a function of a module
        origin : lowest corner of the first cell, mm; by default that of `axes`, or 0
        axes : (3, 3), unit directions of the sides, or a Plane or Location of build123d; by default
            those of `origin`, or of the cell
        blend, ends, wall : of round struts, see `round_struts`: for layers and tiles of them

        Raises
        ------
        OptionError
            If the cell is not known, a size, a count, a radius, a fillet or a wall is not > 0, or
            there are no such ends.
        """
        for name, value in (("blend", blend), ("wall", wall)):
            if value is not None and not callable(value):
                as_number(value, name)
        check_choice(ends, "ends", ENDS)
        chosen = as_cell(cell)
        x, y, z = three_counts(counts).tolist()
        origin, axes = placed_by(origin, axes)
        radii_at(np.zeros((1, 3)), radius)
        self._keep(
            cell=chosen,
            size=cell_size(chosen, size),
            counts=(x, y, z),
            radius=radius,
            origin=as_vector(origin, "origin"),
            axes=chosen.axes if axes is None else as_axes(axes),
            blend=blend,
            ends=ends,
            wall=wall,
        )

    @property
    def strut_options(self) -> dict[str, Any]:
        """What `round_struts` is asked for beside the skeleton."""
        return {"blend": self.blend, "ends": self.ends, "wall": self.wall}

    @property
    def strut_count(self) -> int:
        """Struts of all cells, without those that only close the block's far faces."""
        x, y, z = self.counts
        return self.cell.strut_count * x * y * z

    @property
    def layers(self) -> tuple[int, int, int]:
        """Layers of cells along the sides that own struts: those beyond `counts` close it."""
        return all_layers(self.cell.motif, self.counts)

    def scaled(self, factor: float) -> PeriodicLattice:
        """Return the lattice with positions and radii multiplied by `factor` > 0."""
        factor = as_number(factor, "scale factor", unit="")
        return PeriodicLattice(
            self.cell,
            self.size * factor,
            self.counts,
            radius=_scaled(self.radius, factor),
            origin=self.origin * factor,
            axes=self.axes,
            blend=None if self.blend is None else _scaled(self.blend, factor),
            ends=self.ends,
            wall=None if self.wall is None else factor * self.wall,
        )

    def window(self, low: tuple[int, int, int], high: tuple[int, int, int]) -> Window:
        """Return the struts that cells from `low` to before `high` own, see `window_struts`."""
        return window_struts(self.cell.motif, self.counts, low, high)

    def positions(self, window: Window, keys: Ints) -> Points:
        """Return where nodes of a window are, shape (n, 3), mm."""
        return placed(self.cell, self.size, window.steps(keys), self.origin, self.axes)

    def skeleton(self) -> Skeleton:
        """Return all struts.

        Raises
        ------
        OptionError
            If they are more than 1e8.
        """
        as_counts(self.cell, np.array(self.counts))
        return self.part(self.window((0, 0, 0), self.layers))

    def part(self, window: Window) -> Skeleton:
        """Return the struts of a window."""
        keys, edges = window.used()
        nodes = self.positions(window, keys)
        return Skeleton(nodes, edges, radii_at(nodes, self.radius))


def _scaled(radius: Radius, factor: float) -> Radius:
    return _Scaled(radius, factor) if callable(radius) else factor * radius


@dataclass(frozen=True)
class _Scaled:
    """Radii of a lattice after it was scaled."""

    radius: Callable[[Points], ArrayLike]
    factor: float

    def __call__(self, nodes: Points) -> Floats:
        radii: Floats = np.asarray(self.radius(nodes / self.factor)) * self.factor
        return radii
