"""Which radii of a skeleton a format holds, and the warning about those that are lost."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from scaffold_cad.base.summaries import counted
from scaffold_cad.skeleton import Skeleton

KeptRadii: TypeAlias = Literal["all", "members", "nodes and means", "means", "nodes", "none"]
"""All; those of members at both ends, without balls at nodes; one for each node and one for each
member; one for each member; one for each node; or none."""


MEANS = "a radius for each member, the mean of both ends"
"""What formats of beams without tapers hold, in words."""


def lost_radii(skeleton: Skeleton, kept: KeptRadii) -> str:
    """Return what a format that keeps such radii loses of those of `skeleton`, "" for nothing.

    Examples
    --------
    >>> cone = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], [1.0, 2.0])
    >>> lost_radii(cone, "means")
    'holds a radius for each member, the mean of both ends: 1 taper lost'
    >>> lost_radii(Skeleton(cone.nodes, cone.edges, 2.0, 1.0), "means")
    'holds a radius for each member, the mean of both ends: 2 balls at nodes lost'
    >>> lost_radii(cone, "nodes")
    ''
    """
    own, of_nodes = skeleton.edge_radii, skeleton.radii[skeleton.edges]  # (m, 2)
    if kept == "none":
        return "holds no radii; need radius= to read it"
    if kept == "nodes" and (own != of_nodes).any():
        struts = counted(int((own != of_nodes).any(axis=1).sum()), "strut")
        most = float((of_nodes / own).max())
        return f"holds a radius for each node, which makes {struts} up to {most:.3g} times as thick"
    lost = []
    if kept in ("means", "nodes and means") and (own[:, 0] != own[:, 1]).any():
        lost.append(counted(int((own[:, 0] != own[:, 1]).sum()), "taper"))
    if kept in ("means", "members"):
        thick = np.zeros(len(skeleton.radii))
        np.maximum.at(thick, skeleton.edges, own)
        balls = int((skeleton.radii > thick).sum())
        lost += [f"{counted(balls, 'ball')} at nodes"] if balls else []
    if not lost:
        return ""
    held = "the radii of members" if kept == "members" else MEANS
    return f"holds {held}: {' and '.join(lost)} lost"
