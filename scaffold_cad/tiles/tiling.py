"""tiles(): a skeleton or a lattice cut into blocks, each made when it is asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, as_floats
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.lattice.maps.placing import three_counts
from scaffold_cad.lattice.repetition import Window, further_layers
from scaffold_cad.lattice.unitcell import as_three
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.tiles.halo import chain_of_edges, with_halo
from scaffold_cad.tiles.tile import Tile

NEAR = 5.0
"""How far around a tile's own struts others are looked for that may touch them, in radii: bends
reach 4.3."""

NEAREST = 1.0
"""The same for thin struts, mm: more than the least gap of any process of printing."""

MANY = 100
"""Tiles of a skeleton above which they must have `FEWEST` struts, in the mean."""

FEWEST = 4
"""Struts of a tile: each is made with dozens around it, so that fewer take as long."""


class Source(Protocol):
    """What a tile can be made of, in another process too."""

    def made(self) -> Tile:
        """Return the tile."""


@dataclass(frozen=True, eq=False)
class Ready(Frozen):
    """A tile that is there already."""

    tile: Tile

    def made(self) -> Tile:
        """Return the tile."""
        return self.tile


@overload
def tiles(what: Skeleton, *, block: ArrayLike) -> SkeletonTiles: ...
@overload
def tiles(what: PeriodicLattice, *, block: ArrayLike) -> LatticeTiles: ...
@checks_keywords()
def tiles(what: Skeleton | PeriodicLattice, *, block: ArrayLike) -> SkeletonTiles | LatticeTiles:
    """Return a skeleton or a lattice as tiles, which are made one by one as they are asked for.

    A tile has struts of its own, and around them as many others as decide about the surface of its
    own: their branches to the ends, three stars more, and what is near in space. So its own struts
    and nodes have the same surface as in the whole, to the last bit, and no tile needs to know
    another: neither while it is made nor when surfaces are put together.

    Parameters
    ----------
    what : a skeleton as `check_skeleton` asks, or a lattice of any size
    block : size of a block, one number or three: of a skeleton mm, of a lattice whole cells.
        A strut belongs to the block in which its middle is, or the cell that owns it

    Raises
    ------
    OptionError
        If `what` is something else, or a size is not > 0, or so small that most of many tiles
        would have a strut or two.
    SkeletonError
        If the skeleton cannot be built on.

    Examples
    --------
    >>> from scaffold_cad import PeriodicLattice
    >>> from scaffold_cad.tiles import tiles
    >>> parts = tiles(PeriodicLattice("bcc", 5.0, 12, radius=0.4), block=4)
    >>> len(parts), sum(int(tile.own.sum()) for tile in parts)
    (27, 13824)
    """
    check_kind(what, Skeleton, PeriodicLattice)
    if isinstance(what, PeriodicLattice):
        x, y, z = three_counts(np.asarray(block).tolist()).tolist()
        return LatticeTiles(what, (x, y, z))
    check_skeleton(what)
    sizes = as_floats(block, "block size in mm", OptionError)
    parts = SkeletonTiles(what, as_three(np.broadcast_to(sizes, 3), "block size in mm"))
    if len(parts) > MANY and FEWEST * len(parts) > len(what.edges):
        raise OptionError(
            f"block={parts.block.min():g} (mm) makes {len(parts)} tiles of {len(what.edges)} "
            f"struts; need {block_size(what, FEWEST):.3g} mm or more, for {FEWEST} struts per tile"
        )
    return parts


def block_size(skeleton: Skeleton, struts: int) -> float:
    """Return the side of a cube that holds about `struts` struts of a skeleton, mm.

    As if struts were spread evenly in a box, or over a plane where that is flat.
    """
    sides = np.sort(np.ptp(skeleton.nodes, axis=0))[::-1]
    parts = len(skeleton.edges) / struts
    for count in (3, 2, 1):
        side = (np.prod(sides[:count]) / max(parts, 1.0)) ** (1.0 / count)
        if 0 < side <= sides[count - 1]:
            return float(side)
    return 2.0 * float(sides[0])


@checks_keywords()
@dataclass(frozen=True, eq=False)
class SkeletonTiles(Frozen):
    """The tiles of a skeleton."""

    skeleton: Skeleton
    """The whole."""
    block: Floats
    """Size of a block, shape (3,), mm."""

    def __str__(self) -> str:
        return f"SkeletonTiles: {len(self)}, of {self.skeleton}"

    def __len__(self) -> int:
        return int(self._tile_of_edge.max()) + 1

    def __iter__(self) -> Iterator[Tile]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, number: int) -> Tile:
        _check_number(number, len(self))
        return _tile(self.skeleton, self._chain, self._tile_of_edge == number, number)

    def source(self, number: int) -> Source:
        """Return what a tile can be made of in another process."""
        return Ready(self[number])

    @property
    def content(self) -> tuple[Any, ...]:
        """All that decides about the tiles, to be hashed."""
        of = self.skeleton
        return of.nodes, of.edges, of.radii, of.edge_radii, self.block

    @cached_property
    def _chain(self) -> Ints:
        return chain_of_edges(self.skeleton.chains, len(self.skeleton.edges))

    @cached_property
    def _tile_of_edge(self) -> Ints:
        """Tile of each edge, numbered by their blocks along z, y and x, shape (m,)."""
        ends = self.skeleton.nodes[self.skeleton.edges]
        middles = ends.mean(axis=1)
        place = np.floor((middles - middles.min(axis=0)) / self.block)
        _, tile = np.unique(place, axis=0, return_inverse=True)
        return tile.reshape(-1)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class LatticeTiles(Frozen):
    """The tiles of a lattice, of which nothing is made before."""

    lattice: PeriodicLattice
    """The whole."""
    block: tuple[int, int, int]
    """Cells along the sides of a block."""

    def __str__(self) -> str:
        return f"LatticeTiles: {len(self)}, of {self.lattice}"

    def __len__(self) -> int:
        x, y, z = (len(starts) for starts in self._starts)
        return x * y * z

    def __iter__(self) -> Iterator[Tile]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, number: int) -> Tile:
        return self.source(number).made()

    def source(self, number: int) -> LatticeBlock:
        """Return what a tile can be made of in another process: no strut."""
        _check_number(number, len(self))
        at = np.unravel_index(number, [len(starts) for starts in self._starts])
        low = [starts[k] for starts, k in zip(self._starts, at, strict=True)]
        # The last block has the layers that only close the far faces.
        high = [
            end if start + side >= count else start + side
            for start, side, count, end in zip(
                low, self.block, self.lattice.counts, self.lattice.layers, strict=True
            )
        ]
        return LatticeBlock(
            self.lattice, number, (low[0], low[1], low[2]), (high[0], high[1], high[2])
        )

    @property
    def content(self) -> tuple[Any, ...]:
        """All that decides about the tiles, to be hashed."""
        of, motif = self.lattice, self.lattice.cell.motif
        cell = (motif.sites, motif.struts, motif.moves, motif.copies)
        place = of.size, of.counts, of.radius, of.origin, of.axes
        return *cell, *place, of.strut_options, self.block

    @cached_property
    def _starts(self) -> list[list[int]]:
        pairs = zip(self.lattice.counts, self.block, strict=True)
        return [list(range(0, count, side)) for count, side in pairs]


@dataclass(frozen=True, eq=False)
class LatticeBlock(Frozen):
    """The cells of a lattice whose struts a tile owns."""

    lattice: PeriodicLattice
    number: int
    low: tuple[int, int, int]
    """First cell along each side."""
    high: tuple[int, int, int]
    """The cell after the last along each side."""

    def made(self) -> Tile:
        """Return the tile.

        Cells around the block are made until all stars are whole that the tile must have.
        """
        around = 2
        while True:
            low = [max(at - around, 0) for at in self.low]
            ends = zip(self.high, self.lattice.layers, strict=True)
            high = [min(at + around, end) for at, end in ends]
            window = self.lattice.window((low[0], low[1], low[2]), (high[0], high[1], high[2]))
            skeleton, own = self.lattice.part(window), self._own(window)
            whole = self._whole_stars(window)
            marks, inner = _marks(
                skeleton, chain_of_edges(skeleton.chains, len(skeleton.edges)), own
            )
            joints = np.zeros(len(inner), dtype=np.bool_)
            joints[skeleton.edges[marks]] = True
            joints &= skeleton.valency <= 2  # where branches end only because cells do
            if whole[inner].all() and self._holds(window, skeleton, own):
                ends_here = joints & ~whole
                if not ends_here.any() or around > 2 * max(self.lattice.layers):
                    options = self.lattice.strut_options
                    return _chosen(skeleton, marks, own, self.number, options)
            around *= 2

    def _own(self, window: Window) -> Bools:
        """Return whether the block's own cells own each strut of a window, (m,)."""
        cells = np.stack(np.unravel_index(window.owners, window.layers), axis=1) + window.low
        inside = (cells >= self.low) & (cells < self.high)
        return np.asarray(inside.all(axis=1))

    def _whole_stars(self, window: Window) -> Bools:
        """Return which nodes of a window have all their struts in it, (n,)."""
        keys, _ = window.used()
        place = keys // len(window.motif.sites)
        cells = np.stack(np.unravel_index(place, window.layers), axis=1)  # in the window
        further = further_layers(window.motif)
        owners = np.array(window.layers) - further
        starts = np.array(window.low) == 0
        ends = owners + window.low == self.lattice.layers
        fine = ((cells >= further) | starts) & ((cells < owners) | ends)
        return np.asarray(fine.all(axis=1))

    def _holds(self, window: Window, skeleton: Skeleton, own: Bools) -> bool:
        """Return whether all struts near the block's own ones are in a window."""
        lattice = self.lattice
        low, high = _box_around(skeleton, own)
        corners = np.array(list(product(*zip(low, high, strict=True))))  # (8, 3)
        cells = (corners - lattice.origin) @ np.linalg.inv(lattice.axes * lattice.size[:, None])
        further = further_layers(window.motif)
        first = np.array(window.low) + further  # struts of cells before reach in here
        owners = np.array(window.layers) - further
        last = np.array(window.low) + owners
        below = (np.floor(cells.min(axis=0)) >= first) | (np.array(window.low) == 0)
        above = (cells.max(axis=0) <= last) | (last == lattice.layers)
        return bool((below & above).all())


