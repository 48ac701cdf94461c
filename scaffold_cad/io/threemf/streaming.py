"""3MF files of lattices that no memory holds: beams made, written and forgotten layer by layer.

`write_lattice` writes all beams of one object, whose vertices come first: so the layers are made
twice. `write_repeated` writes one block of cells, and where it is repeated.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, product
from os import PathLike
from pathlib import Path
from typing import IO

import numpy as np

from scaffold_cad.base.arguments import as_count, as_path, check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Edges, Floats, Points
from scaffold_cad.base.files import replacing
from scaffold_cad.base.radii import radii_at
from scaffold_cad.errors import FormatError
from scaffold_cad.io._rows import Columns, decimal, rows_of, whole
from scaffold_cad.io.threemf.model import BEAM_LATTICE, CORE
from scaffold_cad.io.threemf.package import model_part, vertex_rows
from scaffold_cad.io.threemf.writing import SHORTEST_BEAM, check_sizes, decimals_of
from scaffold_cad.lattice.periodic import PeriodicLattice
from scaffold_cad.lattice.repetition import Window, further_layers

AT_ONCE = 200_000
"""Struts made at once, at least a layer of cells: what is worked on stays small."""

MOST_VERTICES = 2**31 - 1
"""Vertices that a 3MF object may have."""

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<model xmlns="{CORE}" xmlns:b="{BEAM_LATTICE}" unit="millimeter" xml:lang="en-US" '
    'requiredextensions="b">\n<resources>\n'
)


def write_lattice(lattice: PeriodicLattice, path: Path) -> None:
    """Write all beams of a lattice as one object, with the memory of a few layers of cells.

    Layers are those along the lattice's first side. Coordinates and radii have six decimals, or
    as many as tell 32-bit coordinates apart.

    Raises
    ------
    FormatError
        If a radius is too small for that, or there are more vertices than a 3MF object may have.
    """
    _, y, z = lattice.layers
    deep = max(1, AT_ONCE // max(lattice.cell.strut_count * y * z, 1))
    slabs = [(at, min(at + deep, lattice.layers[0])) for at in range(0, lattice.layers[0], deep)]
    decimals = decimals_of(_extent(lattice))
    with model_part(path, _HEAD) as file:
        first = np.zeros(len(slabs) + 1, dtype=np.int64)  # vertices before each slab
        file.write(b'<object id="1" type="model"><mesh>\n<vertices>\n')
        for number, (low, high) in enumerate(slabs):
            slab = _Slab.of(lattice, low, high)
            first[number + 1] = first[number] + slab.own_vertices
            if first[number + 1] > MOST_VERTICES:
                raise FormatError(
                    f"the lattice has more than {MOST_VERTICES} nodes; a 3MF object holds no more "
                    "(larger or fewer cells, or `write_repeated`)"
                )
            file.write(vertex_rows(slab.positions[: slab.own_vertices], decimals))
        file.write(b"</vertices>\n<triangles/>\n")
        file.write(_lattice_start(lattice))
        for number, (low, high) in enumerate(slabs):
            slab = _Slab.of(lattice, low, high)
            file.write(_beams(slab.edges, slab.radii, int(first[number]), decimals))
        file.write(b"</b:beams></b:beamlattice></mesh></object>\n")
        file.write(b'</resources>\n<build><item objectid="1"/></build>\n')


@checks_keywords()
def write_repeated(lattice: PeriodicLattice, path: str | PathLike[str], *, block: int = 10) -> None:
    """Write a lattice as a 3MF file of blocks: each kind once, and where it is repeated.

    Beams of different blocks meet at equal places but share no vertices. The file is written whole
    or not at all.

    Parameters
    ----------
    lattice : its radius is one number
    path : of the file
    block : cells along each side of a block

    Raises
    ------
    FormatError
        If radii differ from place to place, or are too small for six decimals; or the file cannot
        be written.
    OptionError
        If `lattice` is not a PeriodicLattice, or `block` is not a whole number > 0.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from scaffold_cad import PeriodicLattice
    >>> from scaffold_cad.io import write_repeated
    >>> lattice = PeriodicLattice("bcc", 1.0, 100, radius=0.1)
    >>> with TemporaryDirectory() as folder:
    ...     write_repeated(lattice, Path(folder, "a.3mf"), block=20)
    ...     Path(folder, "a.3mf").stat().st_size < 1_000_000  # of 8 million beams
    True
    """
    check_kind(lattice, PeriodicLattice)
    block = as_count(block, "block", 1)
    if callable(lattice.radius):
        raise FormatError(
            "radius is a function; need one number, for blocks are repeated (or write all beams)"
        )
    sides = [_intervals(lattice, axis, block) for axis in range(3)]
    numbers: dict[tuple[tuple[int, int, int], ...], int] = {}
    places: list[tuple[int, Points]] = []
    decimals = decimals_of(_extent(lattice))
    with replacing(as_path(path)) as fresh, model_part(fresh, _HEAD) as file:
        for spans in product(*sides):
            low, high = (tuple(span.bounds[side] for span in spans) for side in (0, 1))
            kind = tuple(span.kind for span in spans)
            if kind not in numbers:
                numbers[kind] = _write_block(lattice, low, high, len(numbers) + 1, decimals, file)
            if numbers[kind]:
                shift = (np.array(low) * lattice.size) @ lattice.axes + lattice.origin
                places.append((numbers[kind], shift))
        whole_id = len(numbers) + 1
        file.write(b'<object id="%d" type="model"><components>\n' % whole_id)
        for number in sorted({number for number, _ in places}):
            rows = np.array([shift for other, shift in places if other == number])
            start = b'<component objectid="%d" transform="1 0 0 0 1 0 0 0 1 ' % number
            x, y, z = (decimal(rows[:, axis], decimals) for axis in range(3))
            file.write(rows_of(start, x, b" ", y, b" ", z, b'"/>\n'))
        file.write(b"</components></object>\n</resources>\n")
        file.write(b'<build><item objectid="%d"/></build>\n' % whole_id)


@dataclass(frozen=True)
class _Interval:
    """Layers of cells along a side of a block."""

    bounds: tuple[int, int]
    """First layer, and the one after the last."""
    kind: tuple[int, int, int]
    """Equal for intervals that own the same struts: their length, and what is beyond them."""


def _intervals(lattice: PeriodicLattice, axis: int, block: int) -> list[_Interval]:
    count, end = lattice.counts[axis], lattice.layers[axis]
    cuts = sorted({*range(0, count, block), count, end})
    # A cell owns what it lists, and what the cell before it lists on its far face; mostly the same.
    alone = not lattice.cell.motif.copies[:, 0, 0, 0].all()
    return [
        _Interval((low, high), (high - low, int(alone and low == 0), max(high - count, 0)))
        for low, high in pairwise(cuts)
    ]


def _write_block(
    lattice: PeriodicLattice,
    low: tuple[int, ...],
    high: tuple[int, ...],
    number: int,
    decimals: int,
    file: IO[bytes],
) -> int:
    """Write a block as an object from its own corner; return its number, 0 if it has no strut."""
    x, y, z = low
    window = lattice.window((x, y, z), (high[0], high[1], high[2]))
    if len(window.keys) == 0:
        return 0
    keys, edges = window.used()
    corner = np.array(low) * lattice.size @ lattice.axes + lattice.origin
    file.write(b'<object id="%d" type="model"><mesh>\n<vertices>\n' % number)
    file.write(vertex_rows(lattice.positions(window, keys) - corner, decimals))
    file.write(b"</vertices>\n<triangles/>\n" + _lattice_start(lattice))
    file.write(_beams(edges, None, 0, decimals))
    file.write(b"</b:beams></b:beamlattice></mesh></object>\n")
    return number


@dataclass(frozen=True, eq=False)
class _Slab:
    """The struts of some layers of cells, and the nodes of these layers and of those they reach."""

    positions: Points
    """Of the nodes, in the lattice's order, shape (n, 3), mm."""
    own_vertices: int
    """How many of them, the first ones, are in these layers."""
    edges: Edges
    """Nodes of each strut, shape (m, 2)."""
    radii: Floats | None
    """Radius of each node, shape (n,), mm; None if all have one."""

    @staticmethod
    def of(lattice: PeriodicLattice, low: int, high: int) -> _Slab:
        """Return the slab of layers from `low` to before `high`."""
        further = further_layers(lattice.cell.motif)
        _, y, z = lattice.layers
        before = min(further, low)
        beyond = min(further, lattice.layers[0] - high)
        # A node of the last layer reached may be used by struts further on only.
        around = lattice.window((low - before, 0, 0), (high + beyond, y, z))
        marks = _in_layers(around, around.marks())
        marks[:before] = False
        marks[before + high - low + further :] = False
        own = int(np.count_nonzero(marks[: before + high - low]))
        flat = marks.reshape(-1)
        keys = np.flatnonzero(flat)
        numbers = np.cumsum(flat) - 1
        layer = around.owners // (around.layers[1] * around.layers[2])
        mine = (layer >= before) & (layer < before + high - low)
        positions = lattice.positions(around, keys)
        radii = None
        if callable(lattice.radius):
            radii = np.broadcast_to(radii_at(positions, lattice.radius), len(positions))
            check_sizes(radii, "of the lattice has radius")
        return _Slab(positions, own, numbers[around.keys[mine]], radii)


