"""Round struts some of which are crowded, as one B-rep: facets at clusters, exact faces beside."""

from __future__ import annotations

import logging
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.brep.analytic import AnalyticBrep
from scaffold_cad.brep.facets import brep_of_triangles, edges_between
from scaffold_cad.brep.joining import (
    PlaneRings,
    by_edges,
    edge_numbers,
    extended,
    turned,
    with_voids,
)
from scaffold_cad.mesh.pieces import Pieces, pieces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.facets import SIDES, Faceted, faceted
from scaffold_cad.solid.clusters.growth import Core, unproved
from scaffold_cad.solid.clusters.hollow import hollow, thin_places
from scaffold_cad.solid.clusters.sags import Sags
from scaffold_cad.solid.clusters.spans import Spans, no_spans, whole_runs
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.solid.clusters.walls import Walls, thickened
from scaffold_cad.struts.breps.faces import bored, end_rings, faces_of, run_names
from scaffold_cad.struts.meshes.bands import polygon_wall
from scaffold_cad.struts.meshes.surface import annuli, shell_of
from scaffold_cad.struts.model import RoundStruts

CLUSTER = "cluster"
"""What names of facets begin with."""

NAMED = 5
"""Nodes or struts that the name of a cluster has at most."""

BODY, VOID, EITHER = range(3)
"""What a face says of its shell: that it bounds a body or a void in one, or nothing."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class _Part(Frozen):
    """The surface of solid struts."""

    faces: AnalyticBrep
    """Its faces; as their shells they have what they say of these."""
    circles: Ints
    """Edge at each node where a strut ends, else -1, shape (n,)."""
    first_name: int
    """Place of the name of node 0."""
    mesh: TriangleMesh
    """Triangles near it."""
    node: Ints
    """Nodes that the first of these are around."""
    nodes: Bools
    """Nodes in clusters, (n,)."""
    pieces: Bools
    """Pieces of curves in clusters, (p,)."""
    fillets: Floats
    """Fillet radius of each node, mm, (n,)."""
    spans: Spans
    """Stretches of runs in clusters."""


def mixed_brep(struts: RoundStruts) -> AnalyticBrep:
    """Return the B-rep of round struts some of which are crowded.

    Faces are exact but at clusters, which are plane triangles, see `faceted`. Where a strut begins
    beside a cluster a plane ring lies between its circle and a polygon. Open ends that come to lie
    in clusters are closed.

    Raises
    ------
    MeshError
        If the walls of hollow struts cross.
    """
    if struts.inner is None:
        return _told(_solids(_part(struts, wanted_fillets(struts), unproved(struts)).faces))
    outside, inside = hollow(struts, unproved, _part, _together)
    _tell_thin(struts, *thin_places(outside, struts, struts.inner))
    own = inside.faces.faces
    kind = np.where(own.shell == VOID, BODY, VOID)  # what a solid is inside is a void
    void = replace(inside.faces, faces=replace(own, shell=kind))
    runs = struts.runs
    ends = np.flatnonzero(runs.valency[runs.tails] == 1)
    circles = np.stack([outside.circles, inside.circles], axis=1)[runs.tails[ends]]
    is_open = (circles >= 0).all(axis=1) & (struts.options.ends == "open")
    ends, circles = ends[is_open], circles[is_open]
    either = np.full(len(ends), EITHER)
    if len(struts.sockets.nodes):
        void, circles[:, 1] = bored(struts, void, ends, circles[:, 1], either, inside.first_name)
    rings = end_rings(struts, ends, circles, either, outside.first_name)
    return _told(_solids(extended(outside.faces, turned(void), rings)))


def _tell_thin(struts: RoundStruts, places: Points, walls: Floats) -> None:
    """Log that facets leave thin walls beside exact insides, at points (k, 3)."""
    if len(walls):
        _log.warning(
            "a wall is as thin as %.3g mm near %s, for the %g mm asked for: facets where struts "
            "cross by their outsides only are within the round struts; need the struts further "
            "apart, thicker walls, or a mesh format",
            walls.min(),
            place_text(places[walls.argmin()]),
            struts.options.wall,
        )


def _told(faces: AnalyticBrep) -> AnalyticBrep:
    """Log how many facets there are, and at which clusters; return the faces."""
    found = Counter(name for name in faces.face_names if name.startswith(CLUSTER))
    named = "; ".join(list(found)[:NAMED]) + ("; ..." if len(found) > NAMED else "")
    facets, clusters = found.total(), counted(len(found), "cluster")
    if found:
        _log.info("%d plane facets at %s (%s); all else is exact", facets, clusters, named)
    return faces


def _together(outside: _Part, inside: _Part) -> TriangleMesh:
    """Return the triangles near both surfaces of walls."""
    first, second = outside.mesh, inside.mesh
    return TriangleMesh(
        np.concatenate([first.vertices, second.vertices]),
        np.concatenate([first.triangles, second.triangles[:, ::-1] + len(first.vertices)]),
    )


def _part(
    struts: RoundStruts,
    fillets: Floats,
    core: Core,
    sags: Sags | None = None,
    outside: _Part | None = None,
) -> _Part:
    """Return the surface of solid struts, see `faceted`.

    Parameters
    ----------
    outside : the surface outside, for that inside of hollow struts
    """
    made, count = faceted(struts, fillets, core, sags), len(core.nodes)
    if made is not None and outside is not None:
        walls = Walls.between(outside.mesh, made.mesh, made.rings.reshape(-1))
        wall = float(struts.options.wall or 0.0)
        moved = thickened(walls, wall, polygon_wall(SIDES), 1.0)
        inside = moved.vertices[len(outside.mesh.vertices) :]
        made = replace(made, mesh=TriangleMesh(inside, made.mesh.triangles))
    if made is None:
        part, _ = _exact(struts, np.zeros(len(struts.runs.nodes), dtype=np.bool_))
        return replace(part, nodes=core.nodes, pieces=core.zone, fillets=fillets)
    pieces = _pieces(made)
    piece = pieces.piece_of[made.mesh.triangles[:, 0]]
    names = _cluster_names(struts, made, pieces)
    facets = brep_of_triangles(made.mesh, piece, names)
    facets = _saying(facets, np.where(pieces.volumes[piece] < 0, VOID, BODY))
    if made.clusters is None:
        none, nodes, every = np.zeros(0, np.intp), np.ones_like(core.nodes), np.ones_like(core.zone)
        return _Part(
            facets,
            np.full(count, -1),
            0,
            made.mesh,
            none,
            nodes,
            every,
            fillets,
            whole_runs(struts.runs),
        )
    rest = made.clusters.rest
    beside, corners = _exact(rest.struts, rest.open_at)
    exact = _named(beside.faces, struts, made)
    rings = _rings(beside.circles, made, len(exact.names) + piece[_at_rings(made)], facets)
    numbers = np.append(edge_numbers(exact, facets)[0], -1)
    return _Part(
        extended(exact, facets, rings),
        numbers[beside.circles[:count]],
        beside.first_name,
        _near(made, beside.mesh, corners),
        beside.node,
        made.clusters.nodes,
        made.clusters.pieces,
        made.clusters.reached,
        made.clusters.spans,
    )


def _exact(struts: RoundStruts, open_at: Bools) -> tuple[_Part, Ints]:
    """Return the surface of struts that are all exact, and the vertices of rings where they end.

    Parameters
    ----------
    open_at : (n,) nodes where they end without a face

    Returns
    -------
    the surface, and vertices (n, SIDES) of its triangles
    """
    straight = struts.straight
    faces, ends, rings = faces_of(straight, open_at)
    circles = np.full(len(open_at), -1)
    circles[straight.runs.tails[ends]] = rings
    shell = shell_of(struts, SIDES, open_at)
    corners = np.full((len(open_at), SIDES), -1)
    corners[struts.runs.tails[shell.ends]] = shell.rings
    part = _Part(
        _saying(faces, np.full(len(faces.faces.kinds), EITHER)),
        circles,
        len(straight.runs.edges),
        shell.made.mesh,
        shell.made.node,
        np.zeros_like(open_at),
        np.zeros(len(struts.curves.pieces), dtype=np.bool_),
        np.zeros(len(open_at)),
        no_spans(),
    )
    return part, corners


def _near(made: Faceted, mesh: TriangleMesh, corners: Ints) -> TriangleMesh:
    """Return triangles near the whole surface, those of exact struts first.

    Parameters
    ----------
    corners : (n, SIDES) vertices of the ring at each node where an exact strut ends
    """
    assert made.clusters is not None
    count, cuts = len(mesh.vertices), made.clusters.rest.cuts
    between = annuli(corners[cuts.node], made.rings + count)
    return TriangleMesh(
        np.concatenate([mesh.vertices, made.mesh.vertices]),
        np.concatenate([mesh.triangles, between, made.mesh.triangles + count]),
    )


def _saying(faces: AnalyticBrep, what: Ints) -> AnalyticBrep:
    """Return faces (f,) that say something of their shells."""
    return replace(faces, faces=replace(faces.faces, shell=what), solid=np.arange(EITHER + 1))


def _solids(faces: AnalyticBrep) -> AnalyticBrep:
    """Return the solids of faces that say something of their shells."""
    whole = by_edges(faces)
    said = np.full(len(whole.solid), EITHER)
    np.minimum.at(said, whole.faces.shell, faces.faces.shell)
    return with_voids(whole, said == VOID)


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
    found: Ints = triangle[made.rings[:, 0]]
    return found


def _rings(circles: Ints, made: Faceted, name: Ints, facets: AnalyticBrep) -> PlaneRings:
    """Return the plane rings between the circles of struts and the polygons of clusters."""
    assert made.clusters is not None
    rest = made.clusters.rest
    cuts, count = rest.cuts, len(rest.cuts.node)
    side, ahead = edges_between(facets, made.rings, np.roll(made.rings, -1, axis=1))
    none = np.zeros(count, dtype=np.bool_)
    return PlaneRings(
        rest.struts.runs.nodes[cuts.node],
        -cuts.outward,
        rest.struts.x[made.half_runs],
        np.hstack([circles[cuts.node][:, None], side]),
        np.hstack([none[:, None], ahead]),
        none,
        np.full(count, EITHER),
        name,
    )


def _named(exact: AnalyticBrep, struts: RoundStruts, made: Faceted) -> AnalyticBrep:
    """Return the faces of what is left with the names of the struts that it is a part of.

    Short cylinders beside cut curves are on no strut's axis: they have the name of a curve.
    """
    assert made.clusters is not None
    rest = made.clusters.rest
    names = run_names(struts.runs)
    own = [names[run] for run in rest.run[~rest.struts.curves.curved].tolist()]
    short = [f"curve {node}" for node in rest.cut_curves.nodes.tolist()]
    own[len(own) - len(short) :] = short
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
        found.append(f"{CLUSTER} of {what}{'s' * (len(own) != 1)} {', '.join(own[:NAMED])}{more}")
    return found
