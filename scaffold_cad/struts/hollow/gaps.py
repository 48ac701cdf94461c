"""How far points inside of a node's surface are from it: how thick a wall is there.

The nearest of many samples of the surface is looked for. For a wall that is being made the distance
is that to the paraboloid that touches the surface there, as bent as it; for one that is measured
the sample is moved along the surface to the foot of the perpendicular.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, UnitVectors
from scaffold_cad.base.blocks import cut
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.struts.blending.blend import Solved

LEVELS = 17
"""Samples of a patch in either direction, its rims among them."""
INSIDE = 23
"""The same of the surface inside, where walls are measured: not at the same places."""
AT_ONCE = 512
"""Points whose feet are looked for at once."""
MARGIN = (0.007, 0.5)
"""Parts of how far a point seems to be, and of what bends make of it, that it may be nearer."""
UPRIGHT = 0.9999
"""Least cosine of a perpendicular to the normal at its foot."""
LEANING = 0.99
"""Least cosine of the way to a sample to the normal there at which its plane counts."""
MOST_BENT = 0.5
"""Part of the distance from the tangent plane that the surface bends away from it at most."""
STEPS = 4
"""Steps of Gauss and Newton to the foot of a perpendicular."""
BESIDE = 1.05
"""Distance from a strut's axis up to which points past its collar are its own, in its radii."""


