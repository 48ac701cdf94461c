"""check_printability(): everything to know of a part before it is printed."""

from __future__ import annotations

from typing import Any, Literal

from scaffold_cad.base.arguments import (
    as_direction,
    as_flag,
    check_kind,
    checks_keywords,
    described,
)
from scaffold_cad.base.placements import DirectionLike
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.welding import welded
from scaffold_cad.printability.direction import direction_findings
from scaffold_cad.printability.drainage import drainage_finding
from scaffold_cad.printability.gaps import flat_ends
from scaffold_cad.printability.match import match_finding
from scaffold_cad.printability.part import part_findings
from scaffold_cad.printability.processes import USUAL_MATERIAL, Process, process_named
from scaffold_cad.printability.report import Finding, Report
from scaffold_cad.printability.standing import Facets, best_direction, standing_size
from scaffold_cad.printability.struts import as_wide, strut_findings
from scaffold_cad.printability.surface import surface_findings
from scaffold_cad.printability.thickness import thickness_of
from scaffold_cad.printability.triangletopology import TriangleTopology
from scaffold_cad.printability.walls import wall_finding
from scaffold_cad.products.surfaces import triangles_of
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.stars import APOTHEM
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.checking import check_single_precision
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.struts import RoundStruts


@checks_keywords()
def check_printability(
    what: Any,
    process: str | Process = "sls",
    *,
    skeleton: Skeleton | None = None,
    direction: DirectionLike | Literal["best"] = (0.0, 0.0, 1.0),
    material: str | None = None,
    supports: bool = True,
    name: str = "part",
    sides: int | None = None,
) -> Report:
    """Return what a printing engineer asks of a part before it is printed.

    Parameters
    ----------
    what : a Skeleton, a Scaffold or RoundStruts, whose solid is made; or anything else that has a
        surface, see `surface_of`: a mesh, smooth patches, a Solidified, a manifold3d Manifold, a
        trimesh Trimesh, a build123d shape or a builder
    process : a name in `PROCESSES`, or limits of your own
    skeleton : of the struts of a mesh, with their radii; a Skeleton or a Scaffold has its own
    direction : that is built upwards in, or "best"
    material : a name in `MATERIALS`; by default what the process mostly prints
    supports : whether supports may be used
    name : what the report calls the part
    sides : of the polygons that stand for circles of RoundStruts, a multiple of 4; 16 by default

    Raises
    ------
    MeshError
        If there is no triangle, or struts are too thin for 32-bit coordinates so far from the
        origin.
    OptionError
        If `what` has no surface, `skeleton` is of another type, the process, the material or the
        direction is not known, `supports` is neither True nor False, or `sides` are given for
        anything but RoundStruts.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, check_printability
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> check_printability(strut, "sls").printable
    True
    """
    process, supports = process_named(process), as_flag(supports, "supports")
    if sides is not None and not isinstance(what, RoundStruts):
        raise OptionError(f"sides are for RoundStruts only; {name} is {described(what)}")
    if sides is not None:
        check_sides(sides)
    if skeleton is not None:
        check_kind(skeleton, Skeleton, name="skeleton")
    if isinstance(what, Skeleton):
        what = build_scaffold(what)
    apothem, given = 1.0, skeleton is not None
    if isinstance(what, Scaffold):
        check_single_precision(what.skeleton)
        if skeleton is None:
            apothem = APOTHEM[what.options.section]
            skeleton = as_wide(what.skeleton, apothem)
        what = to_solid(what)
    if isinstance(what, RoundStruts) and skeleton is None:
        skeleton = what.skeleton
    mesh = welded(triangles_of(what, SIDES if sides is None else sides))
    surface = TriangleTopology(mesh)
    if len(surface.triangles) == 0:
        raise MeshError(f"{name} has no triangle of three vertices; need at least one")
    facets = Facets.of(surface)
    if _is_best(direction):
        upwards = best_direction(facets, process)
    else:
        upwards = as_direction(direction, "build direction", hint=', or "best"')
    findings: list[Finding] = []
    loops = None if skeleton is None else skeleton.loop_count
    findings += surface_findings(surface, process, loops)
    if skeleton is not None and len(skeleton.edges) == 0:
        skeleton = None  # there is nothing to say of struts
    if skeleton is not None:
        thickness = thickness_of(skeleton, mesh)
        if given and surface.closed:
            findings.append(match_finding(skeleton, mesh, thickness))
        flat = flat_ends(skeleton, mesh)
        findings += strut_findings(skeleton, thickness, process, flat, apothem)
    findings += direction_findings(surface, facets, upwards, process, skeleton, supports)
    findings.append(drainage_finding(surface, process))
    findings.append(wall_finding(surface, process))
    findings += part_findings(
        surface,
        standing_size(mesh.vertices, upwards, process.build_volume),
        process,
        USUAL_MATERIAL.get(process.name, "pla") if material is None else material,
    )
    return Report(name, process, tuple(findings), mesh, upwards)


@checks_keywords(check_printability)
def assert_printable(what: Any, process: str | Process = "sls", **options: Any) -> None:
    """Raise an AssertionError that holds the report unless `what` is printable; for tests.

    The options are those of `check_printability`.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, assert_printable
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> assert_printable(strut, "sls")
    """
    report = check_printability(what, process, **options)
    if not report.printable:
        raise AssertionError(str(report))


def _is_best(direction: DirectionLike | Literal["best"]) -> bool:
    return isinstance(direction, str) and direction == "best"
