"""What hexahedra are made of: cross-sections, and which of them follow each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import sparse

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.mechanics.hexahedra.control import Control
from scaffold_cad.mechanics.hexahedra.narrowing import narrow_controls
from scaffold_cad.mechanics.hexahedra.sections import Frame
from scaffold_cad.mechanics.hexahedra.surface import RimSurface


@dataclass(frozen=True, eq=False)
class Span(Frozen):
    """Pairs of sections with hexahedra between them, cut into as many pieces each."""

    sections: Ints
    """First and last section of each, shape (e, 2)."""
    pieces: int
    """Hexahedra one after another between the two."""
    edge: Ints
    """Edge of the skeleton that each belongs to, shape (e,)."""
    nodes: Ints
    """Branch point at the first and at the last of its pieces, -1 for none, shape (e, 2)."""
    straight: Ints
    """Those whose sections between the two keep their distances from the axis, shape (s,)."""

    def nodes_touched(self, wide: int) -> Ints:
        """Return the branch point at each hexahedron, -1 for none, `wide` of them a piece."""
        node = np.full((len(self.edge), self.pieces, wide), -1, dtype=np.intp)
        node[:, 0] = self.nodes[:, :1]
        node[:, -1] = np.where(self.nodes[:, 1:] >= 0, self.nodes[:, 1:], node[:, -1])
        return node.reshape(-1)


@dataclass(frozen=True, eq=False)
class Caps(Frozen):
    """Spheres in which struts end."""

    centers: Points
    """Shape (x, 3), mm."""
    radii: Floats
    """Shape (x,), mm."""
    rim: Ints
    """Points of the rim on each, shape (x, r)."""

    def put_on(self, points: Points, sections: Ints) -> None:
        """Move the points of the last sections, (x, s), onto the spheres."""
        spokes = normalize(points[sections] - self.centers[:, None])
        points[sections] = self.centers[:, None] + self.radii[:, None, None] * spokes


@dataclass(frozen=True, eq=False)
class Plan(Frozen):
    """The sections of struts, and what lies between them."""

    frame: Frame
    """The sections."""
    spans: tuple[Span, ...]
    """What lies between them."""
    surface: RimSurface | None
    """Puts points of the rim back on the struts' surface, where those that may move stay on it."""
    closing: Ints
    """Sections in which struts end, shape (x,)."""
    closed: Ints
    """Extremity of the skeleton at each of these, shape (x,)."""
    caps: Caps | None = None
    """The sphere of each, where ends are round."""

    def control(self, weights: sparse.csr_array, cells: Ints, layers: int) -> Control:
        """Return what is relaxed of hexahedra (k, 8)."""
        frame, surface = self.frame, self.surface
        movable, scale = frame.movable(layers)
        hubs, rim = len(frame.hubs), len(frame.rim)
        sliding = np.zeros(len(movable), dtype=np.bool_)
        hub = frame.hub_of_control(layers)
        if surface is None:
            narrow = partial(narrow_controls, frame, layers)
            return Control(weights, cells, movable, scale, sliding, _nowhere, hub, narrow)
        sliding[hubs : hubs + rim] = frame.loose_rim
        on_rim = surface

        def onto(rows: Ints, to: Points) -> tuple[Points, UnitVectors]:
            return on_rim(rows - hubs, to)

        return Control(weights, cells, movable, scale, sliding, onto, hub, None)

    def normals(
        self, places: Points, points: Points, weights: sparse.csr_array, sections: Ints
    ) -> UnitVectors:
        """Return the normals of round struts at outer points, (p, 3); those of others mean nothing.

        Parameters
        ----------
        places : (c, 3) control points, mm
        points : (p, 3) made of these by `weights`, but for those on caps, mm
        sections : (x, s) points of the sections in which struts end
        """
        frame = self.frame
        on_rim = np.arange(len(frame.hubs), len(frame.hubs) + len(frame.rim))
        rim = places[on_rim]
        normals = normalize(rim - places[frame.owner])
        if self.surface is not None:
            on_blends = self.surface.normals.copy()
            moved = np.flatnonzero((rim != frame.rim).any(axis=1))
            on_blends[moved] = self.surface(moved, rim[moved])[1]
            normals = np.where(on_blends.any(axis=1, keepdims=True), on_blends, normals)
        if self.caps is not None:
            centers = self.caps.centers[:, None]
            normals[self.caps.rim] = normalize(rim[self.caps.rim] - centers)
        found = normalize(weights[:, on_rim] @ normals)
        if self.caps is not None:
            found[sections] = normalize(points[sections] - centers)
        return found


def _nowhere(_: Ints, places: Points) -> tuple[Points, Points]:
    """Return places as they are: no point stays on a surface."""
    return places, np.zeros_like(places)
