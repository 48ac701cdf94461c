"""Abaqus and CalculiX input files (.inp): beams, pipes and trusses with their sections."""

from __future__ import annotations

import logging
import math
from itertools import pairwise
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import FormatError
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._units import factor_of
from scaffold_cad.io.abaqus.model import Block, Model, Part, model_of, nodes_named, numbers_of
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer

HELD = {
    "ENCASTRE": (0, 1, 2, 3, 4, 5), "PINNED": (0, 1, 2),
    "XSYMM": (0, 4, 5), "YSYMM": (1, 3, 5), "ZSYMM": (2, 3, 4),
    "XASYMM": (1, 2, 3), "YASYMM": (0, 2, 4), "ZASYMM": (0, 1, 5),
}  # fmt: skip
"""Freedoms 0..5 of a node that supports with names hold."""

SIGNIFICANT = 9
"""Digits to which radii are the same section when beams are written."""

UPRIGHT = 0.7
"""Cosine of the angle to z below which a beam's section has its first axis along -z."""

YOUNG = 210e3
"""Young's modulus of steel, MPa."""

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    upper = head.upper()
    return any(
        line.startswith((b"*NODE", b"*HEADING", b"*PART"))
        for line in upper.replace(b"\r", b"\n").split(b"\n")
    )


@register_reader("Abaqus input", ".inp", recognizes=_recognizes)
def read_abaqus(path: Path) -> RawSkeleton:
    """Read the beams, pipes and trusses of an Abaqus or CalculiX input file; other elements go.

    A beam with a node at its middle is two edges. The radius of a member is that of its circle or
    pipe, or of the circle of its section's area. Parts are placed by their instances. Lengths are
    taken as mm, forces as N; files that are included are not read. Supports (*BOUNDARY) and loads
    (*CLOAD) of the model and its first step are kept.
    """
    model = model_of(path)
    graph = NamedGraph(path)
    for number, (_, name, matrix) in enumerate(model.instances):
        _add(graph, model.parts[name], number, matrix)
    if len(graph) and not len(graph.skeleton().edges):
        raise FormatError(f"{path} has nodes and no struts; need beams, pipes or trusses")
    for block in model.conditions:
        _add_conditions(path, graph, model, block)
    return graph.skeleton()


def _add_conditions(path: Path, graph: NamedGraph, model: Model, block: Block) -> None:
    """Add the supports or loads of a block to their nodes."""
    if block.options.get("TYPE", "DISPLACEMENT").upper() != "DISPLACEMENT":
        _log.warning("%s, line %d: supports with a speed are left out", path, block.line)
        return
    for line, words in block.rows:
        nodes, where = nodes_named(path, line, words[0], model), f"line {line}"
        name = words[1].upper() if len(words) > 1 else ""
        if block.keyword == "BOUNDARY" and name in HELD:
            for node in nodes:
                graph.hold(node, HELD[name], where=where)
            continue
        is_load = block.keyword == "CLOAD"
        first, last, value = _condition(path, line, words, is_load)
        for node in nodes:
            for freedom in range(max(first, 1) - 1, min(last, 6)):
                if is_load:
                    graph.pull(node, freedom, value, where)
                else:
                    graph.hold(node, [freedom], value, where)


def _condition(path: Path, line: int, words: list[str], is_load: bool) -> tuple[int, int, float]:
    """Return the first and the last freedom, from 1, of a line of data, and its value."""
    need = "a node or a set, then freedoms 1 to 6 and a value"
    first, second, third = [*words[1:], "", "", ""][:3]
    begin = int(numbers_of(path, line, [first], need)[0])
    if is_load:
        return begin, begin, numbers_of(path, line, [second], need)[0]
    end = int(numbers_of(path, line, [second or first], need)[0])
    return begin, end, numbers_of(path, line, [third or "0"], need)[0]


def _add(graph: NamedGraph, part: Part, number: int, matrix: Floats) -> None:
    """Add a part that is placed by `matrix`, shape (4, 3)."""
    for node, (line, place) in part.nodes.items():
        point = np.array([*place, 0.0, 0.0][:3]) @ matrix[:3] + matrix[3]
        graph.add_node((number, node), point.tolist(), where=f"line {line}")
    radii = part.radii()
    for element, (line, nodes) in part.struts.items():
        radius = radii.get(element, math.nan)
        for a, b in pairwise(nodes):
            graph.add_edge((number, a), (number, b), radius, f"line {line}")


@register_writer(".inp", name="Abaqus input", solids=False, radii="means")
def write_abaqus(content: Content, path: Path) -> None:
    """Write a Skeleton as beams B31 of steel, with one circular section a radius.

    A beam has the mean of the radii of its ends: the format has no beams that taper. The modulus
    is in N over the square of the unit of lengths. Beams along z have sections of their own, as
    the format's first axis of a section, if none is given, is along z too.
    """
    skeleton = content.skeleton("an .inp file")
    radii = skeleton.edge_radii.mean(axis=1)
    rounded = np.array([float(f"{radius:.{SIGNIFICANT}g}") for radius in radii.tolist()])
    along = skeleton.nodes[skeleton.edges[:, 1]] - skeleton.nodes[skeleton.edges[:, 0]]
    upright = np.abs(along[:, 2]) > UPRIGHT * length(along)
    kinds = np.stack([rounded, upright], axis=1)
    sections, section = np.unique(kinds, axis=0, return_inverse=True)
    section = section.reshape(-1)
    young = YOUNG * factor_of(content.unit, None) ** 2
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"*HEADING\nscaffold_cad, unit: {content.unit}\n*NODE\n")
        rows = enumerate(skeleton.nodes.tolist(), start=1)
        file.writelines(f"{k}, {x!r}, {y!r}, {z!r}\n" for k, (x, y, z) in rows)
        for number in range(1, len(sections) + 1):
            file.write(f"*ELEMENT, TYPE=B31, ELSET=S{number}\n")
            chosen = np.flatnonzero(section == number - 1)
            pairs = (skeleton.edges[chosen] + 1).tolist()
            file.writelines(
                f"{k + 1}, {a}, {b}\n" for k, (a, b) in zip(chosen.tolist(), pairs, strict=True)
            )
        file.write(f"*MATERIAL, NAME=M\n*ELASTIC\n{young!r}, 0.3\n")
        for number, (radius, is_upright) in enumerate(sections.tolist(), start=1):
            file.write(f"*BEAM SECTION, ELSET=S{number}, MATERIAL=M, SECTION=CIRC\n{radius!r}\n")
            file.write("1., 0., 0.\n" if is_upright else "0., 0., -1.\n")
