"""The B-rep of round struts: cylinders and cones, four patches per strut at each node, ends.

Every ring is an exact circle about its strut. The patches of a node share their arcs and spokes,
and each collar's four arcs are shared with the strut's one face.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.topology import component_labels
from scaffold_cad.brep.analytic import (
    AnalyticBrep,
    Axes,
    BrepFaces,
    SplinePatches,
    Surface,
)
from scaffold_cad.brep.joining import PlaneRings, edge_numbers, extended, hollow
from scaffold_cad.struts.breps.edges import edges_of, knots_of
from scaffold_cad.struts.breps.plan import (
    FacePlan,
    domes,
    groups_of,
    placed,
    ring_points,
)
from scaffold_cad.struts.breps.seams import QUARTER
from scaffold_cad.struts.breps.uses import (
    cap_uses,
    curve_uses,
    dome_uses,
    patch_uses,
    strut_uses,
    torus_uses,
)
from scaffold_cad.struts.hollow.sockets import bores
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.runs import Runs
from scaffold_cad.struts.sharp.faces import sharp_brep


def brep_of_struts(struts: RoundStruts) -> AnalyticBrep:
    """Return the B-rep of round struts, one solid a connected part; hollow ones with their inside.

    Struts that overlap make faces that cross: `RoundStruts.overlapping` names them.
    """
    struts = struts if struts.inner is None else replace(struts, inner=struts.inner.straight)
    struts = struts.straight
    outer, ends, rings_outside = faces_of(struts)
    if struts.inner is None:
        return outer
    is_open = np.zeros(len(outer.solid), dtype=np.bool_)
    void, _, inner_rings = faces_of(struts.inner)
    if struts.options.ends != "open":
        return hollow(outer, void, PlaneRings.none(), is_open)
    runs = struts.runs
    shell = _shell_of_nodes(struts)[runs.tails[ends]]
    is_open[shell] = True
    if len(struts.sockets.nodes):
        void, inner_rings = bored(struts, void, ends, inner_rings, shell, len(runs.edges))
    circles = np.stack([rings_outside, inner_rings], axis=1)
    return hollow(outer, void, end_rings(struts, ends, circles, shell, len(runs.edges)), is_open)


def end_rings(
    struts: RoundStruts, ends: Ints, circles: Ints, shell: Ints, first_name: int
) -> PlaneRings:
    """Return the plane rings at open ends of hollow struts.

    Parameters
    ----------
    ends : (e,) half-runs at extremities
    circles : (e, 2) edges there, of the outside and of the inside
    shell : (e,) of each
    first_name : place of the name of node 0
    """
    runs = struts.runs
    return PlaneRings(
        runs.nodes[runs.tails[ends]],
        -runs.directions[ends],
        struts.x[ends],
        circles,
        np.tile([False, True], (len(ends), 1)),
        np.zeros(len(ends), dtype=np.bool_),
        shell,
        first_name + runs.tails[ends],
    )


def faces_of(struts: RoundStruts, open_at: Bools | None = None) -> tuple[AnalyticBrep, Ints, Ints]:
    """Return the shells of solid straight struts, and half-runs (e,) at ends, their circles (e,).

    Ends that are balls are not among them.

    Parameters
    ----------
    open_at : (n,) nodes where struts end without a face; none by default
    """
    if struts.options.is_sharp:
        made = sharp_brep(struts, open_at)
        return made.brep, made.ends, made.rings
    plan = FacePlan.of(struts, open_at)
    plain = np.flatnonzero(~struts.at_balls[plan.ends])
    return _shells_of(plan), plan.ends[plain], plan.end_rings + plain


def bored(
    struts: RoundStruts, void: AnalyticBrep, ends: Ints, rings: Ints, shell: Ints, first_name: int
) -> tuple[AnalyticBrep, Ints]:
    """Return the inside of struts with their sockets, and its circles at all open ends, (e,).

    Parameters
    ----------
    void : the inside without sockets
    ends : (e,) half-runs at open ends
    rings : (e,) circles of `void` there
    shell : (e,) of each
    first_name : place of the name of node 0 among those of `void`
    """
    assert struts.inner is not None
    runs, inner = struts.runs, struts.inner
    sockets = struts.sockets.chosen(np.isin(struts.sockets.nodes, runs.tails[ends]))
    place = np.flatnonzero(np.isin(runs.tails[ends], sockets.nodes))
    place = place[np.argsort(runs.tails[ends[place]])]
    half_run, count = ends[place], len(place)
    inward, x, shell = runs.directions[half_run], struts.x[half_run], shell[place]
    parts = bores(runs.nodes[sockets.nodes], inward, x, sockets, shell, len(void.solid))
    circles = count + np.arange(2 * count).reshape(-1, 2)  # at the shoulder and at the end
    wide = sockets.radii > inner.runs.radii.reshape(-1)[half_run]
    shoulders = PlaneRings(
        inner.runs.nodes[sockets.nodes],
        np.where(wide[:, None], inward, -inward),
        x,
        np.stack([rings[place], circles[:, 0]], axis=1),
        np.stack([np.zeros_like(wide), np.ones_like(wide)], axis=1),
        wide,
        shell,
        first_name + sockets.nodes,
    )
    numbers = edge_numbers(void, parts)
    rings = numbers[0][rings]
    rings[place] = numbers[1][circles[:, 1]]
    return extended(void, parts, shoulders), rings


def _shells_of(plan: FacePlan) -> AnalyticBrep:
    """Return the outer faces of struts, but for the ends of open ones."""
    uses = [patch_uses(plan), strut_uses(plan), curve_uses(plan), torus_uses(plan)]
    uses += [cap_uses(plan), dome_uses(plan)]
    face, order, edge, forward, parameters = (
        np.concatenate(column) for column in zip(*uses, strict=True)
    )
    sorting = np.lexsort((order, face))
    count = int(face.max()) + 1
    shell = _shell_of_nodes(plan.struts)[_nodes_of_faces(plan)]
    return AnalyticBrep(
        _points(plan),
        edges_of(plan),
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


def _points(plan: FacePlan) -> Points:
    """Return the positions of all vertices, shape (v, 3), mm."""
    corners = ring_points(
        plan, np.repeat(plan.ringed, 4), np.tile(QUARTER * np.arange(4), len(plan.ringed))
    )
    splits = ring_points(plan, plan.split, plan.seams.angle[plan.split])
    ends = ring_points(plan, plan.ends, np.zeros(len(plan.ends)))
    center, size, _ = domes(plan)
    poles = center - size[:, None] * plan.struts.runs.directions[plan.ends[plan.balls]]
    points = [corners, splits, ends, poles]
    for group, *_ in groups_of(plan):
        points.append(placed(plan, group)[0].reshape(-1, 3))
    return np.concatenate([*points, plan.curves.ring_points])


def _surfaces(plan: FacePlan) -> tuple[Ints, Axes, Floats, tuple[SplinePatches, ...]]:
    """Return the kinds of faces, their axes and sizes, and the patches."""
    struts, runs = plan.struts, plan.struts.runs
    near = plan.seams.near
    flat, round_ = plan.ends[plan.discs], plan.ends[plan.balls]
    center, size, _ = domes(plan)
    slope = runs.slopes[near]
    in_order = np.argsort(plan.run_face)
    angle = plan.seams.angle[near]
    axis, x = runs.directions[near], struts.x[near]
    seam_x = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * np.cross(axis, x)
    origin = runs.nodes[runs.tails[near]] + struts.collar[near, None] * axis
    radius = runs.radii_at(near, struts.collar[near])
    columns = [
        (runs.nodes[runs.tails[flat]], -runs.directions[flat], struts.x[flat]),
        (origin[in_order], axis[in_order], seam_x[in_order]),
        (center, -runs.directions[round_], struts.x[round_]),
    ]
    sizes = [
        np.zeros((len(flat), 2)),
        np.stack([radius, np.arctan(slope)], axis=1)[in_order],
        np.stack([size, np.zeros(len(round_))], axis=1),
    ]
    kinds = [
        np.full(len(flat), Surface.PLANE),
        np.where(slope[in_order] == 0, Surface.CYLINDER, Surface.CONE),
        np.full(len(round_), Surface.SPHERE),
    ]
    tori = plan.tori
    columns.append((tori.centers, tori.z, tori.x))
    sizes.append(np.stack([tori.radii, runs.radii.reshape(-1)[tori.half_runs[:, 0]]], axis=1))
    kinds.append(np.full(len(tori.radii), Surface.TORUS))
    patches = [_patch_table(plan, group) for group, *_ in groups_of(plan)]
    patches += plan.curves.patches
    kinds.append(np.full(sum(len(table.control) for table in patches), Surface.SPLINE))
    return (
        np.concatenate(kinds).astype(np.intp),
        Axes(*(np.concatenate(column) for column in zip(*columns, strict=True))),
        np.concatenate(sizes),
        tuple(patches),
    )


def _patch_table(plan: FacePlan, group: BlendedNodes) -> SplinePatches:
    """Return the patches of nodes, node after node."""
    _, control = placed(plan, group)
    layout = group.shapes.layout
    return SplinePatches(
        control.reshape(-1, *control.shape[2:]), knots_of(layout.u), knots_of(layout.v)
    )


def _nodes_of_faces(plan: FacePlan) -> Ints:
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
    at_tori = runs.tails[plan.tori.half_runs[:, 0]]
    return np.concatenate([at_ends[plan.discs], struts, at_ends[plan.balls], at_tori, *patches])


def _shell_of_nodes(struts: RoundStruts) -> Ints:
    """Return the shell of each node: the connected part of the skeleton that has edges, (n,)."""
    part = component_labels(struts.skeleton.edges, len(struts.runs.nodes))
    used = np.unique(part[struts.skeleton.edges])
    return np.searchsorted(used, part)


def _names(plan: FacePlan) -> Ints:
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
    tori = slice(plan.torus_faces, plan.patch_faces)
    number[tori] = struts + len(runs.nodes) + len(plan.curves.curves.half_runs)
    number[tori] += np.arange(len(plan.tori.radii))
    return number


def _texts(plan: FacePlan) -> tuple[str, ...]:
    """Return the names of runs, then those of nodes, of curves and of tori."""
    runs = plan.struts.runs
    curves = plan.curves.curves
    joints = np.where(curves.nodes >= 0, curves.nodes, len(runs.nodes))
    lowest = np.minimum.reduceat(joints, curves.offsets[:-1]) if len(joints) else joints
    of_node = np.where(runs.valency == 1, "end", "node")
    return (
        *run_names(runs),
        *(f"{kind} {node}" for node, kind in enumerate(of_node.tolist())),
        *(f"curve {node}" for node in lowest.tolist()),
        *(f"bend {node}" for node in runs.tails[plan.tori.half_runs[:, 0]].tolist()),
    )


def run_names(runs: Runs) -> list[str]:
    """Return the name of each run: the strut of its lowest edge."""
    edge = np.full(len(runs.edges), len(runs.run_of_edge))
    straight = np.flatnonzero(runs.run_of_edge >= 0)
    np.minimum.at(edge, runs.run_of_edge[straight], straight)
    return [f"strut {number}" for number in edge.tolist()]
