"""The B-rep of round struts: a cylinder or a cone a strut, four patches a strut at each node, ends.

Every ring is an exact circle about its strut. The patches of a node share their arcs and spokes,
and each collar's four arcs are shared with the strut's one face.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.topology import component_labels
from scaffold_cad.brep.analytic import (
    AnalyticBrep,
    Axes,
    BrepEdges,
    BrepFaces,
    Knots,
    SplineCurves,
    SplinePatches,
    Surface,
)
from scaffold_cad.brep.joining import PlaneRings, hollow
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.struts.curvefaces import CurveParts
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.options import Ends
from scaffold_cad.struts.rings import parameters_at
from scaffold_cad.struts.seams import QUARTER, Seams, seams
from scaffold_cad.struts.splines import Spline

TURN = 2 * np.pi


def brep_of_struts(struts: RoundStruts) -> AnalyticBrep:
    """Return the B-rep of round struts, one solid a connected part; hollow ones with their inside.

    Struts that overlap make faces that cross: `RoundStruts.overlapping` names them.
    """
    struts = struts if struts.inner is None else replace(struts, inner=struts.inner.straight)
    struts = struts.straight
    plan = _Plan.of(struts)
    outer = _shells_of(plan)
    if struts.inner is None:
        return outer
    inside = _Plan.of(struts.inner)
    is_open = np.zeros(len(outer.solid), dtype=np.bool_)
    ends = np.arange(len(plan.ends) if struts.options.ends == "open" else 0)
    shell = _shell_of_nodes(struts)[struts.runs.tails[plan.ends[ends]]]
    is_open[shell] = True
    runs = struts.runs
    rings = PlaneRings(
        runs.nodes[runs.tails[plan.ends[ends]]],
        -runs.directions[plan.ends[ends]],
        struts.x[plan.ends[ends]],
        np.stack([plan.end_rings + ends, inside.end_rings + ends], axis=1),
        np.stack([np.zeros(len(ends), dtype=np.bool_), np.ones(len(ends), dtype=np.bool_)], axis=1),
        shell,
        len(runs.edges) + runs.tails[plan.ends[ends]],
    )
    return hollow(outer, _shells_of(inside), rings, is_open)


def _shells_of(plan: _Plan) -> AnalyticBrep:
    """Return the outer faces of struts, but for the ends of open ones."""
    uses = [_patch_uses(plan), _strut_uses(plan), _curve_uses(plan)]
    if plan.caps == "flat":
        uses.append(_cap_uses(plan))
    elif plan.caps == "round":
        uses.append(_dome_uses(plan))
    face, order, edge, forward, parameters = (
        np.concatenate(column) for column in zip(*uses, strict=True)
    )
    sorting = np.lexsort((order, face))
    count = int(face.max()) + 1
    shell = _shell_of_nodes(plan.struts)[_nodes_of_faces(plan)]
    return AnalyticBrep(
        _points(plan),
        _edges(plan),
        BrepFaces(
            *_surfaces(plan),
            outward=np.ones(count, dtype=np.bool_),
            loops=np.arange(count + 1),
            uses=np.concatenate([[0], np.cumsum(np.bincount(face, minlength=count))]),
            edge=edge[sorting],
            forward=forward[sorting],
            parameters=parameters[sorting],
            shell=shell,
            name=_names(plan),
        ),
        np.arange(int(shell.max()) + 1),
        _texts(plan),
    )


Uses = tuple[Ints, Ints, Ints, Bools, Floats]
"""Face, place in its loop, edge, whether it runs along it, and parameters (u, 2, 2) of uses."""


@dataclass(frozen=True, eq=False)
class _Plan(Frozen):
    """The numbers of vertices, edges and faces."""

    struts: RoundStruts
    seams: Seams
    ringed: Ints
    """Half-runs at blended nodes, shape (r,)."""
    rank: Ints
    """Place of each half-run in `ringed`, or -1, shape (2 k,)."""
    split: Ints
    """Half-runs of `ringed` whose ring is split, shape (s,)."""
    split_rank: Ints
    """Place of each half-run in `split`, or -1, shape (2 k,)."""
    ends: Ints
    """Half-runs at extremities, shape (e,)."""
    end_rank: Ints
    """Place of each half-run in `ends`, or -1, shape (2 k,)."""
    caps: Ends
    """How struts end."""
    run_face: Ints
    """Place of each run's face among those of all runs, cylinders first, shape (k,)."""
    curves: CurveParts
    """Parts of curves."""

    @staticmethod
    def of(struts: RoundStruts) -> _Plan:
        runs = struts.runs
        at_end = runs.valency[runs.tails] == 1
        found = seams(struts)
        ringed, ends = np.flatnonzero(~at_end), np.flatnonzero(at_end)
        split = np.flatnonzero(~at_end & found.splits)
        is_cone = runs.slopes[0::2] != 0
        run_face = np.empty(len(is_cone), dtype=np.intp)
        run_face[np.argsort(is_cone, kind="stable")] = np.arange(len(is_cone))
        count = len(runs.tails)
        ranks = [_rank(members, count) for members in (ringed, split, ends)]
        caps = struts.options.ends
        return _Plan(
            struts,
            found,
            ringed,
            ranks[0],
            split,
            ranks[1],
            ends,
            ranks[2],
            caps,
            run_face,
            CurveParts.of(struts.curves),
        )

    # Edges: seams, base arcs, rests of split arcs, end rings, meridians, rings of closed curves,
    # arcs and spokes of nodes, spokes of curves.

    @property
    def base_arcs(self) -> int:
        return len(self.struts.runs.edges)

    @property
    def rest_arcs(self) -> int:
        return self.base_arcs + 4 * len(self.ringed)

    @property
    def end_rings(self) -> int:
        return self.rest_arcs + len(self.split)

    @property
    def meridians(self) -> int:
        return self.end_rings + len(self.ends)

    @property
    def curve_rings(self) -> int:
        return self.meridians + (len(self.ends) if self.caps == "round" else 0)

    @property
    def node_edges(self) -> int:
        return self.curve_rings + 4 * len(self.curves.own)

    @property
    def curve_spokes(self) -> int:
        return self.node_edges + 6 * self.node_half_runs

    @property
    def node_half_runs(self) -> int:
        return sum(group.half_runs.size for group in self.struts.blended)

    # Vertices: collar corners, splits, ends of struts, poles, corners of nodes, of closed curves.

    @property
    def split_vertices(self) -> int:
        return 4 * len(self.ringed)

    @property
    def end_vertices(self) -> int:
        return self.split_vertices + len(self.split)

    @property
    def poles(self) -> int:
        return self.end_vertices + len(self.ends)

    @property
    def node_vertices(self) -> int:
        return self.poles + (len(self.ends) if self.caps == "round" else 0)

    @property
    def curve_vertices(self) -> int:
        corners = sum(group.half_runs.size + 2 * len(group.nodes) for group in self.struts.blended)
        return self.node_vertices + corners

    # Faces: discs, struts, domes, patches of nodes, those of curves.

    @property
    def strut_faces(self) -> int:
        return len(self.ends) if self.caps == "flat" else 0

    @property
    def domes(self) -> int:
        return self.strut_faces + len(self.run_face)

    @property
    def patch_faces(self) -> int:
        return self.domes + (len(self.ends) if self.caps == "round" else 0)

    @property
    def curve_faces(self) -> int:
        return self.patch_faces + 4 * self.node_half_runs

    def seam_vertex(self, half_runs: Ints) -> Ints:
        """Return the vertex at which the seam meets the ring of each of some half-runs."""
        corner = 4 * self.rank[half_runs] + self.seams.quarter[half_runs]
        split = self.split_vertices + self.split_rank[half_runs]
        end = self.end_vertices + self.end_rank[half_runs]
        at_node = np.where(self.split_rank[half_runs] >= 0, split, corner)
        return np.where(self.end_rank[half_runs] >= 0, end, at_node)


