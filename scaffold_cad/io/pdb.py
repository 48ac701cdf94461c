"""PDB molecules: atoms, and the bonds that the file names or that distances tell."""

from __future__ import annotations

import logging
from pathlib import Path

from scaffold_cad.io._molecules import Molecule, bonds_by_distance
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import is_number, line_error, read_text
from scaffold_cad.io.register import register_reader

_ATOMS = ("ATOM  ", "HETATM")
_NEED = "an atom: its number in columns 7 to 11, x, y, z in columns 31 to 54"

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    lines = head.replace(b"\r", b"\n").split(b"\n")
    return b"\0" not in head and any(
        line.startswith((b"ATOM  ", b"HETATM")) and len(line) >= 54 for line in lines
    )


@register_reader("PDB", ".pdb", ".ent", recognizes=_recognizes)
def read_pdb(path: Path) -> RawSkeleton:
    """Read the atoms and bonds of the first model of a PDB file.

    Bonds are those of CONECT; where the file has none, atoms are joined that are closer than their
    covalent radii and 0.45 Å. Of alternate places the first is taken. Atoms are balls of a quarter
    of their van der Waals radius, bonds sticks of 0.15 Å, and Å are taken as mm.
    """
    molecule, number = Molecule(), dict[str, int]()
    lines = read_text(path).split("\n")
    for line, text in enumerate(lines, start=1):
        if text.startswith("ENDMDL"):
            break
        if text.startswith(_ATOMS):
            words = [text[at : at + 8] for at in (30, 38, 46)]
            if not all(is_number(word) for word in words):
                raise line_error(path, line, f"{text.rstrip()!r}", _NEED)
            if text[16:17].strip() not in ("", "A", "1"):
                continue
            number[text[6:11].strip()] = len(molecule.places)
            molecule.places.append([float(word) for word in words])
            molecule.elements.append(text[76:78].strip() or text[12:14].strip(" 0123456789"))
    for text in lines:
        if text.startswith("CONECT"):
            names = [text[at : at + 5].strip() for at in range(6, min(len(text), 31), 5)]
            found = [number[name] for name in names if name in number]
            if names[:1] and names[0] in number:
                molecule.bonds += [(found[0], other) for other in found[1:]]
    if not molecule.bonds:
        pairs = bonds_by_distance(molecule.elements, molecule.places)
        molecule.bonds = [(a, b) for a, b in pairs.tolist()]
        if len(pairs):
            _log.warning("%s names no bonds; %d are taken from distances", path, len(pairs))
    return molecule.skeleton(path)
