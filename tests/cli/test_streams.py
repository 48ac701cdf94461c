"""Several files, folders, standard streams, options from a file, and what shells complete."""

from __future__ import annotations

import io
import json
import os
import shlex
import signal
import subprocess
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from scaffold_cad import Skeleton, read_skeleton, write
from scaffold_cad.cli import main
from scaffold_cad.cli.running import INTERRUPTED, _end_quietly
from tests.meshes import CUBE

ANGLE = Skeleton([[0, 0, 0], [10, 0, 0], [0, 20, 0]], [[0, 1], [0, 2]], 1.0)
STRUT = Skeleton([[0, 0, 0], [10, 0, 0]], [[0, 1]], 1.0)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write(ANGLE, "angle.json")
    write(STRUT, "strut.json")
    return tmp_path


class Stream(io.StringIO):
    """A standard stream of text, with one of bytes below it."""

    def __init__(self, content: bytes = b"", terminal: bool = False) -> None:
        super().__init__()
        self.buffer = io.BytesIO(content)  # type: ignore[assignment]
        self._terminal = terminal

    def isatty(self) -> bool:
        return self._terminal


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_several_files_go_into_a_folder(folder: Path, jobs: str) -> None:
    words = ["build", "angle.json", "strut.json", "--round", "-o", "new/solids/", "--format", "STL"]
    assert main([*words, "--jobs", jobs]) == 0
    volume = trimesh.load(folder / "new/solids/strut.stl").volume
    assert volume == pytest.approx(10 * np.pi, rel=1e-6)
    assert trimesh.load(folder / "new/solids/angle.stl").volume > 2.5 * volume


