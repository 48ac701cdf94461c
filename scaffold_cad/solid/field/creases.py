"""Sharp edges of flat ends: corners of the mesh on them, where cells had cut them off.

A side of a triangle from the plane of a flat end to what is beside that plane crosses a crease: the
end's rim, the rim of ends in one plane with the fillets between them, or the foot of a strut that
stands on the end. The crease is looked for in the plane, by the sign of F just beside it. Sides are
split there, or an end of theirs moves to the crease where it is near, so that no triangle is on
both sides of one. What would cross other triangles stays as it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.solid.field.flatends import FLUSH, Lines, Planes, plane_of, planes_near, planes_of
from scaffold_cad.solid.field.grid import Grid
from scaffold_cad.solid.field.splitting import faulty, split_sides
from scaffold_cad.solid.field.union import FilletedUnion

PAST = 1.5
"""How far creases are looked for, in the lengths of sides of triangles seen across the plane."""

APART = (0.0, 0.03)
"""How far creases are from where sides begin in a plane, at least, in the end's radius: each time
that they are looked for. Sides of a vertex that moved to one may cross another."""

SNAP = 0.5
"""A vertex moves to a crease that is nearer than this, in the length of its side across it."""


AROUND_SIDES = 4.0
"""How far beyond the reach of flat ends triangles may meet those that change, in the length of
the longest side: sides leave that reach by one, the triangles at their ends by another."""


@dataclass(frozen=True, eq=False)
class _Crossings(Frozen):
    """Sides of triangles that cross creases, and where."""

    sides: Edges
    """Vertices of each, shape (s, 2)."""
    places: Points
    """On the crease, shape (s, 3), mm, 32-bit numbers."""


def with_creases(
    union: FilletedUnion, grid: Grid, mesh: TriangleMesh, owners: Ints
) -> TriangleMesh:
    """Return the zero set of F with sharp edges at flat ends.

    Parameters
    ----------
    mesh : the zero set, free of crossings; all coordinates are 32-bit numbers, mm
    owners : (v,) group at each vertex
    """
    planes = planes_of(union)
    if len(planes.tip) == 0:
        return mesh
    near = _near_ends(mesh, planes, union.origin)
    used = np.unique(mesh.triangles[near])
    part, own = compacted(mesh.vertices, mesh.triangles[near]), owners[used]
    for apart in APART:
        found = _crossings(union, grid, part, own, planes, apart)
        if len(found.sides) == 0:
            break
        part, split = _creased(part, found)
        own = np.append(own, own[split[:, 0]])
    vertices, new = mesh.vertices.copy(), part.vertices[len(used) :]
    vertices[used] = part.vertices[: len(used)]
    number = np.append(used, len(vertices) + np.arange(len(new)))
    triangles = [mesh.triangles[~near], number[part.triangles]]
    return TriangleMesh(np.concatenate([vertices, new]), np.concatenate(triangles))


def _near_ends(mesh: TriangleMesh, planes: Planes, origin: Points) -> Bools:
    """Return the triangles that may change, or meet what changes, (t,)."""
    ends = sides_of(mesh.triangles)
    first, second = ends[ends[:, 0] < ends[:, 1]].T  # of a closed mesh: each side once
    longest = float(length(mesh.vertices[first] - mesh.vertices[second]).max())
    tree = cKDTree(mesh.vertices, compact_nodes=False, balanced_tree=False)
    found = tree.query_ball_point(planes.tip + origin, planes.reach + AROUND_SIDES * longest)
    marks = np.zeros(len(mesh.vertices), dtype=np.bool_)
    marks[np.concatenate(found).astype(np.intp)] = True
    return np.asarray(marks[mesh.triangles].any(axis=1))


def _creased(mesh: TriangleMesh, found: _Crossings) -> tuple[TriangleMesh, Edges]:
    """Return a mesh with vertices on creases, and the sides that new ones split, (n, 2)."""
    kept = np.arange(len(found.sides))
    made, side = _with(mesh, found.sides, found.places)
    moved = np.flatnonzero((made.vertices[: len(mesh.vertices)] != mesh.vertices).any(axis=1))
    around = np.append(moved, np.arange(len(mesh.vertices), len(made.vertices)))
    while len(kept):
        bad = faulty(made, around)
        if not bad.any():
            return made, found.sides[kept[side]]
        # Vertices that moved belong to all sides that end there, new ones to those that they split.
        drop: Bools = np.asarray(bad[found.sides[kept]].any(axis=1))
        drop[side] |= bad[len(mesh.vertices) :]
        # That changes triangles around the ends of these sides only.
        around, kept = found.sides[kept[drop]], kept[~drop]
        made, side = _with(mesh, found.sides[kept], found.places[kept])
    return mesh, np.zeros((0, 2), dtype=np.intp)


def _crossings(
    union: FilletedUnion,
    grid: Grid,
    mesh: TriangleMesh,
    owners: Ints,
    planes: Planes,
    apart: float,
) -> _Crossings:
    """Return the sides from planes of ends to what is beside them, and the creases there."""
    vertices = mesh.vertices - union.origin
    parts = _leaving(mesh, vertices, planes), _passing(mesh, vertices, planes)
    ends, plane, start = (np.concatenate(each) for each in zip(*parts, strict=True))
    # One that goes from plane to plane is looked at once.
    keys = ends.min(axis=1) * len(vertices) + ends.max(axis=1)
    first = np.unique(keys, return_index=True)[1]
    ends, plane, start = ends[first], plane[first], start[first]
    off = planes.beyond(vertices[ends[:, 1]], plane)
    lines = Lines(union, grid, planes, plane, np.sign(off), owners[ends[:, 0]])
    start, end = lines.flattened(start), lines.flattened(vertices[ends[:, 1]])
    foot, good = lines.crease(start, PAST * (end - start))
    across = lines.normals(foot, normalize(end - start))
    inward = dot(foot - start, across)
    good &= inward > apart * planes.radius[plane]
    lines, ends, start, foot = lines.chosen(good), ends[good], start[good], foot[good]
    across, inward, off = across[good], inward[good], off[good]
    # Seen along the crease a side is cut where it is nearest to it: not all at the same place.
    share = inward / (inward + np.abs(off))
    middle = start + share[:, None] * (foot - start)
    places, good = lines.crease(middle, 2.0 * inward[:, None] * across)
    return _Crossings(ends[good], in_single_precision(places[good] + union.origin))


def _leaving(mesh: TriangleMesh, vertices: Points, planes: Planes) -> tuple[Edges, Ints, Points]:
    """Return sides that begin in the plane of a flat end, that plane, and where they begin."""
    of = plane_of(vertices, planes)
    ends = sides_of(mesh.triangles[(of[mesh.triangles] >= 0).any(axis=1)])
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[of[ends[:, 0]] >= 0]
    plane = of[ends[:, 0]]
    off = planes.beyond(vertices[ends[:, 1]], plane)
    beside = np.abs(off) > FLUSH * planes.radius[plane]
    ends, plane = ends[beside], plane[beside]
    return ends, plane, vertices[ends[:, 0]]


def _passing(mesh: TriangleMesh, vertices: Points, planes: Planes) -> tuple[Edges, Ints, Points]:
    """Return sides that pass planes of flat ends, downward, the planes, and where they do.

    So do those from what stands on an end to its side where no vertex is between.
    """
    vertex, plane = planes_near(vertices, planes)
    off = planes.beyond(vertices[vertex], plane) / planes.radius[plane]
    above = off > FLUSH
    vertex, plane = vertex[above], plane[above]
    marks = np.zeros(len(vertices), dtype=np.bool_)
    marks[vertex] = True
    ends = sides_of(mesh.triangles[marks[mesh.triangles].any(axis=1)])
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    first, last = (np.searchsorted(ends[:, 0], vertex, side) for side in ("left", "right"))
    count = last - first
    rows = np.arange(count.sum()) + np.repeat(first - np.cumsum(count) + count, count)
    ends, plane = ends[rows], np.repeat(plane, count)
    high, low = (planes.beyond(vertices[column], plane) for column in ends.T)
    below = low < -FLUSH * planes.radius[plane]
    ends, plane, high, low = ends[below], plane[below], high[below], low[below]
    start, end = vertices[ends[:, 0]], vertices[ends[:, 1]]
    start = start + (high / (high - low))[:, None] * (end - start)
    on = length(start - planes.tip[plane]) < planes.radius[plane]
    return ends[on], plane[on], start[on]


def _with(mesh: TriangleMesh, sides: Edges, places: Points) -> tuple[TriangleMesh, Ints]:
    """Return a mesh whose sides go by some places, and the side that each new vertex splits.

    New vertices come last.
    """
    vertices = mesh.vertices.copy()
    far = length(places[:, None] - vertices[sides]) / _shortest(mesh, sides)  # (s, 2)
    order = np.argsort(-far.reshape(-1), kind="stable")
    order = order[far.reshape(-1)[order] < SNAP]
    vertices[sides.reshape(-1)[order]] = places[order // 2]  # the nearest one comes last
    moved = np.zeros(len(vertices), dtype=np.bool_)
    moved[sides.reshape(-1)[order]] = True
    split = np.flatnonzero(~moved[sides].any(axis=1))
    new = len(vertices) + np.arange(len(split))
    vertices = np.concatenate([vertices, places[split]])
    return TriangleMesh(vertices, split_sides(vertices, mesh.triangles, sides[split], new)), split


def _shortest(mesh: TriangleMesh, sides: Edges) -> Floats:
    """Return the shortest side of triangles at each end of some sides, mm, (s, 2)."""
    found = np.full(len(mesh.vertices), -np.inf)
    found[sides] = np.inf
    triangles = mesh.triangles[(found[mesh.triangles] > 0).any(axis=1)]
    ends = sides_of(triangles).T
    size = length(mesh.vertices[ends[0]] - mesh.vertices[ends[1]])
    for end in ends:
        np.minimum.at(found, end, size)
    return np.asarray(found[sides])
