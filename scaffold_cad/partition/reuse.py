"""Known quads around other directions: the same combinatorics, the vertices placed again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Bools, Floats, Ints, UnitVectors, as_floats, as_indices
from scaffold_cad.base.vectors import normalize, sums_by_row
from scaffold_cad.errors import PartitionError
from scaffold_cad.partition.arcs import arc_counts, is_closed, side_twins, sides
from scaffold_cad.partition.certificate import certify
from scaffold_cad.partition.relax import NEWTON_SHARPNESS, relaxed
from scaffold_cad.partition.star import direction_keys, nearest_angles

FLOW, NEWTON = 150, 20
"""Steps along the gradient, and Newton steps, from a first guess that may be far off."""
GENTLE_NEWTON, GENTLE_SHARPNESS = 8, (300.0, 3000.0)
"""Newton steps where vertices are to stay near, of a minimum that heeds the worst arcs only."""
BLEND = 0.3
"""Weight of the neighbors in a blended first guess."""


@dataclass(frozen=True, eq=False)
class Models:
    """Partitions whose combinatorics are to be kept."""

    quads: Ints
    """Vertices of the quad around each direction, closed, shape (M, N, 4)."""
    near: UnitVectors | None
    """Vertices to stay near to, shape (M, N + 2, 3)."""

    def __getitem__(self, chosen: Ints) -> Models:
        return Models(self.quads[chosen], None if self.near is None else self.near[chosen])

    @property
    def keys(self) -> Ints:
        """Numbers that agree for the same model, shape (M, K)."""
        quads = self.quads.reshape(len(self.quads), 4 * self.quads.shape[1])
        return quads if self.near is None else np.hstack([quads, direction_keys(self.near)])


def as_models(quads: ArrayLike, near: ArrayLike | None, shape: tuple[int, int]) -> Models:
    """Return models for M stars of valency N.

    Raises
    ------
    PartitionError
        If a shape or type is wrong, or a star's quads do not close up on N + 2 vertices.
    """
    stars, valency = shape
    given = as_indices(quads, "like", PartitionError)
    if given.shape != (stars, valency, 4):
        raise PartitionError(f"like has shape {given.shape}; need {(stars, valency, 4)}")
    known = np.all((given >= 0) & (given < valency + 2), axis=(1, 2), keepdims=True)
    given = np.where(known, given, 0)
    closed = is_closed(given) & (arc_counts(given) > 0).all(axis=1)
    if not closed.all():
        raise PartitionError(
            f"the quads of star {np.argmin(closed)} in like do not close up on "
            f"{valency + 2} vertices"
        )
    if near is None:
        return Models(given, None)
    vertices = as_floats(near, "near", PartitionError)
    if vertices.shape != (stars, valency + 2, 3) or not np.isfinite(vertices).all():
        raise PartitionError(
            f"near has shape {vertices.shape}; need {(stars, valency + 2, 3)}, all finite"
        )
    return Models(given, normalize(vertices))


def placed(stars: UnitVectors, models: Models) -> tuple[UnitVectors, Bools]:
    """Return vertices (M, N + 2, 3) for the models' quads, and which are certified, (M,).

    Several first guesses are tried in turn on the stars that still lack a certificate.

    Parameters
    ----------
    stars : (M, N, 3) float64, unit vectors, distinct within each star
    models : M of them
    """
    quads, near = models.quads, models.near
    reach = nearest_angles(stars) / 2
    vertices = np.zeros((len(stars), stars.shape[1] + 2, 3))
    certified = np.zeros(len(stars), dtype=np.bool_)
    tries = [
        _Try(lambda rest: circumscribed(stars[rest], quads[rest])),
        _Try(lambda rest: blended(stars[rest], quads[rest])),
    ]
    if near is not None:
        # Where the old vertices will still do, the new ones stay beside them: no jumps.
        gentle = _Try(lambda rest: near[rest], 0, GENTLE_NEWTON, GENTLE_SHARPNESS)
        tries = [gentle, _Try(lambda rest: near[rest]), *tries]
    for each in tries:
        rest = np.flatnonzero(~certified)
        if len(rest) == 0:
            break
        vertices[rest], _ = relaxed(
            stars[rest],
            reach[rest],
            quads[rest],
            each.guess(rest),
            flow=each.flow,
            newton=each.newton,
            sharpness=each.sharpness,
        )
        certified[rest] = certify(stars[rest], vertices[rest], quads[rest]).valid
    return vertices, certified


@dataclass(frozen=True)
class _Try:
    """A first guess at the vertices of some stars, and how to go on from it."""

    guess: Callable[[Ints], UnitVectors]
    flow: int = FLOW
    newton: int = NEWTON
    sharpness: tuple[float, float] = NEWTON_SHARPNESS


def circumscribed(stars: UnitVectors, quads: Ints) -> UnitVectors:
    """Return a first guess: the axis of the circle through the directions around each vertex.

    It is the area vector of the polygon of directions, which knows inside from outside.
    """
    row, side = np.arange(len(stars))[:, None], np.arange(4 * stars.shape[1])
    # Counter-clockwise around the vertex that a side leaves, the next quad lies across the
    # side that reaches it.
    following = stars[row, side_twins(quads)[:, _before(side)] // 4]
    areas = np.cross(stars[:, side // 4], following)
    return _with_pockets(stars, quads, normalize(_summed(areas, quads)))


def blended(stars: UnitVectors, quads: Ints) -> UnitVectors:
    """Return a first guess: the circumscribed one drawn toward the vertices it is joined to."""
    guess = circumscribed(stars, quads)
    _, ends = sides(quads)
    neighbors = _summed(guess[np.arange(len(stars))[:, None], ends], quads)
    return normalize(guess + BLEND * normalize(neighbors))


def _with_pockets(stars: UnitVectors, quads: Ints, guess: UnitVectors) -> UnitVectors:
    """Return `guess` with every vertex of two arcs put midway between the arcs' other ends.

    If u, v, w are corners in turn of the quad around P, and v belongs to it and to the quad
    around Q alone, then (P − Q) × (u − w) is as far from P as from Q, as far from u as from w,
    and on the side where both quads see v.
    """
    row, side = np.arange(len(stars))[:, None], np.arange(4 * stars.shape[1])
    starts, ends = sides(quads)
    before, across = starts[:, _before(side)], stars[row, side_twins(quads) // 4]
    middles = np.cross(stars[:, side // 4] - across, guess[row, before] - guess[row, ends])
    pocket = arc_counts(quads) == 2
    moved: UnitVectors = np.where(pocket[..., None], normalize(_summed(middles, quads)), guess)
    return moved


def _before(side: Ints) -> Ints:
    """Return the side of the same quad that comes before each side."""
    return side - side % 4 + (side + 3) % 4


def _summed(values: Floats, quads: Ints) -> Floats:
    """Return the sums at each vertex of values (M, 4 N, 3) at the corners, (M, N + 2, 3)."""
    count = quads.shape[1] + 2
    starts, _ = sides(quads)
    rows = starts + count * np.arange(len(quads))[:, None]
    sums = sums_by_row(values, rows, count * len(quads))
    return sums.reshape(len(quads), count, 3)
