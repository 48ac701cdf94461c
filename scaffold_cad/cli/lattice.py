"""`scaffold-cad lattice`: a box or a part filled with a lattice."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import Any

from scaffold_cad.base.arguments import as_number
from scaffold_cad.brep import BREP_SUFFIXES, read_brep
from scaffold_cad.cli import (
    borders,
    fields,
    foams,
    latticelayers,
    latticeradius,
    latticestruts,
    latticetiles,
    nets,
    processes,
    shapes,
    sizes,
    slicing,
    source,
    streams,
    tiled,
)
from scaffold_cad.cli.latticestruts import box_mesh
from scaffold_cad.cli.maps import add_maps, map_of
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.filling.fill import as_region
from scaffold_cad.filling.flush import flush_box, trimmed_box
from scaffold_cad.filling.hollowing import HollowPart, hollowed
from scaffold_cad.filling.models import maker, sided_maker
from scaffold_cad.filling.parts import filled_part
from scaffold_cad.filling.reaching import lattice_reaching, movable, skeleton_reaching
from scaffold_cad.filling.solids import HollowSolid, filled_solid, hollow_solid
from scaffold_cad.io.write import check_writable, write
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts, round_struts

LATTICE_SIDES = 8
"""Sides of round struts where none are given: few, for a lattice has thousands of struts."""

LENGTHS = ("skin", "drain", "wall", "shortest")
"""Options that are lengths > 0, mm, where they are given."""

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
    _add_cells(parser)
    _add_place(parser)
    _add_skin(parser)
    borders.add_arguments(parser)
    shapes.add_square_arguments(
        parser.add_argument_group("square struts"), "square struts of lattices always have collars"
    )
    shapes.add_round_arguments(parser)
    shapes.add_overlaps_argument(parser)
    processes.add_process(parser)
    parser.add_argument(
        "--beams",
        action="store_true",
        help="write the struts as beams, no solid: a 3MF beam lattice, or JSON",
    )
    streams.add_output(
        parser,
        "file to write: .3mf .stl .obj .ply .glb; .step .brep without --skin and --trim, or with "
        "--skin of a part from such a file",
    )
    slicing.add_layer_arguments(parser, required=False)
    latticetiles.add_arguments(parser)
    source.add_max_nodes(parser, "lattice")
    parser.set_defaults(run=run)


def _add_cells(parser: argparse.ArgumentParser) -> None:
    """Add what struts there are: cells or foams, and how thick."""
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--cell",
        type=nets.cell,
        metavar="NAME",
        help="unit cell; `scaffold-cad cells` lists them; or a net of a Systre file: nets.cgd, "
        "nets.cgd:NAME for one of several",
    )
    foams.add_arguments(what, parser)
    parser.add_argument(
        "--size",
        type=fields.size,
        metavar="A",
        help="size of a cell, mm: 8 or 8x8x12, or a file as for --radius",
    )
    thick = parser.add_mutually_exclusive_group(required=True)
    thick.add_argument(
        "--radius",
        type=fields.number,
        metavar="R",
        help=f"radius of the struts, mm: {fields.ABOUT}",
    )
    thick.add_argument(
        "--density",
        type=float,
        metavar="P",
        help="relative density of the lattice instead, 0 to 1, measured on its solid",
    )


def _add_place(parser: argparse.ArgumentParser) -> None:
    """Add where the struts are: in a box, in a part, or on a face."""
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument(
        "--box",
        type=sizes.box,
        metavar="XxYxZ",
        help="size of a box with a corner at the origin, mm: 40x40x20, or 40 for a cube",
    )
    where.add_argument(
        "--inside", type=Path, metavar="PART", help="closed part: .step .brep .stl .3mf .obj .ply"
    )
    add_maps(where, parser)
    parser.add_argument(
        "--trim",
        action="store_true",
        help="cut struts flush with the box or the part: a box measures as asked",
    )


def _add_skin(parser: argparse.ArgumentParser) -> None:
    """Add the wall around the struts and its holes."""
    parser.add_argument(
        "--skin", type=float, metavar="T", help="thickness of a closed wall around it, mm"
    )
    parser.add_argument(
        "--drain",
        type=float,
        metavar="D",
        help="diameter of holes through the skin, mm, two for each void: powder or resin gets out",
    )


def run(options: argparse.Namespace) -> None:
    """Fill, build and write: all that needs no radius is checked before one is searched."""
    foams.check(options)
    borders.check(options)
    for name in LENGTHS:
        if getattr(options, name) is not None:
            as_number(getattr(options, name), source.flag_of(name))
    _check(options)
    _check_square(options)
    part = latticestruts.part_of(options)
    body = _hollow(part, options)
    if options.density is not None:  # it takes seconds
        options.radius = latticeradius.radius(options)
    if options.tiles is not None:
        latticetiles.run(options, LATTICE_SIDES)
        return
    if options.layer is not None:
        _write_layers(part, options)
        return
    progress = Progress()
    product = _product(part, body, options, progress)
    made = isinstance(product, Scaffold | RoundStruts)
    with progress.stage("file", *_amount(product)):
        write(product, options.output, **(_written_with(options) if made else {}))
    _log.info("%s written", options.output)


def _write_layers(part: TriangleMesh | None, options: argparse.Namespace) -> None:
    """Write layers, of which no mesh is made."""
    flush = options.trim or options.skin is not None
    if latticelayers.made_whole(options):
        region = box_mesh(options.box) if flush and part is None else part
        if options.foam is not None and region is not None:
            foam = latticestruts.foam_around(part, options)
            skeleton = skeleton_reaching(as_region(region), foam, options.skin)(0.0)
        else:
            skeleton = latticestruts.skeleton(part, options)
        processes.check_struts(options, skeleton)
        latticelayers.write(options, skeleton, region)
    elif part is not None:
        latticelayers.write(options, part)
    elif flush or not latticelayers.fills(options.box, options):
        latticelayers.write(options, box_mesh(options.box))
    else:
        latticelayers.write(options, options.box)


def _amount(product: Any) -> tuple[int, str]:
    """Return how much is written, and of what."""
    skeleton = getattr(product, "skeleton", product)
    if isinstance(skeleton, Skeleton):
        return len(skeleton.edges), "struts"
    if hasattr(product, "num_tri"):
        return product.num_tri(), "triangles"
    return len(product.faces()), "faces"


def _written_with(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for `write`."""
    given = shapes.written_with(options)
    if options.round and options.output.suffix.lower() not in BREP_SUFFIXES:
        given.setdefault("sides", LATTICE_SIDES)
    return given


