"""The control mesh taken apart into sections that can be scaled, with sections added to it.

A dome is round only if a section stands close before it, and struts turn a corner only if sections
stand on both sides of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.vectors import dot
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.collars import collar_distances
from scaffold_cad.scaffold.sleeves import sleeve_quads
from scaffold_cad.scaffold.stars import APOTHEM
from scaffold_cad.smooth.bends import Bends, bends_of
from scaffold_cad.smooth.branches import fitting_squares, pulled_half_edges

DOME_DISTANCE = 0.8
"""Distance of the section before a dome from the extremity's node, in radii. With it the limit is
a hemisphere within 3 % of its radius."""

DOME_SCALE = 1.056
"""Size of the cap of a dome, as a multiple of the strut's section; found as `DOME_DISTANCE` was."""

ROOM = 0.9
"""Part of an edge, less the blend of a branch point, that added sections may take."""

LEAST_DEPTH = 0.25
"""Least distance of an added section from its node, in radii; there is none where that is more than
the edge has room for."""


@dataclass(frozen=True, eq=False)
class Rig:
    """The control mesh before its sections are scaled: each vertex at a spoke from its centre."""

    quads: Ints
    """Vertices of each quad, shape (f, 4): those of the scaffold, then four a section added."""
    sleeves: Ints
    """As in `Scaffold`, but a piece of strut ends where a section was added, shape (m', 2, 4)."""
    centres: Points
    """Centre of each vertex's section, shape (v, 3), mm."""
    spokes: Points
    """From the centre to the vertex, shape (v, 3), mm."""
    group: Ints
    """Vertex of the scaffold, or of its own section, with which each vertex is scaled, (v,)."""
    quad_of_quad: Ints
    """Scaffold quad that each quad is a part of, shape (f,)."""
    is_own: Bools
    """Whether each vertex belongs to one strut only, shape (v,)."""


def make_rig(scaffold: Scaffold, domes: bool) -> Rig:
    """Return the control mesh of `scaffold`; with or without sections for `domes`."""
    refined, scaffold_quads = scaffold.refined, scaffold.mesh.quads
    centres = refined.nodes[scaffold.node_of_vertex]
    spokes = scaffold.mesh.vertices - centres

    depth, bends = _added_sections(scaffold, spokes, domes)
    half_edges = np.flatnonzero(depth)  # (k,)
    edge, slot = half_edges >> 1, half_edges & 1
    along = refined.directions[half_edges]
    end = scaffold.sleeves[edge, slot]  # (k, 4)
    added = len(centres) + np.arange(end.size).reshape(-1, 4)

    sleeves = scaffold.sleeves.copy()
    sleeves[edge, slot] = added
    rows = 4 * edge[:, None] + np.arange(4)  # (k, 4)
    quads = scaffold_quads.copy()
    quads[rows] = sleeve_quads(sleeves[edge, 0], sleeves[edge, 1])
    at_start = (slot == 0)[:, None]
    cut = sleeve_quads(np.where(at_start, end, added), np.where(at_start, added, end))

    radii = refined.radii[refined.edges[edge]]
    radii = np.where(at_start, radii, radii[:, ::-1])  # (k, 2): the node's, the other's
    # The section at a joint or extremity, seen along the strut, is a square of the node's radius.
    axis = along[:, None]
    flat = spokes[end] - dot(spokes[end], axis)[..., None] * axis
    at_branch = refined.valency[refined.edges[edge, slot]] >= 3
    squares = fitting_squares(spokes[end[at_branch]], refined.directions[2 * edge[at_branch]])
    flat[at_branch] = (scaffold.options.corner_distance * radii[at_branch, :1])[..., None] * squares
    depths = depth[half_edges]
    growth = 1 + (radii[:, 1] / radii[:, 0] - 1) * depths / refined.lengths[edge]
    places = centres[end] + (depths[:, None] * along)[:, None, :]
    # A dome is as wide as the strut before it; a bend has a width of its own.
    is_dome = refined.valency[refined.edges[edge, slot]] == 1
    branch_or_bend = (refined.valency > 1) & (
        np.arange(len(refined.nodes)) < len(scaffold.skeleton.nodes)
    )
    is_own = np.ones(len(centres) + end.size, dtype=np.bool_)
    is_own[: len(centres)] = ~branch_or_bend[scaffold.node_of_vertex]
    group = np.concatenate(
        [np.arange(len(centres)), np.where(is_dome[:, None], end, added).reshape(-1)]
    )
    if domes:
        spokes[scaffold_quads[cap_rows(scaffold)]] *= DOME_SCALE
    at_bend = scaffold.sleeves.reshape(-1, 4)[bends.leaving[:, 0]]  # (b, 4)
    even = APOTHEM["round"] / APOTHEM[scaffold.options.section] * spokes[at_bend]
    shifts, spokes[at_bend] = bends.placed(even, depth[bends.leaving])
    centres[at_bend] += shifts[:, None]
    return Rig(
        is_own=is_own,
        quads=np.concatenate([quads, cut.reshape(-1, 4)]),
        sleeves=sleeves,
        centres=np.concatenate([centres, places.reshape(-1, 3)]),
        spokes=np.concatenate([spokes, (growth[:, None, None] * flat).reshape(-1, 3)]),
        group=group,
        quad_of_quad=np.concatenate([np.arange(len(scaffold_quads)), rows.reshape(-1)]),
    )


