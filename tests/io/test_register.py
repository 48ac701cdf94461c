"""Formats that other packages add, and the list of all."""

from __future__ import annotations

import logging
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from scaffold_cad.cli import main
from scaffold_cad.io import _formats, known_formats, known_suffixes, read_skeleton
from tests.fuzz.samples import SAMPLES
from tests.io.test_reading import written

MODULE = """
import numpy
from scaffold_cad.io import RawSkeleton, register_reader

@register_reader("pairs", ".pairs", recognises=lambda head: head.startswith(b"pairs"))
def read_pairs(path):
    numbers = [float(word) for word in path.read_text().split()[1:]]
    return RawSkeleton(numpy.reshape(numbers, (2, 3)), numpy.array([[0, 1]]))
"""


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two installed packages with readers, one of them broken."""
    written(tmp_path, "pairs_of_a_test.py", MODULE)
    monkeypatch.syspath_prepend(str(tmp_path))
    names = ("no_module_of_this_name", "pairs_of_a_test")
    found = [EntryPoint(name, name, _formats.ENTRY_POINTS) for name in names]
    monkeypatch.setattr(_formats, "entry_points", lambda group: found)
    monkeypatch.setattr(_formats, "_formats", list(_formats._formats))
    _formats._load_entry_points.cache_clear()


def test_a_package_adds_a_reader_by_an_entry_point(
    tmp_path: Path, packages: None, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        assert ".pairs" in known_suffixes()
    assert "readers of no_module_of_this_name cannot be loaded: ModuleNotFoundError" in caplog.text
    skeleton = read_skeleton(written(tmp_path, "strut.pairs", "pairs 0 0 0 10 0 0"), 1.0)
    assert skeleton.lengths.tolist() == [10]


def test_every_format_that_is_read_has_a_sample() -> None:
    for known in known_formats():
        for suffix in known.suffixes:
            assert any(name.endswith(suffix) for name in SAMPLES), suffix


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_recognised_by_its_own_format_only(name: str) -> None:
    head = SAMPLES[name][: _formats.HEAD_SIZE]
    found = [known for known in known_formats() if known.recognises(head)]
    assert len(found) == 1
    assert name.endswith(found[0].suffixes)


def test_formats_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats"]) == 0
    rows = {line.split()[0]: line.split()[1:] for line in capsys.readouterr().out.splitlines()}
    assert rows[".obj"] == ["read", "write", "OBJ"]
    assert rows[".step"] == ["write", "STEP"]
    assert rows[".bvh"] == ["read", "BVH"]
    assert set(known_suffixes()) < set(rows)
