"""Sleeves: the sections carried along each branch, and how they are joined (Algorithm 2).

A section is four corners at a node, counter-clockwise seen from the end of the walking direction.
It starts as the spherical quad of a branch point, is carried by rotation-minimizing frames over
the joints, and meets the quad at the other end in the one of four cyclic matchings that twists
least; what twist is left is spread over the branch by arc length.

References
----------
Panotopoulou et al., Scaffolding a Skeleton, 2018, Algorithm 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.frames import (
    accumulate,
    bisectors,
    double_reflection,
    multiply,
    square_phases,
    turn,
)
from scaffold_cad.base.topology import Chains
from scaffold_cad.base.vectors import (
    any_perpendicular,
    dot,
    length,
    normalize,
    rotate,
    running_sums,
)
from scaffold_cad.skeleton import Skeleton

MITER_LIMIT = 3.0
"""Most that a section is widened in the direction of a bend."""

TIE = 1e-6
"""Twist below which two matchings count as equal, in quarter turns: struts that are alike but for
rounding are matched alike."""

QUARTER = np.pi / 2
"""Angle between two corners of a section, rad."""

REVERSED = np.array([0, 3, 2, 1])
"""Order of a section's corners seen from its other side."""


@dataclass(frozen=True, eq=False)
class Walk(Frozen):
    """All branches walked from start to end: one step an edge, a branch's steps in a row."""

    half_edge: Ints
    """Half-edge of each step, shape (m,)."""
    branch: Ints
    """Branch of each step, shape (m,)."""
    position: Ints
    """Number of steps before each one in its branch, shape (m,)."""
    first: Ints
    """First step of each branch, shape (b,)."""
    last: Ints
    """Last step of each branch, shape (b,)."""
    closed: Bools
    """Whether the branch is a ring, shape (b,)."""
    tail: Ints
    """Node where each step begins, shape (m,)."""
    head: Ints
    """Node where each step ends, shape (m,)."""


@dataclass(frozen=True, eq=False)
class SphericalQuads(Frozen):
    """The spherical quads of all branch points, by half-edge."""

    vertices: UnitVectors
    """Partition vertices seen from their nodes, shape (w, 3)."""
    corners: Ints
    """Rows in `vertices` of each half-edge's quad, counter-clockwise seen from outside;
    -1 where the tail is not a branch point, shape (2 m, 4)."""

    def at(self, half_edges: Ints) -> Points:
        """Return the corners of the quads of `half_edges` (k,), shape (k, 4, 3)."""
        corners: Points = self.vertices[self.corners[half_edges]]
        return corners


@dataclass(frozen=True, eq=False)
class Sections(Frozen):
    """The sections at joints and extremities, and how the branches' ends are matched."""

    steps: Ints
    """Steps whose head is a joint or an extremity, shape (k,)."""
    corners: Points
    """Corners at the head of those steps, shape (k, 4, 3), mm."""
    start_corners: Points
    """Corners at the start of each branch, shape (b, 4, 3), mm; not used at branch points."""
    shift: Ints
    """Quarter turns between each branch's carried section and the quad that it meets, (b,)."""
    twist: Floats
    """Twist left after the matching, spread over the branch, rad, shape (b,)."""


def walk_branches(skeleton: Skeleton) -> Walk:
    """Return all branches as one run of steps."""
    chains: Chains = skeleton.chains
    sizes = np.diff(chains.offsets)
    first = chains.offsets[:-1]
    ends = skeleton.edges.reshape(-1)
    return Walk(
        half_edge=chains.half_edges,
        branch=np.repeat(np.arange(len(sizes)), sizes),
        position=np.arange(len(chains.half_edges)) - np.repeat(first, sizes),
        first=first,
        last=chains.offsets[1:] - 1,
        closed=chains.closed,
        tail=ends[chains.half_edges],
        head=ends[chains.half_edges ^ 1],
    )


