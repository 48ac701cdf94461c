"""The triangles of round struts: stacks of rings at the nodes, bands between them, ends."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Triangles, read_only
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.curves.rings import CurveRings, curve_rings, intervals_of
from scaffold_cad.struts.hollow.sockets import socket_triangles
from scaffold_cad.struts.meshes.bands import (
    band_triangles,
    enlargement,
    matching,
    polygon_slack,
    ring_triangles,
    twist_of,
)
from scaffold_cad.struts.meshes.ends import closings
from scaffold_cad.struts.meshes.fineness import Fineness
from scaffold_cad.struts.meshes.rings import Grid, stacks
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.sharp.surface import node_triangles


@dataclass(frozen=True, eq=False)
class Sized(Frozen):
    """How the rings of both ends of runs are joined, and how large they are."""

    shift: Ints
    """See `Matching`, shape (k,)."""
    twist: Floats
    """See `Matching`, shape (k,), rad."""
    growth: Floats
    """How much larger than its circle the polygon of each half-run's ring is, shape (2 k,), mm."""
    radius: Floats
    """Radius of each half-run's circle, shape (2 k,), mm."""


@dataclass(frozen=True, eq=False)
class Triangulated(Frozen):
    """Triangles of round struts, and what they stand around."""

    mesh: TriangleMesh
    """The triangles, those of nodes first, then those of curves."""
    node: Ints
    """Node that each triangle of a node stands around, shape (t',)."""
    curve_rings: CurveRings
    """The rings of curves; the triangles between two follow each other."""
    shift: Ints
    """How the rings of each run are joined, see `Matching`, shape (k,)."""
    owner: Ints
    """What each triangle belongs to: node v as v, run i as -1 - i, shape (t,)."""
    swell: Floats
    """How far the triangles of nodes reach beyond their blends where this is more than polygons
    reach beyond circles, mm, shape (n,)."""


@dataclass(frozen=True, eq=False)
class Shell(Frozen):
    """One surface of round struts, and the rings at the ends of struts."""

    made: Triangulated
    """Its triangles."""
    ends: Ints
    """Half-runs that leave the nodes where struts end, but for balls, ascending, shape (e,)."""
    rings: Ints
    """Vertices of the ring at each of these, counter-clockwise about the half-run, (e, sides)."""


def triangulated(struts: RoundStruts, sides: int) -> Triangulated:
    """Return the surface of round struts as triangles; hollow ones have theirs inside too.

    Struts made like others have their triangles, with the vertices moved.

    Parameters
    ----------
    sides : points of a ring, a multiple of 4
    """
    outer = shell_of(struts, sides)
    if struts.inner is None:
        return outer.made
    inside = shell_of(inside_of(struts), sides)
    count = len(outer.made.mesh.vertices)
    faces = [outer.made.mesh.triangles, inside.made.mesh.triangles[:, ::-1] + count]
    more_owners: list[Ints] = []
    points = [outer.made.mesh.vertices, inside.made.mesh.vertices]
    if struts.options.ends == "open":
        more, closing, run = open_ends(
            struts, outer.ends, outer.rings, inside.rings + count, points
        )
        points.append(more)
        faces.append(closing)
        more_owners.append(-1 - run)
    mesh = TriangleMesh(np.concatenate(points), np.concatenate(faces))
    made = outer.made
    owner = np.concatenate([made.owner, inside.made.owner, *more_owners])
    swell = np.maximum(made.swell, inside.made.swell)
    return Triangulated(mesh, made.node, made.curve_rings, made.shift, owner, swell)