def _rank(members: Ints, count: int) -> Ints:
    rank = np.full(count, -1, dtype=np.intp)
    rank[members] = np.arange(len(members))
    return rank


def _groups(plan: _Plan) -> list[tuple[BlendedNodes, int, int, int]]:
    """Return each group with the numbers of its first vertex, edge and face."""
    vertex, edge, face = plan.node_vertices, plan.node_edges, plan.patch_faces
    found = []
    for group in plan.struts.blended:
        nodes, valency = group.half_runs.shape
        found.append((group, vertex, edge, face))
        vertex += nodes * (valency + 2)
        edge += nodes * 6 * valency
        face += nodes * 4 * valency
    return found


def _ring_points(plan: _Plan, half_runs: Ints, angles: Floats) -> Points:
    """Return the points of rings at angles from their x, shape (h, 3), mm."""
    struts, runs = plan.struts, plan.struts.runs
    x, axis = struts.x[half_runs], runs.directions[half_runs]
    distance = struts.collar[half_runs]
    radius = runs.radii_at(half_runs, distance)
    center = runs.nodes[runs.tails[half_runs]] + distance[:, None] * axis
    spoke = np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * np.cross(axis, x)
    points: Points = center + radius[:, None] * spoke
    return points


def _points(plan: _Plan) -> Points:
    """Return the positions of all vertices, shape (v, 3), mm."""
    corners = _ring_points(
        plan, np.repeat(plan.ringed, 4), np.tile(QUARTER * np.arange(4), len(plan.ringed))
    )
    splits = _ring_points(plan, plan.split, plan.seams.angle[plan.split])
    ends = _ring_points(plan, plan.ends, np.zeros(len(plan.ends)))
    points = [corners, splits, ends]
    if plan.caps == "round":
        center, size, _ = _domes(plan)
        points.append(center - size[:, None] * plan.struts.runs.directions[plan.ends])
    for group, *_ in _groups(plan):
        points.append(_placed(plan, group)[0].reshape(-1, 3))
    return np.concatenate([*points, plan.curves.ring_points])


