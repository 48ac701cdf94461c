"""The inside of hollow nodes: the outer surface, a wall further in.

The patches of the inside begin as those outside, moved in by the wall. Then their samples slide to
where the outer surface is a wall away, while smooth patches are fitted to them, and where patches
come nearer than that, their samples are wanted further in from round to round by what the wall
lacks: the multipliers of Uzawa's method, which find a surface that keeps the wall everywhere. So a
wall may be a little thicker than asked, not thinner.

Collars are those outside, moved in as well: between them a wall is exact.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import isnan

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, place_text
from scaffold_cad.base.blocks import CACHE, cut
from scaffold_cad.base.counts import tracked
from scaffold_cad.base.threads import in_order
from scaffold_cad.struts.blending.blend import Originals, Skins, Solved, best_by_layout
from scaffold_cad.struts.blending.fits import TypeFit
from scaffold_cad.struts.blending.fitting import pieces_of_patches
from scaffold_cad.struts.blending.joins import types_of
from scaffold_cad.struts.blending.layouts import Layout
from scaffold_cad.struts.blending.proof import prove
from scaffold_cad.struts.hollow.eyes import seen_from_eyes
from scaffold_cad.struts.hollow.gaps import LEVELS, Gaps
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.room import SPARE
from scaffold_cad.struts.runs import Runs

KEPT = 0.98
"""Part of the wall that is thick enough for no other way to be tried."""
LEAST = 0.95
"""Part of the wall below which an inside is not taken: patches that fold at first may stay so."""
THICKEST = (1.25, 0.03)
"""Greatest wall of an inside that is taken: parts of the wall, and of the node's greatest radius.
Smoother surfaces keep walls as well, but cut off what is narrow: tips between struts."""
THINNER = (0.9, 0.75, 0.6, 0.45)
"""Parts of a wall that no inside leaves that are tried for one that some inside does."""
AIM = 1.01
"""What walls are to be at samples, over what is asked for: between samples they can be thinner."""
PUSH = 1.5
"""Part of what a wall lacks by which its sample is wanted further in from a round on."""
ENOUGH = 0.99
"""Least gap of samples, over the wall, at which a node is pushed no more."""
MOMENTUM = 0.7
"""Part of its last move that a sample goes on along the surface while patches settle."""
SAMPLE_BYTES = 128
"""What a sample of the outer surface takes where it is treated."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class InsideRecipe:
    """One way to fit the inside of a node."""

    layout: Layout
    """How patches are cut and sampled; into more pieces where those outside are."""
    settling: tuple[tuple[float, int], ...]
    """Weights of the thin-plate energy, and for how many rounds each, as patches settle."""
    pushing: int
    """Rounds in which walls that are too thin are pushed, with the last of the weights."""


RECIPES = (
    InsideRecipe(Layout(1, 1, 7), ((1e-2, 1), (1e-3, 4), (1e-4, 4), (1e-5, 4)), 25),
    InsideRecipe(Layout(2, 2, 5), ((1e-4, 6), (1e-5, 8)), 30),
    InsideRecipe(Layout(2, 2, 7), ((1e-6, 12),), 30),
    InsideRecipe(Layout(2, 2, 5), ((1e-3, 4), (1e-4, 6), (1e-5, 6)), 30),
    InsideRecipe(Layout(2, 2, 5), ((1e-3, 6), (1e-4, 8)), 30),
)
"""Tried in this order, each for the nodes that the ones before left unproved or thin."""


def hollow_nodes(outer: RoundStruts, runs: Runs, wall: float) -> Iterator[BlendedNodes]:
    """Yield the insides of those nodes that have room for them and whose insides are proved.

    Parameters
    ----------
    outer : what they are the inside of
    runs : those of the inside, numbered like the outer ones
    wall : thickness, mm
    """
    fits = ~outer.crowded & have_room(outer, runs, wall)
    for group in outer.blended:
        rows = np.flatnonzero(fits[group.nodes])
        some = group[rows]
        used, which = np.unique(some.originals.which, return_inverse=True)
        skins = some.originals.skins[used]
        for kinds, made in insides(skins, wall):
            shapes = np.flatnonzero(np.isin(which, kinds))
            inside = Originals(
                replace(skins[kinds], shapes=made),
                np.searchsorted(kinds, which[shapes]),
                some.originals.views[shapes],
            )
            nodes = np.flatnonzero(np.isin(some.shape_of, shapes))
            yield replace(some[nodes], shapes=inside.turned(), originals=inside)


