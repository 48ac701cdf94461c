"""Packed STEP files."""

from __future__ import annotations

import gzip
import zipfile
from pathlib import Path

import pytest

from scaffold_cad.base import packed
from scaffold_cad.base.packed import pack, unpacked
from scaffold_cad.errors import FormatError

TEXT = b"ISO-10303-21;\n" + 1000 * b"#1=CARTESIAN_POINT('',(0.,0.,0.));\n"


def test_a_packed_file_is_one_of_gzip_and_the_same_each_time(tmp_path: Path) -> None:
    plain, one, other = (tmp_path / name for name in ("a.step", "b.stpz", "c.stpz"))
    plain.write_bytes(TEXT)
    pack(plain, one)
    pack(plain, other)
    assert gzip.decompress(one.read_bytes()) == TEXT
    assert one.read_bytes() == other.read_bytes()
    with unpacked(one) as found:
        assert found.read_bytes() == TEXT
    assert not found.exists()


def test_files_packed_by_zip_are_read_if_they_hold_one_file(tmp_path: Path) -> None:
    path = tmp_path / "node.STPZ"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("node.step", TEXT)
    with unpacked(path) as found:
        assert found.read_bytes() == TEXT
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("more.step", TEXT)
    with pytest.raises(FormatError, match="it is a zip archive of 2 files; need a STEP file"):
        unpacked(path).__enter__()


@pytest.mark.parametrize("held", [TEXT, gzip.compress(TEXT)[:-20], b"PK\x05\x06" + bytes(18)])
def test_damaged_files_are_refused(held: bytes, tmp_path: Path) -> None:
    path = tmp_path / "node.stpz"
    path.write_bytes(held)
    with pytest.raises(FormatError, match=r"node\.stpz cannot be read: .*packed by gzip"):
        unpacked(path).__enter__()


def test_a_small_file_that_holds_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(packed, "LARGEST", 2**21)
    path = tmp_path / "node.stpz"
    path.write_bytes(gzip.compress(bytes(2**21)))
    with unpacked(path) as found:
        assert found.stat().st_size == 2**21
    path.write_bytes(gzip.compress(bytes(2**21 + 1)))
    with pytest.raises(FormatError, match="it holds more than 2097152 bytes"):
        unpacked(path).__enter__()
