"""Triangles as plane faces, and shells put together as solids with voids."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.brep import brep_of_faces
from scaffold_cad.brep.facets import brep_of_triangles, edges_between
from scaffold_cad.brep.joining import by_edges, with_voids
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from tests.meshes import CUBE


def cube(size: float, place: float = 0.0, inside_out: bool = False) -> TriangleMesh:
    triangles = CUBE.triangles[:, ::-1] if inside_out else CUBE.triangles
    middle = CUBE.vertices.mean(axis=0)
    return TriangleMesh(size * (CUBE.vertices - middle) + place, triangles)


def joined(*meshes: TriangleMesh) -> TriangleMesh:
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + n for mesh, n in zip(meshes, first, strict=False)]),
    )


def faces_of(mesh: TriangleMesh):
    return brep_of_triangles(mesh, np.zeros(len(mesh.triangles), dtype=np.intp), ("facet",))


def test_triangles_are_plane_faces_that_share_their_edges() -> None:
    faces = faces_of(cube(1.0))
    faces.check_closed()
    assert len(faces.edges.ends) == 18
    assert faces.face_names == ["facet"] * 12
    shape = brep_of_faces(faces)
    assert shape.is_valid
    assert shape.volume == pytest.approx(8.0, rel=1e-12)


def test_edges_are_found_by_their_vertices() -> None:
    faces = faces_of(cube(1.0))
    start, end = faces.edges.ends.T
    numbers = np.arange(len(start))
    for swapped in (False, True):
        ends = (end, start) if swapped else (start, end)
        found, ahead = edges_between(faces, *ends)
        np.testing.assert_array_equal(found, numbers)
        assert (ahead != swapped).all()


def test_each_connected_surface_is_a_shell() -> None:
    faces = by_edges(faces_of(joined(cube(1.0), cube(1.0, place=9.0))))
    assert np.bincount(faces.faces.shell).tolist() == [12, 12]
    shape = brep_of_faces(faces)
    assert [round(solid.volume, 9) for solid in shape.solids()] == [8.0, 8.0]


def test_voids_are_in_the_smallest_solid_around_them() -> None:
    inside = cube(0.5, place=9.0, inside_out=True)
    faces = faces_of(joined(inside, cube(20.0), cube(1.0, place=9.0)))
    # The large cube is not hollow; it holds the other ones, as bodies apart do in no part.
    found = with_voids(faces, np.array([True, False, False]))
    assert found.solid.tolist() == [0, 1, 1]
    assert found.faces.shell.tolist() == [2] * 12 + [0] * 12 + [1] * 12
    small = with_voids(faces_of(joined(inside, cube(1.0, place=9.0))), np.array([True, False]))
    assert brep_of_faces(small).volume == pytest.approx(7.0, rel=1e-9)
