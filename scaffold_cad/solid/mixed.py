"""Round struts some of which are crowded, as one B-rep: facets at clusters, exact faces beside."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Ints
from scaffold_cad.brep.analytic import AnalyticBrep, Surface
from scaffold_cad.brep.facets import brep_of_triangles, edges_between
from scaffold_cad.brep.joining import PlaneRings, by_edges, extended, with_voids
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.facets import Faceted, faceted
from scaffold_cad.solid.clusters.growth import unproved
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.solid.field.pieces import Pieces, pieces_of
from scaffold_cad.struts.faceplan import FacePlan
from scaffold_cad.struts.faces import brep_of_struts, run_names, shells_of
from scaffold_cad.struts.model import RoundStruts

NAMED = 5
"""Nodes or struts that the name of a cluster has at most."""

_log = logging.getLogger(__name__)


def mixed_brep(struts: RoundStruts) -> AnalyticBrep:
    """Return the B-rep of solid round struts some of which are crowded.

    Faces are exact but at clusters, which are plane triangles, see `faceted`. Where a strut begins
    beside a cluster a plane ring lies between its circle and a polygon.
    """
    made = faceted(struts, wanted_fillets(struts), unproved(struts))
    if made is None:
        return brep_of_struts(struts)
    pieces = _pieces(made)
    piece = pieces.piece_of[made.mesh.triangles[:, 0]]
    names = _cluster_names(struts, made, pieces)
    _log.info("%d plane facets, at %s", len(piece), "; ".join(names[:NAMED]))
    facets, first = brep_of_triangles(made.mesh, piece, names), 0
    if made.clusters is not None:
        rest = made.clusters.rest
        plan = FacePlan.of(rest.struts.straight, rest.open_at)
        exact = _named(shells_of(plan), struts, made)
        rings = _rings(plan, made, facets, len(exact.names) + piece[_at_rings(made)])
        first = int((exact.faces.kinds == Surface.PLANE).sum())
        whole = replace(facets, faces=replace(facets.faces, shell=np.zeros_like(piece)))
        facets = by_edges(extended(exact, whole, rings))
    void = np.zeros(len(facets.solid), dtype=np.bool_)
    void[facets.faces.shell[first : first + len(piece)][pieces.volumes[piece] < 0]] = True
    return with_voids(facets, void)


def _pieces(made: Faceted) -> Pieces:
    """Return the connected surfaces of facets, with their volumes once polygons are filled."""
    rings = made.rings
    around = np.stack(np.broadcast_arrays(rings[:, :1], rings, np.roll(rings, -1, axis=1)), axis=-1)
    triangles = np.concatenate([made.mesh.triangles, around[:, 1:-1].reshape(-1, 3)])
    return pieces_of(TriangleMesh(made.mesh.vertices, triangles))


def _at_rings(made: Faceted) -> Ints:
    """Return a triangle at each polygon, (c,)."""
    triangle = np.empty(len(made.mesh.vertices), dtype=np.intp)
    triangle[made.mesh.triangles] = np.arange(len(made.mesh.triangles))[:, None]
    return triangle[made.rings[:, 0]]


def _rings(plan: FacePlan, made: Faceted, facets: AnalyticBrep, name: Ints) -> PlaneRings:
    """Return the plane rings between the circles of struts and the polygons of clusters."""
    assert made.clusters is not None
    cuts, runs = made.clusters.rest.cuts, plan.struts.runs
    circle = np.empty(len(runs.nodes), dtype=np.intp)
    circle[runs.tails[plan.ends]] = plan.end_rings + np.arange(len(plan.ends))
    side, ahead = edges_between(facets, made.rings, np.roll(made.rings, -1, axis=1))
    none = np.zeros(len(cuts.node), dtype=np.bool_)
    return PlaneRings(
        runs.nodes[cuts.node],
        -cuts.outward,
        made.clusters.rest.struts.x[made.half_runs],
        np.hstack([circle[cuts.node][:, None], side]),
        np.hstack([none[:, None], ahead]),
        none,
        none.astype(np.intp),
        name,
    )


def _named(exact: AnalyticBrep, struts: RoundStruts, made: Faceted) -> AnalyticBrep:
    """Return the faces of what is left with the names of the struts that it is a part of."""
    assert made.clusters is not None
    rest = made.clusters.rest
    names = run_names(struts.runs)
    own = [names[run] for run in rest.run[~rest.struts.curves.curved].tolist()]
    return replace(exact, names=(*own, *exact.names[len(own) :]))


def _cluster_names(struts: RoundStruts, made: Faceted, pieces: Pieces) -> list[str]:
    """Return the name of each connected surface of facets, after its nodes or its struts."""
    runs, clusters = struts.runs, made.clusters
    near = cKDTree(made.mesh.vertices)
    nodes, of_run = np.unique(runs.edges), np.full(len(runs.edges), -1)
    if clusters is not None:
        spans = clusters.spans
        nodes = np.flatnonzero(clusters.nodes)
        middle = (spans.low + spans.high) / 2
        places = runs.nodes[runs.edges[spans.run, 0]]
        places = places + middle[:, None] * runs.directions[2 * spans.run]
        of_run[spans.run] = pieces.piece_of[near.query(places)[1]]
    of_node = pieces.piece_of[near.query(runs.nodes[nodes])[1]]
    run_of = run_names(runs)
    found = []
    for piece in range(len(pieces.volumes)):
        own = [str(node) for node in nodes[of_node == piece].tolist()]
        what = "node" if own else "strut"
        own = own or [run_of[run].split()[-1] for run in np.flatnonzero(of_run == piece).tolist()]
        more = ", ..." if len(own) > NAMED else ""
        found.append(f"cluster of {what}{'s' * (len(own) != 1)} {', '.join(own[:NAMED])}{more}")
    return found
