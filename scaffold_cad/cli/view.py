"""`scaffold-cad view`: a skeleton with its scaffold and its solid, or a solid, in a browser."""

from __future__ import annotations

import argparse
import logging
import tempfile
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING

from scaffold_cad.base.files import check_page
from scaffold_cad.cli import shapes, sizes, source
from scaffold_cad.products.overlaps import to_unite
from scaffold_cad.solid import frame_scaffold, solidified
from scaffold_cad.struts import round_struts
from scaffold_cad.webpage import write_page

if TYPE_CHECKING:
    from scaffold_cad.mesh.trianglemesh import TriangleMesh
    from scaffold_cad.scaffold import Scaffold
    from scaffold_cad.solid import Solidified
    from scaffold_cad.struts import RoundStruts

SOLIDS = ("scaffold", "round", "frame")

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "view",
        parents=[common],
        help="show a skeleton, its scaffold and its solid in a browser",
        description="INPUT is a skeleton, a mesh (STL, 3MF, OBJ, PLY) or a CAD part (STEP, BREP). "
        "The page needs no network; what is shown can be named after its address, as in "
        "page.html#skeleton,solid.",
    )
    source.add_arguments(parser)
    parser.add_argument(
        "-o",
        "--output",
        type=sizes.path,
        metavar="PAGE",
        help="page to write, .html (default: a temporary file)",
    )
    parser.add_argument("--no-open", action="store_true", help="do not open a browser")
    parser.add_argument(
        "--as",
        dest="product",
        choices=SOLIDS,
        help="which solid: the one inside the scaffold (default), round struts, or the scaffold's "
        "edges as struts",
    )
    shapes.add_scaffold_arguments(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Write the page, print where it is, and open it."""
    if options.output is not None:
        check_page(options.output)
    given = (*shapes.SCAFFOLD_OPTIONS, "product")
    asked = any(getattr(options, name) not in (None, False) for name in given)
    why = "is for skeletons; a mesh is shown as it is"
    assembly = source.assembly_from(options, ends=not asked)
    if assembly is not None:
        source.refuse(options, given, why)
        mesh: TriangleMesh | None = source.united(assembly, options)
    else:
        mesh = source.triangles_from(options, given, why)
    if mesh is not None:
        page = _page_path(options)
        write_page(mesh, page)
    else:
        shapes.check_frame_options(options)
        scaffold = shapes.scaffold_from(options, source.skeleton_from(options))
        solid = _solid(scaffold, options)
        page = _page_path(options)
        write_page(scaffold, page, solid=solid)
    print(page)
    if not options.no_open and not webbrowser.open(page.resolve().as_uri()):
        _log.warning("no browser could be opened: open %s in one", page)


def _page_path(options: argparse.Namespace) -> Path:
    """Return where to write; a temporary folder is made only once there is something to write."""
    if options.output is not None:
        return Path(options.output)
    return Path(tempfile.mkdtemp(prefix="scaffold-cad-")) / f"{Path(options.input).stem}.html"


def _solid(scaffold: Scaffold, options: argparse.Namespace) -> Solidified:
    made: Scaffold | RoundStruts = scaffold
    if options.product == "round":
        made = round_struts(scaffold.skeleton)
    elif options.product == "frame":
        radius = shapes.frame_radius(options, scaffold.skeleton)
        made = frame_scaffold(scaffold, radius)
    solid = solidified(made)
    to_unite("unite", solid.united_edges, made.skeleton)
    return solid
