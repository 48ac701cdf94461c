"""Clusters as facets beside exact struts: fields that end in polygons inside of their circles.

The mesh of a cluster is cut off across each strut that leaves it, as for meshes, and joined to a
polygon in the plane in which the exact strut begins. The polygon lies inside the strut's circle,
outside of walls around it, and the ring between both is a plane face of its own.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points
from scaffold_cad.base.ranges import steps
from scaffold_cad.mesh.decimation import decimated
from scaffold_cad.mesh.pieces import without_voids
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.core import Core
from scaffold_cad.solid.clusters.fields import cluster_struts, whole_struts
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.growth import Clusters, bodies_of, clusters_of
from scaffold_cad.solid.clusters.remade import Remade
from scaffold_cad.solid.clusters.seams import seamed
from scaffold_cad.solid.clusters.surface import TRIES, field_of, grown, report_filled
from scaffold_cad.solid.field import FieldStruts
from scaffold_cad.solid.field.solid import SWELL, cell_fraction
from scaffold_cad.struts.apart import Slack
from scaffold_cad.struts.model import RoundStruts

SIDES = 32
"""Corners of the polygons in which clusters end."""

INSET = 0.005
"""How far the corners of polygons are inside of their circles, in radii: more than CAD programs
take for one place. Outside of walls the middles of their sides are as far outside of the circles:
walls are not thinner for them."""

FLAT = 0.005
"""How far facets are off the field's surface, in radii of the struts there, by the root of the
mean square: of parts of few facets. Others may be off four times as far."""

PART_OF_SAG = 0.0625
"""How far facets are off at most where walls have sides with less room, in this room."""

BESIDE = 1.0
"""How far from polygons facets of walls are off less, in radii of the struts there: what is beside
a polygon, which stays, cannot move to where walls are as asked."""

LESS = 0.3
"""By how much less that is."""

FEW, MANY = 1000, 50_000
"""Facets of a part from which on they become coarser, up to four times, and that again."""

FINENESS = Fineness()
"""Of fields that become facets, which are then as few as `FLAT` allows."""

SLACK = 2.0 * SWELL * cell_fraction(FINENESS.sides) ** 2
"""How much thicker than struts their fields are at most, in radii."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Faceted(Frozen):
    """Clusters as facets, and what is left beside them."""

    clusters: Clusters | None
    """Nodes and spans that are facets, and the struts that are left; None if all are facets."""
    mesh: TriangleMesh
    """The facets, open at the polygons: the first vertices are theirs."""
    rings: Ints
    """Vertices of the polygon at each cut, counter-clockwise about its `outward`, (c, SIDES)."""
    half_runs: Ints
    """Half-run that begins at each cut, among those left, shape (c,)."""
    around: bool
    """Whether the polygons are around the circles of struts, not inside of them."""


def faceted(
    struts: RoundStruts, fillets: Floats, core: Core, fineness: Fineness = FINENESS
) -> Faceted | None:
    """Return the clusters of struts as facets, or None if no strut is crowded.

    Parameters
    ----------
    fillets : (n,) fillet radius wanted at each node, mm
    core : what is in clusters in any case
    fineness : of the fields that become facets
    """
    around = struts.inner is not None
    seeds, bodies = core.spans, cache(partial(bodies_of, struts))
    remade = Remade(lambda some: field_of(some, SIDES, fineness))
    for _ in range(TRIES):
        clusters = clusters_of(struts, bodies, fillets, Slack(SLACK), core, seeds)
        if clusters is None or len(clusters.rest.run) == 0:
            break
        if len(clusters.spans) == 0:
            return None
        cuts, left = clusters.rest.cuts, clusters.rest.struts
        half_runs = _half_runs(left, cuts.node)
        points, starts = _polygons(left, half_runs, around), left.x[half_runs]
        rings = np.arange(len(points)).reshape(-1, SIDES)
        fields = cluster_struts(struts, clusters)
        field, voids = without_voids(remade.surface(fields), fields.middles)
        made = seamed(field, cuts, points, rings, starts)
        if len(made.failed) == 0:
            report_filled(voids)
            vertices = np.concatenate([points, made.vertices])
            mesh = _compacted(vertices, made.triangles, len(points))
            return Faceted(
                clusters, _coarser(mesh, fields, rings, fineness), rings, half_runs, around
            )
        _log.debug("%d of %d seams failed", len(made.failed), len(cuts.node))
        core, seeds = grown(struts, clusters, made.failed)
    none, fields = np.zeros((0, SIDES), dtype=np.intp), whole_struts(struts)
    field, voids = without_voids(field_of(fields, SIDES, fineness), fields.middles)
    report_filled(voids)
    mesh = _coarser(field, fields, none, fineness)
    return Faceted(None, mesh, none, none[:, 0], around)


def _coarser(
    mesh: TriangleMesh, fields: FieldStruts, rings: Ints, fineness: Fineness
) -> TriangleMesh:
    """Return the mesh of a field with fewer triangles."""
    count = 1 + np.ceil(fields.lengths / fields.radii.min(axis=1)).astype(np.intp)
    which = np.repeat(np.arange(len(count)), count)
    step = steps(count)
    share = (step / np.maximum(count - 1, 1)[which])[:, None]
    start, end = np.moveaxis(fields.ends[which], 1, 0)
    radii = (1.0 - share[:, 0]) * fields.radii[which, 0] + share[:, 0] * fields.radii[which, 1]
    near = cKDTree(start + share * (end - start)).query(mesh.vertices)[1]
    tolerance = FLAT * radii[near]
    if np.isfinite(fineness.sag):  # of walls
        tolerance = np.minimum(tolerance, PART_OF_SAG * fineness.sags(fields)[which][near])
        if len(rings):
            far = cKDTree(mesh.vertices[rings.reshape(-1)]).query(mesh.vertices)[0]
            tolerance[far < BESIDE * radii[near]] *= LESS
    return decimated(mesh, tolerance, rings.reshape(-1), (FEW, FEW, MANY, MANY))


def _half_runs(left: RoundStruts, nodes: Ints) -> Ints:
    """Return the half-runs that leave nodes of one strut, (c,)."""
    of_node = np.full(len(left.runs.nodes), -1)
    of_node[left.runs.tails] = np.arange(len(left.runs.tails))
    return of_node[nodes]


def _polygons(left: RoundStruts, half_runs: Ints, outside: bool) -> Points:
    """Return the polygons in the circles at the nodes of half-runs (c,), (c SIDES, 3), mm.

    Parameters
    ----------
    outside : whether they are around the circles instead
    """
    runs = left.runs
    angle = 2 * np.pi / SIDES * np.arange(SIDES)
    x = left.x[half_runs]
    y = np.cross(runs.directions[half_runs], x)
    around = np.cos(angle)[:, None] * x[:, None] + np.sin(angle)[:, None] * y[:, None]
    share = (1.0 + INSET) / np.cos(np.pi / SIDES) if outside else 1.0 - INSET
    size = share * runs.radii.reshape(-1)[half_runs]
    center = runs.nodes[runs.tails[half_runs]]
    points: Points = center[:, None] + size[:, None, None] * around
    return points.reshape(-1, 3)


def _compacted(vertices: Points, triangles: Ints, kept: int) -> TriangleMesh:
    """Return triangles with the vertices that they use, the first `kept` of which are all used."""
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[triangles] = True
    used[:kept] = True
    return TriangleMesh(vertices[used], (np.cumsum(used) - 1)[triangles])
