"""Sections of the bodies of blended nodes; those of nodes that are equal are made once."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.ranges import ranges
from scaffold_cad.layers.loops import Loops, Surface
from scaffold_cad.layers.rounds import crossed
from scaffold_cad.layers.sweep import Sweep
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.bodies import NodeBodies

NODES_AT_ONCE = 256
"""Nodes whose bodies are made together, those that follow each other in height."""

GRAIN = 2.0**-30
"""Heights above equal nodes are rounded to this, mm, so that they are the same again."""


class NodeSections:
    """The sections of nodes each unlike any other, made some at a time, from the lowest up."""

    def __init__(self, bodies: NodeBodies, which: Ints) -> None:
        """Take some of the bodies (m,), from the lowest up."""
        self._bodies, self._which = bodies, which
        batch = np.arange(0, len(which), NODES_AT_ONCE)
        high = bodies.high[which, 2]
        self._sweep = Sweep(
            bodies.low[which[batch], 2], np.maximum.reduceat(high, batch) if len(batch) else high
        )
        self._made: dict[int, Surface] = {}

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections at ascending heights (h,), above those before."""
        batches = self._sweep.between(float(heights[0]), float(heights[-1])).tolist()
        self._made = {number: self._batch(number) for number in batches}
        return [made.cut(heights, np.arange(len(made.low))) for made in self._made.values()]

    def _batch(self, number: int) -> Surface:
        made = self._made.get(number)
        if made is not None:
            return made
        first = number * NODES_AT_ONCE
        return Surface(self._bodies.mesh(self._which[first : first + NODES_AT_ONCE]))


class EqualNodeSections:
    """The sections of nodes that are all equal, from the lowest up."""

    def __init__(self, mesh: TriangleMesh, places: Points) -> None:
        """Take the body of a node at 0, and where the nodes are (m, 3)."""
        self._surface, self._places = Surface(mesh), places
        low, high = self._surface.bounds
        self._low, self._high = places[:, 2] + low, places[:, 2] + high
        self._sweep = Sweep(self._low, self._high)

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections at ascending heights (h,), above those before."""
        active = self._sweep.between(float(heights[0]), float(heights[-1]))
        node, level = crossed(self._low[active], self._high[active], heights)  # (q,)
        node = active[node]
        above = np.rint((heights[level] - self._places[node, 2]) / GRAIN) * GRAIN
        distinct, same = np.unique(above, return_inverse=True)
        made = self._surface.cut(distinct, np.arange(len(self._surface.low)))
        first = np.searchsorted(made.levels, np.arange(len(distinct) + 1))
        count = np.diff(first)[same]  # polygons of each pair of a node and a height
        pair = np.repeat(np.arange(len(node)), count)
        polygons = ranges(first[:-1][same], count)
        return [made.taken(polygons).moved(self._places[node[pair], :2], level[pair])]
