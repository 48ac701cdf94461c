"""The edges around each face of round struts, and their parameters on it."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.struts.breps.plan import FacePlan, domes, groups_of, owners
from scaffold_cad.struts.breps.seams import QUARTER
from scaffold_cad.struts.meshes.rings import angles_at, parameters_at

TURN = 2 * np.pi

Uses = tuple[Ints, Ints, Ints, Bools, Floats]
"""Face, place in its loop, edge, whether it runs along it, and parameters (u, 2, 2) of uses."""


def patch_uses(plan: FacePlan) -> Uses:
    """Return the edges around patches: an arc, a spoke, the collar's quarter, the spoke before."""
    parts: list[Uses] = []
    for group, _, edge, face in groups_of(plan):
        quads = group.quads[group.shape_of]
        nodes, valency = quads.shape[:2]
        own_arc, owns = owners(quads)
        arcs = edge + 2 * valency * np.arange(nodes)[:, None]
        spokes = edge + 2 * valency * nodes + 4 * valency * np.arange(nodes)[:, None]
        side = np.arange(4 * valency)
        following = (side & ~3) | ((side + 1) & 3)
        faces = (face + np.arange(nodes * 4 * valency)).reshape(nodes, -1)
        half_run = np.repeat(group.half_runs, 4, axis=1)
        quarter = np.tile(np.arange(4), (nodes, valency))
        zero, one = np.zeros(half_run.shape), np.ones(half_run.shape)
        ahead = np.where(owns, 0.0, 1.0)
        parts.append(_rows(faces, 0, arcs + own_arc, owns, (ahead, zero, 1 - ahead, zero)))
        parts.append(_rows(faces, 1, spokes + following, True, (one, zero, one, one)))
        parts += _arc_uses(plan, faces, 2, half_run, quarter, 1)
        parts.append(_rows(faces, 4, spokes + side, False, (zero, zero, zero, one)))
    return joined(parts)


def curve_uses(plan: FacePlan) -> Uses:
    """Return the edges around the patches of curves: a circle, a spoke, a circle, a spoke."""
    parts, quarter = plan.curves, np.arange(4)
    count = len(parts.first)
    number = np.arange(count)[:, None]
    faces = plan.curve_faces + 4 * number + quarter  # (q, 4)
    spokes = plan.curve_spokes + 4 * number
    zero, one = np.zeros((count, 4)), np.ones((count, 4))
    found = [
        _rows(faces, 10, spokes + (quarter + 1) % 4, True, (one, zero, one, one)),
        _rows(faces, 30, spokes + quarter, False, (zero, zero, zero, one)),
    ]
    own = parts.rings[:, 0] >= 0
    rings = plan.curve_rings + 4 * parts.rings[own][:, :, None] + quarter  # (q', 2, 4)
    none, all_of_it = zero[own], one[own]
    ahead = (none, none, all_of_it, none)
    found.append(_rows(faces[own], 0, rings[:, 0], True, ahead))
    ahead = (none, all_of_it, all_of_it, all_of_it)
    found.append(_rows(faces[own], 20, rings[:, 1], False, ahead))
    for side in (0, 1):
        half_run = np.repeat(parts.half_runs[~own, side, None], 4, axis=1)
        own_quarter = np.broadcast_to(quarter if side else 3 - quarter, half_run.shape)
        found += _arc_uses(plan, faces[~own], 20 * side, half_run, own_quarter, side)
    return joined(found)


def torus_uses(plan: FacePlan) -> Uses:
    """Return the edges around tori: a circle, the seam, the other circle, the seam.

    Circles begin at the outside of the bend, where the seam is.
    """
    tori, count = plan.tori, len(plan.tori.radii)
    faces = (plan.torus_faces + np.arange(count))[:, None]
    seam = (plan.torus_seams + np.arange(count))[:, None]
    zero, turn = np.zeros((count, 1)), tori.turns[:, None]
    found = [
        _rows(faces, 20, seam, True, (zero, zero, turn, zero)),
        _rows(faces, 60, seam, False, (zero, zero + TURN, turn, zero + TURN)),
    ]
    for side, quarter in ((side, quarter) for side in (0, 1) for quarter in range(4)):
        half_run = tori.half_runs[:, side, None]
        own_quarter = np.full_like(half_run, quarter if side else 3 - quarter)
        place = 40 + 4 * (3 - quarter) if side else 4 * quarter
        for of, rank, edge, along, places in _arc_uses(
            plan, faces, place, half_run, own_quarter, side
        ):
            angle = QUARTER * quarter + angles_at(places[..., 0])
            turned = (side * tori.turns[of - plan.torus_faces])[:, None] + 0 * angle
            found.append((of, rank, edge, along, np.stack([turned, TURN - angle], axis=-1)))
    return joined(found)


