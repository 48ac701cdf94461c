"""How thick struts are in a mesh: chords through their axes, as against what was asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.ranges import ranges
from scaffold_cad.base.vectors import any_perpendicular, dot, length
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton

DIRECTIONS = 16
"""Rays from a station; two opposite ones are a chord. A square is at most 2 % wider along them."""

FACETS = 0.95
"""Chords of this part of the diameter asked for, or more, are as asked: circles are polygons."""

MOST_STATIONS = 1000
"""Of a strut; one that is no longer than as many radii has one every radius."""

AROUND = 2.0
"""Farthest that a strut's surface is from its axis, in radii asked for."""

SURROUNDED = 0.4
"""Part of the rays that meet the surface so near where it goes around an axis. Hollow struts that
overlap have it on one side only; a strut beside another surface meets that along a quarter."""

PAIR_BYTES = 40 * DIRECTIONS
"""What a pair of a station and a triangle takes."""


@dataclass(frozen=True, eq=False)
class Thickness:
    """The thinnest place of each strut."""

    diameters: Floats
    """That asked for, or where a chord is shorter than its polygon makes it the chord, (m,), mm."""
    places: Points
    """Where the diameter is, on the axis, shape (m, 3), mm."""
    thinned: Ints
    """Struts that are thinner than was asked for, shape (k,)."""
    surrounded: Bools
    """Whether the mesh goes around each strut's axis at its middle, shape (m,)."""
    bare: Points
    """Places on axes, away from nodes, around which no triangle is, shape (b, 3), mm."""
    of_bare: Ints
    """The strut of each, shape (b,)."""


@dataclass(frozen=True, eq=False)
class _Stations:
    """Places on axes where chords are measured."""

    centers: Points  # (s, 3), mm
    frames: Floats  # (s, 3, 3): rows along the strut and across it
    radii: Floats  # (s,), as asked for, mm
    struts: Ints  # (s,), ascending
    spacing: Floats  # (s,), from one to the next of a strut, mm


