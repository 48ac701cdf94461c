"""Four sieves on pairs of triangles.

Boxes that overlap; spans along diagonals, which few long thin triangles are wide along;
certificates in rounded numbers that two triangles are apart or that they cross; and, for the few
pairs that rounding leaves open, their intersection in whole numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from scaffold_cad.base.arguments import as_count, as_number, check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Edges, Ints, Points, Triangles
from scaffold_cad.base.blocks import cut
from scaffold_cad.base.boxes import order_in_space, overlapping_neighbors
from scaffold_cad.base.counts import counting
from scaffold_cad.base.threads import in_order
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.intersections.certificates import depth_of, left_open, pierces
from scaffold_cad.mesh.intersections.exact import meet_exactly
from scaffold_cad.mesh.intersections.faces import Faces, boxes_of, diagonal_spans, faces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh

LARGEST_COORDINATE = 1e70
"""Products of four greater lengths would overflow, mm."""

ONE_THREAD = 1 << 15
"""Triangles that are not worth a second thread."""

EXACT_PAIRS_AT_ONCE = 1 << 10
"""Pairs tested in whole numbers before a limit is looked at."""


class Triangulated(Protocol):
    """What has vertices and triangles: a TriangleMesh, a QuadMesh, or the like."""

    @property
    def vertices(self) -> Points:
        """Vertex positions, shape (v, 3), mm."""

    @property
    def triangles(self) -> Triangles:
        """Vertex indices of each triangle, shape (t, 3)."""


@checks_keywords()
def self_intersections(
    mesh: Triangulated,
    *,
    tolerance: float | None = None,
    weld: bool = True,
    limit: int | None = None,
    parts: Ints | None = None,
) -> Edges:
    """Return the pairs of triangles that meet outside the vertices or the edge that they share.

    A triangle is the closed convex hull of its corners: a segment or a point if it has no area.
    Two triangles are a pair if some point of both lies outside the hull of the corners that they
    share. So triangles without a common corner may not even touch; with one, they may share
    nothing else; with two, nothing but the edge between them; and two triangles with the same
    three corners are a pair. Without a tolerance the answer is that of exact arithmetic on the
    float64 coordinates, however close or degenerate the triangles are.

    Parameters
    ----------
    mesh : closed or open, manifold or not
    tolerance : mm, ≥ 0; leave out the pairs that only touch, and those of which one triangle need
        be moved no farther than this for them only to touch. Sheets that a boolean operation
        left on top of each other may cross by rounding errors: 1e-9 leaves these out. Two
        triangles in one plane only touch, so that any tolerance leaves them out
    weld : whether vertices at the very same position are the same corner, so that parts of a
        mesh may touch along equal vertices and edges. If not, corners are the same only where
        their vertex index is, and parts that touch are pairs
    limit : number of pairs after which the search stops, ≥ 1; with 1 it tells whether there are
        any
    parts : (t,) intp; the part that each triangle is of, where only pairs within a part matter

    Returns
    -------
    (k, 2) intp, the lower triangle first, in ascending order

    Raises
    ------
    MeshError
        If the triangles are not a proper array of indices, or a coordinate is too large.
    OptionError
        If `mesh` is not a mesh, or `tolerance` or `limit` is out of its range.

    Notes
    -----
    The cost is O(t log t) and the pairs of triangles with overlapping boxes, of which a vertex of
    valence d brings d²/2.

    Examples
    --------
    >>> from scaffold_cad import TriangleMesh, self_intersections
    >>> flat, upright = [[0, 0, 0], [3, 0, 0], [0, 3, 0]], [[1, 1, -1], [1, 1, 1], [2, 2, 0]]
    >>> self_intersections(TriangleMesh(flat + upright, [[0, 1, 2], [3, 4, 5]]))
    array([[0, 1]])
    """
    if not hasattr(mesh, "triangles"):
        check_kind(mesh, TriangleMesh, "QuadMesh")
    if tolerance is not None:
        tolerance = as_number(tolerance, "tolerance", or_zero=True)
    if limit is not None:
        limit = as_count(limit, "limit", least=1)
    checked = TriangleMesh(mesh.vertices, mesh.triangles)
    _check_size(checked)
    # What is looked up together is then together in the cache.
    order = order_in_space(*boxes_of(checked.vertices[checked.triangles]))
    faces = faces_of(checked, order, weld)
    found = [np.zeros((0, 2), dtype=np.intp)]
    count = 0
    part = np.zeros(len(order), dtype=np.intp) if parts is None else parts[order]
    for block in _meeting_pairs(faces, part, tolerance):
        found.append(block)
        count += len(block)
        if limit is not None and count >= limit:
            break
    pairs = np.sort(order[np.concatenate(found)[:limit]], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def _check_size(mesh: TriangleMesh) -> None:
    far = np.flatnonzero((np.abs(mesh.vertices) > LARGEST_COORDINATE).any(axis=1))
    if len(far):
        place = mesh.vertices[far[0]].tolist()
        raise MeshError(f"vertex {far[0]} is at {place} mm; need at most {LARGEST_COORDINATE:g}")


def _meeting_pairs(faces: Faces, part: Ints, tolerance: float | None) -> Iterator[Edges]:
    """Yield blocks of the pairs of triangles that meet where they may not, shape (k, 2)."""
    diagonals = diagonal_spans(faces.corners)

    def sieved(block: tuple[Ints, Ints]) -> tuple[Edges, Bools]:
        i, j = block
        for spans in diagonals:
            overlap = spans.overlap(i, j)
            i, j = i[overlap], j[overlap]
        return _neither_apart_nor_crossing(faces, part, tolerance, i, j)

    several = len(part) > ONE_THREAD
    with counting("triangles tested for crossings", len(part)) as count:
        blocks = overlapping_neighbors(*boxes_of(faces.corners), count)
        for pairs, sure in (in_order if several else map)(sieved, blocks):
            yield pairs[sure]
            unsure = pairs[~sure]
            for some in cut(unsure, row=1, within=EXACT_PAIRS_AT_ONCE):
                meets = [meet_exactly(faces, i, j) for i, j in some.tolist()]
                yield some[np.array(meets)]


def _neither_apart_nor_crossing(
    faces: Faces, part: Ints, tolerance: float | None, i: Ints, j: Ints
) -> tuple[Edges, Bools]:
    """Return the pairs not surely apart, shape (k, 2), and which of them surely meet, (k,)."""
    together = part[i] == part[j]
    i, j, same = left_open(faces, i[together], j[together])
    if tolerance is not None:
        deep = depth_of(faces, i, j) > tolerance
        i, j, same = i[deep], j[deep], same[deep]
    sure = same | pierces(faces, i, j) | pierces(faces, j, i)
    return np.stack([i, j], axis=1), sure
