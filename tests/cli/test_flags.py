"""Each flag of each command is tried, and does something."""

from __future__ import annotations

import argparse
import io
import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import Box, GeomType, export_step, import_step

from scaffold_cad import Skeleton, write
from scaffold_cad.cli import main, parsers
from scaffold_cad.io import read_triangles

TRIPOD = Skeleton([[0, 0, 0], [30, 0, 9], [0, 30, 9], [0, 0, 30]], [[0, 1], [0, 2], [0, 3]], 2.0)
BARE = "v 0 0 0\nv 30 0 0\nv 0 30 0\nv 0 0.001 0\nl 1 2\nl 4 3\n"

INPUT = (
    "--quiet --radius 1 --max-nodes 9 --units cm --scale 0.5 --join 0.1 --simplify 0.01"
    " --turn x:90 --mirror z"
)
"""Flags of all commands that read a skeleton."""

COMMON = {"--help", "--verbose", "--config", "--from", "--format"}
"""Flags of all commands, or of all that read and write."""

STREAMED = {
    "build": "- --from json -o - --format stl",
    "lattice": "--cell bcc --size 8 --radius 0.6 --box 8 -o - --format stl",
    "slice": "- --from json --layer 2 -o - --format cli",
    "convert": "- --from json -o - --format csv",
    "check": "- --from json",
    "strength": "- --from json --weight",
    "view": "- --from json --no-open -o a.html",
    "info": "- --from json",
    "cells": "",
    "formats": "",
}
"""A line of each command with those of these flags that it has."""

SHAPE = "--fit paper --section area --collars"
ROUND = "--round --joints blend --bend torus --blend 0.5 --ends open --wall 0.5 --sides 8"

