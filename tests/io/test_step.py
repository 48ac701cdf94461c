"""STEP files written straight from arrays, as OCCT reads them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.io.step import tables, write_step
from scaffold_cad.mesh.quadmesh import QuadMesh
from tests.meshes import CUBE, DART_PRISM, TORUS, TWISTED_TUBE, TWO_CUBES, ball, pillow, torus

build123d = pytest.importorskip("build123d")


def bilinear(mesh: QuadMesh) -> BezierMesh:
    return BezierMesh.bilinear(mesh)


@pytest.mark.parametrize(
    "patches",
    [
        bilinear(CUBE),
        bilinear(DART_PRISM),
        bilinear(TWISTED_TUBE),
        bilinear(TORUS),
        pillow(0.5),
        ball(3),
        ball(5),
    ],
)
def test_a_closed_mesh_reads_back_as_one_valid_solid(tmp_path: Path, patches) -> None:
    path = tmp_path / "solid.step"
    write_step(patches, path, name="solid")
    again = build123d.import_step(path)
    assert type(again) is build123d.Solid
    assert again.is_valid
    assert again.is_manifold
    assert again.volume == pytest.approx(patches.signed_volume, rel=1e-9)
    assert len(again.faces()) == len(patches.quads)
    assert len(again.edges()) == len(patches.mesh.edges)
    assert len(again.vertices()) == len(patches.mesh.vertices)


@settings(max_examples=8)
@given(seed=st.integers(0, 2**32 - 1), exponent=st.integers(-2, 4))
def test_coordinates_of_any_size_keep_their_last_bit(tmp_path_factory, seed, exponent) -> None:
    mesh = torus(5, 3, seed=seed)
    mesh = mesh.moved(mesh.vertices * 10.0**exponent)
    path = tmp_path_factory.mktemp("step") / "torus.step"
    write_step(bilinear(mesh), path, name="torus")
    again = [tuple(vertex) for vertex in build123d.import_step(path).vertices()]
    assert sorted(again) == sorted(map(tuple, mesh.vertices.tolist()))


def test_flat_quads_are_planes_and_straight_edges_lines(tmp_path: Path) -> None:
    path = tmp_path / "tube.step"
    write_step(bilinear(TWISTED_TUBE), path, name="tube")
    solid = build123d.import_step(path)
    types = sorted(face.geom_type.name for face in solid.faces())
    assert types == ["BSPLINE"] * 16 + ["PLANE"] * 2
    assert {edge.geom_type for edge in solid.edges()} == {build123d.GeomType.LINE}


def test_two_parts_are_two_solids(tmp_path: Path) -> None:
    path = tmp_path / "cubes.step"
    write_step(bilinear(TWO_CUBES), path, name="cubes")
    again = build123d.import_step(path)
    assert again.is_valid
    assert [solid.volume for solid in again.solids()] == pytest.approx([8.0, 8.0])


def test_long_tables_are_written_block_by_block(tmp_path: Path, monkeypatch) -> None:
    whole, chunked = tmp_path / "whole.step", tmp_path / "chunked.step"
    write_step(bilinear(TORUS), whole, name="torus")
    monkeypatch.setattr(tables, "CELL_BYTES", tables.CELL_BYTES << 12)
    write_step(bilinear(TORUS), chunked, name="torus")
    assert without_time(chunked) == without_time(whole)


def test_only_the_time_differs_between_two_files_of_one_mesh(tmp_path: Path) -> None:
    first, second = tmp_path / "first.step", tmp_path / "second.step"
    write_step(bilinear(TORUS), first, name="torus")
    write_step(bilinear(TORUS), second, name="torus")
    assert without_time(first) == without_time(second)


def without_time(path: Path) -> str:
    text, count = re.subn(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'", "", path.read_text(encoding="ascii"))
    assert count == 1
    return text


def test_faces_and_product_have_their_names(tmp_path: Path) -> None:
    path = tmp_path / "cube.step"
    names = [f"edge {number}" for number in range(6)]
    write_step(bilinear(CUBE), path, name="dé's \\ 🧊", face_names=names)
    text = path.read_text(encoding="ascii")
    assert re.findall(r"ADVANCED_FACE\('(.*?)'", text) == names
    assert r"PRODUCT('d\X2\00E9\X0\''s \\ \X4\0001F9CA\X0\'," in text
    assert build123d.import_step(path).is_valid


def test_numbers_are_those_of_step() -> None:
    values = np.array([0.0, -0.0, 1.0, 0.1, 123456789.0, 1e-4, 9.9e-5, -1e-300, 1e16, 1 / 3])
    texts = tables._real_texts(values)
    assert [float(text) for text in texts] == values.tolist()
    for text in texts:
        assert re.fullmatch(r"-?\d+\.\d*(E[+-]\d+)?", text)  # ISO 10303-21, 6.4.2


def test_the_file_is_in_millimeters(tmp_path: Path) -> None:
    path = tmp_path / "cube.step"
    write_step(bilinear(CUBE), path, name="cube")
    assert "SI_UNIT(.MILLI.,.METRE.)" in path.read_text(encoding="ascii")
    size = build123d.import_step(path).bounding_box().size
    assert tuple(size) == pytest.approx((2.0, 2.0, 2.0))
