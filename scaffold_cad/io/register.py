"""The one register of formats: readers of skeletons, readers of meshes, and writers.

A format's module registers what it does when it is imported. `unregister` takes an entry out again.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, TypeAlias, get_args

from scaffold_cad.base.arguments import check_choice, checks_keywords, did_you_mean
from scaffold_cad.base.files import unknown_suffix
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.content import Content
from scaffold_cad.io.radii import KeptRadii
from scaffold_cad.mesh.trianglemesh import TriangleMesh

Reader: TypeAlias = Callable[[Path], RawSkeleton]
"""Reads the skeleton of a file that exists and is not empty."""
MeshReader: TypeAlias = Callable[[Path], TriangleMesh]
"""Reads the triangles of a file; none if it holds a skeleton."""
Writer: TypeAlias = Callable[[Content, Path], None]
"""Writes a file, which exists and is empty."""
Recognizer: TypeAlias = Callable[[bytes], bool]
"""Tells from the first bytes of a file whether it holds the format."""

HEAD_SIZE = 2**16
"""How many bytes of a file a recognizer is given."""

ENTRY_POINTS = "scaffold_cad.readers"
"""Group of entry points, each a module of an installed package that registers what it has."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Format:
    """A format that holds skeletons, and its reader."""

    name: str
    suffixes: tuple[str, ...]
    recognizes: Recognizer
    read: Reader


@dataclass(frozen=True)
class MeshFormat:
    """A format that holds meshes, and its reader."""

    name: str
    suffixes: tuple[str, ...]
    names_unit: bool
    """Whether files say in which unit they are."""
    read: MeshReader


@dataclass(frozen=True)
class WrittenFormat:
    """A format that is written, and its writer."""

    name: str
    suffixes: tuple[str, ...]
    solids: bool
    """Whether it can hold solids: a format that holds skeletons only cannot."""
    skeletons: bool
    """Whether it can hold skeletons: a format of surfaces cannot."""
    names_unit: bool
    """Whether files say in which unit they are."""
    radii: KeptRadii
    """Which radii of a skeleton files hold."""
    write: Writer


_formats: list[Format | MeshFormat | WrittenFormat] = []


@checks_keywords()
def register_reader(
    name: str, *suffixes: str, recognizes: Recognizer
) -> Callable[[Reader], Reader]:
    """Register the decorated reader of skeletons for files whose names end with a suffix.

    A suffix may belong to several formats: the one registered last that recognizes the file
    reads it.

    Parameters
    ----------
    name : what messages call the format
    suffixes : such as ".swc"; case does not matter
    recognizes : tells from the first bytes of a file whether it holds the format
    """

    def register(read: Reader) -> Reader:
        _formats.append(Format(name, _lowered(suffixes), recognizes, read))
        return read

    return register


@checks_keywords()
def register_mesh_reader(
    name: str, *suffixes: str, names_unit: bool = False
) -> Callable[[MeshReader], MeshReader]:
    """Register the decorated reader of triangles for files whose names end with a suffix.

    The reader returns a mesh without triangles where the file holds a skeleton instead.
    The reader registered last for a suffix counts. `names_unit` tells whether files of the format
    say in which unit they are, so that the reader returns mm.
    """

    def register(read: MeshReader) -> MeshReader:
        _formats.append(MeshFormat(name, _lowered(suffixes), names_unit, read))
        return read

    return register


@checks_keywords()
def register_writer(
    *suffixes: str,
    name: str | None = None,
    solids: bool = True,
    skeletons: bool = True,
    names_unit: bool = False,
    radii: KeptRadii = "all",
) -> Callable[[Writer], Writer]:
    """Register the decorated writer for files with one of `suffixes`, such as ".stl".

    The writer registered last for a suffix counts.

    Parameters
    ----------
    suffixes : such as ".stl"; case does not matter
    name : what lists call the format; by default its first suffix without the dot
    solids, skeletons : whether the format can hold these
    names_unit : whether files of the format say that they are in mm
    radii : which radii of a skeleton it holds; `write` tells of those that are lost
    """
    check_choice(radii, "radii", get_args(KeptRadii))

    def register(write: Writer) -> Writer:
        shown = name or (suffixes[0].lstrip(".").upper() if suffixes else "")
        made = WrittenFormat(shown, _lowered(suffixes), solids, skeletons, names_unit, radii, write)
        _formats.append(made)
        return write

    return register