def _placed(plan: _Plan, group: BlendedNodes) -> tuple[Points, Floats]:
    """Return the corners (M, N + 2, 3) and the control points (M, 4 N, n_u, n_v, 3), mm."""
    made, nodes = group.shapes, plan.struts.runs.nodes[group.nodes]
    quads = group.quads  # (U, N, 4)
    count, valency = quads.shape[:2]
    corners = np.empty((count, valency + 2, 3))
    corners[np.arange(count)[:, None], quads.reshape(count, -1)] = made.control[:, :, 0, 0]
    which = group.shape_of
    placed = made.control[which] + nodes[:, None, None, None]
    return corners[which] + nodes[:, None], placed


def _edges(plan: _Plan) -> BrepEdges:
    """Return all edges."""
    runs = plan.struts.runs
    near = plan.seams.near
    seam = np.stack([plan.seam_vertex(near), plan.seam_vertex(near ^ 1)], axis=1)
    ringed, split, ends = plan.ringed, plan.split, plan.ends
    quarter = np.tile(np.arange(4), len(ringed))
    of_arc = np.repeat(ringed, 4)
    arc_ends = 4 * plan.rank[of_arc][:, None] + np.stack([quarter, (quarter + 1) % 4], axis=1)
    angles = QUARTER * np.stack([quarter, quarter + 1], axis=1)
    halved = 4 * plan.rank[split] + plan.seams.quarter[split]
    middle = plan.split_vertices + np.arange(len(split))
    rest_ends = np.stack([middle, arc_ends[halved, 1]], axis=1)
    rest_angles = np.stack([plan.seams.angle[split], angles[halved, 1]], axis=1)
    arc_ends[halved, 1], angles[halved, 1] = middle, plan.seams.angle[split]
    ring = np.repeat((plan.end_vertices + np.arange(len(ends)))[:, None], 2, axis=1)
    ring_angles = np.tile([0.0, TURN], (len(ends), 1))
    half_run = np.concatenate([of_arc, split, ends])
    center = runs.nodes[runs.tails[half_run]]
    center = center + plan.struts.collar[half_run, None] * runs.directions[half_run]
    origin, z, x = [center], [runs.directions[half_run]], [plan.struts.x[half_run]]
    radii = [runs.radii_at(half_run, plan.struts.collar[half_run])]
    circles = [angles, rest_angles, ring_angles]
    pairs = [seam, arc_ends, rest_ends, ring]
    if plan.caps == "round":
        middle_of, size, latitude = _domes(plan)
        outward = -runs.directions[ends]
        origin.append(middle_of)
        z.append(np.cross(plan.struts.x[ends], outward))
        x.append(plan.struts.x[ends])
        radii.append(size)
        circles.append(np.stack([latitude, np.full(len(ends), QUARTER)], axis=1))
        pairs.append(np.stack([ring[:, 0], plan.poles + np.arange(len(ends))], axis=1))
    rings = plan.curves.ring_axes
    origin, z, x = [*origin, rings.origin], [*z, rings.z], [*x, rings.x]
    radii.append(plan.curves.ring_radii)
    circles.append(plan.curves.ring_angles)
    number = np.arange(4 * len(plan.curves.own))
    pairs.append(plan.curve_vertices + np.stack([number, number & ~3 | (number + 1) & 3], axis=1))
    curves = []
    for group, vertex, *_ in _groups(plan):
        for made_pairs, table in _node_curves(plan, group, vertex):
            pairs.append(made_pairs)
            curves.append(table)
    pairs.append(_curve_corners(plan).reshape(-1, 2))
    curves += plan.curves.spokes
    return BrepEdges(
        np.concatenate(pairs),
        Axes(np.concatenate(origin), np.concatenate(z), np.concatenate(x)),
        np.concatenate(radii),
        np.concatenate(circles),
        tuple(curves),
    )


