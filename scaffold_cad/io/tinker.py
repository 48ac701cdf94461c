"""XYZ with bonds as Tinker writes it: balls and sticks."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._molecules import Molecule
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import (
    float_columns,
    is_number,
    line_error,
    read_rows,
    whole_number,
)
from scaffold_cad.io.register import register_reader

_ATOM = "an atom: number, element, x, y, z, type, numbers of its neighbors"


def _recognizes(head: bytes) -> bool:
    if b"\0" in head:
        return False
    lines = [line.split() for line in head.decode("utf-8", errors="replace").splitlines()[:2]]
    return (
        len(lines) == 2
        and lines[0][:1] != []
        and lines[0][0].isdigit()
        and len(lines[1]) >= 6
        and lines[1][0] == "1"
        and not is_number(lines[1][1])
        and all(is_number(word) for word in lines[1][2:6])
    )


def _is_plain_atom(words: list[str]) -> bool:
    """Return whether a line is an element and its place, as in plain XYZ."""
    return len(words) >= 4 and words[0].isalpha() and all(map(is_number, words[1:4]))


@register_reader("Tinker XYZ", ".xyz", ".txyz", recognizes=_recognizes)
def read_xyz(path: Path) -> RawSkeleton:
    """Read atoms and bonds of a Tinker XYZ file; atoms are numbered from 1.

    Elements are those that the atoms' names begin with: CT is carbon, Cl chlorine. The first line
    counts the atoms; a second one with the sides of a periodic box is left out.
    The plain XYZ format has no bonds, and is refused.
    """
    rows = read_rows(path)
    if not rows:
        raise FormatError(f"{path} holds no line; need the number of atoms")
    count = whole_number(path, rows[0][0], rows[0][1][0], "the number of atoms")
    if any(_is_plain_atom(words) for _, words in rows[1:3]):
        raise FormatError(
            f"{path} is plain XYZ, {count} atoms without bonds; need a format with bonds: "
            "Tinker XYZ, MOL, SDF, MOL2, PDB or CJSON"
        )
    if len(rows) > 1 and all(is_number(word) for word in rows[1][1]):
        del rows[1]
    atoms = rows[1:]
    if len(atoms) != count:
        found = f"{path} has {len(atoms)} atoms"
        raise FormatError(f"{found}; need {count}, as the first line says, each {_ATOM}")
    nodes = float_columns(path, atoms, 2, 3, _ATOM)
    edges = []
    for k, (line, words) in enumerate(atoms):
        for word in words[6:]:
            other = whole_number(path, line, word, _ATOM) - 1
            if not 0 <= other < count:
                raise line_error(path, line, f"atom {word}", f"1 to {count}")
            # Each bond is listed at both of its atoms.
            if other > k:
                edges.append((k, other))
    elements = [_element(words[1]) for _, words in atoms]
    return Molecule(elements, nodes.tolist(), edges).skeleton(path)


def _element(name: str) -> str:
    """Return the element of an atom's name: of two letters if the second is a small one."""
    return name[:2] if name[1:2].islower() else name[:1]
