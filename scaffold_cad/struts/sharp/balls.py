"""Balls at nodes, as those of space frames: large enough for every strut to end in a circle."""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors, place_text
from scaffold_cad.errors import SkeletonError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.repair import largest_at_nodes
from scaffold_cad.struts.runs import straight_runs

_log = logging.getLogger(__name__)

SPARE = 1.05
"""Radius of a ball over that of the one on which two circles touch."""
LARGE = 3.0
"""Radius of a ball, over that of its thickest strut, from which on it is reported."""
GROWING = 1.1
"""Growth of a ball in the last of these rounds from which on it has no end."""
TAPER_STEPS = 8
"""Rounds in which the circles of cones and their ball are found: each depends on the other."""


def with_balls(skeleton: Skeleton) -> Skeleton:
    """Return `skeleton` with its radii at bends and branch points raised to those of balls.

    On such a ball the circles of its struts keep apart. A node whose radius is larger keeps it.

    Raises
    ------
    SkeletonError
        If the cones of a node widen as fast as they part.

    Examples
    --------
    >>> tips = [[9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> tripod = Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> with_balls(tripod).radii.round(3).tolist()
    [1.485, 1.0, 1.0, 1.0]
    """
    runs = straight_runs(skeleton)
    radii = skeleton.radii.copy()
    for valency in np.unique(runs.valency[runs.valency > 1]).tolist():
        nodes = np.flatnonzero(runs.valency == valency)
        half_runs = runs.incidence.at_nodes(nodes, valency)  # (M, N)
        directions = runs.directions[half_runs]
        across, slopes = runs.radii.reshape(-1)[half_runs], runs.slopes[half_runs]
        ball = SPARE * _least_balls(directions, across)
        for _ in range(TAPER_STEPS if slopes.any() else 0):
            smaller = ball
            ball = SPARE * _least_balls(directions, across + np.maximum(slopes, 0) * ball[:, None])
        if slopes.any():
            endless = (ball > GROWING * smaller) & (ball > runs.lengths[half_runs >> 1].max(axis=1))
            _check_bounded(skeleton, nodes[endless])
        radii[nodes] = np.maximum(radii[nodes], ball)
    _tell_large(skeleton, radii)
    return Skeleton(skeleton.nodes, skeleton.edges, radii, skeleton.edge_radii)


def _check_bounded(skeleton: Skeleton, nodes: Ints) -> None:
    """Raise if cones at one of some nodes widen as fast as they part: no ball is large enough."""
    if len(nodes):
        raise SkeletonError(
            f"node {nodes[0]} at {place_text(skeleton.nodes[nodes[0]])} has no ball: its struts "
            "widen away from it as fast as they part; need wider angles or less taper there, or "
            "nodes='blend'"
        )


def _tell_large(skeleton: Skeleton, radii: Floats) -> None:
    """Warn of balls that narrow angles make much larger than their struts."""
    thickest = largest_at_nodes(skeleton.edges, skeleton.edge_radii, len(radii))
    grown = (radii > skeleton.radii) & (radii > LARGE * thickest)
    if not grown.any():
        return
    node = int(np.where(grown, radii / np.maximum(thickest, 1e-300), 0.0).argmax())
    _log.warning(
        "%s larger than %g radii of the struts, whose circles would touch on smaller ones: that of "
        "node %d at %s has a radius of %.3g mm; need wider angles or thinner struts there",
        "1 ball is" if grown.sum() == 1 else f"{grown.sum()} balls are",
        LARGE,
        node,
        place_text(skeleton.nodes[node]),
        radii[node],
    )


def _least_balls(directions: UnitVectors, radii: Floats) -> Floats:
    """Return the radii (M,) of balls on which circles of `radii` (M, N) around directions touch.

    Two circles of radii r, s at an angle θ touch where asin(r/R) + asin(s/R) = θ, which
    R² sin² θ = r² + s² + 2 r s cos θ solves; from θ = π/2 + asin(s/r) on, R = r > s is enough.
    """
    cosines = np.clip(directions @ directions.transpose(0, 2, 1), -1.0, 1.0)  # (M, N, N)
    one, other = radii[:, :, None], radii[:, None]
    thick = np.maximum(one, other)
    is_wide = -cosines >= np.minimum(one, other) / thick
    square = one**2 + other**2 + 2 * one * other * cosines
    sines = np.where(is_wide, 1.0, 1 - cosines**2)
    every = np.eye(radii.shape[1], dtype=np.bool_)
    touching = np.sqrt(np.divide(square, sines, out=np.zeros_like(square), where=~every))
    return np.asarray(np.where(is_wide | every, thick, touching).max(axis=(1, 2)))
