"""Where the outer points of a scaffold's hexahedra stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.mechanics.hexahedra.plans import Plan, Span
from scaffold_cad.mechanics.hexahedra.sections import Frame
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.collars import strut_radii

OCTAGON = float(np.sqrt(np.pi / (2.0 * np.sqrt(2.0))))
"""Corner distance of the regular octagon of a circle's area, in radii."""

REACH = 0.45
"""Part of an edge between branch points that the surface of one of them may take."""

FREE_REACH = 0.8
"""The same where the other end is not one."""


def scaffold_plan(scaffold: Scaffold, pieces: int) -> Plan:
    """Return the sections of a scaffold: two per edge, which it shares at nodes."""
    refined, sides = scaffold.refined, section_sides(scaffold)
    rim = surface_points(scaffold, sides)
    owner = np.concatenate([scaffold.node_of_vertex, sides.node])
    around = np.empty((len(refined.edges), 2, 8), dtype=np.intp)
    around[..., ::2] = scaffold.sleeves
    around[..., 1::2] = len(scaffold.node_of_vertex) + sides.of_end
    branches = refined.valency >= 3
    frame = Frame(
        refined.nodes,
        rim,
        owner,
        refined.edges.reshape(-1),
        around.reshape(-1, 8),
        branches,
        branches[owner],
        refined.radii,
    )
    pairs = np.arange(2 * len(refined.edges)).reshape(-1, 2)
    at_branch = branches[refined.edges]  # (m', 2)
    edge = scaffold.refinement.edge_of_edge
    nodes = np.where(at_branch, refined.edges, -1)
    span = Span(pairs, pieces, edge, nodes, np.flatnonzero(~at_branch.any(axis=1)))
    closing = np.flatnonzero((refined.valency == 1)[frame.hub])
    return Plan(frame, (span,), None, closing, frame.hub[closing])


@dataclass(frozen=True, eq=False)
class Sides(Frozen):
    """The sides of all sections, each once."""

    ends: Ints
    """Vertices of the scaffold's mesh that each joins, shape (s, 2)."""
    node: Ints
    """Node of the refined skeleton whose section it is in, shape (s,)."""
    of_end: Ints
    """Sides of the section at each edge's two ends: the j-th joins corners j and j + 1,
    shape (m', 2, 4)."""


def section_sides(scaffold: Scaffold) -> Sides:
    """Return the sides of all sections and arcs of all partitions."""
    sleeves = scaffold.sleeves
    pairs = np.stack([sleeves, np.roll(sleeves, -1, axis=2)], axis=3)  # (m', 2, 4, 2)
    low, high = pairs.min(axis=3).reshape(-1), pairs.max(axis=3).reshape(-1)
    key = low * len(scaffold.node_of_vertex) + high
    _, first, number = np.unique(key, return_index=True, return_inverse=True)
    ends = np.stack([low[first], high[first]], axis=1)
    return Sides(ends, scaffold.node_of_vertex[ends[:, 0]], number.reshape(sleeves.shape))


def surface_points(scaffold: Scaffold, sides: Sides) -> Points:
    """Return corners, then middles of sides, (v + s, 3), mm.

    At joints and extremities they lie on the section's circle, seen along the strut. At branch
    points they keep their directions and lie where the last of the struts beside them ends.
    """
    refined = scaffold.refined
    corner_node = scaffold.node_of_vertex
    offsets = scaffold.mesh.vertices - refined.nodes[corner_node]
    offsets = offsets / scaffold.options.corner_distance * OCTAGON
    offsets *= _section_scale(scaffold)[corner_node, None]
    a, b = sides.ends.T
    middles = (offsets[a] + offsets[b]) * np.sqrt(0.5)
    rim = np.concatenate([offsets, middles])
    owner = np.concatenate([corner_node, sides.node])
    at_branch = np.flatnonzero(refined.valency[owner] >= 3)
    directions = np.concatenate([normalize(offsets), np.zeros_like(middles)])
    directions[len(offsets) :] = normalize(directions[a] + directions[b])
    distance = _distances(scaffold, sides, directions)
    rim[at_branch] = directions[at_branch] * distance[at_branch, None]
    points: Points = refined.nodes[owner] + rim
    return points


def _section_scale(scaffold: Scaffold) -> Floats:
    """Return the mean radius of the struts at each joint and extremity over the node's, (n',)."""
    refined = scaffold.refined
    ends = refined.edges.reshape(-1)
    radii = strut_radii(scaffold.skeleton, scaffold.refinement).reshape(-1)
    total = np.bincount(ends, radii, minlength=len(refined.nodes))
    scale: Floats = total / refined.valency / refined.radii
    return scale


def _distances(scaffold: Scaffold, sides: Sides, directions: UnitVectors) -> Floats:
    """Return how far the struts beside each direction reach along it, (v + s,), mm."""
    refined = scaffold.refined
    points = np.concatenate([scaffold.sleeves, len(scaffold.node_of_vertex) + sides.of_end], axis=2)
    leaving = refined.valency[refined.edges] >= 3  # (m', 2)
    axes = np.stack([refined.directions[::2], refined.directions[1::2]], axis=1)  # (m', 2, 3)
    shared = leaving.all(axis=1)
    reach = refined.lengths * np.where(shared, REACH, FREE_REACH)
    # A cone is taken for the cylinder of its radius at the node.
    radius = strut_radii(scaffold.skeleton, scaffold.refinement) * OCTAGON  # (m', 2)
    edge, slot = np.nonzero(leaving)
    rows = points[edge, slot]  # (h, 8)
    axis = axes[edge, slot][:, None]
    unit = directions[rows]  # (h, 8, 3)
    along = dot(unit, np.broadcast_to(axis, unit.shape))
    across = np.maximum(length(unit - along[..., None] * axis), 1e-6)
    size = radius[edge, slot][:, None]
    wanted = np.where(along > 0, size / across, size)
    distance = np.zeros(len(directions))
    np.maximum.at(distance, rows, wanted)
    most = np.full(len(directions), np.inf)
    limit = np.where(along > 1e-9, reach[edge][:, None] / np.maximum(along, 1e-9), np.inf)
    np.minimum.at(most, rows, limit)
    nearer: Floats = np.minimum(distance, most)
    return nearer
