"""Nodes of one valency, and the blends that they get, outside and inside of walls."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, place_text
from scaffold_cad.struts.blending.blend import Stars
from scaffold_cad.struts.blending.nodes import blends
from scaffold_cad.struts.hollow.insides import LEAST, fitting_wall, have_room, tell_thin
from scaffold_cad.struts.hollow.walls import walls_at
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.options import BLEND
from scaffold_cad.struts.runs import Runs

INNER_FILLETS = (1.0, 0.5)
"""Fillets that are tried inside of hollow nodes whose inside is not the outer surface moved in, in
radii of the widest, which leaves a wall where struts meet at right angles. Tighter ones leave
thicker walls."""

SHRUNK = 0.7
"""What is left of a fillet that is not sound, until one is."""
CLOSE = 0.1
"""How much wider than a sound fillet one may be that is not: the widest is not looked for further.
Each trial costs as much as all recipes."""
SAME_FILLET = 1e-6
"""Part of a fillet radius below which two are one: the radius reached is found by bisection."""

TOLD = 1e-3
"""Part of a fillet radius that may be missing before it is reported."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Group:
    """Nodes of one valency."""

    nodes: Ints
    """Shape (M,)."""
    half_runs: Ints
    """Shape (M, N)."""

    def __getitem__(self, rows: Ints) -> Group:
        return Group(self.nodes[rows], self.half_runs[rows])


def with_blends(group: Group, stars: Stars) -> Iterator[BlendedNodes]:
    """Yield the blends of nodes, those together whose patches are cut alike.

    Where a fillet wider than `BLEND` radii of the thinnest strut is not sound, it shrinks until it
    is, and grows again as far as that is known. A node none of whose fillets is keeps the one
    asked for.
    """
    made = list(_as_asked(group, stars))
    least = BLEND * stars.radii.min(axis=1)
    # The tightest fillet that is not sound and the widest that is, 0 where none is known, (M,).
    failed, passed = np.zeros(len(stars)), np.zeros(len(stars))
    _note(made, group, stars.blends, failed, passed)
    while True:
        narrowest = np.where(passed > 0, (1 + CLOSE) * passed, (1 + SAME_FILLET) * least)
        rows = np.flatnonzero(failed > narrowest)
        if len(rows) == 0:
            break
        lower = np.maximum(SHRUNK * failed[rows], least[rows])
        trial = np.where(passed[rows] > 0, np.sqrt(passed[rows] * failed[rows]), lower)
        tried = list(_as_asked(group[rows], replace(stars[rows], blends=trial)))
        now_failed, now_passed = np.zeros(len(rows)), np.zeros(len(rows))
        _note(tried, group[rows], trial, now_failed, now_passed)
        failed[rows] = np.where(now_passed > 0, failed[rows], now_failed)
        passed[rows] = np.where(now_passed > 0, now_passed, passed[rows])
        sound = [_sound_ones(each) for each in tried]
        done = np.concatenate([each.nodes for each in sound])
        made = [each[np.flatnonzero(~np.isin(each.nodes, done))] for each in made] + sound
    yield from (each for each in made if len(each.nodes))


def reached_fillets(
    groups: list[Group], wanted: list[Stars], solved: tuple[BlendedNodes, ...], crowded: Bools
) -> Floats:
    """Return the fillet radius at each node, (n,), mm; nan at those without a blend.

    Those of crowded nodes are in a field, which has them as wide as asked for.
    """
    asked, reached = np.full((2, len(crowded)), np.nan)
    for group, stars in zip(groups, wanted, strict=True):
        asked[group.nodes] = stars.blends
    for part in solved:
        reached[part.nodes] = part.shapes.rho[part.shape_of]
    return np.where(crowded | (reached > (1 - SAME_FILLET) * asked), asked, reached)


