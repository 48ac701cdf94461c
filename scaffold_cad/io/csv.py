"""CSV: tables of members, of nodes and members, or of samples along a path; columns by name.

==================  ================================================================================
table               columns
==================  ================================================================================
members             ``x1 y1 z1 x2 y2 z2``
nodes               ``x y z``, and the name of each node: ``node``, ``id``, ``name``, ``number``
members of nodes    ``start end``, also ``i j``, ``a b``, ``source target``, ``from to``, ``n1 n2``
samples             ``x y z``; with ``parent`` as in SWC, else in order, each ``branch`` apart
==================  ================================================================================

Any of them may have ``radius``, ``diameter`` or ``area``; members ``r1 r2`` too. A unit may follow
a name, as in ``x1 [m]`` or ``radius (in)``. Columns are parted by commas, semicolons or tabs; where
semicolons part them, a comma is a decimal point. Two tables of one file are parted by an empty
line; else a table of members looks for its nodes, and one of nodes for its members, in the file of
the other name beside it (``truss_nodes.csv``, ``truss_members.csv``).
"""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._columns import cells_of, plain_name, unit_name, unit_of
from scaffold_cad.io._nodes import NamedGraph, radius_of_area
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import line_error, read_text
from scaffold_cad.io._units import MILLIMETERS
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer
from scaffold_cad.skeleton import Skeleton

_AXES = ("x", "y", "z")
_START = (
    ("x1", "y1", "z1"),
    ("xi", "yi", "zi"),
    ("xstart", "ystart", "zstart"),
    ("ax", "ay", "az"),
)
_END = (("x2", "y2", "z2"), ("xj", "yj", "zj"), ("xend", "yend", "zend"), ("bx", "by", "bz"))
_ENDS = (
    ("start", "end"),
    ("i", "j"),
    ("nodei", "nodej"),
    ("inode", "jnode"),
    ("a", "b"),
    ("source", "target"),
    ("from", "to"),
    ("n1", "n2"),
    ("node1", "node2"),
    ("v1", "v2"),
    ("startnode", "endnode"),
)
_NAMES = ("node", "id", "name", "number", "nodeid", "no", "index", "tag", "sample")
_BRANCHES = ("branch", "path", "line", "curve", "polyline", "group")
_SIZES = ("radius", "r", "diameter", "d", "area", "r1", "r2", "radius1", "radius2")
_KNOWN = {
    *_AXES, *_NAMES, *_BRANCHES, *_SIZES, "parent",
    *(name for group in (*_START, *_END, *_ENDS) for name in group),
}  # fmt: skip

_LENGTHS = (*_AXES, *(name for group in (*_START, *_END) for name in group), *_SIZES)
"""Columns of lengths and areas."""

_NODE_FILES, _MEMBER_FILES = (
    ("nodes", "points"),
    ("members", "edges", "elements", "links", "struts"),
)

SEPARATOR = re.compile(r"sep=.?", re.IGNORECASE)
"""First line by which Excel tells itself what separates columns."""

_NEED = (
    "columns x1 y1 z1 x2 y2 z2 of members, x y z of nodes beside start and end of members, or x y z"
)

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Table:
    """A table of a file: values by the name of their column, and the line of each row."""

    path: Path
    columns: dict[str, int]
    """Where a column is, by its plain name."""
    units: dict[str, float]
    """mm in the unit that a column names."""
    said: dict[str, str]
    """The name of this unit, also where it does not measure lengths."""
    rows: list[tuple[int, list[str]]]

    def first(self, groups: Sequence[tuple[str, ...]]) -> tuple[str, ...] | None:
        """Return the first of some groups of columns of which all but z are there."""
        return next((g for g in groups if set(g[:2]) <= set(self.columns)), None)

    def any_of(self, names: Sequence[str]) -> str | None:
        return next((name for name in names if name in self.columns), None)

    def text(self, row: tuple[int, list[str]], name: str) -> str:
        at = self.columns[name]
        return row[1][at].strip() if at < len(row[1]) else ""

    def number(self, row: tuple[int, list[str]], name: str, power: int = 1) -> float:
        """Return a value in mm, or in mm to a power."""
        text = self.text(row, name)
        try:
            return float(text) * self.units.get(name, 1.0) ** power
        except ValueError:
            raise line_error(self.path, row[0], f"{name} is {text!r}", "a number") from None

    def point(self, row: tuple[int, list[str]], names: Sequence[str]) -> list[float]:
        return [self.number(row, name) for name in names if name in self.columns]

    def radius(self, row: tuple[int, list[str]]) -> float | tuple[float, float]:
        """Return the radius of a row, or those of both ends, mm; NaN where it has none."""
        for first, second in (("r1", "r2"), ("radius1", "radius2")):
            if first in self.columns and second in self.columns:
                return self.number(row, first), self.number(row, second)
        name = self.any_of(("radius", "r", "diameter", "d", "area"))
        if name is None or not self.text(row, name):
            return math.nan
        if name == "area":
            return radius_of_area(self.number(row, name, 2))
        return self.number(row, name) / (2.0 if name in ("diameter", "d") else 1.0)


