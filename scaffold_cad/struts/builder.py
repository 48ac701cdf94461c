"""round_struts(): from a skeleton to exact struts with blends at their nodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.struts.apart import crossings
from scaffold_cad.struts.curves.curve import Curves, curves
from scaffold_cad.struts.curves.proof import proved
from scaffold_cad.struts.elbows import elbow_curves
from scaffold_cad.struts.groups import reached_fillets, tell_shrunk, with_blends, with_walls
from scaffold_cad.struts.hollow.curvewalls import with_walls_along
from scaffold_cad.struts.hollow.insides import hollow_nodes, limits_beside, tell_thin
from scaffold_cad.struts.hollow.sockets import sockets_of
from scaffold_cad.struts.hollow.walls import check_wall, end_walls, without_wall
from scaffold_cad.struts.likes import check_like
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.options import Bend, Blend, Ends, Joints, Nodes, StrutOptions, as_blend
from scaffold_cad.struts.plan import Plan, planned
from scaffold_cad.struts.room import allotted
from scaffold_cad.struts.runs import Runs, ball_collars, ball_ends, straight_runs
from scaffold_cad.struts.sharp.balls import with_balls
from scaffold_cad.struts.sharp.builder import sharp_struts
from scaffold_cad.struts.twists import untwisted


@checks_keywords()
def round_struts(
    skeleton: Skeleton,
    *,
    blend: Blend | None = None,
    ends: Ends = "flat",
    wall: float | None = None,
    joints: Joints = "auto",
    bend: Bend = "blend",
    sockets: Mapping[int, tuple[float, float]] | None = None,
    nodes: Nodes = "blend",
    like: RoundStruts | None = None,
) -> RoundStruts:
    """Return the struts of `skeleton` as exact cylinders and cones, blended at its nodes.

    Parameters
    ----------
    skeleton : as `check_skeleton` asks; its edge radii are those of the struts. A node whose own
        radius is larger than those is a ball, blended with its struts
    blend : fillet radius at the nodes, mm; by default half the radius of a node's thinnest strut.
        Where there is no room for it, or none so wide is proved, it shrinks, to a tenth of the
        struts' radii at least. One number, one for each node, shape (n,), or a function of
        positions (n, 3), such as a sampled field
    ends : how struts end: "flat" at their node, "round" beyond it, or "open" with a wall
    wall : thickness of hollow struts, mm
    joints : how struts pass joints of two edges: "blend" as bends with a fillet between exact
        cylinders; "curve" smoothly, with a circle of their radius in the plane that halves the
        angle, where they can; by default the latter where a joint is a sample of a curve: it turns
        by at most 45°, the shorter edge is at most 6 radii long, and the arc over it rises a
        quarter of the radius at most; or where its edges are too short for a bend
    bend : how two cylinders of one radius meet at a bend that is not of a curve: "blend", or as an
        exact torus, tangent to both: "torus" for a centerline radius of 1.5 diameters, or what
        there is room for; or that radius, mm. A bend without room stays a blend, and the log says
        why
    sockets : inner radius and depth, mm, of open ends of hollow struts that take tubes, by node:
        `{3: (14.375, 25)}`
    nodes : what is at nodes: a "blend"; a "ball", as in space frames, of the node's radius, or as
        large as every strut's circle needs on it; or "sharp" edges in which the struts meet: the
        union of their cylinders, cones and balls, without a fillet. Bends of two equal struts of at
        most 90° meet in the plane between them, as mitred pipes do; behind the struts of other
        nodes there is the ball that touches the thickest. `blend`, `joints` and `bend` are for
        blends
    like : struts of the same skeleton with its nodes elsewhere: partitions and triangles stay, for
        animation and optimization, those of sharp nodes while their struts meet in the same edges

    Raises
    ------
    SkeletonError
        If the skeleton cannot be built on.
    OptionError
        If an option has no such value, or `like` is of another graph, with other ends or walls.
    PartitionError
        If nodes moved too far for the partitions of `like`, or are sharp and proved only here or
        there.

    Examples
    --------
    >>> from scaffold_cad import Skeleton
    >>> tips = [[9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> tripod = Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> struts = round_struts(tripod, blend=0.4)
    >>> struts.exact.tolist(), float(struts.fillet[0])
    ([True, True, True], 0.4)
    """
    check_skeleton(skeleton)
    options = StrutOptions(
        as_blend(blend, skeleton.nodes), ends, wall, joints, bend, sockets, nodes
    )
    if nodes == "ball":
        skeleton = with_balls(skeleton)
    if like is not None:
        check_like(skeleton, options, like)
    if wall is not None:
        check_wall(skeleton, wall)
        bored = sockets_of(sockets, skeleton, wall)
    outer = _built(skeleton, options, like)
    tell_shrunk(outer)
    if wall is None:
        return outer
    at_ends = end_walls(skeleton, wall, ends)
    at_ends[ball_ends(skeleton, outer.runs)] = 0.0  # they are a wall smaller themselves
    at_ends[bored.nodes] = bored.depths
    inside = without_wall(skeleton, wall, at_ends)
    bare = replace(options, wall=None, ends="flat", sockets=None)
    inner = _built(inside, bare, None if like is None else like.inner, outer)
    return replace(outer, sockets=bored, inner=replace(inner, options=options))


def _built(
    skeleton: Skeleton,
    options: StrutOptions,
    like: RoundStruts | None,
    outer: RoundStruts | None = None,
    blended: Bools | None = None,
) -> RoundStruts:
    """Return solid struts.

    Parameters
    ----------
    outer : what they are the inside of, whose fillets and curves theirs follow
    blended : (n,) bends that are blends in any case
    """
    if outer is not None:
        runs = outer.runs.within(skeleton)
    else:
        runs = straight_runs(skeleton) if like is None else like.runs.moved(skeleton)
    if options.is_sharp:
        return sharp_struts(skeleton, options, runs, like)
    plan = planned(skeleton, runs, options, like, outer, blended)
    wall = None if outer is None else outer.options.wall
    solved = [] if outer is None or wall is None else list(hollow_nodes(outer, runs, wall))
    # Nodes beside a run without room are crowded, and so is what is inside of crowded ones: for
    # them one recipe is enough.
    crowded = np.repeat(plan.no_room, 2)
    if outer is not None:
        crowded |= outer.crowded[runs.tails]
    limits = np.where(crowded, 0.0, plan.limits)
    solved = _solved(runs, plan, solved, limits_beside(runs, solved, limits), like, outer)
    if outer is None:
        limits, again = _shared(runs, plan, solved, limits)
        kept = [part[np.flatnonzero(~again[part.nodes])] for part in solved] if again.any() else []
        kept = [part for part in kept if len(part.nodes)]
        solved = _solved(runs, plan, kept, limits, like, outer) if again.any() else solved
    struts = _assembled(skeleton, options, runs, tuple(solved), plan, outer)
    if like is None and outer is None and (struts.crowded & np.isfinite(struts.bends)).any():
        lost = plan.elbows.crossing(runs.nodes, struts.crowded)
        lost = lost if blended is None else lost | blended
        return _built(skeleton, options, like, outer, lost)
    return replace(struts, like=like)


def _solved(
    runs: Runs,
    plan: Plan,
    solved: list[BlendedNodes],
    limits: Floats,
    like: RoundStruts | None,
    outer: RoundStruts | None,
) -> list[BlendedNodes]:
    """Return the nodes solved before, and all others with collars within limits (2 k,), mm."""
    solved, done = list(solved), np.zeros(len(runs.nodes), dtype=np.bool_)
    done[[node for part in solved for node in part.nodes.tolist()]] = True
    wall = None if outer is None else outer.options.wall
    wanted = list(zip(plan.groups, plan.wanted, strict=True))
    for group, stars in reversed(wanted):  # bends last: they are turned as what is beside them is
        left = np.flatnonzero(~done[group.nodes])
        if len(left) == 0:
            continue
        rest = group[left]
        asked = replace(stars[left], most=limits[rest.half_runs])
        if like is not None and rest.half_runs.shape[1] == 2:
            asked = untwisted(runs, rest, asked, _ring_starts(runs, solved), like)
        if outer is None or wall is None:
            solved += with_blends(rest, asked)
        else:
            solved += with_walls(rest, asked, outer, runs, wall)
    return sorted(solved, key=lambda part: part.half_runs.shape[1])


def _shared(
    runs: Runs, plan: Plan, solved: list[BlendedNodes], limits: Floats
) -> tuple[Floats, Bools]:
    """Return the limits (2 k,) of collars, and the nodes to be solved again within them, (n,).

    Collars also stand beyond the corners of their patches, further out than fillets ask for: where
    that is too far for a run, its nodes share what the fillets leave of it.
    """
    collar, again = plan.full.copy(), np.zeros(len(runs.nodes), dtype=np.bool_)
    for part in solved:
        collar[part.half_runs] = part.shapes.collar_distances[part.shape_of]
    tight = ~plan.no_room & (collar.reshape(-1, 2).sum(axis=1) > plan.room)
    again[runs.edges[tight]] = True
    shared, _ = allotted(collar, np.minimum(plan.full, collar), plan.room)
    return np.where(np.repeat(tight, 2), shared, limits), again


def _ring_starts(runs: Runs, solved: Iterable[BlendedNodes]) -> UnitVectors:
    """Return where the rings of half-runs begin, across them, (2 k, 3); zeros at other nodes."""
    x = np.zeros((len(runs.tails), 3))
    for group in solved:
        x[group.half_runs] = group.shapes.collar_corners[group.shape_of][:, :, 0]
    return x


def _assembled(
    skeleton: Skeleton,
    options: StrutOptions,
    runs: Runs,
    solved: tuple[BlendedNodes, ...],
    plan: Plan,
    outer: RoundStruts | None,
) -> RoundStruts:
    """Return the struts, once it is known which nodes are crowded."""
    collar, x = np.minimum(plan.joints.wanted, plan.limits), _ring_starts(runs, solved)
    collar += ball_collars(skeleton, runs)
    crowded = np.zeros(len(skeleton.nodes), dtype=np.bool_)
    for group in solved:
        made, which = group.shapes, group.shape_of
        collar[group.half_runs] = made.collar_distances[which]
        crowded[group.nodes[~made.sound[which]]] = True
    bends = np.full(len(skeleton.nodes), np.nan)
    bends[plan.elbows.nodes] = reached = plan.elbows.radii(collar)
    collar[plan.elbows.half_runs] = (reached * np.tan(plan.elbows.turns / 2))[:, None]
    no_room = plan.no_room | (collar.reshape(-1, 2).sum(axis=1) > runs.lengths)
    crowded[runs.edges[no_room]] = True
    passed = curves(runs, plan.joints, collar, x)
    passed = Curves.joined(passed, elbow_curves(runs, plan.elbows, reached))
    if outer is not None and outer.options.wall is not None:
        wall, left_out = outer.options.wall, crowded | outer.crowded
        passed, thin = with_walls_along(passed, outer.curves, left_out, wall)
        crowded[thin] = True
        tell_thin(thin, wall, runs.nodes)
    open_ones = ~passed.closed
    for side, first in enumerate((passed.offsets[:-1], passed.offsets[1:] - 1)):
        x[passed.half_runs[open_ones, side]] = passed.x[first[open_ones]]
    _turn_ends(runs, x)
    _crowd_curves(passed, crowded)
    crossing = crossings(runs, solved, passed, collar, options.ends, crowded)
    crowded |= crossing.nodes
    crowded_runs = no_room | crossing.struts | crowded[runs.edges].all(axis=1)
    fillet = reached_fillets(plan.groups, plan.wanted, solved, crowded)
    return RoundStruts(
        skeleton, options, runs, solved, collar, passed, x, fillet, bends, crowded, crowded_runs
    )


def _crowd_curves(passed: Curves, crowded: Bools) -> None:
    """Mark the joints of pieces of curves that are not proved."""
    folded = passed.pieces[~proved(passed)]
    joints = passed.nodes[np.append(folded, folded + 1)]
    crowded[joints[joints >= 0]] = True


def _turn_ends(runs: Runs, x: UnitVectors) -> None:
    """Let the rings at extremities begin where those at the other end of their run do."""
    ends = np.flatnonzero(runs.valency[runs.tails] == 1)
    x[ends] = x[ends ^ 1]
    lone = ends[(x[ends] == 0).all(axis=1)]
    first = lone[lone % 2 == 0]
    x[first] = any_perpendicular(runs.directions[first])
    x[first + 1] = x[first]
