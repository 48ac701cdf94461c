"""Sharp nodes of round struts: those that are equal have one shape."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors, place_text
from scaffold_cad.base.vectors import any_perpendicular, dot, normalize
from scaffold_cad.errors import BrepError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.runs import Runs, balls_of
from scaffold_cad.struts.sharp.curves import ONE_LINE
from scaffold_cad.struts.sharp.loops import SEAMS, seam_angles
from scaffold_cad.struts.sharp.shapes import LEAST_CLEAR, SharpShape, shapes_of
from scaffold_cad.struts.sharp.stars import SAME, SharpStars

MITRED = np.radians(90.0)
"""Largest turn of a bend whose struts meet in one plane: its corner is 1.41 radii out."""

CORNER = 1.0
"""How far beyond the node that plane reaches at most, in radii."""

SLIVER = 0.05
"""Depth of what other nodes show of their ball, in its radii, below which that is left out: their
thickest struts then end in the planes between them."""

STRAIGHT = 0.01
"""Turn between two struts below which their seams are not on one line, rad."""

SAME_WAY = np.cos(0.02)
"""Cosine of the angle between seams of these from which on they are apart."""

ROUNDED = 1e-11
"""Nodes whose numbers agree to this are made once."""


@dataclass(frozen=True, eq=False)
class SharpNodes(Frozen):
    """Nodes of one valency, each the sharp union of its struts, as proved."""

    nodes: Ints
    """Shape (M,)."""
    half_runs: Ints
    """Half-runs that leave each node, shape (M, N)."""
    size: Floats
    """Radius of each node's ball, the unit of its shape, shape (M,), mm."""
    shape_of: Ints
    """Which of the shapes each node has, shape (M,)."""
    shapes: tuple[SharpShape, ...]
    """What is at the nodes, relative to them and in radii of their balls."""

    @property
    def collars(self) -> Floats:
        """Distance at which each strut is alone, and has its ring, (M, N), mm."""
        collars = np.stack([shape.collars for shape in self.shapes])
        return np.asarray(collars[self.shape_of] * self.size[:, None])


def ring_starts(runs: Runs) -> UnitVectors:
    """Return where the rings of half-runs begin, (2 k, 3): both of a run alike."""
    ahead = runs.directions[0::2]
    first = np.argmax(np.abs(ahead) > 1e-6, axis=1)  # the same for runs that are stored reversed
    sign = np.sign(ahead[np.arange(len(ahead)), first])
    across = any_perpendicular(normalize(np.rint(sign[:, None] * ahead / ROUNDED)))
    across = normalize(across - dot(across, ahead)[:, None] * ahead)
    return np.repeat(across, 2, axis=0)


def sharp_nodes(skeleton: Skeleton, runs: Runs, x: UnitVectors) -> tuple[SharpNodes, ...]:
    """Return all nodes that are proved, by valency.

    Parameters
    ----------
    x : (2 k, 3) where the rings of half-runs begin
    """
    balls, made = balls_of(skeleton, runs), []
    for valency in np.unique(runs.valency[runs.valency > 1]).tolist():
        nodes = np.flatnonzero(runs.valency == valency)
        half_runs = runs.incidence.at_nodes(nodes, valency)
        radii, slopes = runs.radii.reshape(-1)[half_runs], runs.slopes[half_runs]
        touching = (radii / np.hypot(1.0, slopes)).max(axis=1)
        size = np.maximum(touching, balls[nodes])
        directions = runs.directions[half_runs]
        stars = SharpStars(
            directions,
            x[half_runs],
            radii / size[:, None],
            slopes,
            _mitred(directions, radii / np.hypot(1.0, slopes), slopes, size, balls[nodes]),
        )
        first, kind = _distinct(stars)
        shapes = shapes_of(stars[first])
        proved = np.array([shape is not None for shape in shapes])
        number = np.cumsum(proved) - 1
        rows = np.flatnonzero(proved[kind])
        kept = tuple(shape for shape in shapes if shape is not None)
        if len(rows):
            own = SharpNodes(nodes[rows], half_runs[rows], size[rows], number[kind[rows]], kept)
            made.append(own)
    return tuple(made)


def seams_of(runs: Runs, sharp: tuple[SharpNodes, ...], x: UnitVectors) -> Ints:
    """Return the generator on which the seam of each run lies, -1 for runs without one, (k,).

    It is counted about the first half-run; about the other one it is `SEAMS` - 1 less it.

    Parameters
    ----------
    x : (2 k, 3) where the rings of half-runs begin
    """
    clear = np.full((len(runs.tails), SEAMS), np.pi)
    for group in sharp:
        clear[group.half_runs] = np.stack([shape.clear for shape in group.shapes])[group.shape_of]
    both = np.minimum(clear[0::2], clear[1::2, ::-1])  # (k, SEAMS)
    best = np.argmax(np.round(both, 9), axis=1)
    for one, other in _nearly_straight(runs, sharp).tolist():
        ways = [_seam_way(runs, x, run, int(best[run])) for run in (one, other)]
        if ways[0] @ ways[1] > SAME_WAY and one != other:
            free = both[other].copy()
            free[best[other]] = 0.0
            best[other] = np.argmax(free)
    found = both[np.arange(len(both)), best] >= LEAST_CLEAR
    return np.where(found, best, -1)


