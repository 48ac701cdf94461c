"""What a solid is put together from where a scaffold is not embedded.

The struts and nodes that keep apart make a closed surface, those that meet one of these another
one, and so on: their shares. Each strut in no share becomes a prism along its axis, each branch
point in none its own closed sphere of quads, and each joint at such a strut the convex hull of the
sections that meet there. All are closed, and all but the first two are convex. Arrays only: the
union is made elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Triangles, UnitVectors
from scaffold_cad.base.frames import square_phases
from scaffold_cad.base.vectors import any_perpendicular, dot, four_around, length, normalize, rotate
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.embedding import Embedding, stub_apexes
from scaffold_cad.scaffold.shares import Share, shared_out
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.thinning import kept_samples

PLASTIC = 1.32471795724474602596
"""The plastic number, the root of x³ = x + 1."""

PLUG = 0.5
"""How far out the plug of a strut begins within a sphere of another share, in heights of stubs."""

PLUG_WIDTH = 0.97
"""Width of the ring that a plug begins with where its strut does not keep to its cone, in widths of
its section."""

HUB_WIDTH = 1.002
"""Width of the hull at a joint, in widths of the sections that meet there: their corners must
not lie in the planes of its faces."""

OVERLAP = 0.1
"""How far a strut left out goes on beyond its node, in distances of its corners."""

THINNING = 0.1
"""How far struts left out may stray from their edges, in radii."""

THINNED_SPACING = 0.5
"""Least distance of the joints between struts left out, in radii."""

HUB_LENGTH = 0.25
"""How far the hull at a joint reaches along its struts, in radii."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Closed surfaces whose union is the solid around a skeleton."""

    surfaces: list[TriangleMesh]
    """One of each share."""
    spheres: list[TriangleMesh]
    """The quads of each branch point in no share."""
    hulls: list[Points]
    """Points whose convex hulls are the struts left out and what joins them, each (p, 3), mm."""


def solid_pieces(scaffold: Scaffold, embedded: Embedding, wobble: Floats) -> Pieces:
    """Return the pieces of the solid of `scaffold`, given which struts are embedded.

    Parameters
    ----------
    wobble : (n,) float64; relative perturbation of the prisms of struts left out, and of what
        is at their nodes, as a fraction of their radius: faces that lie in one plane, or
        edges in one line, are hard to unite
    """
    shares = shared_out(scaffold, embedded, wobble == 0)
    held = np.zeros(len(scaffold.skeleton.edges), dtype=np.bool_)
    lost = scaffold.skeleton.valency > 2
    for share in shares:
        held |= share.struts
        lost &= ~share.nodes
    struts = _struts_left_out(scaffold, held, wobble)
    return Pieces(
        [surface_of(scaffold, share, embedded.within_cone) for share in shares],
        _spheres(scaffold, np.flatnonzero(lost), wobble),
        [*_prisms(scaffold, struts), *_hubs(scaffold, struts, held)],
    )


def spread(count: int, axis: int) -> Floats:
    """Return evenly spread numbers in [-1/2, 1/2), unlike for neighbors, (count,).

    Multiples of the powers of the plastic number's inverse: Roberts's additive recurrence.
    """
    spread: Floats = np.remainder(np.arange(1, count + 1) * PLASTIC**-axis, 1.0) - 0.5
    return spread


