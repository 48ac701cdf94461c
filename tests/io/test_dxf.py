from __future__ import annotations

import logging
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import _text, read_raw
from tests.fuzz.samples import DXF_R12, SAMPLES
from tests.io.test_reading import written


@pytest.mark.parametrize("name", ["r2000.dxf", "binary.dxf"])
def test_lengths_are_in_the_unit_of_the_header_and_entities_join(tmp_path: Path, name: str) -> None:
    raw = read_raw(written(tmp_path, name, SAMPLES[name]))
    assert raw.edges[:3].tolist() == [[0, 1], [1, 2], [2, 3]]
    assert raw.nodes[:4].tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0], [10, 10, 10]]


def test_a_bulge_becomes_an_arc(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "r2000.dxf", SAMPLES["r2000.dxf"]))
    arc = raw.nodes[4:]
    # Bulge 0.5 over a chord of 10 mm: radius 10 (1 + 0.25) / (4 * 0.5) = 6.25 mm, sagitta 2.5.
    center = np.array([-3.75, 5.0, 0.0])
    distance = np.linalg.norm(arc - center, axis=1)
    assert len(arc) > 8
    assert distance == pytest.approx(6.25, rel=1e-4)


def test_r12_has_no_unit(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "r12.dxf", DXF_R12))
    assert raw.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0], [10, 10, 5]]


def test_what_is_no_curve_is_left_out_with_a_warning(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    document = ezdxf.new(units=ezdxf.units.MM)
    block = document.blocks.new("B")
    block.add_line((0, 0), (1, 1))
    space = document.modelspace()
    space.add_blockref("B", (0, 0))
    space.add_polyface()
    space.add_point((0, 0, 0))
    path = tmp_path / "drawing.dxf"
    document.saveas(path)
    with caplog.at_level(logging.WARNING), pytest.raises(FormatError, match="has no curves in its"):
        read_raw(path)
    assert "left out 1 INSERT, 1 POINT, 1 POLYLINE" in caplog.text
    space.add_circle((0, 0), 10)
    document.saveas(path)
    raw = read_raw(path)
    assert len(raw.nodes) == len(raw.edges)  # closed
    assert np.linalg.norm(raw.nodes, axis=1) == pytest.approx(10, rel=1e-3)


def test_a_dxf_that_is_too_large_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scaffold_cad.io.dxf.LARGEST_DXF", 10)
    with pytest.raises(FormatError, match=rf"has {len(DXF_R12)} bytes; need at most 10"):
        read_raw(written(tmp_path, "large.dxf", DXF_R12))
    assert _text.LARGEST_FILE > 10


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"0\nEOF\n", b"", "does not end with EOF: it was cut short"),
        (b"10\n0\n20", b"10\nzero\n20", "is not a sound DXF file"),
    ],
)
def test_damage_is_refused(tmp_path: Path, old: bytes, new: bytes, message: str) -> None:
    assert old in DXF_R12
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.dxf", DXF_R12.replace(old, new, 1)))


def test_a_binary_file_that_ends_within_a_tag_is_refused(tmp_path: Path) -> None:
    content = b"AutoCAD Binary DXF\r\n\x1a\0\\\nlidONHEC\0^\0\0EOF\0"
    with pytest.raises(FormatError, match="is not a sound DXF file"):
        read_raw(written(tmp_path, "bad.dxf", content))