def _owners(quads: Ints) -> tuple[Ints, Bools]:
    """Return the arc of each side (M, 4 N), and whether it runs along it."""
    twins = side_twins(quads)
    sides = np.arange(twins.shape[1])
    owns = sides < twins
    number = np.cumsum(owns, axis=1) - 1
    return np.where(owns, number, np.take_along_axis(number, twins, axis=1)), owns


def _knots(spline: Spline) -> Knots:
    """Return the knots of patches in one direction."""
    values, counts = np.unique(spline.knots, return_counts=True)
    return Knots(values, counts.astype(np.intp))


def _node_curves(
    plan: _Plan, group: BlendedNodes, vertex: int
) -> tuple[tuple[Ints, SplineCurves], tuple[Ints, SplineCurves]]:
    """Return the ends and the curves of the nodes' arcs, 2 N a node, and of their spokes, 4 N."""
    quads = group.quads[group.shape_of]
    nodes, valency = quads.shape[:2]
    _, control = _placed(plan, group)
    _, owns = _owners(quads)
    first = vertex + (valency + 2) * np.arange(nodes)[:, None]
    start = first + quads.reshape(nodes, -1)  # (M, 4 N)
    end = first + np.roll(quads, -1, axis=2).reshape(nodes, -1)
    collar = (4 * plan.rank[group.half_runs][:, :, None] + np.arange(4)).reshape(nodes, -1)
    layout = group.shapes.layout
    arcs = SplineCurves(control[:, :, :, 0][owns], _knots(layout.u))
    spokes = SplineCurves(control[:, :, 0].reshape(nodes * 4 * valency, -1, 3), _knots(layout.v))
    spoke_ends = np.stack([start, collar], axis=2).reshape(-1, 2)
    return (np.stack([start[owns], end[owns]], axis=1), arcs), (spoke_ends, spokes)


def _surfaces(plan: _Plan) -> tuple[Ints, Axes, Floats, tuple[SplinePatches, ...]]:
    """Return the kinds of faces, their axes and sizes, and the patches."""
    struts, runs = plan.struts, plan.struts.runs
    ends, near = plan.ends, plan.seams.near
    outward, node = -runs.directions[ends], runs.nodes[runs.tails[ends]]
    slope = runs.slopes[near]
    in_order = np.argsort(plan.run_face)
    angle = plan.seams.angle[near]
    axis, x = runs.directions[near], struts.x[near]
    seam_x = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * np.cross(axis, x)
    origin = runs.nodes[runs.tails[near]] + struts.collar[near, None] * axis
    radius = runs.radii_at(near, struts.collar[near])
    columns = [
        (origin[in_order], axis[in_order], seam_x[in_order]),
    ]
    sizes = [np.stack([radius, np.arctan(slope)], axis=1)[in_order]]
    kinds = [np.where(slope[in_order] == 0, Surface.CYLINDER, Surface.CONE)]
    if plan.caps == "flat":
        columns.insert(0, (node, outward, struts.x[ends]))
        sizes.insert(0, np.zeros((len(ends), 2)))
        kinds.insert(0, np.full(len(ends), Surface.PLANE))
    elif plan.caps == "round":
        center, size, _ = _domes(plan)
        columns.append((center, outward, struts.x[ends]))
        sizes.append(np.stack([size, np.zeros(len(ends))], axis=1))
        kinds.append(np.full(len(ends), Surface.SPHERE))
    patches = [_patch_table(plan, group) for group, *_ in _groups(plan)]
    patches += plan.curves.patches
    kinds.append(np.full(sum(len(table.control) for table in patches), Surface.SPLINE))
    return (
        np.concatenate(kinds).astype(np.intp),
        Axes(*(np.concatenate(column) for column in zip(*columns, strict=True))),
        np.concatenate(sizes),
        tuple(patches),
    )


