"""The control mesh of a smooth solid: the scaffold, moved so that its limit has the asked radii.

The Catmull-Clark limit lies inside the scaffold. The mean radius of the limit is measured in the
middle of each strut, and the sections at its ends are scaled until it is what the skeleton asks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from scaffold_cad.arrays import Edges, Floats, Ints, Points, UnitVectors
from scaffold_cad.collars import BLEND
from scaffold_cad.errors import OptionError
from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.sleeves import MITER_LIMIT
from scaffold_cad.smooth.catmull_clark import (
    NO_CREASES,
    Connectivity,
    limit_points,
    subdivided_points,
)
from scaffold_cad.vectors import angle_between, dot, length

Caps: TypeAlias = Literal["round", "flat"]
"""How extremities end: in a dome that reaches one radius beyond the node, or flat at the node."""

RADIUS_TOLERANCE = 0.002
"""Part of its radius by which a strut's mean radius may be off when the scaling stops."""

MOST_ROUNDS = 12
"""Most times that the sections are scaled; collared struts need two."""

MOST_SCALED = 2.0
"""Most that a section is scaled up, or down."""

RING_DISTANCE = 0.8
"""Distance of the section before a dome from the extremity's node, in radii. With it the limit is
a hemisphere within 3 % of its radius."""

DOME_SCALE = 1.056
"""Size of the cap of a dome, as a multiple of the strut's section; found as `RING_DISTANCE` was."""

LEAST_BEND = np.radians(10.0)
"""Bend at a joint of collared struts from which sections are added beside it, rad."""

APEX_WEIGHT = 0.92
"""Part of the shift of a dome's cap that the dome's top follows."""


@dataclass(frozen=True, eq=False)
class ControlMesh:
    """A closed quad mesh whose Catmull-Clark limit is the smooth solid."""

    mesh: QuadMesh
    """The quads of the scaffold in their order, on moved vertices, and four more for each section
    that was added."""
    creases: Edges
    """Vertex pairs of the edges that stay sharp, around flat caps, shape (k, 2)."""
    quad_of_quad: Ints
    """Scaffold quad that each quad is a part of, shape (f,)."""


@dataclass(frozen=True, eq=False)
class _Rig:
    """The control mesh before its sections are scaled: each vertex at a spoke from its centre."""

    quads: Ints
    """Vertices of each quad, (f, 4): four an edge, the caps, four a ring."""
    sleeves: Ints
    """As in `Scaffold`, but a piece of strut ends where a dome begins, (m', 2, 4)."""
    centres: Points
    """Centre of each vertex's section, (v, 3), mm."""
    spokes: Points
    """From the centre to the vertex, (v, 3), mm."""
    group: Ints
    """Which vertices are scaled as one, (v,)."""
    quad_of_quad: Ints
    """Scaffold quad that each quad is a part of, (f,)."""


@dataclass(frozen=True, eq=False)
class _Rings:
    """Sections to be added to the scaffold's."""

    half_edges: Ints
    """Half-edge of the refined skeleton on which each one is, (k,)."""
    depths: Floats
    """Distance from the node that the half-edge leaves, (k,), mm."""


@dataclass(frozen=True, eq=False)
class _MidSections:
    """Where the radius of each strut is measured, in the once subdivided control mesh."""

    samples: Ints
    """Vertices of the subdivided mesh around the middle of each strut, (m, 8)."""
    ends: Ints
    """Vertices of the control mesh at both ends of the piece of strut, (m, 8)."""
    starts: Points
    """Where the piece of strut starts, (m, 3), mm."""
    axes: UnitVectors
    """Direction of the strut, (m, 3)."""
    lengths: Floats
    """Length of the piece, (m,), mm."""
    radii: Floats
    """Radius asked for at both ends of the piece, (m, 2), mm."""

    def wanted_over_measured(self, points: Points) -> Floats:
        """Return how much too thin each strut is among `points` of the limit surface, (m,)."""
        around = points[self.samples]  # (m, 8, 3)
        centres = around.mean(axis=1)
        share = np.clip(dot(centres - self.starts, self.axes) / self.lengths, 0.0, 1.0)
        wanted = (1 - share) * self.radii[:, 0] + share * self.radii[:, 1]
        spokes = around - centres[:, None, :]
        axes = np.broadcast_to(self.axes[:, None, :], spokes.shape)
        across = spokes - dot(spokes, axes)[..., None] * axes
        ratio: Floats = wanted / length(across).mean(axis=1)
        return ratio


