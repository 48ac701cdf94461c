"""Round struts some of which are crowded, as one B-rep: facets at clusters, exact faces beside."""

from __future__ import annotations

import logging
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
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
from scaffold_cad.solid.clusters.changed import tell_changed
from scaffold_cad.solid.clusters.core import Core, unproved
from scaffold_cad.solid.clusters.facets import FINENESS, SIDES, Faceted, faceted
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.hollow import hollow, tell_closed
from scaffold_cad.solid.clusters.spans import Spans, no_spans, whole_runs
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.solid.clusters.united import tell_united
from scaffold_cad.solid.clusters.walls import Walls, tell_thin, thickened
from scaffold_cad.struts.breps.faces import bored, end_rings, faces_of, run_names
from scaffold_cad.struts.meshes.bands import polygon_slack, polygon_wall
from scaffold_cad.struts.meshes.surface import Shell, annuli, shell_of
from scaffold_cad.struts.model import RoundStruts

CLUSTER = "cluster"
"""What names of facets begin with."""

NAMED = 5
"""Nodes or struts that the name of a cluster has at most."""

BODY, VOID, EITHER = range(3)
"""What a face says of its shell: that it bounds a body or a void in one, or nothing."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class _Exact(Frozen):
    """Struts that are all exact."""

    faces: AnalyticBrep
    """Their faces; as their shells they have what they say of these."""
    circles: Ints
    """Edge at each node where a strut ends, else -1, shape (n,)."""
    first_name: int
    """Place of the name of node 0."""


@dataclass(frozen=True, eq=False)
class _Part(Frozen):
    """The surface of solid struts."""

    struts: RoundStruts
    """All of them."""
    made: Faceted | None
    """Facets, and what is left beside them; None if all are exact."""
    mesh: TriangleMesh
    """Triangles near the surface, the facets last."""
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
        part = _part(struts, wanted_fillets(struts), unproved(struts))
        tell_united(struts, part.spans, part.fillets, part.mesh)
        tell_changed(struts, part.spans)
        return _told(_solids(_faces(part).faces))
    outside, inside = hollow(struts, unproved, _part, _together)
    tell_closed(struts, outside)
    tell_united(struts, outside.spans, outside.fillets, outside.mesh)
    tell_changed(struts, outside.spans, inside.spans)
    wall = float(struts.options.wall or 0.0)
    outside = _moved_out(outside, inside, wall)
    if inside.made is not None:
        tell_thin(_walls(outside, inside.made), wall, polygon_wall(SIDES))
    outer, inner = _faces(outside), _faces(inside)
    own = inner.faces.faces
    kind = np.where(own.shell == VOID, BODY, VOID)  # what a solid is inside is a void
    void = replace(inner.faces, faces=replace(own, shell=kind))
    runs = struts.runs
    ends = np.flatnonzero(runs.valency[runs.tails] == 1)
    circles = np.stack([outer.circles, inner.circles], axis=1)[runs.tails[ends]]
    is_open = (circles >= 0).all(axis=1) & (struts.options.ends == "open")
    ends, circles = ends[is_open], circles[is_open]
    either = np.full(len(ends), EITHER)
    if len(struts.sockets.nodes):
        void, circles[:, 1] = bored(struts, void, ends, circles[:, 1], either, inner.first_name)
    both = np.full(len(ends), BODY)  # its faces are of the outside and of the inside
    rings = end_rings(struts, ends, circles, both, outer.first_name)
    return _told(_solids(extended(outer.faces, turned(void), rings)))


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
    fineness: Fineness = FINENESS,
    outside: _Part | None = None,
) -> _Part:
    """Return the surface of solid struts, see `faceted`.

    Parameters
    ----------
    outside : the surface outside, for that inside of hollow struts
    """
    made = faceted(struts, fillets, core, fineness)
    if made is None:
        shell = shell_of(struts, SIDES)
        mesh, node = shell.made.mesh, shell.made.node
        return _Part(struts, None, mesh, node, core.nodes, core.zone, fillets, no_spans())
    if outside is not None:
        made = replace(made, mesh=_inside(_walls(outside, made), struts.options.wall or 0.0))
    clusters = made.clusters
    if clusters is None:
        none, nodes, every = np.zeros(0, np.intp), np.ones_like(core.nodes), np.ones_like(core.zone)
        return _Part(struts, made, made.mesh, none, nodes, every, fillets, whole_runs(struts.runs))
    rest = clusters.rest
    shell = shell_of(rest.struts, SIDES, rest.open_at)
    mesh, node = _near(made, shell, len(rest.open_at)), shell.made.node
    reached = clusters.nodes, clusters.pieces, clusters.reached, clusters.spans
    return _Part(struts, made, mesh, node, *reached)


def _walls(outside: _Part, made: Faceted) -> Walls:
    """Return the walls between a surface outside and the facets inside."""
    return Walls.between(outside.mesh, made.mesh, made.rings.reshape(-1))


def _inside(walls: Walls, wall: float) -> TriangleMesh:
    """Return the facets inside, moved to where walls are as asked."""
    moved, first = thickened(walls, wall, polygon_wall(SIDES), 1.0), walls.first
    return TriangleMesh(moved.vertices[first:], walls.mesh.triangles[walls.inner, ::-1] - first)


def _moved_out(outside: _Part, inside: _Part, wall: float) -> _Part:
    """Return the outside with facets moved away from an exact inside, which stays."""
    if outside.made is None:
        return outside
    facets = outside.made.mesh
    first = len(outside.mesh.vertices) - len(facets.vertices)
    both = _together(outside, inside)
    outer, inner = np.split(np.arange(len(both.triangles)), [len(outside.mesh.triangles)])
    exact = inner if inside.made is None else inner[: -len(inside.made.mesh.triangles)]
    every = np.arange(len(both.vertices))
    fixed = first + outside.made.rings.reshape(-1)
    walls = Walls(both, exact, outer[-len(facets.triangles) :], len(every), every, fixed)
    mesh = thickened(walls, wall, polygon_wall(SIDES), 1.0)
    slack = polygon_slack(SIDES) * float(inside.struts.runs.radii.max())
    tell_thin(replace(walls, mesh=mesh), wall, polygon_wall(SIDES), slack)
    moved = mesh.vertices[: len(outside.mesh.vertices)]
    made = replace(outside.made, mesh=TriangleMesh(moved[first:], facets.triangles))
    return replace(outside, made=made, mesh=TriangleMesh(moved, outside.mesh.triangles))


def _faces(part: _Part) -> _Exact:
    """Return the faces of a surface: exact ones and facets."""
    made, struts, count = part.made, part.struts, len(part.nodes)
    if made is None:
        return _exact(struts, np.zeros(len(struts.runs.nodes), dtype=np.bool_))
    pieces = _pieces(made)
    piece = pieces.piece_of[made.mesh.triangles[:, 0]]
    facets = brep_of_triangles(made.mesh, piece, _cluster_names(struts, made, pieces))
    facets = _saying(facets, np.where(pieces.volumes[piece] < 0, VOID, BODY))
    if made.clusters is None:
        return _Exact(facets, np.full(count, -1), 0)
    rest = made.clusters.rest
    beside = _exact(rest.struts, rest.open_at)
    exact = _named(beside.faces, struts, made)
    rings = _rings(beside.circles, made, len(exact.names) + piece[_at_rings(made)], facets)
    numbers = np.append(edge_numbers(exact, facets)[0], -1)
    circles = numbers[beside.circles[:count]]
    return _Exact(extended(exact, facets, rings), circles, beside.first_name)


def _exact(struts: RoundStruts, open_at: Bools) -> _Exact:
    """Return the faces of struts that are all exact.

    Parameters
    ----------
    open_at : (n,) nodes where they end without a face
    """
    straight = struts.straight
    faces, ends, rings = faces_of(straight, open_at)
    circles = np.full(len(open_at), -1)
    circles[straight.runs.tails[ends]] = rings
    faces = _saying(faces, np.full(len(faces.faces.kinds), EITHER))
    return _Exact(faces, circles, len(straight.runs.edges))


def _near(made: Faceted, shell: Shell, count: int) -> TriangleMesh:
    """Return triangles near the whole surface, those of exact struts first, facets last.

    Parameters
    ----------
    shell : of exact struts, with rings of `SIDES` at some of their `count` nodes
    """
    assert made.clusters is not None
    mesh, rest = shell.made.mesh, made.clusters.rest
    corners = np.full((count, SIDES), -1)
    corners[rest.struts.runs.tails[shell.ends]] = shell.rings
    between = annuli(corners[rest.cuts.node], made.rings + len(mesh.vertices))
    return TriangleMesh(
        np.concatenate([mesh.vertices, made.mesh.vertices]),
        np.concatenate([mesh.triangles, between, made.mesh.triangles + len(mesh.vertices)]),
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
        cuts.outward if made.around else -cuts.outward,
        rest.struts.x[made.half_runs],
        np.hstack([circles[cuts.node][:, None], side]),
        np.hstack([none[:, None], ahead]),
        np.full(count, made.around),
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
