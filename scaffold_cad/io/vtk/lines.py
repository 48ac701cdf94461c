"""Polylines of VTK files, as both of its kinds of files hold them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
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


def radii_among(data: Mapping[str, Floats]) -> Floats | None:
    """Return the radii among data of points or of cells by their names, flat, or None.

    Besides radii that are named so, those that a ``diameter`` or an ``area`` gives.
    """
    for name, values in data.items():
        numbers = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
        if numbers.shape[1] != 1:
            continue
        plain = name.strip().lower()
        if is_radii(plain):
            return numbers[:, 0]
        if plain == "diameter":
            return numbers[:, 0] / 2
        if plain in ("area", "a"):
            with np.errstate(invalid="ignore"):
                return np.sqrt(numbers[:, 0] / np.pi)
    return None


def is_radii(name: str) -> bool:
    """Return whether point data of this name are radii."""
    return name.strip().lower() in RADII


def checked(path: Path, lines: Lines, count: int) -> Lines:
    """Return `lines` if they end in order and pass through points 0..count-1.

    Raises
    ------
    FormatError
        If they do not.
    """
    total, ends = len(lines.connectivity), lines.ends
    if np.diff(ends, prepend=0).min(initial=0) < 0 or ends[-1:].sum() != total:
        raise FormatError(f"{path} has cells that end out of order; need ends up to {total}")
    bad = np.flatnonzero((lines.connectivity < 0) | (lines.connectivity >= count))
    if len(bad):
        found = f"{path} has a line through point {lines.connectivity[bad[0]]}"
        raise FormatError(f"{found}; need 0 to {count - 1}")
    return lines


def skeleton_of(
    points: Floats, lines: Lines, radii: Floats | None, of_lines: Floats | None = None
) -> RawSkeleton:
    """Return polylines, which were checked, as a graph.

    Parameters
    ----------
    radii : (n,) float64, of the points, or None
    of_lines : (c,) float64, of the polylines, or None
    """
    ahead = np.ones(len(lines.connectivity), dtype=np.bool_)
    ahead[lines.ends[np.diff(lines.ends, prepend=0) > 0] - 1] = False
    starts = np.flatnonzero(ahead)
    edges = np.stack([lines.connectivity[starts], lines.connectivity[starts + 1]], axis=1)
    if of_lines is None:
        return RawSkeleton(points, edges, radii)
    line = np.repeat(np.arange(len(lines.ends)), np.diff(lines.ends, prepend=0))
    return RawSkeleton(points, edges, radii, of_lines[line[starts]])


def line_cells(path: Path, cells: Lines, types: Ints) -> Lines:
    """Return those of `cells`, which were checked, that are lines."""
    if len(types) != len(cells.ends):
        raise FormatError(f"{path} has {len(types)} types of {len(cells.ends)} cells; need as many")
    counts = np.diff(cells.ends, prepend=0)
    kept = np.isin(types, LINE_CELLS)
    return Lines(cells.connectivity[np.repeat(kept, counts)], np.cumsum(counts[kept]))
