"""Parts filled with struts as B-reps: one solid of a skin and struts, with exact faces."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad import brep
from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.base.arrays import Frozen
from scaffold_cad.base.backends import need
from scaffold_cad.base.builders import built
from scaffold_cad.base.placements import AxesLike, PositionLike
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import BrepError, OptionError
from scaffold_cad.filling.fill import as_region
from scaffold_cad.filling.hollowing import check_seen
from scaffold_cad.filling.models import RoundOptions, Section, maker
from scaffold_cad.filling.reaching import Reaching, lattice_reaching, skeleton_reaching
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.mesh.nearest import NearestPlace
from scaffold_cad.mesh.remeshing import evened
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.models import Make, Model
from scaffold_cad.products.overlaps import Overlaps, described
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import manifolds, solidified
from scaffold_cad.struts import RoundStruts, round_struts

if TYPE_CHECKING:
    from build123d import Face, Shape, Solid
    from manifold3d import Manifold
    from typing_extensions import Unpack

NUDGES = (0.0, 0.02, -0.02, 0.05, -0.05)
"""How far the lattice is moved, in turn, until OCCT gets the part right; in cell sizes. Faces that
nearly coincide, or touch, are hard for it."""

SAMPLES = 4000
"""Random points at which the thickness of a skin is looked at."""

THINNER = 0.9
"""Part of the skin's thickness below which points must be in it, and over whose inverse not."""

MISPLACED = 0.01
"""Share of the points that may be on the wrong side: distances are from triangles nearby."""

OFF = 5e-3
"""How far the struts' volume in a void may be off that of a mesh of them, as a fraction."""

WALL_ANGLE = 0.2
"""Of the triangles that stand for hollow or square struts, rad: 0.2 % less than their faces where a
wall is a quarter of the radius."""

FINE, FINE_ANGLE = 0.1, 0.1
"""Of the triangles that stand for the void, in usual distances and rad: between thin walls struts
are so short that it shows where they are cut."""

MOST_STRUTS = 5000
"""Most struts that OCCT is given: 4 100 in a block take 2 minutes and 9 GB, 10 600 in a thin tube
did not end in 400 s."""

STRUT_TIME = 0.033
"""What OCCT takes to cut a strut, s, before its faces are known: 0.018 to 0.03 in blocks of 60 to
4 100, up to 0.08 where the inside of the skin is curved."""

FACE_TIME = 0.003
"""What OCCT takes to cut and to look at a face of struts, s: 0.002 to 0.0035."""

CURVED_TIME = 0.1
"""What it takes besides for a strut that passes through a curved skin, s: 0.05 in cylinders, 0.09
in spheres, 0.16 in tori."""

MESH_TIME = 0.003
"""What OCCT takes for the triangles of a face of hollow or square struts, s: 0.002 to 0.0043."""

MOST_FACETS = 60_000
"""Most faces of a union of struts that OCCT is given."""

FACET_TIME = 0.0015
"""What OCCT takes to cut a face of such a union, s: 0.0012 to 0.0019 for 21 000 to 46 000."""

_MESH = "lattice_part and strut_part make it of triangles"

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class HollowSolid(Frozen):
    """A body, and what is inside its skin."""

    solid: Solid
    """The body."""
    surface: TriangleMesh
    """Triangles of it."""
    inner: Solid
    """What is inside the skin."""
    inside: Manifold
    """The same as triangles."""


@dataclass(frozen=True, eq=False)
class FilledSolid(Frozen):
    """A body with a skin and a lattice for its inside."""

    solid: Solid
    """The part."""
    struts: Model
    """The struts, up to whole ones that stick out of the body."""


@checks_keywords(round_struts)
def lattice_solid(
    body: Shape,
    cell: str | UnitCell,
    size: CellSize,
    radius: Radius,
    *,
    skin: float,
    section: Section = "round",
    origin: PositionLike | None = None,
    axes: AxesLike | None = None,
    on: CellMap | None = None,
    overlaps: Overlaps = "refuse",
    **options: Unpack[RoundOptions],
) -> Solid:
    """Return `body` with a skin, and a lattice for its inside, as one build123d solid.

    Its faces are those of the body, the same moved inwards by the skin, whole cylinders and the
    like in quarters, and those of the struts: round ones are true cylinders up to where they meet
    the skin. It can be written as STEP. OCCT takes some 20 to 35 ms per strut, up to 80 where the
    skin is curved, and more than 5 000 are refused. Where it fails, `lattice_part` makes the same
    of triangles.

    Parameters
    ----------
    body : a build123d solid
    cell, size, radius : as for `fill`
    skin : thickness of the closed wall at the body's surface, mm
    section : of the struts, "round" or "square"; round by default, while those of `lattice_part`
        are square
    origin, axes, on : as for `fill`
    overlaps : what becomes of struts that overlap, "refuse" or "unite" as for `to_brep`: round ones
        get plane facets where they overlap, each of which takes OCCT 1 to 2 ms
    **options : those of `round_struts`, for round ones

    Raises
    ------
    OptionError
        If an argument is out of its range, `body` is not one solid, or the skin fills it.
    SkeletonError
        If no strut is in the body.
    BrepError
        If OCCT cannot move the faces of `body` inwards, there are more than 5 000 struts or 60 000
        facets, struts overlap and are refused, the skin around a void of `body` hangs loose, or
        OCCT cannot unite struts and skin wherever the lattice is put.
    MissingBackendError
        If build123d or manifold3d is not installed.

    Examples
    --------
    >>> from build123d import Box
    >>> from scaffold_cad.filling import lattice_solid
    >>> part = lattice_solid(Box(16, 16, 16), "bcc", 8.0, 0.6, skin=1.5)
    >>> part.is_valid, len(part.shells())
    (True, 2)
    """
    make = maker(section=section, **options)
    hollow = hollow_solid(body, skin)
    region = as_region(hollow.surface)
    reaching = lattice_reaching(region, cell, size, radius, skin, origin=origin, axes=axes, on=on)
    return filled_solid(hollow, reaching, make, overlaps).solid