def _patch_table(plan: _Plan, group: BlendedNodes) -> SplinePatches:
    """Return the patches of nodes, node after node."""
    _, control = _placed(plan, group)
    layout = group.shapes.layout
    return SplinePatches(
        control.reshape(-1, *control.shape[2:]), _knots(layout.u), _knots(layout.v)
    )


def _domes(plan: _Plan) -> tuple[Points, Floats, Floats]:
    """Return center and radius of the spheres at round ends, and the latitude of their rings."""
    runs, ends = plan.struts.runs, plan.ends
    radius = runs.radii.reshape(-1)[ends]
    growth = -runs.slopes[ends]  # outward
    center = runs.nodes[runs.tails[ends]] - (radius * growth)[:, None] * runs.directions[ends]
    return center, radius * np.hypot(1.0, growth), np.arctan2(-radius * growth, radius)


def _patch_uses(plan: _Plan) -> Uses:
    """Return the edges around patches: an arc, a spoke, the collar's quarter, the spoke before."""
    parts: list[Uses] = []
    for group, _, edge, face in _groups(plan):
        quads = group.quads[group.shape_of]
        nodes, valency = quads.shape[:2]
        own_arc, owns = _owners(quads)
        arcs = edge + 2 * valency * np.arange(nodes)[:, None]
        spokes = edge + 2 * valency * nodes + 4 * valency * np.arange(nodes)[:, None]
        side = np.arange(4 * valency)
        following = (side & ~3) | ((side + 1) & 3)
        faces = (face + np.arange(nodes * 4 * valency)).reshape(nodes, -1)
        half_run = np.repeat(group.half_runs, 4, axis=1)
        quarter = np.tile(np.arange(4), (nodes, valency))
        zero, one = np.zeros(half_run.shape), np.ones(half_run.shape)
        ahead = np.where(owns, 0.0, 1.0)
        parts.append(_rows(faces, 0, arcs + own_arc, owns, (ahead, zero, 1 - ahead, zero)))
        parts.append(_rows(faces, 1, spokes + following, True, (one, zero, one, one)))
        parts += _arc_uses(plan, faces, 2, half_run, quarter, 1)
        parts.append(_rows(faces, 4, spokes + side, False, (zero, zero, zero, one)))
    return _joined(parts)


def _curve_corners(plan: _Plan) -> Ints:
    """Return the vertices at which the spokes of curves begin and end, shape (q, 4, 2)."""
    parts, quarter = plan.curves, np.arange(4)
    # Half-runs at the start run against the curve: their corners come the other way round.
    corners = np.stack([-quarter % 4, quarter], axis=1)  # (4, 2)
    found = plan.curve_vertices + 4 * parts.rings[:, None] + quarter[:, None]
    at_struts = np.flatnonzero(parts.half_runs[:, 0] >= 0)
    found[at_struts] = 4 * plan.rank[parts.half_runs[at_struts]][:, None] + corners
    return found


def _curve_uses(plan: _Plan) -> Uses:
    """Return the edges around the patches of curves: a circle, a spoke, a circle, a spoke."""
    parts, quarter = plan.curves, np.arange(4)
    count = len(parts.first)
    number = np.arange(count)[:, None]
    faces = plan.curve_faces + 4 * number + quarter  # (q, 4)
    spokes = plan.curve_spokes + 4 * number
    zero, one = np.zeros((count, 4)), np.ones((count, 4))
    found = [
        _rows(faces, 10, spokes + (quarter + 1) % 4, True, (one, zero, one, one)),
        _rows(faces, 30, spokes + quarter, False, (zero, zero, zero, one)),
    ]
    own = parts.rings[:, 0] >= 0
    rings = plan.curve_rings + 4 * parts.rings[own][:, :, None] + quarter  # (q', 2, 4)
    none, all_of_it = zero[own], one[own]
    ahead = (none, none, all_of_it, none)
    found.append(_rows(faces[own], 0, rings[:, 0], True, ahead))
    ahead = (none, all_of_it, all_of_it, all_of_it)
    found.append(_rows(faces[own], 20, rings[:, 1], False, ahead))
    for side in (0, 1):
        half_run = np.repeat(parts.half_runs[~own, side, None], 4, axis=1)
        own_quarter = np.broadcast_to(quarter if side else 3 - quarter, half_run.shape)
        found += _arc_uses(plan, faces[~own], 20 * side, half_run, own_quarter, side)
    return _joined(found)