def open_ends(
    struts: RoundStruts, ends: Ints, outer: Ints, inner: Ints, points: list[Points]
) -> tuple[Points, Triangles, Ints]:
    """Return the vertices of sockets, the triangles of open ends, and the run of each.

    Parameters
    ----------
    ends : (e,) half-runs at ends that are open
    outer, inner : (e, sides) vertices of the rings there
    points : those so far
    """
    sides = outer.shape[1]
    places, bored = _sockets(struts, ends, sides)
    first = sum(len(each) for each in points)
    number = first + np.arange(places.size // 3).reshape(-1, 2, sides)  # at shoulder and end
    faces = [socket_triangles(number[:, 0], number[:, 1], inner[bored])]
    inner = inner.copy()
    inner[bored] = number[:, 1]
    faces.append(annuli(outer, inner))
    around = [np.repeat(some >> 1, sides) for some in (ends[bored], ends)]
    run = np.concatenate([np.tile(around[0], 4), np.tile(around[1], 2)])
    return places.reshape(-1, 3), np.concatenate(faces), run


def inside_of(struts: RoundStruts) -> RoundStruts:
    """Return the inside of hollow struts, with rings at the ends that begin as those outside."""
    assert struts.inner is not None
    x, runs = struts.inner.x.copy(), struts.runs
    ends = np.flatnonzero(runs.valency[runs.tails] == 1)
    x[ends] = struts.x[ends]
    like = None if struts.like is None else inside_of(struts.like)
    return replace(struts.inner, x=x, like=like)


def _sockets(struts: RoundStruts, ends: Ints, sides: int) -> tuple[Points, Ints]:
    """Return the rings of sockets, (q, 2, sides, 3), mm, and their places among ends, (q,)."""
    runs, sockets = struts.runs, struts.sockets
    place = np.flatnonzero(np.isin(runs.tails[ends], sockets.nodes))
    half_run = ends[place]
    row = np.searchsorted(sockets.nodes, runs.tails[half_run])
    radii, depths = sockets.radii[row], sockets.depths[row]
    inward, x = runs.directions[half_run], struts.x[half_run]
    angle = 2 * np.pi / sides * np.arange(sides)
    axes = np.stack([x, np.cross(inward, x)], axis=1)  # (q, 2, 3)
    around = np.einsum("ks,qkx->qsx", np.stack([np.cos(angle), np.sin(angle)]), axes)
    wide = radii * enlargement(np.zeros(1), sides)[0]
    deep = np.stack([depths, 0 * depths], axis=1)  # (q, 2)
    centers = runs.nodes[runs.tails[half_run]][:, None] + deep[..., None] * inward[:, None]
    return centers[:, :, None] + wide[:, None, None, None] * around[:, None], place


def annuli(outer: Ints, inner: Ints) -> Triangles:
    """Return the triangles between rings (e, s) that begin alike, seen from out of the struts."""
    a, b = np.roll(outer, -1, axis=1), outer
    d, c = np.roll(inner, -1, axis=1), inner
    pairs = [np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]
    return np.concatenate(pairs).reshape(-1, 3)


class _Parts:
    """The vertices and triangles of a shell, part after part."""

    def __init__(self, count: int, sides: int) -> None:
        self.points: list[Points] = []
        self.faces: list[Triangles] = []
        self.owners: list[Ints] = []
        self.rings = np.zeros((count, sides), dtype=np.intp)  # vertices of half-runs' rings
        self.count = 0

    def placed(self, points: Points) -> Ints:
        """Add vertices (..., 3), and return their numbers (...)."""
        numbers = self.count + np.arange(points.size // 3).reshape(points.shape[:-1])
        self.points.append(points.reshape(-1, 3))
        self.count += numbers.size
        return numbers

    def add(self, triangles: Triangles, owner: Ints) -> None:
        """Add triangles (t, 3) and what they belong to, each owner that of as many of them."""
        self.faces.append(triangles)
        self.owners.append(np.repeat(owner, len(triangles) // max(1, len(owner))))


def shell_of(struts: RoundStruts, sides: int, open_at: Bools | None = None) -> Shell:
    """Return the outer surface of round struts.

    Vertices come node by node, by valency and number, then those of ends and of curves: they do not
    depend on how the patches are cut.

    Parameters
    ----------
    open_at : (n,) nodes where struts end without a disc or a ball; none by default
    """
    number = np.flatnonzero(np.repeat(~struts.curves.curved, 2))  # of the half-runs left
    owner = -1 - (number[::2] >> 1)  # of the triangles of each run left
    struts = struts.straight
    model = None if struts.like is None else shell_of(struts.first, sides).made
    sized = sized_rings(struts, sides, None if model is None else model.shift)
    own = own_rings(struts, np.arange(len(struts.collar)), sized, sides)  # (2 k, sides, 3)
    parts = _Parts(len(own), sides)
    swell = _add_blended(parts, struts, own, sized.growth, model)
    _add_sharp(parts, struts, own)
    ends = np.flatnonzero(struts.runs.valency[struts.runs.tails] == 1)
    parts.rings[ends] = parts.placed(own[ends])
    passed = _add_curves(parts, struts, own)
    is_ball = struts.at_balls[ends]
    is_open = ~is_ball & (struts.options.ends == "open")
    if open_at is not None:
        is_open |= open_at[struts.runs.tails[ends]]
    for make, some in closings(struts, ends[~is_open]):
        extra, closing = make(struts, some, parts.rings[some], own[some], parts.count)
        parts.placed(extra)
        parts.add(closing, owner[some >> 1])
    bands = band_triangles(parts.rings[0::2], parts.rings[1::2], sized.shift, sized.twist)
    parts.add(bands, owner)
    owner, triangles = np.concatenate(parts.owners), np.concatenate(parts.faces)
    if model is not None:
        owner, triangles = model.owner, model.mesh.triangles
    mesh = TriangleMesh(read_only(np.concatenate(parts.points)), read_only(triangles))
    made = Triangulated(mesh, owner[owner >= 0], passed, sized.shift, owner, swell)
    return Shell(made, number[ends[~is_ball]], parts.rings[ends[~is_ball]])


def _add_blended(
    parts: _Parts, struts: RoundStruts, own: Points, growth: Floats, model: Triangulated | None
) -> Floats:
    """Add the nodes with blends, all vertices of them by `_blocks`; return the swell, (n,).

    Parameters
    ----------
    model : what has their triangles, with other vertices
    """
    fineness = Fineness.of(struts, own.shape[1])
    starts, count = _blocks(struts, fineness)
    points, swell = np.empty((count, 3)), np.zeros(len(struts.runs.nodes))
    parts.placed(points)
    for group, grid in fineness.parts(struts.blended):
        half_runs = group.half_runs
        given = None
        if model is not None:
            given = _triangles_around(model, group.nodes) - starts[group.nodes][:, None, None]
        made = node_surface(struts, group, own[half_runs], growth[half_runs], grid, given)
        block = len(made.points) // len(group.nodes)
        place = (starts[group.nodes][:, None] + np.arange(block)).reshape(-1)
        points[place] = made.points
        parts.rings[half_runs] = place[made.rings]
        parts.add(place[made.triangles], group.nodes)
        swell[group.nodes] = made.swell
    return swell


def _triangles_around(made: Triangulated, nodes: Ints) -> Ints:
    """Return the triangles around nodes (m,) that have as many each, (m, t, 3)."""
    order = np.argsort(made.node, kind="stable")
    first, last = (np.searchsorted(made.node[order], nodes, side) for side in ("left", "right"))
    rows = order[first[:, None] + np.arange(last[0] - first[0])]
    return made.mesh.triangles[rows]


def _add_sharp(parts: _Parts, struts: RoundStruts, own: Points) -> None:
    """Add the sharp nodes."""
    for group in node_triangles(struts, own.shape[1]):
        rings = own[group.half_runs].reshape(len(group.nodes), -1, 3)
        vertex = parts.placed(np.concatenate([group.points, rings], axis=1))
        of_rings = vertex[:, group.points.shape[1] :]
        parts.rings[group.half_runs] = of_rings.reshape(*group.half_runs.shape, -1)
        parts.add(vertex[:, group.triangles].reshape(-1, 3), group.nodes)


def _add_curves(parts: _Parts, struts: RoundStruts, own: Points) -> CurveRings:
    """Add the curves; return their rings."""
    curves, sides = struts.curves, own.shape[1]
    at_ends = curves.half_runs[~curves.closed].reshape(-1)
    parts.rings[at_ends] = parts.placed(own[at_ends])
    rings = own[at_ends].reshape(-1, 2, sides, 3)
    passed = curve_rings(curves, _intervals(struts, sides), parts.rings, rings, parts.count)
    parts.placed(passed.points)
    triangles = ring_triangles(np.concatenate(parts.points), passed.low, passed.high)
    parts.add(triangles, -1 - curves.run[curves.pieces][passed.piece])
    return passed


def _intervals(struts: RoundStruts, sides: int) -> Ints:
    """Return how many intervals the pieces of curves have: those of the first model."""
    first = struts.first
    return intervals_of(first.curves, sides, first.options.wall)


def _blocks(struts: RoundStruts, fineness: Fineness) -> tuple[Ints, int]:
    """Return the first vertex of each blended node, shape (n,), and how many they have."""
    valency, sizes = np.zeros((2, len(struts.runs.nodes)), dtype=np.intp)
    for group, grid in fineness.parts(struts.blended):
        valency[group.nodes] = group.half_runs.shape[1]
        sizes[group.nodes] = grid.block_size(group.half_runs.shape[1])
    order = np.argsort(valency, kind="stable")
    starts = np.empty_like(sizes)
    starts[order] = np.cumsum(sizes[order]) - sizes[order]
    return starts, int(sizes.sum())


def first_alike(struts: RoundStruts, sides: int) -> Ints:
    """Return the same vertex of the first node of the same shape, for those of blends, (v,)."""
    straight = struts.straight
    fineness = Fineness.of(straight, sides)
    starts, count = _blocks(straight, fineness)
    found = np.arange(count)
    for group, grid in fineness.parts(straight.blended):
        _, first, of = np.unique(group.shape_of, return_index=True, return_inverse=True)
        block = np.arange(grid.block_size(group.half_runs.shape[1]))
        own, alike = starts[group.nodes], starts[group.nodes[first[of.reshape(-1)]]]
        found[own[:, None] + block] = alike[:, None] + block
    return found


def sized_rings(struts: RoundStruts, sides: int, shift: Ints | None = None) -> Sized:
    """Return how the rings of runs are joined, as `shift` has it or with least twist, and sized."""
    x, far_x = struts.x[0::2], struts.x[1::2]
    y = np.cross(struts.runs.directions[0::2], x)
    if shift is None:
        matched = matching(x, y, far_x, sides)
        shift, twist = matched.shift, matched.twist
    else:
        twist = twist_of(x, y, far_x, sides, shift)
    radius = struts.runs.radii_at(np.arange(len(struts.collar)), struts.collar)
    growth = np.repeat(enlargement(twist, sides) - 1.0, 2) * radius
    return Sized(shift, twist, growth, radius)


def own_rings(struts: RoundStruts, half_runs: Ints, sized: Sized, sides: int) -> Points:
    """Return the points of the rings of half-runs (h,), shape (h, sides, 3), mm."""
    angle = 2 * np.pi / sides * np.arange(sides)
    x, ahead = struts.x[half_runs], struts.runs.directions[half_runs]
    y = np.cross(ahead, x)
    spoke = np.cos(angle)[:, None] * x[:, None] + np.sin(angle)[:, None] * y[:, None]
    radius = (sized.radius + sized.growth)[half_runs]
    rings: Points = ring_centers(struts, half_runs)[:, None] + radius[:, None, None] * spoke
    return rings


def ring_centers(struts: RoundStruts, half_runs: Ints) -> Points:
    """Return the centers of the collars of half-runs (h,), shape (h, 3), mm."""
    runs = struts.runs
    ahead = struts.collar[half_runs, None] * runs.directions[half_runs]
    centers: Points = runs.nodes[runs.tails[half_runs]] + ahead
    return centers


@dataclass(frozen=True, eq=False)
class NodeSurfaces(Frozen):
    """The triangles of M nodes of valency N."""

    points: Points
    """Node by node, shape (M b, 3), mm."""
    triangles: Triangles
    """Node by node."""
    rings: Ints
    """Vertices of the rings at the collars, shape (M, N, sides)."""
    swell: Floats
    """See `Triangulated`, shape (M,), mm."""


def node_surface(
    struts: RoundStruts,
    group: BlendedNodes,
    own: Points,
    growth: Floats,
    grid: Grid,
    given: Ints | None = None,
) -> NodeSurfaces:
    """Return the triangles of nodes.

    Parameters
    ----------
    own : (M, N, sides, 3) points of the rings, mm
    growth : (M, N), see `Sized`, mm
    grid : how many samples patches have
    given : (M, t, 3) the triangles between samples, see `stacks`
    """
    growth = growth / group.shapes.collar_radii[group.shape_of]
    sampled = stacks(group, growth, grid, polygon_slack(grid.sides), given)
    count, block = sampled.points.shape[:2]
    first = block * np.arange(count)[:, None, None]
    rings = sampled.collars + first
    points = (sampled.points + struts.runs.nodes[group.nodes][:, None]).reshape(-1, 3)
    points[rings] = own
    triangles = (sampled.triangles + first).reshape(-1, 3)
    return NodeSurfaces(points, triangles, rings, sampled.swell)
