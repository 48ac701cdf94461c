"""MDL molecules (.mol, .sdf), V2000 and V3000."""

from __future__ import annotations

import logging
import re
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._molecules import Molecule
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import as_count, is_number, line_error, read_text
from scaffold_cad.io.register import register_reader

_COUNTS = re.compile(rb"^[ \d]{6}.{0,33}V[23]000", re.MULTILINE)
_ATOM = "an atom: x, y, z, element"
_BOND = "a bond: two numbers of atoms"

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    return b"\0" not in head and bool(_COUNTS.search(head.replace(b"\r", b"")))


@register_reader("MOL", ".mol", ".sdf", ".sd", recognizes=_recognizes)
def read_mol(path: Path) -> RawSkeleton:
    """Read the atoms and bonds of a molecule, of the first one of several.

    Atoms are balls of a quarter of their van der Waals radius, bonds sticks of 0.15 Å, and Å are
    taken as mm.
    """
    lines = read_text(path).split("\n")
    ends = [k for k, line in enumerate(lines) if line.startswith("$$$$")]
    if ends and any(line.strip() for line in lines[ends[0] + 1 :]):
        _log.warning("%s holds several molecules; the first one is read", path)
    if len(lines) < 4:
        raise FormatError(f"{path} ends within its header; need four lines and more")
    return (_v3000(path, lines) if "V3000" in lines[3] else _v2000(path, lines)).skeleton(path)


def _v2000(path: Path, lines: list[str]) -> Molecule:
    counts = [_whole(path, 4, lines[3][at : at + 3], "numbers of atoms and bonds") for at in (0, 3)]
    if min(counts) < 0 or len(lines) < 4 + sum(counts):
        raise FormatError(f"{path} ends within {counts[0]} atoms and {counts[1]} bonds; need all")
    molecule = Molecule()
    for k in range(4, 4 + counts[0]):
        # Columns of ten, which some programs do not keep.
        words = [lines[k][at : at + 10].strip() for at in (0, 10, 20)] + [lines[k][31:34].strip()]
        if not all(is_number(word) for word in words[:3]):
            words = lines[k].split()[:4]
        _add_atom(path, k + 1, molecule, words)
    for k in range(4 + counts[0], 4 + sum(counts)):
        ends = [_whole(path, k + 1, lines[k][at : at + 3], _BOND) for at in (0, 3)]
        _add_bond(path, k + 1, molecule, ends[0] - 1, ends[1] - 1)
    return molecule


def _v3000(path: Path, lines: list[str]) -> Molecule:
    molecule, number = Molecule(), dict[str, int]()
    inside = ""
    counts: list[str] = []
    for k, line in enumerate(lines, start=1):
        if line.startswith("M  END"):
            break
        words = line.split()[2:] if line.startswith("M  V30") else []
        if words[:1] == ["BEGIN"]:
            inside = " ".join(words[1:2])
        elif words[:1] == ["END"]:
            inside = ""
        elif words[:1] == ["COUNTS"]:
            counts = words[1:3]
        elif inside == "ATOM" and words:
            number[words[0]] = len(number)
            _add_atom(path, k, molecule, [*words[2:5], *words[1:2]])
        elif inside == "BOND" and words:
            ends = [number.get(word, -1) for word in words[2:4]]
            _add_bond(path, k, molecule, *(ends if len(ends) == 2 else (-1, -1)))
    found = [str(len(molecule.elements)), str(len(molecule.bonds))]
    if len(counts) != 2:
        raise FormatError(f"{path} does not say how many atoms and bonds; need M  V30 COUNTS")
    if found != counts:
        raise FormatError(
            f"{path} has {' atoms and '.join(found)} bonds; need {' and '.join(counts)}, as it says"
        )
    return molecule


def _add_atom(path: Path, line: int, molecule: Molecule, words: list[str]) -> None:
    if len(words) < 4 or not all(is_number(word) for word in words[:3]):
        raise line_error(path, line, f"{' '.join(words)!r}", _ATOM)
    molecule.places.append([float(word) for word in words[:3]])
    molecule.elements.append(words[3])


def _add_bond(path: Path, line: int, molecule: Molecule, start: int, end: int) -> None:
    count = len(molecule.elements)
    if not (0 <= start < count and 0 <= end < count):
        raise line_error(path, line, "a bond of an atom that is not there", f"1 to {count}")
    molecule.bonds.append((start, end))


def _whole(path: Path, line: int, text: str, need: str) -> int:
    number = as_count(text.strip())
    if number is None:
        raise line_error(path, line, f"{text!r}", need)
    return number
