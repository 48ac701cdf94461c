"""Part objects of build123d that are lattices: a box of cells, and a part filled with them.

Imports build123d: `scaffold_cad.parts` does so when one of the classes is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from build123d import Align, Shape, tuplify
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.base.placements import AxesLike, PositionLike
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import Keep
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import fill
from scaffold_cad.filling.fill import as_region
from scaffold_cad.filling.flush import flush_box
from scaffold_cad.filling.models import maker
from scaffold_cad.filling.reaching import lattice_reaching
from scaffold_cad.filling.solids import filled_solid, hollow_solid
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.parts.placing import as_align
from scaffold_cad.parts.skeletonpart import (
    BoxOptions,
    FrameOptions,
    PartOptions,
    SkeletonPart,
    part_options,
    strut_options,
)
from scaffold_cad.parts.stubs import without_overlapping_stubs
from scaffold_cad.products.facets import faceted
from scaffold_cad.products.models import Make, Model
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.struts import round_struts

if TYPE_CHECKING:
    from typing_extensions import Unpack

ALIGNED = {Align.MIN: 0.0, Align.CENTER: 0.5, Align.MAX: 1.0, Align.NONE: 0.0}
"""Where the origin is in a box, as a fraction of its size."""

FLUSH_SIDES = 8
"""Sides of round struts that are cut flush: each of their triangles becomes a face."""


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

    @checks_keywords(SkeletonPart.__init__, maker, round_struts)
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
        axes: AxesLike | None = None,
        on: CellMap | None = None,
        trim: bool = False,
        align: Any = (Align.CENTER, Align.CENTER, Align.CENTER),
        **options: Unpack[BoxOptions],
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
        trim : whether the struts' solids are cut flush with the box, so that the part measures
            `length` x `width` x `height`; struts that overlap are then united, and the faces are
            triangles
        align : of the box, as of build123d's `Box`
        **options : overlaps, with_joints (False by default), label, color, rotation and mode, see
            `CommonOptions`; `section="round"` for round struts, and then those of `round_struts`

        Raises
        ------
        OptionError
            If an argument is out of its range.
        BrepError
            If struts overlap and are refused, more than a fifth of them would be left out as stubs,
            or their union has too many triangles.
        """
        struts, part = strut_options(options), part_options(options)
        make = maker(**struts)
        named = {"length": length, "width": width, "height": height}
        sides = np.array([as_number(side, name) for name, side in named.items()])
        low = -sides * [ALIGNED[one] for one in tuplify(as_align(align), 3) or [Align.NONE] * 3]
        bounds = np.stack([low, low + sides])
        skeleton = fill(bounds, cell, size, radius, keep=keep, dangling=dangling, axes=axes, on=on)
        if trim:
            lattice = maker()(skeleton)  # its skeleton alone is asked for
            flush = FLUSH_SIDES if struts.get("section") == "round" else 4
            given: dict[str, Any] = {name: struts[name] for name in struts if name != "section"}  # type: ignore[literal-required]
            trimmed = flush_box(bounds, cell, size, radius, axes=axes, on=on, sides=flush, **given)
            body: Shape | Model = faceted(manifold_triangles(trimmed))
        else:
            body = lattice = _lattice(skeleton, make, drop_stubs, part)
        part.setdefault("with_joints", False)
        super().__init__(body, lattice, **part)


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

    @checks_keywords(SkeletonPart.__init__, maker, round_struts)
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
        origin: PositionLike | None = None,
        axes: AxesLike | None = None,
        on: CellMap | None = None,
        skin: float | None = None,
        **options: Unpack[FrameOptions],
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
            then whole up to it: `keep`, `dangling` and `drop_stubs` are for none
        **options : overlaps, with_joints (False by default), label, color, rotation, align and
            mode, see `PartOptions`; `section="round"` for round struts, and then those of
            `round_struts`

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
        make, own = maker(**strut_options(options)), part_options(options)
        if skin is not None:
            if (keep, dangling) != ("clip", True):
                raise OptionError("keep or dangling is given with a skin; need neither")
            hollow = hollow_solid(part, skin)
            reaching = lattice_reaching(
                as_region(hollow.surface),
                cell,
                size,
                radius,
                skin,
                origin=origin,
                axes=axes,
                on=on,
            )
            filled = filled_solid(hollow, reaching, make, _overlaps(own))
            body: Shape | Model = filled.solid
            lattice: Model = filled.struts
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
            body = lattice = _lattice(skeleton, make, drop_stubs, own)
        own.setdefault("with_joints", False)
        super().__init__(body, lattice, **own)


def _overlaps(options: PartOptions) -> Overlaps:
    return options.get("overlaps", "refuse")


def _lattice(skeleton: Skeleton, make: Make, drop_stubs: bool, options: PartOptions) -> Model:
    """Return the struts of a lattice, without stubs that overlap if asked and not united."""
    if drop_stubs and _overlaps(options) == "refuse":
        return without_overlapping_stubs(skeleton, make)
    return make(skeleton)