def cap_rows(scaffold: Scaffold) -> Ints:
    """Return which quads are caps, in the order of the extremities, (k,)."""
    return 4 * len(scaffold.refined.edges) + np.arange(len(scaffold.refined.extremities))


def _added_sections(scaffold: Scaffold, spokes: Floats, domes: bool) -> tuple[Floats, Bends]:
    """Return how far along each half-edge a section is added, (2 m',), mm, and the bends they make.

    0 where none is. Two that an edge has no room for get half of it each, or what the other leaves.
    """
    refined = scaffold.refined
    tails = refined.edges.reshape(-1)
    wanted = np.zeros(len(tails))
    if domes:
        wanted[refined.leaving_extremities] = DOME_DISTANCE * refined.radii[refined.extremities]
    bends = bends_of(scaffold)
    wanted[bends.leaving] = bends.reach[:, None]
    blends = _blends(scaffold, spokes)
    pulled = pulled_half_edges(scaffold)
    wanted[pulled] = _to_collars(scaffold, spokes)[pulled] - blends[pulled]

    pairs = wanted.reshape(-1, 2)
    room = ROOM * (refined.lengths - blends.reshape(-1, 2).sum(axis=1))[:, None]
    depth = np.minimum(pairs, np.maximum(room / 2, room - pairs[:, ::-1])).reshape(-1)
    depth[depth < LEAST_DEPTH * refined.radii[tails]] = 0.0
    # Nearer to a branch point its cones are too narrow.
    depth[pulled[depth[pulled] < wanted[pulled]]] = 0.0
    depth[depth > 0] += blends[depth > 0]
    has_both = depth[bends.leaving].all(axis=1)
    depth[bends.leaving[~has_both]] = 0.0
    return depth, bends.chosen(has_both)


def _to_collars(scaffold: Scaffold, spokes: Floats) -> Floats:
    """Return how far along each half-edge its collar would stand, 0 for none, (2 m,), mm."""
    options, stars = scaffold.options, scaffold.stars
    found = collar_distances(scaffold.skeleton, stars, spokes, options.corner_distance)
    return np.nan_to_num(found.reshape(-1))


def _blends(scaffold: Scaffold, spokes: Floats) -> Floats:
    """Return how far each half-edge is inside the star of its branch point, (2 m',), mm."""
    refined = scaffold.refined
    leaving = np.flatnonzero(refined.valency[refined.edges.reshape(-1)] >= 3)
    corners = spokes[scaffold.sleeves.reshape(-1, 4)[leaving]]  # (k, 4, 3)
    blends = np.zeros(2 * len(refined.edges))
    blends[leaving] = dot(corners, refined.directions[leaving][:, None]).max(axis=1)
    return blends