def _note(
    made: list[BlendedNodes], group: Group, asked: Floats, failed: Floats, passed: Floats
) -> None:
    """Note in `failed` and `passed` (M,) which fillets `asked` for (M,) are sound.

    Nodes without room for any are neither: what is crowded stays so.
    """
    for each in made:
        place = np.searchsorted(group.nodes, each.nodes)
        reached = np.minimum(asked[place], each.shapes.rho[each.shape_of])
        sound = each.shapes.sound[each.shape_of]
        passed[place[sound]] = reached[sound]
        is_off = ~sound & each.shapes.has_room[each.shape_of]
        failed[place[is_off]] = reached[is_off]


def _sound_ones(blended: BlendedNodes) -> BlendedNodes:
    """Return those of the blends that are sound."""
    return blended[np.flatnonzero(blended.shapes.sound[blended.shape_of])]


def _as_asked(group: Group, stars: Stars) -> Iterator[BlendedNodes]:
    """Yield the blends of nodes with the fillets asked for."""
    for found in blends(stars):
        _, first = np.unique(found.shape_of, return_index=True)
        yield BlendedNodes(
            group.nodes[found.nodes],
            group.half_runs[found.nodes],
            found.stars.quads[first],
            found.stars.directions[first],
            found.shape_of,
            found.shapes,
            found.originals,
        )


def with_walls(
    group: Group, stars: Stars, outer: RoundStruts, runs: Runs, wall: float
) -> Iterator[BlendedNodes]:
    """Yield blends inside of nodes, with the widest fillets that leave a wall.

    Where none does, the last one has no room. Walls of nodes that are crowded do not count.

    Parameters
    ----------
    outer, runs : what they are the inside of, and their own runs
    wall : thickness, mm
    """
    for share in INNER_FILLETS:
        found = list(with_blends(group, replace(stars, blends=share * stars.blends)))
        least = walls_at(outer.blended, found, len(outer.crowded))
        is_thin = (least < LEAST * wall) & ~outer.crowded
        is_last = share == INNER_FILLETS[-1]
        if is_last and is_thin.any():
            _tell_thinnest(outer, runs, np.flatnonzero(is_thin), least, wall)
        for each in found:
            if is_last:
                yield _without_room(each, is_thin)
            elif not is_thin[each.nodes].all():
                yield each[np.flatnonzero(~is_thin[each.nodes])]
        left = np.flatnonzero(is_thin[group.nodes])
        if len(left) == 0:
            return
        group, stars = group[left], stars[left]


def _tell_thinnest(outer: RoundStruts, runs: Runs, nodes: Ints, least: Floats, wall: float) -> None:
    """Log nodes whose walls would be too thin, the thinnest first, and what that one has room for.

    Parameters
    ----------
    least : (n,) the walls reached, mm
    """
    nodes = nodes[np.argsort(least[nodes], kind="stable")]
    (group,) = (each for each in outer.blended if nodes[0] in each.nodes)
    which = group.originals.which[group.shape_of[group.nodes == nodes[0]]]
    fitting = np.nan
    if have_room(outer, runs, wall)[nodes[0]]:
        fitting = fitting_wall(group.originals.skins[which], wall)
    tell_thin(nodes, wall, outer.runs.nodes, fitting)


def _without_room(blended: BlendedNodes, is_thin: Bools) -> BlendedNodes:
    """Return blends of which those of thin nodes (n,) have no room."""
    has_room = blended.shapes.has_room.copy()
    has_room[blended.shape_of[is_thin[blended.nodes]]] = False
    return replace(blended, shapes=replace(blended.shapes, has_room=has_room))


def tell_shrunk(struts: RoundStruts) -> None:
    """Log how many fillets are tighter than was asked for, and the tightest."""
    if struts.options.blend is None:
        return
    asked = np.broadcast_to(struts.options.blend, struts.fillet.shape)
    tight = np.flatnonzero(~struts.crowded & (struts.fillet < (1 - TOLD) * asked))
    if len(tight):
        least = tight[(struts.fillet / asked)[tight].argmin()]
        _log.warning(
            "%s shrunk: node %d at %s has %.3g mm of the %g mm asked for; wider ones need longer "
            "or thicker struts, or wider angles",
            "1 fillet is" if len(tight) == 1 else f"{len(tight)} fillets are",
            least,
            place_text(struts.skeleton.nodes[least]),
            struts.fillet[least],
            asked[least],
        )
