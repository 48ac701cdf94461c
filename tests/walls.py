"""How thick the walls of hollow struts are, from their surfaces as triangles."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from build123d import Shell as Faces
from build123d import Vertex, import_step
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from scipy.spatial import cKDTree

from scaffold_cad import Skeleton
from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from tests.solids import contains

Random = np.random.Generator
Shell = trimesh.Trimesh

PLACES = 20_000
"""Random points."""

OFF = 0.005
"""How far triangles of exact faces are to be off at most, in walls; those of splines are more."""

THIN = 0.97
"""Walls between triangles of exact faces that are thinner than this are measured again."""

MEASURED = 100
"""Most places where they are, the thinnest ones that are `APART`: until others seem thicker."""

APART = 3.0
"""Least distance of such places, in walls."""


@dataclass(frozen=True)
class Side:
    """What is outside of hollow solids, or inside."""

    meshes: list[Shell]
    faces: list[Faces]
    """The same without triangles; none of files of meshes."""

    @property
    def whole(self) -> Shell:
        """All triangles."""
        return trimesh.util.concatenate(self.meshes)


def of_solids(path: Path, wall: float) -> tuple[str, Side, Side, float]:
    """Return what is wrong with a STEP file, its shells outside and inside, and the volume."""
    shape = import_step(path)
    outer, inner = Side([], []), Side([], [])
    for solid in shape.solids():
        made = []
        for shell in solid.shells():
            points, corners = shell.tessellate(OFF * wall, 0.1)
            made.append((trimesh.Trimesh([tuple(point) for point in points], corners), shell))
        made.sort(key=lambda each: -float(each[0].scale))  # the one around all others comes first
        for (mesh, shell), side in zip(made, (outer, *[inner] * len(made)), strict=False):
            side.meshes.append(mesh)
            side.faces.append(shell)
    return "" if shape.is_valid else "invalid", outer, inner, float(shape.volume)


def walls_between(outer: Side, inner: Side, wall: float, random: Random) -> Floats:
    """Return the walls at places of both sides, mm; the thinnest ones of faces without triangles.

    Triangles of splines are further off than asked for, which makes walls thin.
    """
    found, least = [], THIN * wall
    for one, other in ((inner, outer), (outer, inner)):
        points, _ = places_on(one.whole, 0.5 * wall, random)
        far = far_from(points, other.whole, wall, random)
        for _ in range(MEASURED if one.faces else 0):
            if far.min(initial=np.inf) > least:
                break
            place = points[far.argmin()]
            found.append(np.array([_exact_wall(place, one.faces, other.faces)]))
            least = min(least, float(found[-1].min()))
            apart = np.linalg.norm(points - place, axis=1) > APART * wall
            points, far = points[apart], far[apart]
        found.append(far)
    return np.concatenate(found)


def _exact_wall(place: Points, one: list[Faces], other: list[Faces]) -> float:
    """Return how far the place of some faces that is nearest to a place is from others, mm."""
    start, _ = _nearest(place, one)
    return _nearest(start, other)[1]


def _nearest(place: Points, faces: list[Faces]) -> tuple[Points, float]:
    """Return the place of some faces that is nearest to a place, and how far it is, mm."""
    found = []
    for each in faces:
        nearest = BRepExtrema_DistShapeShape(Vertex(*place).wrapped, each.wrapped)
        point = nearest.PointOnShape2(1)
        found.append((float(nearest.Value()), (point.X(), point.Y(), point.Z())))
    far, point = min(found)
    return np.array(point), far


def places_on(surface: trimesh.Trimesh, step: float, random: Random) -> tuple[Points, Floats]:
    """Return random points of a surface some `step` apart, and corners; and their triangles."""
    count = int(min(surface.area / step**2, 80_000)) + 100
    points, faces = trimesh.sample.sample_surface(surface, count, seed=random)
    every = np.arange(len(surface.faces))
    return (
        np.concatenate([points, *np.moveaxis(surface.triangles, 1, 0), surface.triangles_center]),
        np.concatenate([faces, *[every] * 4]),
    )


def far_from(points: Points, other: trimesh.Trimesh, wall: float, random: Random) -> Floats:
    """Return the distance of points from a surface, of near triangles, mm."""
    near, faces = places_on(other, 0.3 * wall, random)
    found = np.full(len(points), np.inf)
    _, rows = cKDTree(near).query(points, k=6)
    for row in rows.T:
        feet = trimesh.triangles.closest_point(other.triangles[faces[row]], points)
        found = np.minimum(found, np.linalg.norm(feet - points, axis=1))
    return found


def eroded_volume(outside: trimesh.Trimesh, wall: float, random: Random) -> tuple[float, float]:
    """Return the volume of what is inside of a surface and within a wall of it, and its error.

    Points are drawn beside the surface, and each counts as much as it is unlikely: one at depth d
    below a triangle stands for all of its triangles that have it at most a wall away.
    """
    low, high = outside.bounds
    cell = wall / 2
    count = np.ceil((high - low) / cell).astype(int) + 2
    near, _ = places_on(outside, 0.3 * wall, random)
    # Boxes of the grid that have a part of the wall: those near the surface.
    box = np.unique(np.floor((near - low) / cell).astype(np.int64) + 1, axis=0)
    reach = np.arange(-3, 4)
    around = np.stack(np.meshgrid(reach, reach, reach), axis=-1).reshape(-1, 3)
    keys = np.unique((box @ _strides(count))[:, None] + around @ _strides(count))
    chosen = keys[random.integers(len(keys), size=PLACES)]
    strides = _strides(count)
    place = np.stack([chosen // strides[0], chosen % strides[0] // strides[1],
                      chosen % strides[1]], axis=1) - 1  # fmt: skip
    points = low + cell * (place + random.random((PLACES, 3)))
    is_in = contains(TriangleMesh(outside.vertices, outside.faces), points)
    held: Bools = np.zeros(PLACES, dtype=np.bool_)
    held[is_in] = far_from(points[is_in], outside, wall, random) <= wall
    total, share = len(keys) * cell**3, float(held.mean())
    return total * share, total * float(np.sqrt(share * (1 - share) / PLACES))


def filled_volume(
    skeleton: Skeleton, outside: Shell, inside: Shell, wall: float, random: Random
) -> float:
    """Return the volume inside struts that is solid more than a wall from the outside, mm³.

    Points are drawn inside each strut as often as it is large; what several struts have in common
    counts as often as it is drawn.
    """
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    radii = skeleton.edge_radii - wall  # (m, 2)
    most = radii.max(axis=1)
    volumes = np.pi * most**2 * skeleton.lengths
    edge = random.choice(len(volumes), PLACES, p=volumes / volumes.sum())
    along = random.random((PLACES, 1))
    axis = skeleton.directions[::2][edge]
    off = np.cross(axis, random.normal(size=(PLACES, 3)))
    off *= (np.sqrt(random.random(PLACES)) * most[edge] / np.linalg.norm(off, axis=1))[:, None]
    points = start[edge] + along * (end - start)[edge] + off
    within = np.linalg.norm(off, axis=1) < radii[edge, 0] + along[:, 0] * np.diff(radii)[edge, 0]
    solid = within & ~_in_any(inside, points) & _in_any(outside, points)
    deep = far_from(points[solid], outside, wall, random) > wall
    # A place in several struts is drawn for each of them.
    shared = _struts_at(points[solid][deep], start, end, radii)
    return float(volumes.sum() / PLACES * (1.0 / shared).sum())


def _in_any(surface: Shell, points: Points) -> Bools:
    """Return whether points (k, 3) are inside of a surface, whichever way it faces, (k,)."""
    faces = surface.faces if surface.volume > 0 else surface.faces[:, ::-1]
    return contains(TriangleMesh(surface.vertices, faces), points)


def _struts_at(points: Points, start: Points, end: Points, radii: Floats) -> Floats:
    """Return the number of struts that each point is in, at least 1, (k,)."""
    found = np.zeros(len(points))
    for a, b, (first, last) in zip(start, end, radii, strict=True):
        way = points - a
        share = (way @ (b - a) / ((b - a) @ (b - a))).clip(0.0, 1.0)
        far = np.linalg.norm(way - share[:, None] * (b - a), axis=1)
        found += far < first + share * (last - first)
    return np.maximum(found, 1.0)


def _strides(count: np.ndarray) -> np.ndarray:
    wide = count.astype(np.int64) + 8
    return np.array([wide[1] * wide[2], wide[2], 1])
