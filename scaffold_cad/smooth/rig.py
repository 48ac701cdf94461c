"""The control mesh taken apart into sections that can be scaled, with sections added to it.

A dome is round only if a section stands close before it, and a strut is straight up to a bend only
if sections stand on both sides of the bend.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.arrays import Bools, Floats, Ints, Points
from scaffold_cad.collars import BLEND
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.sleeves import MITER_LIMIT
from scaffold_cad.vectors import angle_between, dot

DOME_DISTANCE = 0.8
"""Distance of the section before a dome from the extremity's node, in radii. With it the limit is
a hemisphere within 3 % of its radius."""

DOME_SCALE = 1.056
"""Size of the cap of a dome, as a multiple of the strut's section; found as `DOME_DISTANCE` was."""

BEND_SHIFT = 1 / 8
"""Shift of the section in a bend away from the sections beside it, as a part of their distances.
The limit's axis passes the node half as far inside as without: neither side of the bend is thin."""

LEAST_BEND = np.radians(10.0)
"""Bend at a joint of collared struts from which sections are added beside it, rad."""


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

    half_edges, depths = _added_sections(scaffold, domes)  # (k,)
    edge, slot = half_edges >> 1, half_edges & 1
    along = refined.directions[half_edges]
    end = scaffold.sleeves[edge, slot]  # (k, 4)
    added = len(centres) + np.arange(end.size).reshape(-1, 4)

    sleeves = scaffold.sleeves.copy()
    sleeves[edge, slot] = added
    rows = 4 * edge[:, None] + np.arange(4)  # (k, 4)
    quads = scaffold_quads.copy()
    quads[rows] = _sides(sleeves[edge, 0], sleeves[edge, 1])
    at_start = (slot == 0)[:, None]
    cut = _sides(np.where(at_start, end, added), np.where(at_start, added, end))

    # The section at the node, seen along the strut, is a square of the node's radius.
    axis = np.broadcast_to(along[:, None, :], (len(along), 4, 3))
    flat = spokes[end] - dot(spokes[end], axis)[..., None] * axis
    radii = refined.radii[refined.edges[edge]]
    radii = np.where(at_start, radii, radii[:, ::-1])  # (k, 2): the node's, the other's
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
    np.add.at(centres, end[~is_dome], -BEND_SHIFT * (depths[:, None] * along)[~is_dome, None, :])
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


def _added_sections(scaffold: Scaffold, domes: bool) -> tuple[Ints, Floats]:
    """Return the half-edges that get a section, and how far from their tails, (k,) each.

    An edge gets them only if they take less than half of it.
    """
    refined = scaffold.refined
    depth = np.zeros(2 * len(refined.edges))
    if domes:
        depth[refined.leaving_extremities] = DOME_DISTANCE * refined.radii[refined.extremities]
    if scaffold.options.collars:
        leaving = refined.incidence.at_nodes(refined.joints, 2)  # (j, 2)
        ways = refined.directions[leaving]
        bend = np.pi - angle_between(ways[:, 0], ways[:, 1])
        # Clear of the inner corner of the bend.
        corner = np.minimum(np.tan(bend / 2), MITER_LIMIT) * scaffold.options.corner_distance
        reach = np.where(bend > LEAST_BEND, corner + BLEND, 0.0) * refined.radii[refined.joints]
        depth[leaving] = reach[:, None]
    taken = depth.reshape(-1, 2).sum(axis=1)
    has_room = np.repeat(2 * taken <= refined.lengths, 2)
    half_edges = np.flatnonzero(has_room & (depth > 0))
    return half_edges, depth[half_edges]


def _sides(near: Ints, far: Ints) -> Ints:
    """Return the four quads between the sections (k, 4) at both ends of each sleeve, (k, 4, 4)."""
    return np.stack([near, np.roll(near, -1, axis=1), np.roll(far, -1, axis=1), far], axis=2)
