"""How thick walls between triangles are, and how what is inside is to move.

Walls are measured from places inside to the surface outside, and from edges outside that are
reentrant, whose nearest places may be anywhere in a triangle inside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Triangles
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.topology import edges_of_sides, sides_of
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.mesh.nearest import NearestPlace
from scaffold_cad.mesh.trianglemesh import TriangleMesh

TOO_MUCH = 1.03
"""What is thicker than this, in walls, is thinned in fields."""

ALIKE = 1.5
"""What is thicker than asked by up to this, in walls, is thinned to the wall."""

MORE = 1.01
"""What is too thin is moved to this times what is enough: to the whole wall, triangles between
vertices that moved would be too far in."""

FURTHER = 5.0
"""How many times further than a place at most a corner moves to move it: others may be fixed."""

LUMP = 3.0
"""What is thicker than this, in walls, stays: a void that is filled."""

LARGE = 4.0
"""Size of the pieces of triangles that nearest places are looked for in, in walls."""

NEEDLE, SLIM = 1.0, 4.0
"""Needles longer than this, in walls, and this times their height are cut into pieces, too: the
middles of needles beside each other are nearer than that of the one that is nearest."""

NEAR = 2.0
"""How far from the inside triangles are looked at, in walls."""

REENTRANT = 0.02
"""Least angle between the triangles of an edge that is looked at as reentrant, rad."""

PITCH = 0.3
"""Distance of the places that are looked at along such edges, in walls."""


@dataclass(frozen=True, eq=False)
class Aim:
    """How thick walls are to be."""

    outside: NearestPlace
    """What they are measured to."""
    reentrant: Points
    """Places of reentrant edges outside, (e, 3), mm."""
    wall: float
    """As asked, mm."""
    least: float
    """What is enough, mm."""

    @staticmethod
    def of(vertices: Points, outer: Triangles, points: Points, wall: float, least: float) -> Aim:
        """Return the aim of what is inside of triangles.

        Parameters
        ----------
        outer : triangles outside
        points : those inside
        """
        outer = outer[near_to(vertices[outer], points, wall)]
        corners, _ = _pieces(vertices[outer], points, wall)
        return Aim(_surface(corners), _reentrant(vertices, outer, wall), wall, least)

    def thicker(self, points: Points) -> Floats:
        """Return how points are to move where walls are too thin, (k, 3), mm."""
        rows, places, _ = self.outside.nearer(points, self.least)
        way = np.zeros_like(points)
        way[rows] = self._away(points[rows] - places)
        return way

    def thicker_below(self, corners: Floats, moves: Bools) -> tuple[Ints, Floats]:
        """Return corners inside that are to move from reentrant edges, and how, (q,), (q, 3), mm.

        Parameters
        ----------
        corners : of triangles inside, (t, 3, 3)
        moves : (t, 3) whether they may
        """
        rows, places, triangle = self._below(corners, self.least)
        way = self._away(places - self.reentrant[rows])
        part = shares(weights_of(places, corners[triangle]), moves[triangle])  # (q, 3)
        own = 3 * triangle[:, None] + np.arange(3)
        return own.reshape(-1), (part[..., None] * way[:, None]).reshape(-1, 3)

    def thinner(self, points: Points) -> Floats:
        """Return how points are to move where walls are too thick, (k, 3), mm."""
        way = points - self.outside.nearest(points)
        share = length(way) / self.wall
        wanted = 1.0 + (share - ALIKE).clip(0.0) * (LUMP - 1.0) / (LUMP - ALIKE)
        lumps: Bools = np.asarray((share > TOO_MUCH) & (share < LUMP))
        growth = np.where(lumps, wanted / np.where(lumps, share, 1.0) - 1.0, 0.0)
        return np.asarray(growth[:, None] * way)

    def thinnest(self, vertices: Points, faces: Triangles, limit: float) -> tuple[float, Points]:
        """Return how thin walls of triangles inside (t, 3) are below a limit, mm, and where."""
        looked = [vertices[each].mean(axis=1) for each in between(faces)]
        points = np.concatenate([vertices[np.unique(faces)], *looked])
        rows, places, _ = self.outside.nearer(points, limit)
        below, feet, _ = self._below(vertices[faces], limit)
        starts = np.concatenate([points[rows], self.reentrant[below]])
        if len(starts) == 0:
            return limit, np.zeros(3)
        far = length(np.concatenate([places, feet]) - starts)
        return float(far.min()), starts[far.argmin()]

    def _below(self, corners: Floats, limit: float) -> tuple[Ints, Points, Ints]:
        """Return reentrant places (q,) nearer than a limit to triangles, where, and these (q,)."""
        pieces, parent = _pieces(corners, self.reentrant, self.wall)
        if len(pieces) == 0:
            none = np.zeros(0, dtype=np.intp)
            return none, np.zeros((0, 3)), none
        rows, places, piece = _surface(pieces).nearer(self.reentrant, limit)
        return rows, places, parent[piece]

    def _away(self, way: Floats) -> Floats:
        """Return what ways (k, 3) from the outside lack, (k, 3), mm."""
        far = length(way)
        share = np.where(far > 0, MORE * self.least / np.where(far > 0, far, 1.0) - 1.0, 0.0)
        return np.asarray(share[:, None] * way)


def weights_of(places: Points, corners: Floats) -> Floats:
    """Return what each corner of triangles (q, 3, 3) weighs in a place on them (q, 3), (q, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    size = np.maximum(dot(normal, normal), np.finfo(float).tiny)
    of_b = dot(np.cross(places - a, c - a), normal) / size
    of_c = dot(np.cross(b - a, places - a), normal) / size
    return np.stack([1.0 - of_b - of_c, of_b, of_c], axis=1).clip(0.0, 1.0)


def shares(weights: Floats, moves: Bools) -> Floats:
    """Return how far the corners of places move for these to move by 1, (q, k).

    It is the least that they can move together, 0 where one would move more than `FURTHER`.

    Parameters
    ----------
    weights : (q, k) of corners in places
    moves : (q, k) whether they may
    """
    free = np.where(moves, weights, 0.0)
    size = np.maximum((free * free).sum(axis=1, keepdims=True), np.finfo(float).tiny)
    found = free / size
    return np.where(found.max(axis=1, keepdims=True) > FURTHER, 0.0, found)


def between(faces: Triangles) -> tuple[Triangles, Edges]:
    """Return triangles (t, 3) and their edges (e, 2): walls are looked at in their middles."""
    return faces, edges_of_sides(sides_of(faces))[0]


def near_to(corners: Floats, points: Points, wall: float) -> Bools:
    """Return which triangles (t, k, 3) may have one of some points within `NEAR` walls, (t,)."""
    if len(points) == 0:
        return np.zeros(len(corners), dtype=np.bool_)
    middle = corners.mean(axis=1)
    reach = length(corners - middle[:, None]).max(axis=1) + NEAR * wall
    far = cKDTree(points).query(middle, distance_upper_bound=float(reach.max(initial=0.0)))[0]
    return np.asarray(far < reach)


def _surface(corners: Floats) -> NearestPlace:
    """Return triangles (t, 3, 3) to look for nearest places of."""
    return NearestPlace(
        TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    )


def _pieces(corners: Floats, points: Points, wall: float) -> tuple[Floats, Ints]:
    """Return what of triangles (t, 3, 3) is near some points, in pieces of about one size.

    Returns
    -------
    (p, 3, 3) corners of pieces, and the triangle of each, (p,)
    """
    pieces, parents = [np.zeros((0, 3, 3))], [np.zeros(0, dtype=np.intp)]
    parent = np.arange(len(corners))
    usual = float(np.median(_sides(corners).max(axis=1))) if len(corners) else 0.0
    most = max(LARGE * wall, usual)
    while len(corners):
        near = near_to(corners, points, wall)
        corners, parent = corners[near], parent[near]
        sides = _sides(corners)
        longest = sides.max(axis=1, initial=0.0)
        twice = length(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        needle = (longest > NEEDLE * wall) & (longest**2 > SLIM * twice)
        large: Bools = np.asarray((longest > most) | needle)
        pieces.append(corners[~large])
        parents.append(parent[~large])
        corners, parent, first = corners[large], parent[large], sides[large].argmax(axis=1)
        turn = (first[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(corners, turn[..., None], axis=1), 1, 0)
        half = (a + b) / 2
        corners = np.concatenate([np.stack([a, half, c], axis=1), np.stack([half, b, c], axis=1)])
        parent = np.tile(parent, 2)
    return np.concatenate(pieces), np.concatenate(parents)


def _sides(corners: Floats) -> Floats:
    """Return the lengths of the sides of triangles (t, 3, 3), from each corner to the next."""
    return length(np.roll(corners, -1, axis=1) - corners)


def _reentrant(vertices: Points, triangles: Triangles, wall: float) -> Points:
    """Return places of the reentrant edges of triangles (t, 3) that face outward, (e, 3), mm."""
    edges, of_side = edges_of_sides(sides_of(triangles))
    uses = np.bincount(of_side, minlength=len(edges))
    order = np.argsort(of_side, kind="stable")
    first = (np.cumsum(uses) - uses)[uses == 2]
    sides = np.stack([order[first], order[first + 1]])  # (2, e): triangle times 3, and side
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    normal = normalize(np.cross(b - a, c - a) + np.finfo(float).tiny)
    one, other = sides // 3
    apex = vertices[triangles[other, (sides[1] + 2) % 3]]
    bent = dot(normal[one], normal[other]) < np.cos(REENTRANT)
    bent &= dot(apex - a[one], normal[one]) > 0
    start, end = np.moveaxis(vertices[edges[uses == 2][bent]], 1, 0)
    count = np.ceil(length(end - start) / (PITCH * wall)).astype(np.intp) + 1
    which = np.repeat(np.arange(len(count)), count)
    share = (steps(count) / np.maximum(count - 1, 1)[which])[:, None]
    return np.asarray(start[which] + share * (end - start)[which])
