"""Triangle meshes with fewer triangles: edges drawn together where that moves the surface little.

Each vertex has the mean of the squared distances to the planes of the triangles that it stands for,
by their areas. An edge is drawn together to the point of least mean, where its root is within a
tolerance, no triangle turns over or becomes a sliver, and the surface is not pinched. Edges that
share no triangle are drawn together at once. Where triangles cross in the end, their vertices stay,
and all is done again.

References
----------
Garland, Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Triangles
from scaffold_cad.base.vectors import length, normalize
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh, have_distinct_corners

TURN = 0.5
"""Least cosine of the angle by which a triangle's normal may turn at once."""

THIN = 0.25
"""Least height of a triangle, in tolerances, but for those that are thinner from the start."""

PULL = 1e-3
"""Weight of the middle of an edge beside the planes: it decides where these leave it open."""

COARSEST = 4.0
"""How many times larger tolerances become where there would be too many triangles."""

SHARES = (1 / 256, 1 / 16, 1 / 4, 1.0, COARSEST, COARSEST**2)
"""What of the tolerance, squared, may be used up: first by the edges that cost least."""

SIEVES = 5
"""Times that edges are looked for that share no triangle with those found."""

FEW = 0.003
"""Part of the triangles that a round leaves out at least, or it is the last one."""

TRIES = 6
"""Times that all is done again, with more vertices that stay."""


def decimated(mesh: TriangleMesh, tolerance: Floats, fixed: Ints, most: int) -> TriangleMesh:
    """Return a mesh without crossings with fewer triangles, free of crossings too.

    Parameters
    ----------
    tolerance : (v,) how far the surface may move at each vertex, by the root of the mean, mm
    fixed : (k,) vertices that stay where they are, and keep their order
    most : triangles; where there are more tolerances grow, to `COARSEST` times of these at most
    """
    stays = np.zeros(len(mesh.vertices), dtype=np.bool_)
    stays[fixed] = True
    for _ in range(TRIES):
        work = _Decimation(mesh, tolerance, stays)
        work.run(most)
        crossing = np.unique(self_intersections(work.mesh()))
        if len(crossing) == 0:
            return work.mesh()
        of_crossing = np.zeros_like(stays)
        of_crossing[work.triangles[crossing]] = True
        stays = stays | of_crossing[work.target]
    return mesh