@checks_keywords(round_struts)
def strut_solid(
    body: Shape,
    struts: Skeleton,
    *,
    skin: float,
    section: Section = "round",
    overlaps: Overlaps = "refuse",
    **options: Unpack[RoundOptions],
) -> Solid:
    """Return `body` with a skin, and struts for its inside, as one build123d solid.

    Those that have a part in the body are cut where they meet the skin: they are best made larger
    than the body. The rest is as for `lattice_solid`.

    Parameters
    ----------
    struts : such as a foam or your own, where the body is
    body, skin, section, overlaps, **options : as for `lattice_solid`

    Raises
    ------
    OptionError, BrepError, MissingBackendError
        As `lattice_solid` does.
    SkeletonError
        If no strut is in the body.

    Examples
    --------
    >>> from build123d import Box
    >>> from scaffold_cad import Skeleton, strut_solid
    >>> cross = Skeleton([[-9, 0, 0], [9, 0, 0], [0, 0, -9], [0, 0, 9]], [[0, 1], [2, 3]], 1)
    >>> part = strut_solid(Box(16, 16, 16), cross.joined(1e-6), skin=1.5)
    >>> part.is_valid, len(part.shells())
    (True, 2)
    """
    make = maker(section=section, **options)
    hollow = hollow_solid(body, skin)
    reaching = skeleton_reaching(as_region(hollow.surface), struts, skin)
    return filled_solid(hollow, reaching, make, overlaps).solid


def hollow_solid(body: Shape, skin: float) -> HollowSolid:
    """Return a body and what is inside its skin, before anything is put there.

    Raises
    ------
    OptionError
        If `skin` is out of its range or fills the body, or `body` is not one solid.
    BrepError
        If OCCT cannot move the faces of the body inwards.
    """
    thickness = as_number(skin, "skin")
    solid = _one_solid(body)
    outer = brep.tessellated(solid)
    check_seen(outer, skin=thickness)
    return HollowSolid(solid, outer, *_hollow(solid, outer, thickness))


def filled_solid(
    hollow: HollowSolid, struts: Reaching, make: Make, overlaps: Overlaps = "refuse"
) -> FilledSolid:
    """Return a body with struts for its inside, whose skin is made already; see `lattice_solid`."""
    if overlaps == "allow":
        raise OptionError("overlaps is 'allow' with a skin; need 'refuse' or 'unite'")
    fault = ""
    for nudge in NUDGES:
        skeleton = struts(nudge)
        _check_count(len(skeleton.edges))
        model = make(skeleton)
        fault, made = _united(hollow, model, overlaps)
        if made is not None:
            return FilledSolid(made, model)
        _log.info("with the lattice moved by %g cells %s", nudge, fault)
    raise BrepError(f"OCCT cannot unite the struts with the skin: {fault}; {_MESH}")


def _check_count(count: int) -> None:
    """Raise if OCCT cannot cut so many struts in minutes."""
    if count > MOST_STRUTS:
        raise BrepError(
            f"the body has {count} struts, for which OCCT takes some "
            f"{STRUT_TIME * count / 60:.0f} minutes if it ends at all; need {MOST_STRUTS} or "
            f"fewer, such as larger cells ({_MESH})"
        )


def _check_facets(count: int) -> None:
    """Raise if OCCT cannot cut so many facets in minutes."""
    if count > MOST_FACETS:
        raise BrepError(
            f"the union of struts that overlap has {counted(count, 'face')}, for which OCCT takes "
            f"some {FACET_TIME * count / 60:.0f} minutes; need {MOST_FACETS} or fewer, such as "
            f"fewer struts that overlap ({_MESH})"
        )


def _tell_time(hollow: HollowSolid, struts: Skeleton, frame: Shape, *, meshed: bool) -> None:
    """Log what OCCT takes to cut struts.

    Parameters
    ----------
    frame : their faces
    meshed : whether it also makes triangles of them
    """
    facets, others = _flat_and_curved(frame)
    skin = [sum(face.area for face in faces) for faces in _flat_and_curved(hollow.inner)]
    crossed, _ = MeshRegion(hollow.surface).crossings(struts.nodes, struts.edges)
    seconds = FACET_TIME * len(facets) + (FACE_TIME + MESH_TIME * meshed) * len(others)
    seconds += CURVED_TIME * len(np.unique(crossed)) * skin[1] / sum(skin)
    text = counted(len(struts.edges), "strut"), counted(len(facets) + len(others), "face")
    _log.info("OCCT takes some %g s for %s of %s", float(f"{seconds:.2g}"), *text)


