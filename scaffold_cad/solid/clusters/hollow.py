"""Hollow struts with crowded places: surfaces outside and inside that do not cross each other."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, place_text
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.aims import between
from scaffold_cad.solid.clusters.closing import shortened
from scaffold_cad.solid.clusters.core import Core
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.spans import CUT, Spans
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.struts.curves.proof import proved
from scaffold_cad.struts.meshes.surface import inside_of
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.runs import Runs, ball_ends

FINER = 5
"""Times that hollow struts are made, with cells of half the size where walls cross, until these
are whole."""

AROUND = CUT + 0.05
"""How far past spans walls are looked at, in the strut's radii: their cuts, rings and all."""

LEAST_BEND = 1.5
"""Bend of a curve of equal links, in its radii, from which on the first one has no fold."""

THIN = 0.9
"""Part of the wall below which cells beside it are made smaller."""

_log = logging.getLogger(__name__)


class Made(Protocol):
    """Solid struts, some of which are in fields."""

    @property
    def nodes(self) -> Bools:
        """Nodes that are in fields, shape (n,)."""

    @property
    def pieces(self) -> Bools:
        """Pieces of curves that are in fields, shape (p,)."""

    @property
    def spans(self) -> Spans:
        """Stretches of runs that are in fields."""

    @property
    def fillets(self) -> Floats:
        """Fillet radius of each node, mm, shape (n,)."""


class _Surface(Made, Protocol):
    """The surface of these."""

    @property
    def mesh(self) -> TriangleMesh:
        """Its triangles."""

    @property
    def node(self) -> Ints:
        """Nodes that the first triangles are around, shape (t',)."""


Solid = TypeVar("Solid", bound=Made)
Surface = TypeVar("Surface", bound=_Surface)


def hollow(
    struts: RoundStruts,
    core_of: Callable[[RoundStruts], Core],
    make: Callable[[RoundStruts, Floats, Core, Fineness, Surface | None], Surface],
    joined: Callable[[Surface, Surface], TriangleMesh],
    factor: float = 1.0,
) -> tuple[Surface, Surface]:
    """Return the surfaces outside and inside of hollow struts.

    Where their outside and their inside cross, nodes become fields, and the cells of fields
    smaller; these do so, too, where the outside is near an inside that is its own.

    Parameters
    ----------
    core_of : what has no surface of its own of solid struts, and is in clusters
    make : the surface of solid struts, from their fillets (n,), what is in clusters, how fine
        fields are, and of an inside the surface outside
    joined : both surfaces as triangles, those of the outside first, then those of the inside
    """
    inner = inside_of(struts)
    core = core_of(struts).joined(core_of(inner))
    fineness, finer = Fineness(sag=float(struts.options.wall or 0.0) / 4.0), False
    for left in reversed(range(FINER)):
        outside, inside = both_of(struts, inner, make, core, fineness)
        mesh = joined(outside, inside)
        written = TriangleMesh(in_single_precision(mesh.vertices, factor), mesh.triangles)
        crossing = np.unique(self_intersections(written))
        if len(crossing) == 0:
            thin = _thin_places(outside, struts, inner)
            if finer or left == 0 or len(thin) == 0:
                return outside, inside
            fineness, finer = fineness.finer_at(thin), True
            continue
        places = mesh.vertices[mesh.triangles[crossing]].mean(axis=1)
        at_nodes = _nodes_of(crossing, outside, inside)
        _log.debug("walls cross in %d triangles", len(crossing))
        crossed = np.zeros_like(core.nodes)
        crossed[at_nodes[at_nodes >= 0]] = True
        core = core.with_nodes(crossed)
        fineness = fineness.finer_at(places)
    raise MeshError(
        f"the wall of {struts.options.wall:g} mm crosses itself as triangles in {len(crossing)} "
        f"places, the first near {place_text(places[0])}; need a thicker wall, more sides, or "
        "larger angles between struts"
    )


