"""How far the samples of nodes are moved, so that their triangles have the volume of the blends.

A surface of flat faces through points of a round one is smaller than that, or larger where it is
hollow. As compensation, each sample is moved outward until that adds the gaps around it: on
cylinders by as much as their rings are larger than circles. What that leaves of the volume of a
node is spread over all its samples, the less the nearer these are to its collars.

Samples are moved away from the node where they face away from it: then the directions in which they
are seen from there stay, in narrow crotches too. Others are moved along their normals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.blocks import CACHE, cut
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.struts.blending.blend import Solved
from scaffold_cad.struts.meshes.volumes import Cells, triangle_volumes

MOST = 0.25
"""How far samples are moved at most, over their distance from their strut's axis."""

ENOUGH = 5e-4
"""Part of a node's volume that may be missing so that its samples are not moved further."""

GRAZING, FACING = 0.2, 0.5
"""Cosines between normals and directions from the node: up to the first one samples are moved along
their normals, from the second one on away from the node."""

ROUNDS = 4
"""Times that the volume is looked at."""

LEAST_SLOPE = 0.1
"""Part of the samples that are taken to be free to move at least."""

POINT_BYTES = 512
"""What a point takes while that is done."""


@dataclass(frozen=True, eq=False)
class Samples(Frozen):
    """Samples of U blends around each strut, in the order of rings, `fine` of them each."""

    points: Floats
    """Relative to the node, shape (U, N, levels + 1, fine, 3), mm."""
    normals: UnitVectors
    """Outward, shape (U, N, levels + 1, fine, 3)."""
    rings: Ints
    """Number of each, in 0..b-1: those on arcs are of two struts, (U, N, levels + 1, fine)."""

    @property
    def ways(self) -> UnitVectors:
        """Unit vectors along which they are moved, shape (U, N, levels + 1, fine, 3)."""
        spokes = normalize(self.points)
        share = np.clip((dot(spokes, self.normals) - GRAZING) / (FACING - GRAZING), 0.0, 1.0)
        return normalize(self.normals + share[..., None] * (spokes - self.normals))

    def sums(self, values: Floats) -> Floats:
        """Return the sum of the values (U, N, levels + 1, fine) of samples with one number."""
        row, count = self._on_arcs
        added = np.bincount(row.reshape(-1), values[:, :, :1].reshape(-1), count)
        found = values.copy()
        found[:, :, :1] = added[row]
        return found

    def least(self, values: Floats) -> Floats:
        """Return the least of the values (U, N, levels + 1, fine) of samples with one number."""
        row, count = self._on_arcs
        smallest = np.full(count, np.inf)
        np.minimum.at(smallest, row.reshape(-1), values[:, :, :1].reshape(-1))
        found = values.copy()
        found[:, :, :1] = smallest[row]
        return found

    @property
    def _on_arcs(self) -> tuple[Ints, int]:
        """Numbers of the first level that differ from blend to blend, and how many there may be."""
        rings = self.rings[:, :, :1]
        count = int(rings.max()) + 1
        return count * np.arange(len(rings))[:, None, None, None] + rings, count * len(rings)


@dataclass(frozen=True, eq=False)
class Moved(Frozen):
    """Samples of K nodes where they are moved to."""

    points: Floats
    """Relative to the nodes, shape (K, N, levels + 1, fine, 3), mm."""
    swell: Floats
    """How far they are moved, where that is further than the slack, shape (K,), mm."""