def _arc_uses(
    plan: _Plan, faces: Ints, place: int, half_run: Ints, quarter: Ints, side: int
) -> list[Uses]:
    """Return the uses, against their direction, of quarters of circles by patches at v = `side`.

    A quarter that a seam splits is two edges. At v = 0 the patch runs against it too.
    """
    base = plan.base_arcs + 4 * plan.rank[half_run] + quarter
    split = plan.split_rank[half_run]
    is_split = (split >= 0) & (plan.seams.quarter[half_run] == quarter)
    at = np.ones(half_run.shape)
    at[is_split] = parameters_at(plan.seams.angle[half_run[is_split]] - QUARTER * quarter[is_split])
    v, zero, one = np.full_like(at, side), np.zeros_like(at), np.ones_like(at)
    if side == 0:
        at, zero, one = 1 - at, one, zero
    rest = (at[is_split], v[is_split], one[is_split], v[is_split])
    return [
        _rows(faces[is_split], place, plan.rest_arcs + split[is_split], False, rest),
        _rows(faces, place + 1, base, False, (zero, v, at, v)),
    ]


def _strut_uses(plan: _Plan) -> Uses:
    """Return the edges around each strut's face: a ring, the seam, the other ring, the seam."""
    runs, near = plan.struts.runs, plan.seams.near
    face = plan.strut_faces + plan.run_face
    collars = plan.struts.collar
    height = runs.lengths - collars[near] - collars[near ^ 1]
    height = height * np.hypot(1.0, runs.slopes[near])  # along the generators
    seam = np.arange(len(near))
    zero, turn = np.zeros(len(near)), np.full(len(near), TURN)
    parts = [
        *_ring_uses(plan, face, near, 0, np.zeros(len(near)), True),
        _rows(face, 20, seam, True, (turn, zero, turn, height)),
        *_ring_uses(plan, face, near ^ 1, 30, height, False),
        _rows(face, 50, seam, False, (zero, zero, zero, height)),
    ]
    return _joined(parts)


def _ring_uses(
    plan: _Plan, face: Ints, half_runs: Ints, place: int, height: Floats, along: bool
) -> list[Uses]:
    """Return the uses of the rings of half-runs by their struts' faces, from the seams on.

    Parameters
    ----------
    place : in the loop of the first arc
    height : (k,) parameter v of the ring
    along : whether the face's u grows along the ring
    """
    parts = []
    at_end = plan.end_rank[half_runs] >= 0
    rings = plan.end_rings + plan.end_rank[half_runs[at_end]]
    zero = np.zeros(len(rings))
    first, last = (zero, zero + TURN) if along else (zero + TURN, zero)
    v = height[at_end]
    parts.append(_rows(face[at_end], place, rings, True, (first, v, last, v)))
    face, half_runs, height = face[~at_end], half_runs[~at_end], height[~at_end]
    is_split = plan.split_rank[half_runs] >= 0
    start = plan.seams.quarter[half_runs]
    angle = plan.seams.angle[half_runs]
    left = np.where(is_split, QUARTER * (start + 1) - angle, QUARTER)  # of the first quarter
    passed = np.zeros(len(face))
    for step in range(5):
        quarter = (start + step) % 4
        base = plan.base_arcs + 4 * plan.rank[half_runs] + quarter
        rest = plan.rest_arcs + plan.split_rank[half_runs]
        edge, width = base, np.full(len(face), QUARTER)
        if step == 0:
            edge, width = np.where(is_split, rest, base), left
        if step == 4:
            width = QUARTER - left
        begin, end = passed, passed + width
        if not along:
            begin, end = TURN - begin, TURN - end
        chosen = is_split if step == 4 else np.ones(len(face), dtype=np.bool_)
        columns = (begin[chosen], height[chosen], end[chosen], height[chosen])
        parts.append(_rows(face[chosen], place + 1 + step, edge[chosen], True, columns))
        passed = passed + width
    return parts


