"""`scaffold-cad info`: what a file with a skeleton or a solid holds."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.summaries import range_text, size_text
from scaffold_cad.cli import source
from scaffold_cad.errors import FormatError
from scaffold_cad.io import RawSkeleton, read_raw, read_triangles
from scaffold_cad.io.reading import with_repairs
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.mesh.welding import welded
from scaffold_cad.printability.triangletopology import TriangleTopology
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.repair import least_radius

THIN = 1e-6
"""Least radius in place of those that a file does not have, mm."""


class Row(NamedTuple):
    """What is told of a file under one name."""

    text: str
    value: Any
    """The same as JSON holds it, lengths in mm."""


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser("info", parents=[common], help="count what a file holds")
    source.add_input(parser, several=True)
    source.add_units(parser)
    source.add_max_nodes(parser)
    source.add_strict(parser)
    parser.add_argument("--json", action="store_true", help="print a line of JSON for each file")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print the counts of the skeleton as it is built, or of the solid, one per line."""
    try:
        raw = read_raw(options.input, source.max_nodes(options))
    except FormatError as error:
        solid = _solid(options)
        if solid is None:
            raise error from None
        rows = _solid_counts(solid)
    else:
        rows = _skeleton_rows(options, raw)
    if options.json:
        values = {name.replace(" ", "_"): row.value for name, row in rows.items()}
        print(json.dumps({"name": Path(options.input).name} | values, allow_nan=False))
        return
    width = max(len(name) for name in rows)
    for name, row in rows.items():
        print(f"{name:<{width}}  {row.text}")


def _skeleton_rows(options: argparse.Namespace, raw: RawSkeleton) -> dict[str, Row]:
    """Return what is told of a file with a skeleton, in order."""
    has_radii = raw.has_radii
    radius = None if has_radii else _thin
    told = replace(raw, left_out=(), flat_ends=0)  # in a row of its own
    if options.strict:
        cleaning = source.read_whole(options, replace(raw, flat_ends=0), radius)
    else:
        cleaning = with_repairs(
            options.input, told, radius, units=options.units, scale=options.scale
        )
    skeleton, repairs = cleaning.skeleton, cleaning.repairs
    rows = _counts(skeleton)
    rows["radius"] = (
        _range(skeleton.radii) if has_radii else Row("none in the file: build needs --radius", None)
    )
    if skeleton.has_member_radii:
        rows["strut radius"] = _range(skeleton.edge_radii)
    rows["repairs"] = Row(str(repairs), {k: n for k, n in asdict(repairs).items() if n})
    if raw.beyond_skeleton:
        rows["beside it"] = Row(", ".join(raw.beyond_skeleton), list(raw.beyond_skeleton))
    return rows


def _thin(nodes: Points) -> Floats:
    """Return radii (n,) that nothing is thick beside, and that rounding does not hide.

    They are not shown.
    """
    placed = nodes[np.isfinite(nodes).all(axis=1)]
    return np.full(len(nodes), max(THIN, 2 * least_radius(placed)))


def _solid(options: argparse.Namespace) -> TriangleMesh | None:
    """Return the triangles of a file without a skeleton, or None where it has none."""
    try:
        return read_triangles(options.input, units=options.units, scale=options.scale)
    except FormatError:
        return None


def _solid_counts(solid: TriangleMesh) -> dict[str, Row]:
    """Return what is told of a solid, in order."""
    mesh = welded(solid)
    surface = TriangleTopology(mesh)
    volume = f"{mesh.signed_volume:.6g} mm³"
    if not surface.closed:
        volume += ", of a surface that is open"
    return {
        "skeleton": Row("none: a solid, see scaffold-cad check", None),
        "triangles": _count(len(mesh.triangles)),
        "vertices": _count(len(mesh.vertices)),
        "shells": _count(surface.shell_count),
        "open edges": _count(len(surface.open_edges)),
        "volume": Row(volume, mesh.signed_volume),
        "size": _size(mesh.vertices),
    }


def _counts(skeleton: Skeleton) -> dict[str, Row]:
    """Return what is told of a skeleton, in order."""
    kinds = np.bincount(skeleton.valency[skeleton.branch_points])
    by_valency = {n: count for n, count in enumerate(kinds.tolist()) if count}
    kinds_text = ", ".join(f"{count} of valency {n}" for n, count in by_valency.items())
    branches = len(skeleton.branch_points)
    return {
        "nodes": _count(len(skeleton.nodes)),
        "edges": _count(len(skeleton.edges)),
        "components": _count(skeleton.component_count),
        "loops": _count(skeleton.loop_count),
        "branch points": Row(f"{branches} ({kinds_text})" if branches else "0", by_valency),
        "joints": _count(len(skeleton.joints)),
        "extremities": _count(len(skeleton.extremities)),
        "edge length": _range(skeleton.lengths),
        "size": _size(skeleton.nodes),
    }


def _count(count: int) -> Row:
    return Row(str(count), count)


def _range(values: Floats) -> Row:
    return Row(range_text(values), [float(values.min()), float(values.max())])


def _size(points: Points) -> Row:
    return Row(size_text(points), np.ptp(points, axis=0).tolist() if len(points) else [0.0] * 3)
