"""The register of formats: which reader a file gets, by its suffix and its content."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import TypeAlias

from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton

Reader: TypeAlias = Callable[[Path], RawSkeleton]
"""Reads a file that exists and is not empty."""
Recogniser: TypeAlias = Callable[[bytes], bool]
"""Tells from the first bytes of a file whether it holds the format."""

HEAD_SIZE = 2**16
"""How many bytes of a file a recogniser is given."""

ENTRY_POINTS = "scaffold_cad.readers"
"""Group of entry points, each a module of an installed package that registers its readers."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Format:
    """A file format and its reader."""

    name: str
    suffixes: tuple[str, ...]
    recognises: Recogniser
    read: Reader


_formats: list[Format] = []


def register_reader(
    name: str, *suffixes: str, recognises: Recogniser
) -> Callable[[Reader], Reader]:
    """Register the decorated reader for files whose names end with one of `suffixes`.

    A suffix may belong to several formats: the one registered last that recognises the file
    reads it.

    Parameters
    ----------
    name : what messages call the format
    suffixes : such as ".swc"; case does not matter
    recognises : tells from the first bytes of a file whether it holds the format
    """

    def register(read: Reader) -> Reader:
        _formats.append(Format(name, tuple(s.lower() for s in suffixes), recognises, read))
        return read

    return register


def known_formats() -> tuple[Format, ...]:
    """Return all formats in order of their registration, those of other packages included."""
    _load_entry_points()
    return tuple(_formats)


def known_suffixes() -> tuple[str, ...]:
    """Return the suffixes of all registered formats, in alphabetic order."""
    return tuple(sorted({suffix for known in known_formats() for suffix in known.suffixes}))


@cache
def _load_entry_points() -> None:
    """Import the modules by which other packages add formats, once."""
    for entry in entry_points(group=ENTRY_POINTS):
        _load(entry)


def _load(entry: EntryPoint) -> None:
    try:
        entry.load()
    # A broken package must not keep others' files from being read.
    except Exception as error:
        _log.warning("readers of %s cannot be loaded: %r", entry.value, error)


def reader_of(path: Path, head: bytes) -> Reader:
    """Return the reader for the file at `path` that begins with `head`.

    The suffix decides, unless the content is that of one other format only.

    Raises
    ------
    FormatError
        If no format has the suffix of the file or recognises its content.
    """
    formats = known_formats()
    by_suffix = [known for known in formats if path.name.lower().endswith(known.suffixes)]
    both = [known for known in by_suffix if known.recognises(head)]
    if both:
        return both[-1].read
    by_content = [known for known in formats if known.recognises(head)]
    if len(by_content) == 1:
        _log.warning("%s is read as %s, by its content", path, by_content[0].name)
        return by_content[0].read
    if by_suffix:
        return by_suffix[-1].read  # its error will say what is missing
    raise FormatError(f"{path} is of no known format; need one of {', '.join(known_suffixes())}")
