"""The archive of a 3MF file: a ZIP of XML parts, and the bodies that they build."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO
from urllib.parse import unquote
from zipfile import BadZipFile, ZipFile

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import FormatError
from scaffold_cad.io._text import LARGEST_FILE
from scaffold_cad.io.threemf.model import Body, Model, Placement, read_model, read_start_part

DEEPEST = 64
"""How deep components may be nested; more is a circle."""

SMALL_PART = 2**24
"""Bytes of a part that is taken however well it is packed."""

MOST_PACKED = 100
"""How many times its packed size a larger part may have: lattices have 5 to 40 times."""

MOST_PARTS = 2 * 10**7
"""How many beams and triangles components may multiply to."""

MOST_PIECES = 10**6
"""How many objects with beams or triangles components may multiply to."""

NOTHING = (0, 0)


@dataclass(frozen=True, eq=False)
class Piece:
    """A body where the build puts it."""

    body: Body
    clip: Body | None
    """The mesh that its beams are clipped to, which is placed as the body is."""
    shown: Body | None
    """The mesh that stands for its beams in programs that cannot show them."""
    transform: Floats
    """Rows that a position (x, y, z, 1) is multiplied with, shape (4, 3), the last in mm."""


def read_package(path: Path) -> list[Piece]:
    """Return the bodies that a 3MF file builds, each where it is placed.

    Raises
    ------
    FormatError
        If it is not a sound archive, or a part of it is not what it must be.
    """
    # What overflows under a transform is not finite then, and refused by whoever uses it.
    with _opened(path) as archive, np.errstate(over="ignore", invalid="ignore"):
        package = _Package(path, archive)
        start = package.start_part()
        return package.pieces(start, package.model(start).items)


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
    """The parts of an archive, each model read once and each object counted once."""

    def __init__(self, path: Path, archive: ZipFile) -> None:
        self._path = path
        self._archive = archive
        # The packaging conventions compare part names without regard to case.
        self._parts = {_part_key(info.filename): info for info in archive.infolist()}
        self._models: dict[str, Model] = {}
        self._sizes: dict[tuple[str, str], tuple[int, int]] = {}

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

    def pieces(self, part: str, placements: list[Placement]) -> list[Piece]:
        """Return the bodies that `placements` of `part` build, those in components too."""
        sizes = [self._size(part, placed, depth=1) for placed in placements]
        self._check_count(sum(size for size, _ in sizes), MOST_PARTS, "beams and triangles")
        self._check_count(sum(count for _, count in sizes), MOST_PIECES, "objects")
        found: list[Piece] = []
        waiting = [(part, placed, np.eye(4, 3)) for placed in reversed(placements)]
        while waiting:
            where, placed, outer = waiting.pop()
            if self._size(where, placed, depth=1) == NOTHING:
                continue
            home, body, components = self._object(where, placed)
            transform = _composed(placed.transform, outer)
            if body.size:
                clip = None if body.clipping == "none" else body.clipping_mesh
                meshes = [self._named(home, name) for name in (clip, body.representation_mesh)]
                found.append(Piece(body, meshes[0], meshes[1], transform))
            waiting += [(home, component, transform) for component in reversed(components)]
        return found

    def _check_count(self, total: int, most: int, what: str) -> None:
        if total > most:
            raise FormatError(f"{self._path} builds {total} {what}; need at most {most}")

    def _size(self, part: str, placed: Placement, depth: int) -> tuple[int, int]:
        """Return how many beams and triangles, and how many bodies, a placement builds."""
        if depth > DEEPEST:
            raise FormatError(
                f"{self._path} nests components more than {DEEPEST} deep, or endlessly"
            )
        home, body, components = self._object(part, placed)
        key = (_part_key(home), placed.object_id)
        if key not in self._sizes:
            inner = [self._size(home, component, depth + 1) for component in components]
            sizes = [(body.size, int(body.size > 0)), *inner]
            self._sizes[key] = (sum(size for size, _ in sizes), sum(count for _, count in sizes))
        return self._sizes[key]

    def _object(self, part: str, placed: Placement) -> tuple[str, Body, list[Placement]]:
        """Return the part that holds a placed object, its body and its components."""
        home = placed.part or part
        found = self.model(home).objects.get(placed.object_id)
        if found is None:
            raise FormatError(
                f"{self._path} places object {placed.object_id!r}, which {home} does not hold"
            )
        return home, found.body, found.components

    def _named(self, home: str, name: str | None) -> Body | None:
        """Return the mesh of an object that beams are clipped to or shown by, None for none."""
        if name is None:
            return None
        found = self.model(home).objects.get(name)
        if found is None or not len(found.body.triangles):
            raise FormatError(
                f"{self._path} clips beams to object {name!r}, or shows it for them, which is not "
                f"a mesh in {home}; need one"
            )
        return found.body

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


def _composed(inner: Floats, outer: Floats) -> Floats:
    """Return the transform that does `inner` and then `outer`, each of shape (4, 3)."""
    both = inner @ outer[:3]
    both[3] += outer[3]
    return both
