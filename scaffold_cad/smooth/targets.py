"""What the limit of a control mesh is to be: radii of struts, places, enclosed spheres.

Each target measures points of the limit surface and corrects the pose of the control mesh. One
correction reaches it but for what other corrections change: a few rounds reach all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from scaffold_cad.arrays import Floats, Ints, Points, Radii, UnitVectors
from scaffold_cad.vectors import dot, length

DOME_WEIGHT = 0.92
"""Part of the shift of a dome's cap that its top follows."""

MOST_SCALED = 2.0
"""Most that a section is scaled up, or down."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where the vertices of a control mesh are put."""

    scale: Floats
    """Factor of the spokes of each group of vertices, shape (g,); changed by targets."""
    shift: Points
    """By how much each vertex is moved, shape (v, 3), mm; changed by targets."""


class Target(Protocol):
    """Something that the limit is to be."""

    def error(self, limits: Points) -> float:
        """Return the largest error among the points of the limit surface, 1 for just acceptable."""

    def correct(self, limits: Points, pose: Pose) -> None:
        """Change the pose by what the limit misses."""


@dataclass(frozen=True, eq=False)
class StrutRadii:
    """The mean radius in the middle of each strut."""

    samples: Ints
    """Points of the limit around the start, the middle and the end of the piece of strut that has
    the strut's middle, shape (m, 3, 8)."""
    groups: Ints
    """Groups of vertices at both ends of that piece, shape (m, 8)."""
    middles: Points
    """Middle of each strut, shape (m, 3), mm."""
    axes: UnitVectors
    """Direction of each strut, shape (m, 3)."""
    radii: Radii
    """Radius asked for in the middle, shape (m,), mm."""
    tolerance: float
    """Acceptable error as a part of the radius."""

    def error(self, limits: Points) -> float:
        """Return the largest error of a strut's radius."""
        return float(np.abs(self._ratio(limits) - 1).max(initial=0.0)) / self.tolerance

    def correct(self, limits: Points, pose: Pose) -> None:
        """Scale each section by the mean of what the struts that it belongs to ask for."""
        owners = self.groups.reshape(-1)
        asked = np.repeat(self._ratio(limits), self.groups.shape[1])
        count = np.bincount(owners, minlength=len(pose.scale))
        total = np.bincount(owners, asked, minlength=len(pose.scale))
        pose.scale[count > 0] *= total[count > 0] / count[count > 0]
        np.clip(pose.scale, 1 / MOST_SCALED, MOST_SCALED, out=pose.scale)

    def _ratio(self, limits: Points) -> Floats:
        """Return the radii asked for over those that are there, (m,)."""
        around = limits[self.samples] - self.middles[:, None, None]  # (m, 3, 8, 3)
        spokes = around - around.mean(axis=2, keepdims=True)
        axes = np.broadcast_to(self.axes[:, None, None], spokes.shape)
        height = dot(around, axes).mean(axis=2)  # (m, 3)
        across = spokes - dot(spokes, axes)[..., None] * axes
        ratio: Floats = self.radii / at_zero(height, length(across).mean(axis=2))
        return ratio


@dataclass(frozen=True, eq=False)
class Domes:
    """The tops of domes."""

    caps: Ints
    """Vertices of each dome's cap, shape (k, 4)."""
    tops: Ints
    """Point of the limit in the middle of each cap, shape (k,)."""
    wanted: Points
    """Where it is to be, shape (k, 3), mm."""
    tolerance: Floats
    """Acceptable distance from there, shape (k,), mm."""

    def error(self, limits: Points) -> float:
        """Return the largest distance of a top from its place."""
        return float((length(self.wanted - limits[self.tops]) / self.tolerance).max(initial=0.0))

    def correct(self, limits: Points, pose: Pose) -> None:
        """Move each cap by what its top misses."""
        pose.shift[self.caps] += (self.wanted - limits[self.tops])[:, None, :] / DOME_WEIGHT


@dataclass(frozen=True, eq=False)
class Spheres:
    """Spheres of branch points that the limit is to enclose at the star's vertices."""

    centres: Points
    """Node of each star vertex, shape (w, 3), mm; they are the first vertices and groups."""
    radii: Radii
    """Radius of its sphere, shape (w,), mm."""
    gain: Floats
    """By how much the limit moves outwards as the vertex' scale grows by 1, shape (w,), mm."""
    tolerance: float
    """Acceptable part of the radius by which a sphere stands out."""

    def error(self, limits: Points) -> float:
        """Return by how much a sphere stands out most."""
        return float((self._missing(limits) / self.radii).max(initial=0.0)) / self.tolerance

    def correct(self, limits: Points, pose: Pose) -> None:
        """Scale up the vertices where the sphere stands out."""
        scale = pose.scale[: len(self.radii)]  # a view
        scale += self._missing(limits) / self.gain
        np.clip(scale, 1 / MOST_SCALED, MOST_SCALED, out=scale)

    def _missing(self, limits: Points) -> Floats:
        there = length(limits[: len(self.radii)] - self.centres)
        return np.maximum(self.radii - there, 0.0)


def at_zero(places: Floats, values: Floats) -> Floats:
    """Return the parabolas through three `values` (m, 3) at ascending `places`, at 0, (m,).

    At the nearest of the outer places if 0 is not between them; the second value for places that
    do not ascend.
    """
    at = np.clip(0.0, places[:, 0], places[:, 2])[:, None] - places  # (m, 3)
    gaps = np.diff(places, axis=1)
    proper = (gaps > 0.05 * np.abs(gaps).max(axis=1, keepdims=True)).all(axis=1)
    first, second = np.where(proper[:, None], gaps, 1.0).T
    weights = np.stack(
        [
            at[:, 1] * at[:, 2] / (first * (first + second)),
            -at[:, 0] * at[:, 2] / (first * second),
            at[:, 0] * at[:, 1] / ((first + second) * second),
        ],
        axis=1,
    )
    weights[~proper] = [0.0, 1.0, 0.0]
    found: Floats = (weights * values).sum(axis=1)
    return found
