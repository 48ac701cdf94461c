"""What can be asked of round struts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from scaffold_cad.base.arguments import as_number, check_choice
from scaffold_cad.errors import OptionError

Ends: TypeAlias = Literal["flat", "round", "open"]
"""How struts end at extremities: a plane disc, a hemisphere, or, with a wall, a plane ring."""

Joints: TypeAlias = Literal["auto", "curve", "blend"]
"""How struts pass joints: on a curve through their nodes, or as a bend with a fillet between two
exact cylinders; by default as `scaffold_cad.struts.curvedjoints` tells one from the other."""

BLEND = 0.5
"""Fillet radius when none is given, in radii of the thinnest strut of the node."""


@dataclass(frozen=True)
class StrutOptions:
    """How round struts are made, see `round_struts`."""

    blend: float | None = None
    """Fillet radius of the nodes, mm; None for half the radius of each node's thinnest strut."""
    ends: Ends = "flat"
    """How struts end."""
    wall: float | None = None
    """Thickness of the wall of hollow struts, mm; None for solid ones."""
    joints: Joints = "auto"
    """How struts pass joints of two edges."""
    sockets: Mapping[int, tuple[float, float]] | None = None
    """Inner radius and depth of sockets, mm, by the extremity at which they are."""

    def __post_init__(self) -> None:
        if self.blend is not None:
            as_number(self.blend, "blend")
        check_choice(self.ends, "ends", ("flat", "round", "open"))
        check_choice(self.joints, "joints", get_args(Joints))
        if self.wall is not None:
            as_number(self.wall, "wall")
        elif self.ends == "open":
            raise OptionError("ends is 'open' without a wall; need wall=, mm, or ends='flat'")
        if self.sockets and self.ends != "open":
            raise OptionError(f"sockets with ends={self.ends!r}; need ends='open', and a wall")
