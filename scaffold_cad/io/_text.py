"""Lines of words and numbers, and errors that name the line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.errors import FormatError

Row: TypeAlias = tuple[int, list[str]]
"""Number of a line, from 1, and its words."""

LARGEST_FILE = 2**30
"""Most bytes that are read from a file or an archive's part: 20 million struts and more."""

LONGEST_COUNT = 18
"""Digits of the largest count that is taken: those of 64 bits."""

LARGEST_WHOLE = 2.0**53
"""Beyond it float64 has no longer every whole number."""


def read_text(path: Path) -> str:
    """Return the text of a file, its line ends made one; what is not UTF-8 becomes U+FFFD.

    Raises
    ------
    FormatError
        If the file is too large or is not text.
    """
    check_size(path, LARGEST_FILE)
    data = path.read_bytes()
    if b"\0" in data:
        raise FormatError(f"{path} is not text: byte {data.index(0)} is zero; need UTF-8 text")
    text = data.decode("utf-8-sig", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def check_size(path: Path, limit: int) -> None:
    """Raise a FormatError if a file has more than `limit` bytes."""
    size = path.stat().st_size
    if size > limit:
        raise FormatError(f"{path} has {size} bytes; need at most {limit}")


def read_rows(path: Path) -> list[Row]:
    """Return the lines of a text file that hold more than a comment, which begins with ``#``."""
    rows = []
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        words = line.partition("#")[0].split()
        if words:
            rows.append((number, words))
    return rows


def first_words(head: bytes) -> list[str]:
    """Return the words of the first line that holds more than a comment; none if binary."""
    if b"\0" in head:
        return []
    lines = head.decode("utf-8-sig", errors="replace").splitlines()
    return next((words for line in lines if (words := line.partition("#")[0].split())), [])


def is_number(word: str | bytes) -> bool:
    """Return whether `word` is a number, NaN and infinity included."""
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in str(word)  # which Python takes between digits


def line_error(path: Path | str, line: int, found: str, needed: str) -> FormatError:
    """Return the error for a line of a text file."""
    shown = found if len(found) <= 80 else f"{found[:80]}..."
    return FormatError(f"{path}, line {line}: {shown}; need {needed}")


def float_columns(path: Path, rows: Sequence[Row], first: int, count: int, need: str) -> Floats:
    """Return words `first` to `first + count - 1` of each row as numbers, shape (k, count).

    Raises
    ------
    FormatError
        If a row is too short or a word is not a number; the line is named, and `need`.
    """
    chosen = slice(first, first + count)
    numbers = floats(path, rows, chosen, need)
    if len(numbers) != count * len(rows):
        line, words = next(row for row in rows if len(row[1]) < chosen.stop)
        raise short_row(path, line, words, need)
    return numbers.reshape(-1, count)


def floats(path: Path, rows: Sequence[Row], chosen: slice, need: str) -> Floats:
    """Return the words that are `chosen` of each row as numbers, one row after the other.

    Raises
    ------
    FormatError
        If a word is not a number; the line is named, and `need`.
    """
    found = [word for _, words in rows for word in words[chosen]]
    try:
        if "_" in "".join(found):
            raise ValueError
        return np.asarray(list(map(float, found)), dtype=np.float64)
    except ValueError:
        line, word = next(
            (line, word) for line, words in rows for word in words[chosen] if not is_number(word)
        )
        raise line_error(path, line, f"{word!r} is not a number", need) from None


def floats_of_words(path: Path, words: Sequence[bytes], need: str) -> Floats:
    """Return words as numbers, (k,).

    Raises
    ------
    FormatError
        If one is not a number; it is named, and `need`.
    """
    try:
        if b"_" in b"".join(words):
            raise ValueError
        return np.array(words, dtype=np.float64)
    except ValueError:
        bad = next(word for word in words if not is_number(word)).decode(errors="replace")
        raise FormatError(f"{path} has {bad[:80]!r} as a number; need {need}") from None


def short_row(path: Path, line: int, words: list[str], need: str) -> FormatError:
    """Return the error for a line with too few words."""
    return line_error(path, line, f"{' '.join(words)!r} is too short", need)


def whole_number(path: Path, line: int, word: str, need: str) -> int:
    """Return `word` as a whole number.

    Raises
    ------
    FormatError
        If it is not; the line is named, and `need`.
    """
    try:
        if "_" in word:
            raise ValueError
        return int(word)
    except ValueError:
        raise line_error(path, line, f"{word!r} is not a whole number", need) from None


def as_count(word: str) -> int | None:
    """Return a word of digits as a number, or None if it is something else, or longer than any."""
    return int(word) if word.isdecimal() and len(word) <= LONGEST_COUNT else None


def as_indices(path: Path, values: Floats) -> Ints:
    """Return numbers that were read as floats as indices, in or out of range.

    Raises
    ------
    FormatError
        If one is not a whole number that a float64 holds exactly.
    """
    whole = (np.abs(values) < LARGEST_WHOLE) & (values == np.round(values))
    bad = np.flatnonzero(~whole)
    if len(bad):
        raise FormatError(f"{path} has the index {values[bad[0]]:g}; need a whole number")
    return values.astype(np.intp)


def index_columns(
    path: Path, rows: Sequence[Row], first: int, count: int, limit: int, need: str
) -> Ints:
    """Return words `first` to `first + count - 1` of each row as indices, shape (k, count).

    Raises
    ------
    FormatError
        If a row is too short or a word is not a whole number in 0..limit-1; the line is named,
        and `need`.
    """
    flat = []
    for line, words in rows:
        if len(words) < first + count:
            raise short_row(path, line, words, need)
        for word in words[first : first + count]:
            index = whole_number(path, line, word, need)
            if not 0 <= index < limit:
                raise line_error(path, line, f"index {word}", f"0 to {limit - 1}")
            flat.append(index)
    return np.asarray(flat, dtype=np.intp).reshape(-1, count)
