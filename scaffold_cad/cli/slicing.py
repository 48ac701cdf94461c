"""`scaffold-cad slice`: the struts of a skeleton, or a closed mesh, cut into layers."""

from __future__ import annotations

import argparse
import logging
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.files import check_target
from scaffold_cad.base.summaries import counted
from scaffold_cad.cli import shapes, source, streams, tiled
from scaffold_cad.cli.flags import told_as
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import read_triangles
from scaffold_cad.io.stacks import check_stack, write_layers
from scaffold_cad.layers import Layers, slices
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.rounds import SIDES
from scaffold_cad.struts import RoundStruts, round_struts

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "slice",
        parents=[common],
        help="cut round struts into layers, without a mesh of them",
        description="Struts are cylinders and cones, cut as such, with blends at their nodes. A "
        "file with a closed mesh is cut as it is.",
    )
    source.add_arguments(parser, several=True)
    streams.add_output(parser, "file to write: .cli .3mf .svg, or .zip with PNG images")
    add_layer_arguments(parser, required=True)
    shapes.add_strut_arguments(parser.add_argument_group("round struts"))
    parser.add_argument(
        "--inside", type=Path, metavar="PART", help="closed part that the struts are cut to"
    )
    parser.add_argument(
        "--skin", type=float, metavar="S", help="thickness of a closed wall of that part, mm"
    )
    tiled.add_arguments(parser, of="the layers of struts", jobs="tiles, or on files")
    parser.set_defaults(run=run)


def add_layer_arguments(parser: argparse.ArgumentParser, *, required: bool) -> None:
    """Add the arguments of files of layers; `check_layers` looks at them."""
    about = "thickness of a layer, mm"
    if not required:
        about += ": writes layers, as .cli .3mf .svg or .zip"
    parser.add_argument("--layer", required=required, type=float, metavar="T", help=about)
    parser.add_argument(
        "--pixel", type=float, metavar="P", help="side of a pixel of PNG images, mm"
    )
    parser.add_argument("--text", action="store_true", help="write a .cli file of text")


def run(options: argparse.Namespace) -> None:
    """Read, cut and write."""
    _check(options)
    if options.tiles is not None:
        _slice_tiles(options)
        return
    progress = Progress()
    given = shapes.round_options(options)
    others = (*shapes.ROUND_OPTIONS, "sides")
    asked = any(getattr(options, name) is not None for name in others)
    assembly = source.assembly_from(options, ends=not asked)
    if assembly is not None:
        make = partial(round_struts, **given) if asked else None
        mesh: TriangleMesh | None = source.united(assembly, options, make, options.sides or SIDES)
    else:
        mesh = source.triangles_from(options, others, "is for skeletons; a mesh is cut as it is")
    if mesh is not None:
        what: TriangleMesh | RoundStruts = mesh
        sections = len(mesh.triangles)
    else:
        skeleton = source.skeleton_from(options)
        with progress.stage("struts", len(skeleton.edges), "struts"):
            what = round_struts(skeleton, **given)
        heights = skeleton.nodes[skeleton.edges][:, :, 2]  # (m, 2)
        sections = int(np.ptp(heights, axis=1).sum() / options.layer) + len(heights)
    with progress.stage("layers", sections, "sections"):
        layers = _layers(what, options)
        with told_as(pixel="--pixel"):
            write_layers(layers, options.output, text=options.text, pixel=options.pixel)
    _log.info(
        "%s written: %s of %g mm",
        options.output,
        counted(len(layers), "layer"),
        options.layer,
    )


def _slice_tiles(options: argparse.Namespace) -> None:
    """Cut and write tile by tile, from the lowest node less its radius up."""
    source.check_beams_alone(options, "--tiles")
    skeleton = source.skeleton_from(options)
    bottom = float((skeleton.nodes[:, 2] - skeleton.radii).min())
    given = shapes.round_options(options)
    work = tiled.layer_work(options, bottom, given, options.sides or SIDES, _region(options))
    tiled.make(tiled.cut(skeleton, options), work, options)


def _layers(what: TriangleMesh | RoundStruts, options: argparse.Namespace) -> Layers:
    """Return the layers that are asked for."""
    sides = options.sides if isinstance(what, RoundStruts) else None
    given: dict[str, Any] = {"skin": options.skin, "sides": sides}
    with told_as(thickness="--layer"):
        return slices(what, thickness=options.layer, region=_region(options), **given)


def _region(options: argparse.Namespace) -> TriangleMesh | None:
    """Return the part that the struts are cut to, if one is given."""
    if options.inside is None:
        return None
    part = read_triangles(options.inside)
    if part is None:
        raise FormatError(f"{options.inside} holds no closed part; need a mesh or a solid")
    return part


def _check(options: argparse.Namespace) -> None:
    """Raise where an option is out of its range, or would do nothing."""
    check_layers(options)
    if options.skin is not None and options.inside is None:
        raise OptionError("--skin is the wall of a part; need --inside")
    if options.tiles is None:
        tiled.refuse(options)


def check_layers(options: argparse.Namespace) -> None:
    """Raise where an option of a file of layers is out of its range, or would do nothing."""
    suffix = check_stack(options.output)
    check_target(options.output)
    as_number(options.layer, "--layer")
    if options.text and suffix != ".cli":
        raise OptionError("--text is for .cli files")
    if options.pixel is None and suffix == ".zip":
        raise OptionError("images need --pixel, the side of a pixel in mm")
    if options.pixel is not None:
        as_number(options.pixel, "--pixel")
        if suffix != ".zip":
            raise OptionError("--pixel is for the images of .zip files")
