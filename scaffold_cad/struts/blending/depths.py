"""How far the patches of nodes are from the filleted union, and how deep inside struts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen
from scaffold_cad.struts.blending.distances import LEAST_SLOPE, Union
from scaffold_cad.struts.blending.layouts import Layout

CHECKED = 15
"""Parts of a patch in either direction between which depths are measured, its rim included: the
deepest places are often there."""
LEAST_CHECKED = 7
"""Least number of them in a piece."""
STRIDE = 7
"""Of how many of these the distance from the filleted union is measured at one: it costs most."""
PEAK = 1.5
"""How much more than values at a grid, none of them negative, are their peaks by parabolas, most:
a quarter more in either direction."""


@dataclass(frozen=True, eq=False)
class Misfit(Frozen):
    """What m blends are off by."""

    distance: Floats
    """Greatest distance of samples from the filleted union, mm, shape (m,)."""
    bulge: Floats
    """Greatest distance of samples outside it, mm, shape (m,)."""
    depth: Floats
    """Greatest depth of samples inside a strut or ball, over its radius, shape (m,)."""


def misfit(union: Union, control: Floats, layout: Layout) -> Misfit:
    """Return what blends are off by.

    Parameters
    ----------
    union : the filleted unions of m nodes
    control : (3, m, 4 N, n_u, n_v) float64
    layout : that of the patches
    """
    along_u, along_v = (
        spline.values_at(np.linspace(0.0, 1.0, 1 + max(CHECKED, LEAST_CHECKED * spline.pieces)))
        for spline in (layout.u, layout.v)
    )
    grid = along_u @ (control @ along_v.T)  # (3, m, 4 N, a, b)
    points = grid.reshape(3, control.shape[1], -1)
    value, gradient = union.value_and_slope(points[..., ::STRIDE])
    away = value / np.sqrt(np.maximum((gradient**2).sum(axis=0), LEAST_SLOPE**2))
    depth = _highest(union.deepest(points).reshape(grid.shape[1:]))
    return Misfit(np.abs(away).max(axis=1), np.maximum(away.max(axis=1), 0.0), depth)


def _highest(values: Floats) -> Floats:
    """Return the highest peak of each node on grids of `values` >= 0 (m, patches, a, b), (m,).

    Where a value is a peak along a line of the grid, it is that of the parabola through it and its
    neighbors; lines go on behind their ends as before.
    """
    nodes, _, a, b = values.shape
    most: Floats = values.max(axis=(1, 2, 3))
    high = (values > 0) & (values >= (most / PEAK)[:, None, None, None])
    place = np.flatnonzero(high)
    flat = values.reshape(-1)
    here = flat[place]
    found = here.copy()
    for step, count in ((b, a), (1, b)):
        at = place // step % count
        before = flat[place + step * np.where(at > 0, -1, 1)]
        after = flat[place + step * np.where(at < count - 1, 1, -1)]
        bend = 2 * here - before - after
        is_peak = (here >= before) & (here >= after) & (bend > 0)
        found += np.where(is_peak, (after - before) ** 2 / (8 * np.where(is_peak, bend, 1.0)), 0.0)
    np.maximum.at(most, place // (len(flat) // nodes), found)
    return most