def have_room(outer: RoundStruts, runs: Runs, wall: float) -> Bools:
    """Return the nodes whose collars, moved in, fit on the runs of the inside, shape (n,)."""
    slopes = outer.runs.slopes
    reach = np.where(outer.collar > 0, outer.collar + wall * slopes / np.hypot(1.0, slopes), 0.0)
    short = reach.reshape(-1, 2).sum(axis=1) > runs.lengths * (1 - SPARE / 2)
    fits = np.ones(len(runs.nodes), dtype=np.bool_)
    fits[runs.edges[short]] = False
    return fits


def limits_beside(runs: Runs, made: list[BlendedNodes], limits: Floats) -> Floats:
    """Return the limits (2 k,) of collars, on runs whose other collar is that of a node made."""
    limits = limits.copy()
    for part in made:
        used = part.shapes.collar_distances[part.shape_of]
        left = (1 - SPARE) * runs.lengths[part.half_runs >> 1] - used
        limits[part.half_runs ^ 1] = np.minimum(limits[part.half_runs ^ 1], left)
    return limits


def insides(
    skins: Skins, wall: float, recipes: tuple[InsideRecipe, ...] = RECIPES
) -> list[tuple[Ints, Solved]]:
    """Return the insides that are proved and not thin, those of one layout together, by row.

    Parameters
    ----------
    skins : the outer surfaces
    wall : thickness, mm
    recipes : tried one after the other
    """
    best: list[Solved] = []
    count = len(skins)
    score, trial, place = np.full(count, -np.inf), np.full(count, -1), np.zeros(count, np.intp)
    open_nodes = np.arange(count)
    outside = skins.shapes.layout
    for recipe in recipes:
        if len(open_nodes) == 0:
            break
        if recipe.layout.along_arc == 1 < outside.along_arc:
            continue
        layout = recipe.layout.at_least(outside)
        found, least = _solved(skins[open_nodes], wall, replace(recipe, layout=layout))
        value = np.where(found.proved, least, -np.inf)
        better = value > score[open_nodes]
        trial[open_nodes[better]], place[open_nodes[better]] = len(best), np.flatnonzero(better)
        score[open_nodes[better]] = value[better]
        best.append(found)
        open_nodes = open_nodes[score[open_nodes] < KEPT * wall]
    trial[score < LEAST * wall] = -1
    return list(best_by_layout(best, trial, place))


def _solved(skins: Skins, wall: float, recipe: InsideRecipe) -> tuple[Solved, Floats]:
    """Return the insides that a recipe gives, and their least walls, (U,), mm; -inf if thick."""
    kinds = types_of(skins.quads)
    order = np.argsort(kinds.type_of, kind="stable")
    samples = 4 * skins.axes.shape[1] * LEVELS**2  # of a node

    def work(rows: Ints) -> tuple[Solved, Floats]:
        some = skins[rows]
        gaps = Gaps(some.shapes)
        made = _fitted(some, kinds.sides[rows], kinds.parts(rows), gaps, wall, recipe)
        least, most = gaps.least_and_most(made)
        part, more = THICKEST
        least[most > part * wall + more * some.shapes.collar_radii.max(axis=1)] = -np.inf
        hidden = np.flatnonzero(~made.proved & (least >= LEAST * wall))
        return seen_from_eyes(made, some.axes, hidden), least

    parts = list(cut(order, samples * SAMPLE_BYTES, CACHE))
    done = list(tracked("insides", in_order(work, parts), [len(rows) for rows in parts]))
    back = np.argsort(order)
    least = np.concatenate([each for _, each in done])
    return Solved.joined([each for each, _ in done])[back], least[back]