def _flat_and_curved(shape: Shape) -> tuple[list[Face], list[Face]]:
    """Return the faces of a shape that are plane, and the others."""
    parts: tuple[list[Face], list[Face]] = [], []
    for face in shape.faces():
        parts[face.geom_type.name != "PLANE"].append(face)
    return parts


def _one_solid(body: Shape) -> Solid:
    """Return the only solid of a build123d shape."""
    need("build123d", "a B-rep")
    body = built(body)
    if not callable(getattr(body, "solids", None)):
        raise OptionError(f"the body is a {type(body).__name__}; need a build123d solid ({_MESH})")
    solids = body.solids()
    if len(solids) != 1:
        raise OptionError(f"the body has {len(solids)} solids; need one at a time")
    solid: Solid = solids[0]
    return solid


def _hollow(solid: Solid, outer: TriangleMesh, skin: float) -> tuple[Solid, Manifold]:
    """Return what is inside the skin of a solid, and its triangles.

    OCCT's result is looked at: where rounds are tighter than the skin, it may be anything.
    """
    region, surface = MeshRegion(outer), NearestPlace(evened(outer))
    low, high = region.bounds
    points = low + np.random.default_rng(0).uniform(size=(SAMPLES, 3)) * (high - low)
    points = points[region.contains(points)]
    depth = np.linalg.norm(surface.nearest(points) - points, axis=1)
    if not (depth > skin).any():
        raise OptionError(f"skin is {skin:g} mm, which fills the body; need less")
    for inner in brep.moved_inwards(solid, skin):
        mesh = brep.tessellated(inner, FINE_ANGLE, coarser=FINE)
        within = MeshRegion(mesh).contains(points)
        wrong = np.where(within, depth < THINNER * skin, depth > skin / THINNER)
        if wrong.mean() <= MISPLACED:
            return inner, manifolds.to_manifold(mesh)
    raise BrepError(
        f"OCCT cannot move the faces of the body inwards by {skin:g} mm, as where rounds are "
        f"tighter than that; need a thinner skin, or larger rounds ({_MESH})"
    )


def _united(hollow: HollowSolid, model: Model, overlaps: Overlaps) -> tuple[str, Solid | None]:
    """Return what is wrong, and the part if nothing is."""
    inner, inside = hollow.inner, hollow.inside
    edges = model.overlapping if isinstance(model, RoundStruts) else model.embedding().left_out
    if len(edges) and overlaps == "refuse":
        raise BrepError(
            f"{described(edges, model.skeleton)}: faces would cross; need struts apart (smaller "
            "radii, larger cells, fewer joints), or overlaps='unite' for their union, with plane "
            f"facets where they overlap ({_MESH})"
        )
    try:
        frame = to_brep(model, overlaps=overlaps)
    except BrepError as error:
        raise BrepError(f"{error} ({_MESH})") from None
    if len(edges):
        _check_facets(len(frame.faces()))
    by_faces = _is_meshed_by_faces(model, united=len(edges) > 0)
    _tell_time(hollow, model.skeleton, frame, meshed=by_faces)
    # Both are what the struts take up inside the skin: of triangles, and of exact faces.
    solid = _of_faces(frame) if by_faces else solidified(model).manifold
    left = (inside - solid).volume()
    wanted = inside.volume() - left
    if left < OFF * wanted:
        raise BrepError(f"the struts fill the body; need thinner ones, or larger cells ({_MESH})")
    voids = brep.without(inner, frame.solids())
    if not voids:
        return "nothing is left of the void between them", None
    found = inner.volume - sum(void.volume for void in voids)
    if abs(found - wanted) > OFF * wanted:
        return f"the struts inside the skin get {found:.6g} mm³ and not {wanted:.6g}", None
    part, loose = brep.with_voids(hollow.solid, voids)
    if not part.is_valid:
        return "the solid is not valid", None
    if loose and len(hollow.solid.shells()) > 1:
        return "a piece hangs loose between them, such as the skin around a void of the body", None
    if loose:
        _log.info("%s of struts left out: the skin is out of their reach", counted(loose, "piece"))
    return "", part


def _is_meshed_by_faces(model: Model, *, united: bool) -> bool:
    """Return whether triangles of struts that have the volume of their faces are made of these.

    Polygons of round struts have their circles' volume; walls of few sides have more, and bilinear
    faces of square struts need more than two triangles.
    """
    return not isinstance(model, RoundStruts) or model.inner is not None or united


def _of_faces(frame: Shape) -> Manifold:
    """Return struts as triangles that are near to their faces."""
    return manifolds.to_manifold(brep.tessellated(frame, WALL_ANGLE))
