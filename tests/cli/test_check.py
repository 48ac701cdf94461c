"""`scaffold-cad check`: exit codes, reports, and options that would do nothing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from build123d import Box, Shape
from OCP.IGESControl import IGESControl_Writer

from scaffold_cad import BeamLattice, build_scaffold, check_printability, write
from scaffold_cad.cli import main
from scaffold_cad.errors import OptionError
from scaffold_cad.io import read_triangles
from tests.meshes import CUBE, OPEN_CUBE
from tests.skeletons import K4, ZIGZAG


def test_it_gives_0_for_printable_1_for_not_and_2_for_bad_input(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(K4, tmp_path / "k4.json")
    write(OPEN_CUBE, tmp_path / "open.ply")
    assert main(["check", str(tmp_path / "k4.json")]) == 0
    assert "printable by sls" in capsys.readouterr().out
    assert main(["check", str(tmp_path / "k4.json"), "--radius", "0.2"]) == 1
    assert "raise the radius to 0.4" in capsys.readouterr().out
    assert main(["check", str(tmp_path / "k4.json"), "--min-diameter", "3"]) == 1
    assert main(["check", str(tmp_path / "k4.json"), "--build-volume", "5,5,5"]) == 1
    assert main(["check", str(tmp_path / "open.ply")]) == 1
    assert main(["check", str(tmp_path / "absent.stl")]) == 2
    assert "absent.stl" in capsys.readouterr().err


def test_occt_prints_nothing_where_results_go(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "page.step"
    path.write_text("<!DOCTYPE html>")
    assert main(["check", str(path), "--json"]) == 2
    assert capfd.readouterr().out == ""


def test_it_prints_json_and_writes_the_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(build_scaffold(K4), tmp_path / "k4.stl")
    write(K4, tmp_path / "k4.json")
    arguments = ["--skeleton", str(tmp_path / "k4.json"), "--direction", "best", "--json"]
    arguments += ["--process", "fdm", "--overhang", "30", "--html", str(tmp_path / "k4.html")]
    assert main(["check", str(tmp_path / "k4.stl"), *arguments]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["findings"]["genus"]["value"] == {"genus": 3, "loops": 3}
    assert told["findings"]["strut_diameter"]["value"]["least_mm"] == 2.0
    assert told["findings"]["strut_overhang"]["value"]["needed_deg"] == pytest.approx(30)
    assert "k4.stl" in (tmp_path / "k4.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "shape",
    ["--collars", "--fit paper", "--round --sides 8 --blend 0.4", "--round --wall 0.3 --ends open"],
)
def test_it_looks_at_the_very_solid_that_build_makes(
    shape: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = str(tmp_path / "k4.json"), str(tmp_path / "k4.stl")
    write(K4, path)
    assert main(["build", path, *shape.split(), "-o", out]) == 0
    built = read_triangles(out)
    assert built is not None
    main(["check", path, *shape.split(), "--json"])
    told = json.loads(capsys.readouterr().out)["findings"]
    assert told["volume"]["value"]["volume_mm3"] == pytest.approx(built.signed_volume, rel=1e-5)


def test_shapes_are_refused_for_what_has_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = str(tmp_path / "k4.json"), str(tmp_path / "k4.stl")
    write(K4, path)
    write(build_scaffold(K4), out)
    for words in (["--round"], ["--as", "frame"], ["--collars", "--skeleton", path]):
        assert main(["check", out, *words]) == 2
        message = f"{words[0]} is for skeletons; a mesh is looked at as it is"
        assert message in capsys.readouterr().err
    with pytest.raises(OptionError, match="sides are for RoundStruts only; part is a Scaffold"):
        check_printability(build_scaffold(K4), sides=8)


def test_a_skeleton_beside_a_skeleton_is_bad_input(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(K4, tmp_path / "k4.json")
    path = str(tmp_path / "k4.json")
    assert main(["check", path, "--skeleton", path]) == 2
    assert "--skeleton is for mesh files" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "name"),
    [
        (["--radius", "5"], "--radius"),
        (["--simplify", "0"], "--simplify"),
        (["--strict"], "--strict"),
        (["--max-nodes", "1"], "--max-nodes"),
    ],
)
def test_options_of_skeletons_are_refused_for_a_mesh(
    options: list[str], name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(build_scaffold(K4), tmp_path / "k4.stl")
    assert main(["check", str(tmp_path / "k4.stl"), *options]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert f"{name} is for skeletons; need --skeleton beside a mesh" in captured.err


def test_the_skeleton_beside_a_mesh_is_read_with_the_options_of_skeletons(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(build_scaffold(ZIGZAG), tmp_path / "zigzag.stl")
    write(ZIGZAG, tmp_path / "zigzag.json")
    command = ["check", str(tmp_path / "zigzag.stl"), "--skeleton", str(tmp_path / "zigzag.json")]
    assert main([*command, "--max-nodes", "1"]) == 2
    assert "zigzag.json has 6 nodes" in capsys.readouterr().err
    # What is left of the zigzag leaves the part.
    assert main([*command, "--radius", "2.5", "--simplify", "100", "--json"]) == 1
    captured = capsys.readouterr()
    assert "simplified from 5 to 1 edge" in captured.err
    findings = json.loads(captured.out)["findings"]
    assert "mm, not 5" in findings["strut_diameter"]["advice"]
    assert findings["struts_in_part"]["value"] == {"outside": 1, "cut": 0, "struts": 1}


def test_the_skeleton_of_another_part_fails_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(build_scaffold(K4), tmp_path / "k4.stl")
    write(ZIGZAG, tmp_path / "zigzag.json")
    write(K4, tmp_path / "k4.json")
    command = ["check", str(tmp_path / "k4.stl"), "--skeleton"]
    assert main([*command, str(tmp_path / "zigzag.json")]) == 1
    assert "not printable by sls: struts in part" in capsys.readouterr().out
    assert main([*command, str(tmp_path / "k4.json")]) == 0
    assert "every strut is in the part" in capsys.readouterr().out


def test_the_beams_of_a_3mf_file_are_checked_as_they_are_built(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "beams.3mf"
    write(BeamLattice(K4, mesh=CUBE), path)
    assert main(["check", str(path)]) == 0
    captured = capsys.readouterr()
    assert "6 beams united with 1 mesh of 12 triangles" in captured.err
    assert main(["check", str(path), "--radius", "0.1"]) == 1
    assert "raise the radius to 0.4" in capsys.readouterr().out


@pytest.mark.parametrize("suffix", [".step", ".brep"])
@pytest.mark.parametrize("command", [["view", "--no-open"], ["check"]])
def test_parts_of_cad_systems_are_taken(
    command: list[str], suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"part{suffix}"
    write(build_scaffold(K4), path)
    assert main([*command, str(path)]) == 0
    assert "part" in capsys.readouterr().out


def written_iges(folder: Path, shape: Shape) -> Path:
    writer = IGESControl_Writer()
    writer.AddShape(shape.wrapped)
    writer.Write(str(folder / "part.igs"))
    return folder / "part.igs"


def test_the_faces_of_an_iges_file_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written_iges(tmp_path, Box(1, 1, 1))
    assert main(["check", str(path)]) == 2
    assert "part.igs is an IGES file with faces; need STEP, BREP or STL" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["5x5x5", "5X5X5", "5,5,5", "5"])
def test_the_build_volume_is_given_as_boxes_are(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(K4, tmp_path / "k4.json")
    assert main(["check", str(tmp_path / "k4.json"), "--build-volume", text]) == 1
    assert "mm, larger than 5 x 5 x 5" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("option", "text", "complaint"),
    [("--build-volume", "1,2", "need 40x40x20"), ("--direction", "up", "as in 0,0,1")],
)
def test_numbers_that_are_none_are_refused(
    option: str, text: str, complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["check", "k4.json", option, text])
    assert complaint in capsys.readouterr().err
