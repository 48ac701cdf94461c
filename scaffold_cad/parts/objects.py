"""Part objects of build123d: solids around skeletons, frames, and lattices.

Imports build123d: `scaffold_cad.parts` does so when one of the classes is asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from build123d import Align, tuplify
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_real, check_kind, checks_keywords
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import Keep
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import fill
from scaffold_cad.filling.parts import flush_box
from scaffold_cad.filling.solids import Section, filled_solid
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.mesh import QuadMesh
from scaffold_cad.parts.models import Model, model_of
from scaffold_cad.parts.skeletonpart import CommonOptions, PartOptions, SkeletonPart
from scaffold_cad.parts.stubs import without_overlapping_stubs
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.facets import faceted
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import frame_skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.struts import RoundStruts, round_struts

if TYPE_CHECKING:
    from typing_extensions import Unpack

_Kind = TypeVar("_Kind")

ALIGNED = {Align.MIN: 0.0, Align.CENTER: 0.5, Align.MAX: 1.0, Align.NONE: 0.0}
"""Where the origin is in a box, as a fraction of its size."""

FLUSH_SIDES = 8
"""Sides of round struts that are cut flush: each of their triangles becomes a face."""


class ScaffoldSolid(SkeletonPart):
    """The coarse solid around a skeleton: one face a quad of its scaffold.

    Each extremity has a `RigidJoint` "extremity 7", named after its node: z leaves the strut, x
    points to the middle of a side of its section.

    Examples
    --------
    >>> from scaffold_cad import ScaffoldSolid, Skeleton
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> solid = ScaffoldSolid(strut, label="pin")
    >>> round(solid.volume, 6), sorted(solid.joints)
    (36.0, ['extremity 0', 'extremity 1'])
    """

    @checks_keywords(SkeletonPart.__init__, build_scaffold)
    def __init__(
        self,
        skeleton: Skeleton | Scaffold,
        *,
        overlaps: Overlaps = "refuse",
        with_joints: bool = True,
        **options: Any,
    ) -> None:
        """Build the solid.

        Parameters
        ----------
        skeleton : or a scaffold, as it was built
        overlaps : what becomes of struts that overlap, see `to_brep`
        with_joints : whether extremities get joints
        **options : label, color, rotation, align and mode, see `PartOptions`; and those of
            `build_scaffold`, for a skeleton

        Raises
        ------
        SkeletonError
            If the skeleton cannot be scaffolded.
        BrepError
            If struts overlap and are refused, or their union has too many triangles.
        """
        part = _part_options(options)
        scaffold = _made(skeleton, Scaffold, build_scaffold, options)
        super().__init__(
            to_brep(scaffold, overlaps=overlaps),
            scaffold,
            with_joints=with_joints,
            **part,
        )


class RoundStrutsSolid(SkeletonPart):
    """Round struts around a skeleton: cylinders and cones on its edges, blends at its nodes.

    It has the joints of a `ScaffoldSolid`, each in the center of a strut's last circle.

    Examples
    --------
    >>> from scaffold_cad import RoundStrutsSolid, Skeleton
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round(RoundStrutsSolid(strut).volume, 3)
    28.274
    """

    @checks_keywords(SkeletonPart.__init__, round_struts)
    def __init__(
        self,
        skeleton: Skeleton | RoundStruts,
        *,
        overlaps: Overlaps = "refuse",
        with_joints: bool = True,
        **options: Any,
    ) -> None:
        """Build the solid.

        Parameters
        ----------
        skeleton : or round struts, as they were made
        overlaps : what becomes of struts that overlap, see `to_brep`
        with_joints : whether extremities get joints
        **options : label, color, rotation, align and mode, see `PartOptions`; and those of
            `round_struts`, for a skeleton

        Raises
        ------
        SkeletonError
            If the skeleton cannot be built on.
        BrepError
            If struts overlap and are refused, or their union has too many triangles.
        """
        part = _part_options(options)
        struts = _made(skeleton, RoundStruts, round_struts, options)
        super().__init__(
            to_brep(struts, overlaps=overlaps), struts, with_joints=with_joints, **part
        )


class StrutFrame(SkeletonPart):
    """The edges of a skeleton, a scaffold or a quad mesh as struts of one radius.

    Joints are at the extremities of the skeleton, and of a scaffold's skeleton.

    Examples
    --------
    >>> from scaffold_cad import StrutFrame, Skeleton
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round(StrutFrame(strut, radius=0.5).volume, 6)
    9.0
    """

    @checks_keywords(SkeletonPart.__init__)
    def __init__(
        self,
        what: Skeleton | Scaffold | QuadMesh,
        radius: Radius,
        *,
        section: Section = "square",
        overlaps: Overlaps = "refuse",
        with_joints: bool = True,
        **options: Unpack[PartOptions],
    ) -> None:
        """Build the frame.

        Parameters
        ----------
        what : whose edges
        radius : of the struts, mm; one number, or a function of positions (n, 3) that returns (n,)
        section : "square", or "round" for round struts, see `round_struts`
        overlaps : what becomes of struts that overlap, see `to_brep`
        with_joints : whether extremities get joints
        **options : label, color, rotation, align and mode, see `PartOptions`

        Raises
        ------
        OptionError
            If the radius is not a finite number > 0.
        BrepError
            If struts overlap and are refused, or their union has too many triangles.
        """
        frame = model_of(frame_skeleton(what, radius), section)
        super().__init__(
            to_brep(frame, overlaps=overlaps),
            what if isinstance(what, Scaffold) else frame,
            with_joints=with_joints,
            **options,
        )


class LatticeBox(SkeletonPart):
    """A box of lattice: the axes of its struts fill a box, and the struts are around them.

    It lines up with build123d's `Box` of the same size and `align`; what is in its sides stands
    out, struts by their radius and nodes by more.

    Examples
    --------
    >>> from scaffold_cad import LatticeBox
    >>> box = LatticeBox("bcc", 8.0, 8, 8, 8, radius=0.5)
    >>> len(box.skeleton.edges), box.is_valid
    (8, True)
    """

    @checks_keywords(SkeletonPart.__init__)
    def __init__(
        self,
        cell: str | UnitCell,
        size: ArrayLike,
        length: float,
        width: float,
        height: float,
        radius: Radius,
        *,
        keep: Keep = "clip",
        dangling: bool = True,
        drop_stubs: bool = True,
        axes: ArrayLike | None = None,
        on: CellMap | None = None,
        trim: bool = False,
        section: Section = "square",
        overlaps: Overlaps = "refuse",
        with_joints: bool = False,
        align: Any = (Align.CENTER, Align.CENTER, Align.CENTER),
        **options: Unpack[CommonOptions],
    ) -> None:
        """Build the lattice.

        Parameters
        ----------
        cell : a unit cell or its name, see `cells`
        size : of one cell, mm: three numbers, or one
        length, width, height : of the box, mm
        radius : of the struts, mm; one number, or a function of positions (n, 3) in the box before
            it is rotated and placed, that returns (n,)
        keep, dangling, axes, on : what becomes of struts that the box cuts, how cells are turned,
            and a map that they are put on, see `fill`
        drop_stubs : whether struts that end free and overlap others are left out, unless they are
            united
        section : "square", or "round" for round struts, see `round_struts`
        trim : whether the struts' solids are cut flush with the box, so that the part measures
            `length` x `width` x `height`; struts that overlap are then united, and the faces are
            triangles
        overlaps : what becomes of struts that overlap, see `to_brep`
        with_joints : whether extremities get joints
        align : of the box, as of build123d's `Box`
        **options : label, color, rotation and mode, see `CommonOptions`

        Raises
        ------
        OptionError
            If an argument is out of its range.
        BrepError
            If struts overlap and are refused, more than a fifth of them would be left out as stubs,
            or their union has too many triangles.
        """
        sides = np.array([as_real(side, "a side of the box") for side in (length, width, height)])
        if not (np.isfinite(sides) & (sides > 0)).all():
            raise OptionError(f"the box is {length:g} x {width:g} x {height:g} mm; need > 0")
        low = -sides * [ALIGNED[one] for one in tuplify(align, 3) or [Align.NONE] * 3]
        bounds = np.stack([low, low + sides])
        skeleton = fill(bounds, cell, size, radius, keep=keep, dangling=dangling, axes=axes, on=on)
        if trim:
            lattice = model_of(skeleton, "square")
            flush = FLUSH_SIDES if section == "round" else 4
            trimmed = flush_box(bounds, cell, size, radius, axes=axes, on=on, sides=flush)
            body = faceted(manifold_triangles(trimmed))
        else:
            lattice = _lattice(skeleton, section, drop_stubs and overlaps == "refuse")
            body = to_brep(lattice, overlaps=overlaps)
        super().__init__(
            body,
            lattice,
            with_joints=with_joints,
            **options,
        )


class LatticeFill(SkeletonPart):
    """The struts of a lattice that are inside a part, cut where their axes leave it.

    The ends of slanted struts stand out of the part by up to their radius: `LatticeFill(...) &
    part` trims them, slowly. With `skin` the result is the part itself with a closed wall, see
    `lattice_solid`; `lattice_part` makes it of triangles.

    Examples
    --------
    >>> from build123d import Cylinder
    >>> from scaffold_cad import LatticeFill
    >>> core = LatticeFill(Cylinder(20, 8), "bcc", 8.0, radius=0.5, keep="whole")
    >>> core.is_valid
    True
    """

    @checks_keywords(SkeletonPart.__init__)
    def __init__(
        self,
        part: Any,
        cell: str | UnitCell,
        size: ArrayLike,
        radius: Radius,
        *,
        keep: Keep = "clip",
        dangling: bool = True,
        drop_stubs: bool = True,
        origin: ArrayLike | None = None,
        axes: ArrayLike | None = None,
        on: CellMap | None = None,
        skin: float | None = None,
        section: Section = "square",
        overlaps: Overlaps = "refuse",
        with_joints: bool = False,
        **options: Unpack[PartOptions],
    ) -> None:
        """Build the lattice.

        Parameters
        ----------
        part : a build123d solid, or another region that `fill` knows
        cell : a unit cell or its name, see `cells`
        size : of one cell, mm: three numbers, or one
        radius : of the struts, mm; one number, or a function of positions (n, 3) that returns (n,)
        keep, dangling, origin, axes, on : see `fill`
        drop_stubs : whether struts that end free and overlap others, as cut ones do, are left out,
            unless they are united
        skin : thickness of a closed wall at the part's surface, mm; none by default. The struts are
            then whole up to it: `keep`, `dangling`, `drop_stubs` and `overlaps` are for none
        section : "square", or "round" for round struts, see `round_struts`
        overlaps : what becomes of struts that overlap, see `to_brep`
        with_joints : whether extremities get joints
        **options : label, color, rotation, align and mode, see `PartOptions`

        Raises
        ------
        OptionError
            If an argument is out of its range.
        SkeletonError
            If no strut is in the part.
        BrepError
            If OCCT cannot make the skin or unite struts with it, see `lattice_solid`; if struts
            overlap and are refused, more than a fifth of them would be left out as stubs,
            or their union has too many triangles.
        """
        if skin is not None:
            if (keep, dangling, overlaps) != ("clip", True, "refuse"):
                raise OptionError(
                    "keep, dangling or overlaps is given with a skin; need none of them"
                )
            filled = filled_solid(part, cell, size, radius, skin, section, origin, axes, on)
            body, lattice = filled.solid, filled.struts
        else:
            skeleton = fill(
                part,
                cell,
                size,
                radius,
                keep=keep,
                dangling=dangling,
                origin=origin,
                axes=axes,
                on=on,
            )
            lattice = _lattice(skeleton, section, drop_stubs and overlaps == "refuse")
            body = to_brep(lattice, overlaps=overlaps)
        super().__init__(body, lattice, with_joints=with_joints, **options)


def _part_options(options: dict[str, Any]) -> PartOptions:
    """Take those of every part out of `options`, and return them."""
    names = options.keys() & PartOptions.__annotations__.keys()
    taken = {name: options.pop(name) for name in names}
    return cast("PartOptions", taken)


def _made(
    what: Any, kind: type[_Kind], make: Callable[..., _Kind], options: dict[str, Any]
) -> _Kind:
    """Return what is made of a skeleton, or what is of that kind already.

    Raises
    ------
    OptionError
        If it is neither, or options are given for what is made.
    """
    check_kind(what, Skeleton, kind)
    if isinstance(what, Skeleton):
        return make(what, **options)
    if options:
        raise OptionError(
            f"{', '.join(options)} given for a {kind.__name__} that is made; need a Skeleton"
        )
    made: _Kind = what
    return made


def _lattice(skeleton: Skeleton, section: Section, drop_stubs: bool) -> Model:
    """Return the struts of a lattice, without stubs that overlap if asked."""
    if drop_stubs:
        return without_overlapping_stubs(skeleton, section)
    return model_of(skeleton, section)
