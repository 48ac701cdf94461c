"""Bodies of nodes and of curves: their surfaces, closed by the discs of their collars."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints, Points, Triangles
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.curves.cuts import CutCurves, cut_curves
from scaffold_cad.struts.curves.rings import curve_rings, intervals_of
from scaffold_cad.struts.meshes.bands import enlargement, ring_triangles
from scaffold_cad.struts.meshes.fineness import Fineness
from scaffold_cad.struts.meshes.rings import Grid
from scaffold_cad.struts.meshes.surface import (
    Sized,
    node_surface,
    own_rings,
    ring_centers,
    sized_rings,
)
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.sharp.surface import node_triangles

OFTEN, MOST_KINDS = 8, 256
"""Least number of equal nodes that make a kind, and most kinds."""

SAME = 1e-6
"""Rings whose size agrees to this part of their radius are equally large."""


class NodeBodies:
    """Blended nodes of round struts, from the lowest to the highest."""

    def __init__(self, struts: RoundStruts, sides: int, chosen: Bools) -> None:
        """Take the nodes of struts; none is made yet.

        Parameters
        ----------
        sides : points of a collar's ring, a multiple of 4
        chosen : (n,) which nodes are wanted; none of them crowded
        """
        self._struts, self._sides = struts, sides
        self._sized = sized_rings(struts, sides)
        self._fineness = Fineness.of(struts, sides)
        lows, highs = [np.zeros((0, 3))], [np.zeros((0, 3))]
        groups, nodes, kinds = [], [], []
        rows: list[Ints] = []
        for number, group in enumerate(struts.blended):
            row = np.flatnonzero(chosen[group.nodes])
            # A patch lies among its control points.
            control = group.shapes.control.reshape(len(group.shapes), -1, 3)  # (U, ..., 3)
            growth = self._sized.growth[group.half_runs[row]].max(axis=1)[:, None]
            node, which = struts.runs.nodes[group.nodes[row]], group.shape_of[row]
            lows.append(node + control.min(axis=1)[which] - growth)
            highs.append(node + control.max(axis=1)[which] + growth)
            nodes.append(group.nodes[row])
            kinds.append(
                _equal(which, self._sized, group.half_runs[row]) + sum(len(one) for one in rows)
            )
            groups.append(np.full(len(row), number))
            rows.append(row)
        low = np.concatenate(lows)
        order = np.argsort(low[:, 2], kind="stable")
        self.low: Points = low[order]
        """Lowest corner of a box around each body, from the lowest up, shape (m, 3), mm."""
        self.high: Points = np.concatenate(highs)[order]
        """Highest corner of that box, shape (m, 3), mm."""
        none = np.zeros(0, dtype=np.intp)
        self.nodes: Points = struts.runs.nodes[np.concatenate([none, *nodes])[order]]
        """Positions of the nodes, shape (m, 3), mm."""
        self.kinds: Ints = _kinds(np.concatenate([none, *kinds]))[order]
        """Equal for bodies that are equal but for their place; -1 for those with few like them."""
        self._group_of = np.concatenate([none, *groups])[order]
        self._row_of = np.concatenate([none, *rows])[order]

    def __len__(self) -> int:
        return len(self.low)

    def mesh(self, some: slice | Ints) -> TriangleMesh:
        """Return the closed surfaces of some of the bodies."""
        points: list[Points] = []
        faces: list[Triangles] = []
        count = 0
        group_of, row_of = self._group_of[some], self._row_of[some]
        groups = (
            self._struts.blended[number][row_of[group_of == number]]
            for number in np.unique(group_of).tolist()
        )
        for group, grid in self._fineness.parts(groups):
            placed, triangles = self._closed(group, grid)
            points.append(placed)
            faces.append(triangles + count)
            count += len(placed)
        return TriangleMesh(np.concatenate(points), np.concatenate(faces))

    def _closed(self, group: BlendedNodes, grid: Grid) -> tuple[Points, Triangles]:
        """Return the vertices and triangles of nodes, the discs of their collars included."""
        struts, sides, shape = self._struts, self._sides, group.half_runs.shape
        half_runs = group.half_runs.reshape(-1)
        own = own_rings(struts, half_runs, self._sized, sides).reshape(*shape, sides, 3)
        growth = self._sized.growth[group.half_runs]
        made = node_surface(struts, group, own, growth, grid)
        last = made.rings
        middle = len(made.points) + np.arange(len(half_runs)).reshape(*shape, 1)
        fans = [np.broadcast_to(middle, last.shape), last, np.roll(last, -1, axis=2)]
        discs = np.stack(fans, axis=-1).reshape(-1, 3)
        points = np.concatenate([made.points, ring_centers(struts, half_runs)])
        return points, np.concatenate([made.triangles, discs])


def _equal(shape_of: Ints, sized: Sized, half_runs: Ints) -> Ints:
    """Return the same number for nodes with the same blend and rings as large, shape (m,)."""
    if len(shape_of) == 0:
        return shape_of
    growth = np.rint(sized.growth[half_runs] / (SAME * sized.radius[half_runs]))  # (m, N)
    rows = np.concatenate([shape_of[:, None], growth], axis=1)
    _, number = np.unique(rows, axis=0, return_inverse=True)
    return number.reshape(-1)


def _kinds(numbers: Ints) -> Ints:
    """Return numbers (m,) from 0 on for those that occur often, and -1 for others."""
    _, place, count = np.unique(numbers, return_inverse=True, return_counts=True)
    often = count >= max(OFTEN, len(numbers) / MOST_KINDS)
    found: Ints = np.where(often, np.cumsum(often) - 1, -1)[place.reshape(-1)]
    return found


def crowded_pieces(struts: RoundStruts) -> Bools:
    """Return the pieces of curves that have no surface of their own, (p,)."""
    curves = struts.curves
    ends = np.stack([curves.nodes[curves.pieces], curves.nodes[curves.pieces + 1]], axis=1)
    return np.asarray((struts.crowded[ends] & (ends >= 0)).any(axis=1))


def beside_crowded(struts: RoundStruts) -> Bools:
    """Return the joints at which curves end, as they are crowded beyond, (n,)."""
    found = np.zeros_like(struts.crowded)
    cut = cut_curves(struts.curves, crowded_pieces(struts), len(struts.runs.tails))
    found[cut.nodes] = True
    return found


def curve_bodies(struts: RoundStruts, sides: int, chosen: Bools) -> TriangleMesh:
    """Return the closed surfaces of curves, with discs at their ends, but for crowded pieces.

    Parameters
    ----------
    sides : points of a ring, a multiple of 4
    chosen : (n,) joints; the curves are wanted whose first ones these are
    """
    first_joints = struts.curves.nodes[struts.curves.offsets[:-1] + 1]
    unwanted = ~chosen[first_joints][struts.curves.curve_of_piece]
    count = len(struts.runs.tails)
    cut = cut_curves(struts.curves, unwanted | crowded_pieces(struts), count)
    curves = cut.curves
    ends = curves.half_runs[~curves.closed].reshape(-1)
    rings = np.empty((count + len(cut.nodes), sides), dtype=np.intp)
    rings[ends] = np.arange(len(ends) * sides).reshape(-1, sides)
    circles = np.empty((len(rings), sides, 3))
    real = ends[ends < count]
    circles[real] = own_rings(struts, real, sized_rings(struts, sides), sides)
    circles[count:] = _rings_at(cut, struts.runs.nodes[cut.nodes], sides)
    own = circles[ends]  # (2 c', sides, 3)
    at_ends = own.reshape(-1, 2, sides, 3)
    levels = intervals_of(curves, sides, struts.options.wall)
    made = curve_rings(curves, levels, rings, at_ends, len(ends) * sides)
    points = np.concatenate([own.reshape(-1, 3), made.points, own.mean(axis=1)])
    middle = len(ends) * sides + len(made.points) + np.arange(len(ends))[:, None]
    middle = np.broadcast_to(middle, (len(ends), sides))
    discs = np.stack([middle, rings[ends], np.roll(rings[ends], -1, axis=1)], axis=-1)
    faces = [ring_triangles(points, made.low, made.high), discs.reshape(-1, 3)]
    return TriangleMesh(points, np.concatenate(faces))


def _rings_at(cut: CutCurves, centers: Points, sides: int) -> Points:
    """Return the rings at cuts, counter-clockwise about what is cut off, (v, sides, 3), mm."""
    angle = 2 * np.pi / sides * np.arange(sides)
    axes = np.stack([cut.x, np.cross(cut.outward, cut.x)], axis=1)
    around = np.einsum("ks,vkx->vsx", np.stack([np.cos(angle), np.sin(angle)]), axes)
    size = cut.radii * enlargement(np.zeros(1), sides)[0]
    return np.asarray(centers[:, None] + size[:, None, None] * around)


def sharp_bodies(struts: RoundStruts, sides: int, chosen: Bools) -> TriangleMesh:
    """Return the closed surfaces of sharp nodes, with discs at their collars.

    Parameters
    ----------
    sides : points of a ring, a multiple of 4
    chosen : (n,) which nodes are wanted; none of them crowded
    """
    sized = sized_rings(struts, sides)
    points: list[Points] = [np.zeros((0, 3))]
    faces: list[Triangles] = [np.zeros((0, 3), dtype=np.intp)]
    count = 0
    for part in node_triangles(struts, sides):
        rows = np.flatnonzero(chosen[part.nodes])
        half_runs = part.half_runs[rows]
        first, valency = part.points.shape[1], half_runs.shape[1]
        flat = half_runs.reshape(-1)
        rings = own_rings(struts, flat, sized, sides).reshape(len(rows), valency * sides, 3)
        centers = ring_centers(struts, flat).reshape(len(rows), valency, 3)
        placed = np.concatenate([part.points[rows], rings, centers], axis=1)  # (m, ..., 3)
        ring = first + np.arange(valency * sides).reshape(valency, sides)
        middle = first + valency * sides + np.arange(valency)[:, None]
        discs = np.stack(
            [np.broadcast_to(middle, ring.shape), ring, np.roll(ring, -1, axis=1)], axis=-1
        )
        own = np.concatenate([part.triangles, discs.reshape(-1, 3)])
        start = count + placed.shape[1] * np.arange(len(rows))[:, None, None]
        points.append(placed.reshape(-1, 3))
        faces.append((start + own).reshape(-1, 3))
        count += placed.size // 3
    return TriangleMesh(np.concatenate(points), np.concatenate(faces))
