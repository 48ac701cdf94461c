from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.base import apart
from scaffold_cad.base.apart import Arrays, run_apart
from scaffold_cad.errors import FormatError


def doubled(path: Path, factor: str) -> Arrays:
    return {"numbers": float(factor) * np.loadtxt(path)}


def refuses(path: Path) -> Arrays:
    raise FormatError(f"{path} is not good; need another")


def ends(path: Path) -> Arrays:
    os.kill(os.getpid(), signal.SIGSEGV)
    return {}


def hangs(path: Path) -> Arrays:
    signal.pause()
    return {}


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    (tmp_path / "numbers.txt").write_text("1 2 3")
    return tmp_path / "numbers.txt"


def test_arrays_come_back(path: Path) -> None:
    assert run_apart(doubled, path, "2")["numbers"].tolist() == [2, 4, 6]


def test_an_error_of_the_package_is_raised_again(path: Path) -> None:
    with pytest.raises(FormatError, match=r"numbers\.txt is not good; need another"):
        run_apart(refuses, path)


def test_a_process_that_ends_is_an_error(path: Path) -> None:
    with pytest.raises(
        FormatError, match=r"numbers\.txt cannot be read: the library that reads it crashed"
    ):
        run_apart(ends, path)


def test_a_process_that_hangs_is_an_error(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "LONGEST", 5.0)
    with pytest.raises(FormatError, match="it takes too long; need a sound file, read within 5 s"):
        run_apart(hangs, path)


def test_within_another_program_it_is_done_here(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.executable", "/usr/bin/freecad")
    assert run_apart(doubled, path, "3")["numbers"].tolist() == [3, 6, 9]
