"""Units of files: taken, converted when asked for, kept where the file names them."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pytest
from build123d import Box

from scaffold_cad import Skeleton, build_scaffold, write
from scaffold_cad.cli import main
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import read_skeleton, read_triangles
from scaffold_cad.skeleton.beams import BeamLattice
from tests.fuzz.samples import SWC
from tests.io.test_reading import ELBOW_OBJ, written
from tests.real_files import RADII, real_skeleton

STRUT = Skeleton([[0, 0, 0], [10, 0, 0]], [[0, 1]], edge_radii=[[1.0, 2.0]])


@pytest.mark.parametrize(
    ("units", "scale", "factor"),
    [
        ("in", None, 25.4),
        ("um", None, 0.001),
        ("Meters", None, 1000),
        ("feet", 2.0, 609.6),
        (None, 0.5, 0.5),
    ],
)
def test_lengths_and_radii_of_the_file_are_converted(
    tmp_path: Path, units: str | None, scale: float | None, factor: float
) -> None:
    path = written(tmp_path, "neuron.swc", SWC)
    plain = read_skeleton(path)
    found = read_skeleton(path, units=units, scale=scale)
    np.testing.assert_allclose(found.nodes, plain.nodes * factor)
    np.testing.assert_allclose(found.edge_radii, plain.edge_radii * factor)


def test_a_radius_that_is_given_is_in_mm(tmp_path: Path) -> None:
    found = read_skeleton(written(tmp_path, "x.obj", ELBOW_OBJ), 1.5, units="in")
    assert found.radii.tolist() == [1.5, 1.5, 1.5]
    assert found.nodes[1, 0] == 254


def test_micrometres_of_swc_are_said_unless_asked_for(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = written(tmp_path, "neuron.swc", SWC)
    with caplog.at_level(logging.INFO, "scaffold_cad.io"):
        read_skeleton(path, units="um")
        assert "mostly in um" not in caplog.text
        read_skeleton(path)
        assert "lengths, mostly in um, are taken as mm (units='um' converts them)" in caplog.text
        caplog.clear()
        write(STRUT, tmp_path / "ours.swc")
        read_skeleton(tmp_path / "ours.swc")
        assert "mostly" not in caplog.text


@pytest.mark.parametrize("suffix", ["json", "3mf"])
def test_a_file_that_names_its_unit_needs_none(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"strut.{suffix}"
    write(STRUT, path)
    with pytest.raises(OptionError, match=r"strut\.\w+ says that its unit is \w+; need no units"):
        read_skeleton(path, units="in")
    np.testing.assert_allclose(read_skeleton(path, scale=3).edge_radii, [[3, 6]], rtol=1e-6)


def test_radii_larger_than_the_edges_ask_for_the_units(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = written(tmp_path, "x.obj", ELBOW_OBJ)
    read_skeleton(path, 20.0)  # a path of 20 mm
    assert "check the units" not in caplog.text
    read_skeleton(path, 21.0)
    wanted = "2 of 2 edges thicker than long (middle radius 21 mm, length between branch points 20"
    assert f"{wanted} mm): check the units?" in caplog.text


@pytest.mark.parametrize("strict", [False, True])
def test_a_long_edge_does_not_hide_that_most_are_thicker_than_long(
    strict: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    star = "v 0 0 0\nv 10 0 0\nv 0 8 0\nv 0 0 2000\nl 1 2\nl 1 3\nl 1 4\n"
    path = written(tmp_path, "x.obj", star)
    read_skeleton(path, 9.0)
    assert "check the units" not in caplog.text
    read_skeleton(path, 500.0, strict=strict)
    assert "2 of 3 edges thicker than long (middle radius 500 mm, length" in caplog.text


@pytest.mark.parametrize("name", RADII)
@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_real_files_do_not_ask_for_the_units(
    name: str, factor: float, shared_data: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    write(real_skeleton(shared_data, name, factor), tmp_path / "x.json")
    read_skeleton(tmp_path / "x.json")
    assert "check the units" not in caplog.text


def test_options_out_of_range_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "x.obj", ELBOW_OBJ)
    with pytest.raises(OptionError, match="units is 'inhc'; need"):
        read_skeleton(path, 1.0, units="inhc")
    with pytest.raises(OptionError, match="scale is 0; need > 0"):
        read_skeleton(path, 1.0, scale=0)
    with pytest.raises(FormatError, match=r"x\.obj, in units of 1e\+12 mm: .* need "):
        read_skeleton(path, 1.0, scale=1e12)
    with pytest.raises(OptionError, match=r"scale is 1e\+300; need at most 1e\+12"):
        read_skeleton(path, 1.0, scale=1e300)
    with pytest.raises(OptionError, match="units is 'parsec'; need"):
        write(STRUT, tmp_path / "x.csv", units="parsec")


@pytest.mark.parametrize("suffix", ["graphml", "vtu", "inp"])
def test_a_skeleton_is_written_in_a_unit_and_read_back_in_it(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"strut.{suffix}"
    strut = STRUT if suffix == "graphml" else Skeleton(STRUT.nodes, STRUT.edges, 1.5)
    write(strut, path, units="in")
    found = read_skeleton(path, units="in")
    np.testing.assert_allclose(found.nodes, strut.nodes, rtol=1e-7)
    np.testing.assert_allclose(found.edge_radii, strut.edge_radii, rtol=1e-7)
    np.testing.assert_allclose(read_skeleton(path).nodes, strut.nodes / 25.4, rtol=1e-7)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_a_mesh_is_written_in_a_unit_and_read_back_in_it(tmp_path: Path, suffix: str) -> None:
    scaffold = build_scaffold(STRUT)
    path = tmp_path / f"strut.{suffix}"
    write(scaffold, path, units="in")
    assert b"unit: in" in path.read_bytes()[:200]
    volume = scaffold.mesh.signed_volume
    for options, wanted in (({"units": "in"}, volume), ({}, volume / 25.4**3)):
        mesh = read_triangles(path, **options)
        assert mesh is not None
        assert mesh.signed_volume == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize("suffix", ["3mf", "step", "brep"])
def test_a_format_that_names_its_unit_refuses_another_and_is_scaled(
    tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"box.{suffix}"
    with pytest.raises(OptionError, match="files say in which unit they are; need none"):
        write(Box(1, 2, 3), path, units="in")
    assert not path.exists()
    write(Box(1, 2, 3), path, units="mm", scale=2)
    mesh = read_triangles(path)
    assert mesh is not None
    assert mesh.signed_volume == pytest.approx(48)
    with pytest.raises(OptionError, match="files say in which unit they are; need no units"):
        read_triangles(path, units="in")


def test_beams_and_what_clips_them_are_scaled_together(tmp_path: Path) -> None:
    path = tmp_path / "beams.3mf"
    write(BeamLattice(STRUT, clip=build_scaffold(STRUT)), path, scale=2)
    mesh = read_triangles(path)
    assert mesh is not None
    write(BeamLattice(STRUT, clip=build_scaffold(STRUT)), path)
    plain = read_triangles(path)
    assert plain is not None
    assert mesh.signed_volume == pytest.approx(8 * plain.signed_volume, rel=1e-5)


def test_commands_take_units_and_a_scale(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(written(tmp_path, "x.obj", ELBOW_OBJ))
    assert main(["info", path, "--units", "in", "--scale", "2"]) == 0
    assert "edge length    508 mm" in capsys.readouterr().out
    out = str(tmp_path / "x.stl")
    assert main(["build", path, "--radius", "1", "--units", "in", "-o", out]) == 0
    mesh = read_triangles(out)
    assert mesh is not None
    assert np.ptp(mesh.vertices[:, 0]) > 254
    assert main(["build", path, "--radius", "1", "--units", "ell", "-o", out]) == 2
    assert "units is 'ell'; need" in capsys.readouterr().err
