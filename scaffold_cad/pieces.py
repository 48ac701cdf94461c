"""What a solid is put together from where a scaffold is not embedded.

The struts and nodes that keep to their own room stay one closed surface; each strut left out
becomes a prism along its axis, each branch point left out its own closed sphere of quads, and each
joint at a strut left out the convex hull of the sections that meet there. All are closed, and all
but the first two are convex. Arrays only: the union is made elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.arrays import Bools, Floats, Ints, Points, Triangles
from scaffold_cad.embedding import Embedding, stub_apexes
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.sleeves import fitted_angle
from scaffold_cad.trianglemesh import TriangleMesh
from scaffold_cad.vectors import any_perpendicular, rotate

PLASTIC = 1.32471795724474602596
"""The plastic number, the root of x³ = x + 1."""

HUB_WIDTH = 1.002
"""Width of the hull at a joint, in widths of the sections that meet there: their corners must
not lie in the planes of its faces."""

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


def solid_pieces(scaffold: Scaffold, embedded: Embedding, wobble: float = 0.0) -> Pieces:
    """Return the pieces of the solid of `scaffold`, given which struts are embedded.

    Parameters
    ----------
    wobble : how much the prisms of struts left out are made unlike each other, as a fraction of
        their radius: faces that lie in one plane, or edges in one line, are hard to unite
    """
    count = len(scaffold.skeleton.edges)
    prisms = _Prisms(scaffold, wobble * _spread(count, 1), wobble * _spread(count, 2))
    return Pieces(
        _kept_surface(scaffold, embedded),
        [_sphere(scaffold, node) for node in np.flatnonzero(~embedded.kept_nodes).tolist()],
        [*prisms.struts(embedded.left_out), *prisms.hubs(embedded.kept)],
    )


def _spread(count: int, axis: int) -> Floats:
    """Return evenly spread numbers in [-1/2, 1/2), unlike for neighbours, (count,).

    Multiples of the powers of the plastic number's inverse: Roberts's additive recurrence.
    """
    return np.remainder(np.arange(1, count + 1) * PLASTIC**-axis, 1.0) - 0.5


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


def _sphere(scaffold: Scaffold, node: int) -> TriangleMesh:
    """Return the closed surface of the quads around a branch point."""
    skeleton = scaffold.skeleton
    half_edges = skeleton.incidence.at_nodes(np.array([node]), int(skeleton.valency[node]))[0]
    vertices = np.concatenate([scaffold.mesh.vertices, stub_apexes(scaffold, half_edges)])
    rings = scaffold.stars.corners[half_edges]
    return compacted(vertices, _fans(rings, len(scaffold.mesh.vertices)))


@dataclass(frozen=True, eq=False)
class _Prisms:
    """Struts left out as straight prisms from node to node."""

    scaffold: Scaffold
    widening: Floats
    """Relative change of each edge's width, shape (m,)."""
    turn: Floats
    """Angle by which each edge's section is turned, rad, shape (m,)."""

    def struts(self, edges: Ints) -> list[Points]:
        """Return the corners of the prism of each of `edges`."""
        nodes = self.scaffold.skeleton.nodes[self.scaffold.skeleton.edges[edges]]
        return list((self._sections(edges) + nodes[:, :, None]).reshape(-1, 8, 3))

    def hubs(self, kept: Bools) -> list[Points]:
        """Return the sections that meet at each joint with a strut left out, on both its sides.

        Their hull fills the wedge between two prisms, and reaches into a sleeve that is kept.
        """
        skeleton = self.scaffold.skeleton
        half_edges = skeleton.incidence.at_nodes(skeleton.joints, 2)  # (k, 2)
        half_edges = half_edges[~kept[half_edges >> 1].all(axis=1)]
        flat = half_edges.reshape(-1)
        node = skeleton.edges.reshape(-1)[flat]
        section = HUB_WIDTH * self._sections(flat >> 1)[np.arange(len(flat)), flat & 1]
        reach = np.minimum(HUB_LENGTH * skeleton.radii[node], skeleton.lengths[flat >> 1] / 2)
        along = (reach[:, None] * skeleton.directions[flat])[:, None, :]
        points = np.concatenate([section, section + along], axis=1)  # (2 k, 8, 3)
        return list((points + skeleton.nodes[node][:, None, :]).reshape(-1, 16, 3))

    def _sections(self, edges: Ints) -> Points:
        """Return the sections across `edges` at both nodes, seen from the node, (k, 2, 4, 3)."""
        scaffold, skeleton = self.scaffold, self.scaffold.skeleton
        axis = skeleton.directions[2 * edges]
        first_sleeve = np.searchsorted(scaffold.refinement.edge_of_edge, edges)
        start = skeleton.nodes[skeleton.edges[edges, 0]]
        ring = scaffold.mesh.vertices[scaffold.sleeves[first_sleeve, 0]] - start[:, None, :]
        across = any_perpendicular(axis)
        x = rotate(across, axis, fitted_angle(ring, across, axis) + self.turn[edges])
        y = np.cross(axis, x)
        unit = np.stack([x, y, -x, -y], axis=1)[:, None]  # (k, 1, 4, 3)
        radii = skeleton.radii[skeleton.edges[edges]] * (1.0 + self.widening[edges, None])
        distance = scaffold.options.corner_distance * radii  # (k, 2)
        return unit * distance[:, :, None, None]


def compacted(vertices: Points, triangles: Triangles) -> TriangleMesh:
    """Return the triangles with only the vertices that they use."""
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[triangles] = True
    rank = np.cumsum(used) - 1
    return TriangleMesh(vertices[used], rank[triangles])
