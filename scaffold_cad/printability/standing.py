"""How a part stands on the plate: the directions to build it in, and what each asks for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import ConvexHull

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, length, sums_by_row
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.triangletopology import TriangleTopology

CANDIDATES = 150
"""Directions spread over the sphere that are tried, beside the axes and the largest faces."""
LARGEST_FACES = 20
"""Directions that put one of the largest flat parts on the plate are tried too."""
NEARBY = 16
"""Directions that are tried around each of the best."""
BEST = 3
"""How many of the best directions others are tried around."""
SPREADS = (0.3, 0.1)
"""How far around, first and then, rad: about the steps between those tried before."""
SAME_AREA = 0.002
"""Support areas that are this part of the surface from the least are taken as equal."""
SAME_NORMAL = 1e-4
"""Step to which normals are rounded to tell which faces face the same way."""
STEEP_ENOUGH = 3e-4
"""What is this much below the limit of what hangs over is steep enough, rad: 32-bit coordinates
turn small triangles by as much, and files of few digits struts."""
GOLDEN = math.pi * (1.0 + math.sqrt(5.0))
"""Turn from one direction of a spiral to the next, rad: none comes beside another."""
UP: UnitVectors = np.array([0.0, 0.0, 1.0])
"""The direction that wins over its equals where none is given."""


@dataclass(frozen=True, eq=False)
class Facets:
    """The triangles of a surface, as the plate sees them."""

    vertices: Points
    """Positions, shape (v, 3), mm."""
    triangles: Ints
    """Vertex indices, shape (t, 3)."""
    area_vectors: Floats
    """Outward normals as long as the areas, shape (t, 3), mm²."""

    @classmethod
    def of(cls, surface: TriangleTopology) -> Facets:
        """Return the facets of a surface."""
        corners = surface.corners
        vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        return cls(surface.mesh.vertices, surface.mesh.triangles, vectors)

    @cached_property
    def _grouped(self) -> tuple[Floats, Ints]:
        areas = length(self.area_vectors)
        proper = areas > 0
        normals = self.area_vectors[proper] / areas[proper, None]
        steps = np.round(normals / SAME_NORMAL).astype(np.int64)
        keys = (steps[:, 0] << 42) + (steps[:, 1] << 21) + steps[:, 2]
        found, kind = np.unique(keys, return_inverse=True)
        kind_of_triangle = np.full(len(areas), -1)
        kind_of_triangle[proper] = kind
        return sums_by_row(self.area_vectors[proper], kind, len(found)), kind_of_triangle

    @property
    def kinds(self) -> Floats:
        """Sums of the area vectors that face the same way, shape (k, 3), mm²: few in a lattice."""
        return self._grouped[0]

    @property
    def kind_of_triangle(self) -> Ints:
        """Row of `kinds` of each triangle, -1 of one without area, shape (t,)."""
        return self._grouped[1]

    @cached_property
    def diagonal(self) -> float:
        """Of the box around the surface, mm: it measures no more in any direction."""
        return float(length(np.ptp(self.vertices, axis=0)))

    @cached_property
    def outermost(self) -> Points:
        """The corners of the convex hull, shape (h, 3), mm: what a part measures."""
        if len(self.vertices) < 5:  # fewer than Qhull takes
            return self.vertices
        hull = ConvexHull(
            self.vertices - self.vertices.mean(axis=0), qhull_options="QJ"
        )  # flat too
        outermost: Points = self.vertices[hull.vertices]
        return outermost

    @cached_property
    def _first_corners(self) -> Ints:
        return np.ascontiguousarray(self.triangles[:, 0])

    @property
    def area(self) -> float:
        """Area of the surface, mm²."""
        return float(length(self.area_vectors).sum())

    def within(self, low: Bools) -> Ints:
        """Return the triangles all of whose vertices are `low`, shape (v,)."""
        rows = np.flatnonzero(low[self._first_corners])
        return rows[low[self.triangles[rows]].all(axis=1)]


@dataclass(frozen=True)
class Standing:
    """Facets built in one direction."""

    floor: float
    """Height of the plate along the direction, mm."""
    height: float
    """Of the part, mm."""
    support_area: float
    """Area of the triangles that need support, seen from below, mm²."""
    contact_area: float
    """Area of the triangles on the plate, mm²."""


def standing(facets: Facets, direction: UnitVectors, process: Process) -> Standing:
    """Return what facets ask for when they are built in a direction."""
    heights = facets.vertices @ direction
    floor = float(heights.min())
    rows = facets.within(heights <= floor + process.layer)
    on_plate = facets.area_vectors[rows]
    shown = on_plate @ direction
    hanging = _hanging_kinds(facets, direction, process)
    hanging_on_plate = hanging[facets.kind_of_triangle[rows]]
    support = facets.kinds[hanging[:-1]].sum(axis=0) - on_plate[hanging_on_plate].sum(axis=0)
    return Standing(
        floor,
        float(heights.max()) - floor,
        max(0.0, -float(support @ direction)),
        abs(float(shown[shown < 0].sum())),
    )


def hanging_facets(facets: Facets, direction: UnitVectors, process: Process) -> Ints:
    """Return the triangles that need support when they are built in a direction."""
    heights = facets.vertices @ direction
    hanging = _hanging_kinds(facets, direction, process)[facets.kind_of_triangle]
    hanging[facets.within(heights <= heights.min() + process.layer)] = False
    return np.flatnonzero(hanging)


def least_angle(process: Process) -> float:
    """Return the angle to the plate below which something hangs over, rad; <= 0 if nothing does."""
    return process.overhang_angle - STEEP_ENOUGH


def _hanging_kinds(facets: Facets, direction: UnitVectors, process: Process) -> Bools:
    """Return which kinds of faces are too flat to need no support, shape (k + 1,).

    The last, False, is of triangles without area.
    """
    hanging = np.zeros(len(facets.kinds) + 1, dtype=np.bool_)
    if least_angle(process) > 0:
        # A face at an angle a to the plate shows it the share cos a of its area.
        limit = math.cos(least_angle(process)) * length(facets.kinds)
        hanging[:-1] = -(facets.kinds @ direction) > limit
    return hanging


def best_direction(facets: Facets, process: Process, given: UnitVectors = UP) -> UnitVectors:
    """Return the direction that needs least support, of one given and many that are tried.

    Those in which the part fits into the printer come first, if there are any, and those that need
    no more support than the one given. Among directions of nearly the least support the one of the
    lowest part, and among those the one with the largest hold on the plate. The one given wins over
    its equals.
    """
    tried = np.concatenate([[given], _axes(), _onto_faces(facets), _spiral(CANDIDATES)])
    stands = [standing(facets, direction, process) for direction in tried]
    for spread in SPREADS:
        best = np.argsort([stand.support_area for stand in stands], kind="stable")[:BEST]
        nearby = np.concatenate([_around(direction, spread) for direction in tried[best]])
        tried = np.concatenate([tried, nearby])
        stands += [standing(facets, direction, process) for direction in nearby]
    least = min(stand.support_area for stand in stands) + SAME_AREA * facets.area
    keys = [
        (
            stand.support_area > stands[0].support_area,
            max(stand.support_area, least),
            round(stand.height, 3),
            -round(stand.contact_area, 3),
        )
        for stand in stands
    ]
    order = sorted(range(len(keys)), key=keys.__getitem__)
    room = process.build_volume
    fitting = (row for row in order if _fits(facets, tried[row], room))
    found: UnitVectors = tried[next(fitting, order[0])]
    return found


def _fits(facets: Facets, direction: UnitVectors, room: tuple[float, float, float]) -> bool:
    return facets.diagonal <= min(room) or fits_into(
        standing_size(facets.outermost, direction, room), room
    )


def fits_into(size: tuple[float, float, float], room: tuple[float, float, float]) -> bool:
    """Return whether a part of a width, depth and height fits, turned by a right angle too."""
    wide, free = sorted(size[:2]), sorted(room[:2])
    return wide[0] <= free[0] and wide[1] <= free[1] and size[2] <= room[2]


def _axes() -> UnitVectors:
    return np.concatenate([np.eye(3), -np.eye(3)])


def _onto_faces(facets: Facets) -> UnitVectors:
    """Return the directions that put the largest flat parts on the plate, shape (k, 3)."""
    areas = length(facets.kinds)
    largest = np.argsort(-areas, kind="stable")[:LARGEST_FACES]
    return -facets.kinds[largest] / areas[largest, None]


def _around(direction: UnitVectors, spread: float) -> UnitVectors:
    """Return directions evenly within an angle of one, rad, shape (n, 3)."""
    number = np.arange(NEARBY) + 0.5
    tilt, turn = spread * np.sqrt(number / NEARBY), GOLDEN * number
    side = any_perpendicular(direction)
    sideways = np.stack([np.cos(turn), np.sin(turn)], axis=1) @ [side, np.cross(direction, side)]
    near: UnitVectors = np.cos(tilt)[:, None] * direction + np.sin(tilt)[:, None] * sideways
    return near


def _spiral(count: int) -> UnitVectors:
    """Return directions spread evenly over the sphere along a golden spiral, shape (count, 3)."""
    number = np.arange(count) + 0.5
    z = 1.0 - 2.0 * number / count
    turn = GOLDEN * number
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


def standing_size(
    vertices: Points, direction: UnitVectors, room: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return width, depth and height of a part as it stands on the plate.

    It is turned about `direction`, in steps of 5°, no farther than it must be to fit into the
    width and depth of `room`; if it never fits, as it comes nearest to that.
    """
    side = any_perpendicular(direction)
    flat = np.stack([vertices @ side, vertices @ np.cross(direction, side)])  # (2, v)
    least, most = sorted(room[:2])
    sizes = []
    for turn in np.radians(np.arange(0, 180, 5)):
        axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        width, depth = np.ptp(axes @ flat, axis=1).tolist()
        short, long = sorted((width, depth))
        sizes.append((max(short / least, long / most, 1.0), width, depth))
    # The first of equals is turned least.
    _, width, depth = min(sizes, key=lambda size: size[0])
    return width, depth, float(np.ptp(vertices @ direction))
