"""Arguments that say which skeleton a command works on."""

from __future__ import annotations

import argparse
import logging

from scaffold_cad.io import read_skeleton
from scaffold_cad.skeleton import Skeleton

MAX_NODES = 2_000_000
"""Most nodes of a file that are taken unless more are asked for."""

_log = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that `skeleton_from` reads."""
    parser.add_argument("input", metavar="INPUT", help="file with a skeleton")
    parser.add_argument(
        "--radius", type=float, metavar="R", help="radius of every node, mm (instead of the file's)"
    )
    add_max_nodes(parser)
    parser.add_argument(
        "--simplify",
        type=float,
        metavar="TOL",
        help="drop joints that the shape does not need within TOL mm",
    )
    parser.add_argument(
        "--strict", action="store_true", help="refuse a file that needs repair instead of repairing"
    )


def add_max_nodes(parser: argparse.ArgumentParser) -> None:
    """Add the argument that guards memory."""
    parser.add_argument(
        "--max-nodes",
        type=int,
        default=MAX_NODES,
        metavar="N",
        help="refuse a file with more nodes, as a guard of memory (default: %(default)s)",
    )


def skeleton_from(options: argparse.Namespace) -> Skeleton:
    """Return the skeleton that the arguments ask for."""
    skeleton = read_skeleton(
        options.input, options.radius, options.strict, max_nodes=options.max_nodes
    )
    if options.simplify is None:
        return skeleton
    thin = skeleton.simplified(options.simplify)
    _log.info("simplified from %d to %d edges", len(skeleton.edges), len(thin.edges))
    return thin