def _recognizes(head: bytes) -> bool:
    if b"\0" in head or b"\n" not in head:
        return False
    lines = head.decode("utf-8-sig", errors="replace").replace("\r", "\n").split("\n")
    told = (line for line in lines if line.strip() and not line.startswith("#"))
    first = next((line for line in told if not SEPARATOR.fullmatch(line.strip())), "")
    names = {plain_name(cell) for cell in cells_of(first)}
    return len(names) >= 2 and len(names & _KNOWN) >= 2


@register_reader("CSV", ".csv", ".tsv", recognizes=_recognizes)
def read_csv(path: Path) -> RawSkeleton:
    """Read members, nodes and members, or samples of a path; this module says which columns.

    Lengths without a unit are taken as mm.
    """
    tables = _tables(path)
    raw = _graph(path, tables)
    units = (table.said[name] for table in tables for name in _LENGTHS if name in table.said)
    unit = next(units, None)
    return raw if unit is None else replace(raw, unit=unit)


def _graph(path: Path, tables: list[_Table]) -> RawSkeleton:
    """Return the graph of the tables of a file, and of the file beside it."""
    links = [table for table in tables if table.first(_ENDS) and not table.first(_START)]
    places = [table for table in tables if table.first([_AXES])]
    whole = [table for table in tables if table.first(_START) and table.first(_END)]
    if whole:
        return _of_members(whole)
    if links and not places:
        beside = _beside(path, _MEMBER_FILES, _NODE_FILES)
        places = [] if beside is None else _tables(beside)
        places = [table for table in places if table.first([_AXES])]
        if not places:
            raise FormatError(f"{path} has members and no nodes; need a table of x, y, z too")
    if places and not links and places[0].any_of(_NAMES) and "parent" not in places[0].columns:
        beside = _beside(path, _NODE_FILES, _MEMBER_FILES)
        if beside is None:
            raise FormatError(f"{path} has nodes and no members; need start and end of members too")
        found = _tables(beside)
        if any(table.first(_START) for table in found):
            return read_csv(beside)
        links = [table for table in found if table.first(_ENDS)]
    if links:
        return _of_nodes(places, links)
    if places:
        return _of_samples(places[0])
    raise FormatError(f"{path} has the columns {', '.join(tables[0].columns)[:80]}; need {_NEED}")


def _of_members(tables: list[_Table]) -> RawSkeleton:
    graph = NamedGraph(tables[0].path)
    for table in tables:
        start, end = table.first(_START) or (), table.first(_END) or ()
        if (start[2] in table.columns) != (end[2] in table.columns):
            there, missing = sorted((start[2], end[2]), key=lambda name: name not in table.columns)
            raise FormatError(
                f"{table.path} has a column {there} and no column {missing}; need both, or none"
            )
        for row in table.rows:
            ends = [tuple(table.point(row, names)) for names in (start, end)]
            for place in ends:
                # The table has no other way to share a node than to repeat its coordinates.
                if place not in graph:
                    graph.add_node(place, place)
            graph.add_edge(ends[0], ends[1], table.radius(row), f"line {row[0]}")
    return graph.skeleton()


def _of_nodes(places: list[_Table], links: list[_Table]) -> RawSkeleton:
    graph = NamedGraph(links[0].path)
    for table in places:
        name = table.any_of(_NAMES)
        for row in table.rows:
            key = str(len(graph)) if name is None else _name(table.text(row, name))
            radius = table.radius(row)
            where = f"line {row[0]}"
            graph.add_node(key, table.point(row, _AXES), _single(radius), where)
    for table in links:
        start, end = table.first(_ENDS) or ("", "")
        for row in table.rows:
            ends = [_name(table.text(row, name)) for name in (start, end)]
            graph.add_edge(ends[0], ends[1], table.radius(row), f"line {row[0]}")
    return graph.skeleton()


def _of_samples(table: _Table) -> RawSkeleton:
    graph = NamedGraph(table.path)
    name, branch = table.any_of(_NAMES), table.any_of(_BRANCHES)
    keys = [
        str(k) if name is None else _name(table.text(r, name)) for k, r in enumerate(table.rows)
    ]
    for key, row in zip(keys, table.rows, strict=True):
        graph.add_node(key, table.point(row, _AXES), _single(table.radius(row)), f"line {row[0]}")
    for k, row in enumerate(table.rows):
        if "parent" in table.columns:
            parent = _name(table.text(row, "parent"))
            if parent not in ("", "-1"):
                graph.add_edge(parent, keys[k], where=f"line {row[0]}")
        elif k and (branch is None or _same(table, k, branch)):
            graph.add_edge(keys[k - 1], keys[k])
    return graph.skeleton()