def carry_sections(
    skeleton: Skeleton,
    walk: Walk,
    quads: SphericalQuads,
    corner_distance: float,
    like: Ints | None = None,
) -> Sections:
    """Return the sections at the joints and extremities of all branches.

    Parameters
    ----------
    quads : of the branch points
    corner_distance : distance of a section's corners from its node, in radii
    like : (b,) intp, quarter turns to use instead of those of least twist
    """
    chord = skeleton.directions[walk.half_edge]  # (m, 3)
    tail_tangent, head_tangent = _tangents(walk, chord)
    # Turned onto the strut, then off it: its section stays the same from one end to the other.
    onto = double_reflection(chord, tail_tangent, chord)
    steps = multiply(double_reflection(chord, chord, head_tangent), onto)
    carried = accumulate(steps, walk.position)
    start_x = _start_axes(walk, quads, tail_tangent, head_tangent)  # (b, 3)
    head_x = turn(carried, start_x[walk.branch])  # (m, 3)
    twist = _end_twist(walk, quads, start_x, head_x[walk.last], head_tangent[walk.last])
    shift = np.ceil(twist / QUARTER - 0.5 - TIE).astype(np.intp) if like is None else like
    left = np.remainder(twist - shift * QUARTER + np.pi, 2 * np.pi) - np.pi

    inner = np.flatnonzero(skeleton.valency[walk.head] < 3)  # (k,) steps
    turned = (left[walk.branch] * _arc_fraction(skeleton, walk))[inner]
    x = rotate(head_x[inner], head_tangent[inner], turned)
    after = chord[_next_step(walk)[inner]]
    corners = _section(
        skeleton, walk.head[inner], x, head_tangent[inner], chord[inner], after, corner_distance
    )
    before = np.where(walk.closed[:, None], chord[walk.last], chord[walk.first])
    start, tangent = walk.tail[walk.first], tail_tangent[walk.first]
    starts = _section(skeleton, start, start_x, tangent, before, chord[walk.first], corner_distance)
    return Sections(inner, corners, starts, shift, left)


def _next_step(walk: Walk) -> Ints:
    """Return the step after each one; a ring's last step leads to its first, another's to itself.

    A branch that does not close has no bend at its end: its last step counts as its own successor.
    """
    after = np.arange(len(walk.half_edge)) + 1
    after[walk.last] = np.where(walk.closed, walk.first, walk.last)
    return after


def _tangents(walk: Walk, chord: UnitVectors) -> tuple[UnitVectors, UnitVectors]:
    """Return the unit tangents at the tail and the head of each step, (m, 3): the bisectors."""
    after = _next_step(walk)
    head = bisectors(chord, chord[after])
    tail = chord.copy()
    goes_on = after != np.arange(len(after))
    tail[after[goes_on]] = head[goes_on]
    return tail, head


def _start_axes(
    walk: Walk,
    quads: SphericalQuads,
    tail_tangent: UnitVectors,
    head_tangent: UnitVectors,
) -> UnitVectors:
    """Return the direction from the start of each branch to the first corner of its section.

    At a branch point that of the square that fits the spherical quad best; elsewhere the sides of
    the section lie along and across the plane of the first bend, if there is one, (b, 3).
    """
    tangent = tail_tangent[walk.first]
    along_bend = _bend_direction(walk, tail_tangent, head_tangent)
    across = normalize(np.cross(tangent, along_bend))
    straight = length(across) < 0.5
    across[straight] = any_perpendicular(tangent[straight])
    axes = rotate(across, tangent, np.full(len(tangent), np.pi / 4))

    half_edge = walk.half_edge[walk.first]
    branch = quads.corners[half_edge, 0] >= 0
    first, along = across[branch], tangent[branch]
    angle = square_phases(quads.at(half_edge[branch]), first, np.cross(along, first))
    axes[branch] = rotate(first, along, angle)
    return axes


def _bend_direction(walk: Walk, tail_tangent: UnitVectors, head_tangent: UnitVectors) -> Floats:
    """Return the way each branch's tangent first turns, (b, 3); 0 for a straight branch."""
    turning = head_tangent - tail_tangent
    bent = np.flatnonzero(length(turning) > 1e-6)
    first_bent = np.full(len(walk.first), -1, dtype=np.intp)
    first_bent[walk.branch[bent[::-1]]] = bent[::-1]  # the lowest is written last
    return np.where(first_bent[:, None] >= 0, turning[first_bent], 0.0)


