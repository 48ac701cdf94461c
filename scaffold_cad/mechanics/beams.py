"""Beam model: a skeleton's struts as Timoshenko beams, its nodes as rigid joints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from scaffold_cad.base.arguments import as_number, as_real, as_vector, check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Points, as_edge_radii, as_floats
from scaffold_cad.base.placements import PositionLike
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.beamstruts import Beams
from scaffold_cad.mechanics.elements import (
    assembled,
    beam_blocks,
    first_by_second,
    second_end,
)
from scaffold_cad.mechanics.loading import (
    Load,
    Support,
    check_supported,
    held,
    nodal_forces,
)
from scaffold_cad.mechanics.materials import Material, as_material
from scaffold_cad.mechanics.sections import as_hollow, euler_loads
from scaffold_cad.mechanics.solvers import solve_sparse
from scaffold_cad.mechanics.stresses import largest_stresses
from scaffold_cad.mechanics.weight import clamped_by_weight
from scaffold_cad.skeleton import Skeleton, check_skeleton

MOST_RIGID = 0.9
"""Part of a strut that its rigid ends may take."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class BeamModel(Beams):
    """Struts as beams, held and loaded; `solved` tells what becomes of them."""

    fixed: Bools
    """Which freedoms are held, shape (n, 6)."""
    displacement: Floats
    """Where the held ones are moved to, shape (n, 6), mm and rad."""
    forces: Floats
    """Forces and moments on nodes, own weight apart, shape (n, 6), N and N mm."""
    gravity: Floats
    """Acceleration that gives the struts their weight, shape (3,), m/s²."""
    effective_length: float
    """Length that buckles over the strut's: 1 hinged, 0.5 clamped."""

    def __str__(self) -> str:
        held, loaded = self.fixed.any(axis=1).sum(), self.forces.any(axis=1).sum()
        counts = f"{counted(len(self.edge_radii), 'strut')} of {self.material.name or 'material'}"
        return (
            f"BeamModel: {counts}, {size_text(self.skeleton.nodes)}, "
            f"{radii_text(self.edge_radii)}, {counted(held, 'node')} held, {loaded} loaded"
        )

    @property
    def mass(self) -> float:
        """Mass of all struts, kg."""
        return float(self.masses.sum())

    def solved(self) -> BeamSolution:
        """Return displacements, forces and stresses.

        Raises
        ------
        OptionError
            If the supports let a part move, memory does not suffice, or the equations do not
            converge.
        """
        check_supported(self.skeleton, self.fixed)
        skeleton, matrix = self.skeleton, self.stiffness_matrix()
        load = self.forces - self.weight_at_nodes()
        given = self.displacement.reshape(-1)
        right = load.reshape(-1) - self._forces_at_nodes(given)
        free = solve_sparse(matrix, skeleton.nodes, self.fixed, right, self._forces_at_nodes)
        found = given + free
        reactions = self._forces_at_nodes(found).reshape(-1, 6) - load
        reactions[~self.fixed] = 0.0
        return self.solution(found.reshape(-1, 6), reactions)

    def solution(self, freedoms: Floats, reactions: Floats | None = None) -> BeamSolution:
        """Return what becomes of the struts if nodes move by `freedoms` (n, 6), mm and rad."""
        return BeamSolution(
            model=self,
            displacements=np.ascontiguousarray(freedoms[:, :3]),
            rotations=np.ascontiguousarray(freedoms[:, 3:]),
            reactions=np.zeros_like(freedoms) if reactions is None else reactions,
            end_forces=self.end_forces(freedoms),
        )

    def weight_at_nodes(self) -> Floats:
        """Return what struts that carry their weight push back with at each node, (n, 6)."""
        return _summed_at_nodes(self.skeleton, self._clamped_ends())

    def stiffness_matrix(self) -> sparse.bsr_array:
        """Return the stiffness of all nodes, held or not, 6 rows per node: x y z rx ry rz."""
        directions = self.skeleton.directions[::2]
        blocks = beam_blocks(self.spans, directions, self.stiffnesses)
        return assembled(self.skeleton.edges, blocks, len(self.skeleton.nodes))

    def stresses(self, end_forces: Floats) -> Floats:
        """Return the largest von Mises stress in each strut under forces (m, 2, 6), (m,), MPa."""
        directions = self.skeleton.directions[::2]
        return largest_stresses(end_forces, self.spans, directions, self.edge_radii, self.hollow)

    def compressions(self, end_forces: Floats) -> Floats:
        """Return the largest compression in each strut, 0 in tension, (m,), N."""
        pushes = end_forces[:, :, :3] @ self.skeleton.directions[::2][:, :, None]  # (m, 2, 1)
        zero = np.zeros(len(pushes))
        pressed: Floats = np.max([pushes[:, 0, 0], -pushes[:, 1, 0], zero], axis=0)
        return pressed

    @cached_property
    def euler_loads(self) -> Floats:
        """Compression at which each strut buckles by itself, shape (m,), N."""
        return euler_loads(
            self.skeleton.lengths,
            self.edge_radii,
            self.material,
            self.hollow,
            self.effective_length,
        )

    def utilizations(self, end_forces: Floats) -> Floats:
        """Return the larger of stress over strength and compression over Euler load, (m,)."""
        by_stress = self.stresses(end_forces) / self.material.strength
        larger: Floats = np.maximum(by_stress, self.compressions(end_forces) / self.euler_loads)
        return larger

    def with_edge_radii(self, edge_radii: ArrayLike) -> BeamModel:
        """Return the same model with other radii of struts, (m, 2), (m,) or one number, mm."""
        radii = as_edge_radii(edge_radii, "edge_radii", len(self.skeleton.edges))
        return replace(self, edge_radii=radii)

    def _clamped_ends(self) -> Floats:
        """Return what the ends of struts that carry their weight push back with, (m, 2, 6)."""
        if not self.gravity.any() or self.material.density == 0:
            return np.zeros((len(self.skeleton.edges), 2, 6))
        return clamped_by_weight(self, self.gravity)

    def end_forces(self, freedoms: Floats) -> Floats:
        """Return the forces on each strut's ends if nodes move by `freedoms` (n, 6), (m, 2, 6)."""
        return self._forces_of(freedoms) + self._clamped_ends()

    def _forces_at_nodes(self, freedoms: Floats) -> Floats:
        """Return what moves nodes by `freedoms` (6 n,), weight apart, (6 n,)."""
        forces = self._forces_of(freedoms.reshape(-1, 6))
        return _summed_at_nodes(self.skeleton, forces).reshape(-1)

    def _forces_of(self, freedoms: Floats) -> Floats:
        """Return the forces on ends if nodes move by `freedoms` (n, 6), weight apart, (m, 2, 6)."""
        first, second = np.moveaxis(freedoms[self.skeleton.edges], 1, 0)  # (m, 6)
        # What the second end moves beyond the rigid motion of the first: small differences of
        # large numbers are taken before they are multiplied.
        drift = second - first
        drift[:, :3] -= np.cross(first[:, 3:], self.spans)
        far = second_end(self.skeleton.directions[::2], self.stiffnesses)
        at_second = np.einsum("mij,mj->mi", far, drift)
        at_first = np.einsum("mij,mj->mi", first_by_second(self.spans), at_second)
        return np.stack([at_first, at_second], axis=1)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class BeamSolution(Frozen):
    """What becomes of a beam model under its loads: arrays by node and by strut."""

    model: BeamModel
    """What was solved."""
    displacements: Points
    """Of each node, shape (n, 3), mm."""
    rotations: Points
    """Of each node, shape (n, 3), rad."""
    reactions: Floats
    """Force and moment of the supports on each node, shape (n, 6), N and N mm."""
    end_forces: Floats
    """Force and moment on each strut at its two ends, in space, shape (m, 2, 6), N and N mm."""

    def __str__(self) -> str:
        return (
            f"BeamSolution: {counted(len(self.end_forces), 'strut')}, moved by up to "
            f"{self.largest_displacement:.4g} mm, stress up to {self.stresses.max():.4g} MPa, "
            f"utilization up to {self.utilization.max():.3g}"
        )

    @cached_property
    def axial(self) -> Floats:
        """Force along each strut, shape (m, 2) at its ends, N; tension is positive."""
        along = self.model.skeleton.directions[::2]
        signs = np.array([-1.0, 1.0])
        forces: Floats = np.einsum("mej,mj,e->me", self.end_forces[:, :, :3], along, signs)
        return forces

    @cached_property
    def stresses(self) -> Floats:
        """Largest von Mises stress in each strut, shape (m,), MPa; see `largest_stresses`."""
        return self.model.stresses(self.end_forces)

    @cached_property
    def stress_utilization(self) -> Floats:
        """Stress over the material's strength, shape (m,); 0 where that is unlimited."""
        return self.stresses / self.model.material.strength

    @cached_property
    def buckling_utilization(self) -> Floats:
        """Compression over the strut's own Euler load, shape (m,); 0 in tension."""
        return self.model.compressions(self.end_forces) / self.model.euler_loads

    @cached_property
    def utilization(self) -> Floats:
        """The larger of both utilizations, shape (m,): above 1 the strut is overloaded."""
        return self.model.utilizations(self.end_forces)

    @property
    def compliance(self) -> float:
        """Forces times displacements, of loads on nodes and of moved supports, N mm.

        It is twice the strain energy where no weight acts.
        """
        freedoms = np.concatenate([self.displacements, self.rotations], axis=1)
        return float(((self.model.forces + self.reactions) * freedoms).sum())

    @property
    def largest_displacement(self) -> float:
        """Largest displacement of a node, mm."""
        return float(np.linalg.norm(self.displacements, axis=1).max())

    @property
    def mass(self) -> float:
        """Mass of all struts, kg."""
        return self.model.mass

    def deformed(self, scale: float = 1.0) -> Skeleton:
        """Return the skeleton with its nodes moved, `scale` times as far as they are."""
        return self.model.skeleton.moved(
            self.model.skeleton.nodes + as_real(scale, "scale") * self.displacements
        )


