"""Walls of hollow struts as thick as asked: the inside moves away from where the outside is near.

Both surfaces are triangles, whose sides are inside of round surfaces, so walls are thin in places.
There the vertices inside move away from the nearest place outside, but for those whose triangles
would then cross others. Fillets of fields are not parallel outside and inside: where that makes a
wall thicker than asked, the vertices of fields inside move toward the outside.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from itertools import chain, repeat

import numpy as np

from scaffold_cad.base.arrays import Bools, Frozen, Ints, Points, Triangles, place_text
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.vectors import length
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.aims import Aim, between, near_to, shares

ENOUGH = 0.976
"""What is thinner than this part of the wall between two polygons is thickened."""

TOLD = 0.95
"""What is thinner than this part of the wall is told, if polygons of so few sides leave as much."""

ROUNDS = 12
"""Times that vertices move; each time other places may be the nearest ones."""

THINNING = 2
"""Times that walls in fields become thinner where they are too thick, before that."""

EVENING = 6
"""Times that vertices whose triangles cross are evened."""

TRIES = 6
"""Times that vertices whose triangles cross are put back by a part of their way, before they are by
all of it."""

BACK = 0.4
"""What is left of their way each time."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Walls(Frozen):
    """Hollow struts as triangles without crossings."""

    mesh: TriangleMesh
    """All of them."""
    outer: Ints
    """Numbers of the triangles that stay, those outside."""
    inner: Ints
    """Numbers of those that move, those inside, which share no vertex with these."""
    first: int
    """Vertices that move are those of fields from this one on: walls there may become thinner."""
    alike: Ints
    """Vertex of the first node of the same shape, itself for others, shape (v,)."""
    fixed: Ints
    """Vertices that stay where they are."""

    @staticmethod
    def between(outside: TriangleMesh, inside: TriangleMesh, fixed: Ints) -> Walls:
        """Return the walls between two surfaces, of fields inside.

        Parameters
        ----------
        inside : whose triangles face the outside
        fixed : vertices of it that stay where they are
        """
        count, first = len(outside.triangles), len(outside.vertices)
        mesh = TriangleMesh(
            np.concatenate([outside.vertices, inside.vertices]),
            np.concatenate([outside.triangles, inside.triangles[:, ::-1] + first]),
        )
        outer, inner = np.split(np.arange(len(mesh.triangles)), [count])
        every = np.arange(len(mesh.vertices))
        return Walls(mesh, outer, inner, first, every, fixed + first)

    def turned(self, mesh: TriangleMesh, fixed: Ints) -> Walls:
        """Return the walls at triangles inside whose corners stay, where the outside is to move.

        One corner that stays is enough.

        Parameters
        ----------
        mesh : after the inside has moved
        fixed : vertices outside that stay where they are
        """
        stays = self.inner[~self.moves[self.mesh.triangles[self.inner]].all(axis=1)]
        count = len(mesh.vertices)
        return Walls(mesh, stays, self.outer, count, np.arange(count), fixed)

    @property
    def moves(self) -> Bools:
        """Vertices inside that may move, (v,)."""
        found = np.zeros(len(self.mesh.vertices), dtype=np.bool_)
        found[self.mesh.triangles[self.inner]] = True
        found[self.fixed] = False
        return found

    @property
    def looked_at(self) -> Triangles:
        """Triangles inside that are looked at: of nodes of one shape, those of the first one."""
        found = self.mesh.triangles[self.inner]
        looked = (self.alike[found] == found).all(axis=1) & self.moves[found].any(axis=1)
        return np.asarray(found[looked])


def thickened(struts: Walls, wall: float, between: float, factor: float) -> TriangleMesh:
    """Return hollow struts with walls that are hardly thinner than `wall`.

    Parameters
    ----------
    wall : that is asked for, mm
    between : the part of it that is between two polygons
    factor : what lengths are multiplied with in a file, in whose 32-bit numbers triangles are
        looked at
    """
    faces, moves = struts.looked_at, struts.moves
    if len(faces) == 0:
        return struts.mesh
    aim = _aim(struts, faces, wall, ENOUGH * between * wall)
    mesh = _placed(struts, _moved(struts.mesh.vertices, faces, moves, aim, 0), aim, factor)
    of_field = moves & (np.arange(len(moves)) >= struts.first)
    some = faces[of_field[faces].any(axis=1)]
    if len(some):
        vertices = _moved(mesh.vertices, some, of_field, aim, THINNING)
        mesh = _placed(replace(struts, mesh=mesh), vertices, aim, factor)
    return mesh


def _aim(struts: Walls, faces: Triangles, wall: float, least: float) -> Aim:
    """Return how thick walls are to be at triangles (t, 3), at corners that stay too."""
    vertices = struts.mesh.vertices
    points = np.concatenate([vertices[np.unique(faces)], vertices[faces].mean(axis=1)])
    return Aim.of(vertices, struts.mesh.triangles[struts.outer], points, wall, least)


def tell_thin(struts: Walls, wall: float, part: float, slack: float = 0.0) -> None:
    """Log where a wall is thin.

    Parameters
    ----------
    part : of the wall, that is between two polygons
    slack : how far triangles that stay may reach beyond the round surface that they are near, mm
    """
    faces, enough = struts.looked_at, min(TOLD, ENOUGH * part) * wall - slack
    aim = _aim(struts, faces, wall, enough)
    least, place = aim.thinnest(struts.mesh.vertices, faces, enough)
    if least < enough:
        _log.warning(
            "a wall is as thin as %.3g mm near %s, for the %g mm asked for: its triangles have no "
            "room for more; need a thinner wall, thicker struts or wider angles",
            least,
            place_text(place),
            wall,
        )


