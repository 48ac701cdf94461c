"""The command line: exit codes, one clear line for bad input, and products that hold."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad import __version__
from scaffold_cad.cli import main
from scaffold_cad.errors import OptionError
from scaffold_cad.io import read_skeleton, skeleton_to_json
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from tests import skeletons as named
from tests.real_files import RADII
from tests.scaffold.test_embedding import CROSSING

MESHES = (".stl", ".3mf", ".obj", ".ply", ".glb")


@pytest.fixture
def figure(tmp_path: Path) -> str:
    """Return the path of a file with the stick figure."""
    path = tmp_path / "figure.json"
    path.write_text(skeleton_to_json(named.STICK_FIGURE), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("suffix", MESHES)
def test_build_writes_a_watertight_solid(figure: str, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"figure{suffix}"
    assert main(["build", figure, "-o", str(out)]) == 0
    mesh = trimesh.load(out, force="mesh", process=True)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0


def test_build_writes_a_valid_step_solid(figure: str, tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    out = tmp_path / "figure.step"
    assert main(["build", figure, "-o", str(out)]) == 0
    solids = build123d.import_step(str(out)).solids()
    assert len(solids) == 1
    assert solids[0].is_valid


@pytest.mark.parametrize(("sides", "ends"), [(8, "flat"), (16, "round")])
def test_round_struts_have_the_volume_of_their_cylinder(
    sides: int, ends: str, tmp_path: Path
) -> None:
    source, out = tmp_path / "strut.json", tmp_path / "strut.stl"
    source.write_text(skeleton_to_json(named.STRUT), encoding="utf-8")
    options = ["--round", "--sides", str(sides), "--ends", ends]
    assert main(["build", str(source), "-o", str(out), *options]) == 0
    mesh = trimesh.load(out)
    assert mesh.is_watertight
    if ends == "flat":
        assert len(mesh.faces) == 4 * sides  # a band and two discs
        assert mesh.volume == pytest.approx(10 * np.pi, rel=1e-6)
    else:
        assert mesh.volume == pytest.approx(10 * np.pi + 4 / 3 * np.pi, rel=1e-3)
        # Facets of the volume of a ball reach a little beyond it.
        assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(12.0, abs=0.04)


def test_a_wider_blend_adds_volume(tmp_path: Path) -> None:
    source, volumes = tmp_path / "tripod.json", []
    source.write_text(skeleton_to_json(named.TRIPOD), encoding="utf-8")
    for blend in ("0.2", "0.6", "1.2"):
        out = tmp_path / f"{blend}.stl"
        assert main(["build", str(source), "--round", "--blend", blend, "-o", str(out)]) == 0
        volumes.append(trimesh.load(out).volume)
    assert volumes == sorted(volumes)
    assert volumes[0] < volumes[2] - 0.5


def test_a_round_step_file_holds_a_valid_solid_with_exact_cylinders(tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    source, out = tmp_path / "tripod.json", tmp_path / "round.step"
    source.write_text(skeleton_to_json(named.TRIPOD), encoding="utf-8")
    assert main(["build", str(source), "-o", str(out), "--round"]) == 0
    (solid,) = build123d.import_step(str(out)).solids()
    assert solid.is_valid
    radii = [face.radius for face in solid.faces().filter_by(build123d.GeomType.CYLINDER)]
    np.testing.assert_allclose(radii, np.ones(3) * named.TRIPOD.radii[0], rtol=1e-9)


@pytest.mark.parametrize("suffix", [".stl", ".step"])
def test_frames_have_more_faces_than_their_scaffold(
    figure: str, tmp_path: Path, suffix: str
) -> None:
    scaffold, frame = tmp_path / f"scaffold{suffix}", tmp_path / f"frame{suffix}"
    assert main(["build", figure, "-o", str(scaffold)]) == 0
    command = ["build", figure, "-o", str(frame), "--as", "frame", "--strut-radius", "0.05"]
    assert main(command) == 0
    assert frame.stat().st_size > 5 * scaffold.stat().st_size


def test_a_shell_keeps_the_quads(figure: str, tmp_path: Path) -> None:
    out = tmp_path / "shell.obj"
    assert main(["build", figure, "-o", str(out), "--as", "shell"]) == 0
    quads = [line for line in out.read_text(encoding="utf-8").splitlines() if line.startswith("f ")]
    edges, tips = len(named.STICK_FIGURE.edges), len(named.STICK_FIGURE.extremities)
    assert len(quads) == 4 * edges + tips


@pytest.mark.parametrize(
    ("options", "found"), [([], "2 of 3 struts"), (["--round"], "2 of 3 struts")]
)
def test_overlaps_are_said_and_united(
    options: list[str], found: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, out = tmp_path / "crossing.json", tmp_path / "crossing.stl"
    source.write_text(skeleton_to_json(CROSSING))
    assert main(["build", str(source), "-o", str(out), *options]) == 0
    (line,) = [line for line in capsys.readouterr().err.splitlines() if "struts overlap" in line]
    assert f"{found} overlap others or their nodes (edges 0, 1; the first near" in line
    assert line.endswith("; they are united")
    assert trimesh.load(out).is_watertight


@pytest.mark.parametrize("name", ["figure.foo", "figure.json", "figure.swc"])
def test_a_file_that_holds_no_solid_is_refused_before_the_skeleton_is_read(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", str(tmp_path / "absent.json"), "-o", str(tmp_path / name)]) == 2
    told = capsys.readouterr().err
    assert told.endswith("need one of .3mf, .brep, .glb, .obj, .ply, .step, .stl, .stp, .stpz\n")


def test_faces_of_step_files_are_named_after_their_edges_and_nodes(
    figure: str, tmp_path: Path
) -> None:
    names = []
    for options in ([], ["--round"]):
        out = tmp_path / "named.step"
        assert main(["build", figure, "-o", str(out), *options]) == 0
        text = out.read_text(encoding="ascii")
        names.append(set(re.findall(r"ADVANCED_FACE\('([^']*)'", text)))
    edges = {f"edge {i}" for i in range(10)}
    nodes = range(len(named.STICK_FIGURE.nodes))
    ends = named.STICK_FIGURE.extremities.tolist()
    assert names[0] == edges
    assert names[1] == {
        *(f"strut {i}" for i in range(10)),
        *(f"node {i}" for i in nodes if i not in ends),
        *(f"end {i}" for i in ends),
    }


def test_a_frame_tells_the_radius_that_it_took(
    figure: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", figure, "-o", str(tmp_path / "f.stl"), "--as", "frame"]) == 0
    assert "the frame's struts have radius" in capsys.readouterr().err


def test_quiet_says_nothing(
    figure: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", figure, "-o", str(tmp_path / "f.stl"), "--quiet"]) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == ""


def test_simplify_drops_joints(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = str(shared_data / "nrn_ordering.swc")
    out = tmp_path / "neuron.stl"
    assert main(["build", source, "-o", str(out), "--simplify", "0.5"]) == 0
    assert "simplified from 3782 to" in capsys.readouterr().err
    assert trimesh.load(out).is_watertight


def test_info_counts(figure: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", figure]) == 0
    rows = dict(
        line.split("  ", 1) for line in capsys.readouterr().out.splitlines() if "  " in line
    )
    rows = {name.strip(): value.strip() for name, value in rows.items()}
    skeleton = named.STICK_FIGURE
    assert rows["nodes"] == str(len(skeleton.nodes))
    assert rows["edges"] == str(len(skeleton.edges))
    assert rows["components"] == str(skeleton.component_count)
    assert rows["loops"] == str(skeleton.loop_count)
    assert rows["joints"] == str(len(skeleton.joints))
    assert rows["extremities"] == str(len(skeleton.extremities))
    assert rows["branch points"].startswith(f"{len(skeleton.branch_points)} (")
    assert rows["repairs"] == "nothing"


@pytest.mark.parametrize("command", [["info"], ["build", "-o", "x.stl"]])
def test_more_nodes_than_asked_for_are_refused(
    figure: str, command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*command, figure, "--max-nodes", "3"]) == 2
    assert "need at most 3 nodes" in capsys.readouterr().err


def test_info_needs_no_radii(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "lines.obj"
    source.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\nl 3 2\n")
    assert main(["info", str(source)]) == 0
    out = capsys.readouterr().out
    assert "none in the file: build needs --radius" in out
    assert "1 duplicate edge" in out


@pytest.mark.parametrize("suffix", ["3mf", "obj", "step", "brep"])
def test_info_counts_solids_as_check_does(
    figure: str, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    solid = tmp_path / f"solid.{suffix}"
    assert main(["build", figure, "-o", str(solid)]) == 0
    assert main(["info", str(solid)]) == 0
    told = capsys.readouterr()
    assert "none: a solid" in told.out
    assert re.search(r"open edges +0\n", told.out)
    volume = float(re.search(r"volume +(\S+) mm³\n", told.out)[1])  # type: ignore[index]
    exact = build_scaffold(named.STICK_FIGURE).mesh.signed_volume
    assert volume == pytest.approx(exact, rel=0.01)


def test_struts_that_widen_to_their_nodes_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    rows = ["0,0,0,60,0,0,5", "60,0,0,60,50,0,3", "60,0,0,60,0,50,5"]
    Path("truss.csv").write_text("\n".join(["x1,y1,z1,x2,y2,z2,radius", *rows]))
    assert main(["build", "truss.csv", "-o", "square.stl"]) == 0
    said = "1 of 3 struts widen to the radius of a node (edge 1: 3 mm, node 1 at [60, 0, 0] mm"
    assert said in capsys.readouterr().err
    for kept in ("--round", "--collars"):
        assert main(["build", "truss.csv", kept, "-o", "kept.stl"]) == 0
        assert "widen" not in capsys.readouterr().err
        assert trimesh.load("kept.stl").volume < trimesh.load("square.stl").volume


def test_struts_keep_their_radii_at_joints_with_collars(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    header = "x1,y1,z1,x2,y2,z2,radius\n"
    Path("truss.csv").write_text(header + "0,0,0,60,0,0,5\n60,0,0,120,0,0,2\n")
    area = ["--section", "area", "--collars"]
    assert main(["build", "truss.csv", *area, "-o", "kept.stl"]) == 0
    assert "widen" not in capsys.readouterr().err
    step = np.pi * ((5**2 + 5 * 2 + 2**2) / 3 - 2**2)  # of 1 mm
    cylinders = np.pi * (5**2 + 2**2) * 60
    assert trimesh.load("kept.stl").volume == pytest.approx(cylinders + step, rel=1e-6)
    # Too short for a collar, which is told.
    Path("short.csv").write_text(header + "0,0,0,60,0,0,5\n60,0,0,60.4,0,0,2\n")
    assert main(["build", "short.csv", *area, "-o", "short.stl"]) == 0
    assert "--collars where there is room" in capsys.readouterr().err


def test_a_skeleton_is_not_written_to_a_file_of_solids(
    figure: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.stl"
    assert main(["convert", figure, "-o", str(out)]) == 2
    assert "out.stl cannot hold a skeleton, only a solid of it; need .3mf, .csv" in (
        capsys.readouterr().err
    )
    assert list(tmp_path.glob("out*")) == []


BAD_INPUT = [
    (["build", "missing.swc", "-o", "x.stl"], "missing.swc cannot be read: there is no such file"),
    (["info", "missing.swc"], "missing.swc cannot be read: there is no such file"),
    (["build", "FIGURE", "-o", "x.dwg"], "its suffix is '.dwg'; need one of .3mf"),
    (["build", "FIGURE", "-o", "nowhere/x.stl"], "there is no folder nowhere"),
    (["build", "FIGURE", "-o", "x.stl", "--radius", "-1"], "radius is -1 mm; need > 0"),
    (
        ["build", "FIGURE", "-o", "x.stl", "--round", "--sides", "4000000000"],
        "sides is 4000000000; need at most 8192",
    ),
    (["build", "FIGURE", "-o", "x.stl", "--simplify", "-1"], "--simplify is -1 mm; need >= 0"),
    (
        ["build", "FIGURE", "-o", "x.stl", "--as", "frame", "--strut-radius", "0"],
        "--strut-radius is 0 mm; need > 0",
    ),
]


@pytest.mark.parametrize("suffix", ["stl", "3mf", "step", "json", "obj", "vtu"])
@pytest.mark.parametrize("command", ["check", "info", "build"])
def test_folders_are_told_from_files(
    command: str, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / f"folder.{suffix}"
    folder.mkdir()
    words = ["-o", str(tmp_path / "out.stl")] if command == "build" else []
    assert main([command, str(folder), *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith(f"{folder} is a folder; need a file")


@pytest.mark.parametrize(("arguments", "message"), BAD_INPUT)
def test_bad_input_is_one_clear_line_and_leaves_no_file(
    figure: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = set(tmp_path.iterdir())
    assert main([figure if a == "FIGURE" else a for a in arguments]) == 2
    error = capsys.readouterr().err.strip().splitlines()
    assert message in error[-1]
    assert not any("Traceback" in line for line in error)
    assert set(tmp_path.iterdir()) == before


def test_unknown_choices_exit_with_two(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["build", "a.swc", "-o", "a.stl", "--as", "cloud"])
    assert stop.value.code == 2
    assert "invalid choice: 'cloud'" in capsys.readouterr().err


def test_strict_refuses_what_needs_repair(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "lines.obj"
    source.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\nl 3 2\n")
    command = ["build", str(source), "-o", str(tmp_path / "x.stl"), "--radius", "0.1"]
    for words in (command, ["info", str(source)]):
        assert main([*words, "--strict"]) == 2
        assert "need each edge once (without --strict, files are" in capsys.readouterr().err
    assert main(command) == 0
    assert "was repaired: 1 duplicate edge" in capsys.readouterr().err


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("files", [1, 3])
def test_interrupted_work_exits_with_130_and_leaves_no_file(
    sent: signal.Signals,
    files: int,
    figure: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        begun.append(1)
        assert list(folder.glob(".scaffold-cad-*"))
        signal.raise_signal(sent)

    begun: list[int] = []
    folder = tmp_path / "out"
    before = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr(os, "fsync", interrupted)
    inputs = [shutil.copy(figure, tmp_path / f"figure{k}.json") for k in range(files)]
    assert main(["build", *map(str, inputs), "-o", f"{folder}/", "--format", "stl"]) == 130
    assert len(begun) == 1  # and no other file after it
    assert capsys.readouterr().err.splitlines()[-1] == "scaffold-cad: interrupted"
    assert list(folder.iterdir()) == []
    assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.parametrize("error", [ImportError, OptionError])
def test_what_a_signal_makes_of_an_import_is_an_interruption(
    error: type[Exception],
    figure: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def imported(*_: object, **__: object) -> None:
        with suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        raise error("initialization failed")

    monkeypatch.setattr(os, "fsync", imported)
    assert main(["build", figure, "-o", str(tmp_path / "a.stl")]) == 130
    assert capsys.readouterr().err.splitlines()[-1] == "scaffold-cad: interrupted"
    monkeypatch.undo()
    assert main(["build", figure, "-o", str(tmp_path / "a.stl")]) == 0


@pytest.mark.parametrize("options", [[], ["--round"], ["--round", "--sides", "4000"]])
def test_a_lack_of_memory_is_one_line(
    options: list[str],
    figure: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr("scaffold_cad.cli.build.write", full)
    assert main(["build", figure, "--quiet", "-o", str(tmp_path / "x.stl"), *options]) == 2
    fewer = ", or fewer --sides than 4000" if "--sides" in options else ""
    told = capsys.readouterr().err
    assert told == f"scaffold-cad: out of memory; need a smaller skeleton{fewer}\n"
    assert list(tmp_path.glob("*.stl")) == []


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "scaffold_cad.cli", *arguments],
        capture_output=True,
        encoding="utf-8",
        check=False,
    )


def test_version_and_help() -> None:
    assert run("--version").stdout.strip() == f"scaffold-cad {__version__}"
    assert "build" in run("--help").stdout
    alone = run()
    assert alone.returncode == 2
    assert "build a solid" in alone.stderr


def test_commands_that_build_nothing_load_nothing_heavy() -> None:
    heavy = {"build123d", "OCP", "manifold3d", "trimesh", "lib3mf", "scipy.stats", "scipy.optimize"}
    program = (
        "import sys; from scaffold_cad.cli import main; code = main(['cells']); "
        f"print(code, sorted({heavy} & sys.modules.keys()), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True
    )
    assert done.stderr.strip() == "0 []"


def test_meshes_are_written_without_build123d(figure: str, tmp_path: Path) -> None:
    program = (
        "import sys; from scaffold_cad.cli import main; "
        f"code = main(['build', {figure!r}, '-o', {str(tmp_path / 'x.stl')!r}]); "
        "print(code, sorted({'build123d', 'OCP'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True
    )
    assert done.stdout.strip() == "0 []"


@pytest.mark.parametrize("name", RADII)
def test_real_files_become_watertight(shared_data: Path, tmp_path: Path, name: str) -> None:
    out = tmp_path / "out.stl"
    command = ["build", str(shared_data / name), "-o", str(out)]
    if RADII[name] is not None:
        assert main(command) == 2
        command += ["--radius", str(RADII[name])]
    assert main(command) == 0
    mesh = trimesh.load(out)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    skeleton = read_skeleton(shared_data / name, RADII[name])
    assert (mesh.bounds[0] <= skeleton.nodes.min(axis=0) + 1e-6).all()
    assert (mesh.bounds[1] >= skeleton.nodes.max(axis=0) - 1e-6).all()


@pytest.mark.parametrize(
    ("arguments", "name", "message"),
    [
        (["--blend", "1"], "coarse.stl", "--blend is for --round"),
        (["--ends", "round"], "coarse.stl", "--ends is for --round"),
        (["--sides", "8"], "coarse.stl", "--sides is for --round"),
        (["--round", "--sides", "8"], "round.step", "--sides is for meshes, not for CAD formats"),
        (["--round", "--as", "shell"], "shell.obj", "--as shell is for the coarse quads"),
        (["--strut-radius", "1"], "coarse.stl", "--strut-radius is for --as frame"),
    ],
)
def test_options_that_do_nothing_are_refused_before_any_work(
    arguments: list[str],
    name: str,
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["build", "absent.json", *arguments, "-o", str(tmp_path / name)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert not (tmp_path / name).exists()


def parallel(distance: float) -> str:
    """Return two parallel struts of radius 1 as JSON, a corner of their sections to the other."""
    across = distance / np.sqrt(2)
    nodes = [[0, 0, 0], [20, 0, 0], [0, across, across], [20, across, across]]
    return skeleton_to_json(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))


@pytest.mark.parametrize(
    ("distance", "options", "said"),
    [
        (1.9, ["--round"], True),
        (2.2, ["--round"], False),
        (2.2, [], True),  # the squares around the circles are 2.83 across corners
        (2.9, [], False),
    ],
)
def test_overlaps_are_said_of_the_surface_that_is_written(
    distance: float,
    options: list[str],
    said: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("close.json").write_text(parallel(distance), encoding="utf-8")
    assert main(["build", "close.json", *options, "-o", "out.stl"]) == 0
    assert ("2 of 2 struts overlap" in capsys.readouterr().err) == said
    assert main(["build", "close.json", *options, "-o", "out.step"]) == (2 if said else 0)


def test_number_of_sides_is_a_multiple_of_four(
    figure: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.stl"
    assert main(["build", figure, "--round", "--sides", "10", "-o", str(out)]) == 2
    assert "sides is 10; need a multiple of 4" in capsys.readouterr().err
    assert not out.exists()


def test_a_round_frame_has_round_struts(figure: str, tmp_path: Path) -> None:
    volumes = []
    for options in ([], ["--round"]):
        out = tmp_path / "frame.stl"
        command = ["build", figure, "-o", str(out), "--as", "frame", "--strut-radius", "0.05"]
        assert main([*command, *options]) == 0
        mesh = trimesh.load(out)
        assert mesh.is_watertight
        volumes.append(mesh.volume)
    # A square around a circle has 4/π of its area; nodes differ.
    assert volumes[1] == pytest.approx(volumes[0] * np.pi / 4, rel=0.1)


@pytest.mark.parametrize(
    ("words", "usage", "said"),
    [
        ("biuld a.json -o a.stl", "scaffold-cad [options] COMMAND", "did you mean 'build'?"),
        ("build a.json -o a.stl --colars", "scaffold-cad build", "did you mean '--collars'?"),
        ("check a.json --process sla2", "scaffold-cad check", "did you mean 'sla'?"),
        ("view a.json b.json", "scaffold-cad view", "unrecognized arguments: b.json"),
    ],
)
def test_a_wrong_word_is_told_with_the_usage_of_its_command(
    words: str, usage: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(words.split())
    assert end.value.code == 2
    told = capsys.readouterr().err
    assert told.startswith(f"usage: {usage}")
    assert len(told.splitlines()) == 2
    assert said in told.splitlines()[-1]


@pytest.mark.parametrize("words", ["info", "strength --load zmax:0,0,-1"])
def test_what_was_read_is_told_once(
    words: str, figure: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command, *rest = words.split()
    assert main([command, figure, *rest]) == 0
    assert capsys.readouterr().err.count(" read\n") == 1


@pytest.mark.parametrize("option", ["--collars", "--fit paper", "--section area"])
def test_options_of_square_struts_are_not_for_round_ones(
    option: str, figure: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["build", figure, "--round", *option.split(), "-o", str(tmp_path / "a.stl")]
    assert main(words) == 2
    assert f"{option.split()[0]} is for square struts" in capsys.readouterr().err


def test_a_file_is_no_folder_of_tiles(
    figure: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["build", figure, "--overlaps", "allow", "--tiles", figure]
    assert main([*words, "-o", str(tmp_path / "a.stl")]) == 2
    assert "cannot make the folder" in capsys.readouterr().err


def test_info_tells_once_what_a_file_with_a_wrong_suffix_is_read_as(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "wrong.stl"
    path.write_text(skeleton_to_json(named.STRUT))
    assert main(["info", str(path)]) == 0
    assert capsys.readouterr().err.count("is read as") == 1


@pytest.mark.parametrize(
    ("words", "same"), [(["help"], ["--help"]), (["help", "build"], ["build", "--help"])]
)
def test_help_is_a_word_too(
    words: list[str], same: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    told = []
    for line in (words, same):
        with pytest.raises(SystemExit, match="0"):
            main(line)
        told.append(capsys.readouterr().out)
    assert told[0] == told[1]
    assert told[0].startswith("usage: scaffold-cad")


def test_help_for_a_word_that_is_no_command_names_the_nearest(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["help", "buid"])
    assert "did you mean 'build'?" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["-q", "formats"], ["formats", "-q"], ["-v", "-q", "formats"]])
def test_flags_of_the_log_may_stand_before_the_command(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 0
    assert ".stl" in capsys.readouterr().out


def test_flags_of_the_log_alone_name_what_is_missing(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["-q"])
    assert "scaffold-cad: error: " in capsys.readouterr().err
