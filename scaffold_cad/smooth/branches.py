"""Branch points that long struts would pull out of place: what sections beside them prevent.

A vertex of a star where d sides of quads meet lies on as many struts. Each has 1 edge and 2 quads
there that lead to its far section, and so moves the limit of the vertex by 3 / (d (2 d + 5)) of
its length: a sixth of it at a joint, where d is 2.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, length, rotate
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.sleeves import fitted_angle
from scaffold_cad.smooth.bends import STRAY


def pulled_half_edges(scaffold: Scaffold) -> Ints:
    """Return the half-edges that leave branch points which their struts pull too far, (k,).

    Struts that pull against each other leave a branch point in its place, and collars stop them.
    """
    if scaffold.options.collars:
        return np.zeros(0, dtype=np.intp)
    refined = scaffold.refined
    tails = refined.edges.reshape(-1)
    leaving = np.flatnonzero(refined.valency[tails] >= 3)
    corners = scaffold.sleeves.reshape(-1, 4)[leaving]  # (k, 4)
    count = len(scaffold.stars.vertices)
    meeting = np.bincount(corners.reshape(-1), minlength=count)
    shares = 3 / (meeting * (2 * meeting + 5))  # (v,)
    pull = shares[corners].sum(axis=1) * refined.lengths[leaving >> 1]
    vectors = pull[:, None] * refined.directions[leaving]
    stray = np.zeros((len(refined.nodes), 3))
    np.add.at(stray, tails[leaving], vectors)
    vertices = np.bincount(scaffold.node_of_vertex[:count], minlength=len(refined.nodes))
    is_pulled = length(stray) > STRAY * refined.radii * vertices
    return leaving[is_pulled[tails[leaving]]]


def fitting_squares(quads: Floats, axes: UnitVectors) -> Floats:
    """Return the squares across `axes` (k, 3) that fit spherical quads, 1 mm to corners, (k, 4, 3).

    Parameters
    ----------
    quads : (k, 4, 3) float64, corners seen from the branch point, counter-clockwise about the axis
    """
    x = any_perpendicular(axes)
    x = rotate(x, axes, fitted_angle(quads, x, axes))
    y = np.cross(axes, x)
    return np.stack([x, y, -x, -y], axis=1)
