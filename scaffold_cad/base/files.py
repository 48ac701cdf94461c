"""Files that are written whole or not at all, and messages about those that cannot be read."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

from scaffold_cad.base.arguments import did_you_mean
from scaffold_cad.errors import FormatError

HIDDEN = ".scaffold-cad-"
"""What names of files begin with until they are whole; the number of their process follows."""


def check_name(path: Path, failed: str) -> None:
    """Raise a FormatError if a path has more characters than the system takes, or a null."""
    if "\0" in str(path):
        raise FormatError(f"{failed}: its name has a null character")
    try:
        path.lstat()
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            raise FormatError(f"{failed}: its name is too long for a file") from None


def unknown_suffix(path: Path, known: Iterable[str], what: str = "") -> FormatError:
    """Return the error of a file that cannot be written, with the known suffix nearest to its own.

    Parameters
    ----------
    what : is to be written, if not all things can be written to all `known` formats

    Examples
    --------
    >>> str(unknown_suffix(Path("node.stpe"), [".step", ".stl"]))
    "cannot write node.stpe: its suffix is '.stpe'; need one of .step, .stl; did you mean '.step'?"
    """
    suffix, known = path.suffix.lower(), list(known)
    need = f"{what} need one of" if what else "need one of"
    hint = did_you_mean(suffix, known)
    return FormatError(
        f"cannot write {path}: its suffix is {suffix!r}; {need} {', '.join(known)}{hint}"
    )


def make_folder(path: Path) -> None:
    """Make a folder, and those that it is in, where they are missing.

    Raises
    ------
    FormatError
        If it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise FormatError(f"cannot make the folder {path}: a file has this name") from None
    except OSError as error:
        raise FormatError(f"cannot make the folder {path}: {error.strerror or error}") from None


def check_there(path: Path) -> None:
    """Raise a FormatError if what is to be read is missing, or is no file."""
    check_name(path, f"{path} cannot be read")
    if path.is_dir():
        raise FormatError(f"{path} is a folder; need a file")
    if not path.exists():
        raise FormatError(f"{path} cannot be read: there is no such file")
    if not path.is_file():  # it would be empty when it is read again, or never end
        raise FormatError(f"{path} is a pipe or a device; need a file")


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Tell what fails in the block, which reads a file, in the package's words.

    Raises
    ------
    FormatError
        If it is missing, is no file, or cannot be read.

    Examples
    --------
    >>> with reading(Path("absent.stl")):
    ...     pass
    Traceback (most recent call last):
    ...
    scaffold_cad.errors.FormatError: absent.stl cannot be read: there is no such file
    """
    check_there(path)
    try:
        yield
    except OSError as error:
        raise FormatError(f"{path} cannot be read: {error.strerror or error}") from None


def check_target(path: Path) -> None:
    """Raise unless a file can be written at `path`, as far as can be told without writing it.

    Raises
    ------
    FormatError
        If its name is too long, its folder is missing or read-only, or something else than a file
        is there.
    """
    check_name(path, f"cannot write {path}")
    # A link keeps pointing to its file, whose folder counts.
    folder = Path(os.path.realpath(path)).parent if path.is_symlink() else path.parent
    if not folder.exists():
        raise FormatError(f"cannot write {path}: there is no folder {folder}")
    if not folder.is_dir():
        raise FormatError(f"cannot write {path}: {folder} is not a folder")
    if path.is_dir():
        raise FormatError(f"cannot write {path}: it is a folder; need the name of a file")
    if path.exists() and not path.is_file():
        raise FormatError(f"cannot write {path}: it is a device; need the name of a file")
    if not os.access(folder, os.W_OK):
        raise FormatError(f"cannot write {path}: the folder {folder} is read-only")


def check_page(path: Path) -> None:
    """Raise unless `path` is that of a page, .html, which can be written as far as can be told.

    Raises
    ------
    FormatError
        If it has another suffix, or see `check_target`.
    """
    if path.suffix.lower() != ".html":
        raise FormatError(f"cannot write {path}: it is a page; need .html")
    check_target(path)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a new empty file beside `path` that takes its place once the block is done.

    After any error, or Ctrl-C, the new file is removed and what was at `path` stays as it was.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    check_target(path)
    target = Path(os.path.realpath(path))  # a link keeps pointing to the file
    fresh = target.with_name(f"{HIDDEN}{os.getpid()}-{token_hex(8)}{target.suffix}")
    try:
        fresh.touch(exist_ok=False)
        yield fresh
        with fresh.open("r+b") as file:
            os.fsync(file.fileno())
        if target.exists():
            fresh.chmod(target.stat().st_mode)
        fresh.replace(target)
    except OSError as error:
        why = error.strerror or f"{error}; is the disk full?"  # NumPy tells bytes only
        raise FormatError(f"cannot write {path}: {why}") from None
    finally:
        fresh.unlink(missing_ok=True)


def remove_unfinished(folder: Path, processes: Iterable[int | None]) -> None:
    """Remove the files in a folder that processes had not finished when they were killed."""
    for process in processes:
        for fresh in folder.glob(f"{HIDDEN}{process}-*"):
            fresh.unlink(missing_ok=True)
