"""Plain JSON of points and edges, as people write it themselves."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import FormatError
from scaffold_cad.io._attributes import AREAS, DIAMETERS
from scaffold_cad.io._document import number, read_document
from scaffold_cad.io._nodes import radius_of_area
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._units import length_of
from scaffold_cad.io.register import register_reader

POINTS = ("points", "nodes", "vertices", "verts", "positions", "coordinates", "coords", "joints")
EDGES = ("edges", "lines", "links", "members", "elements", "bars", "segments", "struts", "bones")
RADII = ("radii", "radius", "r")
OF_EDGES = ("edge_radii", "member_radii", "strut_radii", "edge_radius", "member_radius")

_POINTS = re.compile(rb'"(%s)"\s*:\s*\[\s*\[' % "|".join(POINTS).encode(), re.IGNORECASE)


def _recognizes(head: bytes) -> bool:
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    is_ours = b"scaffold-cad skeleton" in head
    return text.startswith(b"{") and bool(_POINTS.search(head)) and not is_ours


@register_reader("points and edges JSON", ".json", recognizes=_recognizes)
def read_points_edges(path: Path) -> RawSkeleton:
    """Read an object with a list of points, x, y, z or x, y, and one of edges, pairs of points.

    Points are called ``points``, ``nodes``, ``vertices`` and the like, edges ``edges``, ``lines``,
    ``members`` and the like; edges count from 0. ``radii`` is one number, or one per point, or one
    an edge; ``edge_radii``, ``diameters`` and ``areas`` are those of edges. ``unit`` names the
    unit, else lengths are mm.
    """
    document = {key.strip().lower(): value for key, value in read_document(path).items()}
    points = _rows(path, document, POINTS, (2, 3))
    edges = _rows(path, document, EDGES, (2,))
    flat = next((k for k, row in enumerate(points) if len(row) != len(points[0])), None)
    if flat is not None:
        raise FormatError(
            f"{path} has {points[flat]} as point {flat}, and {points[0]} as point 0; "
            "need as many numbers in each"
        )
    places = np.reshape([[*row, 0.0][:3] for row in points], (-1, 3)) * _unit(path, document)
    pairs = np.reshape(np.asarray(edges), (-1, 2))
    if (pairs != np.round(pairs)).any() or (np.abs(pairs) > 2**53).any():
        raise FormatError(f"{path} has edges that are not pairs of whole numbers; need those")
    nodes, of_edges = _radii(path, document, len(points), len(edges))
    scale = _unit(path, document)
    nodes = None if nodes is None else nodes * scale
    of_edges = None if of_edges is None else of_edges * scale
    said = next((str(document[key]) for key in ("unit", "units") if key in document), None)
    return RawSkeleton(places, pairs.astype(np.intp), nodes, of_edges, unit=said)


def _rows(
    path: Path, document: dict[str, Any], names: tuple[str, ...], widths: tuple[int, ...]
) -> list[list[float]]:
    """Return the first list of rows of numbers that is called one of `names`."""
    name = next((name for name in names if isinstance(document.get(name), list)), None)
    if name is None:
        raise FormatError(f"{path} has no list of {names[0]}; need one called {', '.join(names)}")
    rows = []
    for k, row in enumerate(document[name]):
        if not isinstance(row, list) or len(row) not in widths:
            raise FormatError(f'{path} has {str(row)[:80]} as row {k} of "{name}"; need {widths}')
        rows.append([number(path, value, f'a number in row {k} of "{name}"') for value in row])
    return rows


def _radii(
    path: Path, document: dict[str, Any], count: int, edges: int
) -> tuple[Floats | None, Floats | None]:
    """Return the radii of nodes and those of edges, in the file's unit, either or none."""
    nodes = of_edges = None
    for name in RADII:
        if name in document:
            values = _numbers(path, document[name], name)
            if values.shape == () or values.shape == (count,):
                nodes = np.array(np.broadcast_to(values, (count,)))
            else:
                of_edges = values
            break
    for names, power, factor in ((OF_EDGES, 1, 1.0), (DIAMETERS, 1, 0.5), (AREAS, 2, 1.0)):
        for name in (*names, *(f"{name}s" for name in names)):
            if of_edges is None and name in document:
                of_edges = _numbers(path, document[name], name) * factor
                if power == 2:
                    of_edges = np.vectorize(radius_of_area, otypes=[float])(of_edges)
    if of_edges is not None:
        if of_edges.shape not in {(), (edges,), (edges, 2)}:
            raise FormatError(
                f"{path} has radii of shape {of_edges.shape}; need one for all, one or two "
                f"for each of {counted(edges, 'edge')}, or radii of {counted(count, 'point')}"
            )
        if of_edges.shape == ():
            of_edges = np.full(edges, of_edges)
    return nodes, of_edges


def _numbers(path: Path, value: Any, name: str) -> Floats:
    """Return a number, a list of numbers, or one of pairs, as an array."""
    if not isinstance(value, list):
        return np.asarray(number(path, value, name))
    if value and all(isinstance(row, list) and len(row) == 2 for row in value):
        return np.array([[number(path, x, f"{name} {k}") for x in r] for k, r in enumerate(value)])
    return np.array([number(path, row, f"{name} {k}") for k, row in enumerate(value)])


def _unit(path: Path, document: dict[str, Any]) -> float:
    name = document.get("unit", document.get("units", "mm"))
    scale = length_of(str(name))
    if scale is None:
        raise FormatError(f"{path} has the unit {str(name)[:80]!r}; need mm, cm, m, in or ft")
    return scale
