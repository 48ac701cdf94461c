"""Chains whose last links are shorter than a closed end of a hollow strut.

What is inside ends a wall before the end, which may be some links further on. It has the same links
as the outside: those near the end are drawn together along the chain, beyond the end's wall. A
branch as short as its end is a stump in the body of a branch point or a ball, and so is what is
inside of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, place_text
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.runs import THICKER

REACH = 3.0
"""Length of chain whose links are drawn together at least, in lengths of the end."""

STUMP = 0.1
"""What is left inside of a branch that is shorter than its end, as a part of its length."""

SPARE = 1e-6
"""What a strut is to be longer than its ends, as a part of them."""


def with_long_ends(skeleton: Skeleton, at_ends: Floats) -> tuple[Skeleton, Floats]:
    """Return a skeleton whose last links are longer than the ends of their struts, and these, mm.

    Joints are moved along their chains, as far from the end as `REACH`, so that the last link goes
    from the end to a place past `at_ends`, and are as thick as the chain there. Balls stay.

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
    parts = skeleton.nodes, skeleton.radii, skeleton.edge_radii
    nodes, own, radii = (part.copy() for part in parts)
    is_body = _are_bodies(skeleton)
    for end in np.unique(skeleton.edges[short][cut[short] > 0]).tolist():
        chain = _chain(skeleton, end, at_ends, is_body)
        if chain.limit > at_ends[end] * (1 + SPARE):
            _draw(skeleton, chain, float(at_ends[end]), nodes, own, radii)
        elif chain.leads_to_body:
            at_ends[end] = (1.0 - STUMP) * chain.limit
            _draw(skeleton, chain, float(at_ends[end]), nodes, own, radii)
        else:
            edge, size = chain.edges[0], chain.place[-1]
            links = f", and its chain {size:g} mm" if len(chain.edges) > 1 else ""
            raise OptionError(
                f"edge {edge} near {place_text(skeleton.nodes[end])} is "
                f"{skeleton.lengths[edge]:g} mm long{links}; need more than its closed ends of "
                f"{at_ends[end]:g} mm on both sides (ends='open' has none)"
            )
    drawn = Skeleton(nodes, skeleton.edges, own, radii)
    # Chains that bend lead less far.
    last, at = np.nonzero(is_end)
    node = skeleton.edges[last, at]
    at_ends[node] = np.minimum(at_ends[node], drawn.lengths[last] * (1 - SPARE))
    return drawn, at_ends


@dataclass(frozen=True, eq=False)
class _Chain:
    """Links from an extremity on."""

    edges: Ints
    """Shape (k,)."""
    sides: Ints
    """Side of each that is nearer to the extremity, shape (k,)."""
    place: Floats
    """How far along the chain its nodes are, shape (k + 1,), mm."""
    limit: float
    """How far along it joints are drawn together, mm."""
    leads_to_body: bool


def _are_bodies(skeleton: Skeleton) -> Bools:
    """Return the nodes that chains lead to: branch points, and balls thicker than struts, (n,)."""
    across = np.zeros(len(skeleton.nodes))
    np.maximum.at(across, skeleton.edges, skeleton.edge_radii)
    is_ball = (skeleton.radii > across * (1 + THICKER)) & (skeleton.valency == 2)
    return np.asarray(is_ball | (skeleton.valency > 2))


def _chain(skeleton: Skeleton, end: int, at_ends: Floats, is_body: Bools) -> _Chain:
    """Return the links from an extremity on that are drawn together.

    They are as long as `REACH`, or lead to a body (n,) or another extremity. Of those between two
    extremities each end has its part.
    """
    edges: list[int] = []
    sides: list[int] = []
    place = [0.0]
    node, ahead, reach = end, [end], REACH * float(at_ends.max())
    while len(ahead) == 1 and not is_body[node] and place[-1] < 2 * reach:
        links = skeleton.incidence.at_nodes(np.array([node]), int(skeleton.valency[node]))[0]
        ahead = [half for half in links.tolist() if half // 2 not in edges[-1:]]
        if len(ahead) == 1:
            edges.append(ahead[0] // 2)
            sides.append(ahead[0] % 2)
            place.append(place[-1] + float(skeleton.lengths[edges[-1]]))
            node = int(skeleton.edges[edges[-1], 1 - sides[-1]])
    limit = min(REACH * float(at_ends[end]), place[-1])
    if len(ahead) == 0:
        other = max(float(at_ends[node]), 0.0)  # what is inside of a round end may reach further
        limit = min(limit, place[-1] * float(at_ends[end]) / (float(at_ends[end]) + other))
    return _Chain(np.array(edges), np.array(sides), np.array(place), limit, bool(is_body[node]))


def _draw(
    skeleton: Skeleton, chain: _Chain, end: float, nodes: Floats, own: Floats, radii: Floats
) -> None:
    """Draw the joints of a chain together past its end.

    The last link keeps its direction where there is room, so that what is inside ends parallel to
    the outside, and begins on the chain.
    """
    edges, sides, place = chain.edges, chain.sides, chain.place
    count = int(np.searchsorted(place, chain.limit * (1 - SPARE))) - 1
    if count == 0:
        return
    first, last = skeleton.edges[edges, sides], skeleton.edges[edges, 1 - sides]
    points = skeleton.nodes[np.append(first, last[-1])]  # (k + 1, 3)
    size = place[1]
    outward = (points[0] - points[1]) / size
    depth = (points[0] - points) @ outward  # below the plane of the end
    reach = end + size * (1.0 - end / chain.limit)
    deep = np.flatnonzero((depth[1:] > reach) & (depth[:-1] <= reach))
    begin = reach
    if len(deep):
        k = int(deep[0])
        begin = float(np.interp(reach, depth[k : k + 2], place[k : k + 2]))
    is_room = len(deep) > 0 and begin < chain.limit
    begin = begin if is_room else reach
    share = (chain.limit - begin) / (chain.limit - size)
    new = np.append(0.0, begin + (place[1 : count + 1] - size) * share)  # of the end and joints
    joints = last[:count]
    for axis in range(3):
        nodes[joints, axis] = np.interp(new[1:], place, points[:, axis])
    if is_room:
        nodes[first[0]] = nodes[joints[0]] + reach * outward
    near, far = skeleton.edge_radii[edges, sides], skeleton.edge_radii[edges, 1 - sides]
    # Radii may jump at joints: of both there, the place just before and just behind.
    along = np.stack([place[:-1], place[1:] * (1 - 1e-12)], axis=1).reshape(-1)
    sizes = np.interp(new, along, np.stack([near, far], axis=1).reshape(-1))
    own[joints] = sizes[1:]
    radii[edges[:count], sides[:count]] = sizes[:count]
    radii[edges[:count], 1 - sides[:count]] = sizes[1:]
    radii[edges[count : count + 1], sides[count : count + 1]] = sizes[count]
