"""Systre files (.cgd): periodic nets, such as those of the database RCSR, as unit cells.

The groups of symmetry other than P1 come from the package gemmi.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import as_path, checks_keywords
from scaffold_cad.base.arrays import Edges, Floats, Ints, Points
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import reading
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.errors import FormatError, OptionError, SkeletonError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import as_count, line_error, read_text
from scaffold_cad.io.register import register_reader
from scaffold_cad.lattice import UnitCell

SAME_SITE = 2e-3
"""Distance below which two positions are one site, in lengths of the cell: files have 5 digits."""

UNIT_BOX = np.ones(3)
"""Periods along the sides of a cell."""

LARGEST = 1e6
"""Largest number of a cell or a position: what is larger leaves fewer than 5 digits of a site."""

IDENTITY = (np.eye(3), np.zeros(3))
"""The operation that leaves all as it is."""


@dataclass
class _Block:
    """What a block says of a net."""

    line: int
    name: str = "net"
    group: str = "P1"
    cell: list[float] = field(default_factory=list)
    nodes: dict[str, tuple[int, list[float]]] = field(default_factory=dict)
    edges: list[tuple[int, list[str]]] = field(default_factory=list)


@checks_keywords()
def read_nets(path: str | Path) -> list[UnitCell]:
    """Return the nets of a Systre file (.cgd) as unit cells, in their order.

    Blocks ``CRYSTAL`` are read, with ``NAME``, ``GROUP``, ``CELL``, ``NODE`` (or ``ATOM``) and
    ``EDGE``. Lengths are taken over as proportions, so that a cell of size 10 is 10 mm along a.

    Raises
    ------
    FormatError
        If the file cannot be read, a line is not what it must be, there is no net, or a node has
        another number of edges than the file says.
    SkeletonError
        If a net cannot be a lattice: two of its struts leave a node in one direction, or overlap.
    MissingBackendError
        If a group is not P1 and gemmi is not installed.
    """
    source = as_path(path)
    with reading(source):
        blocks = _blocks(source)
    nets = [_net(source, block) for block in blocks]
    if not nets:
        raise FormatError(f"{source} has no block CRYSTAL; need one")
    return nets


def _recognizes(head: bytes) -> bool:
    words = head.split(None, 1)
    return bool(words) and words[0].upper() == b"CRYSTAL"


@register_reader("Systre net", ".cgd", recognizes=_recognizes)
def read_cgd(path: Path) -> RawSkeleton:
    """Read one cell of the first net; lengths are taken as mm, struts through its faces are whole.

    `read_nets` returns the nets as unit cells, to be tiled.
    """
    blocks = _blocks(path)
    if not blocks:
        raise FormatError(f"{path} has no block CRYSTAL; need one")
    cell = _net(path, blocks[0])
    nodes = cell.nodes * cell.proportions @ cell.axes * blocks[0].cell[0]
    return RawSkeleton(nodes, cell.edges, None)


def _blocks(path: Path) -> list[_Block]:
    """Return what the blocks of a file say."""
    blocks: list[_Block] = []
    block: _Block | None = None
    for number, text in enumerate(read_text(path).split("\n"), start=1):
        words = text.split("#")[0].split()
        if not words:
            continue
        keyword = words[0].upper()
        if keyword == "CRYSTAL":
            block = _Block(number)
            blocks.append(block)
        elif keyword == "END" or block is None:
            block = None
        else:
            _take(path, block, number, keyword, words[1:])
    return blocks


def _take(path: Path, block: _Block, line: int, keyword: str, words: list[str]) -> None:
    """Take over what a line of a block says; others than these say nothing of the net."""
    if keyword in ("NAME", "ID") and words:
        block.name = " ".join(words)
    elif keyword == "GROUP" and words:
        block.group = "".join(words)
    elif keyword == "CELL":
        block.cell = _numbers(path, line, words, 6, "a, b, c, alpha, beta, gamma")
        if min(block.cell) < 1 / LARGEST:
            raise line_error(path, line, " ".join(words), f"numbers of at least {1 / LARGEST:g}")
    elif keyword in ("NODE", "ATOM"):
        valency = as_count(words[1]) if len(words) == 5 else None
        if valency is None:
            raise line_error(path, line, f"{' '.join(words)!r}", "name, valency, x, y, z")
        place = _numbers(path, line, words[2:], 3, "x, y, z of a node")
        block.nodes[words[0]] = (valency, place)
    elif keyword == "EDGE":
        block.edges.append((line, words))


def _numbers(path: Path, line: int, words: list[str], count: int, need_: str) -> list[float]:
    """Return words as numbers, fractions such as 1/3 among them."""
    values = [_number(word) for word in words]
    # What is not a number is NaN, which no comparison holds for.
    if len(values) != count or not all(abs(value) <= LARGEST for value in values):
        needed = f"{count} numbers of at most {LARGEST:g}: {need_}"
        raise line_error(path, line, f"{' '.join(words)!r}", needed)
    return values


def _number(word: str) -> float:
    """Return a word as a number; NaN if it is not one."""
    above, slash, below = word.partition("/")
    try:
        return float(above) / float(below) if slash else float(above)
    except (ValueError, ZeroDivisionError):
        return float("nan")


def _net(path: Path, block: _Block) -> UnitCell:
    """Return a block's net."""
    where = f"{path}: net {block.name!r}"
    if len(block.cell) != 6 or not block.nodes or not block.edges:
        raise FormatError(f"{where} of line {block.line} has no CELL, NODE or EDGE; need all")
    operations = _operations(where, block.group)
    starts = np.array([place for _, place in block.nodes.values()])
    images = np.concatenate([starts @ turn.T + move for turn, move in operations])
    kind = np.tile(np.arange(len(starts)), len(operations))
    sites, of_image = _distinct(images)
    ends = np.array([_ends(path, block, line, words) for line, words in block.edges])  # (e, 2, 3)
    copies = np.concatenate([ends @ turn.T + move for turn, move in operations])
    edges, moves = _edges(where, sites, copies)
    _check_valency(where, block, edges, kind, of_image)
    a = block.cell[0]
    try:
        return UnitCell.of_net(
            block.name,
            sites,
            edges,
            moves,
            f"Net of {counted(len(sites), 'node')}, group {block.group}.",
            proportions=np.array(block.cell[:3]) / a,
            angles=np.radians(block.cell[3:]),
        )
    except OptionError as error:
        raise FormatError(f"{path}: {error}") from None
    except SkeletonError as error:
        raise SkeletonError(f"{path}: {error}") from None


