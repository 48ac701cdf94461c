"""project: moves the vertices of a quad mesh onto a convolution surface."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, Quads, Radii, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import dot, length, normalize, sums_by_row
from scaffold_cad.convolution.field import ConvolutionField, FieldSamples
from scaffold_cad.convolution.nearby import nearby_pairs
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.skeleton import Skeleton

TOLERANCE = 1e-9
"""Greatest acceptable difference of the field from 1 on the surface."""

LEAST_CHANGE = 1e-12
"""Least change of the field over a step, as a part of it, that its rounding does not hide."""

MOST_STEPS = 30
"""Most steps of a vertex along the gradient; four are enough near the surface."""

MOST_HALVINGS = 60
"""Most times that what lies between a place inside and one outside is halved."""

OUTWARD_STEP = 0.25
"""Step in which the surface is looked for along a line from the skeleton, in radii."""

MOST_OUTWARD_STEPS = 400
"""Most of those steps."""

LEAST_FACINGS = (0.05, 0.5)
"""Least cosines between a quad's corner and the surface that need no spreading, first to unfold
quads, then to give them a shape."""

MOST_ROUNDS = 20
"""Most times that vertices of folded quads are spread."""

RINGS = 2
"""How many quads around a folded one are spread with it."""

_log = logging.getLogger(__name__)


@checks_keywords()
def project(mesh: QuadMesh, field: ConvolutionField) -> QuadMesh:
    """Return `mesh` with its vertices moved onto the convolution surface, its quads kept.

    A vertex follows the gradient in Newton's steps, none longer than the shortest edge at it. One
    that keeps passing the surface goes to where the line between its last places inside and
    outside meets it. One whose gradient leads nowhere, as beyond the reach of a compact kernel,
    goes to where the line from the nearest point of the skeleton through it does. Where quads fold
    over, the vertices around them are then spread along the surface; where they stay folded, a
    warning is logged.

    Parameters
    ----------
    mesh : around the field's skeleton, such as its scaffold with collars, its quads cut in four by
        `catmull_clark(mesh, levels, mesh.edges)`; all its vertices are moved

    Raises
    ------
    OptionError
        If `mesh` or `field` is of another type.
    MeshError
        If a vertex finds no place on the surface; it is named.

    Notes
    -----
    The mesh must be near the surface in bends and forks too, as that of a scaffold with collars
    is. Where edges that do not meet are so close that their surfaces become one, the surface has
    fewer holes than the scaffold, and the mesh crosses itself: `self_intersections` finds where.

    Examples
    --------
    >>> from scaffold_cad import ConvolutionField, Skeleton, build_scaffold, project
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> mesh = build_scaffold(strut, collars=True).mesh
    >>> field = ConvolutionField(strut)
    >>> round(float(field.value(project(mesh, field).vertices).max()), 6)
    1.0
    """
    check_kind(mesh, QuadMesh)
    check_kind(field, ConvolutionField, name="field")
    longest = _shortest_edges(mesh)
    placed = _onto(mesh.vertices, field, longest)
    for least in LEAST_FACINGS:
        _spread(placed, mesh.quads, field, longest, least)
    missed = np.flatnonzero(~(np.abs(placed.values - 1) <= TOLERANCE))
    if len(missed):
        raise MeshError(
            f"vertex {missed[0]} at {place_text(mesh.vertices[missed[0]])} finds no place on the "
            f"convolution surface ({counted(len(missed), 'vertex does', 'vertices do')} not, in "
            "all); need a mesh near it"
        )
    folded = np.flatnonzero(_facing(placed, mesh.quads) <= 0)
    if len(folded):
        _log.warning(
            "%s of the mesh on the convolution surface folded, the first is quad %d: the "
            "mesh was too far from the surface (build the scaffold with collars); whether quads "
            "cross was not checked",
            counted(len(folded), "quad"),
            folded[0],
        )
    return mesh.moved(placed.points)


@dataclass(frozen=True, eq=False)
class Placed:
    """Where vertices came to, and the field there."""

    points: Points
    """Place of each, shape (v, 3), mm."""
    values: Floats
    """The field there, shape (v,)."""
    gradients: Floats
    """Its gradient, shape (v, 3), 1/mm."""

    def put(self, where: Ints | Bools, other: Placed) -> None:
        """Move the vertices `where` to the places of `other`."""
        self.points[where] = other.points
        self.values[where] = other.values
        self.gradients[where] = other.gradients

    def taken(self, where: Ints | Bools) -> Placed:
        """Return a copy of the vertices `where`."""
        return Placed(self.points[where], self.values[where], self.gradients[where])


def _spread(
    placed: Placed, quads: Quads, field: ConvolutionField, longest: Floats, least: float
) -> None:
    """Spread the vertices along the surface around quads that face it less than `least`.

    Folds come where the surface is far from where the mesh was, as in the crotch of a fork. Where
    the worst corner does not get better, all stays as it was.
    """
    facing = _facing(placed, quads)
    before, facing_before = placed.taken(np.arange(len(placed.points))), facing.copy()
    touched = np.zeros(len(placed.points), dtype=np.bool_)
    for _ in range(MOST_ROUNDS):
        if facing.min(initial=1) >= least:
            break
        where, near = _around(quads, facing < least, len(touched))
        steps = _spreading(placed.points, quads[near], placed.gradients)[where]
        placed.put(where, _onto(placed.points[where] + steps, field, longest[where]))
        facing[near] = _facing(placed, quads[near])
        touched[where] = True
    vain = _not_better(quads, touched, facing_before, facing)
    placed.put(vain, before.taken(vain))


def _not_better(quads: Quads, touched: Bools, before: Floats, after: Floats) -> Ints:
    """Return the `touched` vertices (v,) in parts whose least of `before` (f,) did not rise."""
    pairs = np.concatenate([quads[:, [i, j]] for i in range(4) for j in range(i)])
    part = component_labels(pairs[touched[pairs].all(axis=1)], len(touched))
    part_of_quad = np.where(touched[quads], part[quads], -1).max(axis=1)
    in_part = part_of_quad >= 0
    leasts = []
    for values in (before, after):
        least = np.full(len(touched), np.inf)
        np.minimum.at(least, part_of_quad[in_part], values[in_part])
        leasts.append(least)
    return np.flatnonzero(touched & (leasts[1] <= leasts[0])[part])


def _facing(placed: Placed, quads: Quads) -> Floats:
    """Return the least cosine between a quad's corners' normals and the surface's, (f,)."""
    corners = placed.points[quads]
    ahead = np.roll(corners, -1, axis=1) - corners
    normals = normalize(np.cross(ahead, -np.roll(ahead, 1, axis=1)))
    return np.asarray(-dot(normals, normalize(placed.gradients)[quads]).max(axis=1))


