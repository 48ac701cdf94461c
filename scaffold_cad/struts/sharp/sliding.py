"""Points that slide along the edges of a sharp shape until none of its triangles is turned over.

Triangles that are less than a part of what they were, as the node sees them, lack the rest. The sum
of its squares falls in steps of Levenberg and Marquardt.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.struts.sharp.strands import Strands
from scaffold_cad.struts.sharp.triangles import seen_areas

WANTED, ENOUGH = 0.1, 0.002
"""Parts of their areas that triangles are to have, and have at least."""

FLAT = 1e-12
"""Least area that counts for what a triangle had, in squares of the distance from the node."""

STEPS = 60
"""Steps at most."""

DAMPING, CHANGE = 1e-4, 10.0
"""Least damping, as a part of the sum of the squares of slopes, and how it grows and falls."""

ASIDE = 1e-6
"""Angle on their curve to each side of points between which slopes are taken, rad."""


@dataclass(frozen=True, eq=False)
class OnStrands(Frozen):
    """Triangles of a shape, the first of whose points are on strands."""

    strands: Strands
    strand: Ints
    """Strand of each of the first points, shape (f,)."""
    points: Points
    """All points, as they are before the first of them slide, shape (p, 3)."""
    triangles: Triangles
    """Shape (t, 3)."""
    areas: Floats
    """What they had when they were made, shape (t,)."""

    def slid(self, share: Floats) -> Floats | None:
        """Return shares (f,), changed as far as it takes, or None where that is not enough."""
        free = np.flatnonzero(self.strands.corner(self.strand, share) < 0)
        endless = self.strands.corners[self.strand[free], 0] < 0
        lack, damping = self._lack(share), DAMPING
        for _ in range(STEPS):
            if lack.max(initial=0.0) <= WANTED - ENOUGH:
                return share
            short = np.flatnonzero(lack > 0)
            slopes = self._slopes(share, short)[:, free]
            square = slopes @ slopes.T
            heavy = damping * max(float(np.trace(square)), FLAT) * np.eye(len(short))
            turn = np.zeros(len(share))
            turn[free] = -slopes.T @ np.linalg.solve(square + heavy, lack[short])
            tried = share + turn / self.strands.span[self.strand]
            found = self._lack(tried)
            stays = endless | ((tried[free] > 0.0) & (tried[free] < 1.0))
            if stays.all() and _squares(found) < _squares(lack):
                share, lack, damping = tried, found, max(damping / CHANGE, DAMPING)
            else:
                damping *= CHANGE
        return None

    def _lack(self, share: Floats) -> Floats:
        """Return what triangles lack at shares (f,), as parts of what they had, (t,)."""
        every = self.points.copy()
        every[: len(share)] = self.strands.points(self.strand, share)
        return WANTED - seen_areas(every, self.triangles) / np.maximum(self.areas, FLAT)

    def _slopes(self, share: Floats, rows: Ints) -> Floats:
        """Return how what some triangles lack grows with the angles of points, (r, f)."""
        every, aside = self.points.copy(), ASIDE / self.strands.span[self.strand]
        low, here, high = (
            normalize(self.strands.points(self.strand, share + side * aside)) for side in (-1, 0, 1)
        )
        every[: len(share)], ahead = here, (high - low) / (2 * ASIDE)
        found = np.zeros((len(rows), len(share)))
        for corner in range(3):
            a, b, c = np.roll(self.triangles[rows], -corner, axis=1).T
            own = np.flatnonzero(a < len(share))
            across = np.cross(normalize(every[b[own]]), normalize(every[c[own]]))
            found[own, a[own]] = -dot(across, ahead[a[own]])
        return found / np.maximum(self.areas[rows, None], FLAT)


def _squares(lack: Floats) -> float:
    return float((np.maximum(lack, 0.0) ** 2).sum())
