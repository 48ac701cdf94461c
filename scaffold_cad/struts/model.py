"""RoundStruts: struts that are exact cylinders and cones between the collars of their nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.notebook import Shown
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.options import StrutOptions
from scaffold_cad.struts.runs import Runs


@dataclass(frozen=True, eq=False)
class Blends(Frozen):
    """Branch points and bends of one valency: a Bézier patch for each arc of their partitions."""

    nodes: Ints
    """Shape (M,)."""
    half_runs: Ints
    """Half-runs that leave each node, shape (M, N)."""
    quads: Ints
    """Corners of the quad around each strut, in 0..N+1, shape (M, N, 4)."""
    control: Floats
    """Bézier points, shape (M, 4 N, d + 1, d + 1, 3), mm: patch 4 i + k lies between arc k of quad
    i (v = 0) and quarter k of the collar of strut i (v = 1), u along them."""
    proved: Bools
    """Whether each is proved to be star-shaped around its node, shape (M,)."""


@dataclass(frozen=True, eq=False)
class RoundStruts(Frozen, Shown):
    """A skeleton's struts as exact cylinders and cones, with blends at its nodes."""

    skeleton: Skeleton
    """The skeleton that was asked for."""
    options: StrutOptions
    """How they were made."""
    runs: Runs
    """Straight struts, which pass through joints without a bend."""
    blends: tuple[Blends, ...]
    """Branch points and bends, by valency."""
    collar: Floats
    """Distance from each half-run's node at which its own surface begins, shape (2 k,), mm."""
    x: UnitVectors
    """Where the ring of each half-run begins, at right angles to it, shape (2 k, 3)."""
    fillet: Floats
    """Fillet radius reached at each node, mm; nan where there is none, shape (n,)."""
    overlapping: Ints
    """Skeleton edges that have no room of their own, ascending: their surfaces may cross others."""

    @cached_property
    def exact(self) -> Bools:
        """Whether each edge is a cylinder or a cone on its axis between its collars, (m,)."""
        exact = np.ones(len(self.skeleton.edges), dtype=np.bool_)
        exact[self.overlapping] = False
        return exact
