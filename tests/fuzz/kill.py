"""`python -m tests.fuzz.kill --times 50`: a program that writes files is killed at any moment.

Under its final name a file is always absent or whole: one of the two that are written in turn.
"""

from __future__ import annotations

import argparse
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from scaffold_cad import build_scaffold, write
from scaffold_cad.skeleton import Skeleton
from tests.skeletons import CUBE, STICK_FIGURE

SUFFIXES = (".stl", ".3mf", ".obj", ".ply", ".glb", ".step")
SKELETON_SUFFIXES = (".json", ".swc")

_DATE = re.compile(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d")


def write_all(skeleton: Skeleton, folder: Path) -> None:
    """Write a file of each format."""
    scaffold = build_scaffold(skeleton)
    for suffix in SUFFIXES:
        write(scaffold, folder / f"solid{suffix}")
    for suffix in SKELETON_SUFFIXES:
        if suffix == ".json" or skeleton.loop_count == 0:
            write(skeleton, folder / f"skeleton{suffix}")


def contents(folder: Path) -> dict[str, bytes]:
    """Return what the files of a folder hold, but for STEP's date, hidden files left out."""
    files = [path for path in folder.iterdir() if not path.name.startswith(".")]
    return {path.name: _DATE.sub(b"DATE", path.read_bytes()) for path in files}


def damaged(folder: Path, whole: list[dict[str, bytes]]) -> list[str]:
    """Return the names of the files that are none of the whole ones."""
    found = contents(folder)
    return [name for name, data in found.items() if data not in [one.get(name) for one in whole]]


def killed_while_writing(folder: Path, delay: float) -> None:
    """Start a program that writes into `folder` without end, and kill it after `delay` s."""
    command = [sys.executable, "-m", "tests.fuzz.kill", "--write", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as program:
        assert program.stdout is not None
        program.stdout.readline()
        time.sleep(delay)
        program.send_signal(signal.SIGKILL)


def whole_files() -> list[dict[str, bytes]]:
    """Return what the files hold when nobody interferes."""
    whole = []
    for skeleton in (CUBE, STICK_FIGURE):
        with TemporaryDirectory() as folder:
            write_all(skeleton, Path(folder))
            whole.append(contents(Path(folder)))
    return whole


def main() -> int:
    """Kill writers; return 1 if any left a damaged file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=50)
    parser.add_argument("--write", type=Path, help="write into this folder without end")
    options = parser.parse_args()
    if options.write is not None:
        build_scaffold(CUBE)
        print("ready", flush=True)
        while True:
            write_all(CUBE, options.write)
            write_all(STICK_FIGURE, options.write)
    whole = whole_files()
    draw = random.Random(0)
    with TemporaryDirectory() as folder:
        for k in range(options.times):
            killed_while_writing(Path(folder), draw.uniform(0.0, 1.0))
            bad = damaged(Path(folder), whole)
            if bad:
                print(f"kill {k} left {', '.join(bad)}")
                return 1
        print(f"{options.times} kills, {len(contents(Path(folder)))} files, all whole")
    return 0


if __name__ == "__main__":
    sys.exit(main())
