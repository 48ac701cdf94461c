"""Tile: struts of one's own, and those around them that decide what they become."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Bools, Frozen, Ints
from scaffold_cad.base.summaries import size_text
from scaffold_cad.skeleton import Skeleton


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Tile(Frozen):
    """A part of a skeleton whose own struts have the surface that they have in the whole.

    All tiles together own each strut once. Nodes and struts are in the order of the whole.
    """

    number: int
    """Which of the tiles it is."""
    skeleton: Skeleton
    """Its own struts and those around them."""
    own: Bools
    """Which struts are its own, shape (m,)."""
    strut_options: Mapping[str, Any] = field(default_factory=dict)
    """What the whole asks `round_struts` for."""

    def __str__(self) -> str:
        own = f"{self.own.sum()} struts of its own and {(~self.own).sum()} around them"
        return f"Tile: {self.number}, {own}, {size_text(self.skeleton.nodes)}"

    @cached_property
    def first_strut(self) -> Ints:
        """The first strut of each node, shape (n,)."""
        first = np.full(len(self.skeleton.nodes), len(self.skeleton.edges), dtype=np.intp)
        for ends in self.skeleton.edges.T:
            np.minimum.at(first, ends, np.arange(len(ends)))
        return first

    def own_runs(self, run_of_edge: Ints) -> Bools:
        """Return which straight runs are its own: those whose first strut is, shape (k,).

        Parameters
        ----------
        run_of_edge : (m,) the run of each strut
        """
        first = np.full(int(run_of_edge.max()) + 1, len(run_of_edge), dtype=np.intp)
        np.minimum.at(first, run_of_edge, np.arange(len(run_of_edge)))
        own: Bools = self.own[first]
        return own

    @cached_property
    def own_nodes(self) -> Bools:
        """Which nodes are its own: those whose first strut is, shape (n,).

        A node of an own strut has all its struts here, so that tiles agree on whose it is.
        """
        own: Bools = self.own[self.first_strut]
        return own
