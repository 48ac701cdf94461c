"""Formats that other packages add, and the list of all."""

from __future__ import annotations

import logging
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad import TriangleMesh, write
from scaffold_cad.cli import main
from scaffold_cad.errors import FormatError, KeywordError, OptionError
from scaffold_cad.io import (
    RawSkeleton,
    known_formats,
    known_suffixes,
    read_skeleton,
    read_triangles,
    register,
    register_mesh_reader,
    register_reader,
    register_writer,
    unregister,
)
from scaffold_cad.io.content import Content
from scaffold_cad.io.write import check_writable
from tests.fuzz.members import APART, sample_apart
from tests.fuzz.samples import SAMPLES
from tests.io.test_reading import written
from tests.skeletons import STRUT

MODULE = """
import numpy
from scaffold_cad.io import RawSkeleton, register_reader

@register_reader("pairs", ".pairs", recognizes=lambda head: head.startswith(b"pairs"))
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
    found = [EntryPoint(name, name, register.ENTRY_POINTS) for name in names]
    monkeypatch.setattr(register, "entry_points", lambda group: found)
    monkeypatch.setattr(register, "_formats", list(register._formats))
    register._load_entry_points.cache_clear()


def test_a_package_adds_a_reader_by_an_entry_point(
    tmp_path: Path, packages: None, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        assert ".pairs" in known_suffixes()
    assert "readers of no_module_of_this_name cannot be loaded: ModuleNotFoundError" in caplog.text
    skeleton = read_skeleton(written(tmp_path, "strut.pairs", "pairs 0 0 0 10 0 0"), 1.0)
    assert skeleton.lengths.tolist() == [10]


NAMES = (*SAMPLES, *APART)


def sample(name: str) -> bytes:
    return sample_apart(name) if name in APART else SAMPLES[name]


def test_every_format_that_is_read_has_a_sample() -> None:
    for known in known_formats():
        for suffix in known.suffixes:
            assert any(name.endswith(suffix) for name in NAMES), suffix


@pytest.mark.parametrize("name", NAMES)
def test_a_sample_is_recognized_by_its_own_format_only(name: str) -> None:
    head = sample(name)[: register.HEAD_SIZE]
    found = [known for known in known_formats() if known.recognizes(head)]
    assert len(found) == 1
    assert name.endswith(found[0].suffixes)


def test_formats_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats"]) == 0
    rows = {line.split()[0]: line.split()[1:] for line in capsys.readouterr().out.splitlines()}
    assert rows[".obj"] == ["read", "write", "OBJ"]
    assert rows[".step"] == ["read", "write", "STEP"]
    assert rows[".bvh"] == ["read", "BVH"]
    assert set(known_suffixes()) <= set(rows)


def test_a_wrong_keyword_of_the_register_is_answered_with_the_right_one() -> None:
    wrong: Any = register_reader
    with pytest.raises(KeywordError, match="no parameter 'recognises'; did you mean 'recognizes'"):
        wrong("pairs", ".pairs", recognises=lambda head: True)


def test_an_entry_can_be_taken_out_again(tmp_path: Path) -> None:
    @register_reader("pairs", ".pairs", recognizes=lambda head: head.startswith(b"pairs"))
    def read_pairs(path: Path) -> RawSkeleton:
        return RawSkeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], [1, 1])

    @register_mesh_reader("pairs", ".pairs")
    def read_pairs_triangles(path: Path) -> TriangleMesh:
        return TriangleMesh(np.eye(3), [[0, 1, 2]])

    @register_writer(".pairs")
    def write_pairs(content: Content, path: Path) -> None:
        path.write_text(f"pairs {content.name}")

    path = tmp_path / "x.pairs"
    check_writable(path, skeleton=True)
    check_writable(path, solid=True)
    write(STRUT, path)
    assert path.read_text() == "pairs x"
    assert len(read_skeleton(path).edges) == 1
    mesh = read_triangles(path)
    assert mesh is not None
    assert len(mesh.triangles) == 1
    for function in (read_pairs, read_pairs_triangles, write_pairs):
        unregister(function)
    assert read_triangles(path) is None
    with pytest.raises(FormatError, match=r"x\.pairs is of no known format"):
        read_skeleton(path)
    with pytest.raises(FormatError, match=r"cannot write .*x\.pairs: its suffix is '\.pairs'"):
        write(STRUT, path)
    with pytest.raises(OptionError, match="write_pairs is not registered; need a registered read"):
        unregister(write_pairs)