LINES = {
    "build": [
        f"bare.obj {INPUT} -o a.stl",
        f"tripod.json --strict {SHAPE} --output b.step",
        f"tripod.json {ROUND} --overlaps unite --socket 1:1.8:5 --socket 2:1.7:4 -o c.stl",
        "tripod.json --as frame --strut-radius 0.3 -o d.stl",
        "tripod.json --tiles tiles --block 20 --jobs 1 -o e.stl",
        "tripod.json --round --nodes sharp --process sls -o f.step",
        "tripod.json --as hexahedra --round --sides 8 --layers 1 --along 3 --keep volume -o g.inp",
    ],
    "lattice": [
        f"--quiet --cell bcc --size 8 --radius 0.6 --box 8x8x8 {ROUND} --overlaps unite -o a.stl",
        "--cell bcc --size 8 --radius 0.6 --box 16x8x8 --trim --max-nodes 99 --output b.stl",
        "--cell bcc --size 8 --density 0.1 --inside box.step --skin 1 --drain 3 -o c.stl",
        "--cell bcc --size 8 --radius 0.6 --surface box.step --thickness 2 --beams -o k.json",
        (
            "--cell bcc --size 8 --radius 0.6 --face box.step --face-number 0 --to-face 1"
            " --beams -o l.json"
        ),
        "--cell bcc --size 5 --radius 0.4 --cylinder 10x10x5 --beams -o d.3mf",
        "--cell bcc --size 5 --radius 0.4 --box 10 --tiles tiles --block 1 --jobs 2 -o t.stl",
        "--cell octet --size 8 --radius 0.4 --sphere 12x6 --beams -o e.json",
        (
            "--cell bcc --size 5 --radius 0.4 --face box.step --face-number 0 --thickness 3"
            " --beams -o f.json"
        ),
        "--cell bcc --size 8 --radius 0.6 --box 8x8x8 --layer 0.5 --pixel 0.2 -o g.zip",
        "--cell bcc --size 8 --radius 0.6 --box 8x8x8 --layer 0.5 --text -o h.cli",
        "--cell bcc --size 8 --radius 0.6 --box 8x8x8 --round --nodes sharp -o i.stl",
        (
            "--foam voronoi --size 6 --radius 0.4 --box 12 --keep whole --no-dangling --shortest 1"
            " -o n.stl"
        ),
        f"--cell bcc --size 8 --radius 0.6 --box 8x8x8 {SHAPE} -o m.stl",
        (
            "--foam voronoi --count 20 --seed 1 --regularity 0.5 --stretch 1,1,2 --periodic"
            " --radius 0.5 --box 12 --process lpbf -o j.stl"
        ),
    ],
    "cells": ["--quiet --output cells.html", "--stiffness 0.05"],
    "check": [
        f"bare.obj {INPUT} --process fdm --material pla --direction 0,0,1 --no-supports",
        "tripod.stl --skeleton tripod.json --strict --html a.html",
        (
            "tripod.json --min-diameter 0.1 --min-gap 0.1 --max-slenderness 99 --max-bridge 99"
            " --min-opening 0 --layer 0.1 --overhang 10 --build-volume 99x99x99 --json"
        ),
        "tripod.json --tiles report --block 9 --jobs 1",
        f"tripod.json {SHAPE}",
        f"tripod.json {ROUND} --socket 1:1.8:5",
        "tripod.json --round --nodes ball",
        "tripod.json --as frame --strut-radius 0.9",
    ],
    "strength": [
        f"bare.obj {INPUT} --fix xmin --load xmax:0,0,-1",
        (
            "tripod.json --strict --material pla --young 2000 --strength 30 --weight --hollow 0.5"
            " --size 0.5 --html a.html --json --output b.json"
        ),
        "tripod.json --load xmax:0,0,-1 --tiles loaded --block 20 --jobs 1 -o c.npy",
    ],
    "view": [
        f"bare.obj {INPUT} --no-open --output a.html",
        f"tripod.json --strict {SHAPE} --no-open -o b.html",
        "tripod.json --as frame --strut-radius 0.3 --no-open -o c.html",
    ],
    "slice": [
        f"bare.obj {INPUT} --layer 2 --pixel 1 -o a.zip",
        "tripod.json --strict --layer 1 --blend 1 --ends open --wall 0.5 --sides 8 --text -o b.cli",
        "tripod.json --layer 1 --joints blend --bend 5 -o d.cli",
        "tripod.json --layer 1 --tiles layers --block 9 --jobs 1 -o e.cli",
        "tripod.json --layer 1 --inside box.step --skin 1 --output c.cli",
        "tripod.json --layer 1 --nodes sharp -o f.cli",
    ],
    "convert": [
        f"bare.obj {INPUT} -o a.json",
        "tripod.json --strict --to-units cm --jobs 1 --output b.csv",
    ],
    "formats": ["--quiet"],
    "info": ["bare.obj --quiet --strict --units cm --scale 0.5 --max-nodes 9 --json"],
}
"""Command lines, all flags of each command among them."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write(TRIPOD, "tripod.json")
    Path("bare.obj").write_text(BARE)
    return tmp_path


def commands() -> dict[str, argparse.ArgumentParser]:
    return parsers()[1]


@pytest.mark.parametrize("command", commands())
def test_each_flag_is_tried(command: str) -> None:
    flags = {flag for action in commands()[command]._actions for flag in action.option_strings}
    long = {flag for flag in flags if flag.startswith("--")} - COMMON
    assert long - set(" ".join(LINES[command]).split()) == set()


@pytest.mark.parametrize(
    "line", [f"{command} {line}" for command, lines in LINES.items() for line in lines]
)
def test_command_lines_with_each_flag_work(line: str, folder: Path) -> None:
    export_step(Box(16, 16, 16), "box.step")
    if "tripod.stl" in line:
        assert main(["build", "tripod.json", "-o", "tripod.stl"]) == 0
    words = shlex.split(line)
    assert main(words) in ((0, 1) if words[0] == "check" else (0,))
    for flag in ("-o", "--output", "--html"):
        if flag in words:
            assert (folder / words[words.index(flag) + 1]).stat().st_size > 0


@pytest.mark.parametrize("command", commands())
def test_flags_of_all_commands_are_tried_on_each(
    command: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsysbinary: pytest.CaptureFixture[bytes],
) -> None:
    stdin = io.TextIOWrapper(io.BytesIO(Path("tripod.json").read_bytes()))
    monkeypatch.setattr("sys.stdin", stdin)
    Path("options.toml").write_text(f"[{command}]\nquiet = true\n")
    words = [*STREAMED[command].split(), "--verbose", "--config", "options.toml"]
    flags = {flag for action in commands()[command]._actions for flag in action.option_strings}
    assert COMMON & flags - set(words) == {"--help"}
    assert main([command, *words]) == 0
    assert capsysbinary.readouterr().out
    with pytest.raises(SystemExit, match="0"):
        main([command, "--help"])
    assert f"scaffold-cad {command}".encode() in capsysbinary.readouterr().out


def verdicts(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    main(["check", "tripod.json", "--json", *words])
    findings = json.loads(capsys.readouterr().out)["findings"]
    return {name: one["verdict"] for name, one in findings.items()}


@pytest.mark.parametrize(
    ("flag", "value", "finding"),
    [
        ("--min-diameter", "9", "strut_diameter"),
        ("--max-slenderness", "1", "slenderness"),
        ("--overhang", "1", "strut_overhang"),
        ("--build-volume", "9x9x9", "build_volume"),
    ],
)
def test_limits_of_a_process_change_its_verdict(
    flag: str, value: str, finding: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    process = ("--process", "fdm")
    usual = verdicts(capsys, *process)[finding]
    assert verdicts(capsys, *process, flag, value)[finding] != usual


def test_sockets_are_bored_where_they_are_asked_for(folder: Path) -> None:
    hollow = "--round --wall 0.5 --ends open"
    line = f"build tripod.json {hollow} --socket 1:1.8:5 --socket 3:1.625:4 -o lug.step"
    assert main(line.split()) == 0
    faces = [f for f in import_step("lug.step").faces() if f.geom_type == GeomType.CYLINDER]
    bores = {round(face.radius, 9): face for face in faces if face.radius not in (1.5, 2.0)}
    assert sorted(bores) == [1.625, 1.8]
    assert bores[1.8].area == pytest.approx(2 * np.pi * 1.8 * 5)
    assert tuple(bores[1.625].axis_of_rotation.direction)[:2] == pytest.approx((0, 0))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--socket 1:1.8:5", "--socket is for --round"),
        ("--round --socket 1:1.8:5", "need --wall T --ends open"),
        ("--round --wall 0.5 --socket 1:1.8:5", "need --wall T --ends open"),
        ("--round --wall 0.5 --ends open --socket 1:1.8:5 --socket 1:1.7:5", "has node 1 twice"),
        (
            "--round --wall 0.5 --ends open --socket 0:1.8:5",
            "node 0, which is not an end of a strut",
        ),
        ("--round --wall 0.5 --ends open --socket 1:2.1:5", "the socket at node 1 at ["),
    ],
)
def test_sockets_that_cannot_be_are_named(
    line: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", "tripod.json", *line.split(), "-o", "lug.step"]) == 2
    assert message in capsys.readouterr().err


def test_sockets_have_three_numbers(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["build", "tripod.json", "--round", "--socket", "1:1.8", "-o", "lug.step"])
    assert "'1:1.8' is not a socket; need NODE:RADIUS:DEPTH" in capsys.readouterr().err


def test_walls_and_hollow_struts_are_thinner(folder: Path) -> None:
    assert main(["build", "tripod.json", "--round", "--wall", "0.5", "-o", "tube.stl"]) == 0
    assert main(["build", "tripod.json", "--round", "-o", "rod.stl"]) == 0
    assert Path("tube.stl").stat().st_size > 1.5 * Path("rod.stl").stat().st_size


def test_young_and_hollow_change_what_is_found(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def sag(*words: str) -> float:
        load = ["--fix", "0", "--load", "3:0,10,0"]
        assert main(["strength", "tripod.json", *load, "--json", *words]) == 0
        return float(json.loads(capsys.readouterr().out)["largest_displacement_mm"])

    assert sag("--young", "2100") == pytest.approx(100 * sag("--young", "210000"))
    assert sag("--hollow", "0.8") > 1.5 * sag()
    assert sag("--scale", "2") == pytest.approx(sag() / 2, rel=1e-9)


def test_units_and_scale_of_the_input_count(folder: Path) -> None:
    assert main(["build", "bare.obj", *INPUT.split(), "-o", "bare.stl"]) == 0
    mesh = read_triangles("bare.stl")
    assert mesh is not None
    assert np.ptp(mesh.vertices, axis=0)[[0, 2]] == pytest.approx([151, 151], abs=1)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("strength tripod.json --load 1:0,0,-9 --size 0", "--size is 0 mm; need > 0"),
        ("check tripod.json --min-diameter -1", "--min-diameter is -1 mm; need >= 0"),
        ("check tripod.json --max-slenderness -1", "--max-slenderness is -1; need >= 0"),
        ("check tripod.json --overhang -1", "--overhang is -1°; need >= 0"),
        ("check tripod.json --overhang 91", "--overhang is 91°; need 90 or less"),
        ("build tripod.json --join -1 -o a.stl", "--join is -1 mm; need > 0"),
        ("build tripod.json --simplify nan -o a.stl", "--simplify is nan mm; need >= 0"),
        ("build tripod.json --round --wall 3 -o a.stl", "--wall is 3 mm, and edge 0 near"),
        ("build tripod.json --round --sides 5 -o a.stl", "--sides is 5; need a multiple of 4"),
        ("build tripod.json --round --radius 0 -o a.stl", "--radius is 0 mm; need > 0"),
        (
            "build tripod.json --round --blend 0 -o a.stl",
            "--blend is 0 mm; need > 0, or --nodes sharp for edges without a fillet",
        ),
    ],
)
def test_numbers_out_of_range_are_told_by_their_flag(
    words: str,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    write(TRIPOD, "tripod.json")
    assert main(shlex.split(words)) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("slice tripod.json --layer 1e-9 -o a.cli", "--layer is 1e-09 mm for 3"),
        ("slice tripod.json --layer 1 --pixel 1e-5 -o a.zip", "--pixel is 1e-05 mm, which makes"),
        ("convert tripod.json --to-units parsec -o a.csv", "--to-units is 'parsec'; need one of"),
        (
            "lattice --cell bcc --size 8 --radius 1 --box 8 --beams --overlaps unite -o a.3mf",
            "--overlaps is for struts alone, and under a skin in STEP files; need no --beams",
        ),
        (
            "lattice --cell bcc --size 8 --radius 1 --box 8 --trim --overlaps refuse -o a.stl",
            "--overlaps is for struts alone, and under a skin in STEP files; need no --beams",
        ),
        ("convert tripod.json --jobs 0 -o a.csv", "--jobs is 0; need 1 or more"),
        ("build tripod.json --scale 0 -o a.stl", "--scale is 0; need > 0"),
        ("build tripod.json --units xx -o a.stl", "--units is 'xx'; need one of"),
        ("build tripod.json --max-nodes -1 -o a.stl", "--max-nodes is -1; need 0 or more"),
        ("lattice --cell xx --size 8 --radius 1 --box 8 -o a.stl", "--cell is 'xx'; need one of"),
        ("cells --stiffness 2", "--stiffness is 2; need more than 0, less than 1"),
        ("strength tripod.json --weight --material xx", "--material is 'xx'; need one of"),
        ("strength tripod.json --weight --young 0", "--young is 0 MPa; need > 0"),
        ("strength tripod.json --weight --hollow 2", "--hollow is 2; need 0 or more, less than 1"),
        ("strength tripod.json --weight --fix 9", "--fix names node 9; need 0 to 3"),
        ("strength tripod.json --load top:0,0,1", "--load has nodes 'top'; need xmin .. zmax"),
        (
            "strength tripod.json --weight --strength 1e-9 --size 0.5",
            "times the longest strut and more; need a higher strength",
        ),
        ("convert tripod.json --to-units in -o a.3mf", "--to-units is 'in', and 3MF files say"),
    ],
)
def test_limits_of_the_library_are_told_by_the_flag(
    words: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(shlex.split(words)) == 2
    assert message in capsys.readouterr().err
    assert not list(folder.glob("a.*"))


@pytest.mark.parametrize(
    ("words", "flag"),
    [
        ("build tripod.json --round --bend 0 -o a.stl", "--bend"),
        ("check tripod.json --build-volume 0", "--build-volume"),
        ("lattice --cell bcc --size 0 --radius 1 --box 8 -o a.stl", "--size"),
        ("lattice --foam voronoi --size=-1 --radius 1 --box 8 -o a.stl", "--size"),
        ("lattice --cell bcc --size 8 --radius 1 --box 8x-1x8 -o a.stl", "--box"),
        ("lattice --cell bcc --size 8 --radius 1 --sphere infx1 -o a.stl", "--sphere"),
    ],
)
def test_sizes_that_are_none_are_told_by_the_flag(
    words: str, flag: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(shlex.split(words))
    assert f"error: argument {flag}: '" in capsys.readouterr().err
    assert not list(folder.glob("a.*"))


@pytest.mark.parametrize("place", [0, 2_000, 4_500_000])
def test_info_counts_files_without_radii_wherever_they_are(
    place: int, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("far.obj").write_text(f"v {place} 0 0\nv {place + 2000} 0 0\nl 1 2\n")
    assert main(["info", "far.obj"]) == 0
    told = capsys.readouterr().out
    assert "none in the file" in told
    assert "2000 mm" in told


def test_info_asks_for_no_units_where_it_knows_no_radii(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("small.obj").write_text("v 0 0 0\nv 0.1 0 0\nl 1 2\n")
    assert main(["info", "small.obj"]) == 0
    told = capsys.readouterr()
    assert "none in the file" in told.out
    assert "check the units" not in told.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("build bare.obj --radius 1e-9 -o a.stl", "--radius is 1e-09 mm; need 3e-08 mm or more"),
        (
            "build bare.obj --radius 1 --scale 1e9 -o a.stl",
            "this far from the origin, for rounding (asked for also: --scale 1e9)",
        ),
        ("slice tripod.json --radius 1e9 --layer 2 -o a.cli", "(asked for also: --radius 1e9)"),
        ("build tripod.json --join 1e9 -o a.stl", "mm; need at least one (asked for: --join 1e9)"),
        (
            "build tripod.json --round --wall 1e-9 --ends open -o a.stl",
            "need at most",
        ),
        (
            "lattice --cell bcc --size 1e-9 --radius 1 --box 8 -o a.stl",
            "(asked for: --size 1e-9, --radius 1, --box 8)",
        ),
        (
            "build tripod.json --as frame --strut-radius 1e-9 -o a.stl",
            "for rounding (asked for: --strut-radius 1e-9)",
        ),
        (
            "lattice --foam voronoi --count 9 --stretch 0,1,1 --radius 1 --box 8 -o a.stl",
            "--stretch is [0.0, 1.0, 1.0]; need",
        ),
        ("check tripod.json --direction nan,0,1", "--direction is [nan, 0.0, 1.0]; need a dir"),
        ("slice tripod.json --layer 1e9 -o a.cli", "--layer is 1e+09 mm for"),
        ("strength tripod.json --load xmax:nan,0,1", "--load is 'xmax:nan,0,1'; need WHERE"),
    ],
)
def test_what_flags_come_to_is_told_with_the_flag(
    words: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(shlex.split(words)) == 2
    told = capsys.readouterr().err.strip().splitlines()[-1]
    assert message in told
    assert "--" in told
    assert not list(folder.glob("a.*"))