def _cap_uses(plan: _Plan) -> Uses:
    """Return the rings around plane ends."""
    count = len(plan.ends)
    nothing = np.full(count, np.nan)
    rings = plan.end_rings + np.arange(count)
    return _rows(np.arange(count), 0, rings, False, (nothing, nothing, nothing, nothing))


def _dome_uses(plan: _Plan) -> Uses:
    """Return the edges around spheres at round ends: the ring, and a meridian to the pole."""
    _, _, low = _domes(plan)
    count = len(plan.ends)
    face, number = plan.domes + np.arange(count), np.arange(count)
    zero, turn, top = np.zeros(count), np.full(count, TURN), np.full(count, QUARTER)
    ring, meridian = plan.end_rings + number, plan.meridians + number
    return _joined(
        [
            _rows(face, 0, ring, False, (turn, low, zero, low)),
            _rows(face, 1, meridian, True, (turn, low, turn, top)),
            _rows(face, 2, meridian, False, (zero, low, zero, top)),
        ]
    )


def _rows(
    face: Ints, place: int, edge: Ints, forward: Bools | bool, parameters: tuple[Floats, ...]
) -> Uses:
    """Return uses in flat arrays; `parameters` are u and v at the edge's start, then at its end."""
    face = face.reshape(-1)
    along = np.broadcast_to(forward, edge.shape).reshape(-1)
    both = np.stack([each.reshape(-1) for each in parameters], axis=1).reshape(-1, 2, 2)
    return face, np.full(len(face), place), edge.reshape(-1), along, both


def _joined(parts: list[Uses]) -> Uses:
    if not parts:
        empty = np.empty(0, dtype=np.intp)
        return empty, empty, empty, np.empty(0, dtype=np.bool_), np.empty((0, 2, 2))
    face, place, edge, forward, parameters = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    return face, place, edge, forward, parameters


def _nodes_of_faces(plan: _Plan) -> Ints:
    """Return a node that each face belongs to, shape (f,)."""
    runs = plan.struts.runs
    struts = np.empty(len(plan.run_face), dtype=np.intp)
    struts[plan.run_face] = runs.edges[:, 0]
    at_ends = runs.tails[plan.ends]
    patches = [
        np.repeat(group.nodes, 4 * group.half_runs.shape[1]) for group in plan.struts.blended
    ]
    of_curves = plan.struts.curves.nodes[plan.curves.curves.pieces[plan.curves.first] + 1]
    patches.append(np.repeat(of_curves, 4))
    before = at_ends if plan.caps == "flat" else at_ends[:0]
    after = at_ends if plan.caps == "round" else at_ends[:0]
    return np.concatenate([before, struts, after, *patches])


def _shell_of_nodes(struts: RoundStruts) -> Ints:
    """Return the shell of each node: the connected part of the skeleton that has edges, (n,)."""
    part = component_labels(struts.skeleton.edges, len(struts.runs.nodes))
    used = np.unique(part[struts.skeleton.edges])
    return np.searchsorted(used, part)


def _names(plan: _Plan) -> Ints:
    """Return the place of each face's name among `_texts`, shape (f,)."""
    runs = plan.struts.runs
    struts = len(runs.edges) + 0
    number = _nodes_of_faces(plan) + struts
    first = plan.strut_faces
    own = np.empty(struts, dtype=np.intp)
    own[plan.run_face] = np.arange(struts)
    number[first : first + struts] = own
    curves = np.repeat(plan.curves.curve, 4)
    number[plan.curve_faces :] = struts + len(runs.nodes) + curves
    return number


def _texts(plan: _Plan) -> tuple[str, ...]:
    """Return the names of runs, then those of nodes and of curves."""
    runs = plan.struts.runs
    edge = np.full(len(runs.edges), len(runs.run_of_edge))
    straight = np.flatnonzero(runs.run_of_edge >= 0)
    np.minimum.at(edge, runs.run_of_edge[straight], straight)
    curves = plan.curves.curves
    joints = np.where(curves.nodes >= 0, curves.nodes, len(runs.nodes))
    lowest = np.minimum.reduceat(joints, curves.offsets[:-1]) if len(joints) else joints
    of_node = np.where(runs.valency == 1, "end", "node")
    names = [f"strut {number}" for number in edge.tolist()]
    return (
        *names,
        *(f"{kind} {node}" for node, kind in enumerate(of_node.tolist())),
        *(f"curve {node}" for node in lowest.tolist()),
    )
