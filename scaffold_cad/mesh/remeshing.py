"""Remeshing: triangle meshes with triangles of one size, and quads cut from these."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    Triangles,
    UnitVectors,
)
from scaffold_cad.base.topology import edges_of_sides, sides_of
from scaffold_cad.base.vectors import dot, length, normalize, sums_by_row
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.collapse import LEAST_TURN, Lengths, lengths_at, without_short_edges
from scaffold_cad.mesh.decimation import decimated
from scaffold_cad.mesh.nearest import NearestPlace
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.sharpedges import SHARP, SharpEdges
from scaffold_cad.mesh.trianglemesh import TriangleMesh

ROUNDS = 8
"""How often edges are split, drawn together and turned, and vertices moved."""

LONGEST, SHORTEST = 4 / 3, 4 / 5
"""Edges are split above and drawn together below these lengths, in wanted ones: halves of an edge
that is split are not drawn together again (Botsch and Kobbelt, A remeshing approach to
multiresolution modeling, 2004)."""

QUAD_SIDE = 2.85
"""Wanted side of triangles, in sides of a square as large as one of the quads that each is cut
into: remeshed triangles come out a little larger than wanted. `python -m
tests.benchmarks.remeshing` measures it."""

FINE = 0.25
"""Sides of triangles, in wanted ones, below which a mesh is first made coarser at once."""

ROUGH = 0.02
"""How far that may move the surface, in wanted sides; its vertices are moved back onto it later."""

EVEN_ACROSS = 60
"""Most triangles along the longest side of a surface whose large ones are cut."""

MOST_TRIANGLES = 2_000_000
"""Most triangles of a remeshed mesh."""


@dataclass(frozen=True, eq=False)
class Remeshed(Frozen):
    """A surface with triangles of another size, and what they were fitted to."""

    mesh: TriangleMesh
    """The new triangles."""
    surface: NearestPlace
    """The old surface."""
    sharp: SharpEdges
    """Its edges at 60° or more."""


def quadrangulated(mesh: TriangleMesh, size: Lengths) -> QuadMesh:
    """Return the surface in quads about as large as squares of `size` mm, or that at their places.

    It is remeshed with triangles of one size, and each is cut into three quads.
    """
    side = size if callable(size) else as_number(size, "size of quads")
    even = remeshed(mesh, _times(QUAD_SIDE, side))
    quads = three_quads_each(even.mesh)
    normals = _vertex_normals(quads.vertices, quads.triangles)
    edges, of_side = _edges(even.mesh.triangles)
    runs = even.sharp.runs(even.mesh)
    run = runs.of(edges)
    count, centers = len(even.mesh.vertices), len(even.mesh.vertices) + len(edges)
    vertices = quads.vertices.copy()
    middles = vertices[count:centers]  # a view
    middles[run >= 0] = runs.middles[run[run >= 0]]
    vertices[centers:] = middles[of_side].mean(axis=1)  # they give way to arcs
    places = even.surface.nearest(vertices, normals)
    places[count:centers][run >= 0] = middles[run >= 0]
    return quads.moved(places)


def evened(mesh: TriangleMesh) -> TriangleMesh:
    """Return the very same surface with large triangles cut until most are of about one size."""
    corners = mesh.vertices[mesh.triangles]
    extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    sides = length(corners - np.roll(corners, 1, axis=1))
    return split_to(mesh, max(float(np.median(sides)), extent / EVEN_ACROSS))


def three_quads_each(mesh: TriangleMesh) -> QuadMesh:
    """Return each triangle cut into three quads, from its middle to those of its sides."""
    rows = mesh.triangles
    edges, of_side = _edges(rows)
    count = len(mesh.vertices)
    middle = count + of_side  # (t, 3), of side k from corner k to the next
    centers = count + len(edges) + np.arange(len(rows))
    quads = [
        np.stack([rows[:, k], middle[:, k], centers, middle[:, k - 1]], axis=1) for k in range(3)
    ]
    vertices = np.concatenate(
        [
            mesh.vertices,
            mesh.vertices[edges].mean(axis=1),
            mesh.vertices[rows].mean(axis=1),
        ]
    )
    return QuadMesh(vertices, np.stack(quads, axis=1).reshape(-1, 4))


def remeshed(mesh: TriangleMesh, size: Lengths) -> Remeshed:
    """Return the surface with triangles whose sides are about `size` long.

    Vertices stay on the old surface; open borders are kept, and so are edges of the shape at 60° or
    more; others are rounded by a fraction of `size`.

    Parameters
    ----------
    mesh : closed or open, each edge in one triangle or two
    size : wanted length of sides, > 0, mm, or that at places

    Raises
    ------
    MeshError
        If the mesh has no area, or would have more than two million triangles.
    """
    areas = length(_double_areas(mesh.vertices, mesh.triangles)) / 2
    if not areas.sum() > 0:
        raise MeshError("the mesh has no area; need one to remesh it")
    sides = lengths_at(size, mesh.vertices[mesh.triangles].mean(axis=1))
    if float((areas / (sides**2 * 0.433)).sum()) > MOST_TRIANGLES:
        raise MeshError(
            f"triangles of {np.min(sides):g} mm on a surface of {areas.sum():.4g} mm²: more than "
            f"{MOST_TRIANGLES}; need larger ones"
        )
    is_open = len(mesh.faulty_sides()[1]) > 0
    even = split_to(mesh, size)
    target, sharp = NearestPlace(even), SharpEdges(even)
    mesh = _coarser(mesh, size, sharp)
    for _ in range(ROUNDS):
        mesh = split_to(mesh, _times(LONGEST, size), sharp)
        least = _times(SHORTEST, size)
        longest = _times(LONGEST, size)
        mesh = without_short_edges(
            mesh, least, is_open=is_open, order=sharp.ordered, longest=longest
        )
        mesh = _turned(_turned(mesh, sharp), sharp)
        mesh = _relaxed(mesh, target, sharp)
    return Remeshed(mesh, target, sharp)


def _coarser(mesh: TriangleMesh, size: Lengths, sharp: SharpEdges) -> TriangleMesh:
    """Return a mesh of many triangles for one wanted with fewer, near it, to begin with."""
    sides = np.broadcast_to(lengths_at(size, mesh.vertices), len(mesh.vertices))
    corners = mesh.vertices[mesh.triangles]
    own = np.sqrt(length(_double_areas(mesh.vertices, mesh.triangles)).mean())
    if len(corners) == 0 or own > FINE * float(np.median(sides)):
        return mesh
    return decimated(mesh, ROUGH * sides, np.flatnonzero(sharp.on(mesh.vertices)))


def _times(factor: float, size: Lengths) -> Lengths:
    """Return `factor` times a length."""
    if not callable(size):
        return factor * size
    return lambda points: factor * size(points)


def split_to(mesh: TriangleMesh, longest: Lengths, sharp: SharpEdges | None = None) -> TriangleMesh:
    """Return the mesh with edges halved until none is longer than `longest` at its middle.

    Middles of edges along sharp ones are moved onto these.
    """
    while True:
        edges, of_side = _edges(mesh.triangles)
        ends = mesh.vertices[edges]  # (e, 2, 3)
        spans, middles = length(np.diff(ends, axis=1)[:, 0]), ends.mean(axis=1)
        if sharp is not None:
            runs = sharp.runs(mesh)
            run = runs.of(edges)
            along = run >= 0
            spans[along], middles[along] = runs.lengths[run[along]], runs.middles[run[along]]
        long = spans > lengths_at(longest, middles)
        if not long.any():
            return mesh
        middle = len(mesh.vertices) + np.cumsum(long) - 1
        vertices = np.concatenate([mesh.vertices, middles[long]])
        new = np.where(long, middle, -1)[of_side]  # (t, 3)
        mesh = TriangleMesh(vertices, _halved(mesh.triangles, new))


def _halved(rows: Triangles, middles: Ints) -> Triangles:
    """Return triangles (t, 3) cut at the middles of their sides, -1 for those not cut."""
    cut = middles >= 0
    count = cut.sum(axis=1)
    # Corner 0 first: one cut is on its side; with two, it is between them.
    first = np.where(count == 1, cut.argmax(axis=1), (~cut).argmax(axis=1) + 1) % 3
    turn = (np.arange(3) + first[:, None]) % 3
    a, b, c = np.take_along_axis(rows, turn, axis=1).T
    ab, bc, ca = np.take_along_axis(middles, turn, axis=1).T
    none, one, two, three = (count == k for k in range(4))
    parts = [
        (none, (a, b, c)),
        (one, (a, ab, c)),
        (one, (ab, b, c)),
        # Sides ab and ca are cut or, with the uncut one before corner 0, ab and bc.
        (two, (ab, b, bc)),
        (two, (a, ab, bc)),
        (two, (a, bc, c)),
        (three, (a, ab, ca)),
        (three, (ab, b, bc)),
        (three, (ca, bc, c)),
        (three, (ab, bc, ca)),
    ]
    return np.concatenate([np.stack(corners, axis=1)[chosen] for chosen, corners in parts])


def _turned(mesh: TriangleMesh, sharp: SharpEdges) -> TriangleMesh:
    """Return the mesh with edges turned where the angles that face them are more than π together.

    Edges of the shape stay, and so do those beside one that is turned.
    """
    rows = mesh.triangles
    edges, of_side = _edges(rows)
    sides, partner = _facing(of_side, len(edges))
    one, other = sides // 3, partner // 3
    a, b = (rows.reshape(-1)[_next(sides, k)] for k in (0, 1))
    c, d = rows.reshape(-1)[_next(sides, 2)], rows.reshape(-1)[_next(partner, 2)]
    p, q, r, s = (mesh.vertices[k] for k in (a, b, c, d))
    angles = _angle(r, p, q) + _angle(s, q, p)
    normals = normalize(_double_areas(mesh.vertices, rows) + np.finfo(float).tiny)
    is_run = sharp.runs(mesh).of(np.stack([a, b], axis=1)) >= 0
    flat = (dot(normals[one], normals[other]) > SHARP) & ~is_run
    # Both new triangles face the way the old ones do.
    ahead = normals[one] + normals[other]
    proper = (dot(np.cross(s - r, q - r), ahead) > 0) & (dot(np.cross(p - r, s - r), ahead) > 0)
    known = np.sort(edges[:, 0] * len(mesh.vertices) + edges[:, 1])
    key = np.minimum(c, d) * len(mesh.vertices) + np.maximum(c, d)
    is_new = known[np.minimum(np.searchsorted(known, key), len(known) - 1)] != key
    wanted = np.flatnonzero((angles > np.pi + 1e-6) & flat & proper & is_new & (c != d))
    wanted = wanted[np.argsort(-angles[wanted], kind="stable")]
    chosen = wanted[_apart(rows[np.stack([one, other], axis=1)[wanted]].reshape(-1, 6))]
    turned = rows.copy()
    turned[one[chosen]] = np.stack([c, d, b], axis=1)[chosen]
    turned[other[chosen]] = np.stack([d, c, a], axis=1)[chosen]
    return TriangleMesh(mesh.vertices, turned)


def _apart(corners: Ints) -> Bools:
    """Return which rows of vertices (k, 6) share none with an earlier one that stays, (k,)."""
    taken: set[int] = set()
    keep = np.zeros(len(corners), dtype=np.bool_)
    for k, row in enumerate(corners.tolist()):
        if taken.isdisjoint(row):
            taken.update(row)
            keep[k] = True
    return keep


def _relaxed(mesh: TriangleMesh, target: NearestPlace, sharp: SharpEdges) -> TriangleMesh:
    """Return the mesh with its inner vertices in the middle of their neighbors, on the target."""
    edges, of_side = _edges(mesh.triangles)
    uses = np.bincount(of_side.reshape(-1), minlength=len(edges))
    held = sharp.on(mesh.vertices)
    held[edges[uses == 1]] = True
    ends = np.concatenate([edges, edges[:, ::-1]])
    valency = np.bincount(ends[:, 0], minlength=len(held))
    around = sums_by_row(mesh.vertices[ends[:, 1]], ends[:, 0], len(held))
    around /= np.maximum(valency, 1)[:, None]
    normals = _vertex_normals(mesh.vertices, mesh.triangles)
    step = around - mesh.vertices
    moved = mesh.vertices + 0.7 * (step - dot(step, normals)[:, None] * normals)
    moved = target.nearest(moved, normals)
    held |= sharp.on(moved)
    return _without_turning(mesh, np.where(held[:, None], mesh.vertices, moved))


def _without_turning(mesh: TriangleMesh, moved: Points) -> TriangleMesh:
    """Return the mesh with its vertices moved, but those of triangles that this turns by much."""
    before = normalize(_double_areas(mesh.vertices, mesh.triangles) + np.finfo(float).tiny)
    while True:
        after = normalize(_double_areas(moved, mesh.triangles) + np.finfo(float).tiny)
        turned = mesh.triangles[dot(before, after) < LEAST_TURN]
        if (moved[turned] == mesh.vertices[turned]).all():
            return TriangleMesh(moved, mesh.triangles)
        moved = moved.copy()
        moved[turned] = mesh.vertices[turned]


def _vertex_normals(vertices: Points, triangles: Triangles) -> UnitVectors:
    """Return the unit normal at each vertex, the mean of its triangles' by area, (v, 3)."""
    areas = np.repeat(_double_areas(vertices, triangles), 3, axis=0)
    total = sums_by_row(areas, triangles.reshape(-1), len(vertices))
    return normalize(total + np.finfo(float).tiny)


