"""The default method: the dual of a plane 4-regular multigraph, relaxed.

Which quads share an arc is decided by a b-matching on the spherical Delaunay triangulation of
the directions: edges with short Voronoi arcs are better left out, since the arc's ends merge,
and edges with long ones taken twice, since a vertex fits in the arc's middle. The gains that
steer it are estimates (fitted to what relaxation reached on many random choices), so several
good choices are relaxed and the best is kept. Stars that stay poor get more choices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, UnitVectors
from scaffold_cad.base.segments import distance_to_side
from scaffold_cad.base.vectors import angle_between, dot
from scaffold_cad.partition.arcs import arc_counts
from scaffold_cad.partition.certificate import certify, corners_of
from scaffold_cad.partition.delaunay import Triangulations, triangulations
from scaffold_cad.partition.lune import circle_axes, lune_partitions, lunes_about
from scaffold_cad.partition.matching import good_matchings
from scaffold_cad.partition.multigraph import Quadrangulations, quadrangulations
from scaffold_cad.partition.relax import relaxed
from scaffold_cad.partition.star import nearest_angles, unique_rows

# How clearances change with these constants: `python -m tests.benchmarks.tuning`.
PERFECT = 0.9999
"""A lowest ratio that need not be improved."""
MANY_ARCS, MOST_BURDEN = 0.003, 0.05
"""What arcs beyond four at a vertex cost of the score, by the square, and at most."""
STRAIGHT = 0.4
"""Least distance of the straight sides of a quad from its direction's axis, over the sine of its
reach, that costs nothing of the score. Arcs that nearly reach around half the sphere have sides
that pass through the node: however far out its corners are, the strut is thin there."""
WANTED = 1000.0
"""Gain of taking an edge that must be taken."""
LONG_ARC = 3.0
"""What the gain of Voronoi arcs levels off at, in reaches."""
TINY_ARC = 0.1
"""Voronoi arcs shorter than this, in reaches, are hardly there: their ends should merge."""
WIDE_GAP = 1.8
"""What the loss of gaps between two caps levels off at, in reaches."""
ONCE, AGAIN = (0.82, 1.4, 0.8), (0.37, 0.51, 0.0)
"""Weights of arcs, gaps and merging ends in the gain of taking an edge, and of taking it again.

They are near those that `python -m tests.benchmarks.gains` fits to what relaxation reaches on
random choices, in proportion, and are tuned on the clearances that come out.
"""


@dataclass(frozen=True)
class Effort:
    """How much to try for a star."""

    below: float
    """Only stars whose best lowest ratio so far is less get this effort."""
    choices: int
    """Number of multigraphs wanted of each search."""
    search: int
    """Steps of each search, for each direction (as for 10 or 40 if fewer or more)."""
    trusts: tuple[float, ...]
    """A search for each, with the gains times it: less makes for more different choices."""
    flow: tuple[tuple[int, int], ...]
    """Steps along the gradient, and how many of a star's candidates are kept after them."""


FIRST_OF_FOUR = Effort(PERFECT, 1, search=0, trusts=(1.0,), flow=())
"""Four directions have only six multigraphs, and the best by gain is nearly always perfect."""
EFFORTS = (
    Effort(PERFECT, 8, search=8, trusts=(1.0,), flow=((10, 4), (20, 2), (20, 1))),
    Effort(0.9, 24, search=40, trusts=(0.6, 0.3), flow=((12, 12), (20, 4), (20, 2))),
    Effort(
        0.9, 80, search=100, trusts=(1.0, 0.6, 0.4, 0.25, 0.15), flow=((12, 80), (20, 12), (20, 4))
    ),
)
LUNES = ((50, 1),)
"""The flow of lunes, which join the contest for the stars that stay poorest."""
NEWTON = 20
"""Newton steps of those that come through."""


def dual_partitions(stars: UnitVectors) -> tuple[UnitVectors, Ints]:
    """Return vertices (M, N + 2, 3) and quads (M, N, 4) of good partitions of `stars`.

    They are all but certainly valid, but this is for the caller to certify.

    Parameters
    ----------
    stars : (M, N, 3) float64, unit vectors, distinct within each star
    """
    if stars.shape[1] == 3:
        # The only topology; about this axis the arcs are the Voronoi arcs.
        return lunes_about(circle_axes(stars), stars, nearest_angles(stars) / 2)
    contest = Contest(stars)
    meshes, meshed = triangulations(stars)
    for effort in (FIRST_OF_FOUR, *EFFORTS) if stars.shape[1] == 4 else EFFORTS:
        part = contest.lowest[meshed] < effort.below
        rows = meshed[part]
        if len(rows) == 0:
            break
        found, owners = candidates(meshes[part], stars[rows], contest.reach[rows], effort)
        contest.enter(found, rows[owners], effort.flow)
    poor = np.flatnonzero(contest.lowest < EFFORTS[-1].below)
    contest.enter(Quadrangulations(*lune_partitions(stars[poor])), poor, LUNES)
    return contest.best.vertices, contest.best.quads


