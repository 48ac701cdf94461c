"""The blends of nodes: patches that join the collars of a node's struts smoothly, and their proof.

`blends` takes all nodes of one valency at once. Nodes that are equal are solved once, nodes of one
combinatorial type share their linear system, and what is done for a node is done for many in
whole arrays, a block in each thread.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, UnitVectors
from scaffold_cad.base.blocks import CACHE, blocks, cut
from scaffold_cad.base.counts import tracked
from scaffold_cad.base.threads import in_order
from scaffold_cad.base.vectors import normalize
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.struts.blending.blend import (
    Blends,
    Originals,
    Skins,
    Solved,
    Stars,
    best_by_layout,
)
from scaffold_cad.struts.blending.collars import LEAST_BLEND, Collars, collar_distances
from scaffold_cad.struts.blending.evenness import even
from scaffold_cad.struts.blending.fitting import Turned, collars_of, solve, union_of
from scaffold_cad.struts.blending.joins import types_of
from scaffold_cad.struts.blending.recipes import (
    FINER,
    MOST_BULGE,
    MOST_DEPTH,
    RECIPES,
    ROUGH,
    Recipe,
    Stage,
)

SAMPLE_BYTES = 64
"""What a sample of a blend takes where it is treated."""
STAR_BYTES = 2048
"""What a partition takes where its vertices are moved."""
UNPROVED = 1e6
"""What not to be proved counts when the best recipe is chosen, as a bulge."""
DEEP = 1e4
"""What a depth that is too much counts there, over the radius: more than any bulge."""
ROOM = 1e-9
"""Part of a radius that room for collars is rounded to: it is found by bisection."""
MOST_ROOM = 1e6
"""Room for a collar above which it is without end, in radii."""
NARROW = np.cos(np.radians(10.0))
"""Cosine of the least angle between struts of nodes for which all recipes are tried: with less than
10°, they prove one node in a hundred."""
SAME = 1e-11
"""Nodes whose numbers agree to this part of a radius are solved once, with their numbers rounded:
so what a node gets depends on no other node, to the last bit."""


def blends(stars: Stars, recipes: Iterable[Recipe] = RECIPES) -> tuple[Blends, ...]:
    """Return the blends of `stars`, those with the same layout of patches together.

    Nodes that no recipe proves have the blend of the recipe that came nearest; see
    `Blends.proved`.

    Parameters
    ----------
    stars : branch points of one valency
    recipes : ways to fit a blend, in the order in which they are tried

    Examples
    --------
    >>> import numpy as np
    >>> from scaffold_cad.partition import partition_spheres
    >>> tripod = np.eye(3)[None]
    >>> (found,) = blends(Stars.of(partition_spheres(tripod), radii=1.0, blends=0.5))
    >>> found.control.shape, found.proved
    ((1, 12, 6, 6, 3), array([ True]))
    """
    views = stars.views
    seen = stars.seen(views)
    one, kind = _distinct(seen)
    own = _rounded(seen[one])
    recipes = tuple(recipes)
    best, trials = _Best(len(own)), _Trials(own, recipes)
    open_nodes = np.arange(len(own))
    for trial, recipe in enumerate(recipes):
        if trial == 0:
            rows = open_nodes = _with_room(best, trials, recipe, open_nodes)
            fillets = trials.collars(recipe.swell).blends / own.radii.min(axis=1)  # (U,)
        else:
            rows = open_nodes[recipe.suits(fillets[open_nodes])]
        if recipe.swell > 1:
            rows = rows[~best.proved[rows]]
        if len(rows) == 0:
            continue
        found = trials.solved(recipe, rows)
        best.take(rows, found)
        _refine(best, own, trials.collars(recipe.swell), recipe, rows, found)
        open_nodes = np.setdiff1d(open_nodes, rows[best.good[rows] | ~found.has_room])
        if trial == 0:
            open_nodes = open_nodes[~_narrow(own[open_nodes])]
    views = views.rounded(SAME)
    first, shape_of = views.distinct(kind)
    size = _size(seen[one])
    copied = []
    for kinds, made in best_by_layout(best.found, best.which, best.place):
        some, size_of = own[kinds], size[kinds]
        skins = Skins(_enlarged(made, size_of), some.quads, some.directions, some.slopes)
        shapes = np.flatnonzero(np.isin(kind[first], kinds))
        which = np.searchsorted(kinds, kind[first[shapes]])
        originals = Originals(skins, which, views[first[shapes]])
        copied.append(_copied(stars, shapes, shape_of, originals))
    return tuple(copied)


def _with_room(best: _Best, trials: _Trials, recipe: Recipe, rows: Ints) -> Ints:
    """Return which of the nodes `rows` (k,) have room; the others get a rough blend.

    What has no room is crowded, whatever its surface: only its collars are needed.
    """
    has_room = trials.collars(recipe.swell).has_room[rows]
    without = rows[~has_room]
    if len(without):
        best.take(without, trials.solved(replace(recipe, stages=ROUGH), without))
    return rows[has_room]


def _refine(
    best: _Best, own: Stars, fitted: Collars, recipe: Recipe, rows: Ints, found: Solved
) -> None:
    """Try to better blends (k) of the nodes `rows` (k,) that are proved but not good."""
    for stage, most in FINER:
        is_off = found.proved & found.has_room & ~best.good[rows]
        is_off &= fitted.blends[rows] <= most * own.radii[rows].min(axis=1)
        rows, found = rows[is_off], found[np.flatnonzero(is_off)]
        if len(rows):
            finer = replace(recipe, stages=(stage,), kept=1)
            best.take(rows, _solved(own[rows], fitted[rows], finer, found.vertices, found))


class _Trials:
    """What the recipes for U nodes share: each of it is made once, for the nodes that need it."""

    def __init__(self, own: Stars, recipes: tuple[Recipe, ...]) -> None:
        self._own = own
        self._begun_with = {_way(recipe, recipe.stages[:-1]) for recipe in recipes}
        self._collars: dict[float, Collars] = {}
        self._moved: dict[float, tuple[UnitVectors, Bools]] = {}
        self._found: dict[Recipe, tuple[Ints, Solved]] = {}

    def collars(self, swell: float) -> Collars:
        """Return the collars of all nodes, (U,), for ρ times `swell`."""
        if swell not in self._collars:
            self._collars[swell] = collars_of(self._own, swell)
        return self._collars[swell]

    def solved(self, recipe: Recipe, rows: Ints) -> Solved:
        """Return what a recipe gives for the nodes `rows` (k,), ascending, from where it begins.

        That is what an earlier recipe gave with the same stages but for the last.
        """
        own, fitted = self._own[rows], self.collars(recipe.swell)[rows]
        before = self._found.get(_way(recipe, recipe.stages[:-1]))
        if before is None or not np.isin(rows, before[0]).all():
            found = _solved(own, fitted, recipe, self._vertices(recipe.openness, rows))
        else:
            begun = before[1][np.searchsorted(before[0], rows)]
            last = replace(recipe, stages=recipe.stages[-1:])
            found = _solved(own, fitted, last, begun.vertices, begun)
        if (way := _way(recipe, recipe.stages)) in self._begun_with:
            self._found[way] = rows, found
        return found

    def _vertices(self, openness: float, rows: Ints) -> UnitVectors:
        """Return the moved vertices of the partitions of the nodes `rows`, (k, N + 2, 3)."""
        if openness not in self._moved:
            nowhere = np.empty_like(self._own.vertices), np.zeros(len(self._own), dtype=np.bool_)
            self._moved[openness] = nowhere
        moved, is_moved = self._moved[openness]
        left = rows[~is_moved[rows]]
        if len(left):
            moved[left], is_moved[left] = _evened(self._own[left], openness), True
        return moved[rows]


def _way(recipe: Recipe, stages: tuple[Stage, ...]) -> Recipe:
    """Return what a recipe does, whatever the fillet, with other stages."""
    return replace(recipe, stages=stages, least=0.0, most=np.inf)


class _Best:
    """The best blend of each of U nodes so far."""

    def __init__(self, count: int) -> None:
        self.found: list[Solved] = []
        """Blends of some of the nodes."""
        self.which = np.full(count, -1, dtype=np.intp)
        """Which of these has that of a node, shape (U,)."""
        self.place = np.zeros(count, dtype=np.intp)
        """Place in it, shape (U,)."""
        self._score = np.full(count, np.inf)

    @property
    def proved(self) -> Bools:
        """Whether each node's blend is proved, shape (U,)."""
        return np.asarray(self._score < UNPROVED)

    @property
    def good(self) -> Bools:
        """Whether it is nowhere deep inside a strut or far outside as well, shape (U,)."""
        return np.asarray(self._score <= MOST_BULGE)

    def take(self, rows: Ints, found: Solved) -> None:
        """Take those of the blends (k) of nodes `rows` (k,) that are better."""
        value = found.bulge + np.where(found.proved, 0.0, UNPROVED)
        value += np.where(found.depth > MOST_DEPTH, DEEP * found.depth, 0.0)
        better = np.flatnonzero(value < self._score[rows])
        taken = rows[better]
        self.which[taken], self.place[taken] = len(self.found), np.arange(len(taken))
        self._score[taken] = value[better]
        self.found.append(found[better])


