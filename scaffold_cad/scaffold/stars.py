"""The branch points of a skeleton: their partitions, and how far out each partition vertex lies.

A branch point's `star` is the set of directions in which its edges leave it. Stars of one valency
are partitioned together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.segments import distance_to_side
from scaffold_cad.base.vectors import best_turns, dot, length
from scaffold_cad.partition import partition_spheres
from scaffold_cad.partition.star import nearest_angles
from scaffold_cad.skeleton import Skeleton

Fit: TypeAlias = Literal["enclose", "paper"]
"""How large a branch point's sphere is: so that no strut is cut thin at it, or as given."""

Section: TypeAlias = Literal["circumscribed", "area", "inscribed", "round"]
"""Which square section stands for a circle of the node's radius: around it, of its area, in it, or
the one whose Catmull-Clark limit it is."""

APOTHEM: dict[Section, float] = {
    "circumscribed": 1.0,
    "area": float(np.sqrt(np.pi) / 2),
    "inscribed": float(np.sqrt(0.5)),
    # Between equal squares of corner distance 1 the Catmull-Clark limit is a tube of radius 2/3 at
    # the corners and 11 √2/24 at the sides: `tests/scaffold/test_stars.py` holds it against the
    # limit of such a tube.
    "round": float(np.sqrt(0.5) / ((2 / 3 + 11 * np.sqrt(2) / 24) / 2)),
}
"""Distance of a section's sides from its center, as a multiple of the radius."""

SHARED_REACH = 0.45
"""Part of an edge that an enlarged sphere may take where both ends are branch points."""

MOST_ACROSS = 2.5
"""Furthest that an enlarged sphere may reach across a strut, in half widths of its section.

Between struts a few degrees apart the sides of quads run through the inside of both: pushing them
out to the strut's full width would raise spikes and make no strut thicker."""

FREE_REACH = 0.8
"""Part of an edge that an enlarged sphere may take where the other end is not one."""


@dataclass(frozen=True, eq=False)
class Stars(Frozen):
    """The partitions of all branch points of a skeleton, vertices and quads run together."""

    vertices: UnitVectors
    """Partition vertices of all branch points, seen from their nodes, shape (w, 3)."""
    offsets: Ints
    """Number of partition vertices before those of each node, shape (n + 1,)."""
    corners: Ints
    """Row in `vertices` of the four corners of each half-edge's spherical quad,
    counter-clockwise seen from outside; -1 where the tail is not a branch point, shape (2 m, 4)."""
    clearance: Floats
    """Angle from each half-edge's direction to the nearest side of its spherical quad, rad;
    nan where the tail is not a branch point, shape (2 m,)."""
    directions: UnitVectors
    """Direction in which each half-edge leaves its node, shape (2 m, 3)."""


def partition_stars(skeleton: Skeleton, method: str, like: Stars | None = None) -> Stars:
    """Return the partitions of all branch points.

    Parameters
    ----------
    skeleton : checked
    method : of `partition_sphere`
    like : the partitions of another skeleton with the same edges; their combinatorics are kept,
        and their vertices stay near to where the turn of each star brings them
    """
    valency = skeleton.valency
    counts = np.where(valency >= 3, valency + 2, 0)
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.intp)
    vertices = np.empty((offsets[-1], 3))
    corners = np.full((2 * len(skeleton.edges), 4), -1, dtype=np.intp)
    clearance = np.full(2 * len(skeleton.edges), np.nan)
    for n in np.unique(valency[valency >= 3]).tolist():
        nodes = np.flatnonzero(valency == n)  # (k,)
        half_edges = skeleton.incidence.at_nodes(nodes, n)  # (k, n)
        first = offsets[nodes][:, None, None]
        rows = offsets[nodes][:, None] + np.arange(n + 2)  # (k, n + 2)
        directions = skeleton.directions[half_edges]  # (k, n, 3)
        if like is None:
            cut = partition_spheres(directions, method)
        else:
            turns = best_turns(np.swapaxes(directions, 1, 2) @ like.directions[half_edges])
            near = like.vertices[rows] @ np.swapaxes(turns, 1, 2)
            quads = like.corners[half_edges] - first
            cut = partition_spheres(directions, method, like=quads, near=near)
        vertices[rows] = cut.vertices
        corners[half_edges] = cut.quads + first
        clearance[half_edges] = cut.clearance
    return Stars(vertices, offsets, corners, clearance, skeleton.directions)


