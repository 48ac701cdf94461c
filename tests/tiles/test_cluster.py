"""Tiles on a cluster of two workers, killed and resumed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scaffold_cad.tiles import run_tiles, tiles
from tests.tiles.cluster_run import BLOCK, LATTICE, WORK

pytest.importorskip("distributed")

ROOT = Path(__file__).parents[2]
LONGEST = 240.0
"""Time that a run may take, s."""


def started(folder: Path) -> subprocess.Popen[bytes]:
    """Return a run of the cluster in a group of processes of its own."""
    command = [sys.executable, "-m", "tests.tiles.cluster_run", str(folder)]
    return subprocess.Popen(command, cwd=ROOT, start_new_session=True, stderr=subprocess.PIPE)


def test_a_run_killed_and_resumed_gives_the_bytes_of_one_process(tmp_path: Path) -> None:
    run = started(tmp_path)
    end = time.monotonic() + LONGEST
    while len(list(tmp_path.glob("tiles/*.done"))) < 3:
        assert run.poll() is None, run.stderr.read().decode() if run.stderr else ""
        assert time.monotonic() < end
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGKILL)
    run.communicate()
    count = len(tiles(LATTICE, block=BLOCK))
    made = {path: path.stat().st_mtime_ns for path in tmp_path.glob("tiles/*.done")}
    assert 3 <= len(made) < count
    assert not (tmp_path / "all.stl").exists()

    again = started(tmp_path)
    _, said = again.communicate(timeout=LONGEST)
    assert again.returncode == 0, said.decode()
    assert {path: path.stat().st_mtime_ns for path in made} == made  # not made again

    manifest = run_tiles(tiles(LATTICE, block=BLOCK), WORK, tmp_path / "alone")
    manifest.joined(WORK, tmp_path / "alone.stl")
    assert len(manifest.files) == count
    assert (tmp_path / "all.stl").read_bytes() == (tmp_path / "alone.stl").read_bytes()
