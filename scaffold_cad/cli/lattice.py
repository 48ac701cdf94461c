"""`scaffold-cad lattice`: a box or a part filled with a lattice."""

from __future__ import annotations

import argparse
import logging
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.brep import BREP_SUFFIXES, read_brep
from scaffold_cad.cli import (
    build,
    latticelayers,
    latticetiles,
    sizes,
    slicing,
    source,
    streams,
    tiled,
)
from scaffold_cad.cli.maps import add_maps, map_of
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.filling import fill
from scaffold_cad.filling.fill import cells_around
from scaffold_cad.filling.parts import flush_box
from scaffold_cad.io import BYTES_PER_EDGE, read_triangles
from scaffold_cad.io.write import check_writable, write
from scaffold_cad.lattice import CellMap, UnitCell, lattice_on
from scaffold_cad.lattice.maps.cellmap import extents
from scaffold_cad.lattice.registry import unit_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.parts import lattice_part, lattice_solid
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.struts import RoundStruts, round_struts

if TYPE_CHECKING:
    from scaffold_cad.skeleton import Skeleton

BOX_QUADS = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
"""Faces of a box whose corners are numbered by x, y and z, x fastest."""

BEAM_SUFFIXES = (".3mf", ".json", ".obj", ".swc")
"""Suffixes of the formats that hold struts as lines."""

LATTICE_SIDES = 8
"""Sides of round struts where none are given: few, for a lattice has thousands of struts."""

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "lattice",
        parents=[common],
        help="fill a box or a part with a lattice, or put one on a face",
        description="Struts are straight and of constant section between their nodes' blends, as "
        "those of `build --collars`.",
    )
    parser.add_argument("--cell", required=True, help="unit cell; `scaffold-cad cells` lists them")
    parser.add_argument(
        "--size",
        required=True,
        type=sizes.size,
        metavar="A",
        help="size of a cell, mm: 8 or 8x8x12",
    )
    parser.add_argument(
        "--radius", required=True, type=float, metavar="R", help="radius of the struts, mm"
    )
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument(
        "--box",
        type=sizes.box,
        metavar="XxYxZ",
        help="size of a box from 0, mm: 40x40x20, or 40 for a cube",
    )
    where.add_argument(
        "--inside", type=Path, metavar="PART", help="closed part: .step .brep .stl .3mf .obj .ply"
    )
    add_maps(where, parser)
    parser.add_argument(
        "--trim", action="store_true", help="cut struts flush with the box: it measures as asked"
    )
    parser.add_argument(
        "--skin", type=float, metavar="T", help="thickness of a closed wall around it, mm"
    )
    build.add_round_arguments(parser)
    build.add_overlaps_argument(parser)
    parser.add_argument(
        "--beams",
        action="store_true",
        help="write no solid but the struts: a 3MF beam lattice, or JSON",
    )
    streams.add_output(
        parser,
        "file to write: .3mf .stl .obj .ply .glb; .step .brep of a box without --skin, or "
        "with it of a part from such a file",
    )
    slicing.add_layer_arguments(parser, required=False)
    latticetiles.add_arguments(parser)
    source.add_max_nodes(parser, "lattice")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Fill, build and write."""
    if options.tiles is not None:
        latticetiles.run(options, LATTICE_SIDES)
        return
    tiled.refuse(options)
    if options.layer is not None:
        _write_layers(options)
        return
    source.refuse(options, ["pixel", "text"], "is for layers; need --layer")
    check_writable(options.output, solid=not options.beams)
    _check_combination(options)
    product = _product(options, Progress())
    made = isinstance(product, Scaffold | RoundStruts)
    write(product, options.output, **(_written_with(options) if made else {}))
    _log.info("%s written", options.output)


def _write_layers(options: argparse.Namespace) -> None:
    """Write layers, of which no mesh is made."""
    latticelayers.check(options)
    mapping = map_of(options)
    if mapping is not None:
        _check_bodies(options)
        latticelayers.write(options, _on_map(mapping, options))
    elif options.inside is not None:
        _check_bodies(options)
        latticelayers.write(options, _body(options.inside))
    elif options.trim or options.skin is not None or not latticelayers.fills(options.box, options):
        latticelayers.write(options, _box_mesh(options.box))
    else:
        latticelayers.write(options, options.box)


def _written_with(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for `write`."""
    given = build.written_with(options)
    if options.round and options.output.suffix.lower() not in BREP_SUFFIXES:
        given.setdefault("sides", LATTICE_SIDES)
    return given


def _check_combination(options: argparse.Namespace) -> None:
    """Raise where an option would do nothing, or the format cannot hold what is asked."""
    build.check_round_options(options)
    suffix = options.output.suffix.lower()
    _check_bodies(options)
    if options.trim and (options.skin is not None or options.beams):
        raise OptionError("--trim is for struts without a skin; need it without --skin and --beams")
    bodied = options.inside is not None or options.skin is not None or options.trim
    if suffix in BREP_SUFFIXES and (bodied or options.beams) and not _is_filled_solid(options):
        raise FormatError(
            f"cannot write {options.output}: STEP and BREP files hold lattices of a box without "
            "--skin, --trim or --beams, and parts of STEP and BREP files with --skin; need one of "
            "these, or a mesh format"
        )
    if not options.beams:
        return
    if options.round or options.skin is not None:
        raise OptionError("--beams writes the struts as lines; need it without --round and --skin")
    if suffix not in BEAM_SUFFIXES:
        raise FormatError(f"cannot write {options.output}: --beams need {', '.join(BEAM_SUFFIXES)}")