class _Decimation:
    """A mesh that is being decimated."""

    def __init__(self, mesh: TriangleMesh, tolerance: Floats, stays: Bools) -> None:
        self.middle = mesh.vertices.mean(axis=0)
        self.points = mesh.vertices - self.middle
        self.triangles: Triangles = mesh.triangles
        self.target = np.arange(len(self.points))
        """Vertex that each vertex became a part of, shape (v,)."""
        self.stays = stays.copy()
        self.stays[mesh.faulty_sides()[1]] = True  # on a border
        self.tolerance = tolerance.copy()
        self.planes = self._planes()
        self._known = (np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros((0, 3)))
        self._blocked = np.zeros(0, dtype=np.intp)

    def mesh(self) -> TriangleMesh:
        """Return the mesh as it is, with the vertices that it uses."""
        used = np.zeros(len(self.points), dtype=np.bool_)
        used[self.triangles] = True
        rank = np.cumsum(used) - 1
        return TriangleMesh(self.points[used] + self.middle, rank[self.triangles])

    def run(self, most: int) -> None:
        """Draw edges together until little comes of it; beyond tolerances if `most` asks for it."""
        for share in SHARES:
            if share > 1 and len(self.triangles) <= most:
                return
            before = np.inf
            while before - len(self.triangles) > FEW * len(self.triangles):
                before = len(self.triangles)
                if not self._round(share):
                    break

    def _planes(self) -> Floats:
        """Return sums over the triangles of each vertex, by area, of 1, nn, -(np) n and (np)².

        n is the normal of a triangle, p a point of it; shape (v, 1 + 9 + 3 + 1).
        """
        corners = self.points[self.triangles]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area, normal = length(across), normalize(across)
        place = (normal * corners[:, 0]).sum(axis=1)
        columns = [
            np.ones((len(area), 1)),
            (normal[:, :, None] * normal[:, None]).reshape(-1, 9),
            -place[:, None] * normal,
            place[:, None] ** 2,
        ]
        rows = area[:, None] * np.hstack(columns)  # (t, 14)
        sums = [
            np.bincount(self.triangles.reshape(-1), np.repeat(column, 3), len(self.points))
            for column in rows.T
        ]
        return np.stack(sums, axis=1)

    def _round(self, share: float) -> bool:
        """Draw edges together that share no triangle; return whether there were any.

        Parameters
        ----------
        share : of the tolerance, squared, that may be used up
        """
        edges, keys = self._edges()
        cost, places = self._costs(edges, keys)
        scale = self.tolerance[edges].min(axis=1) ** 2
        able = np.flatnonzero((cost <= share * scale) & ~np.isin(keys, self._blocked))
        chosen = able[self._independent(edges[able], cost[able] / scale[able])]
        if len(chosen) == 0:
            return False
        good = self._good(edges[chosen], places[chosen])
        self._blocked = np.union1d(self._blocked, keys[chosen[~good]])
        self._draw(edges[chosen[good]], places[chosen[good]])
        return True

    def _edges(self) -> tuple[Edges, Ints]:
        """Return the edges with an end that may move, shape (e, 2), and their keys, ascending."""
        start, end = self.triangles.reshape(-1), np.roll(self.triangles, -1, axis=1).reshape(-1)
        inner = (start < end) & ~(self.stays[start] & self.stays[end])
        keys = np.sort(start[inner] * len(self.points) + end[inner])
        return np.stack(np.divmod(keys, len(self.points)), axis=1), keys

    def _costs(self, edges: Edges, keys: Ints) -> tuple[Floats, Points]:
        """Return the mean squared distance where each edge is drawn together to, and that place."""
        old_keys, old_costs, old_places = self._known
        if len(old_keys):
            place = np.minimum(np.searchsorted(old_keys, keys), len(old_keys) - 1)
            known = old_keys[place] == keys
            costs, places = old_costs[place], old_places[place]
        else:
            known = np.zeros(len(keys), dtype=np.bool_)
            costs, places = np.zeros(len(keys)), np.zeros((len(keys), 3))
        new = np.flatnonzero(~known)
        costs[new], places[new] = self._placed(edges[new])
        self._known = keys, costs, places
        return costs, places

    def _placed(self, edges: Edges) -> tuple[Floats, Points]:
        """Return the least mean squared distance of points for edges, (e,), and the points."""
        sums = self.planes[edges].sum(axis=1)  # (e, 14)
        sums = sums / np.maximum(sums[:, :1], 1e-300)
        square, linear, rest = sums[:, 1:10].reshape(-1, 3, 3), sums[:, 10:13], sums[:, 13]
        ends = self.points[edges]  # (e, 2, 3)
        pulled = square + PULL * np.eye(3)
        places = np.linalg.solve(pulled, (PULL * ends.mean(axis=1) - linear)[..., None])[..., 0]
        stay = self.stays[edges]
        for side in (0, 1):
            places[stay[:, side]] = ends[stay[:, side], side]
        costs = np.einsum("ei,eij,ej->e", places, square, places)
        costs += 2.0 * (linear * places).sum(axis=1) + rest
        return np.maximum(costs, 0.0), places

    def _independent(self, edges: Edges, cost: Floats) -> Ints:
        """Return edges of low cost, no two of which touch the same triangle."""
        rank = np.empty(len(edges), dtype=np.intp)
        # An even order: a slope of costs would leave one edge a round.
        rank[np.lexsort((_scattered(edges), np.log2(cost + 1e-9).astype(np.intp)))] = np.arange(
            len(edges)
        )
        corners, left, chosen = self.triangles.reshape(-1), np.arange(len(edges)), []
        for _ in range(SIEVES):
            least = np.full(len(self.points), len(edges))
            for side in (0, 1):
                np.minimum.at(least, edges[left, side], rank[left])
            around = least.copy()
            np.minimum.at(around, corners, np.repeat(least[self.triangles].min(axis=1), 3))
            found = left[(around[edges[left]] == rank[left, None]).all(axis=1)]
            chosen.append(found)
            ends = np.zeros(len(self.points), dtype=np.bool_)
            ends[edges[found]] = True
            near = np.zeros_like(ends)
            near[self.triangles[ends[self.triangles].any(axis=1)]] = True
            left = left[~near[edges[left]].any(axis=1)]
        return np.concatenate(chosen)

    def _good(self, edges: Edges, places: Points) -> Bools:
        """Return which edges may be drawn together to their places, (e,)."""
        bad = np.zeros(len(edges), dtype=np.bool_)
        order = np.argsort(self.triangles.reshape(-1), kind="stable") // 3
        count = np.bincount(self.triangles.reshape(-1), minlength=len(self.points))
        first = np.cumsum(count) - count
        beside = []
        least = THIN * self.tolerance[edges].min(axis=1)
        for side in (0, 1):
            own, other = edges[:, side], edges[:, 1 - side]
            which = np.repeat(np.arange(len(edges)), count[own])
            step = np.arange(len(which)) - np.repeat(np.cumsum(count[own]) - count[own], count[own])
            corners = self.triangles[order[first[own][which] + step]]  # (k, 3)
            at = corners == own[which, None]
            near = (which[:, None] * len(self.points) + corners)[
                (corners != own[which, None]) & (corners != other[which, None])
            ]
            beside.append(np.unique(near))  # by edge
            kept = ~(corners == other[which, None]).any(axis=1)
            which, corners, at = which[kept], corners[kept], at[kept]
            before = self.points[corners]
            after = np.where(at[..., None], places[which, None], before)
            bad[which[~_stay_up(before, after, least[which])]] = True
        both = np.sort(np.concatenate(beside))
        shared = both[1:][both[1:] == both[:-1]] // len(self.points)
        bad[np.bincount(shared, minlength=len(edges)) != 2] = True
        return ~bad

    def _draw(self, edges: Edges, places: Points) -> None:
        """Draw edges together, each to its first end or to that which stays."""
        turned = self.stays[edges[:, 1]]
        kept = np.where(turned, edges[:, 1], edges[:, 0])
        gone = np.where(turned, edges[:, 0], edges[:, 1])
        self.points[kept] = places
        self.planes[kept] += self.planes[gone]
        self.tolerance[kept] = np.minimum(self.tolerance[kept], self.tolerance[gone])
        target = np.arange(len(self.points))
        target[gone] = kept
        triangles = target[self.triangles]
        self.triangles = triangles[have_distinct_corners(triangles)]
        self.target = target[self.target]
        moved = np.zeros(len(self.points), dtype=np.bool_)
        moved[kept] = moved[gone] = True
        keys, costs, points = self._known
        same = ~moved[np.stack(np.divmod(keys, len(moved)), axis=1)].any(axis=1)
        self._known = keys[same], costs[same], points[same]
        near = moved.copy()
        near[self.triangles[moved[self.triangles].any(axis=1)]] = True
        ends = np.stack(np.divmod(self._blocked, len(moved)), axis=1)
        self._blocked = self._blocked[~near[ends].any(axis=1)]


def _scattered(edges: Edges) -> NDArray[np.uint64]:
    """Return a number for each edge that is as good as random, and always the same, (e,)."""
    bits = edges[:, 0].astype(np.uint64) << np.uint64(32) | edges[:, 1].astype(np.uint64)
    for factor in (0xBF58476D1CE4E5B9, 0x94D049BB133111EB):  # as in splitmix64
        bits = (bits ^ bits >> np.uint64(30)) * np.uint64(factor)
    return np.asarray(bits ^ bits >> np.uint64(31))


def _stay_up(before: Floats, after: Floats, least: Floats) -> Bools:
    """Return which triangles (k, 3, 3) neither turn over nor become slivers, (k,)."""
    normals = [np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) for c in (before, after)]
    sizes = [length(normal) for normal in normals]
    heights = [
        size / np.maximum(length(c - np.roll(c, 1, axis=1)).max(axis=1), 1e-300)
        for size, c in zip(sizes, (before, after), strict=True)
    ]
    up = (normals[0] * normals[1]).sum(axis=1) > TURN * sizes[0] * sizes[1]
    found: Bools = up & (heights[1] >= np.minimum(least, heights[0]))
    return found
