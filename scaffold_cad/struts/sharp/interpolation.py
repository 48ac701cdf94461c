"""Curves as splines of degree 5 through points of theirs, with as many pieces as they need."""

from __future__ import annotations

from functools import cache

import numpy as np

from scaffold_cad.base.arrays import Floats, read_only
from scaffold_cad.brep.analytic import Knots

DEGREE = 5
PIECES = (2, 4, 8, 16, 32, 64, 128, 256, 512)
"""Numbers of pieces that are tried."""

NEAR, FAIR = 1e-9, 1e-7
"""Distance of a spline from its curve, in radii of the ball: with more pieces it is made nearer
than the first; if it cannot be, up to the second it is taken, and the tolerance says so."""


@cache
def knots_of(pieces: int) -> Knots:
    """Return the knots of splines with a number of pieces."""
    counts = np.ones(pieces + 1, dtype=np.intp)
    counts[[0, -1]] = DEGREE + 1
    return Knots(np.linspace(0.0, 1.0, pieces + 1), counts)


@cache
def sites(pieces: int) -> Floats:
    """Return the parameters of the points that a spline passes, one for each control point."""
    knots = np.repeat(knots_of(pieces).values, knots_of(pieces).counts)
    found = np.lib.stride_tricks.sliding_window_view(knots[1:-1], DEGREE).mean(axis=1)
    return read_only(np.asarray(found, dtype=np.float64))


@cache
def _inverse(pieces: int) -> Floats:
    knots = knots_of(pieces)
    return read_only(np.asarray(np.linalg.inv(knots.matrix(sites(pieces))), dtype=np.float64))


@cache
def _values(pieces: int) -> Floats:
    """Return the basis between the sites, (2 c - 2, count)."""
    at = sites(pieces)
    share = np.array([0.33, 0.66])
    between = (at[:-1, None] + np.diff(at)[:, None] * share).reshape(-1)
    return read_only(knots_of(pieces).matrix(between))


@cache
def checked(pieces: int) -> Floats:
    """Return the sites, and the parameters between them at which a spline is measured."""
    at = sites(pieces)
    between = (at[:-1, None] + np.diff(at)[:, None] * np.array([0.33, 0.66])).reshape(-1)
    return read_only(np.asarray(np.concatenate([at, between]), dtype=np.float64))


def interpolated(values: Floats, pieces: int) -> tuple[Floats, float]:
    """Return the control points (count, d) through values at `checked`, and how far it is off.

    Parameters
    ----------
    values : (c, d) those at the sites, then those between them
    """
    count = len(sites(pieces))
    control = _inverse(pieces) @ values[:count]
    control[0], control[-1] = values[0], values[count - 1]
    off = np.abs(_values(pieces) @ control - values[count:]).max()
    return control, float(off)