def test_a_refused_file_is_named_and_ends_no_other(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("bad.json").write_text("{}")
    assert main(["build", "bad.json", "strut.json", "-o", "out", "--format", "stl"]) == 2
    assert "bad.json" in capsys.readouterr().err
    assert [path.name for path in (folder / "out").iterdir()] == ["strut.stl"]


class Killed(ThreadPoolExecutor):
    """Processes of which that of one file is killed, and takes the others with it."""

    error: BaseException = BrokenProcessPool()

    def __init__(self, *_: object) -> None:
        super().__init__(1)
        self._is_broken = False

    def submit(self, work: Any, /, *items: Any, **_: Any) -> Future[Any]:  # type: ignore[override]
        if self._is_broken:
            raise BrokenProcessPool
        if str(items[0].input) != "angle.json":
            return super().submit(work, *items)
        self._is_broken = True
        future: Future[Any] = Future()
        future.set_exception(self.error)
        return future


@pytest.mark.parametrize("error", [BrokenProcessPool(), SystemExit(INTERRUPTED)])
def test_a_file_whose_process_is_killed_is_named_and_ends_no_other(
    error: BaseException,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(Killed, "error", error)
    monkeypatch.setattr("scaffold_cad.cli.running.ProcessPoolExecutor", Killed)
    words = ["build", "angle.json", "strut.json", "-o", "out", "--format", "stl", "--jobs", "2"]
    assert main(words) == 2
    told = [line for line in capsys.readouterr().err.splitlines() if "killed" in line]
    assert len(told) == 1
    assert told[0].startswith("scaffold-cad: angle.json: process was killed")
    assert [path.name for path in (folder / "out").iterdir()] == ["strut.stl"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_processes_that_wait_are_ended_without_a_word(
    number: signal.Signals, capfd: pytest.CaptureFixture[str]
) -> None:
    process = get_context("spawn").Process(target=_waiting)
    process.start()
    while "waits" not in capfd.readouterr().out:
        assert process.is_alive()
    os.kill(process.pid or 0, number)
    process.join()
    assert process.exitcode == INTERRUPTED
    assert capfd.readouterr().err == ""


def _waiting() -> None:
    _end_quietly()
    print("waits", flush=True)
    time.sleep(60)


def test_info_of_several_files_names_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "angle.json", "strut.json"]) == 0
    out = capsys.readouterr().out
    assert out.index("angle.json:") < out.index("strut.json:")


def test_standard_streams(monkeypatch: pytest.MonkeyPatch) -> None:
    said, made = Stream(), Stream()
    monkeypatch.setattr(sys, "stdin", Stream(Path("strut.json").read_bytes()))
    monkeypatch.setattr(sys, "stdout", made)
    monkeypatch.setattr(sys, "stderr", said)
    words = ["build", "-", "--from", "json", "--round", "-o", "-", "--format", "stl"]
    assert main(words) == 0
    mesh = trimesh.load(io.BytesIO(made.buffer.getvalue()), file_type="stl")
    assert mesh.volume == pytest.approx(10 * np.pi, rel=1e-6)
    assert "stdin.json: 2 nodes" in said.getvalue()
    assert "/" not in said.getvalue()


def test_info_of_several_files_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    write(CUBE, "cube.stl")
    assert main(["info", "angle.json", "cube.stl", "--json", "--scale", "2"]) == 0
    angle, cube = map(json.loads, capsys.readouterr().out.splitlines())
    assert (angle["name"], angle["nodes"], angle["edges"], angle["joints"]) == (
        "angle.json",
        3,
        2,
        1,
    )
    assert angle["edge_length"] == [20.0, 40.0]
    assert (angle["size"], angle["radius"]) == ([20.0, 40.0, 0.0], [2.0, 2.0])
    assert (angle["branch_points"], angle["repairs"]) == ({}, {})
    assert (cube["nodes"], cube["edges"], cube["branch_points"]) == (8, 12, {"3": 8})
    assert cube["radius"] is None


def test_closed_streams_are_empty_ones(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert main(["info", "-", "--from", "json"]) == 2
    assert "stdin.json is empty; need nodes and edges" in capsys.readouterr().err
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    assert main(["convert", "strut.json", "-o", "again.json"]) == 0
    for stream in (sys.stdin, sys.stdout, sys.stderr):
        stream.close()
    assert Path("again.json").read_bytes() == Path("strut.json").read_bytes()


def test_a_pipe_of_two_commands() -> None:
    command = f"{sys.executable} -m scaffold_cad"
    line = (
        f"{command} convert angle.json -q -o - --format swc | "
        f"{command} convert - --from swc --units mm -q -o again.json"
    )
    subprocess.run(line, shell=True, check=True)
    np.testing.assert_allclose(read_skeleton("again.json").lengths, [10, 20])


@pytest.mark.parametrize(
    ("words", "need"),
    [
        ("build angle.json strut.json -o one.stl", "one.stl is one file for 2 inputs"),
        ("build angle.json -o out", "out has no suffix, as folders have none; --format is"),
        ("build angle.json -o .", ". is a folder; --format is missing"),
        (
            "build angle.json -o taken --format stl",
            "cannot make the folder taken: a file has this",
        ),
        (f"build angle.json -o {300 * 'a'}.stl", ".stl: its name is too long for a file"),
        (f"build {300 * 'a'}.json -o a.stl", ".json cannot be read: its name is too long"),
        ("build angle.json -o a.stl --format stl", "a.stl names its own"),
        ("build - -o a.stl", "--from is missing"),
        ("build angle.json ./angle.json -o out --format stl", "2 inputs would be written to"),
        ("build angle.json strut.json --tiles t -o out --format stl", "--tiles is for one file"),
        ("lattice --cell bcc --size 5 --radius 1 --box 5 -o -", "--format is missing"),
    ],
)
def test_what_does_not_go_together(
    words: str, need: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "taken").touch()
    before = set(folder.iterdir())
    assert main(words.split()) == 2
    assert need in capsys.readouterr().err
    assert set(folder.iterdir()) == before


def test_turns_and_a_mirror_move_the_nodes() -> None:
    assert (
        main(
            [
                "convert",
                "strut.json",
                "--turn",
                "Z:90",
                "--turn",
                "x:90",
                "--mirror",
                "z",
                "-o",
                "a.json",
            ]
        )
        == 0
    )
    np.testing.assert_allclose(read_skeleton("a.json").nodes[1], [0, 0, -10], atol=1e-12)


def test_units_that_are_written() -> None:
    assert main(["convert", "strut.json", "--to-units", "cm", "-o", "a.csv"]) == 0
    np.testing.assert_allclose(read_skeleton("a.csv", units="cm").lengths, [10])


def test_options_come_from_a_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("o.toml").write_text('[build]\nround = true\nsides = 8\nturn = ["z:90"]\n[check]\n')
    assert main(["build", "strut.json", "--config", "o.toml", "-o", "a.stl"]) == 0
    mesh = trimesh.load("a.stl")
    assert len(mesh.faces) == 4 * 8
    assert np.ptp(mesh.vertices[:, 1]) == pytest.approx(10)
    assert main(["build", "strut.json", "--config", "o.toml", "--sides", "12", "-o", "a.stl"]) == 0
    assert len(trimesh.load("a.stl").faces) == 4 * 12


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[build]\nrond = true", "did you mean 'round'"),
        ("[biuld]\nround = true", "did you mean 'build'"),
        ("round = true", "need tables named as commands"),
        ('[build]\nround = "yes"', "need true or false"),
        ("[build]\nblend = true", "need a text, a number"),
        ("[build]\nsides = [8, 12]", "has sides = [8, 12]; need one value"),
        ("[build", "is not a TOML file"),
    ],
)
def test_a_file_of_options_is_checked(
    content: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("o.toml").write_text(content)
    with pytest.raises(SystemExit) as stop:
        main(["build", "strut.json", "--config", "o.toml", "-o", "a.stl"])
    assert stop.value.code == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("build strut.json -o a.stl --config", "argument --config: expected one argument"),
        ("build strut.json -o a.stl \N{EM DASH}radius 3", "did you mean '--radius'?"),
        ("build strut.json -o a.stl radius=3", "did you mean '--radius'?"),
        (
            "lattice --cell bcc --size 8 --radius 1 --box 8 -o a.stl --units m",
            "arguments: --units m\n",
        ),
        ("build strut.json -o ''", "'' is not a name; need that of a file or a folder"),
        ("build '' -o a.stl", "'' is not a name; need that of a file or a folder"),
        ("convert strut.json -o . --format json", "strut.json is an input; need another folder"),
        ("build strut.json -o a.stl --scale -1e3", "--scale is -1000; need > 0"),
        (
            "check strut.json --direction -0,-0,-0",
            "--direction is [-0.0, -0.0, -0.0]; need a ",
        ),
        ("build strut.json -o a.stl --round --ends open", "--ends is 'open' without a wall"),
        ("convert strut.json -o a.dwg", "need one of .3mf, .csv, .graphml, .inp, .json, .obj"),
        ("strength strut.json --weight --young 1e99", "--young is 1e+99 MPa; need 1e-09 to 1e+09"),
        ("strength strut.json --weight --material x", "pla, petg, abs\n"),
        (
            "strength strut.json --load xmax:0,0,-1e99",
            "need three finite numbers of at most 1e+15",
        ),
        ("strength strut.json --weight --size 1e9", "--size is 1e+09 mm; need 1e-05 to 1e+04 mm"),
        ("strength strut.json --weight --strength inf --size 1", "--strength is inf MPa; need"),
    ],
)
def test_what_newcomers_get_wrong_is_told(
    line: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = Path("strut.json").read_bytes()
    try:
        code: object = main(shlex.split(line))
    except SystemExit as stop:
        code = stop.code
    assert code == 2
    assert message in capsys.readouterr().err
    assert Path("strut.json").read_bytes() == before
    assert not list(Path().glob("a.*"))


def test_advice_that_is_logged_names_flags(capsys: pytest.CaptureFixture[str]) -> None:
    Path("cell.swc").write_text("1 1 0 0 0 1 -1\n2 3 10 0 0 1 1\n")
    assert main(["info", "cell.swc"]) == 0
    assert "are taken as mm (--units um converts them)" in capsys.readouterr().err


def test_verbose_tells_more(capsys: pytest.CaptureFixture[str]) -> None:
    told = []
    for flag in ("-q", "--quiet", "-v", "--verbose"):
        assert main(["build", "angle.json", flag, "-o", "a.stl"]) == 0
        told.append(capsys.readouterr().err)
    assert told[:2] == ["", ""]
    assert "a.stl written" in told[2]
    assert told[2] == told[3]


def test_choices_are_taken_in_any_case() -> None:
    assert main(["build", "strut.json", "--round", "--ends", "ROUND", "-o", "a.stl"]) == 0
    assert np.ptp(trimesh.load("a.stl").vertices[:, 0]) > 11.9


@pytest.mark.parametrize(("no_color", "red"), [("", True), ("1", False)])
def test_errors_are_red_on_a_terminal(
    no_color: str, red: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", no_color)
    said = Stream(terminal=True)
    monkeypatch.setattr(sys, "stderr", said)
    assert main(["info", "missing.swc"]) == 2
    assert ("\x1b[31m" in said.getvalue()) == red


def test_a_shell_completes_commands_and_flags(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("shtab")
    with pytest.raises(SystemExit) as stop:
        main(["--print-completion", "bash"])
    assert stop.value.code == 0
    script = capsys.readouterr().out
    assert "--mirror" in script
    assert "convert" in script


@pytest.mark.parametrize("words", ["cells", "--help", "build --help", "--print-completion bash"])
def test_a_reader_that_has_enough_ends_a_command_quietly(words: str) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "scaffold_cad", *words.split()]
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True)
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, "")