def surface_of(scaffold: Scaffold, share: Share, within_cone: Bools) -> TriangleMesh:
    """Return the closed surface of a share.

    Parameters
    ----------
    within_cone : (m, 2) bool; whether each strut keeps to its cone at each end. A plug of one that
        does meets the sphere in the corners of its quad alone, and has these very corners
    """
    refined, vertices = scaffold.refined, scaffold.mesh.vertices
    sides = np.repeat(scaffold.edge_of_quad, 2)
    triangles = scaffold.mesh.triangles[share.struts[sides]]
    node = scaffold.skeleton.edges.reshape(-1)
    corners = scaffold.stars.corners

    half_edges = np.flatnonzero(corners[:, 0] >= 0)
    has_strut, has_node = share.struts[half_edges >> 1], share.nodes[node[half_edges]]
    stubs, plugs = half_edges[has_node & ~has_strut], half_edges[has_strut & ~has_node]
    inside = scaffold.skeleton.nodes[node[plugs]]
    ends = inside + PLUG * (stub_apexes(scaffold, plugs) - inside)
    rings = corners[plugs]
    drawn = np.flatnonzero(~within_cone.reshape(-1)[plugs])
    own = ends[drawn, None] + PLUG_WIDTH * (vertices[rings[drawn]] - ends[drawn, None])
    numbers = len(vertices) + np.arange(4 * len(drawn)).reshape(-1, 4)
    edge = sides[share.struts[sides]]
    triangles = _replaced(triangles, edge, plugs[drawn] >> 1, rings[drawn], numbers)
    rings[drawn] = numbers

    sections, nodes = _open_sections(scaffold, share.struts[scaffold.refinement.edge_of_edge])
    closed = np.concatenate([corners[stubs], rings[:, ::-1], sections])
    apexes = np.concatenate([stub_apexes(scaffold, stubs), ends, refined.nodes[nodes]])
    points = np.concatenate([vertices, own.reshape(-1, 3), apexes])
    fans = _fans(closed, len(points) - len(apexes))
    return compacted(points, np.concatenate([triangles, fans]))


def _replaced(triangles: Triangles, edge: Ints, edges: Ints, old: Ints, new: Ints) -> Triangles:
    """Return triangles (t, 3) of edges (t,) with vertices `old` (k, 4) of some edges (k,) `new`."""
    if len(edges) == 0:
        return triangles
    most = int(triangles.max()) + 1
    key = (edges[:, None] * most + old).reshape(-1)
    order = np.argsort(key)
    wanted = edge[:, None] * most + triangles
    place = order[np.minimum(np.searchsorted(key, wanted, sorter=order), len(key) - 1)]
    return np.where(key[place] == wanted, new.reshape(-1)[place], triangles)


def _open_sections(scaffold: Scaffold, kept_sleeve: Bools) -> tuple[Ints, Ints]:
    """Return the sections at joints where only one sleeve is kept, and their nodes.

    The sections (k, 4) are counter-clockwise seen from the side where the sleeve is missing.
    """
    refined = scaffold.refined
    kept_count = np.bincount(refined.edges[kept_sleeve].reshape(-1), minlength=len(refined.nodes))
    lonely = (refined.valency == 2) & (kept_count == 1)
    sleeve, side = np.nonzero(lonely[refined.edges] & kept_sleeve[:, None])
    ring = scaffold.sleeves[sleeve, side]
    ring = np.where((side == 0)[:, None], ring[:, ::-1], ring)
    return ring, refined.edges[sleeve, side]


def _fans(rings: Ints, first_apex: int) -> Triangles:
    """Return the triangles from the sides of each ring (k, 4) to its own apex, (4 k, 3)."""
    apex = np.broadcast_to(first_apex + np.arange(len(rings))[:, None], rings.shape)
    return np.stack([rings, np.roll(rings, -1, axis=1), apex], axis=2).reshape(-1, 3)


def _spheres(scaffold: Scaffold, nodes: Ints, wobble: Floats) -> list[TriangleMesh]:
    """Return the closed surface of the quads around each of the branch points `nodes`.

    They grow with the wobble (n,), each by another part of it: two nodes may be at one place.
    """
    stars, incidence = scaffold.stars, scaffold.skeleton.incidence
    spheres = []
    sizes = 1.0 + np.abs(wobble[nodes]) * (0.5 + spread(len(nodes), 1))
    for node, size in zip(nodes.tolist(), sizes.tolist(), strict=True):
        half_edges = incidence.half_edges[incidence.offsets[node] : incidence.offsets[node + 1]]
        # The vertices of a star follow each other, which come first in the mesh.
        own = slice(*stars.offsets[[node, node + 1]].tolist())
        vertices = scaffold.mesh.vertices[own]
        rings = stars.corners[half_edges] - own.start
        apexes = stub_apexes(scaffold, half_edges)
        triangles = _fans(rings, len(vertices))
        center = scaffold.skeleton.nodes[node]
        points = center + size * (np.concatenate([vertices, apexes]) - center)
        spheres.append(TriangleMesh(points, triangles))
    return spheres