def candidates(
    meshes: Triangulations,
    stars: UnitVectors,
    reach: Floats,
    effort: Effort,
    wanted: Bools | None = None,
) -> tuple[Quadrangulations, Ints]:
    """Return quadrangulations for triangulated `stars`, and the star of each, ascending.

    Only those that take each of the `wanted` edges (M, E), at least once.
    """
    half_edges = edges_of(meshes)  # (M, E)
    first, second = _gains(meshes, half_edges, stars, reach)
    ends = np.stack([_taken(meshes.tails, half_edges), _taken(meshes.heads, half_edges)], axis=2)
    searches = np.repeat(np.arange(len(stars)), len(effort.trusts))
    trust = np.tile(effort.trusts, len(stars))[:, None]
    own = trust * first[searches] + (1 - trust)
    choices, gains = good_matchings(
        ends[searches],
        own if wanted is None else own + WANTED * wanted[searches],
        trust * second[searches] - (1 - trust),
        stars.shape[1],
        effort.choices,
        effort.search * min(max(stars.shape[1], 10), 40),
    )
    search, choice = np.nonzero(gains > -np.inf)
    owners, taken = searches[search], choices[search, choice]
    if wanted is not None:
        complete = (taken > 0).all(axis=1, where=wanted[owners])
        owners, taken = owners[complete], taken[complete]
    unlike, _ = unique_rows(np.column_stack([owners, taken]))
    owners, taken = owners[unlike], taken[unlike]

    multiplicity = np.zeros((len(owners), meshes.tails.shape[1]), dtype=np.intp)
    for side in (half_edges, _taken(meshes.twins, half_edges)):
        np.put_along_axis(multiplicity, side[owners], taken, axis=1)
    found, kept = quadrangulations(meshes[owners], stars[owners], multiplicity)
    return found, owners[kept]


class Contest:
    """The best partition of each star so far."""

    def __init__(self, stars: UnitVectors) -> None:
        count, valency = stars.shape[:2]
        self.stars = stars
        self.reach = nearest_angles(stars) / 2
        self.lowest = np.full(count, -np.inf)  # ratio of the best, less for long arcs
        self.score = np.full(count, -np.inf)
        self.best = Quadrangulations(
            np.zeros((count, valency + 2, 3)), np.zeros((count, valency, 4), dtype=np.intp)
        )

    def enter(
        self, found: Quadrangulations, owners: Ints, flow: tuple[tuple[int, int], ...]
    ) -> None:
        """Relax the quadrangulations of `owners` (ascending) and keep each star's best.

        Those perfect as they stand end the contest for their star. The others flow in heats,
        after each of which only some go on, and the last get Newton steps.
        """
        found, lowest = self._relaxed(found, owners)
        self._keep(found, owners, lowest)
        going = self.lowest[owners] < PERFECT
        found, owners = found[going], owners[going]
        total, done = sum(steps for steps, _ in flow), 0
        for steps, kept in flow:
            part = (done / total, (done + steps) / total)
            found, lowest = self._relaxed(found, owners, flow=steps, part=part)
            scores = _scores(self._straight(found, owners, lowest), found.quads)
            leading = leaders(owners, scores, kept)
            found, owners, done = found[leading], owners[leading], done + steps
        if flow:
            found, lowest = self._relaxed(found, owners, newton=NEWTON)
            self._keep(found, owners, lowest)

    def _relaxed(
        self,
        found: Quadrangulations,
        owners: Ints,
        *,
        flow: int = 0,
        part: tuple[float, float] = (0.0, 1.0),
        newton: int = 0,
    ) -> tuple[Quadrangulations, Floats]:
        vertices, lowest = relaxed(
            self.stars[owners],
            self.reach[owners],
            found.quads,
            found.vertices,
            flow=flow,
            part=part,
            newton=newton,
        )
        return Quadrangulations(vertices, found.quads), lowest

    def _keep(self, found: Quadrangulations, owners: Ints, lowest: Floats) -> None:
        """Take over the best valid one of each star where it improves on what there is."""
        valid = certify(self.stars[owners], found.vertices, found.quads).valid
        lowest = self._straight(found, owners, lowest)
        scores = np.where(valid, _scores(lowest, found.quads), -np.inf)
        chosen = leaders(owners, scores, 1)
        chosen = chosen[scores[chosen] > self.score[owners[chosen]]]
        stars = owners[chosen]
        self.best.vertices[stars] = found.vertices[chosen]
        self.best.quads[stars] = found.quads[chosen]
        self.lowest[stars], self.score[stars] = lowest[chosen], scores[chosen]

    def _straight(self, found: Quadrangulations, owners: Ints, lowest: Floats) -> Floats:
        """Return the lowest ratios (K,), less where arcs are so long that struts are thin."""
        apart = straightness(self.stars[owners], self.reach[owners], found)
        return np.where(lowest > 0, lowest * np.minimum(apart / STRAIGHT, 1.0), lowest)


