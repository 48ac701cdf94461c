"""Zones: the pieces of curves that are part of a field, up to joints at which curves go on.

What is crowded of a curve is a field, and so are the pieces beside it, as far as a cut takes. Where
the zone ends, at a joint, the field's strut runs straight along the axis of the joint's circle to
its cut, and a short straight strut leads from there to the circle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.solid.clusters.spans import CUT
from scaffold_cad.struts.curves.curve import Curves
from scaffold_cad.struts.curves.cuts import CutCurves, chains_left, neighbors
from scaffold_cad.struts.runs import Runs

MARGIN = 2.0 * CUT
"""Length of curve beside what is crowded that is part of a field at least, in radii."""

BEHIND = 0.3
"""How far behind the base of a cut a joint is at least from which an axis leads to it, in radii."""

LEAST_KEPT = 3.0
"""Least length of curve between two zones, in radii: else they are one."""


@dataclass(frozen=True, eq=False)
class Zones(Frozen):
    """The pieces of curves that are part of a field."""

    pieces: Bools
    """Shape (p,)."""
    nodes: Bools
    """Joints all of whose pieces are, shape (n,)."""

    def runs(self, curves: Curves) -> Bools:
        """Return the runs that are curved from end to end and part of a field, (k,)."""
        found = np.zeros_like(curves.curved)
        found[curves.run[curves.pieces[self.pieces]]] = True
        return found & curves.curved


def core_of(curves: Curves, nodes: Bools) -> Bools:
    """Return the pieces that come to one of `nodes` (n,), shape (p,)."""
    ends = _joints(curves)
    return np.asarray((nodes[ends] & (ends >= 0)).any(axis=1))


def zones_of(curves: Curves, core: Bools, count: int, others: Bools) -> Zones:
    """Return the zones around pieces (p,).

    Parameters
    ----------
    count : of nodes
    others : (p,) pieces that are in zones too, without what is beside them
    """
    torn = np.unique(curves.curve_of_piece[core & np.isfinite(curves.tori)[curves.curve_of_piece]])
    core = core | np.isin(curves.curve_of_piece, torn)
    ends, sizes = _joints(curves), _sizes(curves)
    # Pieces between a joint and a straight strut take no cut: there the field follows the strut.
    lone = (ends < 0).any(axis=1)
    inside = core | (_distances(curves, core, np.where(lone, 0.0, sizes)) < MARGIN)
    inside |= others
    inside |= _short(curves, inside, sizes)
    outside, touched = np.zeros((2, count + 1), dtype=np.bool_)
    outside[ends[~inside]], touched[ends[inside]] = True, True
    return Zones(inside, (touched & ~outside)[:-1])


def _distances(curves: Curves, core: Bools, sizes: Floats) -> Floats:
    """Return how far pieces are from those of the core, up to `MARGIN`, in radii, (p,)."""
    found = np.where(core, 0.0, np.inf)
    sides = neighbors(curves)
    while True:
        beyond = np.where(core, 0.0, found + sizes)
        nearer = found
        for side in sides:
            nearer = np.minimum(nearer, np.where(side >= 0, beyond[side], np.inf))
        nearer = np.where(nearer < MARGIN, nearer, np.inf)
        if np.array_equal(nearer, found):
            return found
        found = nearer


def _short(curves: Curves, inside: Bools, sizes: Floats) -> Bools:
    """Return the pieces that are left between two zones with too little room, (p,)."""
    order, chain = chains_left(curves, inside)
    found = np.zeros_like(inside)
    if len(order) == 0:
        return found
    first = np.flatnonzero(np.diff(chain, prepend=-1))
    last = np.append(first[1:], len(order)) - 1
    before, after = neighbors(curves)
    at = before[order[first]], after[order[last]]
    bounded = (at[0] >= 0) & (at[1] >= 0) & inside[at[0]] & inside[at[1]]
    short = bounded & (np.bincount(chain, sizes[order]) < LEAST_KEPT)
    found[order[short[chain]]] = True
    return found


@dataclass(frozen=True, eq=False)
class Lines(Frozen):
    """The axes of a field's struts where curves are cut."""

    passed: Bools
    """Runs that are not there, as they are beside cuts, shape (k,)."""
    joints: Ints
    """Joint from which the axis leads to the base of each cut, shape (v,)."""


def lines_to(runs: Runs, curves: Curves, cut: CutCurves, base: Points, sizes: Floats) -> Lines:
    """Return how axes lead to cuts: from the first joint that is well behind each base.

    Parameters
    ----------
    base : (v, 3) of the cuts, mm
    sizes : (v,) radii that tell how far behind joints are, mm
    """
    piece, at, passed = cut.beyond.copy(), cut.nodes.copy(), np.zeros_like(curves.curved)
    before, after = neighbors(curves)
    ends = _joints(curves)
    rows = np.arange(len(at))
    while len(rows):
        way = np.where(cut.ahead[rows], 1, 0)
        far = ends[piece[rows], way]
        rows, way, far = rows[far >= 0], way[far >= 0], far[far >= 0]
        passed[curves.run[curves.pieces[piece[rows]]]] = True
        at[rows] = far
        behind = dot(runs.nodes[far] - base[rows], cut.outward[rows])
        piece[rows] = np.where(way == 1, after[piece[rows]], before[piece[rows]])
        rows = rows[(behind < BEHIND * sizes[rows]) & (piece[rows] >= 0)]
    return Lines(passed, at)


def _joints(curves: Curves) -> Ints:
    """Return the joints of the circles before and after each piece, -1 for none, (p, 2)."""
    first = curves.pieces
    return np.stack([curves.nodes[first], curves.nodes[first + 1]], axis=1)


def _sizes(curves: Curves) -> Floats:
    """Return the length of each piece, in radii, (p,)."""
    first = curves.pieces
    way = length(curves.centers[first + 1] - curves.centers[first])
    return np.asarray(way / np.maximum(curves.radii[first], curves.radii[first + 1]))