def _arc_uses(
    plan: FacePlan, faces: Ints, place: int, half_run: Ints, quarter: Ints, side: int
) -> list[Uses]:
    """Return the uses, against their direction, of quarters of circles by patches at v = `side`.

    A quarter that a seam splits is two edges. At v = 0 the patch runs against it too.
    """
    base = plan.base_arcs + 4 * plan.rank[half_run] + quarter
    split = plan.split_rank[half_run]
    is_split = (split >= 0) & (plan.seams.quarter[half_run] == quarter)
    at = np.ones(half_run.shape)
    at[is_split] = parameters_at(plan.seams.angle[half_run[is_split]] - QUARTER * quarter[is_split])
    v, zero, one = np.full_like(at, side), np.zeros_like(at), np.ones_like(at)
    if side == 0:
        at, zero, one = 1 - at, one, zero
    rest = (at[is_split], v[is_split], one[is_split], v[is_split])
    return [
        _rows(faces[is_split], place, plan.rest_arcs + split[is_split], False, rest),
        _rows(faces, place + 1, base, False, (zero, v, at, v)),
    ]


def strut_uses(plan: FacePlan) -> Uses:
    """Return the edges around each strut's face: a ring, the seam, the other ring, the seam."""
    runs, near = plan.struts.runs, plan.seams.near
    face = plan.strut_faces + plan.run_face
    collars = plan.struts.collar
    height = runs.lengths - collars[near] - collars[near ^ 1]
    height = height * np.hypot(1.0, runs.slopes[near])  # along the generators
    seam = np.arange(len(near))
    zero, turn = np.zeros(len(near)), np.full(len(near), TURN)
    parts = [
        *_ring_uses(plan, face, near, 0, np.zeros(len(near)), True),
        _rows(face, 20, seam, True, (turn, zero, turn, height)),
        *_ring_uses(plan, face, near ^ 1, 30, height, False),
        _rows(face, 50, seam, False, (zero, zero, zero, height)),
    ]
    return joined(parts)


def _ring_uses(
    plan: FacePlan, face: Ints, half_runs: Ints, place: int, height: Floats, along: bool
) -> list[Uses]:
    """Return the uses of the rings of half-runs by their struts' faces, from the seams on.

    Parameters
    ----------
    place : in the loop of the first arc
    height : (k,) parameter v of the ring
    along : whether the face's u grows along the ring
    """
    parts = []
    at_end = plan.end_rank[half_runs] >= 0
    rings = plan.end_rings + plan.end_rank[half_runs[at_end]]
    zero = np.zeros(len(rings))
    first, last = (zero, zero + TURN) if along else (zero + TURN, zero)
    v = height[at_end]
    parts.append(_rows(face[at_end], place, rings, True, (first, v, last, v)))
    face, half_runs, height = face[~at_end], half_runs[~at_end], height[~at_end]
    is_split = plan.split_rank[half_runs] >= 0
    start = plan.seams.quarter[half_runs]
    angle = plan.seams.angle[half_runs]
    left = np.where(is_split, QUARTER * (start + 1) - angle, QUARTER)  # of the first quarter
    passed = np.zeros(len(face))
    for step in range(5):
        quarter = (start + step) % 4
        base = plan.base_arcs + 4 * plan.rank[half_runs] + quarter
        rest = plan.rest_arcs + plan.split_rank[half_runs]
        edge, width = base, np.full(len(face), QUARTER)
        if step == 0:
            edge, width = np.where(is_split, rest, base), left
        if step == 4:
            width = QUARTER - left
        begin, end = passed, passed + width
        if not along:
            begin, end = TURN - begin, TURN - end
        chosen = is_split if step == 4 else np.ones(len(face), dtype=np.bool_)
        columns = (begin[chosen], height[chosen], end[chosen], height[chosen])
        parts.append(_rows(face[chosen], place + 1 + step, edge[chosen], True, columns))
        passed = passed + width
    return parts


def cap_uses(plan: FacePlan) -> Uses:
    """Return the rings around plane ends."""
    count = len(plan.discs)
    nothing = np.full(count, np.nan)
    rings = plan.end_rings + plan.discs
    return _rows(np.arange(count), 0, rings, False, (nothing, nothing, nothing, nothing))


def dome_uses(plan: FacePlan) -> Uses:
    """Return the edges around spheres at round ends: the ring, and a meridian to the pole."""
    _, _, low = domes(plan)
    count = len(plan.balls)
    face, number = plan.domes + np.arange(count), np.arange(count)
    zero, turn, top = np.zeros(count), np.full(count, TURN), np.full(count, QUARTER)
    ring, meridian = plan.end_rings + plan.balls, plan.meridians + number
    return joined(
        [
            _rows(face, 0, ring, False, (turn, low, zero, low)),
            _rows(face, 1, meridian, True, (turn, low, turn, top)),
            _rows(face, 2, meridian, False, (zero, low, zero, top)),
        ]
    )


def _rows(
    face: Ints, place: int, edge: Ints, forward: Bools | bool, parameters: tuple[Floats, ...]
) -> Uses:
    """Return uses in flat arrays; `parameters` are u and v at the edge's start, then at its end."""
    face = face.reshape(-1)
    along = np.broadcast_to(forward, edge.shape).reshape(-1)
    both = np.stack([each.reshape(-1) for each in parameters], axis=1).reshape(-1, 2, 2)
    return face, np.full(len(face), place), edge.reshape(-1), along, both


def joined(parts: list[Uses]) -> Uses:
    """Return several uses in one."""
    if not parts:
        empty = np.empty(0, dtype=np.intp)
        return empty, empty, empty, np.empty(0, dtype=np.bool_), np.empty((0, 2, 2))
    face, place, edge, forward, parameters = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    return face, place, edge, forward, parameters