def tell_closed(struts: RoundStruts, outside: Made) -> None:
    """Warn of open ends that came to be closed, as they are in fields, and say why."""
    runs = struts.runs
    is_end = (runs.valency == 1) & ~ball_ends(struts.skeleton, runs)
    closed = np.flatnonzero(outside.nodes[: len(runs.nodes)] & is_end)
    if struts.options.ends != "open" or len(closed) == 0:
        return
    folds = _folds_beside(struts, closed, outside.pieces)
    bent, others = closed[folds >= 0], closed[folds < 0]
    if len(bent):
        circle = folds[folds >= 0][0]
        _log.warning(
            "%s closed, as the curve beside bends too tightly: node %d at %s%s, near %s, where the "
            "radius is %.3g mm; need a bend of %.3g radii or more, or a longer straight end",
            counted(len(bent), "open end is", "open ends are"),
            bent[0],
            place_text(runs.nodes[bent[0]]),
            " first" if len(bent) > 1 else "",
            place_text(struts.curves.centers[circle]),
            struts.curves.radii[circle],
            LEAST_BEND,
        )
    if len(others):
        _log.warning(
            "%s other struts, or nearly so, and closed: node %d at %s%s; need more room around",
            counted(len(others), "open end overlaps", "open ends overlap"),
            others[0],
            place_text(runs.nodes[others[0]]),
            " first" if len(others) > 1 else "",
        )


def _folds_beside(struts: RoundStruts, ends: Ints, in_field: Bools) -> Ints:
    """Return the most bent circle of the folded piece that takes each end into a field.

    Parameters
    ----------
    ends : (e,) extremities
    in_field : (p,) pieces of curves that are in fields

    Returns
    -------
    (e,) numbers of circles, -1 where the pieces beside are not folded, or there are none
    """
    runs, curves = struts.runs, struts.curves
    folded, found = ~proved(curves), np.full(len(ends), -1)
    leaves = runs.incidence.half_edges[runs.incidence.offsets[ends]]
    for row, leaf in enumerate(leaves.tolist()):
        for curve, side in np.argwhere(curves.half_runs == leaf ^ 1).tolist():
            pieces = np.flatnonzero(curves.curve_of_piece == curve)[:: 1 - 2 * side]
            is_left = ~in_field[pieces]
            bad = pieces[: is_left.argmax() if is_left.any() else len(pieces)]
            bad = bad[folded[bad]]
            if len(bad):
                circles = curves.pieces[bad[0]] + np.arange(2)
                found[row] = circles[length(curves.bends[circles]).argmax()]
    return found


def _nodes_of(triangles: Ints, outside: _Surface, inside: _Surface) -> Ints:
    """Return the nodes that triangles of walls are around, -1 where they are around none."""
    node = np.full(len(triangles), -1)
    for surface, first in ((outside, 0), (inside, len(outside.mesh.triangles))):
        own = triangles - first
        there = (own >= 0) & (own < len(surface.node))
        node[there] = surface.node[own[there]]
    return node


def _thin_places(outside: _Surface, struts: RoundStruts, inner: RoundStruts) -> Points:
    """Return points outside (k, 3) at thin walls beside struts that cross by their outsides only.

    What is inside these is no field, which could move away. The outside will, by less where its
    cells are small.
    """
    runs, wall = struts.runs, float(struts.options.wall or 0.0)
    _, is_field = _along(outside.spans, runs, inner.runs, wall)
    spans = outside.spans.chosen(~is_field)
    if len(spans) == 0:
        return np.zeros((0, 3))
    looked = between(outside.mesh.triangles)
    points = np.concatenate([outside.mesh.vertices[each].mean(axis=1) for each in looked])
    tail: Points = runs.nodes[runs.edges[spans.run, 0]]
    ahead: Points = runs.directions[2 * spans.run]
    radius = runs.radii[spans.run].max(axis=1)
    low, high = spans.low - AROUND * radius, spans.high + AROUND * radius
    # Places along the axes, by which points find the span that they are near to.
    count: Ints = np.ceil((high - low) / radius).astype(np.intp) + 1
    row: Ints = np.repeat(np.arange(len(spans)), count)
    along = low[row] + steps(count) / (count[row] - 1) * (high - low)[row]
    axes = tail[row] + along[:, None] * ahead[row]
    far, found = cKDTree(axes).query(points, distance_upper_bound=1.5 * float(radius.max()))
    near = np.flatnonzero(np.isfinite(far))
    points, row = points[near], row[np.asarray(found)[near]]
    along = dot(points - tail[row], ahead[row])
    off = length(points - tail[row] - along[:, None] * ahead[row])
    left = off - inner.runs.radii_at(2 * spans.run[row], along)
    thin = (left < THIN * wall) & (along > low[row]) & (along < high[row])
    return np.asarray(points[thin])


