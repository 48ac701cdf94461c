"""`scaffold-cad build`: a file with a skeleton becomes a scaffold, a solid or a frame."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.brep import BREP_SUFFIXES
from scaffold_cad.cli import source
from scaffold_cad.cli.progress import FILE_RATE, SCAFFOLD_RATE, SMOOTH_RATE, SOLID_RATE, Progress
from scaffold_cad.errors import OptionError
from scaffold_cad.io.write import check_writable, write
from scaffold_cad.products.assembly import Assembly, assembly_solid
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.overlaps import log_overlaps
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.stars import Fit, Section
from scaffold_cad.smooth import Caps, crossing_struts, fine_surface, smooth_patches
from scaffold_cad.solid import solidified
from scaffold_cad.solid.roundstruts import ROUND_SIDES
from scaffold_cad.solid.thicken import frame_scaffold

if TYPE_CHECKING:
    from manifold3d import Manifold

    from scaffold_cad.skeleton import Skeleton

PRODUCTS = ("scaffold", "frame", "shell")

FINE_SUFFIXES = (".stl", ".ply")
"""Suffixes of the formats that hold fine surfaces."""

LEVELS = 2
"""Subdivisions of a smooth mesh when none are given, and the most of struts that are united."""

SCAFFOLD_OPTIONS = ("strut_radius", "fit", "section", "collars")
"""What `add_scaffold_arguments` adds."""

FRAME_RADIUS = 0.15
"""Radius of a frame's struts when none is given, as a fraction of the median node radius."""

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "build", parents=[common], help="build a solid, a shell or a frame from a skeleton"
    )
    source.add_arguments(parser)
    parser.add_argument(
        "-o",
        "--output",
        required=True,
        type=Path,
        metavar="OUT",
        help="file to write: .step .brep .stl .3mf .obj .ply .glb",
    )
    parser.add_argument(
        "--as",
        dest="product",
        choices=PRODUCTS,
        default="scaffold",
        help="the solid inside the scaffold, the scaffold's edges as struts, or its bare quads",
    )
    add_scaffold_arguments(parser)
    parser.add_argument(
        "--smooth",
        action="store_true",
        help="round struts and smooth nodes: G1 patches in CAD formats, in others meshes whose "
        f"struts have {ROUND_SIDES} sides",
    )
    parser.add_argument(
        "--levels",
        type=int,
        choices=range(1, 9),
        metavar="N",
        help=f"subdivisions of a smooth mesh: struts get 4 * 2**N sides (default: {LEVELS}); from "
        "3 on for struts that do not overlap, in .stl and .ply files",
    )
    parser.add_argument(
        "--slabs",
        type=int,
        metavar="N",
        help="parts in which a mesh of 3 levels or more is made, for little memory",
    )
    parser.add_argument(
        "--caps",
        choices=get_args(Caps),
        help="how struts end in a smooth CAD solid or a mesh of 3 levels or more (default: round)",
    )
    parser.set_defaults(run=run)


def add_scaffold_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that `scaffold_from` and `frame_radius` read."""
    parser.add_argument(
        "--strut-radius",
        type=float,
        metavar="R",
        help=f"radius of a frame's struts, mm (default: {FRAME_RADIUS} of the median radius)",
    )
    parser.add_argument(
        "--fit",
        choices=get_args(Fit),
        help="how large branch points are: so that no strut is cut thin (default: enclose), or as "
        "in the paper",
    )
    parser.add_argument(
        "--section",
        choices=get_args(Section),
        help="which square section stands for a circle of the radius (default: circumscribed)",
    )
    parser.add_argument(
        "--collars",
        action="store_true",
        help="straight struts of constant section, as an engineer's: without it they widen from "
        "their middles to their nodes (an octet lattice of radius 0.4 mm in cells of 8 mm has "
        "1.25 times the volume of its cylinders, with it 1.11)",
    )


def run(options: argparse.Namespace) -> None:
    """Read, build and write."""
    check_writable(options.output, solid=True)
    _check_combination(options)
    progress = Progress()
    assembly = source.assembly_from(options) if _takes_assemblies(options) else None
    if assembly is not None:
        _build_assembly(assembly, options.output, progress)
        return
    skeleton = source.skeleton_from(options)
    with progress.stage("scaffold", len(skeleton.edges), "struts", SCAFFOLD_RATE):
        scaffold = scaffold_from(options, skeleton)
    if options.product == "frame":
        struts = 2 * len(scaffold.mesh.quads)
        with progress.stage("frame", struts, "struts", SCAFFOLD_RATE):
            scaffold = frame_scaffold(scaffold, frame_radius(options, skeleton))
    struts = len(scaffold.skeleton.edges)
    with progress.stage("solid", struts, "struts", SMOOTH_RATE if options.smooth else SOLID_RATE):
        product = _product(scaffold, options)
    with progress.stage("file", struts, "struts", FILE_RATE):
        write(product, options.output, slabs=options.slabs)
    _log.info("%s written", options.output)


def _takes_assemblies(options: argparse.Namespace) -> bool:
    """Return whether a solid is asked for that is not made by way of a scaffold."""
    given = [getattr(options, name) for name in SCAFFOLD_OPTIONS]
    cad = options.output.suffix.lower() in BREP_SUFFIXES
    return options.product == "scaffold" and not cad and not any(given) and not _is_fine(options)


def _build_assembly(assembly: Assembly, output: Path, progress: Progress) -> None:
    """Write the solid of beams and of what is beside them in a 3MF file."""
    beams = assembly.beam_count
    _log.info("%d beams are united with %s", beams, ", ".join(assembly.beyond_skeleton()))
    with progress.stage("solid", beams, "struts", SOLID_RATE):
        solid = assembly_solid(assembly)
    with progress.stage("file", beams, "struts", FILE_RATE):
        write(solid, output)
    _log.info("%s written", output)


def scaffold_from(options: argparse.Namespace, skeleton: Skeleton) -> Scaffold:
    """Return the scaffold that the arguments ask for."""
    given = {name: getattr(options, name) for name in ("fit", "section")}
    chosen = {name: value for name, value in given.items() if value is not None}
    return build_scaffold(skeleton, collars=options.collars, **chosen)


def frame_radius(options: argparse.Namespace, skeleton: Skeleton) -> float:
    """Return the radius of a frame's struts, mm."""
    if options.strut_radius is not None:
        return as_number(options.strut_radius, "--strut-radius")
    radius = FRAME_RADIUS * float(np.median(skeleton.radii))
    _log.info("the frame's struts have radius %.4g mm; --strut-radius sets another", radius)
    return radius