def sleeve_quads(near: Ints, far: Ints) -> Ints:
    """Return the four quads between the sections (k, 4) at both ends of each sleeve, (k, 4, 4)."""
    return np.stack([near, np.roll(near, -1, axis=1), np.roll(far, -1, axis=1), far], axis=2)


def _end_twist(
    walk: Walk,
    quads: SphericalQuads,
    start_x: UnitVectors,
    end_x: UnitVectors,
    end_tangent: UnitVectors,
) -> Floats:
    """Return the angle from each branch's carried section to the one that it must meet, rad.

    0 at an extremity, the holonomy of a ring, and else the angle of the square that fits the
    last spherical quad.
    """
    twist = np.zeros(len(walk.first))
    ring = walk.closed
    y = np.cross(end_tangent, end_x)
    twist[ring] = np.arctan2(dot(start_x, y), dot(start_x, end_x))[ring]
    twin = walk.half_edge[walk.last] ^ 1
    branch = quads.corners[twin, 0] >= 0
    met = quads.at(twin[branch])[:, REVERSED]
    twist[branch] = square_phases(met, end_x[branch], y[branch])
    return twist


def _arc_fraction(skeleton: Skeleton, walk: Walk) -> Floats:
    """Return the part of its branch's length that lies before the head of each step, (m,)."""
    run = running_sums(skeleton.lengths[walk.half_edge >> 1], walk.position)
    fraction: Floats = run / run[walk.last][walk.branch]
    return fraction


def _section(
    skeleton: Skeleton,
    node: Ints,
    x: UnitVectors,
    tangent: UnitVectors,
    before: UnitVectors,
    after: UnitVectors,
    corner_distance: float,
) -> Points:
    """Return the corners of square sections, counter-clockwise about `tangent`, (k, 4, 3), mm.

    The first lies along `x` from the node. In the direction of the bend between the chords `before`
    and `after` the section is widened by 1 / cos of half the bend: the tubes keep their width.
    """
    right = x * (corner_distance * skeleton.radii[node])[:, None]
    up = np.cross(tangent, right)
    corners = np.stack([right, up, -right, -up], axis=1)  # (k, 4, 3)
    half_cosine = np.maximum(length(before + after) / 2, 1.0 / MITER_LIMIT)
    bend = normalize(after - before)[:, None, :]
    stretch = dot(corners, bend) * (1.0 / half_cosine - 1.0)[:, None]  # (k, 4)
    return skeleton.nodes[node][:, None, :] + corners + stretch[:, :, None] * bend


def join_sections(
    walk: Walk, sections: Sections, quads: SphericalQuads, first_vertex: Ints
) -> Ints:
    """Return the vertices of the sections at both ends of each edge, (m, 2, 4).

    Row j of the first is joined to row j of the second; both are counter-clockwise about the
    edge's direction.

    Parameters
    ----------
    first_vertex : (n,) intp, first of the four vertices of each joint and extremity
    """
    count = np.arange(4)
    near = first_vertex[walk.tail][:, None] + count  # (m, 4)
    far = first_vertex[walk.head][:, None] + count
    leaves = quads.corners[walk.half_edge]
    meets = quads.corners[walk.half_edge ^ 1][:, REVERSED]
    near = np.where(leaves >= 0, leaves, near)
    far = np.where(meets >= 0, meets, far)
    rolled = (count - sections.shift[:, None]) % 4  # (b, 4)
    far[walk.last] = np.take_along_axis(far[walk.last], rolled, axis=1)

    sleeves = np.empty((len(near), 2, 4), dtype=np.intp)
    backward = (walk.half_edge & 1 == 1)[:, None]
    edge = walk.half_edge >> 1
    sleeves[edge, 0] = np.where(backward, far[:, REVERSED], near)
    sleeves[edge, 1] = np.where(backward, near[:, REVERSED], far)
    return sleeves
