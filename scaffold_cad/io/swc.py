"""SWC: reconstructed neurons, one sample per line, each with a radius and its parent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import (
    LARGEST_WHOLE,
    Row,
    first_words,
    float_columns,
    is_number,
    line_error,
    read_rows,
)
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer
from scaffold_cad.skeleton import Skeleton

_NEED = "a sample: number, type, x, y, z, radius, parent"


def _recognizes(head: bytes) -> bool:
    words = first_words(head)
    lines = [line.strip() for line in head.splitlines()]
    # In TGF a line # ends the nodes; here it is a comment, mostly before them.
    is_tgf = b"#" in lines and not lines[0].startswith(b"#")
    return not is_tgf and (
        len(words) >= 7
        and all(is_number(word) for word in words[:7])
        and all(words[k].removeprefix("-").isdigit() for k in (0, 1, 6))
    )


@register_reader("SWC", ".swc", recognizes=_recognizes)
def read_swc(path: Path) -> RawSkeleton:
    """Read an SWC file: a node a sample, an edge from each sample to its parent.

    Positions and radii are taken as mm, whatever they measure (most files: µm). Parent -1 begins
    a tree, of which there may be several; types are ignored, and the soma is a node as any other.
    """
    rows = read_rows(path)
    if not rows:
        raise FormatError(f"{path} holds no line but comments; need {_NEED}")
    table = float_columns(path, rows, 0, 7, _NEED)
    edges = _edges(path, rows, table[:, 0], table[:, 6])
    # Our own files say that they are in mm; those of others are in µm.
    usual = None if b"# unit: mm" in path.read_bytes()[:200] else "um"
    return RawSkeleton(table[:, 2:5], edges, table[:, 5], usual_unit=usual)


def _edges(path: Path, rows: list[Row], number: Floats, parent: Floats) -> Edges:
    """Return the node pairs parent and child, in order of the children, shape (m, 2)."""
    for column in (number, parent):
        whole = (np.abs(column) < LARGEST_WHOLE) & (column == np.round(column))
        _refuse(path, rows, ~whole, "{} is not the number of a sample", column, "a whole number")
    order = np.argsort(number, kind="stable")
    ordered = number[order]
    repeated = np.zeros(len(number), dtype=np.bool_)
    repeated[order[1:]] = ordered[1:] == ordered[:-1]
    _refuse(path, rows, repeated, "sample {} is there already", number, "each number once")

    child: Ints = np.flatnonzero(parent >= 0)
    at = np.searchsorted(ordered, parent[child]).clip(max=len(ordered) - 1)
    lost = np.zeros(len(number), dtype=np.bool_)
    lost[child] = ordered[at] != parent[child]
    _refuse(path, rows, lost, "no sample is the parent {}", parent, "-1 or a sample's number")
    return np.stack([order[at], child], axis=1)


def _refuse(
    path: Path, rows: list[Row], bad: Bools, found: str, column: Floats, needed: str
) -> None:
    """Raise for the first row marked in `bad`, with its value of `column` in `found`."""
    where = np.flatnonzero(bad)
    if len(where):
        value = f"{column[where[0]]:.15g}"
        raise line_error(path, rows[where[0]][0], found.format(value), needed)


DENDRITE = 3
"""Type of every sample: a skeleton knows no soma and no axon."""


@register_writer(".swc", name="SWC", solids=False, radii="nodes")
def write_swc_content(content: Content, path: Path) -> None:
    """Write the Skeleton that `write` is given."""
    write_swc(content.skeleton("an SWC file"), path, content.unit)


def write_swc(skeleton: Skeleton, path: Path, unit: str = "mm") -> None:
    """Write the nodes, exact to the last bit, in mm; edges turn so that parents come first.

    Each component begins with its first node, and samples follow in order of their distance
    from it, which many readers of SWC ask for.

    Raises
    ------
    FormatError
        If the skeleton has a loop.
    """
    if skeleton.loop_count:
        raise FormatError(
            f"SWC holds trees only; the skeleton has {counted(skeleton.loop_count, 'loop')}"
        )
    order, parent = _walk(skeleton)
    number = np.empty(len(order), dtype=np.intp)
    number[order] = np.arange(1, len(order) + 1)
    parents = np.where(parent < 0, -1, number[parent])[order]
    rows = zip(
        skeleton.nodes[order].tolist(),
        skeleton.radii[order].tolist(),
        parents.tolist(),
        strict=True,
    )
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"# scaffold_cad\n# unit: {unit}\n# number type x y z radius parent\n")
        file.writelines(
            f"{k} {DENDRITE} {x!r} {y!r} {z!r} {radius!r} {up}\n"
            for k, ((x, y, z), radius, up) in enumerate(rows, start=1)
        )


def _walk(skeleton: Skeleton) -> tuple[Ints, Ints]:
    """Return the nodes, parents before children, and the parent of each, -1 without one."""
    count = len(skeleton.nodes)
    ends = (skeleton.edges[:, 0], skeleton.edges[:, 1])
    roads = coo_array((np.ones(len(skeleton.edges)), ends), shape=(count, count)).tocsr()
    _, roots = np.unique(skeleton.component_of_node, return_index=True)
    orders, parent = [], np.full(count, -1, dtype=np.intp)
    for root in roots.tolist():
        order, before = breadth_first_order(roads, root, directed=False)
        orders.append(order)
        parent[order[1:]] = before[order[1:]]
    return np.concatenate([np.zeros(0, dtype=np.intp), *orders]), parent
