"""`--tiles` of build, slice and check: what one process makes of a skeleton, tile by tile."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, write
from scaffold_cad.cli import main
from scaffold_cad.cli.tiled import ENOUGH
from scaffold_cad.lattice import tile
from scaffold_cad.tiles.tiling import block_size
from tests.cli.test_latticetiles import facets


@pytest.fixture
def lattice(tmp_path: Path) -> str:
    write(tile("bcc", 5.0, (3, 2, 2), radius=0.4), tmp_path / "bcc.json")
    return str(tmp_path / "bcc.json")


@pytest.mark.parametrize(
    "words", [[], ["--collars", "--section", "inscribed"], ["--round", "--blend", "0.3"]]
)
def test_a_skeleton_built_by_tiles_is_that_of_one_process(
    words: list[str], lattice: str, tmp_path: Path
) -> None:
    whole, tiled, folder = (str(tmp_path / name) for name in ("whole.stl", "tiled.stl", "parts"))
    assert main(["build", lattice, *words, "-o", whole]) == 0
    given = ["--tiles", folder, "--block", "7", "--jobs", "2"]
    assert main(["build", lattice, *words, *given, "-o", tiled]) == 0
    assert len(list((tmp_path / "parts").glob("tile-*.stl"))) == 8
    np.testing.assert_array_equal(facets(tmp_path / "tiled.stl"), facets(tmp_path / "whole.stl"))


def test_its_layers_have_the_same_volume(lattice: str, tmp_path: Path) -> None:
    areas = []
    for words in ([], ["--tiles", str(tmp_path / "parts"), "--block", "7"]):
        out = tmp_path / f"{len(areas)}.cli"
        assert main(["slice", lattice, "--layer", "0.1", "--text", *words, "-o", str(out)]) == 0
        areas.append(area(out.read_text()))
    assert areas[1] == pytest.approx(areas[0], rel=2e-3)


def area(text: str) -> float:
    """Return the sum of the areas of all polygons of a .cli file, in its units."""
    total = 0.0
    for line in text.splitlines():
        if line.startswith("$$POLYLINE/"):
            numbers = np.array(line.split("/")[1].split(",")[3:], dtype=float).reshape(-1, 2)
            x, y = numbers.T
            total += 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    return total


def test_struts_are_checked_by_tiles(
    lattice: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--tiles", str(tmp_path / "parts"), "--block", "7"]
    assert main(["check", lattice, "--process", "sls", *words]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["struts"] == 96
    assert report["printable"]
    assert main(["check", lattice, "--process", "sls", "--radius", "0.1", *words]) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["build", "-o", "a.obj", "--tiles", "p"], "tiles are joined as .stl"),
        (["build", "-o", "a.stl", "--tiles", "p", "--as", "frame"], "need it without --as"),
        (["build", "-o", "a.stl", "--block", "5"], "--block is for --tiles"),
        (["build", "-o", "a.stl", "--tiles", "p", "--block", "0"], "--block is 0 mm"),
        (["slice", "-o", "a.cli", "--layer", "1", "--jobs", "2"], "--jobs is for --tiles"),
        (["check", "--tiles", "p", "--min-gap", "1"], "--min-gap is not for a report by --tiles"),
        (["check", "--jobs", "2"], "--jobs is for --tiles"),
    ],
)
def test_what_tiles_of_skeletons_cannot_do_is_said(
    words: list[str],
    said: str,
    lattice: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([words[0], lattice, *words[1:]]) == 2
    assert said in capsys.readouterr().err


def test_a_block_holds_as_many_struts_as_a_tile_should() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(40.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    lines = np.arange(40**3).reshape(40, 40, 40)
    edges = np.stack([lines[:-1].reshape(-1), lines[1:].reshape(-1)], axis=1)
    cube = Skeleton(grid * 3.0, edges, 0.5)
    assert block_size(cube, ENOUGH) == pytest.approx(117.0 * (ENOUGH / len(edges)) ** (1 / 3))
    flat = Skeleton(grid * [3.0, 3.0, 0.01], edges, 0.001)
    assert block_size(flat, ENOUGH) > 0.39  # one layer of blocks
    strut = Skeleton([[0, 0, 0], [5, 0, 0]], [[0, 1]], 1.0)
    assert block_size(strut, ENOUGH) >= 5.0


def test_blocks_of_a_strut_each_are_refused_before_a_tile_is_made(
    lattice: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    many, out = str(tmp_path / "many.json"), tmp_path / "a.stl"
    write(tile("bcc", 5.0, 3, radius=0.4), many)
    words = ["--tiles", str(tmp_path / "parts"), "-o", str(out)]
    assert main(["build", many, *words, "--block", "1e-6"]) == 2
    told = capsys.readouterr().err
    assert "--block 1e-06 (mm) makes 216 tiles of 216 struts; need 3.97 mm or more" in told
    assert not out.exists()
    assert not (tmp_path / "parts").exists()
    assert main(["build", lattice, *words, "--block", "1e-6"]) == 0  # few tiles are made soon
