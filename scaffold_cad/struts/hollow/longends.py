"""Chains whose last links are shorter than a closed end of a hollow strut.

What is inside ends a wall before the end, which may be some links further on. It has the same links
as the outside: those near the end are drawn together along the chain, beyond the end's wall. A
branch as short as its end is a stump in a branch point's body, and so is what is inside of it.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, place_text
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton

REACH = 3.0
"""Length of chain whose links are drawn together at least, in lengths of the end."""

STUMP = 0.1
"""What is left inside of a branch that is shorter than its end, as a part of its length."""

SPARE = 1e-6
"""What a strut is to be longer than its ends, as a part of them."""


def with_long_ends(skeleton: Skeleton, at_ends: Floats) -> tuple[Skeleton, Floats]:
    """Return a skeleton whose last links are longer than the ends of their struts, and these, mm.

    Joints are moved along their chains, as far from the end as `REACH`, so that the last link goes
    from the end to a place past `at_ends`.

    Parameters
    ----------
    at_ends : (n,) length of the end at each extremity, mm

    Raises
    ------
    OptionError
        If a chain is not longer than its ends; its last link is named.
    """
    is_end = skeleton.valency[skeleton.edges] == 1  # (m, 2)
    cut = at_ends[skeleton.edges] * is_end
    short = np.flatnonzero(skeleton.lengths <= cut.sum(axis=1) * (1 + SPARE))
    if len(short) == 0:
        return skeleton, at_ends
    at_ends = at_ends.copy()
    nodes, radii = skeleton.nodes.copy(), skeleton.edge_radii.copy()
    done = np.zeros(len(skeleton.edges), dtype=np.bool_)
    for edge in short.tolist():
        for side in np.flatnonzero(cut[edge] > 0).tolist():
            end = int(skeleton.edges[edge, side])
            chain = _chain(skeleton, end, REACH * at_ends[end], done)
            done[[link for link, _ in chain]] = True
            if _drawn(skeleton, chain, float(at_ends[end]), nodes, radii):
                continue
            if _at_branch_point(skeleton, chain):
                links = [link for link, _ in chain]
                at_ends[end] = (1.0 - STUMP) * skeleton.lengths[links].sum()
                _drawn(skeleton, chain, float(at_ends[end]), nodes, radii)
            else:
                near = place_text(skeleton.nodes[end])
                raise OptionError(
                    f"edge {edge} near {near} is {skeleton.lengths[edge]:g} mm long; need more "
                    f"than its closed ends of {cut[edge].max():g} mm, in it or in links that "
                    "follow it (ends='open' has none)"
                )
    drawn = Skeleton(nodes, skeleton.edges, skeleton.radii, radii)
    # Chains that bend lead less far.
    last, at = np.nonzero(is_end)
    node = skeleton.edges[last, at]
    at_ends[node] = np.minimum(at_ends[node], drawn.lengths[last] * (1 - SPARE))
    return drawn, at_ends


def _at_branch_point(skeleton: Skeleton, chain: list[tuple[int, int]]) -> bool:
    """Return whether a chain leads to a branch point."""
    if len(chain) == 0:
        return False
    edge, side = chain[-1]
    return bool(skeleton.valency[skeleton.edges[edge, 1 - side]] > 2)


def _chain(skeleton: Skeleton, end: int, reach: float, done: Bools) -> list[tuple[int, int]]:
    """Return the links from an extremity on, and the side that each begins at.

    The chain is as long as `reach`, or leads to a node that is not a joint or to a link that is
    `done`. If it leads to another extremity before twice as much, half of it is for that one.
    """
    chain: list[tuple[int, int]] = []
    lengths: list[float] = []
    node, before = end, -1
    while sum(lengths) < 2 * reach:
        links = skeleton.incidence.at_nodes(np.array([node]), int(skeleton.valency[node]))[0]
        ahead = [(half // 2, half % 2) for half in links.tolist() if half // 2 != before]
        if len(ahead) != 1 or done[ahead[0][0]]:
            break
        before, side = ahead[0]
        chain.append((before, side))
        lengths.append(float(skeleton.lengths[before]))
        node = int(skeleton.edges[before, 1 - side])
    whole = np.cumsum(lengths)
    if len(ahead) == 0:
        reach = min(reach, float(whole[-1]) / 2)
    return chain[: int(np.searchsorted(whole, reach)) + 1]


def _drawn(
    skeleton: Skeleton, chain: list[tuple[int, int]], end: float, nodes: Floats, radii: Floats
) -> bool:
    """Draw the joints of a chain together past its end; return whether there is room.

    The last link keeps its direction, so that what is inside ends parallel to the outside, and
    begins on the chain.
    """
    edges, sides = np.array(chain, dtype=np.intp).reshape(-1, 2).T
    lengths = skeleton.lengths[edges]
    place = np.append(0.0, np.cumsum(lengths))  # of the nodes along the chain
    if len(edges) < 2 or place[-1] <= end * (1 + SPARE):
        return False
    first, last = skeleton.edges[edges, sides], skeleton.edges[edges, 1 - sides]
    points = skeleton.nodes[np.append(first, last[-1])]
    outward = (points[0] - points[1]) / lengths[0]
    depth = (points[0] - points) @ outward  # below the plane of the end
    reach = end + lengths[0] * (1.0 - end / place[-1])
    deep = np.flatnonzero(depth > reach)
    if len(deep) == 0:
        return False
    k = int(deep[0])
    begin = np.interp(reach, depth[k - 1 : k + 1], place[k - 1 : k + 1])
    share = (place[-1] - begin) / (place[-1] - place[1])
    new = np.append(0.0, begin + (place[1:] - place[1]) * share)
    for axis in range(3):
        nodes[last[:-1], axis] = np.interp(new[1:-1], place, points[:, axis])
    nodes[first[0]] = nodes[last[0]] + reach * outward
    near, far = skeleton.edge_radii[edges, sides], skeleton.edge_radii[edges, 1 - sides]
    # Radii may jump at joints: of both there, the place just before and just behind.
    along = np.stack([place[:-1], place[1:] * (1 - 1e-12)], axis=1).reshape(-1)
    sizes = np.interp(new, along, np.stack([near, far], axis=1).reshape(-1))
    radii[edges, sides], radii[edges, 1 - sides] = sizes[:-1], sizes[1:]
    return True
