"""`scaffold-cad info`: what a file with a skeleton or a solid holds."""

from __future__ import annotations

import argparse
from dataclasses import replace

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


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser("info", parents=[common], help="count what a file holds")
    source.add_input(parser, several=True)
    source.add_units(parser)
    source.add_max_nodes(parser)
    source.add_strict(parser)
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
    width = max(len(name) for name in rows)
    for name, value in rows.items():
        print(f"{name:<{width}}  {value}")


def _skeleton_rows(options: argparse.Namespace, raw: RawSkeleton) -> dict[str, str]:
    """Return what is printed of a file with a skeleton, in order."""
    has_radii = raw.has_radii
    radius = None if has_radii else _thin
    told = replace(raw, left_out=(), flat_ends=0)  # in a row of its own
    if options.strict:
        cleaning = source.read_whole(options, replace(raw, flat_ends=0), radius)
    else:
        cleaning = with_repairs(
            options.input, told, radius, units=options.units, scale=options.scale
        )
    rows = _counts(cleaning.skeleton)
    rows["radius"] = (
        range_text(cleaning.skeleton.radii)
        if has_radii
        else "none in the file: build needs --radius"
    )
    if cleaning.skeleton.has_member_radii:
        rows["strut radius"] = range_text(cleaning.skeleton.edge_radii)
    rows["repairs"] = str(cleaning.repairs)
    if raw.beyond_skeleton:
        rows["beside it"] = ", ".join(raw.beyond_skeleton)
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


def _solid_counts(solid: TriangleMesh) -> dict[str, str]:
    """Return what is printed of a solid, in order."""
    mesh = welded(solid)
    surface = TriangleTopology(mesh)
    volume = f"{mesh.signed_volume:.6g} mm³"
    return {
        "skeleton": "none: a solid, see scaffold-cad check",
        "triangles": str(len(mesh.triangles)),
        "vertices": str(len(mesh.vertices)),
        "shells": str(surface.shell_count),
        "open edges": str(len(surface.open_edges)),
        "volume": volume if surface.closed else f"{volume}, of a surface that is open",
        "size": size_text(mesh.vertices),
    }


def _counts(skeleton: Skeleton) -> dict[str, str]:
    """Return what is printed of a skeleton, in order."""
    kinds = np.bincount(skeleton.valency[skeleton.branch_points])
    by_valency = [f"{count} of valency {n}" for n, count in enumerate(kinds.tolist()) if count]
    return {
        "nodes": str(len(skeleton.nodes)),
        "edges": str(len(skeleton.edges)),
        "components": str(skeleton.component_count),
        "loops": str(skeleton.loop_count),
        "branch points": f"{len(skeleton.branch_points)}"
        + (f" ({', '.join(by_valency)})" if by_valency else ""),
        "joints": str(len(skeleton.joints)),
        "extremities": str(len(skeleton.extremities)),
        "edge length": range_text(skeleton.lengths),
        "size": size_text(skeleton.nodes),
    }