def nearest_collars(stars: Stars) -> tuple[Floats, Floats]:
    """Return where collars stand with the fillets asked for, and with the least, mm, both (M, N).

    For equal nodes they are found once.
    """
    views = stars.views
    stars = stars.seen(views)
    first, kind = _distinct(stars)
    own, size = _rounded(stars[first]), _size(stars[first])
    union = union_of(own, own.blends)
    small = np.minimum(own.blends, LEAST_BLEND * own.radii.mean(axis=1))
    found = [size * collar_distances(union, blends) for blends in (own.blends, small)]
    return views.by_strut(found[0][kind]), views.by_strut(found[1][kind])


def _narrow(stars: Stars) -> Bools:
    """Return whether struts leave each node at too narrow angles for any recipe, (M,)."""
    cosines = stars.directions @ stars.directions.transpose(0, 2, 1)
    return np.asarray((np.triu(cosines, 1) > NARROW).any(axis=(1, 2)))


def _copied(stars: Stars, shapes: Ints, shape_of: Ints, originals: Originals) -> Blends:
    """Return the blends of those nodes that have the `shapes` (U,), ascending."""
    nodes = np.flatnonzero(np.isin(shape_of, shapes))
    own = np.searchsorted(shapes, shape_of[nodes])
    first = nodes[np.unique(own, return_index=True)[1]]
    twins = side_twins(stars.quads[first])
    return Blends(stars[nodes], nodes, own, twins, originals.turned(), originals)


