"""`scaffold-cad strength` and the table of cells' stiffness."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, read_skeleton, write
from scaffold_cad.cli import main
from scaffold_cad.lattice import tile

ARM = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 5.0)


@pytest.fixture
def arm(tmp_path: Path) -> str:
    write(ARM, tmp_path / "arm.json")
    return str(tmp_path / "arm.json")


def test_table_tells_the_stress_and_the_sag(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["strength", arm, "--fix", "xmin", "--load", "xmax:0,0,-100"]) == 0
    said = capsys.readouterr().out
    assert "largest displacement mm  0.32" in said
    assert "largest stress MPa       101.86" in said


def test_json_holds_every_strut(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["strength", arm, "--fix", "0", "--load", "x>99:1000,0,0", "--json", "--strength", "50"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["strut_count"] == 1
    assert found["struts"][0]["axial_N"] == pytest.approx(1000)
    assert found["stress_utilization"] == pytest.approx(1000 / (78.5398 * 50), rel=1e-4)


def test_sized_radii_are_written(arm: str, tmp_path: Path) -> None:
    words = ["strength", arm, "--fix", "xmin", "--load", "xmax:5000,0,0", "--size", "0.5"]
    assert main([*words, "-o", str(tmp_path / "sized.json")]) == 0
    radius = read_skeleton(tmp_path / "sized.json").edge_radii[0, 0]
    assert radius == pytest.approx((5000 / 235 / 3.14159265) ** 0.5, rel=3e-3)


def test_beam_models_are_written(arm: str, tmp_path: Path) -> None:
    out = tmp_path / "arm.inp"
    assert main(["strength", arm, "--fix", "xmin", "--weight", "-o", str(out)]) == 0
    assert "B32R" in out.read_text()


@pytest.mark.parametrize("name", ["arm.stl", "arm.xyz"])
def test_all_files_that_hold_beams_are_named(
    name: str, arm: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / name
    assert main(["strength", arm, "--fix", "xmin", "--weight", "-o", str(out)]) == 2
    said = capsys.readouterr().err
    assert "loaded beams; need .3mf, .bdf, .csv, .graphml, .inp, .json, .obj, .swc, .tcl" in said


def test_page_tells_how_many_struts_are_overloaded(arm: str, tmp_path: Path) -> None:
    out = tmp_path / "arm.html"
    words = ["strength", arm, "--fix", "xmin", "--load", "xmax:0,0,-500", "--html", str(out)]
    assert main(words) == 0
    text = out.read_text("utf-8")
    assert "1 strut, above 1: overloaded" in text
    assert 'value="supports"' in text
    assert main([*words[:-1], str(tmp_path / "arm.txt")]) == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "nothing loads the struts; need --load"),
        (["--load", "top:1,2,3"], "--load has nodes 'top'; need xmin"),
        (["--load", "xmax:1,2"], "need WHERE:FX,FY,FZ"),
        (["--weight", "--fix", "xmin:x"], "supports hold"),
        (["--weight", "--material", "cheese"], "material is 'cheese'"),
    ],
)
def test_bad_words_are_named(
    arm: str, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["strength", arm, *words]) == 2
    assert message in capsys.readouterr().err


def test_cells_are_listed_with_their_stiffness(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cells", "--stiffness", "0.01"]) == 0
    rows = {line.split()[0]: line.split()[1:] for line in capsys.readouterr().out.splitlines()[1:]}
    assert float(rows["sc"][0]) == pytest.approx(1 / 3, abs=1e-4)
    assert float(rows["octet"][0]) == pytest.approx(1 / 9, rel=0.02)


def test_supports_and_loads_of_a_file_are_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = ["node 1 0 0 0", "node 2 100 0 0", "element elasticBeamColumn 1 1 2 78.54 210e3"]
    path = tmp_path / "arm.tcl"
    path.write_text("\n".join([*lines, "fix 1 1 1 1 1 1 1", "load 2 0 0 -100 0 0 0"]))
    assert main(["strength", str(path)]) == 0
    assert "largest displacement mm  0.32" in capsys.readouterr().out
    assert main(["strength", str(path), "--load", "xmax:0,0,-200"]) == 0
    assert "largest displacement mm  0.65" in capsys.readouterr().out
    assert main(["strength", str(path), "--fix", "xmax"]) == 0
    assert "largest displacement mm  0\n" in capsys.readouterr().out
    path.write_text("\n".join(lines))
    assert main(["strength", str(path)]) == 2
    assert "nothing loads the struts" in capsys.readouterr().err


def test_strength_by_tiles_is_that_of_one_process(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lattice = str(tmp_path / "bcc.json")
    write(tile("bcc", 5.0, (3, 2, 2), radius=0.4), lattice)
    words = ["strength", lattice, "--fix", "xmin:x,y,z", "--fix", "y<0.1:y", "--weight"]
    words += ["--load", "xmax:0,0,-100", "--load", "1,3:0,5,0", "--json"]
    assert main(words) == 0
    whole = json.loads(capsys.readouterr().out)
    rows = tmp_path / "rows.npy"
    tiles = ["--tiles", str(tmp_path / "parts"), "--block", "6", "-o", str(rows)]
    assert main([*words, *tiles]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["struts"] == whole["strut_count"] == len(np.load(rows))
    for name in ("largest_displacement_mm", "largest_stress_MPa", "buckling_utilization"):
        assert found[name] == pytest.approx(whole[name], rel=1e-7)
    used = sorted(row["utilization"] for row in whole["struts"])
    np.testing.assert_allclose(np.sort(np.load(rows)[:, -1]), used, rtol=1e-6)
    assert main([*words[:-1], *tiles]) == 0  # found again, as a table
    assert "largest stress MPa" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--size", "1"], "--size is not for --tiles"),
        (["-o", "sized.json"], "--tiles write a row per strut, as .npy"),
        (["--fix", "7"], "--fix names node 7; need 0 to 1"),
    ],
)
def test_tiles_refuse_what_they_do_not_make(
    arm: str, words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tiles = ["--tiles", str(tmp_path / "parts")]
    assert main(["strength", arm, "--load", "xmax:0,0,-1", *tiles, *words]) == 2
    assert said in capsys.readouterr().err
