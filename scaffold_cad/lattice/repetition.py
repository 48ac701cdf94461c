"""Struts of a repeated unit cell. Nodes are numbered by cell and site: no search, no tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.motifs import Motif
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.lattice.unitcell import UnitCell

Counts: TypeAlias = tuple[int, int, int]
"""Numbers of cells along x, y and z."""

MOST_STRUTS = 100_000_000
"""Most struts of a lattice: they alone take some 6 GB, and a scaffold of them 100 times that."""


def as_counts(cell: UnitCell, counts: Floats | Ints) -> Counts:
    """Return numbers of cells along x, y and z (3,), not lower than 1, that can be repeated.

    Raises
    ------
    OptionError
        If they make more than `MOST_STRUTS` struts.
    """
    numbers = counts.astype(np.float64)
    struts = cell.strut_count * float(numbers.prod())
    if not struts <= MOST_STRUTS:
        x, y, z = numbers.tolist()
        raise OptionError(
            f"{x:g} x {y:g} x {z:g} cells of {cell.name!r} have {struts:.3g} struts; need at most "
            f"{MOST_STRUTS:g} (larger or fewer cells)"
        )
    x, y, z = counts.astype(np.intp).tolist()
    return x, y, z


def repeated(
    cell: UnitCell,
    size: Floats,
    counts: Counts,
    origin: Points | None = None,
    axes: Floats | None = None,
) -> Struts:
    """Return the struts of `counts` cells along their sides, each once, in order of their cells.

    Parameters
    ----------
    cell : unit cell
    size : (3,) float64, of one cell, mm
    counts : cells along x, y and z, see `as_counts`
    origin : (3,) float64, lowest corner of the first cell, mm; by default 0
    axes : (3, 3) float64, unit directions of the sides, rows; by default those of the cell
    """
    found = window_struts(cell.motif, counts, (0, 0, 0), all_layers(cell.motif, counts))
    used, edges = found.used()
    nodes = placed(cell, size, found.steps(used), origin, axes)
    return Struts(nodes, edges)


def further_layers(motif: Motif) -> int:
    """Return how many layers of cells beyond its own a strut may reach into.

    Sites on far faces, and those of struts through them, belong to further layers of cells.
    """
    return max(int(motif.moves.max(initial=0)), 1)


def all_layers(motif: Motif, counts: Counts) -> Counts:
    """Return the layers of cells that own struts or sites of a lattice of `counts` cells."""
    further = further_layers(motif)
    return counts[0] + further, counts[1] + further, counts[2] + further


def placed(
    cell: UnitCell,
    size: Floats,
    steps: Floats,
    origin: Points | None = None,
    axes: Floats | None = None,
) -> Points:
    """Return positions (n, 3), mm, of `steps` (n, 3) from the first cell's corner, in cells."""
    nodes = steps * size
    frame = cell.axes if axes is None else axes
    if not np.array_equal(frame, np.eye(3)):
        nodes = turned(nodes, frame)
    return nodes if origin is None else nodes + origin


def turned(rows: Floats, frame: Floats) -> Floats:
    """Return `rows` (n, 3) @ `frame` (3, 3), each to the same bits among whatever others."""
    x, y, z = rows[:, :1], rows[:, 1:2], rows[:, 2:]
    product: Floats = x * frame[0] + y * frame[1] + z * frame[2]
    return product


@dataclass(frozen=True, eq=False)
class Window:
    """The struts that a block of a lattice's cells owns, between sites numbered in it."""

    motif: Motif
    low: Counts
    """First cell of the block."""
    layers: Counts
    """Layers of cells that the struts reach into, from there on."""
    keys: Edges
    """Both ends of each strut as cell of these layers · sites + site, shape (m, 2)."""
    owners: Ints
    """Cell of these layers that owns each strut, ascending, shape (m,)."""

    def used(self) -> tuple[Ints, Edges]:
        """Return the keys of the nodes that struts use, ascending (n,), and the edges (m, 2)."""
        used = self.marks()
        edges = (np.cumsum(used) - 1)[self.keys]
        return np.flatnonzero(used), edges

    def marks(self) -> Bools:
        """Return whether a strut uses the site of each key, shape (cells · sites,)."""
        x, y, z = self.layers
        used = np.zeros(x * y * z * len(self.motif.sites), dtype=np.bool_)
        used[self.keys] = True
        return used

    def steps(self, keys: Ints) -> Floats:
        """Return where sites are (n, 3), in cells from the corner of the lattice's first one."""
        place, site = np.divmod(keys, len(self.motif.sites))
        cells = np.stack(np.unravel_index(place, self.layers), axis=1) + self.low
        steps: Floats = cells + self.motif.sites[site]
        return steps


def window_struts(motif: Motif, counts: Counts, low: Counts, high: Counts) -> Window:
    """Return the struts of a lattice that the cells from `low` to before `high` own.

    All windows that share no cell have all struts of the lattice once, and in order of their
    cells they have them in its order.

    Parameters
    ----------
    counts : cells of the lattice along its sides
    low, high : of the window; `all_layers` is the highest
    """
    further = further_layers(motif)
    x, y, z = (high[axis] - low[axis] + further for axis in range(3))
    strides = np.array([y * z, z, 1])
    owners, keys = [], []
    for sites, moves, copies in zip(motif.struts, motif.moves, motif.copies, strict=True):
        cell = _cells_with_strut(copies, counts, low, high, (x, y, z))  # (k,)
        owners.append(cell)
        keys.append((cell[:, None] + moves @ strides) * len(motif.sites) + sites)
    # Neighbors in space stay neighbors in memory; the runs are sorted already.
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return Window(motif, low, (x, y, z), np.concatenate(keys)[order], owner[order])


def _cells_with_strut(
    copies: np.ndarray, counts: Counts, low: Counts, high: Counts, layers: Counts
) -> Ints:
    """Return the cells of a window in which a strut occurs, for one of the cells around lists it.

    Ascending.
    """
    occurs = np.zeros(layers, dtype=np.bool_)
    for offset in np.argwhere(copies).tolist():
        spans = (
            slice(max(step - first, 0), max(min(step + count, last) - first, 0))
            for step, count, first, last in zip(offset, counts, low, high, strict=True)
        )
        occurs[tuple(spans)] = True
    return np.flatnonzero(occurs)
