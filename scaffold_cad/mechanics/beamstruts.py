"""Struts as beams: what they are made of and how stiff they are, before any is held or loaded."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from scaffold_cad.base.arrays import Floats, Frozen, Points
from scaffold_cad.mechanics.materials import Material
from scaffold_cad.mechanics.sections import Stiffnesses, end_stiffnesses, volumes
from scaffold_cad.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class Beams(Frozen):
    """Struts as Timoshenko beams."""

    skeleton: Skeleton
    """The struts' axes."""
    material: Material
    """What all struts are made of."""
    edge_radii: Floats
    """Radius of each strut at its ends, shape (m, 2), mm."""
    hollow: float
    """Inner over outer radius of every section, 0 for full ones."""
    rigid: Floats
    """Length at each end of a strut that does not deform, shape (m, 2), mm."""

    @cached_property
    def spans(self) -> Points:
        """Second end of each strut seen from the first, shape (m, 3), mm."""
        ends = self.skeleton.nodes[self.skeleton.edges]
        spans: Points = ends[:, 1] - ends[:, 0]
        return spans

    @cached_property
    def stiffnesses(self) -> Stiffnesses:
        """Stiffnesses of each strut's second end."""
        return end_stiffnesses(
            self.skeleton.lengths, self.edge_radii, self.material, self.hollow, self.rigid
        )

    @cached_property
    def masses(self) -> Floats:
        """Mass of each strut from node to node, shape (m,), kg; nodes count several times."""
        volume = volumes(self.skeleton.lengths, self.edge_radii, self.hollow)
        masses: Floats = volume * self.material.density * 1e-9
        return masses
