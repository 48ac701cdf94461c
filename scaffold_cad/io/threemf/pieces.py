"""What the bodies of a 3MF file are in its space: a skeleton with radii, and triangles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scaffold_cad.base.arrays import Floats, Points, as_points
from scaffold_cad.io._mesh import joined_meshes
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.threemf.archive import Piece
from scaffold_cad.mesh.trianglemesh import TriangleMesh


def skeleton_of(pieces: Sequence[Piece]) -> RawSkeleton:
    """Return the beams of all pieces, nothing welded, without vertices that no beam uses.

    Each beam keeps the radii of its ends; a transform scales them by the cube root of its
    determinant.

    Raises
    ------
    SkeletonError
        If a position is not finite.
    """
    nodes, edges, radii, first = [np.zeros((0, 3))], [np.zeros((0, 2), dtype=np.intp)], [], 0
    for piece in pieces:
        used, ends = np.unique(piece.body.beams, return_inverse=True)
        nodes.append(_placed(piece, piece.body.vertices[used]))
        edges.append(ends.reshape(-1, 2) + first)
        radii.append(piece.body.radii * _growth(piece))
        first += len(used)
    ends_of_all = np.concatenate(edges)
    of_ends = np.concatenate([np.zeros((0, 2)), *radii])
    points = as_points(np.concatenate(nodes), "nodes")
    return RawSkeleton(points, ends_of_all, edge_radii=of_ends)


def triangles_of(pieces: Sequence[Piece]) -> TriangleMesh:
    """Return the triangles of all pieces, one after the other, every vertex kept.

    Raises
    ------
    MeshError
        If a position is not finite.
    """
    return joined_meshes([_mesh(piece) for piece in pieces if len(piece.body.triangles)])


def _mesh(piece: Piece) -> TriangleMesh:
    triangles = piece.body.triangles
    if np.linalg.det(piece.transform[:3]) < 0:  # a mirror turns triangles inside out
        triangles = triangles[:, ::-1]
    return TriangleMesh(_placed(piece, piece.body.vertices), triangles)


def _placed(piece: Piece, points: Points) -> Floats:
    with np.errstate(over="ignore", invalid="ignore"):
        placed: Floats = points @ piece.transform[:3] + piece.transform[3]
    return placed


def _growth(piece: Piece) -> float:
    """Return how many times radii grow under the transform of a piece."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.cbrt(abs(np.linalg.det(piece.transform[:3]))))
