"""Files are written whole or not at all, and threads do not disturb each other."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from scaffold_cad import build_scaffold, solidified, write
from scaffold_cad.cli import main
from scaffold_cad.errors import FormatError, ScaffoldCadError
from scaffold_cad.io import read_skeleton
from tests.fuzz.geometry import case, fault_of
from tests.fuzz.kill import contents, damaged, killed_while_writing, whole_files, write_all
from tests.fuzz.samples import SAMPLES
from tests.io.test_reading import written
from tests.skeletons import CUBE, STICK_FIGURE, STRUT

INTERRUPTED = """
import os, signal, sys, threading
from scaffold_cad.cli import main
import {module}

# Programs that a shell starts in the background are told to ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
slow = {module}.{function}
def interrupted(*arguments, **options):
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    while True:
        slow(*arguments, **options)
{module}.{function} = interrupted
sys.exit(main(sys.argv[1:]))
"""
"""The command line, whose work is interrupted by Ctrl-C while `function` runs."""


@pytest.fixture(scope="module")
def whole() -> list[dict[str, bytes]]:
    return whole_files()


def test_the_same_skeleton_gives_the_same_bytes(
    tmp_path: Path, whole: list[dict[str, bytes]]
) -> None:
    write_all(CUBE, tmp_path)
    assert contents(tmp_path) == whole[0]


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL is of POSIX")
def test_a_killed_program_leaves_no_half_of_a_file(
    tmp_path: Path, whole: list[dict[str, bytes]]
) -> None:
    for delay in (0.05, 0.3):
        killed_while_writing(tmp_path, delay)
        assert damaged(tmp_path, whole) == []


@pytest.mark.skipif(os.name != "posix", reason="SIGINT is of POSIX")
@pytest.mark.parametrize(
    ("module", "function"),
    [("scaffold_cad.cli.shapes", "build_scaffold"), ("scaffold_cad.io.stl", "write_stl")],
)
def test_ctrl_c_exits_with_130_and_leaves_no_file(
    tmp_path: Path, module: str, function: str
) -> None:
    source = written(tmp_path, "neuron.swc", SAMPLES["neuron.swc"])
    run = subprocess.run(
        [
            sys.executable,
            "-c",
            INTERRUPTED.format(module=module, function=function),
            *("build", str(source), "-o", str(tmp_path / "out.stl")),
        ],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert run.returncode == 130, run.stderr
    assert "scaffold-cad: interrupted" in run.stderr
    assert "Traceback" not in run.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["neuron.swc"]


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() == 0, reason="root may write into any folder"
)
def test_a_folder_without_permission_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(FormatError, match="is read-only"):
            write(STRUT, tmp_path / "strut.json")
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_standard_output_that_is_full_is_an_error(tmp_path: Path) -> None:
    source = written(tmp_path, "neuron.swc", SAMPLES["neuron.swc"])
    with Path("/dev/full").open("w") as full:
        run = subprocess.run(
            [sys.executable, "-m", "scaffold_cad.cli", "info", str(source)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert run.returncode == 2
    assert run.stderr.endswith("scaffold-cad: cannot print: No space left on device\n")


def test_threads_read_build_and_write_the_same(tmp_path: Path) -> None:
    paths = [written(tmp_path, name, content) for name, content in SAMPLES.items()]

    def worked(number: int) -> tuple[list[int], float, bytes]:
        counts = [len(read_skeleton(path, 1.0).edges) for path in paths[number % 3 :: 3]]
        skeleton = (CUBE, STICK_FIGURE)[number % 2]
        solid = solidified(build_scaffold(skeleton))
        target = tmp_path / f"{number}.3mf"
        write(solid.manifold, target)
        return counts, float(solid.manifold.volume()), target.read_bytes()

    alone = [worked(number) for number in range(6)]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(worked, [*range(6), *range(6)]))
    assert together == [*alone, *alone]


def test_threads_write_the_same_file_in_turn(tmp_path: Path) -> None:
    target = tmp_path / "figure.json"
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda skeleton: write(skeleton, target), [CUBE, STICK_FIGURE] * 10))
    assert len(read_skeleton(target, strict=True).edges) in (12, 10)
    assert [path.name for path in tmp_path.iterdir()] == ["figure.json"]


@pytest.mark.parametrize("number", range(10))
def test_a_degenerate_skeleton_gives_a_sound_solid_or_is_refused(
    tmp_path: Path, number: int
) -> None:
    try:
        _, fault = fault_of(case(number), tmp_path / "case.json")
    except ScaffoldCadError as error:
        fault = "" if str(error) else "no message"
    assert fault == ""


def test_the_input_may_be_the_output(tmp_path: Path) -> None:
    path = written(tmp_path, "lines.obj", SAMPLES["lines.obj"])
    skeleton = read_skeleton(path, 1.0)
    assert main(["build", str(path), "--radius", "1", "-o", str(path)]) == 0
    assert path.read_text().count("\nf ") == len(build_scaffold(skeleton).mesh.quads)
