"""Closed meshes of any origin as bodies: faults are mended, or named with their place."""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Triangles, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels, edges_of_sides, sides_of
from scaffold_cad.base.vectors import any_perpendicular, dot, normalize
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh, cone_volumes
from scaffold_cad.mesh.welding import welded, without_repeated_corners

SAME_ANGLE = 1e-9
"""Angle at an edge, rad, below which two triangles are in one plane, as faces on each other are."""

_log = logging.getLogger(__name__)


def body_of(mesh: TriangleMesh) -> TriangleMesh:
    """Return a mesh as a body: corners at one place welded, closed, its outside outside.

    Where bodies touch along an edge each has its own vertices. What is inside out is turned, and
    the log says so.

    Parameters
    ----------
    mesh : triangles, those of a file such as STL with their own corners or not

    Raises
    ------
    MeshError
        If the surface is not closed; the place is named in mm.
    """
    mesh = without_repeated_corners(welded(mesh))
    check_balanced(mesh)
    return turned_outwards(parted(mesh))


def check_balanced(mesh: TriangleMesh) -> None:
    """Raise unless triangles run along each edge as often one way as the other.

    Raises
    ------
    MeshError
        If there is no triangle, or a hole; the place is named in mm.
    """
    if len(mesh.triangles) == 0:
        raise MeshError("the body has no triangles; need at least 4 for a closed surface")
    edges, of_side, forward = _edges(mesh.triangles)
    balance = np.bincount(of_side, weights=np.where(forward, 1.0, -1.0), minlength=len(edges))
    open_edges = edges[balance != 0]
    if len(open_edges):
        start, end = (place_text(corner) for corner in mesh.vertices[open_edges[0]])
        raise MeshError(
            f"the body's surface is open: no triangle runs along the edge from {start} to {end} "
            f"({len(open_edges)} such edges); need a closed surface"
        )


def parted(mesh: TriangleMesh) -> TriangleMesh:
    """Return a balanced mesh with vertices of their own for parts that touch along an edge.

    Of the four or more triangles around such an edge those are neighbors that have material
    between them. Vertices at which parts touch are parted too.
    """
    edges, of_side, forward = _edges(mesh.triangles)
    uses = np.bincount(of_side, minlength=len(edges))
    if not (uses > 2).any():
        return mesh
    order = np.argsort(of_side, kind="stable")
    first = (np.cumsum(uses) - uses)[uses == 2]
    pairs = [np.stack([order[first], order[first + 1]], axis=1)]
    crowded = np.flatnonzero(uses > 2)
    starts = np.cumsum(uses) - uses
    for edge in crowded.tolist():
        sides = order[starts[edge] : starts[edge] + uses[edge]]
        pairs.append(_with_material_between(mesh, edges[edge], sides, forward[sides]))
    _log.info(
        "the body touches itself along %s; its parts are taken apart", counted(len(crowded), "edge")
    )
    return _split_at(mesh, np.concatenate(pairs))


