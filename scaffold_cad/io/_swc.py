"""SWC: reconstructed neurons, one sample a line, each with a radius and its parent."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.io._formats import register_reader
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

_NEED = "a sample: number, type, x, y, z, radius, parent"


def _recognises(head: bytes) -> bool:
    words = first_words(head)
    return (
        len(words) >= 7
        and all(is_number(word) for word in words[:7])
        and all(words[k].removeprefix("-").isdigit() for k in (0, 1, 6))
    )


@register_reader("SWC", ".swc", recognises=_recognises)
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
    return RawSkeleton(table[:, 2:5], edges, table[:, 5])


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