@checks_keywords()
def beam_model(
    skeleton: Skeleton,
    material: Material | str,
    supports: Support | Iterable[Support],
    loads: Load | Iterable[Load] = (),
    *,
    gravity: PositionLike = (0.0, 0.0, 0.0),
    hollow: float = 0.0,
    edge_radii: ArrayLike | None = None,
    rigid_ends: ArrayLike = 0.0,
    effective_length: float = 1.0,
) -> BeamModel:
    """Return the struts of `skeleton` as beams, with what holds and loads them.

    Linear: small displacements, no contact. Struts are Timoshenko beams with round sections that
    meet in points: real nodes are stiffer, and lattices with relative densities above some 10 %
    come out too soft, by up to 40 % at 50 %. `rigid_ends` stiffens the nodes.

    Parameters
    ----------
    skeleton : as `check_skeleton` asks; radii are its struts' `edge_radii`
    material : a Material, or the name of one in MATERIALS
    supports, loads : one or several of each
    gravity : acceleration, m/s², such as (0, 0, -9.81); struts get weight by their density
    hollow : inner over outer radius of tubes, 0 for full struts
    edge_radii : (m, 2), (m,) or one number, mm, in place of the skeleton's
    rigid_ends : length at the ends of struts that does not deform, (m, 2) or one number, mm
    effective_length : length that buckles over that of the strut: 1 for hinged ends (safe in
        braced frames), 0.5 for clamped ones, 2 for one that is free

    Raises
    ------
    OptionError
        If an argument is of another kind or out of its range.
    SkeletonError
        If the skeleton is not valid or a radius is not > 0.

    Examples
    --------
    A cantilever of length 100 mm and radius 5 mm bends by F l³ / (3 E I) and shears a little:

    >>> from scaffold_cad import Skeleton
    >>> arm = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 5.0)
    >>> solution = beam_model(arm, "steel", Support([0]), Load([1], (0, 0, -100))).solved()
    >>> print(f"{solution.displacements[1, 2]:.4f} mm, {solution.stresses[0]:.1f} MPa")
    -0.3251 mm, 101.9 MPa
    """
    check_kind(skeleton, Skeleton)
    check_skeleton(skeleton)
    fastened = held(skeleton, supports)
    return BeamModel(
        skeleton=skeleton,
        material=as_material(material),
        edge_radii=skeleton.edge_radii
        if edge_radii is None
        else as_edge_radii(edge_radii, "edge_radii", len(skeleton.edges)),
        hollow=as_hollow(hollow),
        rigid=_rigid_ends(skeleton, rigid_ends),
        fixed=fastened.fixed,
        displacement=fastened.displacement,
        forces=nodal_forces(skeleton, loads),
        gravity=as_vector(gravity, "gravity", unit=" m/s²"),
        effective_length=as_number(effective_length, "effective_length", unit=""),
    )


def _rigid_ends(skeleton: Skeleton, values: ArrayLike) -> Floats:
    count = len(skeleton.edges)
    given = as_floats(values, "rigid_ends", OptionError)
    if given.shape not in {(), (count, 2)} or not (np.isfinite(given) & (given >= 0)).all():
        shown = given.tolist() if given.ndim == 0 else f"an array of shape {given.shape}"
        raise OptionError(f"rigid_ends is {shown}; need a number >= 0 or ({count}, 2) of them, mm")
    rigid: Floats = np.array(np.broadcast_to(given, (count, 2)))
    over = np.flatnonzero(rigid.sum(axis=1) > MOST_RIGID * skeleton.lengths)
    if len(over):
        raise OptionError(
            f"edge {over[0]} of length {skeleton.lengths[over[0]]:g} mm has rigid ends of "
            f"{rigid[over[0]].sum():g} mm; need at most {MOST_RIGID:g} of its length"
        )
    return rigid


def _summed_at_nodes(skeleton: Skeleton, at_ends: Floats) -> Floats:
    """Return the sum of `at_ends` (m, 2, 6) at each node, (n, 6)."""
    return sums_by_row(at_ends, skeleton.edges, len(skeleton.nodes))