@dataclass(frozen=True, eq=False)
class _Domes:
    """The ends that are to be round."""

    caps: Ints
    """Vertices of each cap, (k, 4)."""
    middles: Ints
    """Vertex of the subdivided mesh in the middle of each cap, (k,)."""
    tops: Points
    """Where the top of each dome should be, (k, 3), mm."""
    outward: UnitVectors
    """Direction in which each strut ends, (k, 3)."""
    tolerance: Floats
    """How far the top may be from there, (k,), mm."""

    def missing(self, points: Points) -> Points:
        """Return how far each top must move, (k, 3), mm, given `points` of the limit surface."""
        short = dot(self.tops - points[self.middles], self.outward)
        return short[:, None] * self.outward


def control_mesh(scaffold: Scaffold, caps: Caps = "round") -> ControlMesh:
    """Return the mesh whose Catmull-Clark limit has the radii of the scaffold's skeleton.

    The mean radius of the limit in the middle of each strut is the strut's, whatever the
    scaffold's `section`. It is exact where every strut has a section of its own, and so for
    `collars=True`; else struts that share their sections come as near as these allow. A section
    is added before each dome, so that it is round, and with `collars=True` beside each bend, so
    that struts are straight up to it, where edges have room for them.

    Parameters
    ----------
    caps : "round" ends each extremity in a dome that reaches one radius beyond its node, "flat"
        in a plane at its node

    Raises
    ------
    OptionError
        If `caps` has none of its values.
    """
    if caps not in get_args(Caps):
        raise OptionError(f"caps is {caps!r}; need one of {', '.join(get_args(Caps))}")
    rig = _with_rings(scaffold, _rig(scaffold), _rings(scaffold, caps))
    if caps == "round":
        rig.spokes[scaffold.mesh.quads[_cap_rows(scaffold)]] *= DOME_SCALE
    creases = _cap_sides(scaffold) if caps == "flat" else NO_CREASES
    mesh = QuadMesh(rig.centres + rig.spokes, rig.quads)
    coarse = Connectivity.of(mesh, creases)
    fine = coarse.subdivided()
    middles = _mid_sections(scaffold, rig.sleeves, coarse)
    domes = _domes(scaffold, coarse, caps)

    scale = np.ones(rig.group.max(initial=-1) + 1)
    shift = np.zeros_like(rig.spokes)
    points = rig.centres + rig.spokes
    for _ in range(MOST_ROUNDS):
        limits = limit_points(fine, subdivided_points(coarse, points))
        ratio = middles.wanted_over_measured(limits)
        missing = domes.missing(limits)
        reached = length(missing) < domes.tolerance
        if reached.all() and np.abs(ratio - 1).max(initial=0.0) < RADIUS_TOLERANCE:
            break
        scale *= _mean_by_group(rig.group, middles.ends, ratio)
        scale = np.clip(scale, 1 / MOST_SCALED, MOST_SCALED)
        shift[domes.caps] += missing[:, None, :] / APEX_WEIGHT
        points = rig.centres + shift + scale[rig.group][:, None] * rig.spokes
    return ControlMesh(mesh.moved(points), creases, rig.quad_of_quad)


