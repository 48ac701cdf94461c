"""How thick the walls of hollow struts are, from their surfaces as triangles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from build123d import import_step
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
"""How far triangles of exact faces are off at most, in walls: on both sides it makes walls thin."""


def of_solids(path: Path, wall: float) -> tuple[str, list[Shell], list[Shell], float]:
    """Return what is wrong with a STEP file, its shells outside and inside, and the volume."""
    shape = import_step(path)
    outer, inner = [], []
    for solid in shape.solids():
        meshes = []
        for shell in solid.shells():
            points, corners = shell.tessellate(OFF * wall, 0.1)
            meshes.append(trimesh.Trimesh([tuple(point) for point in points], corners))
        meshes.sort(key=lambda mesh: -float(mesh.scale))  # the one around all others comes first
        outer.append(meshes[0])
        inner += meshes[1:]
    return "" if shape.is_valid else "invalid", outer, inner, float(shape.volume)


def places_on(surface: trimesh.Trimesh, step: float, random: Random) -> tuple[Points, Floats]:
    """Return random points of a surface some `step` apart, and corners; and their triangles."""
    count = int(min(surface.area / step**2, 80_000)) + 100
    points, faces = trimesh.sample.sample_surface(surface, count, seed=random)
    every = np.arange(len(surface.faces))
    return (
        np.concatenate([points, *np.moveaxis(surface.triangles, 1, 0), surface.triangles_center]),
        np.concatenate([faces, *[every] * 4]),
    )


def gaps(one: trimesh.Trimesh, other: trimesh.Trimesh, wall: float, random: Random) -> Floats:
    """Return the distance of places of a surface from another one, of near triangles, mm."""
    points, _ = places_on(one, 0.5 * wall, random)
    return far_from(points, other, wall, random)


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