def _check_number(number: int, count: int) -> None:
    if not 0 <= number < count:
        raise IndexError(f"tile {number} of {count}; need 0 to {count - 1}")


def _tile(skeleton: Skeleton, chain: Ints, own: Bools, number: int) -> Tile:
    marks, _ = _marks(skeleton, chain, own)
    return _chosen(skeleton, marks, own, number)


def _chosen(
    skeleton: Skeleton,
    marks: Bools,
    own: Bools,
    number: int,
    options: Mapping[str, Any] | None = None,
) -> Tile:
    return Tile(number, skeleton.with_edges(marks), own[marks], options or {})


def _marks(skeleton: Skeleton, chain: Ints, own: Bools) -> tuple[Bools, Bools]:
    """Return the edges of the tile with own edges (m,), and the nodes that must be whole, (n,)."""
    ends = skeleton.nodes[skeleton.edges]
    low, high = _box_around(skeleton, own)
    reach = skeleton.edge_radii.max(axis=1)[:, None]
    near = (ends.min(axis=1) - reach <= high) & (ends.max(axis=1) + reach >= low)
    return with_halo(skeleton.edges, len(skeleton.nodes), chain, own | near.all(axis=1))


def _box_around(skeleton: Skeleton, own: Bools) -> tuple[Points, Points]:
    """Return the corners of the box around own struts and what may touch them, (3,), mm."""
    ends = skeleton.nodes[skeleton.edges[own]]
    reach = max(NEAR * float(skeleton.edge_radii[own].max()), NEAREST)
    return ends.min(axis=(0, 1)) - reach, ends.max(axis=(0, 1)) + reach
