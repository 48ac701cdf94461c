"""Stumps: how far the field around a crowded node reaches along each of its struts.

A stump ends where the strut alone is the surface of the filleted union of the node. Where this
leaves too little room on a strut for a cut and a band up to the other node's ring, the fillets
shrink; where that is not enough, the strut is part of the field, and its other node too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.solid.clusters.spans import BAND, CUT, FACING
from scaffold_cad.struts.blending.collars import LEAST_BLEND, collar_distances, largest_blends
from scaffold_cad.struts.blending.distances import Union
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.room import allotted
from scaffold_cad.struts.runs import balls_of

GAP = 0.3
"""Least distance of other struts where a strut is cut, in its radii: as much as the cells of a
field can tell apart."""

HALVINGS = 5
"""Halvings of the range in which a node's fillets shrink."""


@dataclass(frozen=True, eq=False)
class Stumps(Frozen):
    """The stumps at crowded nodes."""

    nodes: Bools
    """The crowded nodes, and those that had no room beside them, shape (n,)."""
    length: Floats
    """Where the stump of each half-run of these ends, mm, shape (2 k,)."""
    blend: Floats
    """Fillet radius at each node, mm, shape (n,)."""
    whole: Bools
    """Runs without room for a strut of their own, shape (k,)."""


class Reaches:
    """How long stumps are, with the fillets wanted and with the least ones; found when asked."""

    def __init__(self, struts: RoundStruts, fillets: Floats) -> None:
        self.struts = struts
        self.fillets = fillets
        self._rings = struts.collar
        self._wanted, self._least = struts.collar.copy(), struts.collar.copy()
        self._known = np.zeros(len(struts.runs.nodes), dtype=np.bool_)

    def of(self, nodes: Bools) -> tuple[Floats, Floats]:
        """Return both for the half-runs at `nodes` (n,), and where the rings of others are, mm."""
        for row, half_runs, union in _unions(self.struts, nodes & ~self._known, self.fillets):
            small = _least_gaps(union, self.fillets[row])
            self._wanted[half_runs] = collar_distances(union, union.blends)
            self._least[half_runs] = collar_distances(union, small)
        self._known |= nodes
        here = nodes[self.struts.runs.tails]
        return np.where(here, self._wanted, self._rings), np.where(here, self._least, self._rings)


def stumps(reaches: Reaches, nodes: Bools) -> Stumps:
    """Return the stumps at `nodes` (n,) and at those that have to join them.

    Runs that are curved from end to end have none: see `zones`.
    """
    struts, fillets = reaches.struts, reaches.fillets
    runs, curved = struts.runs, struts.curves.curved
    while True:
        wanted, least = reaches.of(nodes)
        here = nodes[runs.edges]  # (k, 2)
        radii = runs.radii.max(axis=1)
        facing = 2 * (FACING + np.abs(runs.slopes[0::2]))
        spare = (np.where(here.all(axis=1), facing, CUT * here.sum(axis=1)) + BAND) * radii
        allowed, no_room = allotted(wanted, least, np.maximum(runs.lengths - spare, 0.0))
        whole = no_room & here.any(axis=1) & ~curved
        joining = nodes.copy()
        joining[runs.edges[whole]] = True
        if np.array_equal(joining, nodes):
            break
        nodes = joining
    fits = (wanted.reshape(-1, 2).sum(axis=1) + spare <= runs.lengths) | curved
    most = np.where(np.repeat(fits | whole, 2), np.inf, allowed)
    length, blend = np.zeros(len(runs.tails)), fillets.copy()
    for row, half_runs, union in _unions(struts, nodes, fillets):
        gaps = _shrunk(union, wanted[half_runs], most[half_runs])
        length[half_runs] = collar_distances(union, gaps)
        blend[row] = np.minimum(fillets[row], gaps)
    return Stumps(nodes, length, blend, whole)


def _shrunk(union: Union, wanted: Floats, most: Floats) -> Floats:
    """Return the largest of a few gaps with which stumps (M, N) are not longer than `most`."""
    gaps = union.blends.copy()
    short = np.flatnonzero((wanted > most).any(axis=1))
    if len(short) == 0:
        return gaps
    part = Union(
        union.directions[:, short],
        union.radii[short],
        union.slopes[short],
        union.balls[short],
        gaps[short],
    )
    gaps[short] = largest_blends(part, _least_gaps(part, gaps[short]), most[short], HALVINGS)
    return gaps


def _least_gaps(union: Union, fillets: Floats) -> Floats:
    """Return the least gaps between struts at the ends of stumps, mm, (M,)."""
    small = np.minimum(fillets, LEAST_BLEND * union.radii.mean(axis=1))
    return np.asarray(np.maximum(small, GAP * union.radii.max(axis=1)))


def wanted_fillets(struts: RoundStruts) -> Floats:
    """Return the fillet radius that each node is asked for, mm, shape (n,)."""
    runs = struts.runs
    thin = np.full(len(runs.nodes), np.inf)
    np.minimum.at(thin, runs.tails, runs.radii.reshape(-1))
    return struts.options.blends(np.arange(len(runs.nodes)), thin)


def _unions(
    struts: RoundStruts, nodes: Bools, fillets: Floats
) -> Iterator[tuple[Ints, Ints, Union]]:
    """Yield nodes of one valency, their half-runs and their filleted unions."""
    runs = struts.runs
    for valency in np.unique(runs.valency[nodes & (runs.valency > 0)]).tolist():
        rows = np.flatnonzero(nodes & (runs.valency == valency))
        half_runs = runs.incidence.at_nodes(rows, valency)
        radii = runs.radii.reshape(-1)[half_runs]
        ball = balls_of(struts.skeleton, runs)[rows]
        directions = np.ascontiguousarray(np.moveaxis(runs.directions[half_runs], -1, 0))
        gaps = np.maximum(fillets[rows], GAP * radii.max(axis=1))
        yield rows, half_runs, Union(directions, radii, runs.slopes[half_runs], ball, gaps)
