"""Unit cells of the command line: by name, or nets of Systre files."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_nets
from scaffold_cad.lattice import UnitCell

FILE = re.compile(r"(.+\.cgd)(?::(.+))?", re.IGNORECASE)
"""A file of nets, and the name of one of them."""


@dataclass(frozen=True)
class NetFile:
    """A net of a file that is not read yet."""

    path: Path
    name: str | None

    def read(self) -> UnitCell:
        """Return the net as a unit cell.

        Raises
        ------
        FormatError
            If the file cannot be read, has no net of that name, or several and none is named.
        """
        nets = read_nets(self.path)
        found = [net for net in nets if self.name in (None, net.name)]
        if len(found) == 1:
            return found[0]
        names = ", ".join(net.name for net in nets)
        which = "" if self.name is None else f", and {len(found)} are called {self.name!r}"
        raise FormatError(f"{self.path} holds nets {names}{which}; need FILE:NAME of one of them")


def cell(text: str) -> str | NetFile:
    """Return the name of a unit cell, or the file that holds it."""
    found = FILE.fullmatch(text)
    return NetFile(Path(found[1]), found[2]) if found else text
