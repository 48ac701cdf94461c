"""The triangles of a mesh, with what is needed of each to tell which of them meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.boxes import Spans, spans_of
from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.mesh.trianglemesh import TriangleMesh


@dataclass(frozen=True, eq=False)
class Faces:
    """The triangles in their order in space, with what the sieves need of each."""

    corners: Floats
    """Positions, shape (t, 3, 3), mm."""
    labels: Ints
    """What tells corners apart: the number of the position or of the vertex, shape (3, t).

    A corner that repeats an earlier one of its triangle has a label < 0 that no other has.
    """
    corner_count: Ints
    """Number of corners that repeat no other, shape (t,)."""
    normals: Floats
    """Cross product of two edges, shape (t, 3), mm²."""
    longest: Floats
    """The longest edge, shape (t, 3), mm."""
    reach: Floats
    """Largest coordinate difference of two corners, shape (t,), mm."""
    centers: Floats
    """Mean of the corners, shape (t, 3), mm."""
    bisectors: Floats
    """Sum of the unit vectors from each corner to the two others, shape (t, 3, 3)."""

    def corner(self, rows: Ints, number: Ints | int) -> Points:
        """Return one corner of each triangle in `rows` (k,), shape (k, 3), mm."""
        return picked(self.corners, rows, number)

    def edge(self, rows: Ints, number: int) -> Floats:
        """Return the edge that ends at a corner of each triangle in `rows` (k,), (k, 3), mm."""
        return self.corner(rows, number) - self.corner(rows, (number + 2) % 3)


def faces_of(mesh: TriangleMesh, order: Ints, weld: bool) -> Faces:
    """Return the triangles of `mesh` in `order` (t,).

    Parameters
    ----------
    weld : whether vertices at the very same position are one corner
    """
    triangles = mesh.triangles[order]
    corners = mesh.vertices[triangles]
    numbers = equal_positions(mesh.vertices)[0] if weld else np.arange(len(mesh.vertices))
    labels = np.ascontiguousarray(numbers[triangles].T)  # or each look-up would copy it all
    repeats = np.zeros(labels.shape, dtype=np.bool_)
    repeats[1] = labels[1] == labels[0]
    repeats[2] = (labels[2] == labels[0]) | (labels[2] == labels[1])
    labels[repeats] = -1 - np.flatnonzero(repeats)
    edges = np.roll(corners, -1, axis=1) - corners  # (t, 3, 3)
    along = normalize(edges)
    return Faces(
        corners=corners,
        labels=labels,
        corner_count=3 - repeats.sum(axis=0),
        normals=np.cross(edges[:, 0], edges[:, 1]),
        longest=picked(edges, np.arange(len(edges)), dot(edges, edges).argmax(axis=1)),
        reach=np.abs(edges).max(axis=(1, 2)),
        centers=(corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0,
        bisectors=along - np.roll(along, 1, axis=1),
    )


def picked(rows_of_three: Floats, rows: Ints, number: Ints | int) -> Floats:
    """Return `rows_of_three[rows, number]`, shape (k, 3); three times as fast as that."""
    return np.take(rows_of_three.reshape(-1, 3), 3 * rows + number, axis=0)


def boxes_of(corners: Floats) -> tuple[Points, Points]:
    """Return the lowest and highest coordinates of triangles (t, 3, 3), shapes (t, 3)."""
    a, b, c = (corners[:, k] for k in range(3))
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def diagonal_spans(corners: Floats) -> tuple[Spans, Spans]:
    """Return the spans of triangles (t, 3, 3) along x + y, y + z, z + x and along x - y, ….

    Rounding keeps the order of sums and differences, so that triangles that meet overlap.
    """
    following = np.roll(corners, -1, axis=2)
    return spans_of(*boxes_of(corners + following)), spans_of(*boxes_of(corners - following))
