"""The struts that fill bodies and make parts: square scaffolds with collars, or round struts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, TypeAlias, TypedDict, get_args

from scaffold_cad.base.arguments import as_count, check_choice
from scaffold_cad.errors import OptionError
from scaffold_cad.products.models import Make
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.struts import Bend, Ends, Joints, Nodes, RoundStruts, round_struts
from scaffold_cad.struts.options import Blend

if TYPE_CHECKING:
    from typing_extensions import Unpack

Section: TypeAlias = Literal["square", "round"]
"""The section of struts."""


class RoundOptions(TypedDict, total=False):
    """How round struts are made, see `round_struts`."""

    blend: Blend | None
    ends: Ends
    wall: float | None
    joints: Joints
    bend: Bend
    sockets: Mapping[int, tuple[float, float]] | None
    nodes: Nodes
    like: RoundStruts | None


class SectionOptions(RoundOptions, total=False):
    """How struts are made that may be square or round."""

    section: Section
    """ "square" by default, with collars; or "round", which the other options are for."""


def maker(*, section: Section = "square", **options: Unpack[RoundOptions]) -> Make:
    """Return what makes struts of a section.

    Parameters
    ----------
    **options : those of `round_struts`, for round ones

    Raises
    ------
    OptionError
        If there is no such section, or options of round struts are given for square ones.
    """
    check_choice(section, "section", get_args(Section))
    if section == "round":
        return lambda skeleton: round_struts(skeleton, **options)
    if options:
        raise OptionError(
            f"{', '.join(options)} given with section='square'; need section='round', of which "
            f"{'it is' if len(options) == 1 else 'they are'}"
        )
    return lambda skeleton: build_scaffold(skeleton, collars=True)


def sides_of(section: Section | None, sides: int | None) -> int:
    """Return how many sides struts of a section have; 4 are square."""
    if section is None:
        return 4 if sides is None else sides
    check_choice(section, "section", get_args(Section))
    if sides is not None:
        sides = as_count(sides, "sides", 4)
    found = (4 if section == "square" else SIDES) if sides is None else sides
    if (found == 4) != (section == "square"):
        raise OptionError(
            f"sides is {found} for section={section!r}; need 4 for square struts, 8 or more for "
            "round ones"
        )
    return found


def sided_maker(sides: int, **options: Unpack[RoundOptions]) -> Make:
    """Return what makes struts with this number of sides."""
    check_sides(sides)
    if sides == 4 and options:
        raise OptionError(
            f"{', '.join(options)} given with sides=4, square struts; need sides=8 or more, round "
            "ones"
        )
    return maker(section="square" if sides == 4 else "round", **options)
