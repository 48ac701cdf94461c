"""Hexahedra as an input file of CalculiX and Abaqus."""

from __future__ import annotations

from collections.abc import Iterator

from scaffold_cad.base.arrays import Ints
from scaffold_cad.mechanics.hexahedra.builder import Hexahedra, sets_by_owner

SET_COLUMNS = 16
"""Numbers in a line of a set: CalculiX reads no more."""


def hexahedra_lines(mesh: Hexahedra) -> Iterator[str]:
    """Give the lines of a file of hexahedra (C3D8I), with sets by strut, node and end."""
    yield "*NODE, NSET=NALL"
    for k, place in enumerate(mesh.points.tolist(), 1):
        # CalculiX reads 20 characters a number.
        yield f"{k}, " + ", ".join(f"{x:.12g}" for x in place)
    yield "*ELEMENT, TYPE=C3D8I, ELSET=EALL"
    for k, corners in enumerate((mesh.hexahedra + 1).tolist(), 1):
        yield f"{k}, " + ", ".join(map(str, corners))
    for name, rows in sets_by_owner("STRUT", mesh.edge_of_hexahedron).items():
        yield from _set_lines(f"*ELSET, ELSET={name}", rows)
    for name, rows in sets_by_owner("NODE", mesh.node_of_hexahedron).items():
        yield from _set_lines(f"*ELSET, ELSET={name}", rows)
    for name, rows in sets_by_owner("END", mesh.end_of_point).items():
        yield from _set_lines(f"*NSET, NSET={name}", rows)


def _set_lines(head: str, rows: Ints) -> Iterator[str]:
    """Give the lines of a set of items, numbered from 1."""
    yield head
    numbers = (rows + 1).tolist()
    for k in range(0, len(numbers), SET_COLUMNS):
        yield ", ".join(map(str, numbers[k : k + SET_COLUMNS]))
