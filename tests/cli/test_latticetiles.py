"""`scaffold-cad lattice --tiles`: the box of one process, tile by tile, and resumed."""

from __future__ import annotations

import io
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.cli import main
from scaffold_cad.cli.progress import PERIOD, QUIET_TIME, Progress
from scaffold_cad.io import read_triangles
from tests.tiles.test_tiling import in_order

BOX = ["lattice", "--cell", "bcc", "--size", "5", "--radius", "0.4", "--box", "10x10x15"]


def facets(path: Path) -> np.ndarray:
    return in_order(read_triangles(path).vertices.reshape(-1, 3, 3))


@pytest.mark.parametrize("words", [[], ["--round", "--blend", "0.3", "--ends", "round"]])
def test_a_box_by_tiles_is_that_of_one_process(words: list[str], tmp_path: Path) -> None:
    whole, tiled, folder = (str(tmp_path / name) for name in ("whole.stl", "tiled.stl", "parts"))
    assert main([*BOX, *words, "-o", whole]) == 0
    given = ["--tiles", folder, "--block", "1", "--jobs", "2"]
    assert main([*BOX, *words, *given, "-o", tiled]) == 0
    assert len(list((tmp_path / "parts").glob("tile-*.stl"))) == 12
    np.testing.assert_array_equal(facets(tmp_path / "tiled.stl"), facets(tmp_path / "whole.stl"))
    read_triangles(tmp_path / "tiled.stl")


def test_layers_by_tiles_are_those_of_one_process(tmp_path: Path) -> None:
    sizes = []
    for name, words in (("a", []), ("b", ["--tiles", str(tmp_path / "parts"), "--block", "2"])):
        out = tmp_path / f"{name}.cli"
        assert main([*BOX, "--layer", "1", "--wall", "0.1", *words, "-o", str(out)]) == 0
        sizes.append(out.stat().st_size)
    assert sizes[1] == pytest.approx(sizes[0], rel=0.05)


def heeds_interrupts() -> None:
    """Let a process be interrupted: those started by one in the background of a shell are not."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_what_was_interrupted_goes_on_where_it_was(tmp_path: Path) -> None:
    folder, out = tmp_path / "parts", tmp_path / "out.stl"
    words = [*BOX, "--round", "--tiles", str(folder), "--block", "1", "-o", str(out)]
    # A pipe in place of the fourth note: the process waits there, however slow this one is.
    folder.mkdir()
    barrier = folder / "tile-000003.done"
    os.mkfifo(barrier)
    process = subprocess.Popen(
        [sys.executable, "-m", "scaffold_cad", *words], env=os.environ, preexec_fn=heeds_interrupts
    )
    for _ in range(2400):
        if (folder / "tile-000002.done").exists():
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    assert not out.exists()
    barrier.unlink()
    kept = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.done")}
    assert sorted(kept) == [f"tile-00000{number}.done" for number in range(3)]
    assert main(words) == 0
    again = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.done")}
    assert len(again) == 12
    assert {name: again[name] for name in kept} == kept
    assert out.exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "a.step"], "tiles are joined as .stl, or with --layer as layers"),
        (["--trim", "-o", "a.stl"], "--trim is not for lattices by --tiles"),
        (["--overlaps", "unite", "-o", "a.stl"], "--overlaps unite is not for --tiles"),
        (["--jobs", "0", "-o", "a.stl"], "--jobs is 0"),
        (["--box", "11", "-o", "a.stl"], "--tiles is for a --box that whole cells fill"),
        (["--radius", "2", "-o", "a.stl"], "need struts apart where tiles are built"),
    ],
)
def test_what_tiles_cannot_do_is_said(
    words: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*BOX, "--tiles", "parts", *words]) == 2
    assert said in capsys.readouterr().err


def test_block_and_jobs_need_tiles(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*BOX, "--jobs", "2", "-o", "a.stl"]) == 2
    assert "--jobs is for --tiles" in capsys.readouterr().err


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    def isatty(self) -> bool:
        return True


def test_progress_counts_what_is_done() -> None:
    stream, counts = Terminal(), iter(range(4, 100))
    with Progress(stream).counted("tiles", 12, lambda: next(counts)):
        time.sleep(QUIET_TIME + 2.5 * PERIOD)
    lines = re.findall(r"tiles: (\d+) of 12, .*?left", stream.getvalue())
    assert lines[:2] == ["5", "6"]
    assert stream.getvalue().endswith("\r\x1b[K")
