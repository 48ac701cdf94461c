"""`scaffold-cad slice`."""

from __future__ import annotations

from pathlib import Path
from zipfile import ZipFile

import pytest

from scaffold_cad import TriangleMesh, write
from scaffold_cad.cli import main
from tests.io.test_stacks import area, read_binary_cli, read_text_cli
from tests.meshes import CUBE
from tests.skeletons import TETRAPOD


@pytest.fixture
def tetrapod(tmp_path: Path) -> str:
    write(TETRAPOD, tmp_path / "tetrapod.json")
    return str(tmp_path / "tetrapod.json")


@pytest.fixture
def cube(tmp_path: Path) -> str:
    write(TriangleMesh(4 * CUBE.vertices, CUBE.triangles), tmp_path / "cube.stl")
    return str(tmp_path / "cube.stl")


@pytest.mark.parametrize("suffix", ["cli", "3mf", "svg"])
def test_struts_are_cut_into_layers(
    suffix: str, tetrapod: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / f"out.{suffix}"
    assert main(["slice", tetrapod, "-o", str(out), "--layer", "0.5"]) == 0
    assert out.stat().st_size > 1000
    assert "out." in (said := capsys.readouterr().err)
    assert "written: 28 layers of 0.5 mm" in said


def test_options_of_struts_are_heeded(tetrapod: str, tmp_path: Path) -> None:
    out = tmp_path / "out.cli"
    words = ["slice", tetrapod, "-o", str(out), "--layer", "0.1"]
    assert main(words) == 0
    solid = sum(area(polygons) for _, polygons, _ in read_binary_cli(out))
    assert main([*words, "--blend", "1.5"]) == 0
    blended = sum(area(polygons) for _, polygons, _ in read_binary_cli(out))
    assert main([*words, "--wall", "0.2", "--ends", "open", "--sides", "8", "--text"]) == 0
    hollow = sum(area(polygons) for _, polygons, _ in read_text_cli(out))
    assert hollow < 0.6 * solid < 0.6 * blended


def test_images_are_written(tetrapod: str, tmp_path: Path) -> None:
    out = tmp_path / "out.zip"
    assert main(["slice", tetrapod, "-o", str(out), "--layer", "1", "--pixel", "0.1"]) == 0
    with ZipFile(out) as archive:
        assert len(archive.namelist()) == 14 + 1


def test_struts_are_cut_to_a_part_with_a_skin(tetrapod: str, cube: str, tmp_path: Path) -> None:
    out = tmp_path / "out.cli"
    words = ["slice", tetrapod, "-o", str(out), "--layer", "0.5", "--inside", cube]
    assert main([*words, "--skin", "0.6"]) == 0
    layers = read_binary_cli(out)
    assert len(layers) == 16
    assert area(layers[0][1]) == pytest.approx(64)


def test_a_closed_mesh_is_cut_as_it_is(
    cube: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.cli"
    words = ["slice", cube, "-o", str(out), "--layer", "1"]
    assert main(words) == 0
    assert [area(polygons) for _, polygons, _ in read_binary_cli(out)] == pytest.approx([64] * 8)
    assert main([*words, "--blend", "1"]) == 2
    assert "--blend is for skeletons; a mesh is cut as it is" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "a.stl", "--layer", "1"], "its suffix is '.stl'; layers need one of .3mf, .cli"),
        (["-o", "a.cli", "--layer", "0"], "--layer is 0 mm; need > 0"),
        (["-o", "a.cli", "--layer", "1", "--skin", "1"], "--skin is the wall of a part; need --in"),
        (["-o", "a.svg", "--layer", "1", "--text"], "--text is for .cli files"),
        (["-o", "a.zip", "--layer", "1"], "images need --pixel"),
        (["-o", "a.zip", "--layer", "1", "--pixel", "-1"], "--pixel is -1 mm; need > 0"),
        (["-o", "a.cli", "--layer", "1", "--pixel", "1"], "--pixel is for the images"),
        (["-o", "none/a.cli", "--layer", "1"], "there is no folder none"),
        (["-o", "a.cli", "--layer", "1", "--sides", "7"], "sides is 7; need a multiple of 4"),
    ],
)
def test_bad_input_writes_nothing(
    words: list[str],
    said: str,
    tetrapod: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["slice", tetrapod, *words]) == 2
    assert said in capsys.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ["tetrapod.json"]


def test_a_lattice_past_memory_is_cut(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out.cli"
    words = ["lattice", "--cell", "bcc", "--size", "1", "--radius", "0.1", "--box", "20x20x4000"]
    assert main([*words, "--layer", "100", "-o", str(out)]) == 0
    assert "12800000 struts, 41 layers of 100 mm" in capsys.readouterr().err
    assert len(read_binary_cli(out)) == 41


def test_a_box_and_a_part_are_filled_in_layers(cube: str, tmp_path: Path) -> None:
    out = tmp_path / "out.cli"
    words = ["lattice", "--cell", "bcc", "--size", "2", "--radius", "0.2", "--layer", "0.5"]
    words += ["-o", str(out)]
    assert main([*words, "--inside", cube, "--skin", "0.6"]) == 0
    layers = read_binary_cli(out)
    assert len(layers) == 16
    assert area(layers[0][1]) == pytest.approx(64)
    assert main([*words, "--box", "7x4x3"]) == 0  # no whole number of cells: cut flush
    layers = read_binary_cli(out)
    assert len(layers) == 6
    corners = [point for _, polygons, _ in layers for one in polygons for point in one.tolist()]
    assert max(x for x, _ in corners) == pytest.approx(7)
    assert main([*words, "--cylinder", "6x8x3", "--blend", "0.3"]) == 0
    assert len(read_binary_cli(out)) > 16


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--layer", "1", "-o", "a.stl"], "layers need one of .3mf, .cli"),
        (["--layer", "1", "-o", "a.3mf", "--beams"], "--beams is not for --layer"),
        (["--layer", "1", "-o", "a.cli", "--joints", "blend"], "--joints is not for layers"),
        (["--text", "-o", "a.3mf"], "--text is for layers; need --layer"),
        (["--layer", "1", "-o", "a.cli", "--size", "1e-9"], "is too small for a box of"),
    ],
)
def test_options_that_do_not_go_with_layers_are_refused(
    words: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    given = ["lattice", "--cell", "bcc", "--size", "1", "--radius", "0.1", "--box", "4"]
    assert main([*given, *words]) == 2
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
