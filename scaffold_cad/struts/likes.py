"""Struts made like others: whether they can have the triangles of these."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import StrutOptions
from scaffold_cad.struts.runs import ball_ends, straight_runs


def check_like(skeleton: Skeleton, options: StrutOptions, like: RoundStruts) -> None:
    """Raise unless struts of a skeleton can have the triangles of others.

    Raises
    ------
    OptionError
        If the graph, the ends, the nodes' kind, the balls or the walls are others.
    """
    check_kind(like, RoundStruts, name="like")
    kinds = options.nodes, like.options.nodes
    if kinds[0] != kinds[1]:
        raise OptionError(f"like has nodes={kinds[1]!r}, not {kinds[0]!r}; need the same")
    if not np.array_equal(skeleton.edges, like.skeleton.edges):
        raise OptionError(
            f"like has {len(like.skeleton.edges)} edges, which are not the skeleton's "
            f"{len(skeleton.edges)}; need the same graph, moved"
        )
    own = (options.ends, options.wall is None)
    others = (like.options.ends, like.options.wall is None)
    if own != others:
        raise OptionError(
            f"like has ends={like.options.ends!r} and wall={like.options.wall}; need the same"
        )
    balls = [
        np.flatnonzero(ball_ends(skeleton, straight_runs(skeleton))).tolist(),
        np.flatnonzero(ball_ends(like.skeleton, like.runs)).tolist(),
    ]
    if balls[0] != balls[1]:
        raise OptionError(f"like has balls at ends {balls[1]}, not {balls[0]}; need the same")
    nodes = [sorted(each.sockets or {}) for each in (options, like.options)]
    if nodes[0] != nodes[1]:
        raise OptionError(f"like has sockets at nodes {nodes[1]}, not {nodes[0]}; need the same")
