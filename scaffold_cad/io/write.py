"""write(): what the package makes, as a file whose suffix names the format.

======================  ====================================================================
.step .stp              solids, mm; faces named after their strut or node; build123d shapes too
.stpz                   STEP packed by gzip, a fifth of the size; FreeCAD and CATIA read it
.brep                   OCCT's own format, mm
.stl                    binary, 32-bit coordinates, mm
.3mf                    one mesh object, 32-bit coordinates, mm; a skeleton as a beam lattice
.obj .ply               quads stay quads, 64-bit coordinates, mm; OBJ also a skeleton, as lines
.glb                    meters and y up, as glTF asks
.json .graphml .csv     a skeleton, as `read_skeleton` reads it
.swc                    a skeleton without loops, as `read_skeleton` reads it
.vtu .inp               a skeleton for ParaView, and as beams of finite elements
======================  ====================================================================
"""

from __future__ import annotations

import logging
from os import PathLike
from pathlib import Path
from typing import Any, get_args

from scaffold_cad.base.arguments import as_flag, as_path, check_choice, checks_keywords
from scaffold_cad.base.builders import built
from scaffold_cad.base.files import check_target, replacing
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io._units import factor_of
from scaffold_cad.io.content import Content
from scaffold_cad.io.radii import lost_radii
from scaffold_cad.io.register import WrittenFormat, written_format_of, written_suffixes
from scaffold_cad.io.step import STEP_SUFFIXES
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.struts import RoundStruts

_log = logging.getLogger(__name__)


@checks_keywords()
def write(
    what: Any,
    path: str | PathLike[str],
    *,
    write_pcurves: bool = False,
    overlaps: Overlaps | None = None,
    sides: int | None = None,
    units: str | None = None,
    scale: float | None = None,
) -> None:
    """Write `what` to the file at `path`, whole or not at all.

    Parameters
    ----------
    what : a Scaffold, RoundStruts, a QuadMesh, smooth patches, a subdivision or a BezierMesh
        for any format that holds solids; a Solidified, a TriangleMesh, a manifold3d Manifold or a
        trimesh Trimesh for mesh formats; a build123d shape, or a builder, which mesh formats get
        within 0.01 mm, large ones within 2e-5 of their diagonal, small ones within 1e-3; a
        Skeleton for JSON, GraphML, CSV, VTU, Abaqus input, 3MF (as a beam lattice), OBJ (as lines,
        without radii) and SWC (without loops); a BeamLattice for 3MF, or a PeriodicLattice of any
        size, whose beams are made and written a few layers at a time
    path : of the file; its suffix names the format
    write_pcurves : whether a STEP file also holds each edge in the parameters of its faces, for
        programs that ask for it: twice the size, and OCCT takes longer to write and to read it
    overlaps : what becomes of the struts of a Scaffold or of RoundStruts that overlap: "unite"
        them, which is the default of mesh formats and gives plane triangles in STEP and BREP files,
        where round struts overlap and instead of all square ones;
        "refuse" them, the default of STEP and BREP; or "allow" faces that cross
    sides : of the polygon that stands for the circle of a round strut in mesh formats, a multiple
        of 4; 16 by default
    units : "um", "mm", "cm", "m", "in", "ft", ...: the unit of the numbers in a file that names
        none, such as STL; refused for formats that name theirs. By default mm
    scale : > 0; what lengths are multiplied with besides

    Raises
    ------
    FormatError
        If the suffix is unknown, the format cannot hold `what`, or the file cannot be written.
    MeshError, BrepError
        If a B-rep is asked for and the mesh does not bound a solid, or struts overlap and are
        refused, or a mesh of a BeamLattice is not closed.
    OptionError
        If an option does not fit the format or `what`; or the units or the scale are not known; or
        `what` is a builder that holds no shape yet, or `path` is not a path.
    MissingBackendError
        If the package that writes the format is not installed.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from scaffold_cad import Skeleton, build_scaffold, write
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> with TemporaryDirectory() as folder:
    ...     write(build_scaffold(strut), Path(folder, "strut.stl"))
    ...     Path(folder, "strut.stl").stat().st_size  # 84 bytes, and 50 per triangle
    684
    """
    path, what = _target(path, what), built(what)
    write_pcurves = as_flag(write_pcurves, "write_pcurves")
    known = written_format_of(path)
    content = Content(
        what,
        path.stem,
        write_pcurves,
        overlaps,
        SIDES if sides is None else sides,
        *_factor(known, units, scale),
    )
    if write_pcurves and path.suffix.lower() not in STEP_SUFFIXES:
        raise OptionError(f"write_pcurves is for STEP files only; {path.name} is not one")
    if overlaps is not None and not isinstance(what, Scaffold | RoundStruts):
        kind = type(what).__name__
        raise OptionError(f"overlaps is for a Scaffold or RoundStruts; {path.name} gets a {kind}")
    if sides is not None and not isinstance(what, RoundStruts):
        kind = type(what).__name__
        raise OptionError(f"sides is for RoundStruts only; {path.name} gets a {kind}")
    if overlaps is not None:
        check_choice(overlaps, "overlaps", get_args(Overlaps))
    if sides is not None:
        check_sides(sides)
    with replacing(path) as fresh:
        known.write(content, fresh)
    lost = lost_radii(what, known.radii) if isinstance(what, Skeleton) else ""
    if lost:
        _log.warning("%s %s", path.name, lost)


def check_writable(
    path: str | PathLike[str], *, solid: bool = False, skeleton: bool = False
) -> None:
    """Raise unless `write` knows the suffix of `path` and can write a file there.

    Parameters
    ----------
    solid, skeleton : whether the format must be able to hold solids, or skeletons

    Raises
    ------
    FormatError
        If the suffix is unknown or its format holds no such thing, or the folder is missing or
        read-only.
    """
    path = as_path(path)
    known = written_format_of(path, solid, skeleton)
    if skeleton and not known.skeletons:
        holds = ", ".join(written_suffixes(skeleton=True))
        raise FormatError(f"{path} cannot hold a skeleton, only a solid of it; need {holds}")
    check_target(path)


def _factor(known: WrittenFormat, units: str | None, scale: float | None) -> tuple[float, str]:
    """Return what lengths in mm are multiplied with for a file of a format, and its unit."""
    factor = factor_of(None, scale)
    if units is None:
        return factor, "mm"
    unit = factor_of(units, None)
    if known.names_unit and unit != 1.0:
        raise OptionError(
            f"units is {units!r}, and {known.name} files say in which unit they are; need none"
        )
    return factor / unit, units


def _target(path: str | PathLike[str], what: Any) -> Path:
    if isinstance(what, str | PathLike) and not isinstance(path, str | PathLike):
        raise OptionError(
            f"path is of type {type(path).__name__}: the object comes first, "
            f"as in write(what, {str(what)!r})"
        )
    return as_path(path)