def _solved(
    own: Stars,
    fitted: Collars,
    recipe: Recipe,
    vertices: UnitVectors,
    begun: Solved | None = None,
) -> Solved:
    """Return the blends that a recipe gives with moved vertices, from those `begun` if any are."""
    kinds = types_of(own.quads)
    samples = 4 * own.directions.shape[1] * recipe.samples  # of a star
    order = np.argsort(kinds.type_of, kind="stable")
    pieces = list(cut(order, samples * SAMPLE_BYTES, CACHE))

    def work(rows: Ints) -> Solved:
        turned = Turned(own[rows], vertices[rows], kinds.sides[rows], kinds.parts(rows))
        return solve(turned, fitted[rows], recipe, None if begun is None else begun[rows])

    made = tracked("blends", in_order(work, pieces), [len(rows) for rows in pieces])
    solved = Solved.joined(list(made))
    return solved[np.argsort(order)]


def _evened(own: Stars, openness: float) -> UnitVectors:
    """Return the moved vertices of the partitions, (U, N + 2, 3); those of bends as they are."""
    if own.directions.shape[1] == 2:
        return own.vertices

    def work(some: slice) -> UnitVectors:
        return even(own.directions[some], own.vertices[some], own.quads[some], openness)

    return np.concatenate(list(in_order(work, blocks(len(own), STAR_BYTES, CACHE))))


def _size(stars: Stars) -> Floats:
    """Return the power of ten nearest to the radii at each node, mm, (M, 1).

    Equal nodes have the same.
    """
    size: Floats = 10 ** np.round(np.log10(stars.radii.mean(axis=1, keepdims=True)))
    return size


def _rounded(stars: Stars) -> Stars:
    """Return the stars with the numbers by which equal ones are known, lengths in their size."""
    size = _size(stars)
    alone = size[:, 0]
    return Stars(
        normalize(np.rint(stars.directions / SAME)),
        np.rint(stars.radii / (SAME * size)) * SAME,
        np.rint(stars.slopes / SAME) * SAME,
        np.rint(stars.blends / (SAME * alone)) * SAME,
        np.rint(stars.balls / (SAME * alone)) * SAME,
        np.where(stars.most < MOST_ROOM * size, np.rint(stars.most / (ROOM * size)) * ROOM, np.inf),
        normalize(np.rint(stars.vertices / SAME)),
        stars.quads,
    )


def _enlarged(made: Solved, size: Floats) -> Solved:
    """Return blends (U) with their lengths multiplied by sizes (U, 1)."""
    return replace(
        made,
        control=made.control * size[:, :, None, None, None],
        collar_distances=made.collar_distances * size,
        collar_radii=made.collar_radii * size,
        rho=made.rho * size[:, 0],
    )


def _distinct(stars: Stars) -> tuple[Ints, Ints]:
    """Return one node of each kind of equal nodes, (U,), and the kind of each node, (M,)."""
    size, count = _size(stars), len(stars)
    most = np.minimum(stars.most, MOST_ROOM * size)
    lengths = [stars.radii, stars.blends[:, None], stars.balls[:, None]]
    ratios = [stars.directions, stars.slopes, stars.vertices]
    rows = [np.rint(each / (SAME * size)) for each in lengths]
    rows += [np.rint(most / (ROOM * size)), np.log10(size)]
    rows += [np.rint(each.reshape(count, -1) / SAME) for each in ratios]
    rows.append(stars.quads.reshape(count, -1).astype(np.float64))
    table = np.ascontiguousarray(np.concatenate(rows, axis=1) + 0.0)  # no -0.0
    keys = table.view(np.dtype((np.void, table.shape[1] * table.itemsize))).reshape(-1)
    _, first, kind = np.unique(keys, return_index=True, return_inverse=True)
    return first, kind.reshape(-1)
