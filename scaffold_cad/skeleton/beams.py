"""BeamLattice: a skeleton with what else a 3MF beam lattice can say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_choice, check_kind, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, as_floats, as_indices, check_believable
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton.skeleton import Skeleton

CAPS = ("sphere", "hemisphere", "butt")
"""How a beam may end, by the numbers that stand for it."""

BUTT = CAPS.index("butt")

Clipping = Literal["inside", "outside"]
"""Which part of the beams stays: what is inside of the mesh that cuts them, or outside."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class BeamLattice(Frozen):
    """Beams along the edges of a skeleton, for `write` to a 3MF file, and as such files hold them.

    Raises
    ------
    OptionError
        If `skeleton` is not a Skeleton, or `caps` or `clipping` is not known.
    SkeletonError
        If a ball's radius is negative or not finite, or there are not as many as nodes.

    References
    ----------
    3MF Beam Lattice Extension 1.2, with balls.

    Examples
    --------
    >>> from scaffold_cad import BeamLattice, Skeleton
    >>> strut = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 0.5)
    >>> BeamLattice(strut, balls=0.8, caps="butt").caps.tolist()
    [[2, 2]]
    """

    skeleton: Skeleton
    """Its `edge_radii` are those of the beams' ends."""
    balls: Floats
    """Radius of a ball at each node, 0 for none, shape (n,), mm; one number stands for all."""
    clip: Any
    """Closed mesh or solid that the beams are cut at."""
    mesh: Any
    """Closed mesh or solid in the same object as the beams: programs that know no beams show and
    print it alone, others unite the two. A skin, or the solid of the very beams."""
    caps: Ints
    """How both ends of each beam end, shape (m, 2), numbers of `CAPS`: 0 for a sphere around the
    node, 1 for the half of it that leaves the beam, 2 for a flat end."""
    clipping: Clipping
    """Which part of the beams stays, where there is a `clip`."""
    representation: Any
    """Closed mesh or solid that is shown for the beams by programs that cannot show them."""

    def __init__(
        self,
        skeleton: Skeleton,
        balls: ArrayLike = 0.0,
        clip: Any = None,
        mesh: Any = None,
        *,
        caps: str | ArrayLike = "sphere",
        clipping: Clipping = "inside",
        representation: Any = None,
    ) -> None:
        check_kind(skeleton, Skeleton)
        check_choice(clipping, "clipping", ("inside", "outside"))
        self._keep(
            skeleton=skeleton,
            balls=_ball_radii(balls, len(skeleton.nodes)),
            clip=clip,
            mesh=mesh,
            caps=_caps(caps, len(skeleton.edges)),
            clipping=clipping,
            representation=representation,
        )

    def __str__(self) -> str:
        """Return one line: beams, balls, size, radii, and which meshes are beside them."""
        nodes, radii = size_text(self.skeleton.nodes), radii_text(self.skeleton.edge_radii)
        counts = (
            f"{counted(len(self.caps), 'beam')}, {counted(int((self.balls > 0).sum()), 'ball')}"
        )
        beside = [name for name in ("clip", "mesh") if getattr(self, name) is not None]
        more = f", with {' and '.join(beside)}" if beside else ""
        return f"BeamLattice: {counts}, {nodes}, {radii}{more}"


def _caps(values: str | ArrayLike, count: int) -> Ints:
    """Return how each end of `count` beams ends, shape (count, 2), from names or numbers."""
    if isinstance(values, str):
        check_choice(values, "caps", CAPS)
        return np.full((count, 2), CAPS.index(values))
    caps = as_indices(values, "caps", OptionError)
    need = f"need one of {', '.join(CAPS)}, or shape ({count}, 2) of numbers 0, 1 and 2 for them"
    if caps.shape != (count, 2):
        raise OptionError(f"caps has shape {caps.shape}; {need}")
    wrong = np.flatnonzero(((caps < 0) | (caps >= len(CAPS))).any(axis=1))
    if len(wrong):
        raise OptionError(f"beam {wrong[0]} has caps {caps[wrong[0]].tolist()}; {need}")
    return caps


def _ball_radii(values: ArrayLike, count: int) -> Floats:
    """Return the radius of the ball at each of `count` nodes, shape (count,)."""
    balls = as_floats(values, "balls")
    if balls.shape not in {(), (count,)}:
        raise SkeletonError(f"balls has shape {balls.shape}; need a number or shape ({count},)")
    balls = np.array(np.broadcast_to(balls, count))
    bad = np.flatnonzero(~np.isfinite(balls) | (balls < 0))
    if len(bad):
        raise SkeletonError(
            f"the ball at node {bad[0]} has radius {balls[bad[0]]:g} mm; need >= 0 and finite"
        )
    check_believable(balls, "has a ball of radius")
    return balls
