"""Cells of a line of a table, and what the headings of its columns name."""

from __future__ import annotations

import csv
import io
import re

from scaffold_cad.io._units import length_of

_NAME_AND_UNIT = re.compile(r"[^\[(]*[\[(]([^\])]*)[\])]?\s*")
"""Such as ``x1 [m]`` or ``radius (in)``."""


def cells_of(line: str) -> list[str]:
    """Return the cells of a line; semicolons, tabs or commas part them, in this order.

    Where semicolons do, a comma is a decimal point.

    Examples
    --------
    >>> from scaffold_cad.io._columns import cells_of
    >>> cells_of("1,5;2"), cells_of('1.5,"a, b"')
    (['1.5', '2'], ['1.5', 'a, b'])
    """
    mark = next((mark for mark in (";", "\t") if mark in line), ",")
    cells = next(csv.reader(io.StringIO(line), delimiter=mark), []) if line.strip() else []
    return [cell.replace(",", ".") for cell in cells] if mark == ";" else cells


def plain_name(heading: str) -> str:
    """Return the name of a column in small letters and digits, without its unit."""
    name = re.split(r"[\[(]", heading)[0] if _NAME_AND_UNIT.fullmatch(heading) else heading
    return re.sub(r"[^a-z0-9]", "", name.lower())


def unit_name(heading: str) -> str:
    """Return the unit of length that a column names, also squared, or "" if it names none."""
    found = _NAME_AND_UNIT.fullmatch(heading)
    unit = found[1] if found else ""
    return unit.strip().removesuffix("²").removesuffix("^2").removesuffix("2")


def unit_of(heading: str) -> float | None:
    """Return mm in the unit that a column names, None if it names none, or no length."""
    return length_of(unit_name(heading))
