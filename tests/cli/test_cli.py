"""The command line: exit codes, one clear line for bad input, and products that hold."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad import __version__
from scaffold_cad.cli import main
from scaffold_cad.io import read_skeleton, skeleton_to_json
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


def test_smooth_struts_are_finer(figure: str, tmp_path: Path) -> None:
    coarse, smooth = tmp_path / "coarse.stl", tmp_path / "smooth.stl"
    assert main(["build", figure, "-o", str(coarse)]) == 0
    assert main(["build", figure, "-o", str(smooth), "--smooth", "--levels", "1"]) == 0
    assert trimesh.load(smooth).is_watertight
    assert len(trimesh.load(smooth).faces) > 3 * len(trimesh.load(coarse).faces)


def test_a_smooth_step_file_holds_a_valid_solid(figure: str, tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    out = tmp_path / "smooth.step"
    assert main(["build", figure, "-o", str(out), "--smooth", "--collars"]) == 0
    assert [solid.is_valid for solid in build123d.import_step(str(out)).solids()] == [True]


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


def test_overlaps_are_said_and_united(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, out = tmp_path / "crossing.json", tmp_path / "crossing.stl"
    source.write_text(skeleton_to_json(CROSSING))
    assert main(["build", str(source), "-o", str(out)]) == 0
    assert (
        "2 of 3 struts overlap others or their nodes, edge 0 first; they are united; collars "
        "keep struts straight" in capsys.readouterr().err
    )
    assert trimesh.load(out).is_watertight
    assert main(["build", str(source), "-o", str(out), "--smooth", "--collars"]) == 0
    assert (
        capsys.readouterr().err.splitlines()[1].endswith("; they are united, and not smooth there")
    )


@pytest.mark.parametrize("name", ["figure.foo", "figure.json", "figure.swc"])
def test_a_file_that_holds_no_solid_is_refused_before_the_skeleton_is_read(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", str(tmp_path / "absent.json"), "-o", str(tmp_path / name)]) == 2
    told = capsys.readouterr().err
    assert told.endswith("need .3mf, .brep, .glb, .obj, .ply, .step, .stl, .stp\n")


def test_faces_of_a_smooth_step_file_are_named_after_their_edges(
    figure: str, tmp_path: Path
) -> None:
    coarse, smooth = tmp_path / "coarse.step", tmp_path / "smooth.step"
    assert main(["build", figure, "-o", str(coarse)]) == 0
    assert main(["build", figure, "-o", str(smooth), "--smooth"]) == 0
    names = [
        re.findall(r"ADVANCED_FACE\('([^']*)'", path.read_text(encoding="ascii"))
        for path in (coarse, smooth)
    ]
    assert set(names[0]) == set(names[1]) == {f"edge {i}" for i in range(10)}


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
    assert "1 duplicate edges" in out


BAD_INPUT = [
    (["build", "missing.swc", "-o", "x.stl"], "missing.swc cannot be read: No such file"),
    (["info", "missing.swc"], "missing.swc cannot be read: No such file"),
    (["build", "FIGURE", "-o", "x.dwg"], "cannot write x.dwg: its suffix is '.dwg'; need .3mf"),
    (["build", "FIGURE", "-o", "nowhere/x.stl"], "there is no folder nowhere"),
    (["build", "FIGURE", "-o", "x.stl", "--radius", "-1"], "radius is -1 mm; need > 0"),
    (["build", "FIGURE", "-o", "x.stl", "--simplify", "-1"], "tolerance is -1 mm; need >= 0"),
    (
        ["build", "FIGURE", "-o", "x.stl", "--as", "frame", "--strut-radius", "0"],
        "--strut-radius is 0 mm; need > 0",
    ),
]


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
    assert main([*command, "--strict"]) == 2
    assert "need each edge once" in capsys.readouterr().err
    assert main(command) == 0
    assert "was repaired: 1 duplicate edges" in capsys.readouterr().err


def test_interrupted_work_exits_with_130(figure: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("scaffold_cad.cli.source.read_skeleton", interrupt)
    assert main(["build", figure, "-o", "x.stl"]) == 130


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "scaffold_cad.cli", *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def test_version_and_help() -> None:
    assert run("--version").stdout.strip() == f"scaffold-cad {__version__}"
    assert "build" in run("--help").stdout
    assert run().returncode == 2


def test_meshes_are_written_without_build123d(figure: str, tmp_path: Path) -> None:
    program = (
        "import sys; from scaffold_cad.cli import main; "
        f"code = main(['build', {figure!r}, '-o', {str(tmp_path / 'x.stl')!r}]); "
        "print(code, sorted({'build123d', 'OCP'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
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


def test_meshes_of_many_levels_are_written_in_slabs(figure: str, tmp_path: Path) -> None:
    whole, slabs = tmp_path / "whole.stl", tmp_path / "slabs.stl"
    arguments = ["build", figure, "--smooth", "--levels", "3", "-o"]
    assert main([*arguments, str(whole)]) == 0
    assert main([*arguments, str(slabs), "--slabs", "5"]) == 0
    assert whole.read_bytes() == slabs.read_bytes()
    mesh = trimesh.load(whole)
    assert mesh.is_watertight
    assert len(mesh.faces) >= 2 * 4 * 4**3 * len(named.STICK_FIGURE.edges)


@pytest.mark.parametrize(
    ("arguments", "name", "message"),
    [
        (["--smooth", "--levels", "3"], "fine.3mf", "need .stl or .ply, or --levels 2"),
        (["--slabs", "2"], "coarse.stl", "--slabs is for meshes of --smooth"),
        (["--smooth", "--slabs", "2"], "coarse.stl", "--slabs is for meshes of --smooth"),
        (["--levels", "1"], "coarse.stl", "--levels is for meshes of --smooth"),
        (["--smooth", "--levels", "2"], "smooth.step", "not for CAD formats"),
        (["--caps", "round"], "coarse.step", "--caps is for --smooth"),
        (["--smooth", "--caps", "flat"], "flat.stl", "--caps flat is for CAD formats"),
        (["--smooth", "--as", "shell"], "shell.obj", "--as shell is for the coarse quads"),
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


def test_struts_that_overlap_have_no_fine_surface(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    crossing = tmp_path / "crossing.json"
    crossing.write_text(skeleton_to_json(CROSSING), encoding="utf-8")
    out = tmp_path / "fine.stl"
    assert main(["build", str(crossing), "--smooth", "--levels", "4", "-o", str(out)]) == 2
    assert "overlap others, edge" in capsys.readouterr().err
    assert not out.exists()


def parallel(distance: float) -> str:
    """Return two parallel struts of radius 1 as JSON, a corner of their sections to the other."""
    across = distance / np.sqrt(2)
    nodes = [[0, 0, 0], [20, 0, 0], [0, across, across], [20, across, across]]
    return skeleton_to_json(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))


@pytest.mark.parametrize(
    ("distance", "arguments", "said"),
    [
        (1.9, ["-o", "out.step"], ["2 of 2 struts overlap", "may cross itself there"]),
        (2.2, ["-o", "out.step"], []),  # squares of half width 1 would
        (1.9, ["-o", "out.stl"], ["2 of 2 struts overlap", "they are united"]),
        (2.2, ["-o", "out.stl"], []),
        (2.2, ["--levels", "4", "-o", "out.stl"], []),
    ],
)
def test_overlaps_are_said_of_the_surface_that_is_written(
    distance: float,
    arguments: list[str],
    said: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("close.json").write_text(parallel(distance), encoding="utf-8")
    assert main(["build", "close.json", "--smooth", "--collars", *arguments]) == 0
    error = capsys.readouterr().err
    assert all(part in error for part in said)
    assert bool(said) == ("overlap" in error)


def test_a_fine_mesh_is_not_said_to_be_united_and_then_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "close.json"
    source.write_text(parallel(1.9), encoding="utf-8")
    out = tmp_path / "fine.ply"
    assert main(["build", str(source), "--smooth", "--levels", "3", "-o", str(out)]) == 2
    error = capsys.readouterr().err
    assert "2 struts overlap others, edge 0 first: they can be united with --levels 2" in error
    assert "they are united" not in error


def test_fine_meshes_may_have_flat_caps(figure: str, tmp_path: Path) -> None:
    volumes = []
    for caps in ("round", "flat"):
        out = tmp_path / f"{caps}.stl"
        command = ["build", figure, "--smooth", "--levels", "3", "--caps", caps, "-o", str(out)]
        assert main(command) == 0
        volumes.append(trimesh.load(out).volume)
    assert volumes[1] < volumes[0]
