"""What the limit of a control mesh is to be: radii of struts, places, enclosed spheres.

Each target measures points of the limit surface and corrects the pose of the control mesh. One
correction reaches it but for what other corrections change: a few rounds reach all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points, Radii, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize

DOME_WEIGHT = 0.92
"""Part of the shift of a dome's cap that its top follows."""

ROUNDNESS = 0.5
"""Weight of each rail's own distance against the mean of all four, where struts share vertices."""

RAIL = (2 / 3) / ((2 / 3 + 11 * np.sqrt(2) / 24) / 2)
"""Distance of a rail's limit from the axis of an even tube, in mean radii: see `stars.APOTHEM`."""

MOST_SCALED = 2.0
"""Most that a vertex is scaled up, or down."""


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
class Rails:
    """The four rails of a piece of each strut, where it comes nearest to the strut's middle."""

    samples: Ints
    """Points of the limit at the start, the middle and the end of the rails, shape (m, 3, 4)."""
    middles: Points
    """Middle of each strut, shape (m, 3), mm."""
    axes: UnitVectors
    """Direction of each strut, shape (m, 3)."""
    radii: Radii
    """Radius asked for in the middle, shape (m,), mm."""
    slopes: Floats
    """By how much the radius grows along the strut, shape (m,)."""

    def passing(self, limits: Points) -> tuple[Floats, Floats]:
        """Return where the rails pass, and how far from the axis they should.

        Returns
        -------
        (m, 4, 3) float64, mm, from the axis to the rails; (m,) float64, mm, the distance asked for
        """
        rails = limits[self.samples] - self.middles[:, None, None]  # (m, 3, 4, 3)
        axes = np.broadcast_to(self.axes[:, None, None], rails.shape)
        height = dot(rails, axes)  # (m, 3, 4)
        across = rails - height[..., None] * axes
        weights = parabola_weights(height.transpose(0, 2, 1).reshape(-1, 3)).reshape(-1, 4, 3)
        start, _, end = height.mean(axis=2).T
        radii = self.radii + self.slopes * np.clip(0.0, np.minimum(start, end), end)
        return np.einsum("mjk,mkjx->mjx", weights, across), RAIL * radii


@dataclass(frozen=True, eq=False)
class RoundStruts:
    """Struts with sections of their own, whose rails are to stand on a circle around the axis."""

    rails: Rails
    """Their rails."""
    vertices: Ints
    """Vertices that are moved, shape (k,)."""
    rail: Ints
    """Rail that each of them belongs to, `4 m + j` for rail j of strut m, shape (k,)."""
    share: Floats
    """How large the section of each is, beside the strut's mean one, shape (k,)."""
    tolerance: float
    """Acceptable distance of a rail from its place, as a part of the radius."""

    def error(self, limits: Points) -> float:
        """Return the largest distance of a rail from its place."""
        parts = length(self._missing(limits)) / self.rails.radii[:, None]
        return float(parts.max(initial=0.0)) / self.tolerance

    def correct(self, limits: Points, pose: Pose) -> None:
        """Move both ends of each rail by what it misses, in proportion to their sections."""
        missing = self._missing(limits).reshape(-1, 3)
        pose.shift[self.vertices] += self.share[:, None] * missing[self.rail]

    def _missing(self, limits: Points) -> Floats:
        """Return from where each rail is to the nearest square of rails, (m, 4, 3)."""
        axes = self.rails.axes
        across, distance = self.rails.passing(limits)
        x = normalize(across[:, 0])
        y = np.cross(axes, x)
        spokes = dot(across, x[:, None]) + 1j * dot(across, y[:, None])  # (m, 4)
        spokes /= np.maximum(np.abs(spokes), np.finfo(np.float64).tiny)
        quarter = np.array([1, 1j, -1, -1j])
        turn = np.angle((spokes / quarter).sum(axis=1))
        places = distance[:, None] * np.exp(1j * turn)[:, None] * quarter
        wanted = places.real[..., None] * x[:, None] + places.imag[..., None] * y[:, None]
        missing: Floats = wanted - across
        return missing


@dataclass(frozen=True, eq=False)
class StrutRadii:
    """Struts that share their sections or stars, whose rails are to have a distance on average."""

    rails: Rails
    """Their rails."""
    groups: Ints
    """Groups of the vertices at both ends of the rails, shape (m, 2, 4)."""
    tolerance: float
    """Acceptable error of the mean distance as a part of it."""

    def error(self, limits: Points) -> float:
        """Return the largest error of a strut's mean distance."""
        return float(np.abs(self._missing(limits).mean(axis=1)).max(initial=0.0)) / self.tolerance

    def correct(self, limits: Points, pose: Pose) -> None:
        """Scale each vertex by the mean of what the rails that it belongs to miss."""
        owners = self.groups.reshape(-1)
        missing = self._missing(limits)
        # A vertex of several struts cannot serve all of their rails: their means come first.
        missing = missing.mean(axis=1, keepdims=True) + ROUNDNESS * missing
        asked = np.broadcast_to(missing[:, None, :], self.groups.shape).reshape(-1)
        count = np.bincount(owners, minlength=len(pose.scale))
        total = np.bincount(owners, asked, minlength=len(pose.scale))
        pose.scale[:] *= 1 + np.clip(total / np.maximum(count, 1), -0.5, 1.0)
        np.clip(pose.scale, 1 / MOST_SCALED, MOST_SCALED, out=pose.scale)

    def _missing(self, limits: Points) -> Floats:
        """Return by what part of its distance from the strut's centre each rail misses it, (m, 4).

        The tube leaves the axis where it rounds bends, and so has a centre of its own.
        """
        across, wanted = self.rails.passing(limits)
        distance = length(across - across.mean(axis=1, keepdims=True))
        missing: Floats = 1 - distance / wanted[:, None]
        return missing


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


def parabola_weights(places: Floats) -> Floats:
    """Return what a parabola's three values at ascending `places` (n, 3) weigh at 0, (n, 3).

    At the nearest of the outer places if 0 is not between them. Places that do not ascend leave
    all weight to the second value.
    """
    at = np.clip(0.0, places[:, 0], places[:, 2])[:, None] - places  # (n, 3)
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
    return weights
