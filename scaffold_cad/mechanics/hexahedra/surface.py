"""The blends that the outer points of hexahedra slide on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Frozen, Ints, Points, UnitVectors
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.blending.nearest import nearest_on_blends
from scaffold_cad.struts.model import BlendedNodes


@dataclass(frozen=True, eq=False)
class RimSurface(Frozen):
    """The blends that points of the rim are on."""

    blended: tuple[BlendedNodes, ...]
    """The nodes."""
    group: Ints
    """Which of these each point is at, -1 for those on struts and curves, shape (r,)."""
    shape: Ints
    """Its blend there, shape (r,)."""
    center: Points
    """Its node, shape (r, 3), mm."""
    normals: UnitVectors
    """There, outward, as planned; 0 on struts and curves, shape (r, 3)."""

    @staticmethod
    def of(
        struts: RoundStruts, rings: list[Ints], normals: list[UnitVectors], count: int
    ) -> RimSurface:
        """Return the blends of `count` points of the rim.

        Parameters
        ----------
        rings : those of each group's struts, from the arcs to the collars,
            (M, N, levels + 1, sides)
        normals : at these, (M, N, levels + 1, sides, 3)
        """
        number, shape = np.full(count, -1, dtype=np.intp), np.zeros(count, dtype=np.intp)
        center, normal = np.zeros((2, count, 3))
        for k, (group, ring) in enumerate(zip(struts.blended, rings, strict=True)):
            normal[ring[:, :, :-1]] = normals[k][:, :, :-1]
            rows = ring[:, :, :-1].reshape(len(group.nodes), -1)
            number[rows] = k
            shape[rows] = group.shape_of[:, None]
            center[rows] = struts.runs.nodes[group.nodes][:, None]
        return RimSurface(struts.blended, number, shape, center, normal)

    def __call__(self, rows: Ints, places: Points) -> tuple[Points, UnitVectors]:
        """Return the points of the surface near places (q, 3) of points (q,), and its normals."""
        found, normals = places.copy(), np.zeros_like(places)
        for k, group in enumerate(self.blended):
            some = np.flatnonzero(self.group[rows] == k)
            if len(some):
                number, center = rows[some], self.center[rows[some]]
                on, normals[some] = nearest_on_blends(
                    group.shapes, self.shape[number], places[some] - center
                )
                found[some] = on + center
        return found, normals
