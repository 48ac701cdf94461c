"""STEP files that are packed: `.stpz`, by gzip as CAx-IF recommends, or by zip as some write it."""

from __future__ import annotations

import gzip
import shutil
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from scaffold_cad.errors import FormatError

GZIP = b"\x1f\x8b"
"""First bytes of what gzip packs."""
PACKED_SUFFIX = ".stpz"
"""Suffix of packed STEP files."""
LARGEST = 2**30
"""Most bytes that are unpacked: a small file may hold more than a disk."""
BLOCK = 2**20
"""Bytes that are unpacked at a time."""
LEVEL = 6
"""How hard gzip tries: from 4 on files have about one size, above 6 only time grows."""


def pack(plain: Path, packed: Path) -> None:
    """Write a file packed by gzip; equal files give equal bytes.

    Parameters
    ----------
    plain : the file
    packed : what is written
    """
    with (
        plain.open("rb") as source,
        packed.open("wb") as target,
        gzip.GzipFile("", "wb", LEVEL, target, mtime=0) as stream,
    ):
        shutil.copyfileobj(source, stream)


@contextmanager
def unpacked(path: Path) -> Iterator[Path]:
    """Give a file as it is, or a plain copy of a packed one until the block ends.

    Raises
    ------
    FormatError
        If it is not packed as its suffix says.

    Examples
    --------
    >>> with unpacked(Path("node.step")) as plain:
    ...     print(plain)
    node.step
    """
    if path.suffix.lower() != PACKED_SUFFIX and not _is_gzip(path):
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / f"{path.stem}.step"
        try:
            with path.open("rb") as source, plain.open("wb") as target:
                _copy(_content(source), target)
        except (OSError, EOFError, ValueError, zipfile.BadZipFile, zlib.error) as error:
            raise FormatError(
                f"{path} cannot be read: {error}; need a STEP file packed by gzip"
            ) from None
        yield plain


def unpacked_head(head: bytes) -> bytes:
    """Return how what gzip packed begins, of the first bytes of the file; others as they are.

    >>> unpacked_head(gzip.compress(b"ISO-10303-21;")), unpacked_head(b"ISO-10303-21;")
    (b'ISO-10303-21;', b'ISO-10303-21;')
    """
    if not head.startswith(GZIP):
        return head
    try:
        return zlib.decompressobj(16 + zlib.MAX_WBITS).decompress(head, BLOCK)
    except zlib.error:
        return b""


def _is_gzip(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(len(GZIP)) == GZIP


def _copy(stream: IO[bytes] | gzip.GzipFile, target: IO[bytes]) -> None:
    left = LARGEST
    while part := stream.read(BLOCK):
        left -= len(part)
        if left < 0:
            raise ValueError(f"it holds more than {LARGEST} bytes")
        target.write(part)


def _content(source: IO[bytes]) -> IO[bytes] | gzip.GzipFile:
    """Return what is packed in a file: by gzip, or the one file in a zip archive."""
    if not zipfile.is_zipfile(source):
        source.seek(0)
        return gzip.GzipFile(fileobj=source)
    archive = zipfile.ZipFile(source)
    names = archive.namelist()
    if len(names) != 1:
        raise ValueError(f"it is a zip archive of {len(names)} files")
    return archive.open(names[0])
