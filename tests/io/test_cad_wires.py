"""Wires of STEP, BREP and IGES files, of drawings and of Rhino."""

from __future__ import annotations

import gzip
import io
import math
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
import rhino3dm
from build123d import Box, CenterArc, Compound, Line, Pos, export_brep, export_step

from scaffold_cad import write
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton, read_triangles
from scaffold_cad.io.register import reader_of
from scaffold_cad.io.step import read_step_wires
from tests.fuzz.members import APART, sample_apart
from tests.io.test_reading import written


def total_length(path: Path) -> float:
    return float(read_skeleton(path, 0.01).lengths.sum())


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("suffix", ["step", "brep"])
def test_curves_become_edges_within_a_thousandth_of_their_size(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"arc.{suffix}"
    arc = CenterArc((0, 0, 0), 10, 0, 180)
    (export_step if suffix == "step" else export_brep)(arc, path)
    raw = read_raw(path)
    # Chords of an arc lie inside it by their sagitta.
    middles = raw.nodes[raw.edges].mean(axis=1)
    assert np.linalg.norm(middles, axis=1).min() > 10 - 0.001 * 25
    np.testing.assert_allclose(np.linalg.norm(raw.nodes, axis=1), 10, rtol=1e-9)
    assert total_length(path) == pytest.approx(10 * math.pi, rel=0.002)


@pytest.mark.usefixtures("in_this_process")
def test_wires_beside_a_solid_are_read_and_the_edges_of_its_faces_are_not(tmp_path: Path) -> None:
    both = Compound([Box(1, 1, 1), Pos(5, 0, 0) * Line((0, 0), (3, 0))])
    export_step(both, tmp_path / "both.step")
    assert total_length(tmp_path / "both.step") == pytest.approx(3)
    mesh = read_triangles(tmp_path / "both.step")
    assert mesh is not None
    assert mesh.signed_volume == pytest.approx(1)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("suffix", ["step", "brep"])
def test_a_solid_alone_is_no_skeleton_and_wires_alone_are_no_mesh(
    tmp_path: Path, suffix: str
) -> None:
    write(Box(1, 1, 1), tmp_path / f"box.{suffix}")
    with pytest.raises(FormatError, match=r"box\.\w+ holds 6 faces and no wires; need edges that"):
        read_raw(tmp_path / f"box.{suffix}")
    export = export_step if suffix == "step" else export_brep
    export(Line((0, 0), (3, 0)), tmp_path / f"line.{suffix}")
    assert read_triangles(tmp_path / f"line.{suffix}") is None


def test_svg_units_transforms_and_curves(tmp_path: Path) -> None:
    text = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="10cm" height="10cm" viewBox="0 0 50 50">'
        '<g transform="scale(2)"><line x1="0" y1="0" x2="5" y2="0"/></g></svg>'
    )
    raw = read_raw(written(tmp_path, "x.svg", text))
    np.testing.assert_allclose(raw.nodes, [[0, 0, 0], [20, 0, 0]], atol=1e-9)
    circle = '<svg xmlns="http://www.w3.org/2000/svg"><circle cx="20" cy="30" r="5"/></svg>'
    path = written(tmp_path, "circle.svg", circle)
    raw = read_raw(path)
    np.testing.assert_allclose(np.linalg.norm(raw.nodes - [20, -30, 0], axis=1), 5, rtol=1e-6)
    skeleton = read_skeleton(path, 0.1)
    assert (skeleton.loop_count, len(skeleton.extremities)) == (1, 0)


