"""Sections of round struts: cones, balls and the bodies of blended nodes, a few layers at a time.

Each is closed by itself and reaches a little into the next; `uniting` joins their sections. Nodes
that are crowded have no surface of their own: there the struts go on to the node, with a ball of
the thickest one around it, and what is between them comes from `fillets`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.blocks import cut
from scaffold_cad.layers.fillets import FilletSections
from scaffold_cad.layers.loops import Loops, MeshSections
from scaffold_cad.layers.nodes import NODES_AT_ONCE, EqualNodeSections, NodeSections
from scaffold_cad.layers.rounds import Balls, Cones, swell
from scaffold_cad.layers.sweep import Sweep, count_at
from scaffold_cad.layers.uniting import Solid
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.parts import Parts, parts_of
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.bodies import NodeBodies, beside_crowded, curve_bodies, sharp_bodies
from scaffold_cad.struts.meshes.ends import end_spheres

OVERLAP = 1e-3
"""How far struts reach into the bodies of their nodes, in their radii: where sections only touched
a gap would be left."""

OPENING = 0.1
"""How far the inside of hollow struts reaches beyond an open end, in its radii."""


@dataclass(frozen=True, eq=False)
class Own(Frozen):
    """The runs and nodes whose sections are wanted."""

    runs: Bools
    """Shape (k,)."""
    nodes: Bools
    """Shape (n,)."""


def struts_solid(struts: RoundStruts, sides: int) -> Solid:
    """Return round struts, solid or hollow, to be cut.

    Parameters
    ----------
    sides : of the polygons that stand for circles, a multiple of 4
    """
    return Solid(*sections_of(struts, sides))


def sections_of(
    struts: RoundStruts, sides: int, own: Own | None = None
) -> tuple[StrutSections, StrutSections | None]:
    """Return the sections of round struts, and of what is taken out of hollow ones.

    Parameters
    ----------
    sides : of the polygons that stand for circles, a multiple of 4
    own : the runs and nodes that are wanted; by default all
    """
    outside, inside = parts_of(struts, sides)
    solid = StrutSections(outside, sides, own=own)
    return solid, None if inside is None else StrutSections(inside, sides, is_inside=True, own=own)


class StrutSections:
    """The sections of solid round struts, from the lowest up."""

    def __init__(
        self,
        parts: Parts,
        sides: int,
        *,
        is_inside: bool = False,
        own: Own | None = None,
    ) -> None:
        """Take struts.

        Parameters
        ----------
        sides : of the polygons that stand for circles, a multiple of 4
        is_inside : whether they are what is taken out of hollow struts
        own : the runs and nodes that are wanted; by default all
        """
        self._sides = sides
        struts = replace(parts.struts, crowded=parts.nodes)
        nodes = ~struts.crowded if own is None else own.nodes & ~struts.crowded
        self._cones, self._balls = cones_of(struts, is_inside, own), balls_of(struts, own)
        self._cone_sweep = Sweep(*self._cones.extents())
        self._ball_sweep = Sweep(*self._balls.extents())
        self._bodies = NodeBodies(struts, sides, nodes)
        alone = np.flatnonzero(self._bodies.kinds < 0)
        self._nodes: list[NodeSections | EqualNodeSections] = [NodeSections(self._bodies, alone)]
        for kind in range(self._bodies.kinds.max(initial=-1) + 1):
            equal = np.flatnonzero(self._bodies.kinds == kind)
            places = self._bodies.nodes[equal]
            first = self._bodies.mesh(equal[:1])
            at_zero = TriangleMesh(first.vertices - places[0], first.triangles)
            self._nodes.append(EqualNodeSections(at_zero, places))
        every = np.ones_like(struts.crowded) if own is None else own.nodes
        bodies = [curve_bodies(struts, sides, every), sharp_bodies(struts, sides, nodes)]
        self._meshes = [MeshSections(body) for body in bodies if len(body.triangles)]
        self._fillets: FilletSections | None = None
        if parts.fields is not None:
            runs = None if own is None else own.runs
            self._fillets = FilletSections(parts.fields, parts.run, runs)

    def count(self, heights: Floats) -> Ints:
        """Return how many parts there are at each height, about, shape (h,)."""
        parts = [self._cones.extents(), self._balls.extents()]
        parts.append((self._bodies.low[:, 2], self._bodies.high[:, 2]))
        low, high = (np.concatenate(column) for column in zip(*parts, strict=True))
        count = count_at(heights, low, high)
        for others in (*self._meshes, self._fillets):
            if others is not None:
                count = count + others.count(heights)
        return count

    @property
    def box(self) -> Floats:
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
        low, high = self._straight_box()
        for others in (*self._meshes, self._fillets):
            if others is not None:
                low[:2] = np.minimum(low[:2], others.box[0])
                high[:2] = np.maximum(high[:2], others.box[1])
        low = np.minimum(low, self._bodies.low.min(axis=0, initial=np.inf))
        high = np.maximum(high, self._bodies.high.max(axis=0, initial=-np.inf))
        # Polygons reach beyond the circles that they stand for.
        widest = max(self._cones.radii.max(initial=0.0), self._balls.radii.max(initial=0.0))
        margin = widest * (float(swell(np.array(2 * np.pi / self._sides))) - 1)
        return np.stack([low - margin, high + margin])[:, :2]

    def _straight_box(self) -> Floats:
        """Return the lowest and the highest corner of the box around struts and balls, (2, 3)."""
        parts = [self._cones.boxes(), self._balls.boxes()]
        low, high = (np.concatenate(column) for column in zip(*parts, strict=True))
        return np.stack([low.min(axis=0, initial=np.inf), high.max(axis=0, initial=-np.inf)])

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest point, mm."""
        low, high = (float(corner[2]) for corner in self._straight_box())
        for mesh in self._meshes:
            low, high = min(low, mesh.bounds[0]), max(high, mesh.bounds[1])
        # What is known of the bodies is only a box around each.
        for bodies in (self._bodies.low[:, 2] < low, self._bodies.high[:, 2] > high):
            for some in cut(np.flatnonzero(bodies), row=1, within=NODES_AT_ONCE):
                z = self._bodies.mesh(some).vertices[:, 2]
                low, high = min(low, float(z.min())), max(high, float(z.max()))
        return low, high

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections of all parts at ascending heights (h,), above those before."""
        between = float(heights[0]), float(heights[-1])
        found = [
            self._cones[self._cone_sweep.between(*between)].loops(heights, self._sides),
            self._balls[self._ball_sweep.between(*between)].loops(heights, self._sides),
        ]
        for made in (*self._nodes, *self._meshes, self._fillets):
            if made is not None:
                found += made.loops(heights)
        return found


def cones_of(struts: RoundStruts, is_inside: bool, wanted: Own | None = None) -> Cones:
    """Return the straight struts, from a little before their collars, and the bores of sockets."""
    runs, bores = struts.runs, struts.options.sockets or {}
    half_runs = np.arange(len(runs.tails))
    is_end = runs.valency[runs.tails] == 1
    own = ~struts.crowded[runs.tails] & ~is_end
    radius = runs.radii.reshape(-1)
    is_open = is_end & ~struts.at_balls & is_inside & (struts.options.ends == "open")
    opening = np.where(is_open, OPENING * radius, 0.0)
    begin = np.where(is_end & ~np.isin(runs.tails, list(bores)), -opening, 0.0)
    begin = np.where(own, struts.collar - OVERLAP * radius, begin)
    ends = runs.nodes[runs.tails] + begin[:, None] * runs.directions
    radii = runs.radii_at(half_runs, begin).reshape(-1, 2)
    crowded = struts.crowded_runs | struts.crowded[runs.edges].any(axis=1)
    straight = ~struts.curves.curved | crowded
    if wanted is not None:
        straight = straight & wanted.runs
    cones = Cones(ends[0::2][straight], ends[1::2][straight], radii[straight])
    return _with_bores(cones, struts) if is_inside and bores else cones


def _with_bores(cones: Cones, struts: RoundStruts) -> Cones:
    """Return the inside of struts with their sockets, from a little before the shoulders."""
    runs, bores = struts.runs, sorted((struts.options.sockets or {}).items())
    nodes = np.array([node for node, _ in bores], dtype=np.intp)
    radii, depths = np.array([size for _, size in bores]).T
    inward = runs.directions[runs.incidence.at_nodes(nodes, 1)[:, 0]]
    start = runs.nodes[nodes] + (OVERLAP * radii)[:, None] * inward
    end = runs.nodes[nodes] - (depths + OPENING * radii)[:, None] * inward
    return Cones(
        np.concatenate([cones.starts, start]),
        np.concatenate([cones.ends, end]),
        np.concatenate([cones.radii, np.stack([radii, radii], axis=1)]),
    )


def balls_of(struts: RoundStruts, wanted: Own | None = None) -> Balls:
    """Return the balls at ends, and those at crowded nodes.

    Where a curve is crowded beyond a joint there is one too.
    """
    runs = struts.runs
    is_end = runs.valency[runs.tails] == 1
    rounds, crowded = (
        is_end & ((struts.options.ends == "round") | struts.at_balls),
        struts.crowded | beside_crowded(struts),
    )
    if wanted is not None:
        rounds, crowded = rounds & np.repeat(wanted.runs, 2), crowded & wanted.nodes
    ends = np.flatnonzero(rounds)
    sphere = end_spheres(struts, ends)
    centers = runs.nodes[runs.tails[ends]] - sphere.center[:, None] * runs.directions[ends]
    widest = np.zeros(len(runs.nodes))
    np.maximum.at(widest, runs.tails, runs.radii.reshape(-1))
    places = np.flatnonzero(crowded & (runs.valency > 1))
    sizes = np.maximum(widest, struts.skeleton.radii)[places]
    return Balls(
        np.concatenate([centers, runs.nodes[places]]),
        np.concatenate([sphere.size, sizes]),
    )
