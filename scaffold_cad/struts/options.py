"""What can be asked of round struts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from scaffold_cad.base.arguments import as_number, check_choice
from scaffold_cad.errors import OptionError

Ends: TypeAlias = Literal["flat", "round", "open"]
"""How struts end at extremities: a plane disc, a hemisphere, or, with a wall, a plane ring."""

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

    def __post_init__(self) -> None:
        if self.blend is not None:
            as_number(self.blend, "blend")
        check_choice(self.ends, "ends", ("flat", "round", "open"))
        if self.wall is not None:
            as_number(self.wall, "wall")
        elif self.ends == "open":
            raise OptionError("ends is 'open' without a wall; need wall=, mm, or ends='flat'")
