"""Quad and triangle meshes as manifold3d solids and trimesh objects."""

from __future__ import annotations

import re
import subprocess
import sys

import build123d
import manifold3d
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.errors import MeshError, MissingBackendError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products import to_trimesh
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.manifolds import manifold_triangles, to_manifold
from scaffold_cad.struts import round_struts
from tests.meshes import CUBE, INSIDE_OUT_CUBE, OPEN_CUBE, TORUS, TWO_CUBES, torus


def triangles_of(mesh: QuadMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.triangles)


def test_importing_the_module_leaves_its_back_ends_alone() -> None:
    program = (
        "import sys, scaffold_cad.solid.manifolds; "
        "print({'manifold3d', 'trimesh'} & set(sys.modules))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True
    )
    assert run.stdout.strip() == "set()"


@pytest.mark.parametrize(("mesh", "volume"), [(CUBE, 8.0), (TWO_CUBES, 16.0)])
def test_cubes_become_solids_of_their_volume(mesh, volume) -> None:
    solid = to_manifold(mesh)
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() == pytest.approx(volume, rel=1e-15)


def test_a_torus_keeps_its_hole_and_its_triangles() -> None:
    solid = to_manifold(TORUS)
    assert solid.genus() == 1
    assert solid.num_tri() == len(TORUS.triangles)


def test_a_triangle_mesh_becomes_the_same_solid() -> None:
    assert to_manifold(triangles_of(TORUS)).volume() == to_manifold(TORUS).volume()


@given(seed=st.integers(0, 2**32 - 1))
def test_a_solid_and_back_keeps_coordinates_to_the_last_bit(seed: int) -> None:
    mesh = torus(5, 4, seed=seed)
    again = manifold_triangles(to_manifold(mesh))
    again.check_closed()
    assert again.signed_volume == pytest.approx(triangles_of(mesh).signed_volume, rel=1e-12)
    assert sorted(again.vertices.tolist()) == sorted(mesh.vertices.tolist())


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (OPEN_CUBE, "the mesh is open"),
        (INSIDE_OUT_CUBE, "the shell of quad 0 has a volume of -8 mm³; need > 0"),
        (triangles_of(OPEN_CUBE), "no triangle runs along the edge from vertex"),
        (triangles_of(INSIDE_OUT_CUBE), "the triangles have a volume of -8 mm³; need > 0"),
    ],
)
def test_what_bounds_no_solid_is_refused(mesh, message) -> None:
    with pytest.raises(MeshError, match=re.escape(message)):
        to_manifold(mesh)


def test_a_refusal_of_manifold3d_is_named(monkeypatch) -> None:
    monkeypatch.setattr("scaffold_cad.solid.manifolds.check_solid", lambda _: None)
    with pytest.raises(MeshError, match="manifold3d refuses the mesh: NotManifold; need NoError"):
        to_manifold(OPEN_CUBE)


def test_a_solid_that_holds_an_error_has_no_triangles() -> None:
    open_cube = manifold3d.Manifold(
        manifold3d.Mesh64(OPEN_CUBE.vertices.copy(), OPEN_CUBE.triangles.astype(np.uint64))
    )
    with pytest.raises(MeshError, match="the manifold3d solid holds the error NotManifold"):
        manifold_triangles(open_cube)


def test_vertices_that_differ_in_a_property_only_become_one() -> None:
    cube = manifold3d.Manifold.cube([1, 1, 1]).calculate_normals(0, 10)
    assert len(cube.to_mesh64().vert_properties) > 8
    triangles = manifold_triangles(cube)
    triangles.check_closed()
    assert len(np.unique(triangles.triangles)) == 8
    assert triangles.signed_volume == pytest.approx(1.0)


@pytest.mark.parametrize("convert", [lambda cube: cube, triangles_of, to_manifold])
def test_trimesh_objects_are_watertight(convert) -> None:
    mesh = to_trimesh(convert(CUBE))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(8.0)


def test_shapes_and_builders_of_build123d_are_solids() -> None:
    with build123d.BuildPart() as plate:
        build123d.Box(20, 10, 2)
        build123d.Hole(3)
    whole = 400 - 18 * np.pi
    for what in (plate, plate.part):
        assert to_solid(what).volume() == pytest.approx(whole, rel=1e-3)
        assert to_trimesh(what).volume == pytest.approx(whole, rel=1e-3)
    with pytest.raises(MeshError, match="the Face holds no solid; need one"):
        to_solid(build123d.Face.make_rect(2, 2))


def test_struts_are_trimesh_objects_of_as_many_sides_as_asked() -> None:
    strut = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 1.0)
    for sides in (8, 20):
        mesh = to_trimesh(round_struts(strut), sides=sides)
        assert len(mesh.vertices) == 2 * sides + 2
        assert mesh.volume == pytest.approx(9 * np.pi, rel=1e-6)
    assert to_trimesh(build_scaffold(strut)).volume == pytest.approx(36)


def test_trimesh_objects_keep_vertices_that_are_close() -> None:
    tiny = CUBE.moved(CUBE.vertices * 1e-12)
    assert len(to_trimesh(tiny).vertices) == 8


@pytest.mark.parametrize(
    ("convert", "message"),
    [
        (to_manifold, "a manifold3d solid needs manifold3d; run: pip install manifold3d"),
        (to_trimesh, "a trimesh object needs trimesh; run: pip install trimesh"),
    ],
)
def test_without_a_back_end_the_error_says_how_to_get_it(monkeypatch, convert, message) -> None:
    monkeypatch.setattr("scaffold_cad.base.backends.find_spec", lambda _: None)
    with pytest.raises(MissingBackendError, match=message):
        convert(CUBE)
