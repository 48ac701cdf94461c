"""Bends: the section at a joint, placed so that the smooth surface turns a corner there.

Sections stand on both sides of the joint, and up to them the limit follows the struts. Seen along
the bend's axis its outer side is to pass the ball at the joint, and its inner side the corner where
the sides of the struts meet. As of a cubic spline, a point of the limit between three sections is
(before + 4 here + after) / 6: that gives the centre and the width of the one in the middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, Radii, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.collars import BLEND
from scaffold_cad.scaffold.sleeves import MITER_LIMIT

COLLARED_STRAY = 0.1
"""Furthest that the limit's axis may pass from a joint of collared struts that gets no sections
beside it, in radii: such struts are to be straight."""

STRAY = 0.5
"""As `COLLARED_STRAY`, without collars: joints may be samples of a curve, and the limit is one."""


@dataclass(frozen=True, eq=False)
class Bends:
    """Joints that get sections on both sides."""

    leaving: Ints
    """The two half-edges that leave each, shape (k, 2)."""
    ways: UnitVectors
    """Their directions, shape (k, 2, 3)."""
    radii: Radii
    """Radius at each joint, shape (k,), mm."""

    @property
    def outward(self) -> UnitVectors:
        """From each joint towards the outer side of its bend, shape (k, 3)."""
        return -normalize(self.ways.sum(axis=1))

    @property
    def cosine(self) -> Floats:
        """Cosine of half the angle between the edges of each, shape (k,)."""
        return length(self.ways.sum(axis=1)) / 2

    @property
    def sine(self) -> Floats:
        """Sine of half the angle between the edges of each, shape (k,)."""
        return length(self.ways[:, 0] - self.ways[:, 1]) / 2

    @property
    def reach(self) -> Floats:
        """How far along the edges sections are clear of the inner corner, shape (k,), mm."""
        reach: Floats = self.radii * (self.cosine / self.sine + BLEND)
        return reach

    def chosen(self, which: Bools) -> Bends:
        """Return those that are `which` (k,)."""
        return Bends(self.leaving[which], self.ways[which], self.radii[which])

    def placed(self, spokes: Floats, depths: Floats) -> tuple[Points, Floats]:
        """Return the sections of the joints: their centres seen from there, and their spokes.

        Parameters
        ----------
        spokes : (k, 4, 3) float64, mm, of "round" sections, widened for the bend
        depths : (k, 2) float64, mm, how far along the edges the sections beside stand

        Returns
        -------
        (k, 3) and (k, 4, 3) float64, mm
        """
        pull = (depths[..., None] * self.ways).sum(axis=1)
        # No further in than the inner sides of the sections beside, where these meet.
        inner = np.minimum(
            self.radii / self.sine, depths.min(axis=1) * self.cosine + self.radii * self.sine
        )
        width = 0.75 * (self.radii + inner) - self.radii * self.sine / 2
        centres = 0.75 * (self.radii - inner)[:, None] * self.outward - pull / 4
        found = self.radii * np.minimum(1 / self.sine, MITER_LIMIT)
        across = self.outward[:, None]
        along = dot(spokes, across)[..., None] * across
        return centres, spokes + (width / found - 1)[:, None, None] * along


def bends_of(scaffold: Scaffold) -> Bends:
    """Return the joints that the limit would pass too far away without sections beside them."""
    refined = scaffold.refined
    leaving = refined.incidence.at_nodes(refined.joints, 2)
    bends = Bends(leaving, refined.directions[leaving], refined.radii[refined.joints])
    # From its control point a cubic spline is a sixth of the way to those beside.
    stray = refined.lengths[leaving >> 1].sum(axis=1) * bends.cosine / 6
    most = COLLARED_STRAY if scaffold.options.collars else STRAY
    return bends.chosen(stray > most * bends.radii)