def _check(options: argparse.Namespace) -> None:
    """Raise where an option is out of its range, would do nothing, or makes what cannot be."""
    if options.density is not None:
        latticeradius.check(options)
    if options.tiles is not None:
        latticetiles.check(options)
        return
    tiled.refuse(options)
    if options.layer is not None:
        latticelayers.check(options)
        _check_bodies(options)
        return
    source.refuse(options, ["pixel", "text"], "is for layers; need --layer")
    check_writable(options.output, solid=not options.beams, skeleton=options.beams)
    _check_combination(options)


def _check_square(options: argparse.Namespace) -> None:
    """Raise where an option of square struts is given for others, or for those of a body."""
    others = ("round", "skin", "trim", "beams", "layer", "tiles", "density")
    if any(getattr(options, name) not in (None, False) for name in others):
        flags = ", ".join(map(source.flag_of, others))
        source.refuse(
            options, shapes.SQUARE_OPTIONS, f"is for square struts alone; need no {flags}"
        )


def _check_combination(options: argparse.Namespace) -> None:
    """Raise where an option would do nothing, or the format cannot hold what is asked."""
    shapes.check_round_options(options)
    suffix = options.output.suffix.lower()
    _check_bodies(options)
    if options.trim and (options.skin is not None or options.beams):
        raise OptionError("--trim is for struts without a skin; need it without --skin and --beams")
    merged = options.skin is not None or options.trim or options.beams
    if suffix in BREP_SUFFIXES and merged and not _is_filled_solid(options):
        raise FormatError(
            f"cannot write {options.output}: STEP and BREP files hold struts without --skin, "
            "--trim and --beams, and parts of STEP and BREP files with --skin; need one of these, "
            "or a mesh format"
        )
    if _is_filled_solid(options):
        if options.overlaps == "allow":
            raise OptionError("--overlaps is allow with --skin; need refuse or unite")
    elif options.beams or options.trim or options.skin is not None:
        why = "is for struts alone, and under a skin in STEP files; need no --beams, --trim or mesh"
        source.refuse(options, ["overlaps"], why)
    if not options.beams:
        return
    if options.round or options.skin is not None:
        raise OptionError("--beams writes the struts as lines; need it without --round and --skin")


