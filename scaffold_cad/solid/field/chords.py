"""Equal volume where struts meet and at round ends: vertices move by what triangles there are off.

Struts are a little thicker, so that triangles with their corners on them have the volume of the
struts. That holds for a strut by itself. Where struts meet, triangles lie outside of the crease or
fillet between them, and most of a short thick strut is inside of others: there the volume between
triangles and surface is measured, at one place in each, and vertices move along their grid edges
for what is missing or too much. They stay on their edges, so the surface stays closed and free of
crossings. Flat ends are left as they are: vertices are in their planes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.threads import in_order
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.solid.field.surface import Surface
from scaffold_cad.solid.field.union import POINT_BYTES, FilletedUnion, Lists, combined

MIDDLE = 0.75
"""Weight of a triangle's middle in the mean of what is 0 at its corners, exact for polynomials of
degree 2, and on average for a crease somewhere in it."""

STEEP = 0.2
"""Least cosine between normals and the way to the surface, or a grid edge, to reckon with."""

ASIDE = 0.01
"""How far struts on a line are beside it at most, and how far their radii are off, as a part of the
radius."""

NOTHING = 1e-300
"""What is divided by where there is nothing."""

ROUNDS = 2
"""Times that triangles share what they measure with those beside them."""


@dataclass(frozen=True, eq=False)
class Crowd(Frozen):
    """The triangles of a surface near which several struts are."""

    vertices: Ints
    """Which they have, ascending, shape (k,)."""
    triangles: Ints
    """Numbers in `vertices`, shape (t, 3)."""
    valency: Floats
    """Number of triangles of each vertex, shape (k,)."""
    groups: Ints
    """Group at each vertex or -1, but at one of each triangle, shape (k,)."""

    def sums(self, values: Floats) -> Floats:
        """Return the sum over the triangles of each vertex of values (t,), shape (k,)."""
        first, second, third = (
            np.bincount(column, values, len(self.vertices)) for column in self.triangles.T
        )
        return np.asarray(first + second + third)

    def shared(self, values: Floats) -> Floats:
        """Return the sums of values (t,), shared with the triangles around, shape (k,)."""
        found = self.sums(values)
        for _ in range(ROUNDS):
            part = found / self.valency
            first, second, third = (part[column] for column in self.triangles.T)
            found = self.sums((first + second + third) / 3.0)
        return found


@dataclass(frozen=True, eq=False)
class Measures(Frozen):
    """What is measured of triangles."""

    areas: Floats
    """Area times normal, shape (t, 3), mm²."""
    heights: Floats
    """How high they are over the surface of struts as asked for, on average, shape (t,), mm."""
    flat: Bools
    """Whether they are at a flat end, shape (t,)."""


def evened(union: FilletedUnion, surface: Surface, thicker: Floats) -> Points:
    """Return the vertices, moved where several struts are near for the volume of their union.

    Parameters
    ----------
    thicker : (m,) by which part of their radius struts are thicker in `union`
    """
    vertices = surface.vertices.copy()
    crowd = _crowd_of(union, surface)
    if len(crowd.vertices) == 0:
        return vertices
    measures = _measured(union, surface, crowd, thicker)
    area = length(measures.areas)
    counted = np.where(measures.flat, 0.0, area)
    outward = -crowd.shared(counted * measures.heights)
    outward /= np.maximum(crowd.shared(counted), NOTHING)  # (k,)
    outward[crowd.triangles[measures.flat]] = 0.0
    edges = surface.edges_of(crowd.vertices)
    square = dot(edges.way, edges.way)
    before = dot(vertices[crowd.vertices] - edges.start, edges.way) / square
    # What a vertex adds to the volume as it moves is a third of its triangles along the way.
    normals = np.stack([crowd.sums(column) for column in measures.areas.T], axis=1)
    rise = dot(normals, edges.way)
    least = np.maximum(STEEP * length(normals) * np.sqrt(square), NOTHING)
    rise = np.copysign(np.maximum(np.abs(rise), least), rise)
    moved = edges.at(before + outward * crowd.sums(area) / rise)
    free = outward != 0
    vertices[crowd.vertices[free]] = moved[free]
    return vertices


def _crowd_of(union: FilletedUnion, surface: Surface) -> Crowd:
    """Return the triangles near which several struts are, and those of round ends."""
    group = surface.grid.groups_at(surface.vertices)  # the same in each run, unlike owners
    crowded = np.append(_crowded(union, surface.grid.lists), False)[group]  # (v,)
    others = np.flatnonzero(~crowded & (group >= 0))
    crowded[others] = _past_ends(
        union, surface.vertices[others], surface.grid.lists.of(group[others])
    )
    first, second, third = (crowded[column] for column in surface.triangles.T)
    triangles = surface.triangles[first | second | third]
    marks = np.zeros(len(crowded), dtype=np.bool_)
    marks[triangles] = True
    triangles = (np.cumsum(marks) - 1)[triangles]
    vertices = np.flatnonzero(marks)
    valency = np.bincount(triangles.reshape(-1), minlength=len(vertices))
    return Crowd(vertices, triangles, valency.astype(np.float64), group[vertices])


def _crowded(union: FilletedUnion, lists: Lists) -> Bools:
    """Return which lists have several struts that are not parts of one: on a line, as thick."""
    counts = np.diff(lists.starts)
    first = np.repeat(lists.struts[lists.starts[:-1]], counts)
    starts, axes = union.rows[:3].T, union.rows[3:6].T
    radii, slopes, lengths, _ = union.section
    off = np.zeros(len(first))
    for place in (np.zeros(len(lengths)), lengths):
        way = (starts + place[:, None] * axes)[lists.struts] - starts[first]
        along = dot(way, axes[first])
        beside = length(way - along[:, None] * axes[first])
        thicker = (radii + slopes * place)[lists.struts] - radii[first] - slopes[first] * along
        off = np.maximum(off, beside + np.abs(thicker))
    return np.asarray(np.maximum.reduceat(off / radii[first], lists.starts[:-1]) > ASIDE)


def _past_ends(union: FilletedUnion, x: Points, entries: tuple[Ints, Ints, Ints]) -> Bools:
    """Return which points (k, 3) are past the axis of each strut near them, (k,).

    Parameters
    ----------
    entries : struts near each, as `combined` takes them
    """
    which, struts, starts = entries
    if len(which) == 0:
        return np.zeros(len(x), dtype=np.bool_)
    along = dot(x[which] - union.rows[:3, struts].T, union.rows[3:6, struts].T)
    past = (along < 0) | (along > union.section[2][struts])
    return np.asarray(np.logical_and.reduceat(past, starts))


def _measured(union: FilletedUnion, surface: Surface, crowd: Crowd, thicker: Floats) -> Measures:
    """Return what is measured of the triangles."""

    def some(block: slice) -> Measures:
        own = crowd.triangles[block]  # (b, 3)
        a, b, c = (surface.vertices[crowd.vertices[column]] for column in own.T)
        areas, x = np.cross(b - a, c - a) / 2.0, (a + b + c) / 3.0
        group = surface.grid.groups_at(x)
        group = np.where(group >= 0, group, crowd.groups[own].max(axis=1))
        normals = areas / np.maximum(length(areas), NOTHING)[:, None]
        height, strut = _heights(union, thicker, x, normals, surface.grid.lists.of(group))
        reach = np.sqrt(
            np.maximum(dot(b - a, b - a), np.maximum(dot(c - b, c - b), dot(a - c, a - c)))
        )
        flat = union.beyond(x, strut) > -reach
        return Measures(areas, height, flat)

    parts = list(in_order(some, blocks(len(crowd.triangles), 4 * POINT_BYTES, CACHE)))
    return Measures(
        np.concatenate([part.areas for part in parts]),
        np.concatenate([part.heights for part in parts]),
        np.concatenate([part.flat for part in parts]),
    )


def _heights(
    union: FilletedUnion,
    thicker: Floats,
    x: Points,
    normals: UnitVectors,
    entries: tuple[Ints, Ints, Ints],
) -> tuple[Floats, Ints]:
    """Return how high triangles are on average (k,), mm, and the strut nearest to each, (k,).

    Parameters
    ----------
    x, normals : (k, 3) middles of triangles, mm, and their normals
    entries : struts near each, as `combined` takes them
    """
    which, struts, starts = entries
    distance, place = union.distances(x[which], struts)
    ratio = distance / union.blend[struts]
    level = combined(union, x[which], entries, ratio)
    least = np.minimum.reduceat(ratio, starts)
    nearest = np.zeros(len(x), dtype=np.intp)
    at = np.flatnonzero(ratio == least[which])[::-1]
    nearest[which[at]] = at  # the first one comes last
    strut = struts[nearest]
    lean = dot(union.gradients(x, strut), normals)
    swell = thicker[strut] * union.local_radii(place[nearest], strut, 0.0)
    return MIDDLE * level * union.blend[strut] / np.maximum(lean, STEEP) + swell, strut
