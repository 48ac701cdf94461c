"""write(): each format read back by another program's reader, and what it refuses."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import lib3mf
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.brep.g1 import smooth_patches
from scaffold_cad.errors import (
    BrepError,
    FormatError,
    MeshError,
    MissingBackendError,
    OptionError,
)
from scaffold_cad.io import read_skeleton
from scaffold_cad.io import written_suffixes as known_suffixes
from scaffold_cad.io.write import check_writable, write
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products import to_trimesh
from scaffold_cad.products.assembly import Assembly
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.solid.manifolds import to_manifold
from tests.meshes import (
    CUBE,
    INSIDE_OUT_CUBE,
    OPEN_CUBE,
    TORUS,
    TWISTED_TUBE,
    TWO_CUBES,
    ball,
    torus,
    twisted_tube_volume,
)
from tests.skeletons import STRUT, TRIPOD

MESH_SUFFIXES = [".stl", ".obj", ".ply", ".glb", ".3mf"]
SUFFIXES = [*MESH_SUFFIXES, ".step", ".stp", ".stpz", ".brep"]


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def read_mesh(path: Path) -> trimesh.Trimesh:
    """Return the triangles in a file; those of a GLB file in mm and z up again."""
    if path.suffix == ".3mf":
        return read_3mf(path)
    mesh = trimesh.load(path, force="mesh")
    if path.suffix == ".glb":
        mesh.vertices = mesh.vertices[:, [0, 2, 1]] * [1000, -1000, 1000]
    return mesh


def read_3mf(path: Path) -> trimesh.Trimesh:
    model = lib3mf.Wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(path))
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    assert model.GetBuildItems().Count() == 1
    items = model.GetMeshObjects()
    assert items.MoveNext()
    body = items.GetCurrentMeshObject()
    vertices = [list(vertex.Coordinates) for vertex in body.GetVertices()]
    triangles = [list(triangle.Indices) for triangle in body.GetTriangleIndices()]
    return trimesh.Trimesh(vertices, triangles, process=False)


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
@pytest.mark.parametrize(("mesh", "volume"), [(CUBE, 8.0), (TWO_CUBES, 16.0)])
def test_a_cube_reads_back_watertight(tmp_path: Path, suffix, mesh, volume) -> None:
    path = tmp_path / f"cube{suffix}"
    write(mesh, path)
    again = read_mesh(path)
    assert again.is_watertight
    assert again.is_winding_consistent
    assert again.volume == pytest.approx(volume, rel=1e-6)
    np.testing.assert_allclose(again.bounds, [mesh.vertices.min(0), mesh.vertices.max(0)])


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_a_torus_keeps_its_volume(tmp_path: Path, suffix) -> None:
    path = tmp_path / f"torus{suffix}"
    triangles = TriangleMesh(TORUS.vertices, TORUS.triangles)
    write(triangles, path)
    again = read_mesh(path)
    assert again.is_watertight
    assert again.volume == pytest.approx(triangles.signed_volume, rel=1e-6)


@pytest.mark.parametrize(
    ("suffix", "options"),
    [(".step", {}), (".stp", {}), (".step", {"write_pcurves": True}), (".brep", {})],
)
def test_a_twisted_tube_reads_back_as_a_valid_solid(tmp_path: Path, suffix, options) -> None:
    build123d = pytest.importorskip("build123d")
    path = tmp_path / f"tube{suffix}"
    write(TWISTED_TUBE, path, **options)
    read = build123d.import_brep if suffix == ".brep" else build123d.import_step
    again = read(path)
    assert len(again.solids()) == 1
    assert again.is_valid
    assert again.volume == pytest.approx(twisted_tube_volume(4), rel=1e-9)


@given(seed=st.integers(0, 2**32 - 1))
def test_obj_and_ply_keep_quads_and_every_bit(tmp_path_factory, seed: int) -> None:
    mesh = torus(5, 3, seed=seed)
    folder = tmp_path_factory.mktemp("quads")
    write(mesh, folder / "torus.obj")
    lines = (folder / "torus.obj").read_text().splitlines()
    vertices = [line.split()[1:] for line in lines if line.startswith("v ")]
    faces = [line.split()[1:] for line in lines if line.startswith("f ")]
    np.testing.assert_array_equal(np.array(vertices, dtype=float), mesh.vertices)
    np.testing.assert_array_equal(np.array(faces, dtype=int) - 1, mesh.fans)

    write(mesh, folder / "torus.ply")
    body = (folder / "torus.ply").read_bytes().partition(b"end_header\n")[2]
    size = 24 * len(mesh.vertices)
    np.testing.assert_array_equal(
        np.frombuffer(body[:size], dtype="<f8").reshape(-1, 3), mesh.vertices
    )
    rows = np.frombuffer(body[size:], dtype=[("count", "u1"), ("corners", "<i4", 4)])
    assert set(rows["count"]) == {4}
    np.testing.assert_array_equal(rows["corners"], mesh.fans)


@pytest.mark.parametrize(("suffix", "line"), [(".obj", "# unit: mm"), (".ply", "comment unit: mm")])
def test_formats_without_a_unit_name_it_in_a_comment(tmp_path: Path, suffix, line) -> None:
    write(CUBE, tmp_path / f"cube{suffix}")
    assert f"{line}\n".encode() in (tmp_path / f"cube{suffix}").read_bytes()


def test_stl_normals_are_those_of_the_triangles(tmp_path: Path) -> None:
    write(TORUS, tmp_path / "torus.stl")
    raw = (tmp_path / "torus.stl").read_bytes()
    assert not raw.startswith(b"solid")
    facets = np.frombuffer(
        raw[84:], dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    )
    expected = TORUS.vertices[TORUS.triangles]
    np.testing.assert_allclose(facets["corners"], expected, atol=1e-5)
    sides = np.diff(expected, axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(facets["normal"], normals, atol=1e-5)


def test_stl_triangles_without_area_have_no_normal(tmp_path: Path) -> None:
    write(TriangleMesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]), tmp_path / "line.stl")
    assert np.frombuffer((tmp_path / "line.stl").read_bytes()[84:96], "<f4").tolist() == [0, 0, 0]


def test_triangles_that_rounding_makes_degenerate_are_not_written(tmp_path: Path) -> None:
    # A tetrahedron with one corner cut off, 1e-9 mm from it: less than 32 bits can tell apart.
    tiny = 1e-9
    corners = [[0, 0, 1], [0, 2, 1], [2, 0, 1], [1, 1, 3], [1, 1 + tiny, 3], [1 + tiny, 1, 3]]
    mesh = TriangleMesh(
        corners,
        [[0, 1, 2], [3, 5, 4], [0, 2, 5], [0, 5, 3], [1, 4, 5], [1, 5, 2], [0, 3, 4], [0, 4, 1]],
    )
    mesh.check_closed()
    for name in ("cut.stl", "cut.3mf"):
        write(mesh, tmp_path / name)
        read = trimesh.load(tmp_path / name, force="mesh")
        assert read.is_watertight
        assert len(read.faces) == 4


def test_glb_files_are_in_meters_and_y_up(tmp_path: Path) -> None:
    tall = CUBE.moved(CUBE.vertices * [1, 2, 3])
    write(tall, tmp_path / "cube.glb")
    sizes = trimesh.load(tmp_path / "cube.glb", force="mesh").extents
    np.testing.assert_allclose(sizes, [0.002, 0.006, 0.004], rtol=1e-6)


@pytest.mark.parametrize("suffix", [*MESH_SUFFIXES, ".brep"])
def test_the_same_mesh_always_gives_the_same_bytes(tmp_path: Path, suffix) -> None:
    first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
    write(TORUS, first)
    write(TORUS, second)
    assert first.read_bytes() == second.read_bytes()


def test_other_assemblies_have_other_3mf_identifiers(tmp_path: Path) -> None:
    def identifiers(mesh: QuadMesh) -> set[str]:
        beside = TriangleMesh(mesh.vertices, mesh.triangles)
        write(Assembly([], [beside]), tmp_path / "part.3mf")
        model = lib3mf.Wrapper().CreateModel()
        model.QueryReader("3mf").ReadFromFile(str(tmp_path / "part.3mf"))
        items = model.GetBuildItems()
        items.MoveNext()
        item = items.GetCurrent()
        return {model.GetBuildUUID()[1], item.GetUUID()[1], item.GetObjectResource().GetUUID()[1]}

    first, second = identifiers(CUBE), identifiers(TORUS)
    assert len(first | second) == 6
    assert identifiers(CUBE) == first


def test_a_scaffold_goes_into_every_format_of_shapes(tmp_path: Path) -> None:
    scaffold = build_scaffold(TRIPOD)
    for suffix in SUFFIXES:
        write(scaffold, tmp_path / f"tripod{suffix}")
    for suffix in MESH_SUFFIXES:
        assert read_mesh(tmp_path / f"tripod{suffix}").is_watertight


def test_step_faces_are_named_after_their_skeleton_edges(tmp_path: Path) -> None:
    scaffold = build_scaffold(TRIPOD)
    write(scaffold, tmp_path / "tripod.step")
    text = (tmp_path / "tripod.step").read_text(encoding="ascii")
    names = re.findall(r"ADVANCED_FACE\('(.*?)'", text)
    assert names == [f"edge {edge}" for edge in scaffold.edge_of_quad]
    assert "PRODUCT('tripod','tripod'" in text


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_solids_of_other_packages_go_into_mesh_formats(tmp_path: Path, suffix) -> None:
    build123d = pytest.importorskip("build123d")
    for what in (to_manifold(CUBE), to_trimesh(CUBE), build123d.Box(2, 2, 2)):
        path = tmp_path / f"cube{suffix}"
        write(what, path)
        again = read_mesh(path)
        assert again.is_watertight
        assert again.volume == pytest.approx(8.0, rel=1e-6)


def test_build123d_shapes_and_smooth_patches_go_into_cad_formats(tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    for what, volume in ((build123d.Box(1, 2, 3), 6.0), (ball(3), ball(3).signed_volume)):
        write(what, tmp_path / "part.step")
        write(what, tmp_path / "part.brep")
        assert build123d.import_step(tmp_path / "part.step").volume == pytest.approx(volume)
        assert build123d.import_brep(tmp_path / "part.brep").volume == pytest.approx(volume)


def test_smooth_patches_go_into_mesh_formats_as_closed_triangles(tmp_path: Path) -> None:
    pytest.importorskip("build123d")
    write(ball(3), tmp_path / "ball.stl")
    again = read_mesh(tmp_path / "ball.stl")
    assert again.is_watertight
    assert again.volume == pytest.approx(ball(3).signed_volume, rel=1e-2)


def test_a_skeleton_reads_back_from_json(tmp_path: Path) -> None:
    write(STRUT, tmp_path / "strut.json")
    again = read_skeleton(tmp_path / "strut.json")
    np.testing.assert_array_equal(again.nodes, STRUT.nodes)
    np.testing.assert_array_equal(again.radii, STRUT.radii)
    assert isinstance(json.loads((tmp_path / "strut.json").read_text()), dict)


def test_suffixes_may_be_in_capitals_and_paths_strings(tmp_path: Path) -> None:
    write(CUBE, str(tmp_path / "CUBE.STL"))
    assert (tmp_path / "CUBE.STL").stat().st_size == 84 + 12 * 50


def test_writing_triangles_or_a_mesh_as_step_imports_no_cad_kernel(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from scaffold_cad.io.write import write\n"
        "from tests.meshes import CUBE\n"
        "for suffix in ('stl', 'obj', 'ply', 'step'):\n"
        "    write(CUBE, f'{sys.argv[1]}/cube.{suffix}')\n"
        "print({'build123d', 'OCP', 'trimesh', 'manifold3d', 'lib3mf'} & set(sys.modules))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.strip() == "set()"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_writing_prints_nothing(tmp_path: Path, suffix, capfd) -> None:
    write(TORUS, tmp_path / f"torus{suffix}")
    assert capfd.readouterr() == ("", "")


def test_an_unknown_suffix_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    for name, suffix in (("cube.xyz", ".xyz"), ("cube", "")):
        message = f"its suffix is '{suffix}'; need one of {', '.join(known_suffixes())}"
        with pytest.raises(FormatError, match=re.escape(message)):
            write(CUBE, tmp_path / name)
        with pytest.raises(FormatError, match=re.escape(message)):
            check_writable(tmp_path / name)
    assert set(SUFFIXES) < set(known_suffixes())


def test_a_path_that_can_be_written_passes(tmp_path: Path) -> None:
    check_writable(tmp_path / "cube.stl")
    assert names_in(tmp_path) == []


def test_a_missing_folder_is_refused_before_anything_is_made(tmp_path: Path) -> None:
    path = tmp_path / "nowhere" / "cube.stl"
    message = re.escape(f"cannot write {path}: there is no folder {path.parent}")
    with pytest.raises(FormatError, match=message):
        write(CUBE, path)
    with pytest.raises(FormatError, match=message):
        check_writable(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_full_disk_is_an_error_and_the_old_file_stays(tmp_path: Path, suffix) -> None:
    resource = pytest.importorskip("resource")
    path = tmp_path / f"torus{suffix}"
    path.write_text("old")
    if suffix == ".brep":
        pytest.importorskip("build123d")  # imported before the limit is set
        write(TORUS, tmp_path / "first.brep")
        (tmp_path / "first.brep").unlink()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (512, hard))  # Python ignores the signal
    try:
        with pytest.raises(FormatError, match=re.escape(f"cannot write {path}: ")):
            write(TORUS, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_text() == "old"
    assert names_in(tmp_path) == [path.name]


@pytest.mark.parametrize(
    ("what", "name", "error", "message"),
    [
        (STRUT, "strut.step", FormatError, "which a Skeleton does not have; need round_struts or"),
        (STRUT, "strut.stl", FormatError, "a mesh file cannot hold a Skeleton; need round_st"),
        (CUBE, "cube.json", FormatError, "a JSON file cannot hold a QuadMesh; need a Skeleton"),
        (TriangleMesh(CUBE.vertices, []), "cube.stl", FormatError, "the TriangleMesh has no faces"),
        (OPEN_CUBE, "cube.step", MeshError, "the mesh is open"),
        (INSIDE_OUT_CUBE, "cube.step", MeshError, "has a volume of -8 mm³; need > 0"),
        (CUBE.moved(CUBE.vertices * 1e-8), "cube.step", BrepError, "is 2e-08 mm long"),
    ],
)
def test_what_a_format_cannot_hold_is_refused(tmp_path: Path, what, name, error, message) -> None:
    path = tmp_path / name
    path.write_text("old")
    with pytest.raises(error, match=re.escape(message)):
        write(what, path)
    assert path.read_text() == "old"
    assert names_in(tmp_path) == [name]


@pytest.mark.parametrize("suffix", [".step", ".brep"])
@pytest.mark.parametrize(
    ("convert", "kind", "need"),
    [
        (to_manifold, "Manifold", "lattice_solid in place of lattice_part"),
        (to_trimesh, "Trimesh", "a Scaffold"),
    ],
)
def test_triangles_are_no_b_rep(tmp_path: Path, suffix, convert, kind, need) -> None:
    message = f"STEP and BREP files need a B-rep, which a {kind} does not have; need {need}"
    with pytest.raises(FormatError, match=message):
        write(convert(CUBE), tmp_path / f"cube{suffix}")


def test_pcurves_are_for_step_files(tmp_path: Path) -> None:
    message = "write_pcurves is for STEP files only; cube.stl is not one"
    with pytest.raises(OptionError, match=message):
        write(CUBE, tmp_path / "cube.stl", write_pcurves=True)


@pytest.mark.parametrize(("suffix", "package"), [(".glb", "trimesh"), (".brep", "build123d")])
def test_without_its_package_a_format_says_how_to_get_it(
    tmp_path: Path, monkeypatch, suffix, package
) -> None:
    monkeypatch.setattr("scaffold_cad.base.backends.find_spec", lambda _: None)
    with pytest.raises(MissingBackendError, match=f"needs {package}; run: pip install {package}"):
        write(CUBE, tmp_path / f"cube{suffix}")
    assert names_in(tmp_path) == []


def test_small_parts_keep_their_shape_in_3mf(tmp_path: Path) -> None:
    small = CUBE.moved(1e-6 * (CUBE.vertices + 0.123456789))
    write(small, tmp_path / "small.3mf")
    read = trimesh.load(tmp_path / "small.3mf", force="mesh", process=False)
    np.testing.assert_allclose(
        np.unique(read.vertices, axis=0), np.unique(small.vertices, axis=0), rtol=1e-6
    )


def test_what_holds_no_solid_is_not_offered_for_one(tmp_path: Path) -> None:
    check_writable(tmp_path / "skeleton.json")
    known = ".3mf, .brep, .glb, .obj, .ply, .step, .stl, .stp, .stpz"
    message = f"its suffix is '.json'; need one of {known}"
    with pytest.raises(FormatError, match=f"{re.escape(message)}$"):
        check_writable(tmp_path / "skeleton.json", solid=True)


def test_a_path_that_is_none_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cube.step"
    with pytest.raises(OptionError, match="path is of type QuadMesh: the object comes first"):
        write(path, CUBE)
    with pytest.raises(OptionError, match=r"path is 5; need a str or a Path$"):
        write(CUBE, 5)
    assert not path.exists()


@pytest.mark.parametrize("split", [0, 1])
def test_smooth_patches_are_one_face_a_patch(split: int, tmp_path: Path) -> None:
    patches = smooth_patches(build_scaffold(TRIPOD).mesh, split=split)
    write(patches, tmp_path / "patches.step")
    text = (tmp_path / "patches.step").read_text()
    assert text.count("ADVANCED_FACE(") == len(patches.bezier.quads) == 15 * 4**split
