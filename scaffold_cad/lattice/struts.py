"""Struts: a graph in space that has no radii yet, to be cut, trimmed and made a skeleton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.topology import valencies
from scaffold_cad.base.vectors import length
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.cutting import drawn_together


@dataclass(frozen=True, eq=False)
class Struts:
    """Straight struts between nodes."""

    nodes: Points
    """Node positions, shape (n, 3), mm."""
    edges: Edges
    """Node pairs, shape (m, 2)."""

    @property
    def starts(self) -> Points:
        """Position of the first node of each strut, shape (m, 3), mm."""
        return self.nodes[self.edges[:, 0]]

    @property
    def ends(self) -> Points:
        """Position of the second node of each strut, shape (m, 3), mm."""
        return self.nodes[self.edges[:, 1]]

    @property
    def middles(self) -> Points:
        """Middle of what each strut stands for, see `at`, shape (m, 3), mm."""
        return self.at(np.arange(len(self.edges)), np.full(len(self.edges), 0.5))

    def at(self, strut: Ints, along: Floats) -> Points:
        """Return places on what struts stand for: the struts, or curves that they are chords of.

        Parameters
        ----------
        strut : (k,) intp
        along : (k,) float64, from 0 to 1

        Returns
        -------
        (k, 3) float64, mm
        """
        start, end = self.starts[strut], self.ends[strut]
        return start + along[:, None] * (end - start)

    @property
    def lengths(self) -> Floats:
        """Length of each strut, shape (m,), mm."""
        return length(self.ends - self.starts)

    def kept(self, keep: Bools) -> Struts:
        """Return the struts marked in `keep` (m,); all nodes stay."""
        return Struts(self.nodes, self.edges[keep])

    def collapsed(self, short: Bools, fixed: Bools) -> Struts:
        """Return the struts with those marked in `short` (m,) shrunk to nothing.

        The nodes that they join become one, in the middle of those that are `fixed` (n,) if any
        is. Repeated struts may remain.
        """
        if not short.any():
            return self
        nodes, label = drawn_together(self.nodes, self.edges, short, fixed)
        return Struts(nodes, label[self.edges[~short]])

    def without_dangling(self) -> Struts:
        """Return the struts without those that lead to a free end, all along to a branching."""
        return self.kept(leading_on(self.edges))

    def skeleton(self, radius: Radius) -> Skeleton:
        """Return the struts as a skeleton, without the nodes that no strut reaches."""
        used = np.zeros(len(self.nodes), dtype=np.bool_)
        used[self.edges] = True
        nodes, edges = self.nodes, self.edges
        if not used.all():
            nodes, edges = nodes[used], (np.cumsum(used) - 1)[edges]
        return Skeleton(nodes, edges, radii_at(nodes, radius))

    def cleaned_skeleton(self, radius: Radius) -> Skeleton:
        """Return the struts as a skeleton, without repeated and overlapping ones."""
        clean = self.skeleton(1.0).cleaned(weld_distance=0.0).skeleton
        return clean.with_radii(radii_at(clean.nodes, radius))


def leading_on(edges: Edges) -> Bools:
    """Return which edges (m, 2) do not lead to a free end, all along to a branching, (m,)."""
    stay = np.ones(len(edges), dtype=np.bool_)
    count = int(edges.max(initial=-1)) + 1
    while True:
        free = stay & (valencies(edges[stay], count) == 1)[edges].any(axis=1)
        if not free.any():
            return stay
        stay &= ~free