@dataclass(frozen=True)
class WorstClearance:
    """Where a partition leaves an edge least room, relative to what is possible."""

    half_edge: int
    """The half-edge; it leaves `node` along `edge`."""
    node: int
    edge: int
    clearance: float
    """Angle to the nearest side of its quad, rad."""
    relative: float
    """The same over half the angle to the nearest other edge: at most 1."""


def worst_clearance(skeleton: Skeleton, clearance: Floats) -> WorstClearance | None:
    """Return the smallest relative clearance, or None without a branch point.

    Parameters
    ----------
    skeleton : the skeleton
    clearance : (2 m,) float64, of each half-edge, rad; as that of its `Stars` or its scaffold
    """
    relative = np.full(2 * len(skeleton.edges), np.inf)
    for n in np.unique(skeleton.valency[skeleton.branch_points]).tolist():
        half_edges = skeleton.incidence.at_nodes(np.flatnonzero(skeleton.valency == n), n)
        nearest = nearest_angles(skeleton.directions[half_edges])  # (k, n)
        relative[half_edges] = 2 * clearance[half_edges] / nearest
    worst = int(np.argmin(relative))
    if not relative[worst] < np.inf:
        return None
    return WorstClearance(
        half_edge=worst,
        node=int(skeleton.edges.reshape(-1)[worst]),
        edge=worst >> 1,
        clearance=float(clearance[worst]),
        relative=float(relative[worst]),
    )


def star_positions(skeleton: Skeleton, stars: Stars, fit: Fit, section: Section) -> Points:
    """Return the partition vertices at their distances from their nodes, shape (w, 3), mm.

    With `fit="paper"` all lie on the sphere of the node's radius. With `fit="enclose"` each lies
    far enough out for the strut sections of the quads around it to pass within them, but neither
    further than its share of the edges nor less than the sphere of the paper's fit.
    """
    owner = np.repeat(np.arange(len(skeleton.nodes)), np.diff(stars.offsets))  # (w,)
    radius = skeleton.radii[owner]
    if fit == "enclose":
        radius = _enclosing_radius(skeleton, stars, radius, APOTHEM[section])
    return stars.vertices * radius[:, None]


def _enclosing_radius(skeleton: Skeleton, stars: Stars, radius: Floats, apothem: float) -> Floats:
    """Return the distance of each partition vertex from its node, (w,).

    The side of a quad keeps a distance `need` from the strut's axis if both its ends lie at least
    `need` / (distance of the side between unit vectors) out: scaling the ends of a side up moves
    every point of it outwards. Neither `edge_reach` nor `MOST_ACROSS` is exceeded for that.
    """
    need = np.zeros(len(stars.vertices))
    room = np.full(len(stars.vertices), np.inf)
    reach = edge_reach(skeleton)  # (2 m,)
    tails = skeleton.edges.reshape(-1)
    at_branch = np.flatnonzero(stars.corners[:, 0] >= 0)
    for part in np.array_split(at_branch, max(1, len(at_branch) // 200_000)):
        rows = stars.corners[part]  # (k, 4)
        corner = stars.vertices[rows]  # (k, 4, 3)
        axis = skeleton.directions[part][:, None, :]
        along = dot(corner, np.broadcast_to(axis, corner.shape))  # (k, 4)
        across = corner - along[:, :, None] * axis
        distance = distance_to_side(across, np.roll(across, -1, axis=1))  # (k, 4)
        size = apothem * skeleton.radii[tails[part]][:, None]  # (k, 1)
        wanted = size / np.maximum(distance, 1e-9)
        np.maximum.at(need, rows, wanted)
        np.maximum.at(need, np.roll(rows, -1, axis=1), wanted)
        limit = np.divide(
            reach[part][:, None], along, out=np.full_like(along, np.inf), where=along > 1e-9
        )
        limit = np.minimum(limit, MOST_ACROSS * size / np.maximum(length(across), 1e-9))
        np.minimum.at(room, rows, limit)
    outward: Floats = np.minimum(need, np.maximum(radius, room))
    return outward


def edge_reach(skeleton: Skeleton) -> Floats:
    """Return how far along each half-edge its branch point may extend, shape (2 m,), mm."""
    both = (skeleton.valency[skeleton.edges] >= 3).all(axis=1)
    return np.repeat(np.where(both, SHARED_REACH, FREE_REACH) * skeleton.lengths, 2)
