"""Tripos MOL2 molecules."""

from __future__ import annotations

import logging
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._molecules import Molecule
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import is_number, line_error, read_rows
from scaffold_cad.io.register import register_reader

_SECTION = "@<TRIPOS>"
_ATOM = "an atom: number, name, x, y, z, type"
_BOND = "a bond: number, and two numbers of atoms"

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    return _SECTION.encode() in head


@register_reader("MOL2", ".mol2", recognizes=_recognizes)
def read_mol2(path: Path) -> RawSkeleton:
    """Read the atoms and bonds of a molecule, of the first one of several.

    Atoms are balls of a quarter of their van der Waals radius, bonds sticks of 0.15 Å, and Å are
    taken as mm.
    """
    molecule, number = Molecule(), dict[str, int]()
    inside, count = "", 0
    said: list[list[str]] = []
    for line, words in read_rows(path):
        if words[0].startswith(_SECTION):
            inside = words[0].removeprefix(_SECTION).upper()
            count += inside == "MOLECULE"
            if count > 1:
                _log.warning("%s holds several molecules; the first one is read", path)
                break
        elif inside == "MOLECULE":
            said.append(words)
        elif inside == "ATOM":
            if len(words) < 6 or not all(is_number(word) for word in words[2:5]):
                raise line_error(path, line, f"{' '.join(words)!r}", _ATOM)
            number[words[0]] = len(number)
            molecule.places.append([float(word) for word in words[2:5]])
            molecule.elements.append(words[5].partition(".")[0])
        elif inside == "BOND":
            ends = [number.get(word, -1) for word in words[1:3]]
            if len(ends) < 2 or min(ends) < 0 or len(number) != len(molecule.places):
                raise line_error(path, line, f"{' '.join(words)!r}", _BOND)
            molecule.bonds.append((ends[0], ends[1]))
    if count == 0:
        raise FormatError(f"{path} has no {_SECTION}MOLECULE; need one")
    found = [str(len(molecule.elements)), str(len(molecule.bonds))]
    counts = said[1][:2] if len(said) > 1 else []
    if found[: len(counts)] != counts:
        raise FormatError(f"{path} has {found} atoms and bonds; need {counts}, as it says")
    return molecule.skeleton(path)
