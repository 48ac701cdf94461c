"""Arguments that say which skeleton a command works on."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Points
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import mirror, rotate
from scaffold_cad.cli import fields, sizes
from scaffold_cad.cli.sizes import AXES
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import BYTES_PER_EDGE, RawSkeleton, read_assembly, read_raw, read_triangles
from scaffold_cad.io.reading import in_millimeters, repairing, strictly, with_repairs
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.assembly import Assembly, assembly_solid, log_united
from scaffold_cad.products.models import Make
from scaffold_cad.skeleton import Cleaning, Skeleton, check_skeleton
from scaffold_cad.skeleton.repair import Repairs
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.solid.rounds import SIDES

MAX_NODES = 2_000_000
"""Most nodes of a file that are taken unless more are asked for."""

OPTIONS = ("radius", "max_nodes", "join", "simplify", "turn", "mirror", "strict")
"""What `add_arguments` adds beside the input, its units and its scale."""

_log = logging.getLogger(__name__)


def add_input(parser: argparse.ArgumentParser, several: bool = False) -> None:
    """Add the argument of the file, or of several files, that a command works on."""
    parser.add_argument(
        "input",
        type=sizes.name,
        metavar="INPUT",
        nargs="+" if several else None,
        help="files with skeletons, one or several; - for standard input"
        if several
        else "file with a skeleton; - for standard input",
    )
    parser.add_argument(
        "--from", dest="from_format", metavar="FMT", help="format of standard input, such as json"
    )


def add_arguments(parser: argparse.ArgumentParser, several: bool = False) -> None:
    """Add the arguments that `skeleton_from` reads."""
    add_input(parser, several)
    what = parser.add_argument_group("the skeleton that is read")
    what.add_argument(
        "--radius",
        type=fields.number,
        metavar="R",
        help=f"radius of every node, mm (instead of the file's): {fields.ABOUT}",
    )
    add_max_nodes(what)
    add_units(what)
    what.add_argument(
        "--join",
        type=float,
        metavar="TOL",
        help="make nodes where struts cross, or end on others, within TOL mm",
    )
    what.add_argument(
        "--simplify",
        type=float,
        metavar="TOL",
        help="drop joints that the shape does not need within TOL mm, and those closer together "
        "than their radius in any case",
    )
    what.add_argument(
        "--turn",
        action="append",
        type=sizes.turn,
        metavar="AXIS:DEGREES",
        help="rotate about an axis through the origin by degrees, as in z:90; repeat it for more "
        "rotations",
    )
    what.add_argument(
        "--mirror", choices=tuple(AXES), help="mirror along an axis, after the rotations"
    )
    add_strict(what)


def add_strict(parser: argparse._ActionsContainer) -> None:
    """Add the argument that allows no repair."""
    parser.add_argument(
        "--strict",
        action="store_true",
        help="refuse a file that needs repair instead of repairing it",
    )


def add_units(parser: argparse._ActionsContainer) -> None:
    """Add the arguments that say how long the unit of the input is."""
    parser.add_argument(
        "--units",
        metavar="UNIT",
        help="unit of the input's lengths where it names none: um, mm, cm, m, in, ft (default: mm)",
    )
    parser.add_argument(
        "--scale", type=float, metavar="S", help="multiply the input's lengths by S"
    )


def add_max_nodes(parser: argparse._ActionsContainer, what: str = "file") -> None:
    """Add the argument that guards memory; `max_nodes` gives its value."""
    parser.add_argument(
        "--max-nodes",
        type=int,
        metavar="N",
        help=f"refuse a {what} with more nodes, to protect memory (default: {MAX_NODES})",
    )


def max_nodes(options: argparse.Namespace) -> int:
    """Return how many nodes are taken at most."""
    return MAX_NODES if options.max_nodes is None else int(options.max_nodes)


def check_memory(options: argparse.Namespace, cells: int, nodes: int, struts: int) -> None:
    """Raise if a lattice with these numbers of cells, nodes and struts may not fit into memory."""
    most = max_nodes(options)
    if nodes > most:
        raise OptionError(
            f"{counted(cells, 'cell')} have some {nodes} nodes and {struts} struts; need at most "
            f"{most} nodes: to build them takes about {struts * BYTES_PER_EDGE / 1e9:.3g} GB of "
            "memory, and --max-nodes allows it"
        )


def refuse(options: argparse.Namespace, names: Iterable[str], why: str) -> None:
    """Raise if one of the options called `names` is given: it would do nothing.

    None and False stand for an option that is not given.
    """
    for name in names:
        value = getattr(options, name)
        if value is not None and value is not False:  # 0 is given
            raise OptionError(f"{flag_of(name)} {why}")


def flag_of(name: str) -> str:
    """Return the flag of an option by its name in the code."""
    return "--as" if name == "product" else "--" + name.replace("_", "-")


def assembly_from(options: argparse.Namespace, *, ends: bool = True) -> Assembly | None:
    """Return what the input holds if it is a 3MF file with more than a skeleton keeps, else None.

    What the arguments ask for is done to all of it: beams get other radii, nodes and joints, and
    are turned and scaled with what is beside them.

    Parameters
    ----------
    ends : whether flat ends are more: not where struts get the ends that are asked for

    Raises
    ------
    OptionError
        If units are given, and the file says that it is in another.
    FormatError
        If balls or flat ends would go, and nothing may.
    SkeletonError
        If beams need repair, and none is allowed.
    """
    path = Path(options.input)
    if path.suffix.lower() != ".3mf":
        return None
    assembly = read_assembly(path)
    more = assembly.beyond_skeleton() if ends else assembly.beside_beams()
    if not more or not assembly.lattices:
        return None
    if options.units is not None:
        in_millimeters(path, read_raw(path), options.units, None)  # refuses another unit
    if options.strict:
        _check_beams(assembly, path)
    changed = _changed(assembly, options)
    kept = changed.beyond_skeleton()
    if options.strict and any(one not in kept for one in more):
        raise FormatError(
            f"{path} holds {', '.join(one for one in more if one not in kept)}; need nothing that "
            "beams lose where they are changed (or read it without --strict)"
        )
    return changed


def _check_beams(assembly: Assembly, path: Path) -> None:
    """Raise if a beam of a file needs repair."""
    if assembly.beams_left_out:
        raise FormatError(
            f"{path} has {counted(assembly.beams_left_out, 'beam')} without a length or a radius "
            "> 0; need none (or read it without --strict)"
        )
    for lattice in assembly.lattices:
        check_skeleton(lattice.skeleton)


def read_whole(options: argparse.Namespace, raw: RawSkeleton, radius: Radius | None) -> Cleaning:
    """Return the skeleton that was read of the input, which needs no repair and is kept whole.

    Parameters
    ----------
    radius : of every node, mm; that of the file if None

    Raises
    ------
    FormatError, SkeletonError
        If it needs repair, or holds what neither a skeleton nor an assembly keeps.
    """
    path, lengths = Path(options.input), {"units": options.units, "scale": options.scale}
    assembly = read_assembly(path) if path.suffix.lower() == ".3mf" else None
    if assembly is None or not assembly.lattices or not assembly.beyond_skeleton():
        return Cleaning(strictly(path, raw, radius, **lengths), Repairs())
    _check_beams(assembly, path)
    return with_repairs(path, replace(raw, left_out=()), radius, **lengths)


def check_beams_alone(options: argparse.Namespace, flag: str) -> None:
    """Raise if the input is a 3MF file with more than beams, of which a flag would lose the rest.

    Raises
    ------
    OptionError
        If there are meshes, clipping or balls beside the beams.
    """
    path = Path(options.input)
    beside = read_assembly(path).beside_beams() if path.suffix.lower() == ".3mf" else []
    if beside:
        refuse_beside(path, beside, flag)


def refuse_beside(path: Path, beside: Iterable[str], flag: str) -> NoReturn:
    """Raise, as a flag would lose what is beside the beams of a file."""
    raise OptionError(
        f"{flag} is for beams alone, and {path} holds also {', '.join(beside)}; need the beams in "
        "a file of their own, such as scaffold-cad convert writes as .json"
    )


def _changed(assembly: Assembly, options: argparse.Namespace) -> Assembly:
    """Return an assembly as the arguments ask for it, in the order of `skeleton_from`."""
    if options.scale is not None:
        assembly = assembly.transformed(np.eye(3) * as_number(options.scale, "--scale"))
    if options.radius is not None:
        assembly = assembly.with_skeletons(lambda beams: beams.with_radii(options.radius))
    assembly = assembly.with_skeletons(lambda beams: _joined(beams, options))
    assembly = assembly.transformed(_turned(np.eye(3), options))
    return assembly.with_skeletons(lambda beams: _simplified(beams, options))


def united(
    assembly: Assembly, options: argparse.Namespace, make: Make | None = None, sides: int = SIDES
) -> TriangleMesh:
    """Return the surface of beams and what is beside them; make and sides: see `assembly_solid`."""
    log_united(assembly, str(options.input))
    return manifold_triangles(assembly_solid(assembly, sides, make=make))


def triangles_from(
    options: argparse.Namespace, others: Iterable[str], why: str
) -> TriangleMesh | None:
    """Return the mesh of an input that is not an assembly, or None where it is a skeleton.

    Parameters
    ----------
    others : options that are refused for meshes, beside those that change a skeleton
    why : why an option is refused

    Raises
    ------
    OptionError
        If an option is given that would do nothing.
    """
    path = Path(options.input)
    if path.suffix.lower() == ".3mf" and read_assembly(path).lattices:
        return None  # beams that `assembly_from` has not taken are a skeleton
    mesh = read_triangles(path, units=options.units, scale=options.scale)
    if mesh is not None:
        refuse(options, [*OPTIONS, *others], why)
    return mesh


def skeleton_from(
    options: argparse.Namespace, path: Path | None = None, *, converted: bool = False
) -> Skeleton:
    """Return the skeleton that the arguments ask for, of the input or of another file.

    Parameters
    ----------
    converted : whether it is written as what it was: then it is told that supports and loads go
    """
    path = Path(options.input) if path is None else path
    # Struts end as they are asked to: nothing is lost where the beams of a file are flat.
    raw = replace(read_raw(path, max_nodes(options)), flat_ends=0)
    if converted and raw.loading is not None:
        raw = replace(raw, left_out=(*raw.left_out, "supports and loads"))
    read = strictly if options.strict else repairing
    skeleton = read(path, raw, options.radius, units=options.units, scale=options.scale)
    skeleton = _joined(skeleton, options)
    if options.turn or options.mirror:
        skeleton = skeleton.moved(_turned(skeleton.nodes, options))
    return _simplified(skeleton, options)


def _joined(skeleton: Skeleton, options: argparse.Namespace) -> Skeleton:
    """Return the skeleton with nodes where struts cross, if that is asked for."""
    if options.join is None:
        return skeleton
    joined = skeleton.joined(as_number(options.join, "--join"))
    _log.info("joined: %s became %d", counted(len(skeleton.edges), "edge"), len(joined.edges))
    return joined


def _turned(points: Points, options: argparse.Namespace) -> Points:
    """Return points (n, 3) after the turns and the mirror image that are asked for."""
    for axis, angle in options.turn or []:
        points = rotate(points, np.asarray(AXES[axis]), np.asarray(angle))
    return points if options.mirror is None else mirror(points, np.asarray(AXES[options.mirror]))


def _simplified(skeleton: Skeleton, options: argparse.Namespace) -> Skeleton:
    """Return the skeleton with fewer joints, if that is asked for."""
    if options.simplify is None:
        return skeleton
    thin = skeleton.simplified(as_number(options.simplify, "--simplify", or_zero=True))
    _log.info("simplified from %d to %s", len(skeleton.edges), counted(len(thin.edges), "edge"))
    return thin
