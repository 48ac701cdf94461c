"""B-reps of meshes, and the CAD files that hold them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.brep import TESSELLATION_DISTANCE, export_brep, export_step, tessellated
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1 import smooth_patches
from scaffold_cad.errors import BrepError, MeshError, MissingBackendError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from tests.meshes import (
    CUBE,
    DART_PRISM,
    INSIDE_OUT_CUBE,
    OPEN_CUBE,
    TORUS,
    TWISTED_TUBE,
    TWO_CUBES,
    ball,
    elevated,
    pillow,
    torus,
    twisted_tube_volume,
)

build123d = pytest.importorskip("build123d")


def test_importing_the_package_leaves_build123d_alone() -> None:
    program = "import sys, scaffold_cad.io.write; print({'build123d', 'OCP'} & set(sys.modules))"
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True
    )
    assert run.stdout.strip() == "set()"


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (CUBE, 8.0),
        (DART_PRISM, 36.0),
        (TWISTED_TUBE, twisted_tube_volume(4)),
        (TORUS, TORUS.signed_volume),
    ],
)
def test_a_closed_mesh_becomes_one_valid_solid_of_its_volume(mesh, volume) -> None:
    solid = to_brep(mesh)
    assert type(solid) is build123d.Solid
    assert solid.is_valid
    assert solid.is_manifold
    assert solid.volume == pytest.approx(volume, rel=1e-9)
    assert len(solid.faces()) == len(mesh.quads)
    assert len(solid.edges()) == len(mesh.edges)
    assert len(solid.vertices()) == len(mesh.vertices)


@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1), across=st.integers(3, 6))
def test_any_torus_of_bilinear_quads_keeps_its_volume(seed: int, across: int) -> None:
    mesh = torus(5, across, seed=seed)
    solid = to_brep(mesh)
    assert solid.is_valid
    assert solid.volume == pytest.approx(mesh.signed_volume, rel=1e-9)


def test_faces_are_in_the_order_of_their_quads() -> None:
    centers = [tuple(face.center()) for face in to_brep(CUBE).faces()]
    np.testing.assert_allclose(centers, CUBE.vertices[CUBE.quads].mean(axis=1), atol=1e-9)


def test_faces_look_outward() -> None:
    for face in to_brep(TWISTED_TUBE).faces():
        # Seen from the tube's middle.
        assert face.normal_at().dot(face.center() - build123d.Vector(0, 0, 6)) > 0


def test_flat_quads_are_planes_and_straight_edges_lines() -> None:
    assert {face.geom_type for face in to_brep(CUBE).faces()} == {build123d.GeomType.PLANE}
    types = [face.geom_type for face in to_brep(TWISTED_TUBE).faces()]
    assert types == [build123d.GeomType.BEZIER] * 16 + [build123d.GeomType.PLANE] * 2
    assert {edge.geom_type for edge in to_brep(TORUS).edges()} == {build123d.GeomType.LINE}


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_patches_of_a_higher_degree_become_a_solid_with_curved_edges(degree) -> None:
    patches = ball(degree)
    solid = to_brep(patches)
    assert solid.is_valid
    assert solid.is_manifold
    assert solid.volume == pytest.approx(patches.signed_volume, rel=1e-9)
    assert {edge.geom_type for edge in solid.edges()} == {build123d.GeomType.BEZIER}


def test_a_pillow_has_the_volume_of_its_polynomials() -> None:
    assert to_brep(pillow(0.5)).volume == pytest.approx(8 + 4 / 3, rel=1e-9)


def test_patches_of_degree_1_are_those_of_the_mesh() -> None:
    solid = to_brep(BezierMesh(CUBE.quads, elevated(CUBE, 1)))
    assert {face.geom_type for face in solid.faces()} == {build123d.GeomType.PLANE}
    assert solid.volume == pytest.approx(8.0, rel=1e-12)


def test_a_mesh_of_two_parts_becomes_a_compound_of_two_solids() -> None:
    compound = to_brep(TWO_CUBES)
    assert type(compound) is build123d.Compound
    assert compound.is_valid
    assert [solid.volume for solid in compound.solids()] == pytest.approx([8.0, 8.0])


def test_an_open_mesh_becomes_an_open_shell() -> None:
    shell = to_brep(OPEN_CUBE, "shell")
    assert type(shell) is build123d.Shell
    assert shell.is_valid
    assert not shell.is_manifold
    assert shell.area == pytest.approx(20.0)
    assert not shell.wrapped.Closed()


def test_a_closed_mesh_becomes_a_closed_shell() -> None:
    shell = to_brep(TORUS, "shell")
    assert type(shell) is build123d.Shell
    assert shell.is_valid
    assert shell.wrapped.Closed()


def test_only_the_closed_shells_are_marked_closed() -> None:
    quads = np.delete(TWO_CUBES.quads, 1, axis=0)
    shells = to_brep(QuadMesh(TWO_CUBES.vertices, quads), "shell").shells()
    assert [shell.wrapped.Closed() for shell in shells] == [True, False]


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(OptionError, match="kind is 'face'; need one of solid, shell"):
        to_brep(CUBE, "face")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (OPEN_CUBE, "the mesh is open"),
        (INSIDE_OUT_CUBE, "the shell of quad 0 has a volume of -8 mm³; need > 0"),
        (QuadMesh(CUBE.vertices, np.zeros((0, 4), dtype=int)), "the mesh has no quads"),
    ],
)
def test_what_bounds_no_solid_is_refused(mesh, message) -> None:
    with pytest.raises(MeshError, match=re.escape(message)):
        to_brep(mesh)


def test_an_edge_below_the_tolerance_is_refused() -> None:
    message = re.escape("the edge between vertices 0 and 1 is 2e-08 mm long; need 2e-07 mm or more")
    with pytest.raises(BrepError, match=message):
        to_brep(CUBE.moved(CUBE.vertices * [1, 1, 1e-8]))


def test_a_quad_without_area_is_refused() -> None:
    vertices = CUBE.vertices.copy()
    # Quad 0, at x = -1, becomes a line.
    vertices[CUBE.quads[0]] = [[-1, y, 0] for y in (-2, -1, 1, 2)]
    message = re.escape("quad 0 is 0 mm wide; need 2e-07 mm or more")
    with pytest.raises(BrepError, match=message):
        to_brep(CUBE.moved(vertices))


@pytest.mark.parametrize("write_pcurves", [False, True])
@pytest.mark.parametrize("mesh", [CUBE, TWISTED_TUBE, ball(3)])
def test_a_step_file_reads_back_as_one_valid_solid(tmp_path: Path, mesh, write_pcurves) -> None:
    path = tmp_path / "solid.step"
    shape = to_brep(mesh)
    export_step(shape, path, write_pcurves=write_pcurves)
    again = build123d.import_step(path)
    assert len(again.solids()) == 1
    assert again.is_valid
    assert again.is_manifold
    assert again.volume == pytest.approx(shape.volume, rel=1e-9)


def test_a_step_file_holds_pcurves_only_if_asked(tmp_path: Path) -> None:
    path = tmp_path / "solid.step"
    for write_pcurves in (True, False):
        export_step(to_brep(TWISTED_TUBE), path, write_pcurves=write_pcurves)
        assert ("PCURVE" in path.read_text(encoding="ascii")) == write_pcurves


@pytest.mark.parametrize("mesh", [CUBE, TORUS, TWO_CUBES, ball(3)])
def test_a_brep_file_reads_back_unchanged(tmp_path: Path, mesh) -> None:
    path = tmp_path / "solid.brep"
    shape = to_brep(mesh)
    export_brep(shape, path)
    again = build123d.import_brep(path)
    assert again.is_valid
    assert len(again.faces()) == len(shape.faces())
    assert again.volume == pytest.approx(shape.volume, rel=1e-12)


def test_step_settings_are_what_they_were(tmp_path: Path) -> None:
    from OCP.Interface import Interface_Static

    export_step(to_brep(CUBE), tmp_path / "first.step")
    name = "write.surfacecurve.mode"
    before = Interface_Static.IVal_s(name)
    try:
        for mode in (0, 1):
            Interface_Static.SetIVal_s(name, mode)
            export_step(to_brep(CUBE), tmp_path / "cube.step", write_pcurves=not mode)
            assert Interface_Static.IVal_s(name) == mode
    finally:
        Interface_Static.SetIVal_s(name, before)


def test_step_files_are_written_in_silence(tmp_path: Path, capfd) -> None:
    export_step(to_brep(CUBE), tmp_path / "cube.step")
    assert capfd.readouterr() == ("", "")


def test_files_in_no_folder_are_refused(tmp_path: Path) -> None:
    for export in (export_step, export_brep):
        with pytest.raises(OSError, match="OCCT could not write it"):
            export(to_brep(CUBE), tmp_path / "nowhere" / "cube")


@pytest.mark.parametrize(("mesh", "volume"), [(CUBE, 8.0), (TWO_CUBES, 16.0)])
def test_triangles_of_flat_faces_are_exact_and_closed(mesh, volume) -> None:
    triangles = tessellated(to_brep(mesh))
    triangles.check_closed()
    assert triangles.signed_volume == pytest.approx(volume, rel=1e-12)
    assert len(triangles.vertices) == len(mesh.vertices)


def test_triangles_of_curved_faces_are_near_and_closed() -> None:
    triangles = tessellated(build123d.Sphere(5))
    triangles.check_closed()
    assert triangles.signed_volume == pytest.approx(4 / 3 * np.pi * 125, rel=1e-2)
    assert np.linalg.norm(triangles.vertices, axis=1) == pytest.approx(5)


@pytest.mark.parametrize("radius", [1, 5, 20, 50])
def test_triangles_are_within_a_hundredth_of_a_millimeter(radius: float) -> None:
    triangles = tessellated(build123d.Sphere(radius))
    triangles.check_closed()
    corners = triangles.vertices[triangles.triangles]
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    depths = radius - length(np.concatenate([corners.mean(axis=1), *middles]))
    assert np.quantile(depths, 0.95) < TESSELLATION_DISTANCE
    assert depths.max() < 2.2 * TESSELLATION_DISTANCE  # at the seam


def test_large_bodies_have_no_more_triangles_than_smaller_ones() -> None:
    smaller, larger = (tessellated(build123d.Cylinder(size, size)) for size in (500, 5000))
    assert len(larger.triangles) <= len(smaller.triangles)
    corners = larger.vertices[larger.triangles]
    side = corners[np.ptp(corners[:, :, 2], axis=1) > 0]  # not the discs
    middles = (side + np.roll(side, 1, axis=1)) / 2
    assert 0.05 < (5000 - np.linalg.norm(middles[..., :2], axis=-1)).max() < 0.3  # 2e-5 of 15 m


def test_small_bodies_have_no_fewer_triangles_than_larger_ones() -> None:
    smaller, larger = (tessellated(build123d.Cylinder(size, size / 5)) for size in (0.01, 1))
    smaller.check_closed()
    assert len(smaller.triangles) == len(larger.triangles)


def gaps(points: Points, mesh: TriangleMesh) -> Floats:
    """Return the distance of each of `points` (n, 3) from the nearest triangle, shape (n,)."""
    corners = mesh.vertices[mesh.triangles]
    nearest = []
    for point in points:
        here = np.broadcast_to(point, (len(corners), 3))
        sides = [(corners[:, k - 1], corners[:, k]) for k in range(3)]
        to_sides = [length(here - nearest_on_segments(here, here, *s)[1]) for s in sides]
        normals = normalize(np.cross(*(corners[:, k] - corners[:, 0] for k in (1, 2))))
        over = [dot(np.cross(end - start, here - start), normals) >= 0 for start, end in sides]
        off = np.where(np.all(over, axis=0), np.abs(dot(here - corners[:, 0], normals)), np.inf)
        nearest.append(min(off.min(), np.min(to_sides)))
    return np.array(nearest)


def test_thin_smooth_struts_have_few_triangles_near_their_patches() -> None:
    strut = build_scaffold(Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 0.1))
    patches = smooth_patches(strut.mesh).bezier
    triangles = tessellated(to_brep(patches))
    triangles.check_closed()
    assert len(triangles.triangles) < 10_000
    weights = bernstein(patches.degree, np.linspace(0.1, 0.9, 5))
    points = np.einsum("ui,vj,fijx->fuvx", weights, weights, patches.control_points)
    assert gaps(points.reshape(-1, 3), triangles).max() < TESSELLATION_DISTANCE


def test_triangles_that_a_shape_has_are_neither_used_nor_changed() -> None:
    ball = build123d.Sphere(20)
    ball.mesh(5.0, 1.5)
    before = len(ball.tessellate(5.0, 1.5)[1])
    assert len(tessellated(ball).triangles) > 10 * before
    assert len(ball.tessellate(5.0, 1.5)[1]) == before


def test_faces_without_an_end_have_no_triangles() -> None:
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Dir, gp_Pnt
    from OCP.TopoDS import TopoDS_Face

    face = TopoDS_Face()
    BRep_Builder().MakeFace(face, Geom_Plane(gp_Pnt(), gp_Dir(0, 0, 1)), 1e-7)
    with pytest.raises(BrepError, match="OCCT finds no triangles for face 0; need a finite"):
        tessellated(build123d.Face(face))


def test_triangles_follow_the_place_of_a_shape() -> None:
    triangles = tessellated(build123d.Pos(10, 20, 30) * build123d.Box(1, 2, 3))
    triangles.check_closed()
    np.testing.assert_allclose(triangles.vertices.mean(axis=0), [10, 20, 30])
    assert triangles.signed_volume == pytest.approx(6.0)


def test_without_build123d_the_error_says_how_to_get_it(monkeypatch) -> None:
    monkeypatch.setattr("scaffold_cad.base.backends.find_spec", lambda _: None)
    message = "a B-rep needs build123d; run: pip install build123d"
    with pytest.raises(MissingBackendError, match=message):
        to_brep(CUBE)


def test_step_files_say_how_exact_their_shape_is(tmp_path: Path) -> None:
    # Else ends of edges that a boolean left apart are read as edges without a length.
    from OCP.BRep import BRep_Builder
    from OCP.Interface import Interface_Static

    box = build123d.Box(10, 10, 10) - build123d.Cylinder(3, 20)
    vertex = box.vertices()[0].wrapped
    BRep_Builder().UpdateVertex(vertex, 7e-6)
    export_step(box, tmp_path / "box.step")
    text = (tmp_path / "box.step").read_text("utf-8")
    (told,) = re.findall(r"UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\(([^)]*)\)", text)
    assert 7e-6 < float(told) < 2e-5
    assert Interface_Static.RVal_s("write.precision.val") == 1e-3  # as it is for others