def _rig(scaffold: Scaffold) -> _Rig:
    """Return the scaffold as it is."""
    centres = scaffold.refined.nodes[scaffold.node_of_vertex]
    vertex = np.arange(len(centres))
    alone = len(scaffold.stars.vertices)
    return _Rig(
        quads=scaffold.mesh.quads,
        sleeves=scaffold.sleeves,
        centres=centres,
        spokes=scaffold.mesh.vertices - centres,
        # Four a section; each vertex of a star on its own.
        group=np.where(vertex < alone, vertex, alone + (vertex - alone) // 4),
        quad_of_quad=np.arange(len(scaffold.mesh.quads)),
    )


def _with_rings(scaffold: Scaffold, rig: _Rig, rings: _Rings) -> _Rig:
    """Return `rig` with one more section in each of `rings`."""
    refined = scaffold.refined
    edge, slot = rings.half_edges >> 1, rings.half_edges & 1
    along = refined.directions[rings.half_edges]  # (k, 3)
    end = rig.sleeves[edge, slot]  # (k, 4)
    ring = len(rig.centres) + np.arange(end.size).reshape(-1, 4)

    sleeves = rig.sleeves.copy()
    sleeves[edge, slot] = ring
    rows = 4 * edge[:, None] + np.arange(4)  # (k, 4)
    quads = rig.quads.copy()
    quads[rows] = _sides(sleeves[edge, 0], sleeves[edge, 1])
    at_start = (slot == 0)[:, None]
    cut = _sides(np.where(at_start, end, ring), np.where(at_start, ring, end))

    # The section at the node, seen along the strut, is a square of the node's radius.
    spokes = rig.spokes[end]
    axis = np.broadcast_to(along[:, None, :], spokes.shape)
    spokes = spokes - dot(spokes, axis)[..., None] * axis
    radii = refined.radii[refined.edges[edge]]
    radii = np.where(at_start, radii, radii[:, ::-1])  # (k, 2): the node's, the other's
    growth = 1 + (radii[:, 1] / radii[:, 0] - 1) * rings.depths / refined.lengths[edge]
    spokes = spokes * growth[:, None, None]
    centres = rig.centres[end] + (rings.depths[:, None] * along)[:, None, :]
    # A dome is as wide as the strut before it; a bend has a width of its own.
    first = int(rig.group.max(initial=-1)) + 1
    own = first + np.arange(len(end))[:, None]
    is_dome = refined.valency[refined.edges[edge, slot]] == 1
    group = np.where(is_dome[:, None], rig.group[end], own)
    return _Rig(
        quads=np.concatenate([quads, cut.reshape(-1, 4)]),
        sleeves=sleeves,
        centres=np.concatenate([rig.centres, centres.reshape(-1, 3)]),
        spokes=np.concatenate([rig.spokes, spokes.reshape(-1, 3)]),
        group=np.concatenate([rig.group, group.reshape(-1)]),
        quad_of_quad=np.concatenate([rig.quad_of_quad, rows.reshape(-1)]),
    )


def _rings(scaffold: Scaffold, caps: Caps) -> _Rings:
    """Return where sections are added: before domes, and beside the bends of collared struts."""
    refined = scaffold.refined
    depth = np.zeros(2 * len(refined.edges))
    if caps == "round":
        depth[_leaving_extremities(scaffold)] = RING_DISTANCE * refined.radii[refined.extremities]
    if scaffold.options.collars:
        joints = refined.joints
        leaving = refined.incidence.at_nodes(joints, 2)  # (k, 2)
        ways = refined.directions[leaving]
        bend = np.pi - angle_between(ways[:, 0], ways[:, 1])
        reach = np.minimum(np.tan(bend / 2), MITER_LIMIT) * scaffold.options.corner_distance
        blend = np.where(bend > LEAST_BEND, reach + BLEND, 0.0) * refined.radii[joints]
        depth[leaving] = blend[:, None]
    taken = depth.reshape(-1, 2).sum(axis=1)
    room = np.repeat(2 * taken <= refined.lengths, 2)
    half_edges = np.flatnonzero(room & (depth > 0))
    return _Rings(half_edges, depth[half_edges])


def _sides(near: Ints, far: Ints) -> Ints:
    """Return the four quads between two sections (k, 4) of each sleeve, (k, 4, 4)."""
    return np.stack([near, np.roll(near, -1, axis=1), np.roll(far, -1, axis=1), far], axis=2)


def _leaving_extremities(scaffold: Scaffold) -> Ints:
    """Return the half-edge of the refined skeleton that leaves each extremity."""
    refined = scaffold.refined
    return refined.incidence.at_nodes(refined.extremities, 1)[:, 0]


def _cap_rows(scaffold: Scaffold) -> Ints:
    """Return which quads are caps, in the order of the extremities."""
    return 4 * len(scaffold.refined.edges) + np.arange(len(scaffold.refined.extremities))


def _cap_sides(scaffold: Scaffold) -> Edges:
    """Return the vertex pairs of all sides of the caps, (4 k, 2)."""
    caps = scaffold.mesh.quads[_cap_rows(scaffold)]
    return np.stack([caps, np.roll(caps, -1, axis=1)], axis=2).reshape(-1, 2)


def _domes(scaffold: Scaffold, coarse: Connectivity, caps: Caps) -> _Domes:
    """Return the ends that are to be round: all extremities, or none."""
    refined = scaffold.refined
    which = slice(None) if caps == "round" else slice(0)
    nodes = refined.extremities[which]
    rows = _cap_rows(scaffold)[which]
    outward = -refined.directions[_leaving_extremities(scaffold)][which]
    radii = refined.radii[nodes]
    return _Domes(
        caps=scaffold.mesh.quads[rows],
        middles=coarse.count + len(coarse.edges) + rows,
        tops=refined.nodes[nodes] + radii[:, None] * outward,
        outward=outward,
        tolerance=RADIUS_TOLERANCE * radii,
    )


def _mid_sections(scaffold: Scaffold, sleeves: Ints, coarse: Connectivity) -> _MidSections:
    """Return where the radius of each strut of the skeleton is measured.

    In the middle of the piece between its collars, or at its only collar if that stands between
    two branch points.
    """
    collared = scaffold.refinement.collared
    pieces = 1 + collared.sum(axis=1)
    # The second of three, and the one of two that leads away from the branch point.
    piece = np.cumsum(pieces) - pieces + collared[:, 0]  # (m,)
    branch = scaffold.skeleton.valency[scaffold.skeleton.edges] >= 3
    alone = (pieces == 2) & branch.all(axis=1)

    first_edge, first_quad = coarse.count, coarse.count + len(coarse.edges)
    quads = 4 * piece[:, None] + np.arange(4)  # (m, 4)
    rails = coarse.edge_of_side[quads, 3]
    samples = np.concatenate([first_edge + rails, first_quad + quads], axis=1)
    ends = sleeves[piece].reshape(-1, 8)
    # A lone collar is the start of the second piece or the end of the first.
    at = np.where(collared[alone, 0], 0, 1)
    ring = sleeves[piece[alone], at]  # (j, 4)
    around = coarse.edge_of_side[quads[alone], 2 * at[:, None]]
    samples[alone] = np.concatenate([ring, first_edge + around], axis=1)
    ends[alone] = np.concatenate([ring, ring], axis=1)

    refined = scaffold.refined
    return _MidSections(
        samples=samples,
        ends=ends,
        starts=refined.nodes[refined.edges[piece, 0]],
        axes=refined.directions[2 * piece],
        lengths=refined.lengths[piece],
        radii=refined.radii[refined.edges[piece]],
    )


def _mean_by_group(group: Ints, vertices: Ints, values: Floats) -> Floats:
    """Return the mean of `values` (m,) over the `vertices` (m, 8) of each group; 1 without any."""
    owners = group[vertices].reshape(-1)
    groups = int(group.max(initial=-1)) + 1
    count = np.bincount(owners, minlength=groups)
    total = np.bincount(owners, np.repeat(values, vertices.shape[1]), minlength=groups)
    return np.divide(total, count, out=np.ones(groups), where=count > 0)