@dataclass(frozen=True, eq=False)
class _Struts:
    """Straight struts from node to node, in place of one or more edges left out."""

    ends: Edges
    """Nodes, shape (k, 2)."""
    axis: UnitVectors
    """Direction from the first node to the second, shape (k, 3)."""
    x: UnitVectors
    """Direction from the axis to the first corner of the section, shape (k, 3)."""
    width: Floats
    """Distance of the section's corners from the axis, in radii, shape (k,)."""


def _struts_left_out(scaffold: Scaffold, kept: Bools, wobble: Floats) -> _Struts:
    """Return the struts for the edges left out, without joints that their shape does not need."""
    skeleton = scaffold.skeleton
    ends, first_edge, wobbles = _thinned_runs(skeleton, kept, wobble)
    axis = normalize(skeleton.nodes[ends[:, 1]] - skeleton.nodes[ends[:, 0]])
    turn, widening = (wobbles * spread(len(ends), power) for power in (1, 2))
    x = rotate(_across(axis, _corner_directions(scaffold, first_edge)), axis, turn)
    return _Struts(ends, axis, x, scaffold.options.corner_distance * (1.0 + widening))


def _thinned_runs(skeleton: Skeleton, kept: Bools, wobble: Floats) -> tuple[Edges, Ints, Floats]:
    """Return the ends of straight struts along the edges left out, (k, 2), and more of each.

    Where joints follow each other more closely than the radius, as in over-sampled curves, the
    prisms of single edges would be slices with nearly the same faces.

    Returns
    -------
    (k, 2) intp, the ends; (k,) intp, an edge of each; (k,) float64, the largest wobble along it
    """
    walk = skeleton.chains
    tails = skeleton.edges.reshape(-1)
    steps = np.flatnonzero(~kept[walk.half_edges >> 1])
    starts_chain = np.isin(steps, walk.offsets)
    follows = np.diff(steps, prepend=-2) == 1
    runs = np.split(walk.half_edges[steps], np.flatnonzero(~follows | starts_chain)[1:])
    single = np.array([run[0] for run in runs if len(run) == 1], dtype=np.intp)
    ends = np.stack([tails[single], tails[single ^ 1]], axis=1)
    struts = [np.column_stack([ends, single >> 1])]
    wobbles = [_largest_of(wobble[ends[:, 0]], wobble[ends[:, 1]])]
    for run in (run for run in runs if len(run) > 1):
        stops = np.append(tails[run], tails[run[-1] ^ 1])
        points, radii = skeleton.nodes[stops], skeleton.radii[stops]
        mask = kept_samples(points, radii, THINNING * radii.min(), THINNED_SPACING)
        if stops[0] == stops[-1]:
            mask[[len(run) // 3, 2 * len(run) // 3]] = True
        keep = np.flatnonzero(mask)
        struts.append(np.stack([stops[keep[:-1]], stops[keep[1:]], run[keep[:-1]] >> 1], axis=1))
        wobbles.append(_largest_between(wobble[stops], keep))
    rows = np.concatenate(struts)
    return rows[:, :2], rows[:, 2], np.concatenate(wobbles)


def _largest_between(values: Floats, stops: Ints) -> Floats:
    """Return the value of largest size from each stop to the next, both included, (stops - 1,)."""
    before = stops[:-1]
    above = np.maximum(np.maximum.reduceat(values, before), values[stops[1:]])
    below = np.minimum(np.minimum.reduceat(values, before), values[stops[1:]])
    return _largest_of(below, above)


def _largest_of(first: Floats, second: Floats) -> Floats:
    """Return the value of larger size of each two, the greater one at a tie, (k,)."""
    below, above = np.minimum(first, second), np.maximum(first, second)
    largest: Floats = np.where(above >= -below, above, below)
    return largest


def _prisms(scaffold: Scaffold, struts: _Struts) -> list[Points]:
    """Return the corners of each strut, which goes a little beyond its nodes.

    Ends that only touched, as those of two struts in one line, would leave a gap of no width.
    """
    skeleton = scaffold.skeleton
    radii = skeleton.radii[struts.ends] * struts.width[:, None]  # (k, 2), of the corners
    further = np.where(skeleton.valency[struts.ends] > 1, OVERLAP * radii, 0.0)
    outward = np.stack([-struts.axis, struts.axis], axis=1)
    centers = skeleton.nodes[struts.ends] + further[:, :, None] * outward  # (k, 2, 3)
    sections = _square(struts.x, struts.axis)[:, None] * radii[:, :, None, None]
    return list((centers[:, :, None, :] + sections).reshape(-1, 8, 3))


def _hubs(scaffold: Scaffold, struts: _Struts, kept: Bools) -> list[Points]:
    """Return the sections that meet at each joint with a strut left out, on both its sides.

    Their hull fills the wedge between two prisms, and reaches into a sleeve that is kept.
    """
    skeleton = scaffold.skeleton
    at_joint = np.zeros(len(skeleton.nodes), dtype=np.bool_)
    at_joint[struts.ends] = True
    at_joint &= skeleton.valency == 2
    sleeves = np.flatnonzero(at_joint[skeleton.edges.reshape(-1)] & np.repeat(kept, 2))
    axis = skeleton.directions[sleeves]
    node = np.concatenate(
        [struts.ends[:, 0], struts.ends[:, 1], skeleton.edges.reshape(-1)[sleeves]]
    )
    direction = np.concatenate([struts.axis, -struts.axis, axis])
    x = np.concatenate(
        [struts.x, struts.x, _across(axis, _corner_directions(scaffold, sleeves >> 1))]
    )
    corner_distance = np.full(len(sleeves), scaffold.options.corner_distance)
    width = HUB_WIDTH * np.concatenate([struts.width, struts.width, corner_distance])

    arms = np.flatnonzero(at_joint[node])
    arms = arms[np.argsort(node[arms], kind="stable")]  # two at each joint
    radius = skeleton.radii[node[arms]]
    near = _square(x[arms], direction[arms]) * (width[arms] * radius)[:, None, None]
    far = near + (HUB_LENGTH * radius[:, None] * direction[arms])[:, None, :]
    points = np.concatenate([near, far], axis=1) + skeleton.nodes[node[arms]][:, None, :]
    return list(points.reshape(-1, 16, 3))


def _corner_directions(scaffold: Scaffold, edges: Ints) -> UnitVectors:
    """Return the direction from each edge to the first corner of its section, (k, 3)."""
    skeleton = scaffold.skeleton
    axis = skeleton.directions[2 * edges]
    sleeve = np.searchsorted(scaffold.refinement.edge_of_edge, edges)
    start = skeleton.nodes[skeleton.edges[edges, 0]]
    ring = scaffold.mesh.vertices[scaffold.sleeves[sleeve, 0]] - start[:, None, :]
    across = any_perpendicular(axis)
    return rotate(across, axis, square_phases(ring, across, np.cross(axis, across)))


def _across(axis: UnitVectors, vectors: UnitVectors) -> UnitVectors:
    """Return the directions of the parts of `vectors` across `axis`; any if they are along it."""
    parts = vectors - dot(vectors, axis)[:, None] * axis
    return np.where(length(parts)[:, None] > 0.1, normalize(parts), any_perpendicular(axis))


def _square(x: UnitVectors, axis: UnitVectors) -> Points:
    """Return four corners at distance 1 from 0 across `axis`, the first along `x`, (k, 4, 3)."""
    return four_around(x, np.cross(axis, x))