@dataclass(frozen=True, eq=False)
class Lifted(Frozen):
    """Samples of U blends around each strut, and how they are moved."""

    points: Floats
    """Relative to the node, shape (U, N, levels + 1, fine, 3), mm."""
    ways: UnitVectors
    """Along which they are moved, shape (U, N, levels + 1, fine, 3)."""
    lifts: Floats
    """How far, for the gaps around each, shape (U, N, levels + 1, fine), mm."""
    reach: Floats
    """Distance from the strut's axis, or its radius, shape (U, N, levels + 1, fine), mm."""
    areas: Floats
    """Volume that moving each adds to its strut, shape (U, N, levels + 1, fine), mm²."""
    spokes: Floats
    """From the axes of struts to their last rings, shape (U, N, fine, 3), mm."""
    volumes: Floats
    """Volume between the patches and their node, shape (U,), mm³."""
    discs: Floats
    """Volume between the disc of each collar and the node, shape (U, N), mm³."""

    @staticmethod
    def of(shapes: Solved, axes: UnitVectors, samples: Samples, cells: Cells) -> Lifted:
        """Return how samples are moved.

        Parameters
        ----------
        axes : (U, N, 3) of the struts
        cells : those between the samples
        """
        points, ways = samples.points, samples.ways
        gap, (total, area) = cells.gaps(points) / 4, np.zeros((2, *points.shape[:-1]))
        for near in (np.s_[:, :, :-1], np.s_[:, :, 1:]):
            for turn in (0, 1):
                total[near] += np.roll(gap, turn, axis=3)
                area[near] += dot(ways[near], np.roll(cells.areas, turn, axis=3)) / 4
        across = points - dot(points, axes[:, :, None, None])[..., None] * axes[:, :, None, None]
        wide, far = shapes.collar_radii, shapes.collar_distances
        return Lifted(
            points,
            ways,
            samples.sums(total) / samples.sums(area),
            samples.least(np.maximum(length(across), wide[..., None, None])),
            area,
            points[:, :, -1] - (far[..., None] * axes)[:, :, None],
            cells.volumes,
            np.pi / 3 * wide**2 * far,
        )

    def moved(self, which: Ints, growth: Floats, sides: int, slack: float) -> Moved:
        """Return the samples of nodes as they make up for the volume of their blends.

        Parameters
        ----------
        which : (K,) blend of each node
        growth : (K, N) how much larger than the collars their polygons are, over their radii
        sides : of these
        slack : how far samples are moved, over `reach`; further where that is not enough
        """
        found = np.empty((len(which), *self.points.shape[1:]))
        swell = np.zeros(len(which))
        for part in cut(np.arange(len(which)), self.lifts[0].size * POINT_BYTES, CACHE):
            found[part], _, missing = self._moved(which[part], growth[part], sides, slack)
            short = part[missing > ENOUGH]
            if len(short):
                found[short], swell[short], _ = self._moved(
                    which[short], growth[short], sides, MOST
                )
        return Moved(found, swell)

    def _moved(
        self, which: Ints, growth: Floats, sides: int, most: float
    ) -> tuple[Floats, Floats, Floats]:
        """Return moved samples, how far they are, (K,), mm, and the part that is missing, (K,)."""
        points, ways = self.points[which], self.ways[which]
        lifts, limit = self.lifts[which], most * self.reach[which]
        fades = np.linspace(1.0, 0.0, points.shape[2])[:, None]
        areas = self.areas[which] * fades
        rings = points[:, :, -1] + growth[..., None, None] * self.spokes[which]
        wider = 0.5 / np.pi * sides * np.sin(2 * np.pi / sides) * (1.0 + growth) ** 2 - 1.0
        wanted = self.volumes[which] - (wider * self.discs[which]).sum(axis=1)
        least = LEAST_SLOPE * areas.reshape(len(which), -1).sum(axis=1)
        spread = np.zeros(len(which))
        for _ in range(ROUNDS):
            steps = lifts + spread[:, None, None, None] * fades
            placed = points + np.clip(steps, -limit, limit)[..., None] * ways
            placed[:, :, -1] = rings
            missing = wanted - triangle_volumes(placed)
            free = np.where(np.abs(steps) < limit, areas, 0.0).reshape(len(which), -1)
            spread = spread + missing / np.maximum(free.sum(axis=1), least)
        furthest = np.abs(np.clip(steps, -limit, limit)).reshape(len(which), -1).max(axis=1)
        return placed, furthest, np.abs(missing) / wanted
