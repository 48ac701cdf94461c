"""Flat ends of struts in fields: a polygon in place of the rim that a field's cells cut off.

The end of a strut that nothing else is near is cut off like a strut that leaves a cluster, and
joined to the polygon that stands for its circle, with a disc in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Points, UnitVectors
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.vectors import any_perpendicular, dot, length
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.solid.clusters.remainder import Cuts
from scaffold_cad.solid.clusters.seams import BESIDE, seamed
from scaffold_cad.solid.field import FieldStruts
from scaffold_cad.struts.meshes.bands import enlargement

DEPTH = 0.75
"""How far below a flat end its strut is cut off at most, in its larger radius there."""

CLEAR = 1.3
"""How far about the axis nothing else may be, in that radius."""

AHEAD = 0.3
"""How far before the end nothing else may be, in its radius."""

ON_STRUT = 0.05
"""How far a vertex may be off the strut that it is part of, in its radius at the end."""


@dataclass(frozen=True, eq=False)
class _Ends(Frozen):
    """Flat ends, and where their struts are cut off."""

    tip: Points
    """Middles of the ends, shape (e, 3), mm."""
    outward: UnitVectors
    """Shape (e, 3)."""
    radius: Floats
    """At the end, shape (e,), mm."""
    slope: Floats
    """Growth of the radius outward, mm per mm, shape (e,)."""
    depth: Floats
    """Where the stretch begins in which the strut is cut off, below the end, shape (e,), mm."""

    @property
    def wide(self) -> Floats:
        """Largest radius of that stretch and before the end, shape (e,), mm."""
        down, up = -self.slope * self.depth, self.slope * AHEAD * self.radius
        return np.asarray(self.radius + np.maximum(down, up).clip(0.0))

    def chosen(self, keep: Bools) -> _Ends:
        """Return some of them."""
        parts = self.tip, self.outward, self.radius, self.slope, self.depth
        return _Ends(*(part[keep] for part in parts))

    def cuts(self) -> Cuts:
        """Return where the strut of each is cut off."""
        every = np.arange(len(self.tip))
        base = self.tip - self.depth[:, None] * self.outward
        radius = self.radius - self.slope * self.depth
        return Cuts(every, base, self.outward, radius, self.slope, every)


def with_flat_ends(
    field: TriangleMesh, struts: FieldStruts, sides: int, factor: float = 1.0
) -> TriangleMesh:
    """Return the surface of a field with polygons at the flat ends that nothing else is near.

    Parameters
    ----------
    field : of `struts`, whose vertices are 32-bit numbers, times `factor`
    sides : of the polygons, which have the area of their circles
    """
    ends = _ends(struts)
    ends = ends.chosen(_alone(field.vertices, ends))
    while len(ends.tip):
        points, starts = _polygons(ends, sides, factor)
        rings = np.arange(len(points)).reshape(-1, sides)
        far = ends.depth + AHEAD * ends.radius
        made = seamed(field, ends.cuts(), points, rings, starts, factor, far)
        if len(made.failed) == 0:
            first = np.repeat(rings[:, :1], sides - 2, axis=1)
            discs = np.stack([first, rings[:, 1:-1], rings[:, 2:]], axis=2)
            triangles = np.concatenate([made.triangles, discs.reshape(-1, 3)])
            return compacted(np.concatenate([points, made.vertices]), triangles)
        kept = np.ones(len(ends.tip), dtype=np.bool_)
        kept[made.failed] = False
        ends = ends.chosen(kept)
    return field


def _ends(struts: FieldStruts) -> _Ends:
    """Return the flat ends of struts that are long enough to be cut off there."""
    lengths = struts.lengths
    strut, end = np.nonzero(struts.flat & (lengths > 0)[:, None])
    tip, tail = struts.ends[strut, end], struts.ends[strut, 1 - end]
    size = lengths[strut]
    radius = struts.radii[strut, end]
    slope = (radius - struts.radii[strut, 1 - end]) / size
    narrowing = 1.0 + DEPTH * np.minimum(slope, 0.0)
    depth = DEPTH * radius / np.maximum(narrowing, 1e-9)
    fits = (depth < size) & (DEPTH * slope < 0.5)
    ends = _Ends(tip, (tip - tail) / size[:, None], radius, slope, depth)
    return ends.chosen(fits)


def _alone(vertices: Points, ends: _Ends) -> Bools:
    """Return which ends have no vertex near them that is not of their own strut, (e,)."""
    alone = np.ones(len(ends.tip), dtype=np.bool_)
    if len(alone) == 0:
        return alone
    below, above = ends.depth + BESIDE * ends.wide, AHEAD * ends.radius
    middle = ends.tip + 0.5 * (above - below)[:, None] * ends.outward
    reach = np.hypot(0.5 * (above + below), CLEAR * ends.wide)
    found = cKDTree(vertices).query_ball_point(middle, reach)
    end = np.repeat(np.arange(len(found)), [len(each) for each in found])
    way = vertices[np.concatenate([np.zeros(0), *found]).astype(np.intp)] - ends.tip[end]
    out = dot(way, ends.outward[end])
    away = length(way - out[:, None] * ends.outward[end])
    near = (out > -below[end]) & (out < above[end]) & (away < CLEAR * ends.wide[end])
    slope = ends.slope[end]
    beyond = (away - ends.radius[end] - slope * out) / np.sqrt(1.0 + slope * slope)
    off = np.abs(np.maximum(out, beyond)) > ON_STRUT * ends.radius[end]
    alone[end[near & off]] = False
    return alone


def _polygons(ends: _Ends, sides: int, factor: float) -> tuple[Points, UnitVectors]:
    """Return the corners of polygons, (e sides, 3) mm, and where they begin, (e, 3)."""
    x = any_perpendicular(ends.outward)
    y = np.cross(ends.outward, x)
    angle = 2 * np.pi / sides * np.arange(sides)
    around = np.cos(angle)[:, None] * x[:, None] + np.sin(angle)[:, None] * y[:, None]
    size = enlargement(np.zeros(1), sides)[0] * ends.radius
    points: Points = ends.tip[:, None] + size[:, None, None] * around
    return in_single_precision(points.reshape(-1, 3), factor) / factor, x