class Gaps:
    """The surfaces of U nodes, to which points inside are measured."""

    def __init__(self, shapes: Solved) -> None:
        """Take the surfaces of blends."""
        self._shapes = shapes
        self._points, self._normals = surface_samples(shapes, LEVELS)
        self._axes, self._bends = surface_bends(shapes, self._normals, LEVELS)
        self._trees = [cKDTree(each) for each in self._points]

    def measured(self, points: Floats, rows: Ints) -> tuple[Floats, UnitVectors]:
        """Return how far points are from the surface beside the nearest samples.

        Parameters
        ----------
        points : (k, q, 3) float64, mm
        rows : (k,) the node of each row

        Returns
        -------
        (k, q) float64, mm, and the normals at these samples, (k, q, 3)
        """
        gaps, normals = np.empty(points.shape[:2]), np.empty(points.shape)
        for place, (row, inside) in enumerate(zip(rows.tolist(), points, strict=True)):
            nearest, gaps[place], _ = self._beside(row, inside)
            normals[place] = self._normals[row, nearest]
        return gaps, normals

    def _beside(self, row: int, points: Floats) -> tuple[Ints, Floats, Floats]:
        """Return the samples nearest to points (q, 3), and how far these are, mm, all (q,).

        The distance is that from the paraboloid there, to the second order of how far aside the
        sample is. What its bends make of the distance comes last.
        """
        place = np.asarray(self._trees[row].query(points)[1], dtype=np.intp)
        way = self._points[row, place] - points
        height = dot(way, self._normals[row, place])
        aside = np.einsum("qax,qx->qa", self._axes[row, place], way)
        bends = self._bends[row, place]
        bends = bends / np.maximum(1.0 + bends * height[:, None], MOST_BENT)
        most = MOST_BENT * np.abs(height)
        bent = np.clip((bends * aside**2).sum(axis=1) / 2, -most, most)
        return place, height + bent, bent

    def least(self, inside: Solved) -> Floats:
        """Return the least distance of samples of the surfaces inside, (U,), mm."""
        return self.least_and_most(inside)[0]

    def least_and_most(self, inside: Solved) -> tuple[Floats, Floats]:
        """Return the least distance of samples of the surfaces inside, (U,), mm; and the greatest.

        The greatest is that beside the nearest samples, past no collar.
        """
        points, _ = surface_samples(inside, INSIDE)
        below, walls = self._below_struts(points)
        least = np.where(below, walls, np.inf).min(axis=1)
        rest = [self._range(row, each[~below[row]]) for row, each in enumerate(points)]
        nearest, furthest = np.transpose(rest)
        return np.minimum(least, nearest), furthest

    def _below_struts(self, points: Floats) -> tuple[Bools, Floats]:
        """Return which points are at a strut past its collar, and how far below its surface.

        They are in it or just outside: what is far from a strut may be in another's node.

        Parameters
        ----------
        points : (U, p, 3) samples inside, patch by patch, mm

        Returns
        -------
        (U, p) bool, and (U, p) float64, mm
        """
        shapes = self._shapes
        rim = shapes.control[:, ::4, 0, -2:]  # (U, N, 2, 3): along a generator
        x, y = shapes.collar_corners[:, :, 0], shapes.collar_corners[:, :, 1]
        axes = np.cross(x, y)[:, :, None]  # (U, N, 1, 3)
        heights, radii = _along_and_across(rim, axes)
        slopes = np.diff(radii, axis=2) / np.diff(heights, axis=2)  # (U, N, 1)
        high, wide = _along_and_across(points[:, None], axes)  # (U, N, p)
        past = high - shapes.collar_distances[..., None]
        walls = shapes.collar_radii[..., None] + slopes * past - wide
        walls /= np.hypot(1.0, slopes)
        there = (past > 0) & (wide < BESIDE * shapes.collar_radii[..., None])
        nearest: Floats = np.where(there, walls, -np.inf).max(axis=1)
        return np.asarray(there.any(axis=1)), nearest

    def _range(self, row: int, points: Floats) -> tuple[float, float]:
        """Return the least distance of points (q, 3) inside of a surface, mm; < 0 outside.

        And the greatest, as it seems. Those that may be nearest are looked at first, and no more
        where all others are further away.
        """
        place, seems, bent = self._beside(row, points)
        may_be = seems - MARGIN[0] * np.abs(seems) - MARGIN[1] * np.abs(bent)
        order = np.argsort(may_be, kind="stable")
        least = np.inf
        for some in cut(order, row=1, within=AT_ONCE):
            if may_be[some[0]] > least:
                break
            least = min(least, float(self._distances(row, points[some], place[some]).min()))
        return least, float(seems.max(initial=0.0))

    def _distances(self, row: int, points: Floats, place: Ints) -> Floats:
        """Return how far points (q, 3) are inside of a surface, (q,), mm; < 0 for those outside.

        Parameters
        ----------
        place : (q,) the nearest sample of each
        """
        patch, rest = place // LEVELS**2, place % LEVELS**2
        at = np.stack([rest // LEVELS, rest % LEVELS], axis=1) / (LEVELS - 1)  # (q, 2)
        most = 0.5 / (LEVELS - 1)
        for _ in range(STEPS):
            found, slopes = self._evaluated(row, patch, at)
            way = points - found
            square = np.einsum("qax,qbx->qab", slopes, slopes)
            along = np.einsum("qax,qx->qa", slopes, way)
            (a, b), (_, d) = np.moveaxis(square, 0, -1)
            size = np.maximum(a * d - b * b, 1e-300)
            step = np.stack([d * along[:, 0] - b * along[:, 1], a * along[:, 1] - b * along[:, 0]])
            at = np.clip(at + np.clip(step / size, -most, most).T, 0.0, 1.0)
        found, slopes = self._evaluated(row, patch, at)
        start = self._points[row, place] - points
        way = found - points
        normal = normalize(np.cross(slopes[:, 0], slopes[:, 1]))
        sizes, height = np.sqrt(dot(way, way)), dot(way, normal)
        is_foot = np.abs(height) > UPRIGHT * sizes
        sizes = np.minimum(sizes, np.sqrt(dot(start, start)))
        seems = dot(start, self._normals[row, place])
        # Where the foot is beyond the patch the plane at the sample says more, unless it leans.
        better = ~is_foot & (seems < sizes) & (seems > LEANING * sizes)
        sizes = np.where(better, seems, sizes)
        out = np.flatnonzero((height < 0) & (seems < 0))
        out = out[self._are_beyond(row, points[out])]
        sizes[out] *= -1
        return sizes

    def _are_beyond(self, row: int, points: Floats) -> Bools:
        """Return whether points (q, 3) are further from the node than the surface, (q,).

        It is star-shaped: the sample in nearly the same direction tells.
        """
        away = np.sqrt(dot(points, points))
        distances = np.sqrt(dot(self._points[row], self._points[row]))
        directions = self._points[row] / distances[:, None]
        _, nearest = cKDTree(directions).query(points / away[:, None])
        return np.asarray(away > distances[nearest])

    def _evaluated(self, row: int, patch: Ints, at: Floats) -> tuple[Floats, Floats]:
        """Return points (q, 3) of patches (q,) at parameters (q, 2), and slopes by both."""
        control = self._shapes.control[row, patch]  # (q, n_u, n_v, 3)
        u, v = self._shapes.layout.u, self._shapes.layout.v
        values = u.values_at(at[:, 0]), v.values_at(at[:, 1])
        by_u, by_v = u.values_at(at[:, 0], 1), v.values_at(at[:, 1], 1)
        rows = np.einsum("qj,qijx->qix", values[1], control)
        across = np.einsum("qj,qijx->qix", by_v, control)
        points = np.einsum("qi,qix->qx", values[0], rows)
        slopes = np.einsum("qi,qix->qx", by_u, rows), np.einsum("qi,qix->qx", values[0], across)
        return points, np.stack(slopes, axis=1)


def _along_and_across(points: Floats, axes: UnitVectors) -> tuple[Floats, Floats]:
    """Return how far points (U, N or 1, q, 3) are along axes (U, N, 1, 3), and from them."""
    along = (points * axes).sum(axis=-1)
    return along, length(points - along[..., None] * axes)


def surface_samples(shapes: Solved, levels: int) -> tuple[Floats, UnitVectors]:
    """Return points and normals of blends on a grid in each patch, both (U, p, 3).

    Parameters
    ----------
    levels : of the grid in either direction
    """
    at = np.linspace(0.0, 1.0, levels)
    u, v = shapes.layout.u, shapes.layout.v
    patches = np.moveaxis(shapes.control, -1, 0)  # (3, U, 4 N, n_u, n_v)
    points = u.values_at(at) @ patches @ v.values_at(at).T
    by_u = u.values_at(at, 1) @ patches @ v.values_at(at).T
    by_v = u.values_at(at) @ patches @ v.values_at(at, 1).T
    normals = np.cross(by_u, by_v, axis=0)
    count = len(shapes)
    flat = [np.moveaxis(each, 0, -1).reshape(count, -1, 3) for each in (points, normals)]
    return np.ascontiguousarray(flat[0]), normalize(flat[1])


def surface_bends(shapes: Solved, normals: UnitVectors, levels: int) -> tuple[UnitVectors, Floats]:
    """Return the axes of greatest and least curvature of blends, and the curvatures there.

    Parameters
    ----------
    normals : (U, p, 3) on a grid in each patch
    levels : of the grid in either direction

    Returns
    -------
    (U, p, 2, 3) unit vectors, and (U, p, 2) float64, 1 / mm, > 0 where the surface is hollow
    """
    at = np.linspace(0.0, 1.0, levels)
    u, v = shapes.layout.u, shapes.layout.v
    patches = np.moveaxis(shapes.control, -1, 0)  # (3, U, 4 N, n_u, n_v)

    def slope(by_u: int, by_v: int) -> Floats:
        found = u.values_at(at, by_u) @ patches @ v.values_at(at, by_v).T
        return np.moveaxis(found, 0, -1).reshape(normals.shape)

    across, along = slope(1, 0), slope(0, 1)
    x = normalize(across)
    y = np.cross(normals, x)
    # Parameters per mm along x and y: across = a x, along = b x + c y.
    a, b, c = (dot(one, other) for one, other in ((across, x), (along, x), (along, y)))
    second = [dot(slope(*order), normals) for order in ((2, 0), (1, 1), (0, 2))]
    xx = second[0] / a**2
    xy = (second[1] - b * xx * a) / (a * c)
    yy = (second[2] - b**2 * xx - 2 * b * c * xy) / c**2
    bends, turns = np.linalg.eigh(np.stack([xx, xy, xy, yy], axis=-1).reshape(*xx.shape, 2, 2))
    axes = np.einsum("upax,upab->upbx", np.stack([x, y], axis=2), turns)
    return axes, bends
