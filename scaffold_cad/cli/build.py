"""`scaffold-cad build`: a file with a skeleton becomes a solid, a frame or hexahedra."""

from __future__ import annotations

import argparse
import logging
from typing import TYPE_CHECKING, Any

from scaffold_cad.brep import BREP_SUFFIXES
from scaffold_cad.cli import assemblies, hexahedra, processes, shapes, source, streams, tiled
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import OptionError
from scaffold_cad.io.write import check_writable, write
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.scaffold.stars import APOTHEM
from scaffold_cad.solid.rounds import SIDES

if TYPE_CHECKING:
    from scaffold_cad.skeleton import Skeleton

PRODUCTS = ("scaffold", "frame", "shell", "hexahedra")

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "build", parents=[common], help="build a solid, a shell or a frame from a skeleton"
    )
    source.add_arguments(parser, several=True)
    streams.add_output(parser, "file to write: .step .brep .stl .3mf .obj .ply .glb")
    parser.add_argument(
        "--as",
        dest="product",
        choices=PRODUCTS,
        default="scaffold",
        help="the solid inside the scaffold, the scaffold's edges as struts, its bare quads, or "
        "hexahedra for finite elements: .inp .bdf .msh .vtu",
    )
    shapes.add_overlaps_argument(parser)
    processes.add_process(parser)
    shapes.add_arguments(parser)
    hexahedra.add_arguments(parser)
    tiled.add_arguments(parser, of="an .stl file", jobs="tiles, or on files")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Read, build and write."""
    if options.product == "hexahedra":
        hexahedra.check(options)
    else:
        hexahedra.refuse(options)
        check_writable(options.output, solid=True)
    _check_combination(options)
    if options.tiles is not None:
        _build_tiles(options)
        return
    progress = Progress()
    if _build_assembly(options, progress):
        return
    skeleton = shapes.frame(options, source.skeleton_from(options), progress)
    _check_process(options, skeleton)
    product: Any = shapes.struts(options, skeleton, progress)
    if options.product == "shell":
        cad = options.output.suffix.lower() in BREP_SUFFIXES
        overlaps: Overlaps = options.overlaps or "allow"
        product = to_brep(product, "shell", overlaps=overlaps) if cad else product.mesh
    if options.product == "hexahedra":
        hexahedra.write(product, options, progress)
        return
    keywords = {} if options.product == "shell" else shapes.written_with(options)
    with progress.stage("file", len(skeleton.edges), "struts"):
        write(product, options.output, **keywords)
    _log.info("%s written", options.output)


def _build_tiles(options: argparse.Namespace) -> None:
    """Write the solid tile by tile."""
    tiled.check_stl(options)
    source.check_beams_alone(options, "--tiles")
    skeleton = source.skeleton_from(options)
    _check_process(options, skeleton)
    given = shapes.round_options(options), shapes.scaffold_options(options)
    work = tiled.surface_work(options, *given, options.sides or SIDES)
    tiled.make(tiled.cut(skeleton, options), work, options)


def _check_process(options: argparse.Namespace, skeleton: Skeleton) -> None:
    """Raise if struts of the section that is asked for cannot be printed."""
    square = not options.round and options.product != "frame"
    apothem = APOTHEM[options.section or "circumscribed"] if square else 1.0
    processes.check_struts(options, skeleton, apothem)


def _build_assembly(options: argparse.Namespace, progress: Progress) -> bool:
    """Write beams with what is beside them in the file, if there is anything; return whether."""
    cad = options.output.suffix.lower() in BREP_SUFFIXES
    made = cad or shapes.is_given(options) or options.overlaps is not None
    assembly = source.assembly_from(options, ends=not made and options.product == "scaffold")
    if assembly is None:
        return False
    if options.product != "scaffold":
        source.refuse_beside(options.input, assembly.beside_beams(), f"--as {options.product}")
    if options.socket and len(assembly.lattices) > 1:  # whose nodes are meant?
        source.refuse_beside(options.input, assembly.beside_beams(), "--socket")
    for lattice in assembly.lattices:
        _check_process(options, lattice.skeleton)
    assemblies.build(assembly, options, shapes.maker(options) if made else None, progress)
    return True


def _check_combination(options: argparse.Namespace) -> None:
    """Raise where an option would do nothing."""
    cad = options.output.suffix.lower() in BREP_SUFFIXES
    if options.round and options.product == "shell":
        raise OptionError("--as shell is for the coarse quads; need it without --round")
    if options.process is not None and options.product == "shell":
        raise OptionError("--process looks at struts; need it without --as shell")
    shapes.check(options)
    if options.sides is not None and cad:
        raise OptionError("--sides is for meshes, not for CAD formats")
    if options.tiles is None:
        tiled.refuse(options)
    elif options.socket or options.product != "scaffold":
        raise OptionError("--tiles is for solids of struts; need it without --as and --socket")
