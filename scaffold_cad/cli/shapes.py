"""The shape of struts: the arguments that say which, and what makes it, for all commands."""

from __future__ import annotations

import argparse
import logging
from functools import partial
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Bools, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.cli import fields, sizes, source
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import OptionError
from scaffold_cad.products.models import Make
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.stars import Fit, Section
from scaffold_cad.solid import frame_skeleton
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.struts import Ends, Joints, Nodes, RoundStruts, StrutOptions, round_struts

if TYPE_CHECKING:
    from scaffold_cad.skeleton import Skeleton

SQUARE_OPTIONS = ("fit", "section", "collars")
"""Those that round struts have no use for, unless they are made of a scaffold's edges."""

SCAFFOLD_OPTIONS = ("strut_radius", *SQUARE_OPTIONS)
"""What `add_scaffold_arguments` adds."""

ROUND_OPTIONS = ("blend", "ends", "joints", "bend", "wall", "nodes")
"""What `add_strut_arguments` adds, beside the sides."""

OPTIONS = (*SCAFFOLD_OPTIONS, "round", *ROUND_OPTIONS, "sides", "socket")
"""What `add_arguments` adds."""

FRAME_RADIUS = 0.15
"""Radius of a frame's struts when none is given, as a fraction of the median node radius."""

WIDENED = 1.1
"""Radius of a node, in that of a strut that ends there, above which it is reported."""

_log = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the shape; `check` looks at them and `struts` reads them."""
    add_scaffold_arguments(parser)
    add_round_arguments(parser).add_argument(
        "--socket",
        action="append",
        type=sizes.socket,
        metavar="NODE:RADIUS:DEPTH",
        help="bore the open end at a node for a tube: inner radius, and depth down to a shoulder, "
        "mm; for several sockets several times",
    )


def add_scaffold_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that `scaffold_from` and `frame_radius` read."""
    square = parser.add_argument_group("square struts")
    square.add_argument(
        "--strut-radius",
        type=float,
        metavar="R",
        help=f"radius of a frame's struts, mm (default: {FRAME_RADIUS} of the median radius)",
    )
    add_square_arguments(
        square,
        "straight struts of constant section, as an engineer's: without it they widen from "
        "their middles to their nodes (3 x 3 x 2 octet cells of 8 mm with a radius of 0.4 mm have "
        "1.23 times the volume of their cylinders, with it 1.11)",
    )


def add_square_arguments(square: argparse._ActionsContainer, collars: str) -> None:
    """Add the arguments that `scaffold_options` reads; `collars` is the help of `--collars`."""
    square.add_argument(
        "--fit",
        choices=get_args(Fit),
        help="how large branch points are: so that no strut is cut thin (default: enclose), or as "
        "in the paper",
    )
    square.add_argument(
        "--section",
        choices=get_args(Section),
        help="which square section stands for a circle of the radius (default: circumscribed)",
    )
    square.add_argument("--collars", action="store_true", help=collars)


