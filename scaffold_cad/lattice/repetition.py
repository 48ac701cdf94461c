"""Struts of a repeated unit cell. Nodes are numbered by cell and site: no search, no tolerance."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats, Ints, Points
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.motifs import Motif
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.lattice.unitcell import UnitCell

MOST_STRUTS = 100_000_000
"""Most struts of a lattice: they alone take some 6 GB, and a scaffold of them 100 times that."""


def as_counts(cell: UnitCell, counts: Floats | Ints) -> tuple[int, int, int]:
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
    counts: tuple[int, int, int],
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
    motif = cell.motif
    # Sites on far faces, and those of struts through them, belong to further layers of cells.
    further = max(int(motif.moves.max(initial=0)), 1)
    layers = (counts[0] + further, counts[1] + further, counts[2] + further)
    keys = _strut_keys(motif, counts, layers)  # (m, 2)
    used = np.zeros(layers[0] * layers[1] * layers[2] * len(motif.sites), dtype=np.bool_)
    used[keys] = True
    edges = (np.cumsum(used) - 1)[keys]
    place, site = np.divmod(np.flatnonzero(used), len(motif.sites))
    steps = np.stack(np.unravel_index(place, layers), axis=1)  # (n, 3)
    nodes = (steps + motif.sites[site]) * size
    frame = cell.axes if axes is None else axes
    if not np.array_equal(frame, np.eye(3)):
        nodes = nodes @ frame
    return Struts(nodes if origin is None else nodes + origin, edges)


def _strut_keys(motif: Motif, counts: tuple[int, int, int], layers: tuple[int, int, int]) -> Edges:
    """Return both ends of all struts as cell · sites + site, (m, 2)."""
    strides = np.array([layers[1] * layers[2], layers[2], 1])
    cells, keys = [], []
    for sites, moves, copies in zip(motif.struts, motif.moves, motif.copies, strict=True):
        cell = _cells_with_strut(copies, counts, layers)  # (k,)
        cells.append(cell)
        keys.append((cell[:, None] + moves @ strides) * len(motif.sites) + sites)
    # Neighbors in space stay neighbors in memory; the runs are sorted already.
    order = np.argsort(np.concatenate(cells), kind="stable")
    return np.concatenate(keys)[order]


def _cells_with_strut(
    copies: np.ndarray, counts: tuple[int, int, int], layers: tuple[int, int, int]
) -> Ints:
    """Return the cells in which a strut occurs, for one of the cells around lists it, ascending."""
    occurs = np.zeros(layers, dtype=np.bool_)
    for i, j, k in np.argwhere(copies).tolist():
        occurs[i : i + counts[0], j : j + counts[1], k : k + counts[2]] = True
    return np.flatnonzero(occurs)
