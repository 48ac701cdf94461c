"""Runs: straight struts that pass through joints without a bend, joined to one cylinder or cone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.topology import Incidence, component_labels, incidence, valencies
from scaffold_cad.base.vectors import both_directions, dot, length
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton

STRAIGHT = 1e-8
"""Largest turn (rad) at a joint, step of radius (in radii) and change of taper of one run."""

THICKER = 1e-9
"""By how much a ball is thicker than the struts at its node at least, in their radii."""

STEEP = 0.02
"""Steep cones touch a ball that is smaller than they are across their node. Where that is more than
this, in radii, the node has a ball of their radius: a cell body, from which thin necks leave."""


@dataclass(frozen=True, eq=False)
class Runs(Frozen):
    """Struts between ends, bends and branch points, each straight and of one taper.

    Half-run `2 i` leaves node `edges[i, 0]`, half-run `2 i + 1` leaves `edges[i, 1]`.
    """

    nodes: Points
    """Positions of all nodes of the skeleton, shape (n, 3), mm."""
    edges: Edges
    """First and last node of each run, shape (k, 2)."""
    radii: Floats
    """Radius at both ends of each run, shape (k, 2), mm."""
    run_of_edge: Ints
    """Run that each edge of the skeleton belongs to, shape (m,); -1 where it is left out."""
    valency: Ints
    """Number of runs at each node, 0 at those that runs pass through, shape (n,)."""

    @staticmethod
    def of(nodes: Points, edges: Edges, radii: Floats, run_of_edge: Ints) -> Runs:
        """Return runs with the valency that they give the nodes."""
        return Runs(nodes, edges, radii, run_of_edge, valencies(edges, len(nodes)))

    def chosen(self, keep: Bools) -> Runs:
        """Return some of the runs; nodes keep their valency."""
        number = np.append(np.where(keep, np.cumsum(keep) - 1, -1), -1)  # the last one for -1
        run = number[self.run_of_edge]
        return Runs(self.nodes, self.edges[keep], self.radii[keep], run, self.valency)

    @cached_property
    def tails(self) -> Ints:
        """Node that each half-run leaves, shape (2 k,)."""
        return self.edges.reshape(-1)

    @cached_property
    def lengths(self) -> Floats:
        """Length of each run, shape (k,), mm."""
        return length(self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]])

    @cached_property
    def directions(self) -> UnitVectors:
        """Direction in which each half-run leaves its node, shape (2 k, 3)."""
        return both_directions(self.nodes, self.edges)

    @cached_property
    def slopes(self) -> Floats:
        """Growth of the radius along each half-run, mm per mm, shape (2 k,)."""
        taper = (self.radii[:, 1] - self.radii[:, 0]) / self.lengths
        return np.stack([taper, -taper], axis=1).reshape(-1)

    @cached_property
    def incidence(self) -> Incidence:
        """The half-runs that leave each node."""
        return incidence(self.edges, len(self.nodes))

    def within(self, skeleton: Skeleton) -> Runs:
        """Return the same runs on the same graph with its nodes a little elsewhere.

        They lead straight from end to end, whatever joints they pass.
        """
        radii = _radii_at_ends(skeleton, self)
        return Runs.of(skeleton.nodes, self.edges, radii, self.run_of_edge)

    def moved(self, skeleton: Skeleton) -> Runs:
        """Return the runs of the same graph with its nodes elsewhere.

        Raises
        ------
        OptionError
            If a joint that a run passes is bent.
        """
        own = straight_runs(skeleton)
        at_ends = np.zeros(len(self.nodes), dtype=np.bool_)
        at_ends[self.edges] = True
        bent = np.flatnonzero((own.valency > 0) & ~at_ends)
        if len(bent):
            raise OptionError(
                f"node {bent[0]} was a straight joint in like, and bends now; need like with a "
                "bend there"
            )
        return self.within(skeleton)

    def radii_at(self, half_runs: Ints, distances: Floats) -> Floats:
        """Return the radius of half-runs (h,) at distances (h,) from their nodes, mm, (h,)."""
        return self.radii.reshape(-1)[half_runs] + self.slopes[half_runs] * distances


def _radii_at_ends(skeleton: Skeleton, runs: Runs) -> Floats:
    """Return the radii at the ends of runs (k, 2) of several edges each."""
    radii = np.empty(runs.edges.shape)
    tails, sizes = skeleton.edges.reshape(-1), skeleton.edge_radii.reshape(-1)
    run = np.repeat(runs.run_of_edge, 2)
    for side in (0, 1):
        at_end = np.flatnonzero(tails == runs.edges[run, side])
        radii[run[at_end], side] = sizes[at_end]
    return radii


def balls_of(skeleton: Skeleton, runs: Runs) -> Floats:
    """Return the radius of the ball at each node, mm, (n,); 0 at nodes without one."""
    across, touched = np.zeros(len(runs.nodes)), np.zeros(len(runs.nodes))
    radii = runs.radii.reshape(-1)
    np.maximum.at(across, runs.tails, radii)
    np.maximum.at(touched, runs.tails, radii / np.hypot(1.0, runs.slopes))
    is_ball = skeleton.radii > across * (1 + THICKER)
    is_ball |= (runs.valency > 1) & (skeleton.radii > touched * (1 + STEEP))
    return np.where(is_ball & (runs.valency > 0), skeleton.radii, 0.0)


def ball_ends(skeleton: Skeleton, runs: Runs) -> Bools:
    """Return the extremities that are balls, thicker than their strut, (n,)."""
    return np.asarray((balls_of(skeleton, runs) > 0) & (runs.valency == 1))


def ball_collars(skeleton: Skeleton, runs: Runs) -> Floats:
    """Return how far from its node each half-run leaves the ball there, mm, (2 k,).

    It is 0 but at extremities that are balls.
    """
    found = np.zeros(len(runs.tails))
    ends = np.flatnonzero(ball_ends(skeleton, runs)[runs.tails])
    size, radius, slope = (
        skeleton.radii[runs.tails[ends]],
        runs.radii.reshape(-1)[ends],
        runs.slopes[ends],
    )
    stretch = np.hypot(1.0, slope)
    out = np.sqrt((stretch * size - radius) * (stretch * size + radius))
    found[ends] = (out - radius * slope) / stretch**2
    return found


def at_balls(runs: Runs, collar: Floats) -> Bools:
    """Return whether half-runs leave extremities that are balls, by their `collar`, (2 k,)."""
    return np.asarray((collar > 0) & (runs.valency[runs.tails] == 1))


def straight_runs(skeleton: Skeleton) -> Runs:
    """Return the edges of `skeleton`, joined where a joint changes nothing."""
    through = _passed(skeleton)
    if not through.any():
        every = np.arange(len(skeleton.edges))
        return Runs.of(skeleton.nodes, skeleton.edges, skeleton.edge_radii, every)
    half_edges = skeleton.incidence.at_nodes(np.flatnonzero(through), 2)  # (j, 2)
    run_of_edge = component_labels(half_edges >> 1, len(skeleton.edges))
    tails = skeleton.edges.reshape(-1)
    outer = np.flatnonzero(~through[tails])
    # Two half-edges of each run leave nodes where it ends.
    ends = outer[np.argsort(run_of_edge[outer >> 1], kind="stable")].reshape(-1, 2)
    return Runs.of(skeleton.nodes, tails[ends], skeleton.edge_radii.reshape(-1)[ends], run_of_edge)


def _passed(skeleton: Skeleton) -> Bools:
    """Return the joints that change neither direction nor radius nor taper, shape (n,)."""
    passed = np.zeros(len(skeleton.nodes), dtype=np.bool_)
    joints = skeleton.joints
    if len(joints) == 0:
        return passed
    sides = skeleton.incidence.at_nodes(joints, 2)  # (j, 2)
    directions = skeleton.directions[sides]  # (j, 2, 3)
    radii = skeleton.edge_radii.reshape(-1)
    near, far = radii[sides], radii[sides ^ 1]  # (j, 2)
    slopes = (far - near) / skeleton.lengths[sides >> 1]
    turned = length(directions.sum(axis=1))
    ball = skeleton.radii[joints] - near.max(axis=1)
    passed[joints] = (
        (turned < STRAIGHT)
        & (dot(directions[:, 0], directions[:, 1]) < 0)
        & (np.abs(near[:, 0] - near[:, 1]) < STRAIGHT * near[:, 0])
        & (np.abs(slopes.sum(axis=1)) < STRAIGHT)
        & (ball < STRAIGHT * near[:, 0])
    )
    return passed
