"""Radii of nodes from the radii of the edges at them."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats


def largest_at_nodes(edges: Edges, radii: Floats, count: int) -> Floats:
    """Return the largest radius of the edges at each node, shape (count,); NaN without edges.

    Parameters
    ----------
    edges : (m, 2) intp, all in 0..count-1
    radii : (m,) or (m, 2) float64, of each edge or of its ends
    """
    of_ends = np.broadcast_to(radii if radii.ndim == 2 else radii[:, None], edges.shape)
    largest = np.full(count, np.nan)
    np.fmax.at(largest, edges.reshape(-1), of_ends.reshape(-1))
    return largest
