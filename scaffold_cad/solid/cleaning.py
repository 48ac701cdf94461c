"""The surfaces of unions as files hold them: closed, without crossings, touching nowhere.

Readers of files without indices, such as STL, take vertices at one place for one. Where a surface
touches itself at a vertex or along edges, that makes vertices where several sheets meet and edges
of four triangles. So the sheets are parted there: each vertex is drawn a little toward its own
neighbors.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Points, place_text
from scaffold_cad.base.positions import equal_positions, in_single_precision, single_steps
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels, sides_of
from scaffold_cad.base.vectors import length, sums_by_row
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.collapse import without_short_edges
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.intersections.faces import boxes_of
from scaffold_cad.mesh.necks import without_necks
from scaffold_cad.mesh.pieces import pieces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.mesh.welding import with_fans_apart
from scaffold_cad.solid import manifolds

if TYPE_CHECKING:
    from manifold3d import Manifold

SINGLE_PRECISION = 2.0**-22
"""Least length of an edge after a union, in greatest coordinates: 2 to 4 steps of 32 bits.

What is thinner goes, so more of them would take struts that files can hold."""

MENDINGS = (8.0, 32.0, 256.0)
"""Lengths of edges that are drawn together where a union crosses itself, in least lengths, in
turn."""

LEAST_THICKNESS = 1.0
"""Least mean thickness of a shell, in steps of 32-bit coordinates: vertices are off by half one."""

MOST_BOXES = 100
"""With more places that were changed all triangles are looked at again."""

PARTINGS = (1e-5, 1e-6)
"""How far vertices are moved where a surface touches itself, in greatest coordinates, in turn: the
first that leaves no crossing is taken."""

MOST_OF_EDGE = 0.25
"""How far at most, in lengths of the shortest edge there."""

FLAT = 1e-3
"""A vertex whose neighbors' mean is as near as this, in lengths of edges, stays: its sheet is flat,
and the other one moves."""

_log = logging.getLogger(__name__)


class FaultySurfaceError(MeshError):
    """A surface that is not that of a solid, and where."""

    def __init__(self, message: str, places: Points) -> None:
        super().__init__(message)
        self.places = places
        """Points near the faults, shape (k, 3), mm; none where they are not known."""


def clean_surface(manifold: Manifold, factor: float = 1.0) -> TriangleMesh:
    """Return the surface of a union in 32-bit coordinates, as files hold it, in their lengths.

    Edges and slivers that these cannot hold, which would be written with two ends at one place or
    turned over, are drawn together before; what that leaves of cracks and crests goes; where it
    touches itself, it is parted, and the log says by how much.

    Parameters
    ----------
    factor : what lengths are multiplied with in a file

    Raises
    ------
    FaultySurfaceError
        If it crosses itself, does not stay closed in 32-bit coordinates, or cannot be parted.
    """
    manifold = manifold.scale((factor, factor, factor))
    low, high = np.reshape(manifold.bounding_box(), (2, 3))
    extent = float(np.abs([low, high]).max())
    least = SINGLE_PRECISION * extent
    mesh = manifolds.manifold_triangles(manifold.simplify(least))
    mesh = without_short_edges(mesh, least)
    written = mesh.single_precision()
    try:
        written.check_closed()
    except MeshError as error:
        places = written.vertices[np.concatenate(written.faulty_sides())[:, 0]]
        message = f"does not stay closed in 32-bit coordinates: {error}"
        raise FaultySurfaceError(message, places) from None
    if len(written.triangles) < len(mesh.triangles):  # vertices have become one
        written = with_fans_apart(written)
    return parted(_uncrossed(written, least), extent, factor)


def _uncrossed(mesh: TriangleMesh, least: float) -> TriangleMesh:
    """Return a closed mesh without crossings: edges where it crosses itself are drawn together.

    What crosses once it is rounded are slivers, whose short sides are a few roundings long.

    Parameters
    ----------
    least : shortest of the edges, mm

    Raises
    ------
    FaultySurfaceError
        If it crosses itself where no edges are short.
    """
    mesh = without_flakes(mesh)
    crossings = self_intersections(mesh)
    for longer in MENDINGS:
        if len(crossings) == 0:
            return mesh
        near = np.zeros(len(mesh.vertices), dtype=np.bool_)
        near[mesh.triangles[crossings]] = True
        near[mesh.triangles[near[mesh.triangles].any(axis=1)]] = True
        low, high = _boxes_around(mesh, near)
        mesh = without_necks(mesh, longer * least, near)
        near = np.append(near, np.ones(len(mesh.vertices) - len(near), dtype=np.bool_))
        mesh = without_flakes(without_short_edges(mesh, longer * least, near=near))
        crossings = _crossings_within(mesh, low, high)
    if len(crossings) == 0:
        return mesh
    places = mesh.vertices[mesh.triangles[crossings[:, 0]]].mean(axis=1)
    raise FaultySurfaceError(f"crosses itself in {counted(len(crossings), 'place')}", places)


def without_flakes(mesh: TriangleMesh) -> TriangleMesh:
    """Return a closed mesh without the shells that 32-bit coordinates give no thickness.

    They are all that is left of a crack or a crest whose edges were drawn together: rounding would
    make a body of a void, or two triangles that are each other's back.
    """
    pieces = pieces_of(mesh)
    if len(pieces.volumes) < 2:
        return mesh
    shell = pieces.piece_of[mesh.triangles[:, 0]]  # (t,)
    corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = sums_by_row(length(normals) / 2.0, shell, len(pieces.volumes))
    step = np.zeros(len(areas))
    np.maximum.at(step, pieces.piece_of, single_steps(mesh.vertices))
    # A plate has half its area on each side.
    flat = 2.0 * np.abs(pieces.volumes) < LEAST_THICKNESS * step * areas
    if not flat.any():
        return mesh
    return compacted(mesh.vertices, mesh.triangles[~flat[shell]])


def _boxes_around(mesh: TriangleMesh, near: Bools) -> tuple[Points, Points]:
    """Return boxes around the triangles at the vertices `near` (v,), one for each connected part.

    Returns
    -------
    (b, 3) float64, mm; (b, 3) float64, mm, the lowest and highest corners
    """
    touched = mesh.triangles[near[mesh.triangles].any(axis=1)]
    label = component_labels(touched[:, [0, 1, 1, 2]].reshape(-1, 2), len(mesh.vertices))
    place, box = np.unique(label[touched], return_inverse=True)
    low, high = np.full((2, len(place), 3), np.inf)
    np.minimum.at(low, box.reshape(-1), mesh.vertices[touched].reshape(-1, 3))
    np.minimum.at(high, box.reshape(-1), -mesh.vertices[touched].reshape(-1, 3))
    return low, -high


def _crossings_within(mesh: TriangleMesh, low: Points, high: Points) -> Edges:
    """Return the pairs of triangles that meet where they may not, of those that reach into boxes.

    Parameters
    ----------
    low, high : (b, 3) float64, mm; what changed since the last test is in one of these boxes
    """
    if len(low) > MOST_BOXES:
        return self_intersections(mesh)
    lowest, highest = boxes_of(mesh.vertices[mesh.triangles])
    inside = np.zeros(len(lowest), dtype=np.bool_)
    for least, most in zip(low, high, strict=True):
        inside |= ((lowest <= most) & (highest >= least)).all(axis=1)
    rows = np.flatnonzero(inside)
    found: Edges = rows[self_intersections(compacted(mesh.vertices, mesh.triangles[rows]))]
    return found


def parted(mesh: TriangleMesh, extent: float, factor: float = 1.0) -> TriangleMesh:
    """Return a closed mesh of 32-bit coordinates, no two vertices of it at one place.

    Parameters
    ----------
    mesh : it may touch itself at vertices and edges, and does not cross itself
    extent : greatest coordinate
    factor : lengths in it over those in mm

    Raises
    ------
    FaultySurfaceError
        If it crosses or touches itself after all.
    """
    touching = _at_one_place(mesh)
    if not touching.any():
        return mesh
    places = mesh.vertices[touching]
    count = counted(len(np.unique(places, axis=0)), "place")
    for parting in PARTINGS:
        found = _drawn_in(mesh, touching, parting * extent)
        crossings = _crossings_within(found, *_boxes_around(found, touching))
        if not _at_one_place(found).any() and len(crossings) == 0:
            moved = length(found.vertices - mesh.vertices).max() / factor
            one = place_text(places[0] / factor)
            told = f"the surface touches itself at {count} (one is {one})"
            _log.info("%s: vertices there are moved apart by up to %.2g mm", told, moved)
            return found
    raise FaultySurfaceError(f"touches itself at {count}", places)


def _at_one_place(mesh: TriangleMesh) -> Bools:
    """Return which vertices are where another one is, (v,)."""
    place, first = equal_positions(mesh.vertices)
    several: Bools = np.bincount(place, minlength=len(first))[place] > 1
    return several


def _drawn_in(mesh: TriangleMesh, touching: Bools, distance: float) -> TriangleMesh:
    """Return the mesh with some vertices (v,) moved toward the means of their neighbors, mm.

    At a corner of the solid this is into it, at a corner of what is outside it is out of it: in
    both, sheets that met there are parted.
    """
    ends = sides_of(mesh.triangles)
    start, end = ends[touching[ends[:, 0]]].T  # each neighbor once: the surface is closed
    way = mesh.vertices[end] - mesh.vertices[start]
    count = np.maximum(np.bincount(start, minlength=len(touching)), 1)
    mean = sums_by_row(way, start, len(touching)) / count[:, None]
    shortest = np.full(len(touching), np.inf)
    np.minimum.at(shortest, start, length(way))
    size = length(mean)
    moves = touching & (size > FLAT * shortest)
    step = np.minimum(distance, MOST_OF_EDGE * shortest)
    points = mesh.vertices.copy()
    points[moves] += (step / np.where(moves, size, 1.0))[moves, None] * mean[moves]
    return TriangleMesh(in_single_precision(points), mesh.triangles)
