"""Walls of hollow struts: what is inside them, and how thin they are."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import dot
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.rings import stacks

SAMPLES = (8, 32)
"""Levels and sides of the grids on the patches of nodes where walls are measured."""


def without_wall(skeleton: Skeleton, wall: float, at_ends: Floats) -> Skeleton:
    """Return the skeleton of what is inside struts with walls.

    Parameters
    ----------
    wall : thickness, mm
    at_ends : (n,) by how much struts are shorter at extremities, mm

    Raises
    ------
    OptionError
        If a strut is not thicker than twice its wall, or not longer than its ends; it is named.
    """
    thin = np.flatnonzero(skeleton.edge_radii.min(axis=1) <= wall)
    if len(thin):
        radius = skeleton.edge_radii[thin[0]].min()
        raise OptionError(
            f"wall is {wall:g} mm, and edge {thin[0]} has radius {radius:g} mm; need a wall that "
            "is thinner than each radius"
        )
    is_end = skeleton.valency[skeleton.edges] == 1  # (m, 2)
    cut = at_ends[skeleton.edges] * is_end
    short = np.flatnonzero(skeleton.lengths <= cut.sum(axis=1) * (1 + 1e-6))
    if len(short):
        raise OptionError(
            f"edge {short[0]} is {skeleton.lengths[short[0]]:g} mm long; need more than its closed "
            f"ends of {cut[short[0]].max():g} mm (ends='open' has none)"
        )
    share = cut / skeleton.lengths[:, None]
    near, far = skeleton.edge_radii.T
    start = near + share[:, 0] * (far - near)
    end = far + share[:, 1] * (near - far)
    nodes = skeleton.nodes.copy()
    ahead = skeleton.directions.reshape(-1, 2, 3)
    nodes[skeleton.edges[is_end]] += (cut[..., None] * ahead)[is_end]
    radii = skeleton.radii - wall
    return Skeleton(nodes, skeleton.edges, radii, np.stack([start, end], axis=1) - wall)


def least_wall(struts: RoundStruts) -> float:
    """Return the least thickness of the walls of hollow struts at samples of their nodes, mm.

    Between collars a wall is exact. Each sample on the inside is measured to the tangent plane at
    the nearest of the samples outside.
    """
    if struts.inner is None:
        raise OptionError("the struts are solid; need wall=, mm")
    thickness = [float(struts.options.wall or 0.0)]
    runs, sockets = struts.runs, struts.sockets
    half_runs = runs.incidence.half_edges[runs.incidence.offsets[sockets.nodes]]
    for depth in (0.0 * sockets.depths, sockets.depths):
        thickness += (runs.radii_at(half_runs, depth) - sockets.radii).tolist()
    levels, sides = SAMPLES
    for outer, inner in zip(struts.blended, struts.inner.blended, strict=True):
        grids = [
            stacks(each, np.zeros(each.half_runs.shape), levels, sides) for each in (outer, inner)
        ]
        for row in range(len(outer.nodes)):
            near, normal = grids[0].points[row], grids[0].normals[row]
            inside = grids[1].points[row]
            _, place = cKDTree(near).query(inside)
            thickness.append(float(dot(near[place] - inside, normal[place]).min()))
    return min(thickness)
