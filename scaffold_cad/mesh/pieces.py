"""The connected surfaces of a closed mesh: bodies, and voids in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.mesh.bodies import winding_number
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted, cone_volumes


@dataclass(frozen=True, eq=False)
class Pieces(Frozen):
    """Connected surfaces of a mesh."""

    piece_of: Ints
    """Surface of each vertex, shape (v,)."""
    volumes: Floats
    """Volume inside each surface, shape (p,), mm³; < 0 where it bounds a void."""


def pieces_of(mesh: TriangleMesh) -> Pieces:
    """Return the connected surfaces of a closed mesh, whose vertices are all used."""
    corners = mesh.triangles.astype(np.int32)
    ends = np.concatenate([corners[:, :2], corners[:, 1:]])  # (2 t, 2)
    count = len(mesh.vertices)
    marks = np.ones(len(ends), dtype=np.int8)
    graph = coo_array((marks, (ends[:, 0], ends[:, 1])), shape=(count, count)).tocsr()
    pieces, marked = connected_components(graph, directed=False)
    labels = marked.astype(np.intp)  # (v,)
    cones = cone_volumes(mesh.vertices, mesh.triangles)
    volumes = sums_by_row(cones, labels[corners[:, 0]], pieces)
    return Pieces(labels, volumes)


def without_voids(
    mesh: TriangleMesh, middles: Points | None = None
) -> tuple[TriangleMesh, list[float]]:
    """Return a closed mesh with its enclosed voids filled, and the volumes of these, mm³.

    A void that holds a body of its own stays.

    Parameters
    ----------
    middles : (m, 3) float64, mm; of the struts that a field is the surface of. Bodies that are
        around none of them are crumbs, as where cells are wider than a sharp rim: they go, too
    """
    pieces = pieces_of(mesh)
    voids, bodies = np.flatnonzero(pieces.volumes < 0), np.flatnonzero(pieces.volumes > 0)
    if len(pieces.volumes) == 1:
        return mesh, []
    low, high = _boxes(mesh, pieces)
    crumbs = bodies[:0]
    if middles is not None and len(bodies) > 1:
        crumbs = bodies[~_around(low[bodies], high[bodies], middles)]
        bodies = np.setdiff1d(bodies, crumbs)
    after = (low[voids, None] <= low[bodies]).all(axis=2)  # (voids, bodies)
    before = (high[bodies] <= high[voids, None]).all(axis=2)
    filled = voids[~np.logical_and(after, before).any(axis=1)]
    if len(filled) + len(crumbs) == 0:
        return mesh, []
    gone = np.isin(np.arange(len(pieces.volumes)), np.append(filled, crumbs))
    return without_pieces(mesh, pieces, gone), (-pieces.volumes[filled]).tolist()


def without_bodies(mesh: TriangleMesh, pieces: Pieces, gone: Bools) -> TriangleMesh:
    """Return a closed mesh without the bodies marked in `gone` (p,), nor the voids in them."""
    low, high = _boxes(mesh, pieces)
    voids, bodies = np.flatnonzero(pieces.volumes < 0), np.flatnonzero(gone)
    after = (low[voids, None] >= low[bodies]).all(axis=2)  # (voids, bodies)
    before = (high[voids, None] <= high[bodies]).all(axis=2)
    marked = gone.copy()
    piece_of = pieces.piece_of[mesh.triangles[:, 0]]  # (t,)
    # A box that holds another tells too little: crumbs may lie around a part of the rest.
    for row, column in np.argwhere(np.logical_and(after, before)).tolist():
        place = mesh.vertices[np.argmax(pieces.piece_of == voids[row])]
        around = mesh.vertices[mesh.triangles[piece_of == bodies[column]]]
        marked[voids[row]] |= winding_number(place, around) > 0
    return without_pieces(mesh, pieces, marked)


def without_pieces(mesh: TriangleMesh, pieces: Pieces, gone: Bools) -> TriangleMesh:
    """Return a mesh without the surfaces marked in `gone` (p,)."""
    return compacted(mesh.vertices, mesh.triangles[~gone[pieces.piece_of[mesh.triangles[:, 0]]]])


def _around(low: Floats, high: Floats, points: Points) -> Bools:
    """Return which boxes (b, 3) hold one of some points (m, 3), (b,)."""
    found = np.zeros(len(low), dtype=np.bool_)
    both = np.concatenate([low, points]), np.concatenate([high, points])
    for box, other in overlapping_boxes(*both):
        found[box[(box < len(low)) & (other >= len(low))]] = True
    return found


def _boxes(mesh: TriangleMesh, pieces: Pieces) -> tuple[Floats, Floats]:
    """Return the lowest and highest corner of each piece, (p, 3), mm."""
    low = np.full((len(pieces.volumes), 3), np.inf)
    high = -low
    np.minimum.at(low, pieces.piece_of, mesh.vertices)
    np.maximum.at(high, pieces.piece_of, mesh.vertices)
    return low, high
