"""`--process` of what builds: struts that cannot be printed are told before they are made."""

from __future__ import annotations

from pathlib import Path

import pytest

from scaffold_cad import Skeleton, write
from scaffold_cad.cli import main

STRUT = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 0.45)
GRADED = "0,0,0,0.39\n10,0,0,0.6\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write(STRUT, "strut.json")
    Path("radii.csv").write_text(GRADED)
    return tmp_path


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "build strut.json --radius 0.3",
            "sls: 1 strut too thin: strut 0 is 0.6 mm, SLS needs 0.8",
        ),
        ("build strut.json --round --radius 0.3", "raise the radius to 0.4 or more"),
        # Half the width of a square in a circle is 0.7071 of its radius.
        ("build strut.json --section inscribed", "strut 0 is 0.6364 mm, SLS needs 0.8: raise"),
        ("build strut.json --as frame --strut-radius 0.1", "struts too thin: strut 0 is 0.2 mm"),
        ("build strut.json --radius 0.3 --tiles tiles", "strut 0 is 0.6 mm, SLS needs 0.8"),
        ("lattice --cell bcc --size 8 --box 8 --radius 0.3", "8 struts too thin: strut 0 is 0.6"),
        ("lattice --cell bcc --size 8 --box 8 --radius 0.3 --trim", "struts too thin"),
        ("lattice --cell bcc --size 8 --box 8 --radius 0.3 --skin 1", "struts too thin"),
        ("lattice --cell bcc --size 8 --sphere 20x8 --radius 0.3", "struts too thin"),
        ("lattice --foam voronoi --size 4 --box 8 --radius 0.3", "struts too thin"),
        ("lattice --cell bcc --size 8 --box 8 --radius 0.3 --tiles tiles", "struts of 0.6 mm, SLS"),
        ("lattice --cell bcc --size 8 --box 8 --radius radii.csv --tiles t", "struts of 0.78 mm"),
        ("lattice --cell bcc --size 8 --box 8 --radius 0.3 --layer 1", "struts of 0.6 mm, SLS"),
    ],
)
def test_thin_struts_are_refused_before_they_are_made(
    line: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = "out.cli" if "--layer" in line else "out.stl"
    assert main([*line.split(), "--process", "sls", "-o", out]) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert "not printable by sls: " in told
    assert message in told
    assert sorted(path.name for path in folder.iterdir()) == ["radii.csv", "strut.json"]


def test_struts_as_thick_as_the_process_asks_are_built() -> None:
    assert main(["build", "strut.json", "--process", "sls", "-o", "a.stl"]) == 0
    line = "lattice --cell bcc --size 8 --box 8 --radius 0.4 --process SLS"
    assert main([*line.split(), "--trim", "-o", "b.stl"]) == 0
    assert main([*line.split(), "--tiles", "tiles", "--overlaps", "allow", "-o", "c.stl"]) == 0


def test_slender_struts_and_narrow_gaps_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    pair = Skeleton([[0, 0, 0], [0, 0, 30], [1, 0, 0], [1, 0, 30]], [[0, 1], [2, 3]], 0.4)
    write(pair, "pair.json")
    assert main(["build", "pair.json", "--process", "sls", "-o", "a.stl"]) == 0
    told = capsys.readouterr().err
    assert "sls: 2 struts may bend or break: strut 0 is 30 mm long" in told
    assert "sls: 1 pair of struts may fuse, SLS needs 0.5 mm" in told


def test_a_process_is_for_struts(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "strut.json", "--as", "shell", "--process", "sls", "-o", "a.obj"]) == 2
    assert "--process looks at struts; need it without --as shell" in capsys.readouterr().err