def _seam_way(runs: Runs, x: UnitVectors, run: int, seam: int) -> Floats:
    """Return the direction across a run in which its seam is, (3,)."""
    ahead, start = runs.directions[2 * run], x[2 * run]
    angle = seam_angles(ahead)[seam]
    found: Floats = np.cos(angle) * start + np.sin(angle) * np.cross(ahead, start)
    return found


def _nearly_straight(runs: Runs, sharp: tuple[SharpNodes, ...]) -> Ints:
    """Return pairs of runs that leave a node almost oppositely, (p, 2)."""
    found = [np.empty((0, 2), dtype=np.intp)]
    for group in sharp:
        i, j = np.triu_indices(group.half_runs.shape[1], 1)
        ways = runs.directions[group.half_runs]
        turn = np.linalg.norm(ways[:, i] + ways[:, j], axis=2)
        row, pair = np.nonzero((turn > ONE_LINE) & (turn < STRAIGHT))
        found.append(
            np.stack([group.half_runs[row, i[pair]], group.half_runs[row, j[pair]]], 1) >> 1
        )
    return np.concatenate(found)


def check_made(runs: Runs, sharp: tuple[SharpNodes, ...]) -> None:
    """Raise unless all nodes that struts share have a shape.

    Raises
    ------
    BrepError
        If one has none; it is named, and where it is.
    """
    missing = runs.valency > 1
    for group in sharp:
        missing[group.nodes] = False
    if missing.any():
        node = int(np.argmax(missing))
        raise BrepError(
            f"node {node} at {place_text(runs.nodes[node])} has no sharp surface that is proved; "
            "need overlaps='unite', or nodes='blend'"
        )


def _mitred(
    directions: UnitVectors, own: Floats, slopes: Floats, size: Floats, balls: Floats
) -> Bools:
    """Return the nodes whose thickest struts end in the planes between them, (M,).

    These are bends of two equal struts, and nodes where the thickest struts are equal cylinders
    that leave no more of the ball than a sliver.

    Parameters
    ----------
    own : (M, N) radius of the ball that each strut touches, mm
    size : (M,) that of the node, mm
    balls : (M,) that of the skeleton, mm, or 0
    """
    touching = own >= size[:, None] * (1.0 - SAME)
    flat = np.where(touching, np.abs(slopes), 0.0).max(axis=1) == 0
    if directions.shape[1] == 2:
        flat |= touching.all(axis=1) & (np.abs(slopes[:, 0] - slopes[:, 1]) < SAME)
        deepest = np.where(touching.all(axis=1), -np.sin(MITRED / 2), -SLIVER) - SAME
    else:
        deepest = np.full(len(size), -SLIVER)
    return np.asarray(flat & (balls == 0) & (_depths(directions, touching) > deepest))


def _depths(directions: UnitVectors, chosen: Bools) -> Floats:
    """Return the least cosine between any direction and the nearest of those chosen, (M,)."""
    valency = directions.shape[1]
    ways = [-directions]
    i, j = np.triu_indices(valency, 1)
    ways.append(-(directions[:, i] + directions[:, j]))
    if valency > 2:
        i, j, k = np.array(list(combinations(range(valency), 3))).T
        across = np.cross(directions[:, i] - directions[:, j], directions[:, i] - directions[:, k])
        ways += [across, -across]
    every = np.concatenate(ways, axis=1)  # (M, w, 3)
    size = np.linalg.norm(every, axis=2, keepdims=True)
    every = every / np.maximum(size, 1e-300)
    cosines = every @ directions.transpose(0, 2, 1)  # (M, w, N)
    nearest = np.where(chosen[:, None], cosines, -np.inf).max(axis=2)
    found: Floats = np.where(size[..., 0] > SAME, nearest, np.inf).min(axis=1)
    return found


def _distinct(stars: SharpStars) -> tuple[Ints, Ints]:
    """Return one star of each kind of equal ones, (U,), and the kind of each, (M,)."""
    count = len(stars)
    columns = [stars.directions, stars.x, stars.radii, stars.slopes, stars.mitred]
    flat = [np.asarray(each, dtype=np.float64).reshape(count, -1) for each in columns]
    table = np.ascontiguousarray(np.rint(np.concatenate(flat, axis=1) / (4 * ROUNDED)) + 0.0)
    keys = table.view(np.dtype((np.void, table.shape[1] * table.itemsize))).reshape(-1)
    _, first, kind = np.unique(keys, return_index=True, return_inverse=True)
    return first, kind.reshape(-1)