def _same(table: _Table, k: int, name: str) -> bool:
    return table.text(table.rows[k - 1], name) == table.text(table.rows[k], name)


def _single(radius: float | tuple[float, float]) -> float:
    return max(radius) if isinstance(radius, tuple) else radius


def _name(text: str) -> str:
    """Return a name of a node; 3 and 3.0 are the same."""
    return text.removesuffix(".0")


def _beside(path: Path, kinds: Sequence[str], others: Sequence[str]) -> Path | None:
    """Return the file beside `path` whose name has one of `others` in place of one of `kinds`."""
    stem = path.stem.lower()
    kind = next((kind for kind in kinds if kind in stem), None)
    if kind is None:
        return None
    at = stem.index(kind)
    for other in others:
        found = path.with_name(path.stem[:at] + other + path.stem[at + len(kind) :] + path.suffix)
        if found.is_file():
            _log.info("%s: %s is read with it", path, found.name)
            return found
    return None


def _tables(path: Path) -> list[_Table]:
    """Return the tables of a file, which empty lines part; a comment begins with ``#``."""
    tables: list[_Table] = []
    inside, width = False, 0
    for line, text in enumerate(read_text(path).split("\n"), start=1):
        if text.lstrip().startswith("#") or (line == 1 and SEPARATOR.fullmatch(text.strip())):
            continue
        cells = cells_of(text)
        if not any(cell.strip() for cell in cells):
            inside = False
        elif not inside and _is_header(cells):
            named = [(plain_name(cell), unit_of(cell)) for cell in cells]
            columns: dict[str, int] = {}
            for k, (name, _) in enumerate(named):
                if columns.setdefault(name, k) != k and name in _KNOWN:
                    raise line_error(path, line, f"column {name} is there twice", "it once")
            units = {name: unit for name, unit in named if unit is not None}
            said = {name: unit_name(cells[k]) for name, k in columns.items() if unit_name(cells[k])}
            tables.append(_Table(path, columns, units, said, []))
            inside, width = True, len(cells)
        elif not tables:
            raise line_error(path, line, f"{text.strip()!r} names no columns", _NEED)
        elif any(cell.strip() for cell in cells[width:]):
            raise line_error(
                path, line, f"{len(cells)} cells below {width} headings", "as many, or fewer"
            )
        else:
            tables[-1].rows.append((line, cells))
            inside = True
    if not tables:
        raise FormatError(f"{path} holds no table; need {_NEED}")
    _check_units(path, tables)
    _check_ends(path, tables)
    return tables


def _check_ends(path: Path, tables: list[_Table]) -> None:
    """Raise where a column of radii is that of one end of members, and the other end has none."""
    for table in tables:
        for pair in (("r1", "r2"), ("radius1", "radius2")):
            there = [name for name in pair if name in table.columns]
            if len(there) == 1:
                missing = pair[1 - pair.index(there[0])]
                raise FormatError(
                    f"{path} has a column {there[0]} and no column {missing}; need both, or radius"
                )


def _check_units(path: Path, tables: list[_Table]) -> None:
    """Raise where a column of lengths names no unit of length, or only some of them have one.

    Columns without a unit are in mm, which is not meant beside places in another unit.
    """
    lengths = [(table, name) for table in tables for name in _LENGTHS if name in table.columns]
    for table, name in lengths:
        if name in table.said and name not in table.units:
            raise FormatError(
                f"{path}: column {name} has the unit {table.said[name]!r}; need one of "
                f"{', '.join(MILLIMETERS)}, or none"
            )
    places = (name for table, name in lengths if table.units.get(name, 1.0) != 1.0)
    other = next((name for name in places if name not in _SIZES), None)
    bare = next((name for table, name in lengths if name not in table.said), None)
    if other is not None and bare is not None:
        raise FormatError(
            f"{path}: column {other} has a unit and column {bare} has none; need one in each, "
            "or in none of them, with units="
        )


def _is_header(cells: list[str]) -> bool:
    return any(plain_name(cell) in _KNOWN for cell in cells)


@register_writer(".csv", name="CSV", solids=False, radii="members")
def write_csv(content: Content, path: Path) -> None:
    """Write the members of a Skeleton, a line each: both ends and both radii, exact.

    Columns name their unit where it is not mm.
    """
    skeleton: Skeleton = content.skeleton("a CSV file")
    ends = skeleton.nodes[skeleton.edges].reshape(-1, 6).tolist()
    radii = skeleton.edge_radii.tolist()
    with path.open("w", encoding="ascii", newline="\n") as file:
        unit = "" if content.unit == "mm" else f" [{content.unit}]"
        names = ("x1", "y1", "z1", "x2", "y2", "z2", "r1", "r2")
        file.write(",".join(name + unit for name in names) + "\n")
        file.writelines(
            ",".join(map(repr, [*row, *pair])) + "\n" for row, pair in zip(ends, radii, strict=True)
        )
