"""What the bodies of a 3MF file are in its space: a skeleton, triangles, or an assembly of both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scaffold_cad.base.arrays import Floats, Points, as_points
from scaffold_cad.io._mesh import joined_meshes
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.threemf.archive import Piece
from scaffold_cad.io.threemf.model import Body
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.products.assembly import Assembly
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.beams import BeamLattice


def skeleton_of(pieces: Sequence[Piece]) -> RawSkeleton:
    """Return the beams of all pieces, nothing welded, without vertices that no beam uses.

    What a skeleton does not keep is named in `left_out` and `flat_ends`.

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
        radii.append(_scaled(piece, piece.body.radii))
        first += len(used)
    ends_of_all = np.concatenate(edges)
    of_ends = np.concatenate([np.zeros((0, 2)), *radii])
    points = as_points(np.concatenate(nodes), "nodes")
    assembly = assembly_of(pieces)
    units = dict.fromkeys(piece.body.unit for piece in pieces if len(piece.body.beams))
    return RawSkeleton(
        points,
        ends_of_all,
        edge_radii=of_ends,
        left_out=assembly.beside_beams(),
        flat_ends=assembly.flat_ends,
        unit=" and ".join(units),
    )


def triangles_of(pieces: Sequence[Piece]) -> TriangleMesh:
    """Return the triangles of all pieces, one after the other.

    Raises
    ------
    MeshError
        If a position is not finite.
    """
    return joined_meshes(
        [_mesh(piece, piece.body) for piece in pieces if len(piece.body.triangles)]
    )


def assembly_of(pieces: Sequence[Piece]) -> Assembly:
    """Return the bodies as what they are: beam lattices, with what they are clipped to, and meshes.

    Beams without a length or a radius > 0 are left out, and counted.

    Raises
    ------
    MeshError, SkeletonError
        If a position is not finite.
    """
    lattices = [_lattice(piece) for piece in pieces if len(piece.body.beams)]
    bodies = [piece for piece in pieces if not len(piece.body.beams)]
    meshes = [_mesh(piece, piece.body) for piece in bodies if len(piece.body.triangles)]
    lost = sum(len(piece.body.beams) for piece in pieces)
    lost -= sum(len(one.skeleton.edges) for one in lattices)
    return Assembly([one for one in lattices if len(one.skeleton.edges) or one.mesh], meshes, lost)


def _lattice(piece: Piece) -> BeamLattice:
    body = piece.body
    radii = _scaled(piece, body.radii)
    places = _placed(piece, body.vertices)
    with np.errstate(over="ignore", invalid="ignore"):
        spans = places[body.beams[:, 1]] - places[body.beams[:, 0]]
        sound = (np.linalg.norm(spans, axis=1) > 0) & (radii > 0).all(axis=1)
    used, ends = np.unique(body.beams[sound], return_inverse=True)
    balls = _scaled(piece, body.balls[used])
    return BeamLattice(
        Skeleton(places[used], ends.reshape(-1, 2), edge_radii=radii[sound]),
        np.where(balls > 0, balls, 0.0),
        None if piece.clip is None else _mesh(piece, piece.clip),
        _mesh(piece, body) if len(body.triangles) else None,
        caps=body.caps[sound],
        clipping="outside" if body.clipping == "outside" else "inside",
        representation=None if piece.shown is None else _mesh(piece, piece.shown),
    )


def _mesh(piece: Piece, body: Body) -> TriangleMesh:
    """Return the triangles of a body placed as the piece is, with the vertices that they use."""
    triangles = body.triangles
    if np.linalg.det(piece.transform[:3]) < 0:  # a mirror turns triangles inside out
        triangles = triangles[:, ::-1]
    return compacted(_placed(piece, body.vertices), triangles)


def _placed(piece: Piece, points: Points) -> Floats:
    with np.errstate(over="ignore", invalid="ignore"):
        placed: Floats = points @ piece.transform[:3] + piece.transform[3]
    return placed


def _scaled(piece: Piece, radii: Floats) -> Floats:
    """Return radii under the transform of a piece: times the cube root of its determinant."""
    with np.errstate(over="ignore", invalid="ignore"):
        scaled: Floats = radii * np.cbrt(abs(np.linalg.det(piece.transform[:3])))
    return scaled