def _in_layers(window: Window, marks: Bools) -> Bools:
    """Return what is known of each key by layer along the first side, (layers, keys of one)."""
    return marks.reshape(window.layers[0], -1)


def _extent(lattice: PeriodicLattice) -> float:
    """Return the greatest coordinate of the lattice's block, mm."""
    corners = np.array(list(product(*((0, count) for count in lattice.layers))))
    return float(np.abs((corners * lattice.size) @ lattice.axes + lattice.origin).max())


def _beams(edges: Edges, radii: Floats | None, first: int, decimals: int) -> bytes:
    """Return the rows of beams between nodes of which the first has the number `first`."""
    if len(edges) == 0:
        return b""
    ends: list[bytes | Columns] = [b'<b:beam v1="', whole(edges[:, 0] + first)]
    ends += [b'" v2="', whole(edges[:, 1] + first)]
    if radii is not None:
        ends += [b'" r1="', decimal(radii[edges[:, 0]], decimals)]
        ends += [b'" r2="', decimal(radii[edges[:, 1]], decimals)]
    return rows_of(*ends, b'"/>\n')


def _lattice_start(lattice: PeriodicLattice) -> bytes:
    """Return the start of the beams, with their radius or, where it varies, any of them."""
    radius = np.broadcast_to(radii_at(lattice.origin[None], lattice.radius), 1)
    if not callable(lattice.radius):
        check_sizes(radius, "of the lattice has radius")
    return (
        f'<b:beamlattice radius="{float(radius[0]):.9g}" minlength="{SHORTEST_BEAM:.6f}" '
        'cap="sphere"><b:beams>\n'
    ).encode()
