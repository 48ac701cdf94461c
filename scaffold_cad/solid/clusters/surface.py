"""The surface of round struts: their exact surface where it is proved, fields where it is not.

Fields are the fallback for clusters of struts that overlap or whose nodes are not proved.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import length
from scaffold_cad.mesh.pieces import without_voids
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.solid.clusters.changed import tell_changed
from scaffold_cad.solid.clusters.core import Core, unmade
from scaffold_cad.solid.clusters.ends import with_flat_ends
from scaffold_cad.solid.clusters.fewest import fewest_sides
from scaffold_cad.solid.clusters.fields import cluster_struts, whole_struts
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.growth import Clusters, bodies_of, clusters_of, most_field
from scaffold_cad.solid.clusters.hollow import hollow, tell_closed
from scaffold_cad.solid.clusters.remade import Remade
from scaffold_cad.solid.clusters.seams import seamed
from scaffold_cad.solid.clusters.spans import Spans, whole_runs
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.solid.clusters.united import tell_united
from scaffold_cad.solid.clusters.walls import Walls, tell_thin, thickened
from scaffold_cad.solid.field import FieldStruts
from scaffold_cad.solid.field.written import field_as_written, report_thickened
from scaffold_cad.struts.apart import Slack
from scaffold_cad.struts.curves.rings import rings_hold
from scaffold_cad.struts.meshes.bands import polygon_slack, polygon_wall
from scaffold_cad.struts.meshes.surface import Shell, Triangulated, first_alike, open_ends, shell_of
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.runs import ball_ends

MARGIN = 1e-9
"""Least sine of the angle at which the triangles of a node are seen from it."""

TRIES = 8
"""Times that clusters grow where a seam fails, before all becomes one field."""

STEP = 0.4
"""By how much a span grows whose seam failed, in radii: the next window has other vertices."""

ON_BALL = 0.1
"""How far from a ball's surface its vertices are at most, in radii."""

