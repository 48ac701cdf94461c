"""3MF with the beam lattice extension: a ZIP archive of XML parts."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO
from urllib.parse import unquote
from zipfile import BadZipFile, ZipFile

import numpy as np

from scaffold_cad.base.arrays import as_points
from scaffold_cad.errors import FormatError
from scaffold_cad.io._formats import register_reader
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE
from scaffold_cad.io._threemf_model import (
    Lattice,
    Model,
    Placement,
    read_model,
    read_start_part,
)

DEEPEST = 64
"""How deep components may be nested; more is a circle."""

SMALL_PART = 2**24
"""Bytes of a part that is taken however well it is packed."""

MOST_PACKED = 100
"""How many times its packed size a larger part may have: lattices have 5 to 40 times."""

MOST_BEAMS = 2 * 10**7
"""How many beams components may multiply to."""


def _recognises(head: bytes) -> bool:
    return head.startswith(b"PK\x03\x04")


@register_reader("3MF", ".3mf", recognises=_recognises)
def read_3mf(path: Path) -> RawSkeleton:
    """Read the beam lattices that a 3MF file builds, each where it is placed, in mm.

    A node gets the largest radius of the beams that end there; a transform scales radii by the
    cube root of its determinant. Meshes, balls and vertices without a beam are left out, and a
    lattice that is to be clipped is read whole.
    """
    # What overflows under a transform is not finite then, and refused below.
    with _opened(path) as archive, np.errstate(over="ignore", invalid="ignore"):
        package = _Package(path, archive)
        start = package.start_part()
        lattice = package.joined(start, package.model(start).items, depth=1)
    if len(lattice.edges) == 0:
        raise FormatError(f"{path} builds no beam lattice; need at least one beam")
    return RawSkeleton(as_points(lattice.nodes, "nodes"), lattice.edges, lattice.radii)


@contextmanager
def _opened(path: Path) -> Iterator[ZipFile]:
    """Open an archive; what goes wrong in it is a FormatError."""
    try:
        with ZipFile(path) as archive:
            yield archive
    # RuntimeError: a password or a compression that Python doesn't know; UnicodeError: a name.
    except (BadZipFile, zlib.error, struct.error, EOFError, RuntimeError, UnicodeError) as error:
        raise FormatError(f"{path} cannot be unpacked: {error}; need a ZIP archive") from None


class _Package:
    """The parts of an archive, each model read once and each object put together once."""

    def __init__(self, path: Path, archive: ZipFile) -> None:
        self._path = path
        self._archive = archive
        # The packaging conventions compare part names without regard to case.
        self._parts = {_part_key(info.filename): info for info in archive.infolist()}
        self._models: dict[str, Model] = {}
        self._lattices: dict[tuple[str, str], Lattice] = {}

    def start_part(self) -> str:
        """Return the part to begin with."""
        with self._open("/_rels/.rels") as stream:
            start = read_start_part(f"{self._path}/_rels/.rels", stream)
        if start is None:
            raise FormatError(f"{self._path} names no 3D model in /_rels/.rels; need one")
        return start

    def model(self, part: str) -> Model:
        """Return what a model part holds."""
        key = _part_key(part)
        if key not in self._models:
            with self._open(part) as stream:
                self._models[key] = read_model(f"{self._path}{key}", stream)
        return self._models[key]

    def joined(self, part: str, placements: list[Placement], depth: int) -> Lattice:
        """Return the objects that `part` places, `depth` levels deep, as one lattice."""
        if depth > DEEPEST:
            raise FormatError(
                f"{self._path} nests components more than {DEEPEST} deep, or endlessly"
            )
        pieces = [(self._lattice(part, placed, depth), placed.transform) for placed in placements]
        total = sum(len(lattice.edges) for lattice, _ in pieces)
        if total > MOST_BEAMS:
            raise FormatError(f"{self._path} builds {total} beams; need at most {MOST_BEAMS}")
        return _concatenated([lattice.placed(transform) for lattice, transform in pieces])

    def _lattice(self, part: str, placed: Placement, depth: int) -> Lattice:
        """Return the object that `part` places, with its components, in its own coordinates."""
        home = placed.part or part
        key = (_part_key(home), placed.object_id)
        if key not in self._lattices:
            found = self.model(home).objects.get(placed.object_id)
            if found is None:
                raise FormatError(
                    f"{self._path} places object {placed.object_id!r}, which {home} does not hold"
                )
            inner = self.joined(home, found.components, depth + 1)
            self._lattices[key] = _concatenated([found.lattice, inner])
        return self._lattices[key]

    @contextmanager
    def _open(self, part: str) -> Iterator[IO[bytes]]:
        info = self._parts.get(_part_key(part))
        if info is None:
            raise FormatError(f"{self._path} has no part {part}; need it")
        if info.file_size > LARGEST_FILE:
            raise FormatError(
                f"{self._path} has {info.file_size} bytes in {part}; need at most {LARGEST_FILE}"
            )
        growth = info.file_size // max(info.compress_size, 1)
        if info.file_size > SMALL_PART and growth > MOST_PACKED:
            raise FormatError(
                f"{self._path} unpacks {info.filename} to {growth} times its size; "
                f"need at most {MOST_PACKED}"
            )
        with self._archive.open(info) as stream:
            yield stream


def _part_key(name: str) -> str:
    """Return a part's name in the form in which names are compared."""
    return "/" + unquote(name).lstrip("/").lower()


def _concatenated(lattices: list[Lattice]) -> Lattice:
    """Return lattices as one, nothing welded."""
    first = np.cumsum([0, *(len(lattice.nodes) for lattice in lattices)])
    return Lattice(
        np.concatenate([np.zeros((0, 3)), *(lattice.nodes for lattice in lattices)]),
        np.concatenate(
            [
                np.zeros((0, 2), dtype=np.intp),
                *(lattice.edges + start for lattice, start in zip(lattices, first, strict=False)),
            ]
        ),
        np.concatenate([np.zeros(0), *(lattice.radii for lattice in lattices)]),
    )
