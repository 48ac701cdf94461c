"""What a solid is put together from where a scaffold is not embedded.

The struts and nodes that keep to their own room stay one closed surface; each strut left out
becomes a prism along its axis, each branch point left out its own closed sphere of quads, and each
joint at a strut left out the convex hull of the sections that meet there. All are closed, and all
but the first two are convex. Arrays only: the union is made elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Triangles, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, dot, four_around, length, normalize, rotate
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.embedding import Embedding, stub_apexes
from scaffold_cad.scaffold.sleeves import fitted_angle
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.thinning import kept_samples

PLASTIC = 1.32471795724474602596
"""The plastic number, the root of x³ = x + 1."""

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

    surface: TriangleMesh
    """What is embedded, possibly empty."""
    spheres: list[TriangleMesh]
    """The quads of each branch point left out."""
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
    struts = _struts_left_out(scaffold, embedded.kept, wobble)
    return Pieces(
        _kept_surface(scaffold, embedded),
        _spheres(scaffold, np.flatnonzero(~embedded.kept_nodes), wobble),
        [*_prisms(scaffold, struts), *_hubs(scaffold, struts, embedded.kept)],
    )


def spread(count: int, axis: int) -> Floats:
    """Return evenly spread numbers in [-1/2, 1/2), unlike for neighbors, (count,).

    Multiples of the powers of the plastic number's inverse: Roberts's additive recurrence.
    """
    spread: Floats = np.remainder(np.arange(1, count + 1) * PLASTIC**-axis, 1.0) - 0.5
    return spread


def _kept_surface(scaffold: Scaffold, embedded: Embedding) -> TriangleMesh:
    """Return the closed surface of the struts and nodes that are kept."""
    refined = scaffold.refined
    kept_sleeve = embedded.kept[scaffold.refinement.edge_of_edge]
    quads = scaffold.mesh.triangles.reshape(-1, 2, 3)
    kept_quad = embedded.kept[scaffold.edge_of_quad]
    tails = scaffold.skeleton.edges.reshape(-1)

    half_edges = np.flatnonzero(scaffold.stars.corners[:, 0] >= 0)
    open_quad = ~embedded.kept[half_edges >> 1] & embedded.kept_nodes[tails[half_edges]]
    half_edges = half_edges[open_quad]
    apexes = stub_apexes(scaffold, half_edges)
    stubs = _fans(scaffold.stars.corners[half_edges], len(scaffold.mesh.vertices))

    rings, nodes = _open_sections(scaffold, kept_sleeve)
    closures = _fans(rings, len(scaffold.mesh.vertices) + len(apexes))
    vertices = np.concatenate([scaffold.mesh.vertices, apexes, refined.nodes[nodes]])
    triangles = np.concatenate([quads[kept_quad].reshape(-1, 3), stubs, closures])
    return compacted(vertices, triangles)


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
    return rotate(across, axis, fitted_angle(ring, across, axis))


def _across(axis: UnitVectors, vectors: UnitVectors) -> UnitVectors:
    """Return the directions of the parts of `vectors` across `axis`; any if they are along it."""
    parts = vectors - dot(vectors, axis)[:, None] * axis
    return np.where(length(parts)[:, None] > 0.1, normalize(parts), any_perpendicular(axis))


def _square(x: UnitVectors, axis: UnitVectors) -> Points:
    """Return four corners at distance 1 from 0 across `axis`, the first along `x`, (k, 4, 3)."""
    return four_around(x, np.cross(axis, x))
