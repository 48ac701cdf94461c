"""Collars: joints put where each strut leaves the blend of its branch point, or a step.

Between two collars a strut is straight and its section constant, as an engineer's strut is. A
joint or an extremity has a section of its node's radius: a strut whose own radius is another there
has it from a collar on, a *step* away. What the skeleton with such joints is to the one without
them, its `Refinement`, is here too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.scaffold.sleeves import MITER_LIMIT
from scaffold_cad.scaffold.stars import Stars
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.repair import largest_at_nodes

BLEND = 0.5
"""Distance from the furthest corner at a node along a strut to its collar, in radii."""

STEP = 1e-3
"""Least difference between the radii of a strut and of its joint or extremity, in the node's: with
less the strut widens or narrows over its whole length."""

WIDER = 1.01
"""Width of the cone at a collar, in widths of the collar."""

LEAST_STRUT = 0.25
"""Least length of strut between two collars, in radii; below it the strut gets one or none."""

RESOLUTION = 1e-9
"""Least distance of a collar from a node, in the largest coordinate of its strut."""

MOST_SQUEEZED = 0.9
"""Part of an edge that its collars and what lies before them may take when they must stay."""


@dataclass(frozen=True, eq=False)
class Refinement(Frozen):
    """A skeleton with more joints, and where its edges come from."""

    skeleton: Skeleton
    """The refined skeleton: the old nodes first, then the new joints."""
    edge_of_edge: Ints
    """Old edge of each new one, shape (m',); the new edges of an old one follow each other."""
    collared: Bools
    """Which ends of each old edge have a collar, or at a sharp bend a bevel, shape (m, 2)."""
    beveled: Bools
    """Which of these have a bevel, shape (m, 2)."""

    @property
    def leaving(self) -> Ints:
        """New half-edge that leaves a node where each old half-edge did, shape (2 m,)."""
        pieces = 1 + self.collared.sum(axis=1)
        last = np.cumsum(pieces) - 1
        first = last - pieces + 1
        return np.stack([2 * first, 2 * last + 1], axis=1).reshape(-1)


def without_collars(skeleton: Skeleton) -> Refinement:
    """Return the skeleton as it is."""
    edges = len(skeleton.edges)
    none = np.zeros((edges, 2), dtype=np.bool_)
    return Refinement(skeleton, np.arange(edges), none, none)


def with_collars(
    skeleton: Skeleton,
    stars: Stars,
    positions: Points,
    corner_distance: float,
    like: Bools | None = None,
) -> Refinement:
    """Return the skeleton with a joint where each strut leaves the blend of a branch point.

    And where one leaves the step at a joint or an extremity whose radius is not its own. Sharp
    bends are left to bevels.

    Parameters
    ----------
    positions : (w, 3) float64, mm; the partition vertices seen from their nodes
    corner_distance : distance of a section's corners from its node, in radii
    like : (m, 2) bool; exactly these ends get a collar, squeezed together where there is room for
        others only
    """
    near, far = collar_distances(
        skeleton, stars, positions, corner_distance, like
    ).T  # (m,), nan for none
    fractions = np.stack([near / skeleton.lengths, 1.0 - far / skeleton.lengths], axis=1)  # (m, 2)
    return split_edges(without_collars(skeleton), fractions, skeleton.edge_radii)


def split_edges(refinement: Refinement, fractions: Floats, edge_radii: Floats) -> Refinement:
    """Return a refinement with more joints on its edges.

    Parameters
    ----------
    fractions : (m', 2) float64, where on each edge joints are added; nan for none
    edge_radii : (m', 2) float64, radii of each strut at its ends, mm; the new joints have its
        radius there
    """
    skeleton = refinement.skeleton
    ends = skeleton.edges
    added = np.isfinite(fractions)
    edge, slot = np.nonzero(added)
    share = fractions[edge, slot][:, None]
    start, end = ends[edge, 0], ends[edge, 1]
    nodes = (1.0 - share) * skeleton.nodes[start] + share * skeleton.nodes[end]
    near_radius, far_radius = edge_radii[edge].T
    radii = (1.0 - share[:, 0]) * near_radius + share[:, 0] * far_radius

    # The stops of each edge in order: start, new joints, end.
    stops = np.full((len(ends), 4), -1, dtype=np.intp)
    stops[:, 0], stops[:, 3] = ends.T
    stops[edge, slot + 1] = len(skeleton.nodes) + np.arange(len(edge))
    owner = np.repeat(np.arange(len(ends)), 4).reshape(-1, 4)[stops >= 0]
    flat = stops[stops >= 0]
    joined = owner[:-1] == owner[1:]
    refined = Skeleton(
        np.concatenate([skeleton.nodes, nodes]),
        np.stack([flat[:-1], flat[1:]], axis=1)[joined],
        np.concatenate([skeleton.radii, radii]),
    )
    collared = refinement.collared | added.reshape(-1)[refinement.leaving].reshape(-1, 2)
    edge_of_edge = refinement.edge_of_edge[owner[:-1][joined]]
    return Refinement(refined, edge_of_edge, collared, refinement.beveled)


def strut_radii(skeleton: Skeleton, refinement: Refinement) -> Floats:
    """Return the radius of each edge of the refined skeleton at its ends, (m', 2), mm.

    They are the struts' own, also where those differ from the radii of their nodes; between a
    collar and a joint or an extremity they end at the node's.
    """
    radii = refinement.skeleton.edge_radii.reshape(-1).copy()
    stepped = refinement.collared & ~refinement.beveled & (skeleton.valency[skeleton.edges] < 3)
    own = np.where(stepped, skeleton.radii[skeleton.edges], skeleton.edge_radii)
    radii[refinement.leaving] = own.reshape(-1)
    return radii.reshape(-1, 2)


def sharp_bends(skeleton: Skeleton) -> Bools:
    """Return which nodes are joints whose miter would exceed `MITER_LIMIT`, (n,)."""
    sharp = np.zeros(len(skeleton.nodes), dtype=np.bool_)
    joints = skeleton.joints
    sharp[joints] = _half_sines(skeleton) > np.sqrt(1.0 - MITER_LIMIT**-2)
    return sharp


def _half_sines(skeleton: Skeleton) -> Floats:
    """Return the sine of half the turn at each joint, (j,)."""
    pairs = skeleton.incidence.at_nodes(skeleton.joints, 2)  # (j, 2)
    sines: Floats = length(skeleton.directions[pairs].sum(axis=1)) / 2.0
    return sines


def _extents(skeleton: Skeleton, corner_distance: float) -> Floats:
    """Return how far joints and extremities reach along each of their struts, (m, 2), mm.

    As far as the miter at a bend, and to where the strut leaves a ball: a node whose radius is
    larger than that of each of its struts.
    """
    reach = np.zeros(len(skeleton.nodes))
    sines = _half_sines(skeleton)
    widening = 1.0 / np.maximum(np.sqrt(np.maximum(1.0 - sines**2, 0.0)), 1.0 / MITER_LIMIT)
    reach[skeleton.joints] = corner_distance * skeleton.radii[skeleton.joints] * sines * widening

    largest = largest_at_nodes(skeleton.edges, skeleton.edge_radii, len(skeleton.nodes))
    ball = np.where(skeleton.radii > (1.0 + STEP) * largest, skeleton.radii, 0.0)
    chord = np.maximum(ball[skeleton.edges] ** 2 - skeleton.edge_radii**2, 0.0)  # (m, 2)
    extents: Floats = np.maximum(reach[skeleton.edges], np.sqrt(chord))
    return extents


def collar_distances(
    skeleton: Skeleton,
    stars: Stars,
    positions: Points,
    corner_distance: float,
    like: Bools | None = None,
) -> Floats:
    """Return how far from each end of each edge its collar stands, (m, 2), mm; nan for none.

    Beyond the furthest corner of the node, and at a branch point where the cone of the spherical
    quad has become wide enough for the collar's own corners.

    An edge with no room for two gets one in the middle of the room that is left, or none.
    """
    at_branch = stars.corners[:, 0] >= 0  # (2 m,)
    corner = positions[stars.corners[at_branch]]  # (k, 4, 3)
    axis = np.broadcast_to(skeleton.directions[at_branch][:, None, :], corner.shape)
    extent = _extents(skeleton, corner_distance).reshape(-1)
    extent[at_branch] = dot(corner, axis).max(axis=1)
    extents = extent.reshape(-1, 2)
    radii = skeleton.edge_radii
    # A wider clearance than a right angle leaves room at once.
    slope = np.tan(np.clip(stars.clearance, 1e-6, 1.5)).reshape(-1, 2)
    wide_enough = WIDER * corner_distance * radii.max(axis=1)[:, None] / slope
    # (m, 2); no cone, nan, where an end is not a branch point
    wanted: Floats = np.fmax(extents + BLEND * radii, wide_enough)

    placed = _placed(skeleton, wanted, extents, at_branch.reshape(-1, 2) | _stepped(skeleton))
    if like is None:
        return placed
    wanted[~like] = np.nan
    total = np.nansum(wanted, axis=1)
    squeeze = np.minimum(1.0, MOST_SQUEEZED * skeleton.lengths / np.maximum(total, 1e-300))
    same = (np.isfinite(placed) == like).all(axis=1)
    kept: Floats = np.where(same[:, None], placed, wanted * squeeze[:, None])
    return kept


def _placed(skeleton: Skeleton, wanted: Floats, extents: Floats, asked: Bools) -> Floats:
    """Return how far from each end of each edge its collar stands by the room there is, (m, 2)."""
    lengths, radii = skeleton.lengths, skeleton.edge_radii
    wanted = np.where(asked, wanted, np.nan)
    # Collars closer than that to a node could not be told from it.
    coordinate = np.abs(skeleton.nodes[skeleton.edges]).max(axis=(1, 2))  # (m,)
    least = np.maximum(LEAST_STRUT * radii.max(axis=1), RESOLUTION * coordinate)
    wanted[wanted < least[:, None]] = np.nan
    taken = np.where(np.isfinite(wanted), wanted, extents).sum(axis=1)
    fits = lengths - taken >= least
    room = lengths - extents.sum(axis=1)
    wanted[~fits] = np.nan
    one = np.flatnonzero(~fits & (room >= least) & asked.any(axis=1))
    slot = np.where(asked[one, 0], 0, 1)
    wanted[one, slot] = extents[one, slot] + room[one] / 2
    return wanted


def _stepped(skeleton: Skeleton) -> Bools:
    """Return which ends of struts at joints and extremities have another radius, (m, 2)."""
    at_nodes = skeleton.radii[skeleton.edges]
    other = np.abs(at_nodes - skeleton.edge_radii) > STEP * at_nodes
    calm = (skeleton.valency < 3) & ~sharp_bends(skeleton)
    return np.asarray(other & calm[skeleton.edges])