def thickness_of(skeleton: Skeleton, mesh: TriangleMesh) -> Thickness:
    """Return how thick the struts of a skeleton are in a mesh.

    Chords through the axis are measured at stations of each strut, across it, from outside to
    outside: the bore of a hollow strut does not count. A triangle is taken for one of the strut
    whose axis is nearest; where that leaves a gap no chord is measured.
    """
    stations = _stations(skeleton)
    distances = _distances(stations, *_crossing_pairs(stations, mesh), mesh)
    chords = (distances[:, : DIRECTIONS // 2] + distances[:, DIRECTIONS // 2 :]).min(axis=1)
    asked = 2 * stations.radii
    measured = np.where(chords < FACETS * asked, chords, np.inf)  # (s,)
    first = np.searchsorted(stations.struts, np.arange(len(skeleton.edges)))
    least = np.minimum.reduceat(measured, first)  # (m,)
    thinnest = 2 * skeleton.edge_radii.min(axis=1)
    order = np.lexsort((measured, stations.struts))[first]
    middle = first + np.bincount(stations.struts) // 2
    bare = np.flatnonzero(np.isinf(distances).all(axis=1) & _away(skeleton, stations))
    return Thickness(
        np.minimum(least, thinnest),
        stations.centers[order],
        np.flatnonzero(np.isfinite(least)),
        (distances[middle] <= AROUND * stations.radii[middle, None]).mean(axis=1) >= SURROUNDED,
        stations.centers[bare],
        stations.struts[bare],
    )


def thickness_asked(skeleton: Skeleton) -> Thickness:
    """Return how thick the struts of a skeleton are by their radii, for want of a mesh."""
    end = skeleton.edges[np.arange(len(skeleton.edges)), skeleton.edge_radii.argmin(axis=1)]
    none, all_of_them = np.zeros(0, dtype=np.intp), np.ones(len(end), dtype=np.bool_)
    diameters = 2 * skeleton.edge_radii.min(axis=1)
    return Thickness(diameters, skeleton.nodes[end], none, all_of_them, np.zeros((0, 3)), none)


def _stations(skeleton: Skeleton) -> _Stations:
    radii = skeleton.edge_radii  # (m, 2)
    count = np.ceil(skeleton.lengths / radii.mean(axis=1)).clip(1, MOST_STATIONS).astype(np.intp)
    strut = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(strut)) - (np.cumsum(count) - count)[strut]
    along = (number + 0.5) / count[strut]
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    lengths = np.maximum(skeleton.lengths, np.finfo(np.float64).tiny)  # a strut may have none
    axis = (end - start) / lengths[:, None]
    across = any_perpendicular(axis)
    frames = np.stack([axis, across, np.cross(axis, across)], axis=1)
    return _Stations(
        start[strut] + along[:, None] * (end - start)[strut],
        frames[strut],
        radii[strut, 0] * (1 - along) + radii[strut, 1] * along,
        strut,
        (lengths / count)[strut],
    )


def _away(skeleton: Skeleton, stations: _Stations) -> Bools:
    """Return which stations are not in the nodes of their strut, (s,)."""
    ends = skeleton.edges[stations.struts]  # (s, 2)
    away = length(skeleton.nodes[ends] - stations.centers[:, None])
    return np.asarray((away > AROUND * skeleton.radii[ends]).all(axis=1))


def _crossing_pairs(stations: _Stations, mesh: TriangleMesh) -> tuple[Ints, Ints]:
    """Return pairs of a station and a triangle of its strut that crosses its plane, (p,) each."""
    corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
    _, nearest = KDTree(stations.centers).query(corners.mean(axis=1))
    axes = stations.frames[:, 0]
    along = np.einsum("tci,ti->tc", corners - stations.centers[nearest, None], axes[nearest])
    strut = stations.struts[nearest]
    first = np.searchsorted(stations.struts, strut)
    behind = dot(stations.centers[nearest] - stations.centers[first], axes[nearest])
    step = stations.spacing[nearest]
    low, high = ((behind + end(along, axis=1)) / step for end in (np.min, np.max))
    last = np.searchsorted(stations.struts, strut, side="right") - 1 - first
    low, high = np.maximum(np.ceil(low), 0), np.minimum(np.floor(high), last)
    count = np.maximum(high - low + 1, 0).astype(np.intp)
    return ranges(first + low.astype(np.intp), count), np.repeat(np.arange(len(count)), count)


def _distances(stations: _Stations, station: Ints, triangle: Ints, mesh: TriangleMesh) -> Floats:
    """Return how far from each station its rays leave the strut, infinite if nowhere, (s, d)."""
    order = np.argsort(station, kind="stable")
    station, triangle = station[order], triangle[order]
    distances = np.full((len(stations.struts), DIRECTIONS), np.inf)
    for part in blocks(len(station), PAIR_BYTES):
        there, found = _rays(stations, station[part], mesh, triangle[part])
        if len(there):
            starts = np.flatnonzero(np.diff(there, prepend=-1))
            nearest = np.minimum.reduceat(found, starts, axis=0)
            distances[there[starts]] = np.minimum(distances[there[starts]], nearest)
    return distances


def _rays(
    stations: _Stations, station: Ints, mesh: TriangleMesh, triangle: Ints
) -> tuple[Ints, Floats]:
    """Return how far rays from stations (p,) go to outer sides of triangles (p,), (p', directions).

    It is infinite where a ray passes the triangle by.
    """
    corners = mesh.vertices[mesh.triangles[triangle]] - stations.centers[station, None]
    corners = np.einsum("pij,pkj->pki", stations.frames[station], corners)  # (p, corner, axis)
    above = corners[:, :, 0] > 0
    crossed = above.any(axis=1) & ~above.all(axis=1)
    corners, above, station = corners[crossed], above[crossed], station[crossed]
    # The corner that is alone on its side of the plane; both sides from it cross the plane.
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    rows = np.arange(len(alone))
    tip = corners[rows, alone]
    ends = []
    for step in (1, 2):
        other = corners[rows, (alone + step) % 3]
        share = tip[:, 0] / (tip[:, 0] - other[:, 0])
        ends.append((tip + share[:, None] * (other - tip))[:, 1:])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 1:]
    outer = dot(normal, ends[0]) > 0
    return station[outer], _hits(ends[0][outer], ends[1][outer])


def _hits(start: Floats, end: Floats) -> Floats:
    """Return where rays from the origin meet segments in a plane, (p, 2), infinite if nowhere."""
    angles = 2 * np.pi / DIRECTIONS * np.arange(DIRECTIONS)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)  # (d, 2)
    beside = rays[:, 0] * start[:, 1, None] - rays[:, 1] * start[:, 0, None]  # (p, d)
    beyond = rays[:, 0] * end[:, 1, None] - rays[:, 1] * end[:, 0, None]
    met = (beside > 0) != (beyond > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip(beside / (beside - beyond), 0.0, 1.0)
    distance = start @ rays.T + share * ((end - start) @ rays.T)
    return np.where(met & (distance > 0), distance, np.inf)