@checks_keywords()
def unregister(function: Callable[..., Any]) -> None:
    """Take a reader or a writer out of the register, for all of its suffixes.

    Raises
    ------
    OptionError
        If it is not registered.

    Examples
    --------
    >>> from scaffold_cad.io import register_writer, unregister
    >>> @register_writer(".nodes")
    ... def write_nodes(content, path):
    ...     path.write_text(str(content.what.nodes.tolist()))
    >>> unregister(write_nodes)
    """
    kept = [entry for entry in _formats if _function(entry) is not function]
    if len(kept) == len(_formats):
        found = getattr(function, "__name__", repr(function))
        raise OptionError(f"{found} is not registered; need a registered reader or writer")
    _formats[:] = kept


def known_formats() -> tuple[Format, ...]:
    """Return the formats that skeletons are read from, in order of their registration.

    Those of other packages are included.
    """
    _load_entry_points()
    return tuple(entry for entry in _formats if isinstance(entry, Format))


def known_suffixes() -> tuple[str, ...]:
    """Return the suffixes of formats that skeletons are read from, in alphabetic order."""
    return _suffixes(known_formats())


def mesh_formats() -> tuple[MeshFormat, ...]:
    """Return the formats that meshes are read from, in order of their registration."""
    _load_entry_points()
    return tuple(entry for entry in _formats if isinstance(entry, MeshFormat))


def written_formats(solid: bool = False, skeleton: bool = False) -> tuple[WrittenFormat, ...]:
    """Return the formats that are written, or those that can hold solids, or skeletons."""
    _load_entry_points()
    written = [entry for entry in _formats if isinstance(entry, WrittenFormat)]
    return tuple(
        entry
        for entry in written
        if (entry.solids or not solid) and (entry.skeletons or not skeleton)
    )


def written_suffixes(solid: bool = False, skeleton: bool = False) -> tuple[str, ...]:
    """Return the suffixes of `written_formats`, in alphabetic order."""
    return _suffixes(written_formats(solid, skeleton))


def reader_of(path: Path, head: bytes) -> Reader:
    """Return the reader of skeletons for the file at `path` that begins with `head`.

    The suffix decides, unless the content is that of one other format only.

    Raises
    ------
    FormatError
        If no format has the suffix of the file or recognizes its content.
    """
    formats = known_formats()
    by_suffix = [known for known in formats if path.name.lower().endswith(known.suffixes)]
    both = [known for known in by_suffix if known.recognizes(head)]
    if both:
        return both[-1].read
    by_content = [known for known in formats if known.recognizes(head)]
    if len(by_content) == 1:
        _log.warning("%s is read as %s, by its content", path, by_content[0].name)
        return by_content[0].read
    if by_suffix:
        return by_suffix[-1].read  # its error will say what is missing
    suffixes = known_suffixes()
    hint = did_you_mean(path.suffix, suffixes)
    raise FormatError(f"{path} is of no known format; need one of {', '.join(suffixes)}{hint}")


def mesh_format_of(path: Path) -> MeshFormat | None:
    """Return the format with meshes that the suffix of `path` asks for, or None."""
    found = [known for known in mesh_formats() if path.name.lower().endswith(known.suffixes)]
    return found[-1] if found else None


def written_format_of(path: Path, solid: bool = False, skeleton: bool = False) -> WrittenFormat:
    """Return the format that is written to files with the suffix of `path`.

    Parameters
    ----------
    solid : whether it must be able to hold solids
    skeleton : whether only those that hold skeletons are named where none has the suffix

    Raises
    ------
    FormatError
        If no format that is written has the suffix.
    """
    found = [known for known in written_formats(solid) if path.suffix.lower() in known.suffixes]
    if found:
        return found[-1]
    raise unknown_suffix(path, written_suffixes(solid, skeleton))


def _lowered(suffixes: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(suffix.lower() for suffix in suffixes)


def _suffixes(
    formats: tuple[Format, ...] | tuple[MeshFormat, ...] | tuple[WrittenFormat, ...],
) -> tuple[str, ...]:
    return tuple(sorted({suffix for known in formats for suffix in known.suffixes}))


def _function(entry: Format | MeshFormat | WrittenFormat) -> Callable[..., Any]:
    return entry.write if isinstance(entry, WrittenFormat) else entry.read


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