def _check_combination(options: argparse.Namespace) -> None:
    """Raise where an option would do nothing."""
    name, suffix = options.output.name, options.output.suffix.lower()
    cad = suffix in BREP_SUFFIXES
    if options.smooth and options.product == "shell":
        raise OptionError("--as shell is for the coarse quads; need it without --smooth")
    if options.levels is not None and (cad or not options.smooth):
        raise OptionError("--levels is for meshes of --smooth, not for CAD formats")
    if options.caps is not None and not options.smooth:
        raise OptionError("--caps is for --smooth")
    if options.caps == "flat" and not cad and not _is_fine(options):
        raise OptionError(
            "--caps flat is for CAD formats and --levels 3 or more; coarser meshes have domes"
        )
    if options.slabs is not None and not _is_fine(options):
        raise OptionError("--slabs is for meshes of --smooth with --levels 3 or more")
    if _is_fine(options) and suffix not in FINE_SUFFIXES:
        raise OptionError(
            f"{name} cannot hold {options.levels} levels; need {' or '.join(FINE_SUFFIXES)}, "
            "or --levels 2"
        )
    check_frame_options(options)


def check_frame_options(options: argparse.Namespace) -> None:
    """Raise where an option of frames is given for something else."""
    if options.product != "frame":
        why = "is for --as frame; --radius is that of the nodes"
        source.refuse(options, ["strut_radius"], why)


def _is_fine(options: argparse.Namespace) -> bool:
    """Return whether the mesh is finer than `solidified` makes it."""
    return options.levels is not None and options.levels > LEVELS


def _product(scaffold: Scaffold, options: argparse.Namespace) -> Any:
    """Return what to write; in a mesh format overlapping struts are united."""
    cad = options.output.suffix.lower() in BREP_SUFFIXES
    if options.smooth:
        return _smooth_product(scaffold, options, cad)
    left_out, shell = scaffold.embedding().left_out, options.product == "shell"
    if not (cad or shell):
        return united_solid(scaffold) if len(left_out) else scaffold
    log_overlaps(scaffold, left_out, united=False)
    if not shell:
        return scaffold
    return to_brep(scaffold.mesh, "shell") if cad else scaffold.mesh


def united_solid(scaffold: Scaffold, sides: int = 4) -> Manifold:
    """Return the solid of a scaffold; log which of its struts had to be united."""
    solid = solidified(scaffold, sides=sides)
    log_overlaps(scaffold, solid.united_edges, united=True, smooth=sides > 4)
    return solid.manifold


def _smooth_product(scaffold: Scaffold, options: argparse.Namespace, cad: bool) -> Any:
    """Return smooth patches for CAD, else a mesh."""
    caps: Caps = options.caps or "round"
    if cad:
        patches = smooth_patches(scaffold, caps=caps)
        log_overlaps(scaffold, crossing_struts(patches, scaffold), united=False)
        return patches
    if not _is_fine(options):
        sides = ROUND_SIDES if options.levels is None else 4 * 2**options.levels
        return united_solid(scaffold, sides)
    surface = fine_surface(scaffold, options.levels, caps)
    crossing = crossing_struts(surface, scaffold)
    if len(crossing):
        raise OptionError(
            f"{len(crossing)} struts overlap others, edge {crossing[0]} first: they can be united "
            f"with --levels 2 at most, not {options.levels} (or lower the radius)"
        )
    return surface
