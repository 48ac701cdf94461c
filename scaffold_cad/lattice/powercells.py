"""Edges of Voronoi and Laguerre (power) cells of points, and tetrahedra between the points."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.spatial import ConvexHull, Delaunay

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.vectors import dot
from scaffold_cad.lattice.struts import Struts

FAR = 10.0
"""How far the points that close the outermost cells are, in diagonals of the box."""

CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
"""Corners of a tetrahedron around the origin."""


def cell_edges(points: Points, box: Floats, weights: Floats | None = None) -> Struts:
    """Return the edges of the cells of points, all those that meet the box among them.

    An edge joins the centers of two tetrahedra with a common face. Four more points, too far away
    to be the nearest one of any place in the box, close the cells that would be open.

    Parameters
    ----------
    points : (n, 3) float64, mm
    box : (2, 3) float64, lowest and highest corner, mm
    weights : (n,) float64, mm²; a place is in the cell of the point of least squared distance less
        weight (a Laguerre cell). None for Voronoi cells
    """
    far = box.mean(axis=0) + FAR * np.linalg.norm(box[1] - box[0]) * CORNERS
    everything = np.concatenate([points, far])
    if weights is None:
        triangulation = Delaunay(everything)
        simplices = triangulation.simplices.astype(np.intp)
        neighbors = triangulation.neighbors.astype(np.intp)
        powers = np.zeros(len(everything))
    else:
        powers = np.concatenate([weights, np.zeros(4)])
        simplices, neighbors = _regular(everything, powers)
    one, side = np.nonzero(neighbors > np.arange(len(neighbors))[:, None])
    edges: Edges = np.stack([one, neighbors[one, side]], axis=1)
    # Four points of one plane, as copies of a box have outside it, have no center.
    nodes = centers(everything[simplices], powers[simplices])
    there: Bools = np.asarray(np.isfinite(nodes).all(axis=1))
    return Struts(np.where(there[:, None], nodes, 0.0), edges[there[edges].all(axis=1)])


def centers(corners: Floats, weights: Floats | None = None) -> Points:
    """Return the places equally far from the corners of tetrahedra (t, 4, 3), shape (t, 3).

    Distances are squared and less the corners' weights (t, 4), if any: without them these are the
    centers of the spheres through the corners. They are not finite where the corners are in a
    plane.
    """
    u, v, w = (corners[:, k] - corners[:, 0] for k in range(1, 4))
    squares = np.stack([dot(u, u), dot(v, v), dot(w, w)], axis=1)  # (t, 3)
    if weights is not None:
        squares = squares + weights[:, :1] - weights[:, 1:]
    toward = (
        squares[:, :1] * np.cross(v, w)
        + squares[:, 1:2] * np.cross(w, u)
        + squares[:, 2:] * np.cross(u, v)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        found: Points = corners[:, 0] + toward / (2 * dot(u, np.cross(v, w)))[:, None]
    return found


def repeated_around(points: Points, box: Floats) -> Points:
    """Return points of a box and their copies in the 26 boxes around it, shape (27 n, 3)."""
    steps = np.array(sorted(product((-1, 0, 1), repeat=3), key=lambda step: step != (0, 0, 0)))
    moved: Points = (points + (steps * (box[1] - box[0]))[:, None]).reshape(-1, 3)
    return moved


def _regular(points: Points, weights: Floats) -> tuple[Ints, Ints]:
    """Return the tetrahedra of the regular triangulation (t, 4), and their neighbors, -1 for none.

    It is the underside of the hull of the points lifted to |p|² - weight, in four dimensions
    (Aurenhammer, Power diagrams, SIAM J. Comput. 16, 1987).
    """
    local = points - points.mean(axis=0)
    hull = ConvexHull(np.column_stack([local, dot(local, local) - weights]))
    below = hull.equations[:, 3] < -1e-12
    number = np.where(below, np.cumsum(below) - 1, -1)
    neighbors = number[hull.neighbors[below]]
    return hull.simplices[below].astype(np.intp), neighbors.astype(np.intp)