def _check_bodies(options: argparse.Namespace) -> None:
    """Raise where an option of boxes or parts is given without them."""
    if options.trim and options.box is None:
        raise OptionError("--trim cuts struts flush with a box; need --box")
    if options.skin is not None and options.box is None and options.inside is None:
        raise OptionError("--skin is the wall of a box or a part; need --box or --inside")


def _is_filled_solid(options: argparse.Namespace) -> bool:
    """Return whether a part from a CAD file is filled for a CAD file."""
    return (
        options.inside is not None
        and options.inside.suffix.lower() in BREP_SUFFIXES
        and options.output.suffix.lower() in BREP_SUFFIXES
        and options.skin is not None
        and not options.beams
    )


def _product(options: argparse.Namespace, progress: Progress) -> Any:
    """Return what to write."""
    bodied = options.inside is not None or options.skin is not None
    mapping = map_of(options)
    if mapping is not None:
        skeleton = _on_map(mapping, options)
        return skeleton if options.beams else _struts(skeleton, options, progress)
    part = None if options.inside is None else _body(options.inside)
    cells = _cell_count(options.box if part is None else part.vertices, options)
    if _is_filled_solid(options):
        with progress.stage("lattice", cells, "cells"):
            return lattice_solid(
                read_brep(options.inside),
                options.cell,
                options.size,
                options.radius,
                skin=options.skin,
                section="round" if options.round else "square",
                **build.round_options(options),
            )
    sides = (options.sides or LATTICE_SIDES) if options.round else 4
    given = build.round_options(options)
    if options.trim:
        with progress.stage("lattice", cells, "cells"):
            return flush_box(
                options.box, options.cell, options.size, options.radius, sides=sides, **given
            )
    if options.beams or not bodied:
        skeleton = fill(
            options.box if part is None else part, options.cell, options.size, options.radius
        )
        _log.info("%d struts", len(skeleton.edges))
        return skeleton if options.beams else _struts(skeleton, options, progress)
    body = _box_mesh(options.box) if part is None else part
    with progress.stage("lattice", cells, "cells"):
        return lattice_part(
            body,
            options.cell,
            options.size,
            options.radius,
            skin=options.skin,
            sides=sides,
            **given,
        )


def _cell_count(corners: Points, options: argparse.Namespace) -> int:
    """Return how many cells the box around points (n, 3) meets; refuse what memory may not hold."""
    cell = unit_cell(options.cell)
    bounds = np.stack([corners.min(axis=0), corners.max(axis=0)])
    counts, _ = cells_around(bounds, cell, cell_size(cell, options.size))
    return _allowed(math.prod(counts), cell, options)


def _on_map(mapping: CellMap, options: argparse.Namespace) -> Skeleton:
    """Return the lattice on a map; refuse what memory may not hold."""
    cell = unit_cell(options.cell)
    sizes_of_cell = cell_size(cell, options.size)
    _allowed(mapping.patches * int(np.prod(extents(mapping) / sizes_of_cell)), cell, options)
    lattice = lattice_on(mapping, cell, radius=options.radius, size=options.size)
    _log.info(
        "%d struts, %.3g to %.3g times as long as in a cell of the mean size",
        len(lattice.skeleton.edges),
        lattice.least_stretch,
        lattice.largest_stretch,
    )
    return lattice.skeleton


def _allowed(cells: int, cell: UnitCell, options: argparse.Namespace) -> int:
    """Return a number of cells; refuse what memory may not hold."""
    most = source.max_nodes(options)
    nodes, struts = cells * cell.site_count, cells * cell.strut_count
    if nodes > most:
        raise OptionError(
            f"{cells} cells have some {nodes} nodes and {struts} struts; need at most {most} "
            f"nodes: to build them takes about {struts * BYTES_PER_EDGE / 1e9:.3g} GB of memory, "
            "and --max-nodes allows it"
        )
    return cells


def _struts(
    skeleton: Skeleton, options: argparse.Namespace, progress: Progress
) -> Scaffold | RoundStruts:
    """Return the struts of the lattice, round or square."""
    struts = len(skeleton.edges)
    if options.round:
        with progress.stage("struts", struts, "struts"):
            return round_struts(skeleton, **build.round_options(options))
    with progress.stage("scaffold", struts, "struts"):
        return build_scaffold(skeleton, collars=True)


def _body(path: Path) -> TriangleMesh:
    """Return the triangles of the part in a file."""
    mesh = read_triangles(path)
    if mesh is None:
        raise FormatError(f"{path} holds no closed part; need .step, .brep, .stl, .3mf, .obj, .ply")
    return mesh


def _box_mesh(box: Floats) -> TriangleMesh:
    corners = np.stack(np.meshgrid(*box.T[::-1], indexing="ij"), axis=-1).reshape(-1, 3)[:, ::-1]
    mesh = QuadMesh(corners, BOX_QUADS)
    return TriangleMesh(mesh.vertices, mesh.triangles)