TRIANGLE_BYTES = 256
"""What a triangle takes where it is looked at."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class _Surface:
    """One closed surface, but for rings at open ends."""

    mesh: TriangleMesh
    ends: Ints
    """Nodes where struts end in rings, ascending, shape (e,)."""
    rings: Ints
    """Vertices of these, shape (e, sides)."""
    nodes: Bools
    """Nodes that are in fields, shape (n,)."""
    pieces: Bools
    """Pieces of curves that are in fields, shape (p,)."""
    fillets: Floats
    """Fillet radius of each node, mm, shape (n,)."""
    node: Ints
    """Nodes that the first triangles are around, shape (t',)."""
    spans: Spans
    """Stretches of runs that are in fields."""
    exact: int
    """Number of the vertices that come first, of struts that are not fields."""
    left: RoundStruts | None
    """These struts."""

    @property
    def alone(self) -> Ints:
        """Vertices of struts by themselves, which have the volume of exact faces, (k,)."""
        moves = np.zeros(len(self.mesh.vertices), dtype=np.bool_)
        moves[self.mesh.triangles[: len(self.node)]] = True
        return np.flatnonzero(~moves[: self.exact])

    def alike(self, sides: int) -> Ints:
        """Return the vertex of a node of the same shape for each vertex, (v,)."""
        found = np.arange(len(self.mesh.vertices))
        if self.left is not None:
            first = first_alike(self.left, sides)
            found[: len(first)] = first
        return found


def surface_of(struts: RoundStruts, sides: int, factor: float = 1.0) -> TriangleMesh:
    """Return the surface of round struts, closed and without crossings in 32-bit coordinates.

    Struts that pass each other closely may have more sides, see `fewest_sides`.
    What is crowded is made as fields, and everything where the struts of these have most of the
    area, see `most_field`. The inside of hollow struts is a surface like that outside; open ends
    that come to lie in a field are closed.

    Parameters
    ----------
    factor : what lengths are multiplied with in a file, in whose 32-bit numbers triangles are
        looked at
    """
    fine, sides = Fineness(sides), fewest_sides(struts, sides)
    if struts.inner is None:
        fillets, core = wanted_fillets(struts), unmade(struts, sides)
        made = _surface(struts, sides, fillets, core, factor, fine)
        tell_united(struts, made.spans, made.fillets, made.mesh)
        tell_changed(struts, made.spans)
        return made.mesh

    def unmade_of(own: RoundStruts) -> Core:
        return unmade(own, sides)

    def make(
        own: RoundStruts, fillets: Floats, core: Core, fineness: Fineness, _: _Surface | None = None
    ) -> _Surface:
        return _surface(own, sides, fillets, core, factor, replace(fineness, sides=fine.sides))

    def joined(outside: _Surface, inside: _Surface) -> TriangleMesh:
        return _walls(struts, outside, inside)

    outside, inside = hollow(struts, unmade_of, make, joined, factor)
    tell_closed(struts, outside)
    tell_united(struts, outside.spans, outside.fillets, outside.mesh)
    tell_changed(struts, outside.spans, inside.spans)
    mesh, wall = joined(outside, inside), float(struts.options.wall or 0.0)
    count, first = len(outside.mesh.triangles), len(outside.mesh.vertices)
    outer, inner = np.split(np.arange(count + len(inside.mesh.triangles)), [count])
    alike = np.arange(len(mesh.vertices))
    alike[first : first + len(inside.mesh.vertices)] = first + inside.alike(sides)
    at_ends = np.unique(mesh.triangles[len(outer) + len(inner) :])
    alone = inside.alone
    alone = alone[~_on_balls(struts, inside.mesh.vertices[alone])]
    fixed = np.concatenate([at_ends, first + alone])
    walls, part = Walls(mesh, outer, inner, first + inside.exact, alike, fixed), polygon_wall(sides)
    mesh = thickened(walls, wall, part, factor)
    of_struts = np.concatenate([at_ends, np.arange(outside.exact)])
    mesh = thickened(walls.turned(mesh, of_struts), wall, part, factor)
    tell_thin(replace(walls, mesh=mesh), wall, part)
    return mesh


def _on_balls(struts: RoundStruts, points: Points) -> Bools:
    """Return which of some points inside, (k,), are on balls at ends.

    Where the rings of their necks differ, so do the latitudes of their triangles.
    """
    rows = np.flatnonzero(ball_ends(struts.skeleton, struts.runs))
    if len(rows) == 0:
        return np.zeros(len(points), dtype=np.bool_)
    sizes = struts.skeleton.radii[rows] - float(struts.options.wall or 0.0)
    far, ball = cKDTree(struts.runs.nodes[rows]).query(points)
    return np.asarray(np.abs(far - sizes[ball]) < ON_BALL * sizes[ball])


def _walls(struts: RoundStruts, outside: _Surface, inside: _Surface) -> TriangleMesh:
    """Return what is between two surfaces."""
    count = len(outside.mesh.vertices)
    faces = [outside.mesh.triangles, inside.mesh.triangles[:, ::-1] + count]
    points = [outside.mesh.vertices, inside.mesh.vertices]
    if struts.options.ends == "open":
        runs = struts.runs
        half_runs = runs.incidence.at_nodes(outside.ends, 1)[:, 0]
        rings = outside.rings, inside.rings + count
        more, closing, _ = open_ends(struts, half_runs, *rings, points)
        points.append(more)
        faces.append(closing)
    return TriangleMesh(np.concatenate(points), np.concatenate(faces))


def _surface(
    struts: RoundStruts,
    sides: int,
    fillets: Floats,
    core: Core,
    factor: float,
    fineness: Fineness,
) -> _Surface:
    """Return the surface of solid struts with what is in `core` in clusters.

    Parameters
    ----------
    fillets : (n,) fillet radius wanted at each node, mm
    fineness : of fields
    """
    count = len(core.nodes)
    slack = Slack(polygon_slack(sides), np.zeros(count))
    seeds, bodies = core.spans, cache(partial(bodies_of, struts))
    remade = Remade(lambda some: field_of(some, sides, fineness, factor))
    for _ in range(TRIES):
        clusters = clusters_of(struts, bodies, fillets, slack, core, seeds, most_field(struts))
        if clusters is None:
            break
        core, seeds, rest = clusters.core, clusters.seeds, clusters.rest
        fields = cluster_struts(struts, clusters) if len(clusters.spans) else None
        left = struts if fields is None else rest.struts
        shell = shell_of(left, sides, None if fields is None else rest.open_at)
        swell = shell.made.swell[:count]
        hidden = unseen(left, shell.made, factor)[:count]
        if hidden.any() or (swell > slack.nodes).any():
            core = core.with_nodes(hidden)
            slack = replace(slack, nodes=np.maximum(slack.nodes, swell))
            continue
        ends = left.runs.tails[shell.ends]
        mesh, failed = shell.made.mesh, np.zeros(0, dtype=np.intp)
        voids: list[float] = []
        if fields is not None:
            field, voids = without_voids(remade.surface(fields), fields.middles)
            mesh, failed = _joined(clusters, shell, field, factor)
        if len(failed) == 0:
            own = ends < count
            if fields is not None:
                report_thickened(fields, factor)
            report_filled(voids)
            return _Surface(
                mesh=mesh,
                ends=ends[own],
                rings=shell.rings[own],
                nodes=clusters.nodes,
                pieces=clusters.pieces,
                fillets=clusters.reached,
                node=shell.made.node,
                spans=clusters.spans,
                exact=len(shell.made.mesh.vertices),
                left=left,
            )
        _log.debug("%d of %d seams failed", len(failed), len(rest.cuts.node))
        core, seeds = grown(struts, clusters, failed)
    return _whole_field(struts, sides, fillets, core, fineness, factor)


def _whole_field(
    struts: RoundStruts, sides: int, fillets: Floats, core: Core, fineness: Fineness, factor: float
) -> _Surface:
    """Return the surface of solid struts as one field, see `_surface`."""
    _log.info(
        "%s too little room for rings of their own: made as a field",
        counted(len(struts.skeleton.edges), "strut has", "struts have"),
    )
    fields = whole_struts(struts)
    report_thickened(fields, factor)
    mesh, voids = without_voids(field_of(fields, sides, fineness, factor), fields.middles)
    report_filled(voids)
    none = np.zeros((0, sides), dtype=np.intp)
    return _Surface(
        mesh=mesh,
        ends=none[:, 0],
        rings=none,
        nodes=np.ones_like(core.nodes),
        pieces=np.ones_like(core.pieces),
        fillets=fillets,
        node=none[:, 0],
        spans=whole_runs(struts.runs),
        exact=0,
        left=None,
    )


def field_of(
    fields: FieldStruts, sides: int, fineness: Fineness, factor: float = 1.0
) -> TriangleMesh:
    """Return the surface of fields, whose coordinates are 32-bit numbers in the unit of a file.

    Parameters
    ----------
    sides : of the polygons at flat ends
    """
    mesh = field_as_written(fields, factor, fineness.sides, fineness.sags(fields))
    return with_flat_ends(mesh, fields, sides, factor)


def report_filled(voids: list[float]) -> None:
    """Log the volumes, mm³, of voids that overlapping struts enclosed, if there are any."""
    if voids:
        _log.info(
            "voids between overlapping struts are filled: %d of %.3g mm³", len(voids), sum(voids)
        )


def _joined(
    clusters: Clusters, shell: Shell, field: TriangleMesh, factor: float
) -> tuple[TriangleMesh, Ints]:
    """Return a shell joined to the field of clusters, and the cuts where this fails.

    The vertices of the shell come first.
    """
    rest = clusters.rest
    runs = rest.struts.runs
    of_node = np.empty(len(runs.nodes), dtype=np.intp)
    of_node[runs.tails[shell.ends]] = np.arange(len(shell.ends))
    row = of_node[rest.cuts.node]
    points = shell.made.mesh.vertices
    starts = rest.struts.x[shell.ends[row]]
    made = seamed(field, rest.cuts, points, shell.rings[row], starts, factor)
    triangles = np.concatenate([shell.made.mesh.triangles, made.triangles])
    return compacted(np.concatenate([points, made.vertices]), triangles), made.failed


def grown(struts: RoundStruts, clusters: Clusters, failed: Ints) -> tuple[Core, Spans]:
    """Return what clusters are to hold so that they grow where seams at cuts have failed."""
    cut = clusters.rest.cut_curves
    straight = len(clusters.rest.cuts.node) - len(cut.nodes)
    at_joints = np.zeros_like(clusters.nodes)
    at_joints[cut.nodes[failed[failed >= straight] - straight]] = True
    more = _further(struts, clusters, failed[failed < straight])
    return clusters.core.with_nodes(at_joints), Spans.joined([clusters.seeds, more])


def _further(struts: RoundStruts, clusters: Clusters, failed: Ints) -> Spans:
    """Return the stretches by which spans grow whose seams failed."""
    cuts, runs = clusters.rest.cuts, struts.runs
    run = clusters.spans.run[cuts.span[failed]]
    tail, ahead = runs.nodes[runs.edges[run, 0]], runs.directions[2 * run]
    step = (STEP * cuts.radius[failed])[:, None] * cuts.outward[failed]
    ends = (cuts.base[failed], cuts.base[failed] + step)
    places = [((end - tail) * ahead).sum(axis=1) for end in ends]
    return Spans(run, np.minimum(*places), np.maximum(*places))


def unseen(struts: RoundStruts, made: Triangulated, factor: float = 1.0) -> Bools:
    """Return the nodes with triangles that do not face away from them in 32 bits, (n,)."""
    written = in_single_precision(made.mesh.vertices, factor)
    triangles = made.mesh.triangles[: len(made.node)]
    node = np.zeros(len(written), dtype=np.intp)  # that each vertex stands around
    node[triangles] = made.node[:, None]
    spokes = written - factor * struts.runs.nodes[node]
    leading, size = np.ascontiguousarray(spokes.T), length(spokes)
    found = np.zeros(len(struts.runs.nodes), dtype=np.bool_)
    for part in blocks(len(triangles), TRIANGLE_BYTES, CACHE):
        a, b, c = np.ascontiguousarray(triangles[part].T)
        least = MARGIN * size[a] * size[b] * size[c]
        seen = _volumes(*(leading[:, corner] for corner in (a, b, c))) > least
        found[made.node[part][~seen]] = True
    folded = struts.curves.pieces[made.curve_rings.piece[~_in_order(made, written)]]
    joints = struts.curves.nodes[np.append(folded, folded + 1)]
    found[joints[joints >= 0]] = True
    return found


def _volumes(a: Floats, b: Floats, c: Floats) -> Floats:
    """Return det(a, b, c) of vectors (3, t) whose coordinates come first, (t,)."""
    volumes: Floats = a[0] * (b[1] * c[2] - b[2] * c[1])
    volumes += a[1] * (b[2] * c[0] - b[0] * c[2])
    volumes += a[2] * (b[0] * c[1] - b[1] * c[0])
    return volumes


def _in_order(made: Triangulated, written: Points) -> Bools:
    """Return whether the rings of curves follow each other in 32-bit coordinates, (l,)."""
    rings = made.curve_rings
    if len(rings.low) == 0:
        return np.ones(0, dtype=np.bool_)
    start = len(made.node)
    return rings_hold(written, rings, made.mesh.triangles[start : start + 2 * rings.low.size])