def _fitted(
    skins: Skins,
    sides: Ints,
    parts: tuple[tuple[slice, Ints], ...],
    gaps: Gaps,
    wall: float,
    recipe: InsideRecipe,
) -> Solved:
    """Return the insides of nodes that are in the order of their types.

    Parameters
    ----------
    sides : (U, 4 N) each node's own number of each side of its type
    parts : the nodes of each type, and the twins of its sides
    """
    shapes, layout = skins.shapes, recipe.layout
    row = np.arange(len(skins))[:, None]
    cosines = 1 / np.hypot(1.0, skins.slopes)
    distances = shapes.collar_distances + wall * cosines * skins.slopes
    radii = shapes.collar_radii - wall * cosines
    control = shapes.control[row, sides]  # (U, 4 N, n_u, n_v, 3)
    moved = (distances, radii)
    rows = _given_rows(skins, control, moved, sides // 4, layout)
    fits = _Fits(rows, parts, layout)
    wanted = _moved_in(shapes.layout, control, layout, wall)
    wanted = _settled(fits, wanted, gaps, AIM * wall, recipe.settling)
    found = _pushed(fits, wanted, gaps, wall, recipe.pushing)
    own = np.empty((*found.shape[1:], 3))
    own[row, sides] = np.moveaxis(found, 0, -1)
    proof = prove(pieces_of_patches(own, layout), distances, radii)
    return replace(
        shapes,
        layout=layout,
        control=own,
        collar_distances=distances,
        collar_radii=radii,
        rho=shapes.rho + wall,
        is_star_shaped=proof.is_star_shaped,
        solid_angle=proof.solid_angle,
        least_cosine=proof.least_cosine,
    )


class _Fits:
    """The fits of nodes of several types."""

    def __init__(self, rows: Floats, parts: tuple[tuple[slice, Ints], ...], layout: Layout) -> None:
        self._parts = [part for part, _ in parts]
        self._fits = [TypeFit(twins, layout, rows[:, part]) for part, twins in parts]

    def stiffen(self, stiffness: float) -> None:
        for fit in self._fits:
            fit.stiffen(stiffness)

    def samples(self, wanted: Floats) -> Floats:
        """Return the samples of the surfaces that are best for those wanted, both (3, U, q)."""
        both = zip(self._fits, self._parts, strict=True)
        return np.concatenate([fit.samples(wanted[:, part]) for fit, part in both], axis=1)

    def control(self) -> Floats:
        """Return the control points of the last surfaces, (3, U, 4 N, n_u, n_v)."""
        return np.concatenate([fit.control() for fit in self._fits], axis=1)


def _settled(
    fits: _Fits, wanted: Floats, gaps: Gaps, aim: float, settling: tuple[tuple[float, int], ...]
) -> Floats:
    """Return wanted samples (3, U, q) that have slid to where the surface is even."""
    every = np.arange(wanted.shape[1])
    before: Floats | None = None
    for stiffness, rounds in settling:
        fits.stiffen(stiffness)
        for _ in range(rounds):
            samples = fits.samples(wanted)
            ahead = samples if before is None else samples + MOMENTUM * (samples - before)
            before = samples
            gap, normals = gaps.measured(np.moveaxis(ahead, 0, -1), every)
            wanted = ahead - (aim - gap) * np.moveaxis(normals, -1, 0)
    return wanted


def _pushed(fits: _Fits, wanted: Floats, gaps: Gaps, wall: float, rounds: int) -> Floats:
    """Return the control points of surfaces whose samples are pushed in until walls are enough."""
    pushes = np.zeros(wanted.shape[1:])
    thin = np.arange(len(pushes))  # nodes whose walls are too thin somewhere
    for _ in range(rounds):
        samples = fits.samples(wanted)[:, thin]
        gap, normals = gaps.measured(np.moveaxis(samples, 0, -1), thin)
        lack = AIM * wall - gap
        pushes[thin] += PUSH * np.where(gap < wall, lack, 0.0)
        wanted[:, thin] = samples - (lack + pushes[thin]) * np.moveaxis(normals, -1, 0)
        thin = thin[gap.min(axis=1) < ENOUGH * wall]
    fits.samples(wanted)
    return fits.control()


def _given_rows(
    skins: Skins, control: Floats, moved: tuple[Floats, Floats], strut: Ints, layout: Layout
) -> Floats:
    """Return the two rows at the collars among control points (3, U, 4 N, n_u, n_v), 0 elsewhere.

    Parameters
    ----------
    control : (U, 4 N, n_u, n_v, 3) of the outer surface
    moved : two (U, N), distances and radii of the collars inside
    strut : (U, 4 N) of each patch
    """
    shapes, outside = skins.shapes, skins.shapes.layout
    row = np.arange(len(skins))[:, None]
    axes = skins.axes[row, strut][:, :, None]  # (U, 4 N, 1, 3)
    was, is_now = (
        each[row, strut][..., None, None] for each in (shapes.collar_distances, moved[0])
    )
    growth = (moved[1] / shapes.collar_radii)[row, strut][..., None, None]
    last = is_now * axes + growth * (control[..., -1, :] - was * axes)  # (U, 4 N, n_u, 3)
    step = (control[..., -2, :] - control[..., -1, :]) * (layout.v.step / outside.v.step)
    if layout.along_arc != outside.along_arc:
        last, step = layout.u.refinement @ last, layout.u.refinement @ step
    rows = np.zeros((3, *last.shape[:3], layout.v.count))
    rows[..., -1], rows[..., -2] = np.moveaxis(last, -1, 0), np.moveaxis(last + step, -1, 0)
    return rows


def _moved_in(outside: Layout, control: Floats, layout: Layout, wall: float) -> Floats:
    """Return samples of the outer surface, moved in by the wall, (3, U, samples)."""
    patches = np.moveaxis(control, -1, 0)
    u, v = layout.at_u, layout.at_v

    def evaluated(order_u: int, order_v: int) -> Floats:
        across = outside.u.values_at(u, order_u) @ patches
        return np.asarray(across @ outside.v.values_at(v, order_v).T)

    normals = np.cross(evaluated(1, 0), evaluated(0, 1), axis=0)
    normals /= np.sqrt((normals**2).sum(axis=0))
    inside = evaluated(0, 0) - wall * normals
    return np.asarray(inside.reshape(3, len(control), -1))


def fitting_wall(skins: Skins, wall: float) -> float:
    """Return a wall, mm, less than `wall`, that a smooth inside leaves; 0 if none is found."""
    for share in THINNER:
        tried = float(f"{share * wall:.3g}")
        if insides(skins, tried, RECIPES[:2]):  # the others seldom help, and take longer
            return tried
    return 0.0


def tell_thin(nodes: Ints, wall: float, places: Points, fitting: float | None = None) -> None:
    """Log nodes whose walls would be too thin.

    Parameters
    ----------
    nodes : the first is the one whose place is told
    places : (n,) of all nodes, mm
    fitting : the thickest wall that fits there, mm; 0 if none does, None if not looked for, nan
        where a strut is too short for any
    """
    if len(nodes):
        one = len(nodes) == 1
        thinner = "a thinner wall, " if fitting is None else ""
        if fitting is not None and isnan(fitting):
            thinner = "longer struts, shallower sockets, "
        elif fitting:
            thinner = f"a wall of {fitting:g} mm{'' if one else ' there'}, "
        _log.warning(
            "no inside of %s %s leaves a wall of %g mm%s at %s; %s crowded: need %s"
            "thicker struts or wider angles for %s",
            "node" if one else "nodes",
            ", ".join(map(str, nodes.tolist())),
            wall,
            "" if one else ", the first",
            place_text(places[nodes[0]]),
            "it is" if one else "they are",
            thinner,
            "a smooth one" if one else "smooth ones",
        )
