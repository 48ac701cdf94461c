"""VTK: lines of poly data and unstructured grids, in legacy files (.vtk) and XML (.vtp, .vtu).

Both are read here, not by VTK: its readers end the process on files that are damaged.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scaffold_cad.arrays import Floats, Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton

RADII = ("radius", "radii", "maximuminscribedsphereradius")
"""Names of point data, without regard to case, that hold radii; the last is VMTK's."""

LINE_CELLS = (3, 4)
"""Types of cells that are lines: a line and a polyline."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Polylines through points that they share."""

    connectivity: Ints
    """Points of one polyline after the other, shape (k,)."""
    ends: Ints
    """Where each polyline ends in `connectivity`, shape (c,)."""


def is_radii(name: str) -> bool:
    """Return whether point data of this name are radii."""
    return name.strip().lower() in RADII


def skeleton_of(path: Path, points: Floats, lines: Lines, radii: Floats | None) -> RawSkeleton:
    """Return polylines as a graph.

    Raises
    ------
    FormatError
        If a polyline ends before it begins, or names a point that isn't there.
    """
    total, ends = len(lines.connectivity), lines.ends
    if len(ends) and (np.diff(ends, prepend=0).min() < 0 or ends[-1] != total):
        raise FormatError(f"{path} has lines that end out of order; need ends up to {total}")
    ahead = np.ones(total, dtype=np.bool_)
    ahead[ends[np.diff(ends, prepend=0) > 0] - 1] = False
    starts = np.flatnonzero(ahead)
    edges = np.stack([lines.connectivity[starts], lines.connectivity[starts + 1]], axis=1)
    return RawSkeleton(points, edges, radii)


def line_cells(path: Path, lines: Lines, types: Ints) -> Lines:
    """Return the cells that are lines."""
    if len(types) != len(lines.ends):
        raise FormatError(f"{path} has {len(types)} types of {len(lines.ends)} cells; need as many")
    counts = np.diff(lines.ends, prepend=0)
    if (counts < 0).any() or counts.sum() != len(lines.connectivity):
        raise FormatError(f"{path} has cells that end out of order; need ends in order")
    kept = np.isin(types, LINE_CELLS)
    return Lines(lines.connectivity[np.repeat(kept, counts)], np.cumsum(counts[kept]))