def add_round_arguments(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Add the arguments that `round_options` and `round_sides` read, and return their group."""
    struts = parser.add_argument_group("round struts")
    struts.add_argument(
        "--round",
        action="store_true",
        help="round struts: cylinders and cones on the edges, with blends at the nodes",
    )
    add_strut_arguments(struts)
    return struts


def add_strut_arguments(parser: argparse._ActionsContainer) -> None:
    """Add the arguments of round struts: those that `round_options` reads, and their sides."""
    parser.add_argument(
        "--blend",
        type=fields.number,
        metavar="R",
        help="fillet radius at the nodes of round struts, mm, a number or a file as for --radius "
        "(default: half of the thinnest strut's radius)",
    )
    parser.add_argument(
        "--ends", choices=get_args(Ends), help="how round struts end (default: flat)"
    )
    parser.add_argument(
        "--joints",
        choices=get_args(Joints),
        help="how round struts pass joints of two edges: on a curve through their nodes, or as a "
        "bend between two cylinders (default: auto, by how the curve is sampled)",
    )
    parser.add_argument(
        "--bend",
        type=sizes.bend,
        metavar="HOW",
        help="how two cylinders meet at a bend: blend, torus, or the radius of the torus' "
        "centerline, mm (default: blend)",
    )
    parser.add_argument(
        "--nodes",
        choices=get_args(Nodes),
        help="what is at nodes: a blend, a ball on which each strut ends in a circle, or sharp "
        "edges in which the struts meet (default: blend)",
    )
    parser.add_argument(
        "--wall", type=float, metavar="T", help="thickness of hollow round struts, mm"
    )
    parser.add_argument(
        "--sides",
        type=int,
        metavar="N",
        help=f"sides of the polygons that stand for circles, a multiple of 4 (default: {SIDES})",
    )


def add_overlaps_argument(parser: argparse.ArgumentParser) -> None:
    """Add the argument that says what becomes of struts that overlap."""
    parser.add_argument(
        "--overlaps",
        choices=get_args(Overlaps),
        help="what becomes of struts that overlap (default: unite in meshes, refuse in STEP and "
        "BREP files)",
    )


def check_round_options(options: argparse.Namespace) -> None:
    """Raise where an option of round struts is given without them, or has a value that none have.

    This takes no skeleton: nothing need be read or made before it.
    """
    if not options.round:
        source.refuse(options, [*ROUND_OPTIONS, "sides"], "is for --round")
        return
    if options.sides is not None:
        check_sides(options.sides)
    given = round_options(options)
    if not isinstance(given.get("blend"), float):  # values of a file, for the nodes that there are
        given.pop("blend", None)
    StrutOptions(**given)


def check_frame_options(options: argparse.Namespace) -> None:
    """Raise where an option of frames is given for something else."""
    if options.product != "frame":
        why = "is for --as frame; --radius is that of the nodes"
        source.refuse(options, ["strut_radius"], why)


def round_options(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for `round_struts` that are given."""
    given = {name: getattr(options, name) for name in ROUND_OPTIONS}
    return {name: value for name, value in given.items() if value is not None}


def sockets(options: argparse.Namespace) -> dict[int, tuple[float, float]]:
    """Return the radius and the depth of sockets by their nodes."""
    found: dict[int, tuple[float, float]] = {}
    for node, radius, depth in options.socket or []:
        if node in found:
            raise OptionError(f"--socket has node {node} twice; need each node once")
        found[node] = radius, depth
    return found


def scaffold_options(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for `build_scaffold` that are given."""
    given = {name: getattr(options, name) for name in ("fit", "section")}
    chosen = {name: value for name, value in given.items() if value is not None}
    return {"collars": options.collars, **chosen}


def written_with(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for `write` that are given."""
    given = {name: getattr(options, name) for name in ("overlaps", "sides")}
    return {name: value for name, value in given.items() if value is not None}


def scaffold_from(options: argparse.Namespace, skeleton: Skeleton) -> Scaffold:
    """Return the scaffold that the arguments ask for."""
    scaffold = build_scaffold(skeleton, **scaffold_options(options))
    _report_widened(skeleton, scaffold.refinement.collared)
    return scaffold


def _report_widened(skeleton: Skeleton, collared: Bools) -> None:
    """Log which struts are thicker in the scaffold than they are: at ends without a collar.

    Parameters
    ----------
    collared : (m, 2), which ends of each edge have a collar
    """
    own, at_nodes = skeleton.edge_radii, skeleton.radii[skeleton.edges]
    wide = (at_nodes > WIDENED * own) & ~collared
    edges = np.flatnonzero(wide.any(axis=1))
    if len(edges) == 0:
        return
    edge = edges[0]
    end = int(np.argmax(wide[edge]))
    node = skeleton.edges[edge, end]
    _log.warning(
        "%d of %s widen to the radius of a node (edge %d: %.4g mm, node %d at %s: %.4g mm); "
        "--round keeps each strut's own radius, and so does --collars where there is room",
        len(edges),
        counted(len(skeleton.edges), "strut"),
        edge,
        own[edge, end],
        node,
        place_text(skeleton.nodes[node]),
        skeleton.radii[node],
    )


def frame_radius(options: argparse.Namespace, skeleton: Skeleton) -> float:
    """Return the radius of a frame's struts, mm."""
    if options.strut_radius is not None:
        return as_number(options.strut_radius, "--strut-radius")
    radius = FRAME_RADIUS * float(np.median(skeleton.radii))
    _log.info("the frame's struts have radius %.4g mm; --strut-radius sets another", radius)
    return radius


def check(options: argparse.Namespace) -> None:
    """Raise where an argument of the shape would do nothing."""
    check_round_options(options)
    if options.round and options.product != "frame":
        source.refuse(options, SQUARE_OPTIONS, "is for square struts; need it without --round")
    if options.socket and not options.round:
        raise OptionError("--socket is for --round")
    if options.socket and (options.ends != "open" or options.wall is None):
        raise OptionError("--socket bores open ends of hollow struts; need --wall T --ends open")
    check_frame_options(options)


def is_given(options: argparse.Namespace) -> bool:
    """Return whether a shape is asked for, so that beams do not stay as they are."""
    return any(getattr(options, name) not in (None, False) for name in OPTIONS)


def maker(options: argparse.Namespace) -> Make:
    """Return what makes the struts that stand for the beams of a 3MF file."""
    if options.round:
        return partial(round_struts, **round_options(options), sockets=sockets(options))
    return partial(scaffold_from, options)


def frame(options: argparse.Namespace, skeleton: Skeleton, progress: Progress) -> Skeleton:
    """Return the skeleton whose struts are asked for: its own, or the edges of its scaffold."""
    if options.product != "frame":
        return skeleton
    with progress.stage("scaffold", len(skeleton.edges), "struts"):
        scaffold = scaffold_from(options, skeleton)
    return frame_skeleton(scaffold, frame_radius(options, skeleton))


def struts(
    options: argparse.Namespace, skeleton: Skeleton, progress: Progress
) -> Scaffold | RoundStruts:
    """Return the struts that are asked for, of a skeleton that `frame` has returned."""
    if options.round:
        with progress.stage("struts", len(skeleton.edges), "struts"):
            return round_struts(skeleton, **round_options(options), sockets=sockets(options))
    with progress.stage("scaffold", len(skeleton.edges), "struts"):
        if options.product == "frame":
            return build_scaffold(skeleton, collars=True)
        return scaffold_from(options, skeleton)
