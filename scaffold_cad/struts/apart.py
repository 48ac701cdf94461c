"""Which parts of round struts keep apart from all that they do not join: a proof by distances.

Every run is cut into three capsules: what lies within its collars' distance of either node, as wide
as the node's patches reach, and the strut between. A node without collars is a capsule of no
length. Capsules that share no node must keep apart; those that share one are apart because the
node's body is star-shaped around it, see `proof`.

Distances of cones are bounded by their larger radius.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length

PIECES = 4
"""Capsules that the strut of a cone is cut into, so that its larger radius bounds little."""


@dataclass(frozen=True, eq=False)
class Capsules(Frozen):
    """Segments with a radius each, and the nodes whose bodies they belong to."""

    start: Points
    """Shape (c, 3), mm."""
    end: Points
    """Shape (c, 3), mm."""
    radius: Floats
    """Shape (c,), mm."""
    nodes: Edges
    """The one or two nodes that each touches, shape (c, 2); twice the same for one."""
    run: Ints
    """Run that each is of, shape (c,)."""


def meeting_runs(capsules: Capsules, gap: float) -> Edges:
    """Return the pairs of runs whose capsules come nearer than `gap` (mm), each once, (p, 2).

    Capsules that share a node are no pair.
    """
    reach = capsules.radius[:, None] + 0.5 * gap
    low = np.minimum(capsules.start, capsules.end) - reach
    high = np.maximum(capsules.start, capsules.end) + reach
    found = []
    for i, j in overlapping_boxes(low, high):
        i, j = _without_neighbors(capsules, i, j)
        a, b = nearest_on_segments(
            capsules.start[i], capsules.end[i], capsules.start[j], capsules.end[j]
        )
        near = length(a - b) < capsules.radius[i] + capsules.radius[j] + gap
        found.append(np.stack([capsules.run[i[near]], capsules.run[j[near]]], axis=1))
    pairs = np.concatenate(found) if found else np.empty((0, 2), dtype=np.intp)
    pairs = np.sort(pairs, axis=1)
    return np.unique(pairs, axis=0)


def _without_neighbors(capsules: Capsules, i: Ints, j: Ints) -> tuple[Ints, Ints]:
    """Return the pairs that share no node."""
    a, b = capsules.nodes[i], capsules.nodes[j]  # (p, 2)
    shared: Bools = (a[:, :, None] == b[:, None, :]).any(axis=(1, 2))
    return i[~shared], j[~shared]
