"""Struts as hexahedra for finite elements: `scaffold-cad build --as hexahedra`."""

from __future__ import annotations

import argparse
import logging
from typing import Any

from scaffold_cad.base.arguments import as_count
from scaffold_cad.base.files import check_target
from scaffold_cad.base.summaries import counted
from scaffold_cad.cli import source
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import FormatError
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.struts import RoundStruts

OPTIONS = ("along", "keep", "layers")
"""What `add_arguments` adds."""

ENDINGS = (".inp", ".bdf", ".msh", ".vtu")

_log = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of hexahedra."""
    elements = parser.add_argument_group("hexahedra")
    elements.add_argument(
        "--along", type=int, metavar="N", help="hexahedra along each strut's straight part"
    )
    elements.add_argument(
        "--keep",
        choices=("surface", "volume"),
        help="what hexahedra of round struts keep: outer points on the surface, or the volume",
    )
    elements.add_argument(
        "--layers", type=int, metavar="N", help="layers of hexahedra around the core of struts"
    )


def check(options: argparse.Namespace) -> None:
    """Raise where an option does nothing for hexahedra, or no format of theirs is asked for."""
    if options.output.suffix.lower() not in ENDINGS:
        raise FormatError(
            f"cannot write {options.output}: hexahedra are written as {', '.join(ENDINGS)}"
        )
    check_target(options.output)
    for name, least in (("along", 1), ("layers", 0)):
        if getattr(options, name) is not None:
            as_count(getattr(options, name), f"--{name}", least=least)
    others = ("overlaps", "socket", "wall")
    source.refuse(options, others, "is for solids; need it without --as hexahedra")


def refuse(options: argparse.Namespace) -> None:
    """Raise where an option, or the format, is of hexahedra, and something else is asked for."""
    source.refuse(options, OPTIONS, "is of hexahedra; need --as hexahedra")
    if options.output.suffix.lower() in ENDINGS:
        raise FormatError(
            f"cannot write {options.output}: its format holds hexahedra (--as hexahedra), no "
            "surface; scaffold-cad convert writes skeletons, strength beams"
        )


def write(struts: Scaffold | RoundStruts, options: argparse.Namespace, progress: Progress) -> None:
    """Make the hexahedra and write them.

    Raises
    ------
    OptionError
        If a number is out of its range, or struts overlap.
    """
    from scaffold_cad.mechanics import hexahedra, write_hexahedra

    given: dict[str, Any] = {name: getattr(options, name) for name in (*OPTIONS, "sides")}
    chosen = {name: value for name, value in given.items() if value is not None}
    with progress.stage("hexahedra", len(struts.skeleton.edges), "struts"):
        mesh = hexahedra(struts, **chosen)
    count = counted(len(mesh.hexahedra), "hexahedron", "hexahedra")
    _log.info("%s, scaled Jacobians %.3g or more", count, mesh.quality.min())
    write_hexahedra(mesh, options.output)
