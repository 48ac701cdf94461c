"""What hangs loose in a filled region: pieces of less than half a cell's struts."""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Points, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.lattice.unitcell import UnitCell

CRUMB = 0.5
"""Strut length below which a loose piece is a crumb: in those of a cell, and of the largest piece.
"""

_log = logging.getLogger(__name__)


def without_crumbs(struts: Struts, cell: UnitCell, size: Floats) -> Struts:
    """Return the struts without loose pieces that are mere crumbs; the log says how many they were.

    Parameters
    ----------
    cell, size : that the struts are of; size (3,), mm
    """
    return struts.kept(no_crumbs(struts.edges, struts.lengths, struts.middles, cell, size))


def no_crumbs(
    edges: Edges, lengths: Floats, middles: Points, cell: UnitCell, size: Floats
) -> Bools:
    """Return which struts are in no crumb, (m,); the log says how many are.

    Parameters
    ----------
    edges : (m, 2) intp
    lengths : of the struts, as in cells of `size`, (m,) float64
    middles : (m, 3) float64, mm
    """
    if len(edges) == 0:
        return np.ones(0, dtype=np.bool_)
    piece = component_labels(edges, int(edges.max()) + 1)[edges[:, 0]]
    total = np.bincount(piece, weights=lengths)
    least = CRUMB * min(float(cell.strut_lengths(size).sum()), float(total.max()))
    keep: Bools = total[piece] >= least
    if not keep.all():
        lost = np.unique(piece[~keep])
        place = place_text(middles[~keep][0])
        _log.info(
            "%s of %s left out, as at %s: cut off by the surface",
            counted(len(lost), "loose crumb"),
            counted(len(keep) - int(keep.sum()), "strut"),
            place,
        )
    return keep


def report_small(bounds: Floats, cell: UnitCell, size: Floats) -> None:
    """Log where a region is smaller than a cell."""
    extent = bounds[1] - bounds[0]
    small = extent < size * (1 - 1e-6)
    if not small.any():
        return
    _log.log(
        logging.WARNING if small.all() else logging.INFO,
        "the region, %s mm, is smaller than a cell of %r, %s mm, along %s",
        " x ".join(f"{one:.4g}" for one in extent),
        cell.name,
        " x ".join(f"{one:.4g}" for one in size),
        " and ".join(axis for axis, is_small in zip("xyz", small, strict=True) if is_small),
    )