def _check_bodies(options: argparse.Namespace) -> None:
    """Raise where an option of boxes or parts is given without them."""
    if options.trim and options.box is None and options.inside is None:
        raise OptionError("--trim cuts struts flush with a box or a part; need --box or --inside")
    if options.skin is not None and options.box is None and options.inside is None:
        raise OptionError("--skin is the wall of a box or a part; need --box or --inside")
    if options.drain is not None and (options.skin is None or options.layer is not None):
        raise OptionError("--drain is for holes in the skin of a mesh; need --skin, no --layer")
    if options.periodic and (options.trim or options.skin is not None):
        raise OptionError("--periodic is for struts alone; need it without --trim and --skin")


def _is_filled_solid(options: argparse.Namespace) -> bool:
    """Return whether a part from a CAD file is filled for a CAD file."""
    return (
        options.inside is not None
        and options.inside.suffix.lower() in BREP_SUFFIXES
        and options.output.suffix.lower() in BREP_SUFFIXES
        and options.skin is not None
        and not options.beams
    )


def _hollow(
    part: TriangleMesh | None, options: argparse.Namespace
) -> HollowPart | HollowSolid | None:
    """Return the part or the box with its skin in which struts are cut, or a part without one.

    None stands for struts alone, and for those cut flush with a box.
    """
    if options.layer is None and options.foam is None and map_of(options) is None:
        latticestruts.check_cells(part, options)
    if options.layer is not None or (options.skin is None and (part is None or not options.trim)):
        return None
    if _is_filled_solid(options):
        source.refuse(options, ["drain"], "is for mesh files; cut a hole into the STEP solid")
        return hollow_solid(read_brep(options.inside), options.skin)
    body = box_mesh(options.box) if part is None else part
    return hollowed(body, options.skin, drain=options.drain)


def _product(
    part: TriangleMesh | None,
    body: HollowPart | HollowSolid | None,
    options: argparse.Namespace,
    progress: Progress,
) -> Any:
    """Return what to write."""
    if body is None and not options.trim:
        skeleton = latticestruts.skeleton(part, options)
        processes.check_struts(options, skeleton)
        return skeleton if options.beams else _struts(skeleton, options, progress)
    if options.process is not None:
        processes.check_struts(options, latticestruts.skeleton(part, options))
    if options.foam is None:
        foam, amount = None, (latticestruts.check_cells(part, options), "cells")
    else:
        foam = latticestruts.foam_around(part, options)
        amount = len(foam.edges), "struts"
    with progress.stage("lattice", *amount):
        return _bodied(part, body, foam, options)


def _bodied(
    part: TriangleMesh | None,
    body: HollowPart | HollowSolid | None,
    foam: Skeleton | None,
    options: argparse.Namespace,
) -> Any:
    """Return struts that are cut flush with a box or a part, or are in one with a skin."""
    lattice = options.cell, options.size, options.radius
    given = shapes.round_options(options)
    sides = (options.sides or LATTICE_SIDES) if options.round else 4
    if foam is not None:
        if body is None:
            return trimmed_box(options.box, movable(foam), sided_maker(sides, **given), sides)
        struts = skeleton_reaching(as_region(body.surface), foam, options.skin)
    else:
        on = latticestruts.map_of_sizes(part, options)
        if body is None:
            return flush_box(options.box, *lattice, on=on, sides=sides, **given)
        struts = lattice_reaching(as_region(body.surface), *lattice, options.skin, on=on)
    if isinstance(body, HollowSolid):
        make = maker(section="round" if options.round else "square", **given)
        return filled_solid(body, struts, make, options.overlaps or "refuse").solid
    return filled_part(body, struts, sided_maker(sides, **given), sides=sides)


def _struts(
    skeleton: Skeleton, options: argparse.Namespace, progress: Progress
) -> Scaffold | RoundStruts:
    """Return the struts of the lattice, round or square."""
    struts = len(skeleton.edges)
    if options.round:
        with progress.stage("struts", struts, "struts"):
            return round_struts(skeleton, **shapes.round_options(options))
    with progress.stage("scaffold", struts, "struts"):
        return build_scaffold(skeleton, **{**shapes.scaffold_options(options), "collars": True})
