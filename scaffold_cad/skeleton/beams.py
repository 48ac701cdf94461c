"""BeamLattice: a skeleton with what else a 3MF beam lattice can say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Floats, Frozen, as_floats, check_believable
from scaffold_cad.errors import SkeletonError
from scaffold_cad.skeleton.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class BeamLattice(Frozen):
    """Beams along the edges of a skeleton, for `write` to a 3MF file.

    Raises
    ------
    OptionError
        If `skeleton` is none.
    SkeletonError
        If a ball's radius is negative or not finite, or there are not as many as nodes.

    References
    ----------
    3MF Beam Lattice Extension 1.2, with balls.

    Examples
    --------
    >>> from scaffold_cad import BeamLattice, Skeleton
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> BeamLattice(strut, balls=1.5).balls
    array([1.5, 1.5])
    """

    skeleton: Skeleton
    """Its radii are those of the beams' ends, which are spheres."""
    balls: Floats
    """Radius of a ball at each node, 0 for none, shape (n,), mm; one number stands for all."""
    clip: Any
    """Closed mesh or solid outside of which the beams are cut away."""
    mesh: Any
    """Closed mesh or solid in the same object as the beams: programs that know no beams show and
    print it alone, others unite the two. A skin, or the solid of the very beams."""

    def __init__(
        self, skeleton: Skeleton, balls: ArrayLike = 0.0, clip: Any = None, mesh: Any = None
    ) -> None:
        check_kind(skeleton, Skeleton)
        radii = _ball_radii(balls, len(skeleton.nodes))
        self._keep(skeleton=skeleton, balls=radii, clip=clip, mesh=mesh)


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
