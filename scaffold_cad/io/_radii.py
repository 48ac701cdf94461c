"""Which radii of a skeleton a format holds, and the warning about those that are lost."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from scaffold_cad.base.summaries import counted
from scaffold_cad.skeleton import Skeleton

KeptRadii: TypeAlias = Literal["all", "members", "means", "nodes", "none"]
"""All; those of members at both ends, without balls at nodes; one for each member; one for each
node; or none."""


def lost_radii(skeleton: Skeleton, kept: KeptRadii) -> str:
    """Return what a format that keeps such radii loses of those of `skeleton`, "" for nothing.

    Examples
    --------
    >>> cone = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], [1.0, 2.0])
    >>> lost_radii(cone, "means")
    'holds a radius for each member, the mean of both ends: 1 taper lost'
    >>> lost_radii(cone, "nodes")
    ''
    """
    own, of_nodes = skeleton.edge_radii, skeleton.radii[skeleton.edges]  # (m, 2)
    if kept == "none":
        return "holds no radii; need radius= to read it"
    if kept == "nodes" and (own != of_nodes).any():
        struts = counted(int((own != of_nodes).any(axis=1).sum()), "strut")
        most = float((of_nodes / own).max())
        return f"holds a radius for each node: {struts} become up to {most:.3g} times as thick"
    if kept == "means" and (own[:, 0] != own[:, 1]).any():
        tapers = counted(int((own[:, 0] != own[:, 1]).sum()), "taper")
        return f"holds a radius for each member, the mean of both ends: {tapers} lost"
    if kept == "members":
        thick = np.zeros(len(skeleton.radii))
        np.maximum.at(thick, skeleton.edges, own)
        balls = int((skeleton.radii > thick).sum())
        return (
            f"holds the radii of members: {counted(balls, 'ball')} at nodes lost" if balls else ""
        )
    return ""
