"""Seams: the generator of each strut along which its one face is closed.

A seam ends in a vertex of the ring at either end of its strut. Rings at nodes have four corners,
and those at the two ends of a strut seldom stand at the same angle: then an arc of one ring is
split where the seam from a corner of the other arrives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.vectors import dot
from scaffold_cad.struts.model import RoundStruts

QUARTER = np.pi / 2

SAME = 1e-9
"""Angle at which corners of both rings are one above the other, rad."""

CLOSE = 0.05
"""Angle below which corners are too close together for an arc between them, rad."""


@dataclass(frozen=True, eq=False)
class Seams(Frozen):
    """Where the seams of runs meet the rings of their half-runs."""

    near: Ints
    """Half-run at whose ring the strut's face begins, the thinner one of a cone, shape (k,)."""
    angle: Floats
    """Angle of the seam from x on the ring of each half-run, in [0, 2π), shape (2 k,), rad."""
    quarter: Ints
    """Quarter of the ring that begins with the seam or holds it, shape (2 k,)."""
    splits: Bools
    """Whether the seam splits that quarter, shape (2 k,)."""


def seams(struts: RoundStruts) -> Seams:
    """Return the seams of all runs."""
    runs, x = struts.runs, struts.x
    near = 2 * np.arange(len(runs.edges)) + (runs.slopes[0::2] < 0)
    far = near ^ 1
    y = np.cross(runs.directions, x)
    beyond = _angle(x[near], x[far], y[far])
    offset = beyond - QUARTER * np.round(beyond / QUARTER)
    is_corner = np.abs(offset) < SAME
    is_close = ~is_corner & (np.abs(offset) < CLOSE)
    start = np.where(is_close, QUARTER / 2, 0.0)  # (k,)
    turned = np.cos(start)[:, None] * x[near] + np.sin(start)[:, None] * y[near]
    beyond = _angle(turned, x[far], y[far])
    beyond = np.where(is_corner, np.mod(QUARTER * np.round(beyond / QUARTER), 2 * np.pi), beyond)
    angle = np.empty(len(x))
    angle[near], angle[far] = start, beyond
    splits = np.empty(len(x), dtype=np.bool_)
    splits[near], splits[far] = is_close, ~is_corner
    quarter = np.floor((angle + SAME) / QUARTER).astype(np.intp) % 4
    return Seams(near, angle, quarter, splits)


def _angle(vectors: Floats, x: Floats, y: Floats) -> Floats:
    """Return the angle of vectors (k, 3) from x toward y, in [0, 2π), shape (k,), rad."""
    angles: Floats = np.mod(np.arctan2(dot(vectors, y), dot(vectors, x)), 2 * np.pi)
    return angles
