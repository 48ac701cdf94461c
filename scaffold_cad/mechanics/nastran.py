"""Cards of Nastran's bulk data, and hexahedra written with them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.arrays import Ints
from scaffold_cad.mechanics.hexahedra.builder import Hexahedra, sets_by_owner


def card(name: str, *fields: float | int | None) -> str:
    """Return a card of 16 characters per field, four per line."""
    texts = [_wide(field) for field in fields]
    lines = [texts[k : k + 4] for k in range(0, len(texts), 4)]
    starts = [f"{name + '*':<8}"] + ["*" + " " * 7] * (len(lines) - 1)
    return "\n".join(
        start + "".join(line) for start, line in zip(starts, lines, strict=True)
    ).rstrip()


def _wide(field: float | int | None) -> str:
    """Return a field of 16 characters; None is empty."""
    if field is None:
        return " " * 16
    text = str(field) if isinstance(field, int) else f"{field:.9E}"
    return f"{text:>16}"


def short(value: float) -> str:
    """Return a number in at most 8 characters that reads as real."""
    for digits in range(6, 0, -1):
        text = f"{value:.{digits}g}"
        if "." not in text and "e" not in text:
            text += "."
        text = text.replace("e-0", "-").replace("e-", "-").replace("e+0", "+").replace("e+", "+")
        if len(text) <= 8:
            return text
    return text


def hexahedra_cards(mesh: Hexahedra) -> Iterator[str]:
    """Give the lines of a file of hexahedra: one PSOLID per strut, numbered from 1, of material 1.

    Case control has SETs of the elements at each node and of the points in each end face.
    """
    yield "CEND"
    sets = sets_by_owner("NODE", mesh.node_of_hexahedron)
    sets |= sets_by_owner("END", mesh.end_of_point)
    for k, (name, members) in enumerate(sets.items(), 1):
        yield f"$ {name}"
        yield from _set_lines(k, members)
    yield "BEGIN BULK"
    yield card("MAT1", 1, 1.0, None, 0.3)
    for strut in np.unique(mesh.edge_of_hexahedron).tolist():
        yield f"PSOLID,{strut + 1},1"
    for k, place in enumerate(mesh.points.tolist(), 1):
        yield card("GRID", k, None, *place)
    rows = zip(mesh.edge_of_hexahedron.tolist(), (mesh.hexahedra + 1).tolist(), strict=True)
    for k, (strut, corners) in enumerate(rows, 1):
        first, last = (",".join(map(str, part)) for part in (corners[:6], corners[6:]))
        yield f"CHEXA,{k},{strut + 1},{first},+\n+,{last}"
    yield "ENDDATA"


def _set_lines(number: int, rows: Ints) -> Iterator[str]:
    """Give the lines of a SET of items, numbered from 1, at most 72 characters each."""
    words = [str(one) for one in (rows + 1).tolist()]
    lines = [", ".join(words[k : k + 6]) for k in range(0, len(words), 6)]
    yield f"SET {number} = " + ",\n".join(lines)
