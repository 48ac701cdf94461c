"""`scaffold-cad lattice`: what becomes of struts at the surface of what they fill."""

from __future__ import annotations

import argparse
from typing import Any, get_args

from scaffold_cad.base.regions import Keep
from scaffold_cad.cli import source
from scaffold_cad.cli.maps import map_of

OF_BORDERS = ("keep", "no_dangling", "shortest")
"""The options of this module."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that `borders` reads."""
    group = parser.add_argument_group("struts at the surface, without --skin and --trim")
    group.add_argument(
        "--keep",
        choices=get_args(Keep),
        help="cut struts at the surface (default: clip), or keep those whole whose middle is "
        "inside",
    )
    group.add_argument("--no-dangling", action="store_true", help="leave out struts that end free")
    group.add_argument(
        "--shortest",
        type=float,
        metavar="L",
        help="shrink struts shorter than this to a node, mm (default: 1/1000 of a cell)",
    )


def check(options: argparse.Namespace) -> None:
    """Raise where one of the options is given for struts that do not end at a surface."""
    layered = options.layer is not None and options.inside is not None
    if options.skin is not None or options.trim or layered:
        named = OF_BORDERS if options.foam is None else OF_BORDERS[:2]  # foams are made whole
        why = "is for struts alone; need it without --skin, --trim and --layer of --inside"
        source.refuse(options, named, why)
    if options.foam == "delaunay":
        source.refuse(options, OF_BORDERS[:2], "is not for --foam delaunay, which keeps whole ones")
    if map_of(options) is not None:
        source.refuse(options, ["keep", "shortest"], "is for a box or a part; need --box, --inside")


def borders(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for `fill` and foams, of those that are given."""
    given: dict[str, Any] = {"keep": options.keep, "shortest": options.shortest}
    if options.no_dangling:
        given["dangling"] = False
    return {name: value for name, value in given.items() if value is not None}
