"""`scaffold-cad build`: a file with a skeleton becomes a scaffold, a solid or a frame."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from scaffold_cad.cli import source
from scaffold_cad.export import BREP_SUFFIXES, check_writable, write
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.smooth import Caps, smooth_patches
from scaffold_cad.solid import solidified
from scaffold_cad.stars import Fit, Section
from scaffold_cad.thicken import frame_scaffold

if TYPE_CHECKING:
    from scaffold_cad.skeleton import Skeleton

PRODUCTS = ("scaffold", "frame", "shell")

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
        help="round struts and smooth nodes: G1 patches in CAD formats, fine meshes in others",
    )
    parser.add_argument(
        "--levels",
        type=int,
        choices=(1, 2),
        default=2,
        help="subdivisions of a smooth mesh: struts get 8 or 16 sides (default: 2)",
    )
    parser.add_argument(
        "--caps",
        choices=get_args(Caps),
        default="round",
        help="how struts end in a smooth CAD solid (default: round)",
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
        default="enclose",
        help="how large branch points are: so that no strut is cut thin, or as in the paper",
    )
    parser.add_argument(
        "--section",
        choices=get_args(Section),
        default="circumscribed",
        help="which square section stands for a circle of the radius",
    )
    parser.add_argument(
        "--collars", action="store_true", help="keep struts straight between their nodes' blends"
    )


def run(options: argparse.Namespace) -> None:
    """Read, build and write."""
    check_writable(options.output)
    skeleton = source.skeleton_from(options)
    scaffold = scaffold_from(options, skeleton)
    if options.product == "frame":
        scaffold = frame_scaffold(scaffold, frame_radius(options, skeleton))
    write(_product(scaffold, options), options.output)
    _log.info("%s written", options.output)


def scaffold_from(options: argparse.Namespace, skeleton: Skeleton) -> Scaffold:
    """Return the scaffold that the arguments ask for."""
    return build_scaffold(
        skeleton, fit=options.fit, section=options.section, collars=options.collars
    )


def frame_radius(options: argparse.Namespace, skeleton: Skeleton) -> float:
    """Return the radius of a frame's struts, mm."""
    if options.strut_radius is not None:
        return float(options.strut_radius)
    radius = FRAME_RADIUS * float(np.median(skeleton.radii))
    _log.info("the frame's struts have radius %.4g mm; --strut-radius sets another", radius)
    return radius


def _product(scaffold: Scaffold, options: argparse.Namespace) -> Any:
    """Return what to write; a scaffold in a mesh format gets its overlapping struts united."""
    cad = options.output.suffix.lower() in BREP_SUFFIXES
    shell = options.product == "shell"
    left_out = scaffold.embedding().left_out
    if len(left_out):
        _log.warning(
            "%d of %d struts overlap others or their nodes, edge %d first%s",
            len(left_out),
            len(scaffold.skeleton.edges),
            left_out[0],
            ": the surface may cross itself there; --simplify, a smaller radius or a mesh helps"
            if cad or shell
            else "; they are united",
        )
    if options.smooth and not shell:
        if cad:
            return smooth_patches(scaffold, caps=options.caps)
        return solidified(scaffold, sides=4 * 2**options.levels).manifold
    if not shell:
        return scaffold
    if not cad:
        return scaffold.mesh
    # Imported here: only CAD shells need build123d.
    from scaffold_cad.brep import to_brep

    return to_brep(scaffold.mesh, "shell")
