"""Partitions in which chosen pairs of directions are neighbors.

Two directions can only be neighbors along an edge of the triangulation that the dual method
starts from. So the triangulation is changed by edge flips until it has an edge for each pair,
and only multigraphs that take these edges are considered.
"""

from __future__ import annotations

import heapq
from itertools import count

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors, as_indices
from scaffold_cad.base.vectors import angle_between, normalize
from scaffold_cad.errors import PartitionError
from scaffold_cad.partition.delaunay import Triangulations, triangulations
from scaffold_cad.partition.dual import EFFORTS, Contest, candidates, edges_of
from scaffold_cad.partition.multigraph import EDGES_EACH


def as_neighbors(pairs: ArrayLike, valency: int) -> Ints:
    """Return `pairs` as (k, 2) intp, ascending in each pair, none twice.

    Raises
    ------
    PartitionError
        If the shape or type is wrong, an index is out of range, a pair is of one direction, or a
        direction has more than four neighbors.
    """
    wanted = as_indices(pairs, "neighbors", PartitionError)
    if wanted.size == 0:
        return wanted.reshape(0, 2)
    if wanted.ndim != 2 or wanted.shape[1] != 2:
        raise PartitionError(f"neighbors has shape {wanted.shape}; need (k, 2)")
    for i, j in wanted.tolist():
        if not (0 <= i < valency and 0 <= j < valency and i != j):
            raise PartitionError(
                f"neighbors {i} and {j} are not two directions; need two of 0 to {valency - 1}"
            )
    wanted = np.unique(np.sort(wanted, axis=1), axis=0)
    uses = np.bincount(wanted.reshape(-1))
    if uses.max() > EDGES_EACH:
        raise PartitionError(
            f"direction {np.argmax(uses)} is to have {uses.max()} neighbors; "
            f"a quad has at most {EDGES_EACH}"
        )
    return wanted


def guided_partition(star: UnitVectors, pairs: Ints) -> tuple[UnitVectors, Ints]:
    """Return vertices (N + 2, 3) and quads (N, 4) in which each pair shares an arc.

    Parameters
    ----------
    star : (N, 3) float64, unit vectors, distinct; N ≥ 4
    pairs : (k, 2) intp

    Raises
    ------
    PartitionError
        If no certified partition with these neighbors is found.
    """
    contest = Contest(star[None])
    mesh, found = triangulations(star[None])
    if len(found) == 0:
        raise PartitionError("these directions have no triangulation to choose neighbors in")
    mesh = _with_edges(mesh, pairs)
    ends = np.sort(np.stack([mesh.tails, mesh.heads], axis=2)[:, edges_of(mesh)[0]], axis=2)
    wanted = (ends[:, :, None] == pairs).all(axis=3).any(axis=2)  # (1, E)
    for effort in EFFORTS:
        if contest.lowest[0] >= effort.below:
            break
        contest.enter(*candidates(mesh, star[None], contest.reach, effort, wanted), effort.flow)
    if not contest.lowest[0] > 0:
        names = ", ".join(f"{i} and {j}" for i, j in pairs.tolist())
        raise PartitionError(f"no certified partition found with neighbors {names}")
    return contest.best.vertices[0], contest.best.quads[0]


def _with_edges(mesh: Triangulations, pairs: Ints) -> Triangulations:
    """Return the triangulation of one star changed by flips until it has an edge a pair."""
    surface = _Surface(mesh)
    for i, j in pairs.tolist():
        surface.connect(i, j, kept=pairs.tolist())
    return surface.triangulation()


class _Surface:
    """The triangles of one star, which flips change."""

    def __init__(self, mesh: Triangulations) -> None:
        self.triangles: list[list[int]] = mesh.triangles[0].tolist()
        self.centers: list[Floats] = list(mesh.centers[0])
        self.beside = {  # triangle on the left of each half-edge
            (triangle[k - 1], triangle[k]): number
            for number, triangle in enumerate(self.triangles)
            for k in range(3)
        }

    def triangulation(self) -> Triangulations:
        return Triangulations(np.array([self.triangles]), np.array([self.centers]))

    def connect(self, i: int, j: int, kept: list[list[int]]) -> None:
        """Flip the edges between directions i and j away, none of those `kept`.

        Raises
        ------
        PartitionError
            If the kept edges or those that would be made twice are in the way.
        """
        if (i, j) in self.beside:
            return
        for a, b in self._crossed(i, j, kept):
            if not self._flip(a, b):
                raise PartitionError(f"directions {i} and {j} cannot be neighbors in this star")

    def _crossed(self, i: int, j: int, kept: list[list[int]]) -> list[tuple[int, int]]:
        """Return the edges crossed on the cheapest way through triangles from i to j.

        To cross an edge costs the length of its Voronoi arc: what its two directions share.
        """
        serial = count()
        queue: list[tuple[float, int, int, list[tuple[int, int]]]] = [
            (0.0, next(serial), number, [])
            for number, triangle in enumerate(self.triangles)
            if i in triangle
        ]
        seen: set[int] = set()
        while queue:
            cost, _, number, way = heapq.heappop(queue)
            if number in seen:
                continue
            seen.add(number)
            triangle = self.triangles[number]
            if j in triangle:
                return way
            for k in range(3):
                a, b = triangle[k - 1], triangle[k]
                if sorted((a, b)) in kept or i in (a, b):
                    continue
                other = self.beside[b, a]
                arc = angle_between(self.centers[number], self.centers[other])
                step = (cost + float(arc) + 1e-9, next(serial), other, [*way, (a, b)])
                heapq.heappush(queue, step)
        raise PartitionError(
            f"directions {i} and {j} cannot be neighbors: other pairs of neighbors separate them"
        )

    def _flip(self, a: int, b: int) -> bool:
        """Replace edge (a, b) by that between the corners opposite it, unless there is one."""
        left, right = self.beside[a, b], self.beside[b, a]
        c = next(v for v in self.triangles[left] if v not in (a, b))
        d = next(v for v in self.triangles[right] if v not in (a, b))
        if (c, d) in self.beside:
            return False
        del self.beside[a, b], self.beside[b, a]
        middle = normalize(self.centers[left] + self.centers[right])
        for number, triangle in ((left, [c, a, d]), (right, [d, b, c])):
            self.triangles[number] = triangle
            self.centers[number] = middle
            for k in range(3):
                self.beside[triangle[k - 1], triangle[k]] = number
        return True
