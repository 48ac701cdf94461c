"""What is made at each node, a blend, a curve or a torus, and the room that it has on struts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, UnitVectors
from scaffold_cad.partition import partition_spheres
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.blending.bends import bend_partitions
from scaffold_cad.struts.blending.blend import Stars
from scaffold_cad.struts.blending.copies import Views
from scaffold_cad.struts.blending.nodes import nearest_collars
from scaffold_cad.struts.curves.joints import (
    CurvedJoints,
    curved_joints,
    joints_inside,
    possible,
    sampled,
)
from scaffold_cad.struts.elbows import Elbows, elbows_of
from scaffold_cad.struts.groups import Group
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import StrutOptions
from scaffold_cad.struts.room import allotted
from scaffold_cad.struts.runs import Runs, ball_collars, balls_of


@dataclass(frozen=True, eq=False)
class Plan:
    """What is made at each node, and how much room it has."""

    groups: list[Group]
    """Nodes with blends."""
    wanted: list[Stars]
    """What the blends of each group are asked for."""
    joints: CurvedJoints
    """Joints that curves pass."""
    limits: Floats
    """Greatest collar distance of each half-run, shape (2 k,), mm."""
    no_room: Bools
    """Runs whose nodes have no room on them, shape (k,)."""
    room: Floats
    """Length of each run that collars share, without sockets if they can, shape (k,), mm."""
    full: Floats
    """Collar distance of each half-run that its fillet asks for, shape (2 k,), mm."""
    elbows: Elbows
    """Bends that are parts of tori."""


def planned(
    skeleton: Skeleton,
    runs: Runs,
    options: StrutOptions,
    like: RoundStruts | None,
    outer: RoundStruts | None,
    blended: Bools | None,
) -> Plan:
    """Return the plan; joints that have no room for a bend and can be of a curve are."""
    model, balls = outer if like is None else like, ball_collars(skeleton, runs)
    able = possible(skeleton, runs)
    at = sampled(runs, able, options.joints) if model is None else model.at_curves
    bendable = ~at if blended is None else ~(at | blended)
    elbows = elbows_of(skeleton, runs, bendable, options.bend, like, outer)
    while True:
        bent = np.zeros_like(at)
        bent[elbows.nodes] = True
        groups = _groups(runs, at | bent)
        wanted = [_stars(skeleton, runs, group, options, outer, like) for group in groups]
        full, least = _collars(balls, groups, wanted)
        closed = _shortening(options)
        curved = None if model is None else model.curves.curved
        joints = curved_joints(runs, at, full, closed, curved)
        if outer is not None:
            joints = joints_inside(runs, joints, outer.collar)
        joints, cut = elbows.beside(joints), elbows.cut(runs, closed)
        asked = full + joints.wanted + cut
        room, limits, no_room = _limits(runs, options, asked, least + joints.least + cut)
        short = np.zeros_like(at)
        short[runs.edges[no_room]] = True
        if model is None and (short & bent).any():
            elbows = elbows.with_room(runs, short, least + joints.least)
            continue
        more = short & able & ~at
        if model is not None or options.joints != "auto" or not more.any():
            return Plan(groups, wanted, joints, limits, no_room, room, asked, elbows)
        at = at | more


def _shortening(options: StrutOptions) -> float:
    """Return by how much the inside of struts is shorter at extremities, at most, mm."""
    flat = options.wall if options.wall and options.ends == "flat" else 0.0
    return max([flat, *(depth for _, depth in (options.sockets or {}).values())])


def _groups(runs: Runs, curved: Bools) -> list[Group]:
    """Return the branch points, and the bends but for joints of curves, by valency, ascending."""
    groups = []
    blended = np.where(curved, 0, runs.valency)
    for valency in np.unique(blended[blended > 1]).tolist():
        nodes = np.flatnonzero(blended == valency)
        groups.append(Group(nodes, runs.incidence.at_nodes(nodes, valency)))
    return groups


def _stars(
    skeleton: Skeleton,
    runs: Runs,
    group: Group,
    options: StrutOptions,
    outer: RoundStruts | None,
    like: RoundStruts | None,
) -> Stars:
    """Return what the blends of nodes are asked for, with room without end."""
    directions = runs.directions[group.half_runs]  # (M, N, 3)
    radii = runs.radii.reshape(-1)[group.half_runs]
    ball = balls_of(skeleton, runs)[group.nodes]
    thin = radii.min(axis=1)
    blend = options.blends(group.nodes, thin)
    if outer is not None:
        blend = outer.fillet[group.nodes] + (outer.options.wall or 0.0)
    vertices, quads = _partitions(directions, radii, group, like or outer)
    most = np.full(radii.shape, np.inf)
    slopes = runs.slopes[group.half_runs]
    return Stars(directions, radii, slopes, blend, ball, most, vertices, quads)


def _partitions(
    directions: UnitVectors, radii: Floats, group: Group, like: RoundStruts | None
) -> tuple[UnitVectors, Ints]:
    """Return partition vertices (M, N + 2, 3) and quads (M, N, 4) around directions (M, N, 3).

    Turned copies of nodes, with the same radii (M, N), have turned copies of partitions.
    """
    views = Views.of(directions, radii / radii.mean(axis=1, keepdims=True))
    seen = views.by_number(views.seen(directions))
    if directions.shape[1] == 2:
        made = bend_partitions(seen)
    elif like is None:
        made = partition_spheres(seen)
    else:
        quads, vertices = _of_nodes(like, group)
        quads, vertices = views.by_number(quads), views.seen(vertices)
        made = partition_spheres(seen, like=quads, near=vertices)
    return views.meant(made.vertices), views.by_strut(made.quads)


def _of_nodes(struts: RoundStruts, group: Group) -> tuple[Ints, UnitVectors]:
    """Return the quads (M, N, 4) and vertices (M, N + 2, 3) of nodes in other struts."""
    count, valency = group.half_runs.shape
    quads = np.empty((count, valency, 4), dtype=np.intp)
    vertices = np.empty((count, valency + 2, 3))
    for other in struts.blended:
        if other.half_runs.shape[1] == valency:
            place = np.searchsorted(group.nodes, other.nodes)
            quads[place] = other.quads[other.shape_of]
            vertices[place] = other.shapes.vertices[other.shape_of]
    return quads, vertices


def _collars(balls: Floats, groups: list[Group], wanted: list[Stars]) -> tuple[Floats, Floats]:
    """Return the collar distances that blends want, and those of the smallest fillets, (2 k,).

    Parameters
    ----------
    balls : (2 k,) those at balls, see `ball_collars`
    """
    full, least = balls.copy(), balls.copy()
    for group, stars in zip(groups, wanted, strict=True):
        full[group.half_runs], least[group.half_runs] = nearest_collars(stars)
    return full, least


def _limits(
    runs: Runs, options: StrutOptions, full: Floats, least: Floats
) -> tuple[Floats, Floats, Bools]:
    """Return what room runs have, (k,), mm, the greatest collar distances, and runs without room.

    Distances are of each half-run, (2 k,), mm.
    """
    bored = np.zeros(len(runs.nodes))
    for node, (_, depth) in (options.sockets or {}).items():
        bored[node] = depth
    left = runs.lengths - bored[runs.edges].sum(axis=1)
    room = np.where(allotted(full, least, left)[1], runs.lengths, left)
    allowed, no_room = allotted(full, least, room)
    # Where all that is wanted fits there is no limit: equal nodes stay equal.
    fits = np.repeat(full.reshape(-1, 2).sum(axis=1) <= room, 2)
    return room, np.where(fits, np.inf, allowed), no_room
