"""`scaffold-cad check`: whether a part can be printed, what is in the way, and where."""

from __future__ import annotations

import argparse
import json
import logging
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.files import check_page
from scaffold_cad.cli import shapes, sizes, source, tiled
from scaffold_cad.cli.flags import with_ways
from scaffold_cad.cli.progress import Progress
from scaffold_cad.cli.source import flag_of
from scaffold_cad.errors import OptionError
from scaffold_cad.io import read_triangles
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.printability import MATERIALS, PROCESSES, check_printability
from scaffold_cad.printability.page import write_page
from scaffold_cad.printability.processes import Process
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import SIDES
from scaffold_cad.struts import RoundStruts

NOT_PRINTABLE = 1

PRODUCTS = ("scaffold", "frame")

REPORT = "report.json"
"""File of the report beside the tiles'."""

LIMITS = {
    "least_diameter": ("--min-diameter", "MM", "thinnest strut or wall"),
    "least_gap": ("--min-gap", "MM", "narrowest gap between struts"),
    "greatest_slenderness": ("--max-slenderness", "N", "length of a strut over its diameter"),
    "longest_bridge": ("--max-bridge", "MM", "longest level strut without support"),
    "least_opening": ("--min-opening", "MM", "narrowest hole that powder or resin leaves through"),
    "layer": ("--layer", "MM", "height of a layer"),
}
"""Option, unit and meaning of the limits of a process that are plain numbers."""

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "check",
        parents=[common],
        help="check whether a mesh file, or the solid of a skeleton, can be printed",
        description="Exit code 0: printable; 1: not printable; 2: bad input. INPUT is a mesh "
        "(STL, 3MF, OBJ, PLY), a CAD part (STEP, BREP) or a skeleton, which is built; so is the "
        "beam lattice of a 3MF file.",
    )
    source.add_arguments(parser)
    parser.add_argument(
        "--skeleton", type=Path, metavar="FILE", help="skeleton of the struts of a mesh file"
    )
    parser.add_argument(
        "--process", choices=PROCESSES, default="sls", help="printing process (default: sls)"
    )
    parser.add_argument("--material", choices=MATERIALS, help="material, for the mass of the part")
    parser.add_argument(
        "--direction",
        type=_direction,
        default=(0.0, 0.0, 1.0),
        metavar="X,Y,Z",
        help='build direction, such as -1,0,0, or "best" (default: 0,0,1)',
    )
    parser.add_argument(
        "--no-supports", action="store_true", help="faces that need supports are failures"
    )
    limits = parser.add_argument_group("limits, instead of those of the process")
    for name, (option, unit, meaning) in LIMITS.items():
        limits.add_argument(option, dest=name, type=float, metavar=unit, help=meaning)
    limits.add_argument(
        "--overhang",
        type=float,
        metavar="DEG",
        help="angle to the plate, degrees, below which faces need supports",
    )
    limits.add_argument(
        "--build-volume",
        type=sizes.three_sizes,
        metavar="XxYxZ",
        help="size of the build volume, mm: 250x210x210, or 200 for a cube",
    )
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    parser.add_argument(
        "--html", type=Path, metavar="PAGE", help="write a page that shows the failing places"
    )
    parser.add_argument(
        "--as",
        dest="product",
        choices=PRODUCTS,
        help="which solid of a skeleton, as `build` makes it: the one inside its scaffold "
        "(default), or the scaffold's edges as struts",
    )
    shapes.add_arguments(parser)
    tiled.add_arguments(parser, of="a report of the struts alone")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the report and return 0 if the part is printable, else 1."""
    if options.tiles is not None:
        return _check_tiles(options)
    tiled.refuse(options)
    shapes.check(options)
    if options.html is not None:
        check_page(options.html)
    part, skeleton = _part(options)
    report = check_printability(
        part,
        _process(options),
        skeleton=skeleton,
        sides=options.sides if isinstance(part, RoundStruts) else None,
        direction=options.direction,
        material=options.material,
        supports=not options.no_supports,
        name=Path(options.input).name,
    )
    print(report.to_json() if options.json else with_ways(str(report)))
    if options.html is not None:
        write_page(report, options.html)
        _log.info("%s written", options.html)
    return 0 if report.printable else NOT_PRINTABLE


def _part(
    options: argparse.Namespace,
) -> tuple[TriangleMesh | Scaffold | RoundStruts, Skeleton | None]:
    """Return what is looked at, and the struts that are in it where it does not know them."""
    given, why = (*shapes.OPTIONS, "product"), "is for skeletons; a mesh is looked at as it is"
    if options.skeleton is not None:
        source.refuse(options, given, why)
        mesh = read_triangles(options.input, units=options.units, scale=options.scale)
        if mesh is None:
            raise OptionError("--skeleton is for mesh files; the input is a skeleton itself")
        return mesh, source.skeleton_from(options, options.skeleton)
    made = shapes.is_given(options)
    assembly = source.assembly_from(options, ends=not made and options.product != "frame")
    if assembly is not None:
        if options.product == "frame":
            source.refuse_beside(options.input, assembly.beside_beams(), "--as frame")
        make = shapes.maker(options) if made else None
        solid = source.united(assembly, options, make, options.sides or SIDES)
        return solid, assembly.whole_beams()
    mesh = source.triangles_from(options, (), "is for skeletons; need --skeleton beside a mesh")
    if mesh is not None:
        source.refuse(options, given, why)
        return mesh, None
    progress = Progress()
    skeleton = shapes.frame(options, source.skeleton_from(options), progress)
    return shapes.struts(options, skeleton, progress), None


def _check_tiles(options: argparse.Namespace) -> int:
    """Print what a process asks of the struts as JSON, looked at tile by tile."""
    others = ("build_volume", "overhang", "skeleton", "material", "no_supports", "html", "product")
    names = [*LIMITS, *others, *shapes.OPTIONS]
    flags = {name: option for name, (option, _, _) in LIMITS.items()}
    for name in names:
        if getattr(options, name) not in (None, False):
            raise OptionError(f"{flags.get(name, flag_of(name))} is not for a report by --tiles")
    source.check_beams_alone(options, "--tiles")
    skeleton = source.skeleton_from(options)
    parts = tiled.cut(skeleton, options)
    from scaffold_cad.tiles import Check

    report = tiled.make(parts, Check(process=options.process), options, REPORT)
    text = report.read_text("utf-8")
    print(text, end="")
    return 0 if json.loads(text)["printable"] else NOT_PRINTABLE


def _process(options: argparse.Namespace) -> Process:
    """Return the process asked for, with the limits asked for."""
    changes: dict[str, Any] = {name: getattr(options, name) for name in [*LIMITS, "build_volume"]}
    for name, (option, unit, _) in LIMITS.items():
        if changes[name] is not None:
            as_number(changes[name], option, unit=" mm" if unit == "MM" else "", or_zero=True)
    if options.overhang is not None:
        if as_number(options.overhang, "--overhang", unit="°", or_zero=True) > 90:
            raise OptionError(f"--overhang is {options.overhang:g}°; need 90 or less")
        changes["overhang_angle"] = math.radians(options.overhang)
    given = {name: value for name, value in changes.items() if value is not None}
    return replace(PROCESSES[options.process], **given)


def _direction(text: str) -> Any:
    return "best" if text.lower() == "best" else sizes.direction(text)
