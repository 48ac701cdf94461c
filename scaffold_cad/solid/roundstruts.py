"""Struts with 8 or 16 sides, smooth at their nodes: what their solid is put together from.

The Catmull-Clark surface of a scaffold is the solid as long as it does not cross itself, which is
tested on its triangles. The struts that cross others are taken out of the skeleton, which gets a
surface of its own, and become convex prisms with balls at their ends. Arrays only: the union is
made elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.intersections import intersections_of_bodies
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold, ScaffoldOptions, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import Subdivision, smooth_mesh
from scaffold_cad.solid.pieces import spread

LEVELS = {8: 1, 16: 2}
"""Subdivisions that give a section its number of sides."""

ROUND_SIDES = 16
"""Sides of round struts in a mesh: as many as `solidified` makes."""

GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
"""Turn between neighbouring struts, and balls, that keeps their faces out of common planes, rad."""


@dataclass(frozen=True, eq=False)
class RoundSurface:
    """The smooth surface of the struts that keep to their own room."""

    mesh: QuadMesh | None
    """The surface, closed and without crossings; None if no strut is left."""
    left_out: Ints
    """Edges whose struts are not in it, ascending."""


def circumradius(sides: int) -> float:
    """Return how far out the corners of a polygon are that has the area of a circle of radius 1."""
    return float(np.sqrt(2 * np.pi / (sides * np.sin(2 * np.pi / sides))))


def check_sides(sides: int) -> None:
    """Raise unless struts can have so many sides.

    Raises
    ------
    OptionError
        If it is not 4, 8 or 16.
    """
    if sides not in (4, *LEVELS):
        raise OptionError(f"struts have {sides} sides; need 4, 8 or 16")


def round_surface(scaffold: Scaffold, sides: int) -> RoundSurface:
    """Return the smooth surface around the skeleton of `scaffold`, without the struts that cross.

    In the middle of a strut the section has the area of the circle of its radius.
    """
    skeleton = scaffold.skeleton.with_radii(scaffold.skeleton.radii * circumradius(sides))
    kept = np.arange(len(skeleton.edges))
    while len(kept):
        part = skeleton.with_edges(kept)
        smooth = _scaffold(part, scaffold.options)
        surface = smooth_mesh(smooth, LEVELS[sides])
        crossing = intersections_of_bodies(surface.mesh, *_bodies(smooth, surface))
        if len(crossing) == 0:
            return RoundSurface(surface.mesh, np.setdiff1d(np.arange(len(skeleton.edges)), kept))
        # Two triangles a quad.
        kept = np.delete(kept, smooth.edge_of_quad[surface.quad_of_quad[crossing >> 1]])
    return RoundSurface(None, np.arange(len(skeleton.edges)))


def _bodies(scaffold: Scaffold, surface: Subdivision) -> tuple[Ints, Points]:
    """Return the body of each quad of the surface, (f,), and a point in each body, (b, 3), mm.

    Body i < n is what lies between branch point i and its collars, body n + j is strut j.
    """
    skeleton, refined = scaffold.skeleton, scaffold.refined
    nodes = len(skeleton.nodes)
    tail, head = refined.edges.T
    body_of_sleeve = nodes + scaffold.refinement.edge_of_edge
    for node, other in ((tail, head), (head, tail)):
        blend = (refined.valency[node] >= 3) & (other >= nodes)
        body_of_sleeve[blend] = node[blend]
    body_of_quad = nodes + scaffold.edge_of_quad  # that of its strut for the end of a strut
    body_of_quad[: 4 * len(tail)] = np.repeat(body_of_sleeve, 4)
    body = body_of_quad[surface.quad_of_quad]

    centres = np.concatenate([skeleton.nodes, np.zeros_like(skeleton.directions[::2])])
    count = np.maximum(np.bincount(body, minlength=len(centres)), 1)
    middles = surface.mesh.vertices[surface.mesh.quads].mean(axis=1)
    for axis in range(3):
        mean = np.bincount(body, middles[:, axis], minlength=len(centres)) / count
        centres[nodes:, axis] = mean[nodes:]
    return body, centres


def prisms_and_balls(scaffold: Scaffold, edges: Ints, sides: int, wobble: Floats) -> list[Points]:
    """Return the corners of a prism along each of `edges` and of a ball at each of their ends.

    Parameters
    ----------
    wobble : (n,) float64; how much they are made unlike each other at each node, see `pieces`
    """
    skeleton = scaffold.skeleton
    radii = skeleton.radii * circumradius(sides)
    ends = skeleton.edges[edges]
    axis = skeleton.directions[2 * edges]
    turning, widening = (wobble[ends] * spread(len(edges), power)[:, None] for power in (1, 2))
    turn = GOLDEN_ANGLE * np.arange(len(edges)) + 2 * np.pi / sides * turning.sum(axis=1)
    turn = turn[:, None] + 2 * np.pi / sides * np.arange(sides)
    x = any_perpendicular(axis)
    y = np.cross(axis, x)
    ring = np.cos(turn)[:, :, None] * x[:, None] + np.sin(turn)[:, :, None] * y[:, None]
    widths = radii[ends] * (1.0 + widening)
    sections = widths[:, :, None, None] * ring[:, None]  # (k, 2, sides, 3)
    prisms = (skeleton.nodes[ends][:, :, None] + sections).reshape(-1, 2 * sides, 3)

    # Where struts are kept, their smooth surface is around the node, and a ball would graze it.
    kept = np.bincount(np.delete(skeleton.edges, edges, axis=0).reshape(-1), minlength=len(radii))
    nodes = np.unique(ends[kept[ends] == 0])
    turn = GOLDEN_ANGLE * np.arange(len(nodes))
    widths = radii[nodes] * (1.0 + wobble[nodes] * spread(len(nodes), 2))
    balls = widths[:, None, None] * _turned_balls(turn, sides) + skeleton.nodes[nodes, None]
    return [*prisms, *balls]


def _turned_balls(turn: Floats, sides: int) -> Points:
    """Return points of the unit sphere turned about z by each of `turn` (k,), (k, p, 3)."""
    count = sides**2 // 2
    height = 1 - (2 * np.arange(count) + 1) / count
    angle = GOLDEN_ANGLE * np.arange(count) + turn[:, None]  # (k, p)
    across = np.sqrt(1 - height**2)
    return np.stack(
        [across * np.cos(angle), across * np.sin(angle), np.broadcast_to(height, angle.shape)],
        axis=2,
    )


def _scaffold(skeleton: Skeleton, options: ScaffoldOptions) -> Scaffold:
    return build_scaffold(
        skeleton,
        fit=options.fit,
        section=options.section,
        collars=options.collars,
        method=options.method,
    )
