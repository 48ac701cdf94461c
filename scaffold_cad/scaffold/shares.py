"""Struts shared out among surfaces that are embedded each for itself.

Where struts of a scaffold meet, each of them is still a tube without crossings, and most of them
meet a few others only. A *share* is a part of them that keep apart, with the nodes between them:
its surface is closed and embedded, and the union of a few surfaces takes much less than that of
all struts that meet any other. All shares together have each node once. A strut of a later share
ends within the sphere of a node of another share with a *plug*, four triangles around a point of
its axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges
from scaffold_cad.base.visibility import rounding_of
from scaffold_cad.scaffold.bodies import Bodies, conflicting
from scaffold_cad.scaffold.embedding import Embedding, tubes_of, with_stubs
from scaffold_cad.scaffold.scaffold import Scaffold

MOST_SHARES = 8
"""More of them hold less and less."""


@dataclass(frozen=True, eq=False)
class Share:
    """Struts and nodes whose surface is closed and embedded."""

    struts: Bools
    """Struts, shape (m,)."""
    nodes: Bools
    """Branch points, shape (n,); where other struts leave them, stubs close them."""


def shared_out(scaffold: Scaffold, embedded: Embedding, calm: Bools) -> list[Share]:
    """Return shares of the struts and branch points of a scaffold, the largest first.

    What is in none of them meets itself, or too many others.

    Parameters
    ----------
    embedded : of the scaffold
    calm : (n,) bool; nodes whose struts may be in any share, others only as they are embedded
    """
    skeleton, tubes = scaffold.skeleton, tubes_of(scaffold)
    may = calm[skeleton.edges].all(axis=1)
    at_joint = (skeleton.valency == 2)[skeleton.edges].any(axis=1)
    struts = embedded.kept | (embedded.uncrossed & may)
    nodes = (skeleton.valency > 2) & (embedded.kept_nodes | calm)
    home = np.zeros(len(nodes), dtype=np.bool_)  # nodes of earlier shares
    broken = np.zeros(len(nodes), dtype=np.bool_)  # where one of their struts breaks its cone
    shares: list[Share] = []
    while len(shares) < MOST_SHARES and (struts.any() or nodes.any()):
        # A plug may break its cone, but two that do so at one node mostly run along each other.
        fine = (embedded.within_cone | (home & ~broken)[skeleton.edges]).all(axis=1)
        share = _share(scaffold, tubes, struts & fine, nodes, home)
        if not (share.struts.any() or share.nodes.any()):
            break
        shares.append(share)
        home = home | share.nodes
        ends = skeleton.edges[share.struts]
        broken[ends[~embedded.within_cone[share.struts]]] = True
        # At a joint two shares would touch in a face.
        struts = struts & ~share.struts & ~at_joint
        nodes = nodes & ~share.nodes
    return shares


def _share(scaffold: Scaffold, tubes: Bodies, struts: Bools, nodes: Bools, home: Bools) -> Share:
    """Return those of some struts (m,) and branch points (n,) that keep apart.

    Parameters
    ----------
    home : (n,) bool; branch points of other shares
    """
    ends, count = scaffold.skeleton.edges, len(nodes)
    rounding = rounding_of(scaffold.mesh.vertices)
    is_star = scaffold.skeleton.valency > 2
    struts = struts & _first_at(ends, struts, home)
    struts &= ~(is_star & ~home & ~nodes)[ends].any(axis=1)
    among = tubes.only(struts[tubes.owner])
    struts &= ~_cover(among.owner[conflicting(among, rounding)], len(ends))
    while True:
        bodies = with_stubs(
            scaffold, tubes.only(struts[tubes.owner]), np.flatnonzero(~struts), nodes
        )
        item = np.where(bodies.node >= 0, bodies.node, count + bodies.owner)
        meeting = item[conflicting(bodies, rounding, bodies.node >= 0)]
        if len(meeting) == 0:
            return Share(struts, nodes)
        out = _cover(meeting, count + len(ends))
        nodes = nodes & ~out[:count]
        struts = struts & ~out[count:] & ~(is_star & ~home & ~nodes)[ends].any(axis=1)


def _first_at(ends: Edges, struts: Bools, home: Bools) -> Bools:
    """Return the struts (m,) that are the first at each of their nodes that is marked (n,).

    Plugs of two struts at one node would touch.
    """
    number = np.where(struts, np.arange(len(ends)), len(ends))
    first = np.full(len(home), len(ends))
    for side in (0, 1):
        np.minimum.at(first, ends[:, side], number)
    at: Bools = (~home[ends] | (first[ends] == number[:, None])).all(axis=1)
    return at


def _cover(pairs: Edges, count: int) -> Bools:
    """Return which of `count` items to leave out so that no pair (k, 2) is whole, few of them.

    The one of most pairs among its partners goes, over and over.
    """
    out = np.zeros(count, dtype=np.bool_)
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    out[pairs[pairs[:, 0] == pairs[:, 1], 0]] = True
    pairs = pairs[~out[pairs].any(axis=1)]
    while len(pairs):
        rank = np.bincount(pairs.reshape(-1), minlength=count) * count + np.arange(count)
        highest = np.zeros(count, dtype=np.intp)
        for side in (0, 1):
            np.maximum.at(highest, pairs[:, side], rank[pairs[:, 1 - side]])
        out |= (highest > 0) & (rank > highest)
        pairs = pairs[~out[pairs].any(axis=1)]
    return out
