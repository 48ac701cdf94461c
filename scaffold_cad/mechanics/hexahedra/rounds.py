"""Where the cross-sections of round struts stand, all with their outer points on the surface.

From a branch point or bend outward the sections of a strut go from the arcs that it shares with its
neighbors, over rings on its patches, to its collar. Straight parts have a section at either end,
and one at each joint that they pass. The rings at both ends of a strut may have another phase: the
strut and its patches share that turn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.mechanics.hexahedra.plans import Caps, Plan, Span
from scaffold_cad.mechanics.hexahedra.runs import RunEdges, RunTurns, check_has_hexahedra
from scaffold_cad.mechanics.hexahedra.sections import FrameParts
from scaffold_cad.mechanics.hexahedra.surface import RimSurface
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.curves.rings import intervals, intervals_of
from scaffold_cad.struts.meshes.ends import end_spheres
from scaffold_cad.struts.meshes.rings import first_rings, turned_rings
from scaffold_cad.struts.meshes.surface import ring_centers
from scaffold_cad.struts.model import BlendedNodes

LEVELS = 4
"""Sections of a strut from its arcs to its collar, for 16 points around it."""

JOINT_GAP = 0.02
"""Distance from collars, in radii, within which a joint that a run passes has no section."""

RIM_OF_CAP = 0.5
"""Where the last section of a round end has its rim, from its circle, 0, to its pole, 1."""


def round_plan(struts: RoundStruts, sides: int, pieces: int) -> Plan:
    """Return the sections of round struts and what lies between them.

    Parameters
    ----------
    sides : points around a section, a multiple of 8
    pieces : hexahedra along each straight part of a strut

    Raises
    ------
    OptionError
        If struts are hollow, have sharp nodes or overlap.
    """
    check_has_hexahedra(struts)
    frames, edges = FrameParts(sides), RunEdges.of(struts)
    straight, turns = struts.straight, RunTurns.of(struts.straight)
    own = _circles(straight, turns.turn, sides)  # (2 k, sides, 3)
    rings = np.empty(own.shape[:2], dtype=np.intp)
    hubs = np.empty(len(own), dtype=np.intp)
    plain = np.ones(len(own), dtype=np.bool_)
    spans, stacks, normals = [], [], []
    for group in straight.blended:
        plain[group.half_runs] = False
        stack = _stack(straight, group, turns, own[group.half_runs], frames)
        rings[group.half_runs], hubs[group.half_runs] = stack.rings[:, :, -1], stack.hubs[:, :, -1]
        stacks.append(stack.rings)
        normals.append(_blend_normals(group, turns, stack.rings.shape[2] - 1, sides))
        spans.append(_node_span(straight, group, turns, stack, frames, edges))
    some = np.flatnonzero(plain)
    hubs[some] = frames.add_hubs(ring_centers(straight, some), turns.radius[some])
    rings[some] = frames.add_rim(own[some], hubs[some])
    sections = frames.add_sections(hubs, turns.seen_along(np.arange(len(own)), rings))
    spans.append(_straight_span(straight, turns, sections, pieces, frames, edges))
    spans.append(_curve_span(straight, rings, hubs, frames, edges))
    ends = np.flatnonzero(straight.runs.valency[straight.runs.tails] == 1)
    closing, caps = sections[ends], None
    if struts.options.ends == "round":
        closing, span, caps = _round_ends(straight, turns, ends, own[ends], sections[ends], frames)
        spans.append(
            replace(
                span,
                edge=np.repeat(
                    edges.at(edges.number[ends >> 1], caps.centers),
                    len(span.edge) // max(len(ends), 1),
                ),
            )
        )
    frame = frames.frame()
    surface = RimSurface.of(straight, stacks, normals, len(frame.rim))
    return Plan(frame, tuple(spans), surface, closing, straight.runs.tails[ends], caps)


@dataclass(frozen=True, eq=False)
class _Stack(Frozen):
    """Rings of M nodes of valency N, from the arcs outward."""

    rings: Ints
    """Points of the rim, shape (M, N, levels + 1, sides)."""
    hubs: Ints
    """Shape (M, N, levels + 1)."""


def _circles(struts: RoundStruts, turn: Floats, sides: int) -> Points:
    """Return the points of the circles on which half-runs begin, (2 k, sides, 3), mm."""
    every = np.arange(len(struts.collar))
    radius = struts.runs.radii_at(every, struts.collar)
    around = _around(struts.x, struts.runs.directions, turn, radius, sides)
    points: Points = ring_centers(struts, every)[:, None] + around
    return points


def _around(x: UnitVectors, axes: UnitVectors, turn: Floats, radius: Floats, sides: int) -> Points:
    """Return points around axes (h, 3), from `x` turned on, relative to them, (h, sides, 3), mm."""
    angle = 2 * np.pi / sides * np.arange(sides) + turn[:, None]
    y = np.cross(axes, x)
    spokes = np.cos(angle)[..., None] * x[:, None] + np.sin(angle)[..., None] * y[:, None]
    points: Points = radius[:, None, None] * spokes
    return points


def _stack(
    struts: RoundStruts, group: BlendedNodes, turns: RunTurns, own: Points, frames: FrameParts
) -> _Stack:
    """Add the sections of nodes from the arcs to the collars, and return their points.

    Parameters
    ----------
    own : (M, N, sides, 3) points of the collars, mm
    """
    runs, half_runs = struts.runs, group.half_runs
    count, valency, sides = own.shape[:3]
    levels = max(2, round(LEVELS * sides / 16))
    at = np.linspace(0.0, 1.0, levels + 1)
    node = runs.nodes[group.nodes][:, None, None, None]
    points = node + turned_rings(group, turns.turn[half_runs], at, sides)
    points[:, :, -1] = own
    axes = runs.directions[half_runs][:, :, None]  # (M, N, 1, 3)
    height = dot(
        points.mean(axis=3) - node[..., 0, :],
        np.broadcast_to(axes, (*axes.shape[:2], levels + 1, 3)),
    )
    share = (height - height[..., :1]) / (height[..., -1:] - height[..., :1])
    middle = node[..., 0, :] + (share * struts.collar[half_runs][..., None])[..., None] * axes
    size = turns.radius[half_runs]  # (M, N)
    hubs = np.empty((count, valency, levels + 1), dtype=np.intp)
    center = frames.add_hubs(runs.nodes[group.nodes], size.max(axis=1), loose=True)
    hubs[:, :, 0] = center[:, None]
    wide = np.broadcast_to(size[..., None], (count, valency, levels))
    hubs[:, :, 1:-1] = frames.add_hubs(middle[:, :, 1:-1], wide[..., 1:], loose=True)
    hubs[:, :, -1] = frames.add_hubs(middle[:, :, -1], size)
    first = first_rings(group.quads, sides // 4)[group.shape_of]  # (M, N, sides)
    shared = valency + 2 + 2 * valency * (sides // 4 - 1)
    arcs = np.empty((count, shared, 3))
    arcs[np.arange(count)[:, None, None], first] = points[:, :, 0]
    on_arcs = frames.add_rim(arcs, center, loose=True)
    rings = np.empty((count, valency, levels + 1, sides), dtype=np.intp)
    rings[:, :, 0] = on_arcs[np.arange(count)[:, None, None], first]
    rings[:, :, 1:-1] = frames.add_rim(points[:, :, 1:-1], hubs[:, :, 1:-1], loose=True)
    rings[:, :, -1] = frames.add_rim(own, hubs[:, :, -1])
    return _Stack(rings, hubs)


def _blend_normals(group: BlendedNodes, turns: RunTurns, levels: int, sides: int) -> UnitVectors:
    """Return the normals at the points of a stack, (M, N, levels + 1, sides, 3)."""
    turn, at = turns.turn[group.half_runs], np.linspace(0.0, 1.0, levels + 1)
    by_u, by_v = (turned_rings(group, turn, at, sides, each) for each in ((1, 0), (0, 1)))
    return normalize(np.cross(by_u, by_v))


def _node_span(
    struts: RoundStruts,
    group: BlendedNodes,
    turns: RunTurns,
    stack: _Stack,
    frames: FrameParts,
    edges: RunEdges,
) -> Span:
    """Return what lies between the arcs and the collars of nodes."""
    half_runs = group.half_runs
    every = np.broadcast_to(half_runs[..., None], stack.hubs.shape)
    rows = frames.add_sections(stack.hubs, turns.seen_along(every, stack.rings))
    pairs = np.stack([rows[:, :, :-1], rows[:, :, 1:]], axis=-1)  # (M, N, levels, 2)
    backward = (half_runs % 2 == 1)[..., None, None]
    pairs = np.where(backward, pairs[..., ::-1], pairs).reshape(-1, 2)
    run = np.broadcast_to(half_runs[..., None] >> 1, stack.hubs[:, :, 1:].shape).reshape(-1)
    edge = edges.at(edges.number[run], frames.middles(pairs))
    branch = np.where(struts.runs.valency[group.nodes] >= 3, group.nodes, -1)
    nodes = np.repeat(branch, len(pairs) // max(len(branch), 1))
    return Span(pairs, 1, edge, np.stack([nodes, nodes], axis=1), np.empty(0, dtype=np.intp))


def _straight_span(
    struts: RoundStruts,
    turns: RunTurns,
    sections: Ints,
    pieces: int,
    frames: FrameParts,
    edges: RunEdges,
) -> Span:
    """Return what lies between collars, with sections at joints, and where rings turn.

    Parameters
    ----------
    sections : (2 k,) those at the collars
    """
    runs, collar = struts.runs, struts.collar.reshape(-1, 2)
    every = np.arange(len(runs.edges))
    run = np.searchsorted(edges.number, edges.run)
    is_straight = np.isin(edges.run, edges.number)
    run, start = run[is_straight], edges.start[is_straight]
    slack = JOINT_GAP * turns.radius.reshape(-1, 2).max(axis=1)
    inside = (start > collar[run, 0] + slack[run]) & (
        start < runs.lengths[run] - collar[run, 1] - slack[run]
    )
    run, start = run[inside], start[inside]
    # Straight sides between rings that are turned make a waist: other runs are cut for that.
    most = pieces * 2 * np.pi / frames.sides
    cuts = np.maximum(np.ceil(np.abs(turns.rest) / most - 1e-9).astype(np.intp) - 1, 0)
    cuts[run] = 0
    more = np.repeat(every, cuts)
    place = steps(cuts) + 1
    free = runs.lengths - collar.sum(axis=1)
    run = np.concatenate([run, more])
    start = np.concatenate([start, collar[more, 0] + free[more] * place / (cuts[more] + 1)])
    share = (start - collar[run, 0]) / (runs.lengths[run] - collar[run].sum(axis=1))
    turn = turns.turn[2 * run] + turns.rest[run] * share
    axis = runs.directions[2 * run]
    middle = runs.nodes[runs.edges[run, 0]] + start[:, None] * axis
    radius = runs.radii_at(2 * run, start)
    hubs = frames.add_hubs(middle, radius)
    around = middle[:, None] + _around(struts.x[2 * run], axis, turn, radius, frames.sides)
    at_joints = frames.add_sections(hubs, frames.add_rim(around, hubs))
    owner = np.concatenate([every, run])
    order = np.lexsort((np.concatenate([collar[:, 0], start]), owner))
    first = np.concatenate([sections[::2], at_joints])[order]
    owner = owner[order]
    last = np.roll(first, -1)
    ending = np.ones(len(owner), dtype=np.bool_)
    ending[:-1] = owner[1:] != owner[:-1]
    last[ending] = sections[1::2][owner[ending]]
    pairs = np.stack([first, last], axis=1)
    edge = edges.at(edges.number[owner], frames.middles(pairs))
    return Span(pairs, pieces, edge, np.full(pairs.shape, -1, dtype=np.intp), np.arange(len(pairs)))


def _curve_span(
    straight: RoundStruts,
    rings: Ints,
    hubs: Ints,
    frames: FrameParts,
    edges: RunEdges,
) -> Span:
    """Return what lies between the rings of curves.

    Parameters
    ----------
    rings : (2 k, sides) of straight half-runs
    hubs : (2 k,) of these
    """
    curves = straight.curves
    found = intervals(curves, intervals_of(curves, frames.sides, straight.options.wall))
    order, circles = found.order, found.frames[found.order.is_own]
    radius = np.sqrt(dot(circles[:, 1], circles[:, 1]))
    hub = np.empty(len(found.piece), dtype=np.intp)
    ring = np.empty((len(found.piece), frames.sides), dtype=np.intp)
    hub[order.is_own] = own = frames.add_hubs(circles[:, 0], radius)
    angle = 2 * np.pi / frames.sides * np.arange(frames.sides)
    unit = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    ring[order.is_own] = frames.add_rim(np.einsum("sk,lkx->lsx", unit, circles), own)
    start, end = curves.half_runs[~curves.closed].T
    hub[order.last], ring[order.last] = hubs[end], rings[end]
    # Seen the way the curve runs, the ring of the strut before it runs the other way round.
    backward = -np.arange(frames.sides) % frames.sides
    low = frames.add_sections(
        order.before(hub, hubs[start]), order.before(ring, rings[start][:, backward])
    )
    pairs = np.stack([low, frames.add_sections(hub, ring)], axis=1)
    edge = edges.at(curves.run[curves.pieces][found.piece], frames.middles(pairs))
    none = np.empty(0, dtype=np.intp)
    return Span(pairs, 1, edge, np.full(pairs.shape, -1, dtype=np.intp), none)


def _round_ends(
    struts: RoundStruts,
    turns: RunTurns,
    ends: Ints,
    own: Points,
    sections: Ints,
    frames: FrameParts,
) -> tuple[Ints, Span, Caps]:
    """Return the last sections of struts with round ends, what lies before them, and spheres.

    Parameters
    ----------
    ends : (e,) half-runs that leave extremities
    own : (e, sides, 3) points of their circles, mm
    sections : (e,) those there
    """
    runs, radius = struts.runs, turns.radius[ends]
    sphere = end_spheres(struts, ends)
    outward, node = -runs.directions[ends], runs.nodes[runs.tails[ends]]
    levels = max(1, frames.sides // 8)
    share = np.arange(1, levels + 1) / levels
    latitude = sphere.start[:, None] + share * RIM_OF_CAP * (np.pi / 2 - sphere.start[:, None])
    wide = sphere.size[:, None] * np.cos(latitude) / radius[:, None]  # (e, levels)
    high = sphere.center[:, None] + sphere.size[:, None] * np.sin(latitude)
    spokes = own - node[:, None]
    around = (
        wide[..., None, None] * spokes[:, None] + high[..., None, None] * outward[:, None, None]
    )
    tip = (sphere.center + sphere.size)[:, None, None] * share[:, None] * outward[:, None]
    hubs = frames.add_hubs(node[:, None] + tip, np.broadcast_to(radius[:, None], wide.shape))
    rings = frames.add_rim(node[:, None, None] + around, hubs)
    every = np.broadcast_to(ends[:, None], hubs.shape)
    beyond = frames.add_sections(hubs, turns.seen_along(every, rings))
    rows = np.concatenate([sections[:, None], beyond], axis=1)
    pairs = np.stack([rows[:, :-1], rows[:, 1:]], axis=2)
    pairs = np.where((ends % 2 == 0)[:, None, None], pairs[..., ::-1], pairs).reshape(-1, 2)
    none = np.empty(0, dtype=np.intp)
    nodes = np.full(pairs.shape, -1, dtype=np.intp)
    span = Span(pairs, 1, np.repeat(ends >> 1, levels), nodes, none)
    centers = node + sphere.center[:, None] * outward
    return (
        beyond[:, -1],
        span,
        Caps(centers, sphere.size, rings.reshape(len(ends), levels * frames.sides)),
    )