def _edges(rows: Triangles) -> tuple[Edges, Ints]:
    """Return the edges, lower vertex first (e, 2), and that of each side (t, 3)."""
    edges, of_side = edges_of_sides(sides_of(rows))
    return edges, of_side.reshape(-1, 3)


def _facing(of_side: Ints, count: int) -> tuple[Ints, Ints]:
    """Return the two sides, triangle · 3 + side, of each edge that has two, both (k,)."""
    flat = of_side.reshape(-1)
    order = np.argsort(flat, kind="stable")
    uses = np.bincount(flat, minlength=count)
    if uses.max() > 2:
        raise MeshError("an edge has more than two triangles; need a surface")
    first = (np.cumsum(uses) - uses)[uses == 2]
    return order[first], order[first + 1]


def _next(sides: Ints, step: int) -> Ints:
    return sides // 3 * 3 + (sides % 3 + step) % 3


def _angle(corner: Points, a: Points, b: Points) -> Floats:
    """Return the angle at `corner` between `a` and `b`, shape (n,), rad."""
    u, v = a - corner, b - corner
    return np.arctan2(length(np.cross(u, v)), dot(u, v))


def _double_areas(vertices: Points, rows: Triangles) -> Floats:
    """Return normals as long as twice the triangles' areas, (t, 3), mm²."""
    a, b, c = (vertices[rows[:, k]] for k in range(3))
    return np.cross(b - a, c - a)
