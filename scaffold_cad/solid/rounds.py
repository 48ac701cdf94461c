"""Round struts as a watertight mesh: rings and bands, and a field solid where they are crowded.

What is written is what is proved. Beyond the proof of the smooth surface, the triangles of each
node are seen from the node from outside in the 32-bit coordinates of files, and polygons, which
reach beyond their circles, keep apart. Where one of these does not hold the nodes are crowded too.
"""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arguments import as_count, check_kind
from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.base.vectors import length, triple
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field import FieldStruts, field_solid, field_struts
from scaffold_cad.struts.apart import crossing_runs
from scaffold_cad.struts.bands import enlargement
from scaffold_cad.struts.curverings import largest_growth, rings_hold
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import BLEND
from scaffold_cad.struts.surface import Triangulated, triangulated

SIDES = 16
"""Sides of round struts in meshes where none are given."""

MARGIN = 1e-9
"""Least sine of the angle at which the triangles of a node are seen from it."""


_log = logging.getLogger(__name__)


def round_mesh(struts: RoundStruts, sides: int = SIDES) -> TriangleMesh:
    """Return the surface of round struts, closed and without crossings in 32-bit coordinates.

    Parameters
    ----------
    sides : of the polygon that stands for a circle, a multiple of 4; it has the circle's area

    Raises
    ------
    OptionError
        If `struts` is not a RoundStruts, or `sides` is not a multiple of 4.
    """
    check_kind(struts, RoundStruts)
    check_sides(sides)
    if struts.crowded.any() or len(_polygons_crossing(struts, sides)):
        return _field(struts)
    made = triangulated(struts, sides)
    if not (_seen_from_nodes(struts, made).all() and _in_order(made).all()):
        return _field(struts)
    return made.mesh


def coarse_union(struts: RoundStruts) -> TriangleMesh:
    """Return the union of round struts with few triangles, for formats where each is a face."""
    check_kind(struts, RoundStruts)
    fields = _field_struts(struts)
    return field_solid(fields, cell=float(fields.radii.max())).mesh


def check_sides(sides: int) -> None:
    """Raise unless a round strut can have so many sides."""
    if as_count(sides, "sides", 4) % 4:
        raise OptionError(f"sides is {sides}; need a multiple of 4")


def _polygons_crossing(struts: RoundStruts, sides: int) -> Ints:
    slack = max(
        float(enlargement(np.array([np.pi / sides]), sides)[0]) - 1.0, largest_growth(sides)
    )
    return crossing_runs(struts.runs, struts.blended, struts.curves, struts.collar, slack)


def _seen_from_nodes(struts: RoundStruts, made: Triangulated) -> Bools:
    """Return whether each triangle of a node faces away from it in 32-bit coordinates, (t',)."""
    corners = made.mesh.single_precision().vertices[made.mesh.triangles[: len(made.node)]]
    a, b, c = np.moveaxis(corners - struts.runs.nodes[made.node][:, None], 1, 0)
    size: Floats = length(a) * length(b) * length(c)
    return np.asarray(triple(a, b, c) > MARGIN * size)


def _in_order(made: Triangulated) -> Bools:
    """Return whether the rings of curves follow each other in 32-bit coordinates, (l,)."""
    rings = made.curve_rings
    start = len(made.node)
    triangles = made.mesh.triangles[start : start + 2 * rings.low.size]
    return rings_hold(made.mesh.single_precision().vertices, rings, triangles)


def _field(struts: RoundStruts) -> TriangleMesh:
    """Return the whole of the struts as a field solid."""
    count = len(struts.skeleton.edges)
    _log.info("%d struts have too little room for rings of their own: made as a field", count)
    return field_solid(_field_struts(struts)).mesh


def _field_struts(struts: RoundStruts) -> FieldStruts:
    runs, skeleton = struts.runs, struts.skeleton
    at_end = runs.valency[runs.edges] == 1  # (k, 2)
    used = np.flatnonzero(runs.valency > 0)
    widest = np.zeros(len(skeleton.nodes))
    np.maximum.at(widest, runs.tails, runs.radii.reshape(-1))
    balls = used[skeleton.radii[used] > widest[used] * (1 + 1e-9)]
    given = struts.options.blend
    blend = BLEND * runs.radii.min(axis=1) if given is None else np.full(len(runs.edges), given)
    return field_struts(
        runs.nodes[runs.edges],
        runs.radii,
        flat=at_end & (struts.options.ends == "flat"),
        balls=runs.nodes[balls],
        ball_radii=skeleton.radii[balls],
        blend=blend,
    )