def _ends(path: Path, block: _Block, line: int, words: list[str]) -> Points:
    """Return both ends of an edge, each a name or three numbers, (2, 3)."""
    rest, ends = list(words), []
    for _ in range(2):
        if rest and rest[0] in block.nodes and len(rest) not in (3, 6):
            ends.append(block.nodes[rest.pop(0)][1])
        else:
            ends.append(_numbers(path, line, rest[:3], 3, "x, y, z of the end of an edge"))
            rest = rest[3:]
    if rest:
        raise line_error(path, line, f"{' '.join(words)!r}", "two ends, names or x, y, z")
    return np.array(ends)


def _operations(where: str, group: str) -> list[tuple[Floats, Floats]]:
    """Return the operations of a group of symmetry: a matrix (3, 3) and a move (3,) each.

    Where tables have two origins the one at a center of symmetry is meant, as in files of RCSR.
    """
    if group.upper() == "P1":
        return [IDENTITY]
    need("gemmi", f"the group of symmetry {group}")
    import gemmi

    second = None if ":" in group else gemmi.find_spacegroup_by_name(f"{group}:2")
    found = second or gemmi.find_spacegroup_by_name(group)
    if found is None:
        raise FormatError(f"{where} has the group {group!r}; need one of the 230 space groups")
    unit = gemmi.Op.DEN
    return [(np.array(op.rot) / unit, np.array(op.tran) / unit) for op in found.operations()]


def _distinct(places: Points) -> tuple[Points, Ints]:
    """Return the distinct places modulo 1 (k, 3), the mean of those that are one, and of which."""
    wrapped = places % 1.0 % 1.0  # a little below 0 is 1 after the first
    tree = cKDTree(wrapped, boxsize=UNIT_BOX)
    label = component_labels(tree.query_pairs(SAME_SITE, output_type="ndarray"), len(wrapped))
    _, first, site = np.unique(label, return_index=True, return_inverse=True)
    near = wrapped - np.rint(wrapped - wrapped[first][site])  # beside the first of each
    means = sums_by_row(near, site, len(first)) / np.bincount(site)[:, None]
    return means % 1.0 % 1.0, site


def _edges(where: str, sites: Points, ends: Points) -> tuple[Edges, Ints]:
    """Return the distinct pairs of sites (m, 2) that edges (k, 2, 3) join, and moves (m, 3)."""
    flat = ends.reshape(-1, 3)
    gaps, site = cKDTree(sites, boxsize=UNIT_BOX).query(flat % 1.0 % 1.0)
    lost = np.flatnonzero(gaps > 2 * SAME_SITE)
    if len(lost):
        place = np.round(flat[lost[0]], 5).tolist()
        raise FormatError(f"{where} has an edge that ends at {place}, where no node is; need one")
    cell = np.rint(flat - sites[site]).astype(np.intp).reshape(-1, 2, 3)
    pairs = site.astype(np.intp).reshape(-1, 2)
    moves = cell[:, 1] - cell[:, 0]
    rows = np.concatenate([pairs, moves], axis=1)
    back = np.concatenate([pairs[:, ::-1], -moves], axis=1)
    ordered = [min(a, b) for a, b in zip(rows.tolist(), back.tolist(), strict=True)]
    unique = np.unique(np.array(ordered, dtype=np.intp), axis=0)
    return unique[:, :2], unique[:, 2:]


def _check_valency(where: str, block: _Block, edges: Edges, kind: Ints, of_image: Ints) -> None:
    """Raise where a site has another number of edges than the file gives its node."""
    valency = np.bincount(edges.reshape(-1), minlength=int(of_image.max()) + 1)
    wanted = np.array([count for count, _ in block.nodes.values()])
    wrong = np.flatnonzero(valency[of_image] != wanted[kind])
    if len(wrong):
        name = list(block.nodes)[kind[wrong[0]]]
        found, said = valency[of_image[wrong[0]]], wanted[kind[wrong[0]]]
        raise FormatError(f"{where}: node {name} has {found} edges; need {said}, as the file says")