def _along(spans: Spans, runs: Runs, inside: Runs, wall: float) -> tuple[Spans, Bools]:
    """Return the spans as those of the same runs inside, and which are fields there, (q,).

    They go on past the rings of those outside, where facets are inside of the round surface: what
    is inside of facets can move away from them. Those where struts cross by their outsides only are
    no fields inside.
    """
    way = inside.nodes[inside.edges[:, 0]] - runs.nodes[runs.edges[:, 0]]
    shift = dot(way, runs.directions[::2])[spans.run]
    more = (1.0 + CUT) * wall  # a ring is `CUT` radii past its span, and radii inside are less
    at_node = (spans.low == 0) | (spans.high == runs.lengths[spans.run])
    low = np.where(spans.low > 0, spans.low - more, -np.inf)
    high = np.where(spans.high < runs.lengths[spans.run], spans.high + more, np.inf)
    own = Spans(spans.run, low - shift, high - shift)
    return own, at_node | _cross(own, inside)


def _cross(spans: Spans, runs: Runs) -> Bools:
    """Return which stretches of runs cross others of them, (q,)."""
    found = np.zeros(len(spans), dtype=np.bool_)
    bounds = np.stack([spans.low.clip(0.0), np.minimum(spans.high, runs.lengths[spans.run])])
    tail, ahead = runs.nodes[runs.edges[spans.run, 0]], runs.directions[2 * spans.run]
    ends = tail + bounds[..., None] * ahead  # (2, q, 3)
    radii = runs.radii[spans.run].max(axis=1)
    low, high = ends.min(axis=0) - radii[:, None], ends.max(axis=0) + radii[:, None]
    for one, other in overlapping_boxes(low, high):
        near = nearest_on_segments(ends[0, one], ends[1, one], ends[0, other], ends[1, other])
        meet = length(near[1] - near[0]) < radii[one] + radii[other]
        meet &= spans.run[one] != spans.run[other]
        found[one[meet]] = found[other[meet]] = True
    return found


def both_of(
    struts: RoundStruts,
    inner: RoundStruts,
    make: Callable[[RoundStruts, Floats, Core, Fineness, Solid | None], Solid],
    core: Core,
    fineness: Fineness,
) -> tuple[Solid, Solid]:
    """Return the outside and the inside of hollow struts.

    What is a field outside around nodes is one inside too: where cells cut off a part of the wall
    the inside can move. Of curves the same pieces are fields on both sides, which follow edges and
    not the curve.
    """
    wall, fillets = float(struts.options.wall or 0.0), wanted_fillets(struts)
    is_end = (struts.runs.valency == 1) & ~ball_ends(struts.skeleton, struts.runs)
    is_open = struts.options.ends == "open"
    while True:
        outside = make(struts, fillets, core, fineness, None)
        own = shortened(inner, core.nodes & is_end, wall)
        core = core.with_zone(outside.pieces)
        spans, is_field = _along(outside.spans, struts.runs, own.runs, wall)
        there = core.with_spans(spans.chosen(is_field))
        # Fields of fillets a wall wider would be parallel where struts meet at right angles only.
        inside = make(own, outside.fillets, there, fineness, outside)
        more = (outside.nodes | inside.nodes) & is_end & ~core.nodes & is_open
        if not more.any() and np.array_equal(inside.pieces, outside.pieces):
            return outside, inside
        core = core.with_nodes(more).with_zone(inside.pieces)
