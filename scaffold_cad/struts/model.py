"""RoundStruts: struts that are exact cylinders and cones between the collars of their nodes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.blending.blend import Originals, Solved
from scaffold_cad.struts.curves.curve import Curves
from scaffold_cad.struts.hollow.sockets import NO_SOCKETS, Sockets
from scaffold_cad.struts.options import StrutOptions
from scaffold_cad.struts.runs import Runs, at_balls
from scaffold_cad.struts.sharp.nodes import SharpNodes


@dataclass(frozen=True, eq=False)
class BlendedNodes(Frozen):
    """Branch points and bends of one valency whose patches are cut alike, and their blends."""

    nodes: Ints
    """Shape (M,)."""
    half_runs: Ints
    """Half-runs that leave each node, shape (M, N)."""
    quads: Ints
    """Corners of the quad around each strut, in 0..N+1, shape (U, N, 4)."""
    axes: UnitVectors
    """Direction of each strut, shape (U, N, 3)."""
    shape_of: Ints
    """Which of the U blends each node has, shape (M,)."""
    shapes: Solved
    """The blends: patches between the collars, relative to the nodes."""
    originals: Originals
    """What they are turned copies of."""

    def __getitem__(self, rows: Ints) -> BlendedNodes:
        used, shape_of = np.unique(self.shape_of[rows], return_inverse=True)
        return BlendedNodes(
            self.nodes[rows],
            self.half_runs[rows],
            self.quads[used],
            self.axes[used],
            shape_of.reshape(-1),
            self.shapes[used],
            self.originals[used],
        )


@checks_keywords()
@dataclass(frozen=True, eq=False)
class RoundStruts(Frozen, Shown):
    """A skeleton's struts as exact cylinders and cones, with blends at its nodes.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round_struts(strut).overlapping.tolist()
    []
    >>> print(round_struts(strut))
    RoundStruts: 1 of 1 strut exact, 0 crowded nodes, 9 x 0 x 0 mm, radius 1 mm
    """

    skeleton: Skeleton
    """The skeleton that was asked for."""
    options: StrutOptions
    """How they were made."""
    runs: Runs
    """Straight struts, which pass through joints without a bend."""
    blended: tuple[BlendedNodes, ...]
    """Branch points and bends that have a blend, by valency."""
    collar: Floats
    """Distance from each half-run's node at which it is alone, shape (2 k,), mm: where its own
    surface begins, and a little beyond the edges of balls and sharp nodes; at extremities > 0 where
    they are balls."""
    curves: Curves
    """Struts that run on smoothly through joints."""
    x: UnitVectors
    """Where the ring of each half-run begins, at right angles to it, shape (2 k, 3)."""
    fillet: Floats
    """Fillet radius reached at each node, mm; nan at nodes without a blend, shape (n,)."""
    bends: Floats
    """Centerline radius of the torus that each bend is, mm; nan at other nodes, shape (n,)."""
    crowded: Bools
    """Nodes without a surface of their own, shape (n,): what is there overlaps or is not proved."""
    crowded_runs: Bools
    """Runs that have no surface of their own, shape (k,): they cross others between their collars,
    or both of their nodes are crowded."""
    like: RoundStruts | None = None
    """Struts of the same skeleton, moved, whose partitions and triangles these have."""
    sockets: Sockets = NO_SOCKETS
    """Sockets at open ends of hollow struts."""
    sharp: tuple[SharpNodes, ...] = ()
    """Branch points and bends that are the sharp union of their struts, by valency."""
    inner: RoundStruts | None = None
    """The inside of hollow struts, thinner by their wall; None for solid ones."""

    def __str__(self) -> str:
        struts = f"{self.exact.sum()} of {counted(len(self.exact), 'strut')} exact"
        crowded = counted(int(self.crowded.sum()), "crowded node")
        if self.inner is not None and (inside := int((self.inner.crowded & ~self.crowded).sum())):
            crowded += f" and {inside} crowded inside"
        size, radii = size_text(self.skeleton.nodes), radii_text(self.skeleton.edge_radii)
        return f"RoundStruts: {struts}, {crowded}, {size}, {radii}"

    @cached_property
    def exact(self) -> Bools:
        """Whether each edge is a cylinder or a cone on its axis between its collars, (m,).

        Edges that are curved from end to end are not: see `curves`.
        """
        return ~(self.crowded_runs | self.curves.curved)[self.runs.run_of_edge]

    @property
    def at_balls(self) -> Bools:
        """Whether each half-run leaves an extremity that is a ball, shape (2 k,)."""
        return at_balls(self.runs, self.collar)

    @property
    def within(self) -> float:
        """How far these are inside the struts that they make hollow, mm; 0 for others."""
        return float(self.options.wall or 0.0) if self.inner is None else 0.0

    @property
    def overlapping(self) -> Ints:
        """Edges whose surface, or that at one of their nodes, may cross others, ascending."""
        crowded: Bools = self.crowded_runs | self.crowded[self.runs.edges].any(axis=1)
        edges = np.flatnonzero(crowded[self.runs.run_of_edge])
        return edges if self.inner is None else np.union1d(edges, self.inner.overlapping)

    @property
    def at_curves(self) -> Bools:
        """Whether each node is a joint that a curve passes, but for bends, shape (n,)."""
        found = np.zeros(len(self.runs.nodes), dtype=np.bool_)
        found[self.curves.nodes[self.curves.nodes >= 0]] = True
        return found & np.isnan(self.bends)

    @property
    def first(self) -> RoundStruts:
        """The first of the struts that these are made like, one after another; or themselves."""
        found = self
        while found.like is not None:
            found = found.like
        return found

    @cached_property
    def straight(self) -> RoundStruts:
        """The same with those runs only that are straight somewhere."""
        keep = ~self.curves.curved
        if keep.all():
            return self
        both = np.repeat(keep, 2)
        number = np.where(both, np.cumsum(both) - 1, -1)
        blended = (replace(each, half_runs=number[each.half_runs]) for each in self.blended)
        ends = np.where(self.curves.half_runs < 0, -1, number[self.curves.half_runs])
        return replace(
            self,
            runs=self.runs.chosen(keep),
            blended=tuple(blended),
            collar=self.collar[both],
            x=self.x[both],
            curves=replace(self.curves, half_runs=ends, curved=np.zeros(keep.sum(), np.bool_)),
            crowded_runs=self.crowded_runs[keep],
        )