@pytest.mark.parametrize("name", sorted(set(APART) - {"wire.stp", "wire.iges"}))
def test_a_damaged_file_does_not_end_the_program(tmp_path: Path, name: str) -> None:
    content = sample_apart(name)
    half = content[: 2 * len(content) // 3]
    with pytest.raises(
        FormatError, match=rf"{name} (cannot be read|holds 0 faces|is not a sound|has no)"
    ):
        read_raw(written(tmp_path, name, half))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"Ve\n1e-07", b"Ve\xfe1e-07", "record 1 of its shapes is damaged"),
        (b"\nWi\n", b"\nWl\n", "record 6 of its shapes is damaged"),
        (b"*\nEd", b"\nEd", "it has 4 records of shapes and names 6"),
        (b"10 10 0\n0 0", b"10 10 0\x1a0 0", r"line 38 has '0\\x1a0' in a record of a shape"),
        (b"10 10 0\n0 0", b"10 1o 0\n0 0", "line 38 has '1o' in a record of a shape"),
        (b"TShapes 6", b"TShapes -6", "it has no records of shapes"),
        (b"10 10 0\n0 0", b"10 10 0\n0", "record 4 of its shapes has more or fewer numbers"),
        (b"10 10 0\n0 0", b"10 10 0\n0 1.5", "record 4 of its shapes has more or fewer numbers"),
        (b"Locations 0", b"Locations 1\n2 1 1.5 0", "its places are damaged"),
        (b"+1 0", b"+1", "it was cut short"),
    ],
)
def test_records_that_occt_never_ends_reading_are_refused_at_once(
    tmp_path: Path, old: bytes, new: bytes, message: str
) -> None:
    content = sample_apart("wire.brep")
    assert old in content
    path = written(tmp_path, "x.brep", content.replace(old, new))
    for read in (read_raw, read_triangles):
        with pytest.raises(FormatError, match=rf"x\.brep cannot be read: {message}"):
            read(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<svg/>", r"x\.svg has no outlines; need paths, lines or shapes"),
        ('<!DOCTYPE svg [<!ENTITY a "b">]><svg>&a;</svg>', "declares a document type or entities"),
        ("<svg", "need well-formed XML"),
        ('<svg><path d="M0 0L9 9"/><path d="M 0 0 L 9 1O"/></svg>', "path 2, has 'O'; need num"),
        ('<svg><path d="M0 0Q1 2 3"/></svg>', "path 1, has 'Q1 2 3', of 3 numbers; need a mult"),
        ('<svg><polygon points="0,0 9"/></svg>', "polygon 1, has '0,0 9', of 3 numbers; need"),
        ('<svg><line x2="9"/><path d="L 5 5"/></svg>', "path 1, begins with 'L 5 5'; need M"),
        ('<svg><path d="M0 0A5 5 0 0 1 10"/></svg>', "has 'A5 5 0 0 1 10'; need seven numbers an"),
        ("<svg><path/></svg>", r"x\.svg has no outlines; need paths, lines or shapes"),
        ('<svg><path id="rim" d="M 0 0 L 1e 9"/></svg>', r"x\.svg, path rim, has 'e'; need"),
        ('<svg><polyline points="0,0 1_0,9"/></svg>', "polyline 1, has '_'; need numbers"),
        ('<svg><line x1="0" y1="abc" x2="3" y2="4"/></svg>', "line 1, has 'abc'; need numbers"),
    ],
)
def test_errors_of_drawings(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "x.svg", text))


def test_numbers_of_drawings_may_run_together_and_have_units(tmp_path: Path) -> None:
    text = (
        '<svg><path d="M0-3.5.5.25l1e1-.5zM1,1"/><path d="none"/><path d=""/>'
        '<rect x="1cm" width=" 2mm " height="3" rx="auto"/><line x2="5%"/></svg>'
    )
    raw = read_raw(written(tmp_path, "x.svg", text))
    np.testing.assert_allclose(raw.nodes[:3], [[0, 3.5, 0], [0.5, -0.25, 0], [10.5, 0.25, 0]])
    assert raw.nodes[-2:, 0].tolist() == [0, 50]  # of the 1000 mm that a drawing has without a size


def test_rhino_curves_are_in_the_unit_of_the_file(tmp_path: Path) -> None:
    document = rhino3dm.File3dm()
    document.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Inches
    corners = [rhino3dm.Point3d(*place) for place in ((0, 0, 0), (1, 0, 0), (1, 1, 0))]
    document.Objects.AddPolyline(rhino3dm.Polyline(corners))
    circle = rhino3dm.Circle(rhino3dm.Point3d(5, 0, 0), 1.0)
    document.Objects.AddCurve(circle.ToNurbsCurve())
    document.Objects.AddPoint(rhino3dm.Point3d(0, 0, 0))
    path = tmp_path / "x.3dm"
    document.Write(str(path), 7)
    raw = read_raw(path)
    np.testing.assert_allclose(raw.nodes[:3], [[0, 0, 0], [25.4, 0, 0], [25.4, 25.4, 0]])
    around = raw.nodes[3:] - [127, 0, 0]
    np.testing.assert_allclose(np.linalg.norm(around, axis=1), 25.4, rtol=1e-6)


def test_a_damaged_rhino_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"x\.3dm is not a sound 3DM file"):
        read_raw(written(tmp_path, "x.3dm", b"3D Geometry File Format and no more"))


def test_a_damaged_packed_file_is_named_as_it_was_given(tmp_path: Path) -> None:
    path = tmp_path / "node.stpz"
    path.write_bytes(gzip.compress(b"ISO-10303-21;\nHEADER;\n"))
    with pytest.raises(FormatError, match=re.escape(f"{path} cannot be read: OCCT cannot read it")):
        read_skeleton(path, radius=1.0)


def test_packed_files_are_step_where_they_hold_step() -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("node.STEP", "ISO-10303-21;")
    for head in (packed.getvalue(), gzip.compress(b"ISO-10303-21;")):
        assert reader_of(Path("node.stpz"), head) is read_step_wires
    assert reader_of(Path("node.step.gz"), gzip.compress(b"ISO-10303-21;")) is read_step_wires
    with pytest.raises(FormatError, match=r"graph\.gz is of no known format"):
        reader_of(Path("graph.gz"), gzip.compress(b"{}"))
