"""Welding: what becomes one vertex, and what stays as it is."""

from __future__ import annotations

import numpy as np

from scaffold_cad.filling import fill
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.mesh.welding import welded, with_fans_apart, without_repeated_corners
from tests.meshes import CUBE

CORNERS_APART = TriangleMesh(
    CUBE.vertices[CUBE.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3)
)
"""The cube as an STL file holds it."""

EDGE_TO_EDGE = TriangleMesh(
    np.concatenate([CUBE.vertices, CUBE.vertices + np.array([2.0, 2.0, 0.0])]),
    np.concatenate([CUBE.triangles, CUBE.triangles + len(CUBE.vertices)]),
)
"""Two cubes that touch along an edge, of which each has its own vertices."""


def test_corners_at_one_position_become_one_vertex() -> None:
    mesh = welded(CORNERS_APART)
    mesh.check_closed()
    assert len(mesh.vertices) == 8
    assert mesh.signed_volume == CORNERS_APART.signed_volume


def test_what_is_closed_stays_as_it_is() -> None:
    assert welded(EDGE_TO_EDGE) is EDGE_TO_EDGE


def test_parts_that_touch_along_an_edge_are_a_region() -> None:
    skeleton = fill(EDGE_TO_EDGE, "sc", 1.0, 0.1)
    assert skeleton.nodes.min() == -1.0
    assert skeleton.nodes.max() == 3.0


def test_triangles_that_become_edges_stay_until_they_are_dropped() -> None:
    # A sliver between two corners at one position, beside the triangles that share its long sides.
    vertices = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    triangles = np.array([[0, 2, 1], [1, 2, 3]])
    mesh = welded(TriangleMesh(vertices, triangles))
    assert mesh.triangles.tolist() == [[0, 1, 0], [0, 1, 2]]
    assert without_repeated_corners(mesh).triangles.tolist() == [[0, 1, 2]]


def test_nothing_is_made_anew_where_no_corner_repeats() -> None:
    assert without_repeated_corners(EDGE_TO_EDGE) is EDGE_TO_EDGE


def test_each_fan_around_a_point_gets_a_vertex_of_its_own() -> None:
    other = CUBE.vertices + np.ptp(CUBE.vertices, axis=0)  # corner to corner
    places, place = np.unique(np.concatenate([CUBE.vertices, other]), axis=0, return_inverse=True)
    rows = np.concatenate([CUBE.triangles, CUBE.triangles + len(CUBE.vertices)])
    touching = TriangleMesh(places, place.reshape(-1)[rows])
    assert len(touching.vertices) == 15
    apart = with_fans_apart(touching)
    apart.check_closed()
    assert len(apart.vertices) == 16
    np.testing.assert_array_equal(
        apart.vertices[apart.triangles], touching.vertices[touching.triangles]
    )
    assert with_fans_apart(CUBE) is CUBE