def straightness(stars: UnitVectors, reach: Floats, found: Quadrangulations) -> Floats:
    """Return the least distance of straight sides from the axes in their quads, (M,).

    It is over the sine of the axis' `reach` (M, N): 1 for a side that keeps as far from it as any
    arc may be.
    """
    corners = corners_of(found.vertices, found.quads)  # (M, N, 4, 3)
    axes = stars[:, :, None]
    across = corners - dot(corners, axes)[..., None] * axes
    far = distance_to_side(across, np.roll(across, -1, axis=2))
    return np.asarray((far / np.sin(reach)[:, :, None]).min(axis=(1, 2)))


def leaders(owners: Ints, scores: Floats, count: int) -> Ints:
    """Return the rows of the `count` highest scores of each owner, in order of owner."""
    order = np.lexsort((-scores, owners))
    sorted_owners = owners[order]
    starts = np.searchsorted(sorted_owners, sorted_owners)
    leading: Ints = order[np.arange(len(order)) - starts < count]
    return leading


def _scores(lowest: Floats, quads: Ints) -> Floats:
    """Return how good partitions are: their lowest ratio, less where many arcs meet."""
    excess = np.maximum(arc_counts(quads) - 4, 0)
    burden = 1 - np.minimum(MANY_ARCS * (excess**2).sum(axis=1), MOST_BURDEN)
    return np.where(lowest > 0, lowest * burden, lowest)


def _gains(
    meshes: Triangulations, half_edges: Ints, stars: UnitVectors, reach: Floats
) -> tuple[Floats, Floats]:
    """Return what taking each edge once, and once more, is worth, both (M, E)."""
    arc, gap, merging = measures(meshes, half_edges, stars, reach)
    first, second = (
        start + a * arc - b * gap - c * merging for start, (a, b, c) in ((1, ONCE), (-1, AGAIN))
    )
    return first, second


def measures(
    meshes: Triangulations, half_edges: Ints, stars: UnitVectors, reach: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the Voronoi arc of each edge, its gap, and how much the arc's ends merge, (M, E)."""
    row = np.arange(len(stars))[:, None]
    tails, heads = _taken(meshes.tails, half_edges), _taken(meshes.heads, half_edges)
    left = meshes.centers[row, half_edges // 3]
    right = meshes.centers[row, _taken(meshes.twins, half_edges) // 3]
    near, far = reach[row, tails], reach[row, heads]
    arc = _leveled(angle_between(left, right) / np.sqrt(near * far), LONG_ARC)
    apart = angle_between(stars[row, tails], stars[row, heads])
    gap = _leveled(apart / (near + far) - 1, WIDE_GAP)
    return arc, gap, np.maximum(1 - arc / TINY_ARC, 0)


def _leveled(values: Floats, limit: float) -> Floats:
    """Return values that tend to `limit`, but so that no two different ones become equal.

    Equal gains would leave it to the order of the directions which edge is taken.
    """
    leveled: Floats = values / np.sqrt(1 + (values / limit) ** 2)
    return leveled


def edges_of(meshes: Triangulations) -> Ints:
    """Return the lower half-edge of each edge, shape (M, 3 N − 6)."""
    half_edges = np.arange(meshes.twins.shape[1])
    lower = np.nonzero(half_edges < meshes.twins)[1]
    return lower.reshape(len(meshes.twins), meshes.twins.shape[1] // 2)


def _taken(values: Ints, half_edges: Ints) -> Ints:
    return np.take_along_axis(values, half_edges, axis=1)
