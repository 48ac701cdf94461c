"""The core of clusters: what they begin with, as it has no surface of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Frozen
from scaffold_cad.solid.clusters.spans import Spans, no_spans
from scaffold_cad.struts.curves.proof import proved
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.sharp.surface import without_triangles


@dataclass(frozen=True, eq=False)
class Core(Frozen):
    """What clusters hold in any case."""

    nodes: Bools
    """Shape (n,)."""
    pieces: Bools
    """Pieces of curves, and with them what of the curves beside them a cut takes, shape (p,)."""
    zone: Bools
    """Pieces of curves and nothing beside them: those that are a field on the other side of a
    wall, shape (p,)."""
    spans: Spans
    """Stretches of runs: those that are a field on the other side of a wall."""

    def joined(self, other: Core) -> Core:
        """Return the same with the nodes and pieces of another."""
        return replace(self, nodes=self.nodes | other.nodes, pieces=self.pieces | other.pieces)

    def with_nodes(self, nodes: Bools) -> Core:
        """Return the same with more nodes (n,)."""
        return replace(self, nodes=self.nodes | nodes)

    def with_zone(self, pieces: Bools) -> Core:
        """Return the same with more pieces (p,) in the zone."""
        return replace(self, zone=self.zone | pieces)

    def with_spans(self, spans: Spans) -> Core:
        """Return the same with other spans."""
        return replace(self, spans=spans)


def unproved(struts: RoundStruts) -> Core:
    """Return the nodes whose blend is not proved, or whose struts have no room, and such pieces."""
    runs = struts.runs
    found = np.zeros(len(runs.nodes), dtype=np.bool_)
    for group in struts.blended:
        good = group.shapes.sound[group.shape_of]
        found[group.nodes[~good]] = True
    if struts.options.is_sharp:
        found = runs.valency > 1
        for own in struts.sharp:
            found[own.nodes] = False
    used = struts.collar.reshape(-1, 2).sum(axis=1)
    found[runs.edges[used > runs.lengths]] = True
    folded = ~proved(struts.curves)
    return Core(found, folded, np.zeros_like(folded), no_spans())


def unmade(struts: RoundStruts, sides: int) -> Core:
    """Return the nodes and pieces that have no triangles of their own with so many sides."""
    core = unproved(struts)
    return replace(core, nodes=core.nodes | without_triangles(struts, sides))
