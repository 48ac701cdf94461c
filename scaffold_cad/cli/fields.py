"""Numbers of the command line that may vary from place to place: then a file holds their values."""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scaffold_cad.base.arrays import Floats
from scaffold_cad.cli import sizes
from scaffold_cad.cli.nets import NetFile
from scaffold_cad.errors import FormatError
from scaffold_cad.io.fields import FIELD_SUFFIXES, read_field

ABOUT = (
    "a number, or a file of values at places: .vti .vtu .vtp (FILE:NAME for one of several), or "
    "lines of x, y, z and a value: .csv .txt .dat"
)
"""What may stand for such a number."""

FILE = re.compile(rf"(.+(?:{'|'.join(map(re.escape, FIELD_SUFFIXES))}))(?::(.+))?", re.IGNORECASE)
"""A file, and the name of the values in it."""


@dataclass(frozen=True)
class FieldFile:
    """A file of values that is not read yet."""

    path: Path
    name: str | None

    def read(self) -> Any:
        """Return the field.

        Raises
        ------
        FormatError
            If the file cannot be read, or holds several fields and none is named.
        """
        try:
            return read_field(self.path, self.name)
        except FormatError as error:
            told = str(error).replace("need name= one of them", "need FILE:NAME")
            raise FormatError(told) from None


def number(text: str) -> float | FieldFile:
    """Return a number, or the file that holds it for each place."""
    try:
        return _file(text) or float(text)
    except ValueError:
        known = " ".join(FIELD_SUFFIXES)
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a number; need one, or a file of values: {known}"
        ) from None


def size(text: str) -> Floats | FieldFile:
    """Return one number, three, or the file that holds one for each place."""
    return _file(text) or sizes.size(text)


def with_contents(options: argparse.Namespace) -> argparse.Namespace:
    """Return options with the fields and nets that files hold in place of these.

    Raises
    ------
    FormatError
        If a file cannot be read, or holds several fields and none is named.
    """
    read = {
        name: value.read()
        for name, value in vars(options).items()
        if isinstance(value, FieldFile | NetFile)
    }
    return argparse.Namespace(**{**vars(options), **read})


def _file(text: str) -> FieldFile | None:
    """Return the file that a text names, or None."""
    found = FILE.fullmatch(text)
    return FieldFile(Path(found[1]), found[2]) if found else None