def _around(quads: Quads, marked: Bools, count: int) -> tuple[Ints, Ints]:
    """Return the vertices of and around the marked quads (f,), and all quads at these."""
    vertices = np.zeros(count, dtype=np.bool_)
    for _ in range(1 + RINGS):
        vertices[quads[marked]] = True
        marked = np.asarray(vertices[quads].any(axis=1))
    return np.flatnonzero(vertices), np.flatnonzero(marked)


def _spreading(points: Points, quads: Quads, gradients: Floats) -> Points:
    """Return the step of each vertex along the surface to between its neighbors, (v, 3), mm.

    Parameters
    ----------
    quads : all those at each vertex whose step matters
    """
    spans = points[np.roll(quads, -1, axis=1)] - points[quads]  # (f, 4, 3)
    uses = np.bincount(quads.reshape(-1), minlength=len(points))
    steps = sums_by_row(spans, quads, len(points)) / np.maximum(uses, 1)[:, None]
    normals = normalize(gradients)
    return np.asarray(steps - dot(steps, normals)[:, None] * normals)


def _onto(start: Points, field: ConvolutionField, longest: Floats) -> Placed:
    """Return where the points `start` (k, 3) come to on the surface; some may miss it."""
    path = _walked(start, field, longest)
    placed = path.placed
    resting = np.abs(placed.values - 1) <= TOLERANCE
    passing = ~resting & path.is_inside & path.is_outside
    lost = ~resting & ~passing
    points = placed.points
    points[passing] = _between(path.inside[passing], path.outside[passing], field)
    if lost.any():
        points[lost] = _between(*_across(start[lost], field), field)
    samples = field.samples(points[~resting])
    placed.put(~resting, Placed(points[~resting], samples.values, samples.gradients))
    return placed


def _shortest_edges(mesh: QuadMesh) -> Floats:
    """Return the length of the shortest edge at each vertex, (v,), mm; 0 without edges."""
    ends = mesh.vertices[mesh.edges]
    lengths = length(ends[:, 1] - ends[:, 0])
    shortest = np.full(len(mesh.vertices), np.inf)
    for column in mesh.edges.T:
        np.minimum.at(shortest, column, lengths)
    return np.where(np.isfinite(shortest), shortest, 0)


@dataclass(frozen=True, eq=False)
class Path:
    """Where vertices came to along the gradient."""

    placed: Placed
    """Their last places."""
    inside: Points
    """Last place where the field was more than 1, shape (v, 3), mm."""
    is_inside: Bools
    """Whether there is one, shape (v,)."""
    outside: Points
    """Last place where the field was less than 1, shape (v, 3), mm."""
    is_outside: Bools
    """Whether there is one, shape (v,)."""


