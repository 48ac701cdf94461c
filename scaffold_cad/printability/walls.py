"""Thin walls: where a solid has two sides close behind each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Points, Triangles, place_text
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import MOST_PLACES, Finding
from scaffold_cad.printability.thickness import FACETS
from scaffold_cad.printability.triangletopology import TriangleTopology

OPPOSITE = -0.95
"""Cosine of the angle between the normals of both sides of a wall at most."""

SAMPLES = np.vstack([np.full((1, 3), 1 / 3), 1 / 6 + np.eye(3) / 2])
"""Where triangles are measured: at the middle, and halfway from there to each corner, (4, 3)."""


SPECK = 0.01
"""Least area of both sides of a wall, over the square of the limit: smaller folds, as unions of
surfaces have where 32-bit coordinates round them, are too small to be seen."""


@dataclass(frozen=True, eq=False)
class Walls:
    """Places where a solid is thinner than some limit, the thinnest first."""

    thickness: Floats
    """Shape (w,), mm."""
    places: Points
    """On the surface, shape (w, 3), mm."""


def wall_finding(surface: TriangleTopology, process: Process) -> Finding:
    """Return the finding on what is thinner between two sides than the process prints."""
    if not surface.closed:
        text = "none: the surface is not closed"
        return Finding("wall_thickness", "part", "note", None, text)
    needed = process.least_diameter
    walls = thin_walls(surface, FACETS * needed)
    count = len(walls.thickness)
    text, advice = f"{needed:g} mm or more, facets aside", ""
    if count:
        text = f"{walls.thickness[0]:.3g} mm near {place_text(walls.places[0])}"
        advice = f"{process.name.upper()} needs {needed:g} mm: thicken it there, or open it"
    return Finding(
        "wall_thickness",
        "part",
        "failure" if count else "ok",
        {
            "least_mm": float(walls.thickness[0]) if count else None,
            "needed_mm": needed,
            "triangles": count,
        },
        text,
        advice,
        walls.places[:MOST_PLACES],
    )


def thin_walls(surface: TriangleTopology, limit: float) -> Walls:
    """Return where the solid within a closed surface is thinner than `limit`, mm.

    It is measured straight inwards from some places of each triangle to the triangles behind that
    face the other way and share no corner with it: the solid beside an edge is no wall. There is
    one row, of the thinnest place, for each triangle with such a one, specks left out.
    """
    sides = surface.corners[:, 1:] - surface.corners[:, :1]
    normals = np.cross(sides[:, 0], sides[:, 1])  # (t, 3)
    doubled = length(normals)
    proper = doubled > 0
    corners, normals = surface.corners[proper], normals[proper] / doubled[proper, None]
    names = surface.mesh.triangles[proper]
    # Both sides of a thin wall meet where each is moved inwards by half the limit.
    moved = corners - normals[:, None] * (limit / 2)
    low = np.minimum(corners.min(axis=1), moved.min(axis=1))
    high = np.maximum(corners.max(axis=1), moved.max(axis=1))
    places = np.einsum("sc,tcx->stx", SAMPLES, corners)  # (4, t, 3)
    least = np.full(places.shape[:2], np.inf)  # (4, t)
    for pairs in overlapping_boxes(low, high):
        facing = dot(normals[pairs[0]], normals[pairs[1]]) < OPPOSITE
        one, other = (each[facing] for each in pairs)
        apart = (names[one, :, None] != names[other, None]).all(axis=(1, 2))
        one, other = one[apart], other[apart]
        for i, j in ((one, other), (other, one)):
            for sample, start in zip(least, places, strict=True):
                np.minimum.at(sample, i, _depths(start[i], normals[i], corners[j], normals[j]))
    rows = np.arange(len(corners))
    sample = least.argmin(axis=0)
    thickness = least[sample, rows]
    thin = np.flatnonzero(thickness < limit)
    thin = thin[_regions(names[thin], doubled[proper][thin] / 2) >= SPECK * limit**2]
    thin = thin[np.argsort(thickness[thin], kind="stable")]
    return Walls(thickness[thin], places[sample[thin], thin])


def _regions(triangles: Triangles, areas: Floats) -> Floats:
    """Return the area of all triangles that each of some (k, 3) hangs together with, (k,)."""
    vertices, corner = np.unique(triangles, return_inverse=True)
    corner = corner.reshape(-1, 3)
    pairs = np.concatenate([corner[:, :2], corner[:, 1:]])
    label = component_labels(pairs, len(vertices))[corner[:, 0]]  # (k,)
    return np.asarray(np.bincount(label, areas), dtype=np.float64)[label]


def _depths(start: Points, outwards: Floats, corners: Floats, normals: Floats) -> Floats:
    """Return how far inwards from places (p, 3) triangles (p, 3, 3) are, infinite if beside, (p,).

    Triangles with normals (p, 3) face away from `outwards`.
    """
    depth = dot(start - corners[:, 0], normals) / dot(outwards, normals)
    there = start - depth[:, None] * outwards
    within = depth > 0
    for corner in range(3):
        side = corners[:, (corner + 1) % 3] - corners[:, corner]
        within &= dot(np.cross(side, there - corners[:, corner]), normals) >= 0
    return np.where(within, depth, np.inf)
