"""Exact volumes of blends, cell by cell, for the compensation of their triangles.

A cell is what lies between two samples each way. Between it and the two triangles that stand for it
is a gap: its mean thickness tells how far their corners are to be moved, so that the triangles are
as much beyond the surface as they are behind it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Points
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.vectors import dot, triple
from scaffold_cad.struts.blending.blend import Solved

LEAST_PLACES = 8
"""Least number of places, along a side of a patch, at which it is looked at: those of Gauss and
Legendre in each cell."""

PLACE_BYTES = 96
"""What a place takes where it is looked at."""


@dataclass(frozen=True, eq=False)
class Cells(Frozen):
    """Cells of the patches around each strut, in the order of rings."""

    areas: Floats
    """Vector area, outward, shape (U, N, levels, sides, 3), mm²."""
    moments: Floats
    """Three times the volume between the cell and the node, shape (U, N, levels, sides), mm³."""

    @property
    def volumes(self) -> Floats:
        """Volume between the patches of each node and the node, shape (U,), mm³."""
        return np.asarray(self.moments.reshape(len(self.moments), -1).sum(axis=1) / 3.0)

    def gaps(self, points: Points) -> Floats:
        """Return the volume between cells and their triangles, > 0 where these are behind, mm³.

        The height of a paraboloid over the middle of its corners, across its own tangent planes,
        adds up to twice that volume, in the mean of both diagonals.

        Parameters
        ----------
        points : (U, N, levels + 1, sides, 3) corners of the cells, relative to the node, mm
        """
        near, far = points[:, :, :-1], points[:, :, 1:]
        both = near + far
        middle = (both + np.roll(both, -1, axis=3)) / 4
        return np.asarray((self.moments - dot(middle, self.areas)) / 2.0)


def cells_of(shapes: Solved, u: Floats, v: Floats) -> Cells:
    """Return the cells between parameters from 0 to 1, `u` (steps + 1,) and `v` (levels + 1,)."""
    steps, levels = len(u) - 1, len(v) - 1
    at_u, weight_u = _places(u)
    at_v, weight_v = _places(v)
    across, along = shapes.layout.u, shapes.layout.v
    values_u, slopes_u = across.values_at(at_u), across.values_at(at_u, 1)
    values_v, slopes_v = along.values_at(at_v).T, along.values_at(at_v, 1).T
    weights = weight_u[:, None] * weight_v
    patches = shapes.control.reshape(-1, *shapes.control.shape[2:])  # (f, n_u, n_v, 3)
    areas = np.empty((len(patches), levels, steps, 3))
    moments = np.empty((len(patches), levels, steps))
    split = (steps, len(at_u) // steps, levels, len(at_v) // levels)
    for part in blocks(len(patches), len(at_u) * len(at_v) * PLACE_BYTES, CACHE):
        control = np.ascontiguousarray(np.moveaxis(patches[part], -1, 0))  # (3, f, n_u, n_v)
        rows = control @ values_v
        points, by_u = values_u @ rows, slopes_u @ rows
        by_v = values_u @ (control @ slopes_v)
        turned = np.cross(by_u, by_v, axis=0) * weights  # (3, f, u, v)
        moment = (points * turned).sum(axis=0)
        areas[part] = turned.reshape(3, -1, *split).sum(axis=(3, 5)).transpose(1, 3, 2, 0)
        moments[part] = moment.reshape(-1, *split).sum(axis=(2, 4)).swapaxes(1, 2)
    return Cells(_around(areas, len(shapes)), _around(moments, len(shapes)))


def triangle_volumes(points: Points) -> Floats:
    """Return the volume between the triangles of stacks and their nodes, (K,), mm³.

    Parameters
    ----------
    points : (K, N, levels + 1, sides, 3), relative to the node, mm; the shorter diagonals are taken
    """
    a, d = points[:, :, :-1], points[:, :, 1:]
    b, c = np.roll(a, -1, axis=3), np.roll(d, -1, axis=3)
    one, other = c - a, d - b
    ahead = dot(one, one) <= dot(other, other)
    flat = np.where(ahead, triple(a, b + -d, c), triple(b, c + -a, d))
    return np.asarray(flat.sum(axis=(1, 2, 3)) / 6.0)


def _places(at: Floats) -> tuple[Floats, Floats]:
    """Return the places in the intervals between `at` (k + 1,), and their weights, (k q,)."""
    size = np.diff(at)[:, None]
    nodes, weights = np.polynomial.legendre.leggauss(max(2, -(-LEAST_PLACES // len(size))))
    places = at[:-1, None] + size * (nodes + 1) / 2
    return places.reshape(-1), (size * weights / 2).reshape(-1)


def _around(values: Floats, count: int) -> Floats:
    """Return the values (U 4 N, levels, steps, ...) of the cells of patches around struts."""
    _, levels, steps = values.shape[:3]
    by_strut = values.reshape(count, -1, 4, levels, steps, *values.shape[3:])
    by_strut = by_strut.swapaxes(2, 3)
    return by_strut.reshape(count, -1, levels, 4 * steps, *values.shape[3:])
