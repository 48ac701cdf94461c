"""What can be asked of round struts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, check_choice, described
from scaffold_cad.base.arrays import Floats, Ints, Points, as_floats, place_text, read_only
from scaffold_cad.errors import OptionError

Ends: TypeAlias = Literal["flat", "round", "open"]
"""How struts end at extremities: a plane disc, a hemisphere, or, with a wall, a plane ring."""

Joints: TypeAlias = Literal["auto", "curve", "blend"]
"""How struts pass joints: on a curve through their nodes, or as a bend with a fillet between two
exact cylinders; by default as `scaffold_cad.struts.curves.joints` tells one from the other."""

Nodes: TypeAlias = Literal["blend", "ball", "sharp"]
"""What is at nodes: patches that blend the struts' surfaces; a ball that these end at; or these
themselves up to the edges in which they meet."""

Bend: TypeAlias = float | Literal["blend", "torus"]
"""How two cylinders of one radius meet: with a blend, or as an exact torus; a number is the radius
of its centerline, mm."""

BLEND = 0.5
"""Fillet radius when none is given, in radii of the thinnest strut of the node."""

BLENDS = ", one for each node, or a function of positions (n, 3) that returns them"
"""What else `blend` may be, for messages."""

SHARP = 0.1
"""Fillet radius of sharp nodes without a surface of their own, in radii of the thinnest strut."""

Blend: TypeAlias = float | ArrayLike | Callable[[Points], ArrayLike]
"""Fillet radius, mm: one number, one for each node (n,), or a function of positions (n, 3)."""


@dataclass(frozen=True)
class StrutOptions:
    """How round struts are made, see `round_struts`."""

    blend: float | Floats | None = None
    """Fillet radius of all nodes, or of each, shape (n,), mm; None for half the radius of each
    node's thinnest strut."""
    ends: Ends = "flat"
    """How struts end."""
    wall: float | None = None
    """Thickness of the wall of hollow struts, mm; None for solid ones."""
    joints: Joints = "auto"
    """How struts pass joints of two edges."""
    bend: Bend = "blend"
    """How bends are made that are not of a curve."""
    sockets: Mapping[int, tuple[float, float]] | None = None
    """Inner radius and depth of sockets, mm, by the extremity at which they are."""
    nodes: Nodes = "blend"
    """What is at nodes."""

    def __post_init__(self) -> None:
        if self.blend is not None and np.ndim(self.blend) == 0:
            _number(self.blend, BLENDS)
        check_choice(self.ends, "ends", ("flat", "round", "open"))
        check_choice(self.joints, "joints", get_args(Joints))
        if isinstance(self.bend, str):
            check_choice(self.bend, "bend", ("blend", "torus"), or_else="a radius in mm")
        else:
            as_number(self.bend, "bend", hint=", 'blend' or 'torus'")
        check_choice(self.nodes, "nodes", get_args(Nodes))
        if self.is_sharp:
            self._check_sharp()
        if self.wall is not None:
            as_number(self.wall, "wall")
        elif self.ends == "open":
            raise OptionError("ends is 'open' without a wall; need wall=, mm, or ends='flat'")
        _check_sockets(self.sockets)
        if self.sockets and self.ends != "open":
            raise OptionError(f"sockets with ends={self.ends!r}; need ends='open', and a wall")

    @property
    def is_sharp(self) -> bool:
        """Whether nodes have edges: all but blends."""
        return self.nodes != "blend"

    def _check_sharp(self) -> None:
        """Raise if something is asked for that sharp nodes do not have."""
        asked = {"blend": self.blend, "joints": self.joints, "bend": self.bend}
        usual = {"blend": None, "joints": "auto", "bend": "blend"}
        for name, value in asked.items():
            if value is not usual[name] and not (isinstance(value, str) and value == usual[name]):
                raise OptionError(
                    f"{name} is given with nodes={self.nodes!r}, whose struts meet in edges; need "
                    f"no {name}="
                )

    def blends(self, nodes: Ints, thin: Floats) -> Floats:
        """Return the fillet radius asked for at nodes, of any one shape, mm.

        Parameters
        ----------
        thin : radius of the thinnest strut of each
        """
        if self.is_sharp:
            return SHARP * thin
        if self.blend is None:
            return BLEND * thin
        given = np.asarray(self.blend, dtype=np.float64)
        return np.full(thin.shape, given) if given.ndim == 0 else given[nodes]


def _number(blend: object, hint: str) -> float:
    """Return the one fillet radius of all nodes."""
    if blend == 0:
        raise OptionError("blend is 0 mm; need > 0, or nodes='sharp' for edges without a fillet")
    return as_number(blend, "blend", hint=hint)


def _check_sockets(sockets: object) -> None:
    """Raise unless sockets are None or pairs of a radius and a depth by nodes."""
    if sockets is None:
        return
    need = "need a radius and a depth, mm, by the node, as in {3: (14.375, 25)}"
    if not isinstance(sockets, Mapping):
        raise OptionError(f"sockets is {described(sockets)}; {need}")
    for node, size in sockets.items():
        if isinstance(node, bool) or not isinstance(node, int | np.integer):
            raise OptionError(f"sockets has {described(node)} for a node; {need}")
        if np.shape(size) != (2,):
            raise OptionError(f"the socket at node {node} is {described(size)}; {need}")
        for value, what in zip(size, ("radius", "depth"), strict=True):
            as_number(value, f"the {what} of the socket at node {node}")


def as_blend(blend: Blend | None, nodes: Points) -> float | Floats | None:
    """Return fillet radii as a number or one for each of the nodes (n, 3).

    Raises
    ------
    OptionError
        If there are more or fewer, or one is not > 0; its node is named.
    """
    there = blend(nodes) if callable(blend) else blend
    if there is None or np.ndim(there) == 0:
        return None if there is None else _number(there, "" if callable(blend) else BLENDS)
    given = as_floats(there, "blend", OptionError)
    if given.shape != (len(nodes),):
        raise OptionError(f"blend has shape {given.shape}; need one number, or ({len(nodes)},), mm")
    bad = np.flatnonzero(~(np.isfinite(given) & (given > 0)))
    if len(bad):
        place = place_text(nodes[bad[0]])
        raise OptionError(f"blend of node {bad[0]} at {place} is {given[bad[0]]:g} mm; need > 0")
    return read_only(given)
