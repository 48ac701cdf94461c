"""Chemical JSON, as Avogadro writes it: balls and sticks, where it names the elements."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._document import member, read_document
from scaffold_cad.io._molecules import SYMBOLS, Molecule
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_reader


def _recognizes(head: bytes) -> bool:
    return b'"chemicalJson"' in head or b'"chemical json"' in head


@register_reader("Chemical JSON", ".cjson", recognizes=_recognizes)
def read_cjson(path: Path) -> RawSkeleton:
    """Read atoms and bonds; the order of bonds is ignored, and lengths, in Å, are taken as mm.

    Atoms whose elements are named, by number or symbol, are balls, and all bonds sticks then.
    """
    document = read_document(path)
    atoms = member(path, document, "atoms", dict)
    places = member(path, member(path, atoms, "coords", dict), "3d", list)
    bonds = member(path, document, "bonds", dict)
    ends = member(path, member(path, bonds, "connections", dict), "index", list)
    nodes, edges = _rows(path, places, 3, "3d"), _rows(path, ends, 2, "index")
    raw = RawSkeleton(nodes, edges)  # refuses bonds of no atom
    elements = _elements(path, atoms, len(nodes))
    if elements is None:
        return raw
    return Molecule(elements, raw.nodes.tolist(), raw.edges.tolist()).skeleton(path)


def _elements(path: Path, atoms: dict[str, object], count: int) -> list[str] | None:
    """Return the symbol of each atom, or None if the file names no elements."""
    named = atoms.get("elements")
    if not isinstance(named, dict):
        return None
    values = named.get("number", named.get("type"))
    if not isinstance(values, list):
        return None
    if len(values) != count:
        raise FormatError(f"{path} has {len(values)} elements; need {count}, one per atom")
    known = dict(enumerate(SYMBOLS, start=1))
    return [value if isinstance(value, str) else known.get(value, "") for value in values]


def _rows(path: Path, values: list[object], width: int, name: str) -> np.ndarray:
    """Return a flat list as rows of `width`."""
    if len(values) % width:
        raise FormatError(f'{path} has {len(values)} numbers in "{name}"; need {width} per row')
    if not all(isinstance(value, int | float) for value in values):
        raise FormatError(f'{path} has values that are not numbers in "{name}"; need numbers')
    return np.asarray(values).reshape(-1, width)
