"""Curves cut at the circles of their joints: what is left where some of their pieces are not."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.ranges import steps
from scaffold_cad.struts.curves.curve import NOT_OF_CIRCLES, Curves


@dataclass(frozen=True, eq=False)
class CutCurves(Frozen):
    """Curves without some of their pieces, and the circles on which they end now."""

    curves: Curves
    """What is left; ends at cuts are on the half-runs `first`, `first` + `step` and so on."""
    nodes: Ints
    """Joint at each cut, shape (v,)."""
    outward: UnitVectors
    """Axis of its circle, away from what is left, shape (v, 3)."""
    x: UnitVectors
    """Where the circle begins, shape (v, 3)."""
    radii: Floats
    """Of the circle, shape (v,), mm."""
    ahead: Bools
    """Whether the curve runs on beyond the cut, or came from there, shape (v,)."""
    beyond: Ints
    """Piece of the whole curves that lies on the other side, shape (v,)."""


def cut_curves(curves: Curves, left_out: Bools, first: int, step: int = 1) -> CutCurves:
    """Return curves without pieces (p,) that are left out; tori are so as a whole or not at all.

    Parameters
    ----------
    first, step : numbers of the half-runs on which curves end at cuts
    """
    order, chain = chains_left(curves, left_out)
    count = int(chain[-1]) + 1 if len(chain) else 0
    sizes = np.bincount(chain, minlength=count)
    offsets = np.concatenate([[0], np.cumsum(sizes + 1)])
    begin, end = order[np.cumsum(sizes) - sizes], order[np.cumsum(sizes) - 1]  # (c',)
    rows = np.empty(offsets[-1], dtype=np.intp)
    rows[np.arange(len(order)) + chain] = curves.pieces[order]
    rows[offsets[1:] - 1] = curves.pieces[end] + 1
    own = [each.name for each in fields(curves) if each.name not in NOT_OF_CIRCLES]
    per_circle = {name: getattr(curves, name)[rows] for name in own}
    per_circle["run"][offsets[1:] - 1] = -1
    of = curves.curve_of_piece[begin]
    whole = sizes == np.diff(curves.offsets)[of] - 1
    at_start = (curves.pieces[begin] == curves.offsets[of]) & ~curves.closed[of]
    at_end = (curves.pieces[end] + 1 == curves.offsets[of + 1] - 1) & ~curves.closed[of]
    given = np.stack([at_start, at_end], axis=1) | (whole & curves.closed[of])[:, None]
    half_runs = curves.half_runs[of].copy()
    half_runs[~given] = first + step * np.arange((~given).sum())
    made = replace(
        curves,
        offsets=offsets,
        half_runs=half_runs,
        tori=np.where(whole, curves.tori[of], np.nan),
        **per_circle,
    )
    at, side = np.nonzero(~given)
    circle = np.where(side == 0, offsets[at], offsets[at + 1] - 1)
    sign = np.where(side == 0, -1.0, 1.0)[:, None]
    before, after = neighbors(curves)
    return CutCurves(
        made,
        made.nodes[circle],
        sign * made.tangents[circle],
        made.x[circle],
        made.radii[circle],
        side == 1,
        np.where(side == 0, before[begin[at]], after[end[at]]),
    )


def chains_left(curves: Curves, left_out: Bools) -> tuple[Ints, Ints]:
    """Return the pieces that are left, one after another, and the chain that each is in."""
    counts = np.diff(curves.offsets) - 1
    of = curves.curve_of_piece
    place = steps(counts)
    # Closed curves begin behind the last piece that is left out.
    last = np.full(len(counts), -1, dtype=np.intp)
    np.maximum.at(last, of[left_out], place[left_out])
    turned = (place - np.where(curves.closed, last + 1, 0)[of]) % np.maximum(counts, 1)[of]
    order = np.lexsort((turned, of))
    order = order[~left_out[order]]
    key = of[order] * (len(of) + 1) + turned[order]
    return order, np.cumsum(np.diff(key, prepend=-2) != 1) - 1


def neighbors(curves: Curves) -> tuple[Ints, Ints]:
    """Return the pieces before and after each piece, -1 at the ends of curves, (p,) each."""
    number = np.arange(len(curves.curve_of_piece))
    counts = np.diff(curves.offsets) - 1
    end = np.cumsum(counts)
    start = end - counts
    before, after = number - 1, number + 1
    before[start] = np.where(curves.closed, end - 1, -1)
    after[end - 1] = np.where(curves.closed, start, -1)
    return before, after