def turned_outwards(mesh: TriangleMesh) -> TriangleMesh:
    """Return a closed mesh whose shells are not inside out; the log says which were turned.

    A shell of negative volume is a cavity if there is material around it, and inside out if not.
    """
    if mesh.signed_volume < 0:
        near = place_text(mesh.vertices[mesh.triangles[0]].mean(axis=0))
        _log.warning("the body is inside out, as at %s; it is turned", near)
        mesh = TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1])
    shell = shells_of(mesh.triangles, len(mesh.vertices))
    volume = np.bincount(shell, weights=cone_volumes(mesh.vertices, mesh.triangles))
    wrong = np.zeros(len(volume), dtype=np.bool_)
    for number in np.flatnonzero(volume < 0).tolist():
        rows = np.flatnonzero(shell == number)
        place, outward = _outermost(mesh.vertices, mesh.triangles[rows])
        others = mesh.vertices[mesh.triangles[shell != number]]
        wrong[number] = winding_number(place + 1e-9 * outward, others) < 1
        if wrong[number]:
            _log.warning(
                "a shell of the body is inside out, as at %s; it is turned", place_text(place)
            )
    if not wrong.any():
        return mesh
    turn = wrong[shell]
    return TriangleMesh(
        mesh.vertices, np.where(turn[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    )


def check_uncrossed(mesh: TriangleMesh) -> None:
    """Raise if a body crosses itself.

    Raises
    ------
    MeshError
        If it does; the place is named in mm.
    """
    crossings = self_intersections(mesh, tolerance=1e-9, limit=1)
    if len(crossings) > 0:
        raise MeshError(
            f"the body crosses itself near {_crossing_place(mesh, crossings[0])}; need a "
            "surface that does not"
        )


def report_crossed(mesh: TriangleMesh, tolerance: float) -> None:
    """Warn in the log if a shell crosses itself deeper than a tolerance, mm.

    Shells that cross others are a union, and not a fault.
    """
    crossings = self_intersections(mesh, tolerance=tolerance)  # (k, 2)
    shell = shells_of(mesh.triangles, len(mesh.vertices))
    crossings = crossings[shell[crossings[:, 0]] == shell[crossings[:, 1]]]
    if len(crossings) > 0:
        _log.warning(
            "the body crosses itself near %s; what its surface winds around is taken as inside",
            _crossing_place(mesh, crossings[0]),
        )


def _crossing_place(mesh: TriangleMesh, pair: Ints) -> str:
    """Return about where two triangles (2,) cross."""
    one, other = (mesh.vertices[mesh.triangles[k]] for k in pair)
    low = np.maximum(one.min(axis=0), other.min(axis=0))
    high = np.minimum(one.max(axis=0), other.max(axis=0))
    return place_text((low + high) / 2)


def shells_of(triangles: Triangles, count: int) -> Ints:
    """Return the connected part of each triangle, numbered from 0, shape (t,)."""
    sides = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    label = component_labels(sides, count)[triangles[:, 0]]
    _, shell = np.unique(label, return_inverse=True)
    return shell.reshape(-1)


def winding_number(place: Points, corners: Floats) -> int:
    """Return how often triangles (t, 3, 3) wind around a place (3,), by their solid angles."""
    a, b, c = (corners[:, k] - place for k in range(3))
    la, lb, lc = (np.sqrt(dot(one, one)) for one in (a, b, c))
    volume = dot(a, np.cross(b, c))
    # Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return round(float(2 * np.arctan2(volume, below).sum() / (4 * np.pi)))


def _outermost(vertices: Points, triangles: Triangles) -> tuple[Points, Points]:
    """Return the place of a shell furthest along x, and the direction x scaled by its size."""
    points = vertices[triangles].reshape(-1, 3)
    size = float(np.ptp(points, axis=0).max())
    return points[points[:, 0].argmax()], np.array([size, 0.0, 0.0])


def _edges(triangles: Triangles) -> tuple[Edges, Ints, Bools]:
    """Return the edges (e, 2), lower vertex first, that of each side, and whether it runs so."""
    sides = sides_of(triangles)
    return *edges_of_sides(sides), sides[:, 0] < sides[:, 1]


def _with_material_between(mesh: TriangleMesh, edge: Ints, sides: Ints, forward: Bools) -> Edges:
    """Return pairs of sides at an edge that bound the same wedge of material, (k, 2)."""
    a, b = mesh.vertices[edge]
    along = normalize(b - a)
    opposite = mesh.triangles[sides // 3, (sides % 3 + 2) % 3]
    spokes = mesh.vertices[opposite] - a
    x = any_perpendicular(along[None])[0]
    angle = np.arctan2(spokes @ np.cross(along, x), spokes @ x)
    # Material is on the far side, in the sense of turning, of triangles that run backwards, and
    # on the near side of those that run forwards: each of these closes the wedge opened last.
    # Where faces lie on each other, one wedge is closed before the next is opened.
    order = np.lexsort([~forward, _planes(angle)])
    depth = np.cumsum(np.where(forward[order], -1, 1))
    order = np.roll(order, -(int(depth.argmin()) + 1))
    opened: list[int] = []
    pairs = []
    for k in order.tolist():
        if forward[k]:
            pairs.append((int(sides[opened.pop()]), int(sides[k])))
        else:
            opened.append(k)
    return np.asarray(pairs, dtype=np.intp)


def _planes(angles: Floats) -> Ints:
    """Return the number of the half plane of each angle, in their order around an edge, (k,)."""
    order = np.argsort(angles, kind="stable")
    gaps = np.diff(angles[order], append=angles[order[0]] + 2 * np.pi)
    order = np.roll(order, -(int(gaps.argmax()) + 1))  # no plane is on both sides of the start
    turned = np.mod(angles[order] - angles[order[0]], 2 * np.pi)
    planes = np.zeros(len(angles), dtype=np.intp)
    planes[order] = np.cumsum(np.diff(turned, prepend=turned[0]) > SAME_ANGLE)
    return planes


def _split_at(mesh: TriangleMesh, pairs: Edges) -> TriangleMesh:
    """Return the mesh whose triangles share vertices only across paired sides (p, 2)."""
    rows = mesh.triangles
    one, other = pairs.T
    # Corners of a triangle are numbered as its sides: a side goes from its corner to the next.
    after_one, after_other = (side // 3 * 3 + (side % 3 + 1) % 3 for side in (one, other))
    flat = rows.reshape(-1)
    same_way = flat[one] == flat[other]
    ends = np.concatenate(
        [
            np.stack([one, np.where(same_way, other, after_other)], axis=1),
            np.stack([after_one, np.where(same_way, after_other, other)], axis=1),
        ]
    )
    label = component_labels(ends, len(flat))
    _, first, corner = np.unique(label, return_index=True, return_inverse=True)
    return TriangleMesh(mesh.vertices[flat[first]], corner.reshape(-1, 3))
