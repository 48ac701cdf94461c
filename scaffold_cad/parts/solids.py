"""Part objects of build123d around a given skeleton: square struts, round struts, frames.

Imports build123d: `scaffold_cad.parts` does so when one of the classes is asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.radii import Radius
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.models import maker
from scaffold_cad.mesh import QuadMesh
from scaffold_cad.parts.skeletonpart import FrameOptions, SkeletonPart, part_options, strut_options
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import frame_skeleton
from scaffold_cad.struts import RoundStruts, round_struts

if TYPE_CHECKING:
    from typing_extensions import Unpack

_Kind = TypeVar("_Kind")


class ScaffoldSolid(SkeletonPart):
    """The coarse solid around a skeleton: one face per quad of its scaffold.

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
        **options: Any,
    ) -> None:
        """Build the solid.

        Parameters
        ----------
        skeleton : or a scaffold, as it was built
        **options : overlaps, with_joints, label, color, rotation, align and mode, see
            `PartOptions`; and those of `build_scaffold`, for a skeleton

        Raises
        ------
        SkeletonError
            If the skeleton cannot be scaffolded.
        BrepError
            If struts overlap and are refused, or their union has too many facets.
        """
        part = part_options(options)
        scaffold = _made(skeleton, Scaffold, build_scaffold, options)
        super().__init__(scaffold, scaffold, **part)


class RoundStrutsSolid(SkeletonPart):
    """Round struts around a skeleton: cylinders and cones on its edges, blends at its nodes.

    It has the joints of a `ScaffoldSolid`, each in the center of a strut's last circle: z leaves
    the strut, x is level, and y points upwards; x is that of the skeleton at vertical struts.

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
        **options: Any,
    ) -> None:
        """Build the solid.

        Parameters
        ----------
        skeleton : or round struts, as they were made
        **options : overlaps, with_joints, label, color, rotation, align and mode, see
            `PartOptions`; and those of `round_struts`, for a skeleton

        Raises
        ------
        SkeletonError
            If the skeleton cannot be built on.
        BrepError
            If struts overlap and are refused, or their union has too many facets.
        """
        part = part_options(options)
        struts = _made(skeleton, RoundStruts, round_struts, options)
        super().__init__(struts, struts, **part)


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

    @checks_keywords(SkeletonPart.__init__, maker, round_struts)
    def __init__(
        self,
        what: Skeleton | Scaffold | QuadMesh,
        radius: Radius,
        **options: Unpack[FrameOptions],
    ) -> None:
        """Build the frame.

        Parameters
        ----------
        what : whose edges
        radius : of the struts, mm; one number, or a function of positions (n, 3) that returns (n,)
        **options : overlaps, with_joints, label, color, rotation, align and mode, see
            `PartOptions`; `section="round"` for round struts, and then those of `round_struts`

        Raises
        ------
        OptionError
            If an argument is out of its range, or an option is for round struts only.
        BrepError
            If struts overlap and are refused, or their union has too many facets.
        """
        make = maker(**strut_options(options))
        frame = make(frame_skeleton(what, radius))
        own = part_options(options)
        super().__init__(frame, what if isinstance(what, Scaffold) else frame, **own)


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