def _walked(start: Points, field: ConvolutionField, longest: Floats) -> Path:
    """Return where the points `start` (v, 3) come to with steps of at most `longest` (v,), mm."""
    placed = Placed(np.array(start), np.zeros(len(start)), np.zeros_like(start))
    inside, outside = placed.points.copy(), placed.points.copy()
    is_inside, is_outside = np.zeros((2, len(start)), dtype=np.bool_)
    active = np.arange(len(start))
    for _ in range(MOST_STEPS):
        here = placed.points[active]
        samples = field.samples(here)
        placed.put(active, Placed(here, samples.values, samples.gradients))
        more = samples.values > 1
        inside[active[more]], outside[active[~more]] = here[more], here[~more]
        is_inside[active[more]], is_outside[active[~more]] = True, True
        sure = length(samples.gradients) * longest[active] > LEAST_CHANGE * samples.values
        going = sure & (np.abs(samples.values - 1) > TOLERANCE)
        steps = _newton_steps(samples, field.integrand.exponent)[going]
        active = active[going]
        if len(active) == 0:
            break
        share = longest[active] / np.maximum(length(steps), longest[active])
        placed.points[active] += share[:, None] * steps
    return Path(placed, inside, is_inside, outside, is_outside)


def _newton_steps(samples: FieldSamples, exponent: float) -> Points:
    """Return the steps to where the field should be 1, (k, 3), mm; 0 where it has no slope.

    Newton's steps for the power of the field that is nearly linear in the squared distance: the
    field itself is so flat far from the skeleton that its own would lead too far.
    """
    slopes = length(samples.gradients)
    excess = (samples.values - samples.values ** (1 - exponent)) / exponent
    distances = np.divide(-excess, slopes, out=np.zeros_like(slopes), where=slopes > 0)
    return distances[:, None] * normalize(samples.gradients)


def _between(inside: Points, outside: Points, field: ConvolutionField) -> Points:
    """Return where the surface passes between the places `inside` and `outside`, (k, 3), mm."""
    inside, outside = inside.copy(), outside.copy()
    active = np.arange(len(inside))
    for _ in range(MOST_HALVINGS):
        middle = (inside[active] + outside[active]) / 2
        excess = field.value(middle) - 1
        # Both ends move to the middle where it is on the surface.
        low, high = excess >= -TOLERANCE, excess <= TOLERANCE
        inside[active[low]], outside[active[high]] = middle[low], middle[high]
        active = active[low != high]
    return (inside + outside) / 2


def _across(points: Points, field: ConvolutionField) -> tuple[Points, Points]:
    """Return places inside and outside the surface for `points`, two arrays of shape (k, 3), mm.

    On the line from the nearest point of the skeleton through each.
    """
    feet, radii = _feet(points, field.skeleton)
    outward = normalize(points - feet)
    inside, outside = feet, points.copy()
    hidden = np.flatnonzero(outward.any(axis=1))
    for _ in range(MOST_OUTWARD_STEPS):
        hidden = hidden[field.value(outside[hidden]) > 1]
        if len(hidden) == 0:
            break
        inside[hidden] = outside[hidden]
        outside[hidden] += (OUTWARD_STEP * radii[hidden])[:, None] * outward[hidden]
    return inside, outside


def _feet(points: Points, skeleton: Skeleton) -> tuple[Points, Radii]:
    """Return the point of the skeleton nearest to each of `points` (k, 3), and the radius there."""
    starts, ends = (skeleton.nodes[skeleton.edges[:, k]] for k in range(2))
    spans = ends - starts
    squares = dot(spans, spans)
    # No edge is farther from a point than the nearest node.
    reach = np.max(cKDTree(skeleton.nodes).query(points)[0])
    least, share = np.full(len(points), np.inf), np.zeros(len(points))
    edge = np.zeros(len(points), dtype=np.intp)
    for pairs in nearby_pairs(points, starts, ends, np.full(len(starts), reach)):
        rows, edges = (column.reshape(-1) for column in np.broadcast_arrays(*pairs))
        offsets = points[rows] - starts[edges]
        shares = np.clip(dot(offsets, spans[edges]) / squares[edges], 0, 1)
        gaps = length(offsets - shares[:, None] * spans[edges])
        np.minimum.at(least, rows, gaps)
        nearest = gaps == least[rows]
        edge[rows[nearest]], share[rows[nearest]] = edges[nearest], shares[nearest]
    low, high = skeleton.edge_radii[edge].T
    return starts[edge] + share[:, None] * spans[edge], low + share * (high - low)
