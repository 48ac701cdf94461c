"""Directions in which a layer on quads rises, leaned where its cells would fold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Quads, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize, sums_by_row, triple

LEAST_VOLUME = 0.02
"""Volume at the corner of a cell below which it counts as folded, in the mean of its corners."""

AIM = 0.2
"""Volume at corners that is aimed at, in that of a straight cell on the quad."""

HOLD = 1e-4
"""Cost of a turn by a radian, in those of a corner that lacks the volume of a straight cell."""

RINGS = 3
"""Of quads around the folded ones whose vertices lean."""

ROUNDS, STEPS = 6, 200
"""How often cells that are still folded are looked for at most, and steps of the minimizer then."""


def leaned(
    vertices: Points, quads: Quads, directions: UnitVectors, low: Floats, high: Floats
) -> UnitVectors:
    """Return directions (v, 3) at the vertices of quads under which few cells fold, none if found.

    Beside a sharp edge the layer is narrower than the surface, and quads there have room only if
    those beside them give way: around folded cells the sum of squares of what corners lack of
    volume is minimized, with a small cost for turns. Others stay.

    Parameters
    ----------
    vertices, quads : (v, 3) float64, mm, and (f, 4) intp
    directions : (v, 3), normals of the surface
    low, high : heights of the layer's bottom and top at the vertices, (v,), mm
    """
    layer = _Layer(vertices, quads, low, high)
    found, best, fewest = directions, directions, len(quads) + 1
    for _ in range(ROUNDS):
        folded = layer.folded(found)
        count = int(folded.sum())
        if count < fewest:
            best, fewest = found, count
        if count == 0:
            break
        near = np.zeros(len(vertices), dtype=np.bool_)
        near[quads[folded]] = True
        for _ in range(RINGS):
            near[quads[near[quads].any(axis=1)]] = True
        found = _leaned_near(layer, found, directions, np.flatnonzero(near))
    return best


@dataclass(frozen=True, eq=False)
class _Layer(Frozen):
    """A layer of one cell a quad."""

    vertices: Points
    """Shape (v, 3), mm."""
    quads: Quads
    """Shape (f, 4)."""
    low: Floats
    """Height of the bottom at each vertex, shape (v,), mm."""
    high: Floats
    """Height of the top, shape (v,), mm."""

    def folded(self, directions: UnitVectors) -> Bools:
        """Return which quads have a cell with a corner that is inside out, (f,)."""
        volumes = np.concatenate([triple(*sides) for sides in self._corners(directions)], axis=1)
        folded: Bools = volumes.min(axis=1) < LEAST_VOLUME * np.abs(volumes).mean(axis=1)
        return folded

    def around(self, rows: Ints) -> _Layer:
        """Return the cells with vertices among `rows`, of all vertices."""
        some = np.zeros(len(self.vertices), dtype=np.bool_)
        some[rows] = True
        return _Layer(self.vertices, self.quads[some[self.quads].any(axis=1)], self.low, self.high)

    def lacking(self, directions: UnitVectors) -> tuple[float, Floats]:
        """Return the sum of squares of what corners lack, and its slope by `directions`, (v, 3)."""
        thick = (self.high - self.low)[self.quads]  # (f, 4)
        unit = self._areas * np.abs(thick)
        value, slope = 0.0, np.zeros_like(self.vertices)
        heights = self.low, self.high
        for height, (a, b, up) in zip(heights, self._corners(directions), strict=True):
            lack = np.maximum(AIM - triple(a, b, up) / unit, 0.0)
            value += float((lack**2).sum())
            pull = (-2.0 * lack / unit)[..., None]
            by_a, by_b = pull * np.cross(b, up), pull * np.cross(up, a)
            by_place = np.roll(by_a, 1, axis=1) + np.roll(by_b, -1, axis=1) - by_a - by_b
            by_direction = by_place * height[self.quads][..., None]
            by_direction += pull * np.cross(a, b) * np.abs(thick)[..., None]
            slope += sums_by_row(by_direction.reshape(-1, 3), self.quads.reshape(-1), len(slope))
        return value, slope

    def _corners(self, directions: UnitVectors) -> list[tuple[Floats, Floats, Floats]]:
        """Return the sides from the corners of bottoms and of tops, (f, 4, 3) each.

        They lead along the quad to the next corner and to the one before, and to the top.
        """
        bottom, top = (
            (self.vertices + height[:, None] * directions)[self.quads]
            for height in (self.low, self.high)
        )
        up = (top - bottom) * np.sign(self.high - self.low)[self.quads][..., None]
        return [
            (np.roll(one, -1, axis=1) - one, np.roll(one, 1, axis=1) - one, up)
            for one in (bottom, top)
        ]

    @property
    def _areas(self) -> Floats:
        """Mean area at the corners of each quad, (f, 1), mm²."""
        corners = self.vertices[self.quads]
        ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
        areas = length(np.cross(ahead, back)).mean(axis=1, keepdims=True)
        return np.asarray(np.maximum(areas, np.finfo(float).tiny))


def _leaned_near(
    layer: _Layer, directions: UnitVectors, upright: UnitVectors, rows: Ints
) -> UnitVectors:
    """Return directions (v, 3) under which cells around vertices `rows` lack least.

    Parameters
    ----------
    upright : (v, 3), those that turns are measured from
    """
    from scipy.optimize import minimize  # takes a fifth of a second, and few layers need it

    near = layer.around(rows)

    def turned(flat: Floats) -> UnitVectors:
        found = directions.copy()
        found[rows] = normalize(flat.reshape(-1, 3))
        return found

    def cost(flat: Floats) -> tuple[float, Floats]:
        here = turned(flat)
        value, slope = near.lacking(here)
        turn = here[rows] - upright[rows]
        value += HOLD * float((turn**2).sum())
        along = slope[rows] + 2.0 * HOLD * turn
        along -= dot(along, here[rows])[:, None] * here[rows]
        return value, (along / length(flat.reshape(-1, 3))[:, None]).reshape(-1)

    found = minimize(
        cost,
        directions[rows].reshape(-1),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": STEPS, "maxfun": 2 * STEPS},
    )
    return turned(found.x)
