"""Spherical Delaunay triangulations of many stars at once.

The triangles are the facets of the convex hull of the unit directions; the outward normal of a
facet is its Voronoi vertex, also where the hull does not contain the origin: the caps that the
facets cut off are empty all the same, and some are larger than a hemisphere.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import combinations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import dot, normalize

TIE_BREAK = 1e-11
"""How far directions are moved to choose the diagonals of facets with 4 or more corners.

It lies between the rounding of a hull's facets (1e-15) and the height of the flattest cap that
three directions 0.01° apart cut off (1e-9). A coplanar star becomes a flat hull of two sides.
"""
FEW = 32
"""Most directions of which all triples are tried as facets."""
HEIGHT_BYTES = 32
"""What the height of a direction above a plane takes where it is calculated."""


@dataclass(frozen=True, eq=False)
class Triangulations(Frozen):
    """Spherical Delaunay triangulations of M stars of valency N, as half-edges.

    Half-edge 3 t + k runs from corner k of triangle t to its next corner.
    """

    triangles: Ints
    """Directions at the corners, counter-clockwise seen from outside, shape (M, 2 N − 4, 3)."""
    centers: UnitVectors
    """Voronoi vertex of each triangle, shape (M, 2 N − 4, 3)."""

    def __getitem__(self, chosen: Ints | Bools) -> Triangulations:
        part = Triangulations(self.triangles[chosen], self.centers[chosen])
        part._keep(twins=self.twins[chosen])  # sorting them again would cost more
        return part

    @property
    def tails(self) -> Ints:
        """Direction that each half-edge leaves, shape (M, 6 N − 12)."""
        stars, triangles, corners = self.triangles.shape
        return self.triangles.reshape(stars, triangles * corners)

    @property
    def heads(self) -> Ints:
        """Direction that each half-edge reaches, shape (M, 6 N − 12)."""
        heads: Ints = np.roll(self.triangles, -1, axis=2).reshape(self.tails.shape)
        return heads

    @cached_property
    def twins(self) -> Ints:
        """The half-edge that runs along each one the other way, shape (M, 6 N − 12)."""
        count = self.triangles.shape[1] // 2 + 2
        ahead, back = self.tails * count + self.heads, self.heads * count + self.tails
        twins: Ints = np.empty_like(ahead)
        np.put_along_axis(twins, np.argsort(ahead, axis=1), np.argsort(back, axis=1), axis=1)
        return twins


def triangulations(stars: UnitVectors) -> tuple[Triangulations, Ints]:
    """Return the triangulations of those `stars` (M, N, 3) that have one, and which these are.

    Those so nearly degenerate that rounding decides have none.
    """
    valency = stars.shape[1]
    # Powers of e satisfy no linear relation: no four of the moved directions stay coplanar.
    moves = TIE_BREAK * (1000 * np.exp(np.arange(3 * valency) / 21) % 1.0).reshape(valency, 3)
    facets_of = _facets_of_few if valency <= FEW else _facets_of_many
    triangles, kept = facets_of(stars + moves)
    closed = _is_sphere(triangles, valency)
    triangles, kept = triangles[closed], kept[closed]
    a, b, c = (stars[kept[:, None], triangles[:, :, k]] for k in range(3))
    return Triangulations(triangles, normalize(np.cross(b - a, c - a))), kept


def _facets_of_few(points: Floats) -> tuple[Ints, Ints]:
    """Return the facets of the hulls of M times N points, (K, 2 N − 4, 3), and of which, (K,).

    Every triple of points is tried, which suits arrays: all hulls are found at once.
    """
    valency = points.shape[1]
    chosen = _triples(valency)
    found: list[tuple[Ints, Ints]] = []
    for part in blocks(len(points), len(chosen) * valency * HEIGHT_BYTES):
        above, below = _supports(points[part], chosen)
        complete = np.flatnonzero((above | below).sum(axis=1) == 2 * valency - 4)
        facets = np.nonzero((above | below)[complete])[1].reshape(-1, 2 * valency - 4)
        inward = above[complete[:, None], facets]
        triples = chosen[facets]
        triples = np.where(inward[..., None], triples[..., ::-1], triples)
        found.append((triples, part.start + complete))
    if not found:
        return np.empty((0, 2 * valency - 4, 3), dtype=np.intp), np.empty(0, dtype=np.intp)
    triangles, kept = zip(*found, strict=True)
    return np.concatenate(triangles), np.concatenate(kept)


def _facets_of_many(points: Floats) -> tuple[Ints, Ints]:
    """Return what `_facets_of_few` does, of one hull after the other."""
    valency = points.shape[1]
    triangles = np.zeros((len(points), 2 * valency - 4, 3), dtype=np.intp)
    kept: list[int] = []
    for star, own in enumerate(points):
        try:
            hull = ConvexHull(own)
        except QhullError:  # coplanar
            continue
        if len(hull.simplices) == 2 * valency - 4:
            a, b, c = np.moveaxis(own[hull.simplices], 1, 0)
            inward = dot(np.cross(b - a, c - a), hull.equations[:, :3]) < 0
            triangles[star] = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
            kept.append(star)
    return triangles[kept], np.array(kept, dtype=np.intp)


@lru_cache(maxsize=8)
def _triples(valency: int) -> Ints:
    """Return all triples i < j < k of 0..valency-1, shape (T, 3)."""
    return np.array(list(combinations(range(valency), 3)), dtype=np.intp)


def _supports(points: Floats, triples: Ints) -> tuple[Bools, Bools]:
    """Return which triples have no other point below their plane, and which none above, (M, T)."""
    i, j, k = (points[:, triples[:, c]] for c in range(3))
    normals = np.cross(j - i, k - i)
    # Heights are taken from a corner of the triple: near it they do not cancel.
    heights: Floats = normals @ np.swapaxes(points, 1, 2) - dot(normals, i)[..., None]
    heights[:, np.arange(len(triples))[:, None], triples] = 0.0
    return np.all(heights >= 0, axis=2), np.all(heights <= 0, axis=2)


def _is_sphere(triangles: Ints, valency: int) -> Bools:
    """Return whether the triangles of each star meet in pairs along every edge, shape (M,)."""
    following = np.roll(triangles, -1, axis=2)
    shape = (len(triangles), 6 * valency - 12)
    ahead = np.sort((triangles * valency + following).reshape(shape), axis=1)
    back = np.sort((following * valency + triangles).reshape(shape), axis=1)
    closed: Bools = (ahead == back).all(axis=1) & (np.diff(ahead, axis=1) > 0).all(axis=1)
    return closed
