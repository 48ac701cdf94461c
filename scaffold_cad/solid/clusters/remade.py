"""Fields made again: only where their struts have changed.

Where a seam fails, its cluster grows, and clusters that come near each other are one. The surfaces
of all others stay: groups of struts that are far apart have nothing to do with each other.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.mesh.pieces import pieces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.solid.field import FieldStruts

BESIDE = 0.6
"""How far apart groups of struts are at least, in radii: flat ends look so far around them."""


class Remade:
    """Makes surfaces of fields one after the other, and keeps what stays from one to the next."""

    def __init__(self, make: Callable[[FieldStruts], TriangleMesh]) -> None:
        """Take what makes the surface of struts that are not there yet."""
        self._make = make
        self._mesh: TriangleMesh | None = None
        self._struts: FieldStruts | None = None

    def surface(self, struts: FieldStruts) -> TriangleMesh:
        """Return the surface of all groups of struts."""
        before, old = self._struts, self._mesh
        if before is None or old is None:
            mesh = self._make(struts)
        else:
            stays, kept = _unchanged(before, struts)
            mesh = _of_struts(old, before, stays)
            if not kept.all():
                mesh = _both(mesh, self._make(struts.chosen(~kept)))
        self._mesh, self._struts = mesh, struts
        return mesh


def _unchanged(before: FieldStruts, after: FieldStruts) -> tuple[Bools, Bools]:
    """Return which struts are in groups that are the same before and after."""
    keys = [_keys(before), _keys(after)]
    both = set(keys[0]) & set(keys[1])
    first, second = (np.array([key in both for key in some], dtype=np.bool_) for some in keys)
    return first, second


def _keys(struts: FieldStruts) -> list[bytes]:
    """Return what tells the group of each strut from others."""
    group = groups_of(struts)
    rows = np.column_stack(
        [struts.ends.reshape(-1, 6), struts.radii, struts.flat, struts.blend]
    )  # (m, 11)
    order = np.lexsort((*rows.T, group))
    first = np.flatnonzero(np.diff(group[order], prepend=-1))
    of_group = [part.tobytes() for part in np.split(rows[order], first[1:])]
    return [of_group[number] for number in group.tolist()]


def groups_of(struts: FieldStruts) -> Ints:
    """Return the group of each strut: those that come near each other are in one, (m,)."""
    reach = struts.radii.max(axis=1) * (1.0 + BESIDE) + struts.blend
    low, high = (struts.ends.min(axis=1) - reach[:, None], struts.ends.max(axis=1) + reach[:, None])
    links = [np.zeros((0, 2), dtype=np.intp)]
    for one, other in overlapping_boxes(low, high):
        a, b = nearest_on_segments(*_axes(struts, one), *_axes(struts, other))
        near = length(a - b) <= reach[one] + reach[other]
        links.append(np.stack([one[near], other[near]], axis=1))
    return component_labels(np.concatenate(links), len(reach))


def _axes(struts: FieldStruts, which: Ints) -> tuple[Points, Points]:
    return struts.ends[which, 0], struts.ends[which, 1]


def _of_struts(mesh: TriangleMesh, struts: FieldStruts, stays: Bools) -> TriangleMesh:
    """Return the surfaces around those struts (m,) of a mesh that stay."""
    pieces = pieces_of(mesh)
    _, first = np.unique(pieces.piece_of, return_index=True)
    kept = stays[_nearest(struts, mesh.vertices[first])]
    triangles = mesh.triangles[kept[pieces.piece_of[mesh.triangles[:, 0]]]]
    return compacted(mesh.vertices, triangles)


def _nearest(struts: FieldStruts, points: Points) -> Ints:
    """Return the strut on whose surface each point (k, 3) is, or whose fillet is nearest, (k,)."""
    reach = (struts.radii.max(axis=1) * (1.0 + BESIDE) + struts.blend)[:, None]
    low = np.concatenate([points, struts.ends.min(axis=1) - reach])
    high = np.concatenate([points, struts.ends.max(axis=1) + reach])
    best, found = np.full(len(points), np.inf), np.zeros(len(points), dtype=np.intp)
    for point, strut in overlapping_boxes(low, high):
        own = (point < len(points)) & (strut >= len(points))
        point, strut = point[own], strut[own] - len(points)
        gap = _gaps(struts, strut, points[point])
        order = np.argsort(-gap, kind="stable")  # the nearest one comes last, and stays
        nearer = order[gap[order] < best[point[order]]]
        best[point[nearer]], found[point[nearer]] = gap[nearer], strut[nearer]
    return found


def _gaps(struts: FieldStruts, strut: Ints, points: Points) -> Floats:
    """Return how far points (k, 3) are from the surfaces of struts (k,), (k,)."""
    start, end = _axes(struts, strut)
    along = end - start
    share = dot(points - start, along) / np.maximum(dot(along, along), 1e-300)
    share = share.clip(0.0, 1.0)
    near, far = struts.radii[strut].T
    away = length(points - start - share[:, None] * along)
    return np.asarray(np.abs(away - near - share * (far - near)))


def _both(first: TriangleMesh, second: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(
        np.concatenate([first.vertices, second.vertices]),
        np.concatenate([first.triangles, second.triangles + len(first.vertices)]),
    )
