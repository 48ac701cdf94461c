"""Where a closed mesh that is put together from star-shaped bodies meets itself.

The quads of each body and a fan of triangles in every ring of edges where it meets another body
make a closed surface. If all its triangles are seen from the body's center, and together cover the
sphere of directions once, then it does not cross itself, and all that is inside it is seen as well.

Let such bodies A and B share a ring, and let all corners of B lie in a convex cone over the ring
with its tip at the center of A. In this cone A ends at the fan. Of B nothing lies behind the fan,
as the fan is seen from its center: A and B share the ring and nothing else. Two bodies that keep to
such cones of the same A share nothing, as these cones have different rays.

Bodies whose boxes are apart are apart. Whatever is not settled so is left to the exact test.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Ints, Points
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.visibility import in_front, rounding_of, seen
from scaffold_cad.mesh.intersections.search import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import compacted

MOST_HUBS = 4
"""Rings looked at of a body whose cones it keeps to."""

TRIANGLES_AT_ONCE = 1 << 18
RINGS_AT_ONCE = 1 << 13
"""These bound the memory needed."""


@dataclass(frozen=True, eq=False)
class _Rings:
    """Closed lines of edges between two bodies, all of the same number of edges."""

    low: Ints
    high: Ints
    """The two bodies, the one of lower number first, shape (r,)."""
    starts: Ints
    ends: Ints
    """Vertices of the sides of the quads of the first body, shape (r, s)."""
    middles: Points
    """Tips of the fans, shape (r, 3), mm."""


def intersections_of_bodies(mesh: QuadMesh, body: Ints, centers: Points) -> Edges:
    """Return what `self_intersections` does, sooner where a mesh is made of star-shaped bodies.

    Parameters
    ----------
    mesh : closed
    body : (f,) intp, the body that each quad is of, whatever way the mesh is cut
    centers : (b, 3) float64, a point in each body, mm. Of two bodies that meet, the one of
        lower number should be the one that the other one leaves straight from its center

    Returns
    -------
    (k, 2) intp, pairs of rows of `mesh.triangles`, as `self_intersections`
    """
    rings, whole = _rings(mesh, body, len(centers))
    rounding = rounding_of(np.concatenate([mesh.vertices, centers]))
    star_shaped = whole & _star_shaped(mesh, body, centers, rings, rounding)
    held = star_shaped[rings.low] & star_shaped[rings.high]
    held &= _in_cones(mesh, body, centers, rings, rounding)

    doubtful = ~star_shaped
    doubtful[rings.low[~held]] = doubtful[rings.high[~held]] = True
    doubtful[_near_each_other(mesh, body, len(centers), rings, held)] = True
    rows = np.flatnonzero(np.repeat(doubtful[body], 2))
    if len(rows) == 0:
        return np.zeros((0, 2), dtype=np.intp)
    pairs: Edges = rows[self_intersections(compacted(mesh.vertices, mesh.triangles[rows]))]
    return pairs


def _rings(mesh: QuadMesh, body: Ints, count: int) -> tuple[_Rings, Bools]:
    """Return the rings of the commonest size, and the bodies without any other border, (b,)."""
    pair, side = _borders(mesh, body)
    first = np.flatnonzero(np.diff(pair, axis=0, prepend=-1).any(axis=1))
    size = np.diff(first, append=len(pair))
    common = int(np.bincount(size, minlength=1).argmax())
    chosen = np.flatnonzero(size == common)
    sides = mesh.half_edges[side[first[chosen][:, None] + np.arange(common)]]  # (r, s, 2)
    ends = np.sort(sides, axis=1)
    closed = (ends[:, :, 0] == ends[:, :, 1]).all(axis=1)
    chosen, sides = chosen[closed], sides[closed]
    whole = np.ones(count, dtype=np.bool_)
    whole[pair[np.delete(first, chosen)]] = False

    low, high = pair[first[chosen]].T
    middles = mesh.vertices[sides[:, :, 0]].sum(axis=1) / max(common, 1)
    return _Rings(low, high, sides[:, :, 0], sides[:, :, 1], middles), whole


def _borders(mesh: QuadMesh, body: Ints) -> tuple[Edges, Ints]:
    """Return the edges between two bodies, sorted by these.

    Returns
    -------
    (k, 2) intp, the bodies, the lower one first; (k,) intp, the side of a quad of the lower one
    """
    edge, of_side = mesh.edge_of_half_edge, np.repeat(body, 4)
    one = np.empty(len(mesh.edges), dtype=np.intp)
    one[edge] = of_side  # either of the two
    differs = np.zeros(len(mesh.edges), dtype=np.bool_)
    differs[edge[of_side != one[edge]]] = True
    rows = np.flatnonzero(differs[edge])
    sides = rows[np.argsort(edge[rows], kind="stable")].reshape(-1, 2)
    sides = np.take_along_axis(sides, np.argsort(of_side[sides], axis=1), axis=1)
    pairs = of_side[sides]
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    return pairs[order], sides[order, 0]


def _star_shaped(
    mesh: QuadMesh, body: Ints, centers: Points, rings: _Rings, rounding: float
) -> Bools:
    """Return which bodies, closed by the fans, are seen from their centers and only once, (b,)."""
    hidden, angle = np.zeros(len(centers)), np.zeros(len(centers))

    def add(a: Points, b: Points, c: Points, owner: Ints) -> None:
        at = centers[owner]
        visible, angles = seen(a - at, b - at, c - at, rounding)
        hidden[:] += np.bincount(owner, ~visible, minlength=len(centers))
        angle[:] += np.bincount(owner, angles, minlength=len(centers))

    vertices, owner = mesh.vertices, np.repeat(body, 2)
    for part in blocks(len(owner), 1, TRIANGLES_AT_ONCE):
        a, b, c = mesh.triangles[part].T
        add(vertices[a], vertices[b], vertices[c], owner[part])
    sides = rings.starts.shape[1]
    tails, heads = vertices[rings.starts.reshape(-1)], vertices[rings.ends.reshape(-1)]
    tips = np.repeat(rings.middles, sides, axis=0)
    add(heads, tails, tips, np.repeat(rings.low, sides))
    add(tails, heads, tips, np.repeat(rings.high, sides))
    return np.asarray((hidden == 0) & (np.abs(angle - 4 * np.pi) < 1e-3))


def _in_cones(mesh: QuadMesh, body: Ints, centers: Points, rings: _Rings, rounding: float) -> Bools:
    """Return where the second body lies in the convex cone of the first over a ring, (r,)."""
    corners, first, count = _corners_of(mesh, body, rings.high)
    inside = np.zeros(len(rings.low), dtype=np.bool_)
    for part in blocks(len(inside), 1, RINGS_AT_ONCE):
        # As many corners of each body as the largest has, some of them twice.
        high, starts, ends = rings.high[part], rings.starts[part], rings.ends[part]
        number = np.arange(count[high].max()) % count[high][:, None]
        points = corners[first[high][:, None] + number]  # (k, p)
        tip = centers[rings.low[part]][:, None]
        planes = np.cross(mesh.vertices[ends] - tip, mesh.vertices[starts] - tip)  # (k, s, 3)
        fine = in_front(planes, mesh.vertices[points] - tip, rounding)  # (k, p, s)
        fine |= points[:, :, None] == starts[:, None]
        fine |= points[:, :, None] == ends[:, None]
        inside[part] = fine.all(axis=(1, 2))
    return inside


def _corners_of(mesh: QuadMesh, body: Ints, wanted: Ints) -> tuple[Ints, Ints, Ints]:
    """Return the vertices of the bodies `wanted`, the first one of each body, and their counts."""
    is_wanted = np.zeros(int(body.max()) + 1, dtype=np.bool_)
    is_wanted[wanted] = True
    quads = np.flatnonzero(is_wanted[body])
    keys = np.repeat(body[quads], 4) * len(mesh.vertices) + mesh.quads[quads].reshape(-1)
    owner, vertex = np.divmod(np.unique(keys), len(mesh.vertices))
    count = np.bincount(owner, minlength=len(is_wanted))
    return vertex, np.cumsum(count) - count, count


def _near_each_other(mesh: QuadMesh, body: Ints, count: int, rings: _Rings, held: Bools) -> Ints:
    """Return the bodies whose boxes overlap, but for those that a ring or a cone keeps apart."""
    order = np.argsort(body, kind="stable")
    used, first = np.unique(body[order], return_index=True)
    corners = mesh.vertices[mesh.quads[order]]
    low = np.minimum.reduceat(corners.min(axis=1), first)
    high = np.maximum.reduceat(corners.max(axis=1), first)
    joined = np.sort(rings.low * count + rings.high)
    hubs = _hubs(count, rings, held)
    near = [np.zeros(0, dtype=np.intp)]
    for i, j in overlapping_boxes(low, high):
        a, b = used[i], used[j]
        place = np.searchsorted(joined, a * count + b).clip(max=max(len(joined) - 1, 0))
        apart = joined[place] == a * count + b if len(joined) else np.zeros(len(a), dtype=np.bool_)
        apart |= (hubs[a][:, :, None] == hubs[b][:, None]).any(axis=(1, 2))
        near += [a[~apart], b[~apart]]
    return np.unique(np.concatenate(near))


def _hubs(count: int, rings: _Rings, held: Bools) -> Ints:
    """Return up to `MOST_HUBS` bodies in whose cones each body is held, -1 - body for none."""
    hubs = np.repeat(-1 - np.arange(count)[:, None], MOST_HUBS, axis=1)
    low, high = rings.low[held], rings.high[held]
    order = np.argsort(high, kind="stable")
    low, high = low[order], high[order]
    rank = np.arange(len(high)) - np.searchsorted(high, high)
    some = rank < MOST_HUBS
    hubs[high[some], rank[some]] = low[some]
    return hubs