def _placed(struts: Walls, vertices: Points, aim: Aim, factor: float) -> TriangleMesh:
    """Return a mesh with its vertices at places (v, 3), but for those where it would cross.

    There they are evened first, which unfolds small triangles; what still crosses is put back.
    Crossings that the mesh has itself stay.
    """
    mesh = struts.mesh
    placed, crossing = mesh.vertices, mesh.triangles[:0]
    for back in chain(repeat(None, EVENING), repeat(BACK, TRIES), repeat(0.0)):
        before, placed = placed, _as_written(struts, vertices, factor)
        looked: Bools = np.asarray((placed != before).any(axis=1))
        looked[crossing] = True
        crossing = _crossing(mesh, placed, looked, aim.wall, factor)
        vertices = placed.copy()
        back_at_first = back == 0.0 and (placed[crossing] == mesh.vertices[crossing]).all()
        if len(crossing) == 0 or back_at_first:
            break
        beside = _beside(mesh, crossing)
        beside[struts.alike[beside]] = True
        if back is None:
            rows = np.flatnonzero(beside & struts.moves)
            vertices[rows] = _evened(mesh, vertices, rows)
            faces = struts.looked_at
            faces = faces[beside[faces].any(axis=1)]
            vertices = _moved(vertices, faces, struts.moves, aim, 0)
        else:
            vertices[beside] += (1.0 - back) * (mesh.vertices - vertices)[beside]
    return TriangleMesh(vertices, mesh.triangles)


def _as_written(struts: Walls, vertices: Points, factor: float) -> Points:
    """Return vertices (v, 3) as a file has those that moved; nodes of one shape as the first one.

    Those that do not move stay as they are.
    """
    mesh = struts.mesh
    way = np.where(struts.moves[:, None], (vertices - mesh.vertices)[struts.alike], 0.0)
    placed = in_single_precision(mesh.vertices + way, factor) / factor
    return np.where(way.any(axis=1, keepdims=True), placed, mesh.vertices)


def _crossing(
    mesh: TriangleMesh, placed: Points, looked: Bools, wall: float, factor: float
) -> Triangles:
    """Return the triangles that cross others with the vertices of a mesh at places (v, 3).

    Parameters
    ----------
    looked : (v,) vertices that moved since others were looked at, or whose triangles crossed then
    """
    near = near_to(mesh.vertices[mesh.triangles], mesh.vertices[looked], wall)
    triangles = mesh.triangles[near]
    written = in_single_precision(placed, factor)
    return triangles[np.unique(self_intersections(TriangleMesh(written, triangles)))]


def _evened(mesh: TriangleMesh, places: Points, rows: Ints) -> Points:
    """Return vertices (r,) half the way to the mean of those that they share triangles with."""
    beside = np.zeros(len(places), dtype=np.bool_)
    beside[rows] = True
    faces = mesh.triangles[beside[mesh.triangles].any(axis=1)]
    total, count = np.zeros_like(places), np.zeros(len(places))
    for turn in (1, 2):
        np.add.at(total, faces, places[np.roll(faces, turn, axis=1)])
        np.add.at(count, faces, 1.0)
    return np.asarray((places[rows] + total[rows] / count[rows, None]) / 2)


def _moved(vertices: Points, faces: Triangles, moves: Bools, aim: Aim, thinning: int) -> Points:
    """Return vertices (v, 3) with some of those inside moved to where walls are as asked.

    Parameters
    ----------
    faces : those that are looked at, (t, 3)
    moves : (v,) vertices that may move
    thinning : times that walls that are too thick become thinner, before others become thicker
    """
    vertices = vertices.copy()
    looked = np.unique(faces)
    looked = looked[moves[looked]]
    some = np.zeros_like(moves)
    for _ in range(thinning):
        way = aim.thinner(vertices[looked])
        vertices[looked] += way
        some[looked] |= way.any(axis=1)
    if thinning:
        faces = faces[some[faces].any(axis=1)]
    for _ in range(ROUNDS):
        looked = np.unique(faces)
        looked = looked[moves[looked]]
        away = np.zeros_like(vertices)
        away[looked] = aim.thicker(vertices[looked])
        for each in between(faces):
            way = aim.thicker(vertices[each].mean(axis=1))
            thin = np.flatnonzero(way.any(axis=1))
            free = moves[each[thin]]
            part = shares(np.full(free.shape, 1.0 / free.shape[1]), free)
            for corner, share in zip(each[thin].T, part.T, strict=True):
                _keep_larger(away, corner, share[:, None] * way[thin])
        corner, way = aim.thicker_below(vertices[faces], moves[faces])
        _keep_larger(away, faces.reshape(-1)[corner], way)
        away[~moves] = 0.0
        vertices += away
        # Where a vertex moved the next ones may be too near.
        moved: Bools = np.asarray(away.any(axis=1))
        faces = faces[moved[faces].any(axis=1)]
    return vertices


def _keep_larger(away: Points, corner: Ints, way: Points) -> None:
    """Put ways of corners (q, 3) in place of those (v, 3) that are shorter.

    Of several ways of a corner the longest one stays.
    """
    size = length(way)
    larger = np.flatnonzero(size > length(away[corner]))
    larger = larger[np.argsort(size[larger], kind="stable")]
    away[corner[larger]] = way[larger]


def _beside(mesh: TriangleMesh, triangles: Ints) -> Bools:
    """Return the vertices of some triangles and those next to them, (v,)."""
    marks = np.zeros(len(mesh.vertices), dtype=np.bool_)
    marks[triangles] = True
    beside = np.flatnonzero(marks[mesh.triangles].any(axis=1))
    marks[mesh.triangles[beside]] = True
    return marks
