"""smooth_patches: the Catmull-Clark limit of a quad mesh as G1 Bézier patches, for a B-rep."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arguments import as_count, check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.summaries import counted, size_text
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.brep.bernstein import bernstein, elevation
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1.bicubic import bicubic_patches
from scaffold_cad.brep.g1.controlnet import ControlNet
from scaffold_cad.brep.g1.system import G1System
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision.connectivity import NO_CREASES, Connectivity
from scaffold_cad.mesh.subdivision.grids import as_grids
from scaffold_cad.mesh.subdivision.limits import limit, limit_points
from scaffold_cad.mesh.subdivision.refining import Subdivision, catmull_clark, subdivided

_log = logging.getLogger(__name__)

DEGREES = (4, 5)
"""Degrees that leave a surface free enough to be smooth; 4 does on patches that are not long."""

TURN_SAMPLES = 9
"""Points in each direction at which a patch is looked at for folds."""

SAMPLE_LEVELS = 3
"""Subdivisions after which the limit surface is sampled: 9 × 9 points per patch."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Patches(Frozen):
    """A closed surface of Bézier patches that join with one tangent plane."""

    bezier: BezierMesh
    """The patches; their quads are those of `control`."""
    control: Subdivision
    """The mesh whose Catmull-Clark limit they follow, and the creases across which they do not
    join smoothly; one patch per quad."""
    is_flat: Bools
    """Whether each patch is in a plane within creases, shape (f,)."""

    def __str__(self) -> str:
        flat = f"{int(self.is_flat.sum())} flat"
        size = size_text(self.control.mesh.vertices)
        return f"Patches: {counted(len(self.is_flat), 'patch', 'patches')}, {flat}, {size}"

    @property
    def quad_of_patch(self) -> Ints:
        """Quad of the mesh given that each patch is a part of, shape (f,)."""
        return self.control.quad_of_quad

    @cached_property
    def turned(self) -> Ints:
        """Patches that are folded or inside out; none if all is well.

        Those whose normals at two neighboring points are more than a right angle apart, or whose
        normal in the middle points into the limit surface.
        """
        _, normals = self.sampled(TURN_SAMPLES)
        least = np.minimum(
            dot(normals[:, 1:], normals[:, :-1]).min(axis=(1, 2)),
            dot(normals[:, :, 1:], normals[:, :, :-1]).min(axis=(1, 2)),
        )
        fine = catmull_clark(self.control.mesh, 1, self.control.creases)
        middles = len(fine.mesh.vertices) - len(self.is_flat)
        outward = limit(fine.mesh, fine.creases).normals[middles:]
        center = normals[:, TURN_SAMPLES // 2, TURN_SAMPLES // 2]
        return np.flatnonzero(~self.is_flat & ((least <= 0) | (dot(center, outward) <= 0)))

    def sampled(self, count: int) -> tuple[Floats, UnitVectors]:
        """Return points (f, count, count, 3), mm, of an even grid on each patch, and normals there.

        At corners of flat caps where sides meet in a straight angle the normal is not determined.
        """
        degree, points = self.bezier.degree, self.bezier.control_points
        at = np.linspace(0, 1, count)
        value, slope = bernstein(degree, at), bernstein(degree, at, 1)

        def surface(u: Floats, v: Floats) -> Floats:
            along_v = np.einsum("bj,fijk->fibk", v, points, optimize=True)
            return np.asarray(np.einsum("ai,fibk->fabk", u, along_v, optimize=True))

        normals = np.cross(surface(slope, value), surface(value, slope))
        return surface(value, value), normalize(normals)


@checks_keywords()
def smooth_patches(surface: QuadMesh, degree: int = 5, split: int | None = None) -> Patches:
    """Return a quad mesh as smooth Bézier patches: one per quad, all joins G1.

    They follow the mesh's Catmull-Clark limit. Where one patch per quad would fold, the quads are
    cut in four; where that does not help a warning is logged. Whether patches far from each other
    cross is not checked here.

    Parameters
    ----------
    surface : a closed quad mesh, such as `project` moves onto a convolution surface
    degree : 5 or 4, of the patches in both directions; 5 is fairer, and 4 needs quads cut in four
    split : how often each quad is cut in four first, for patches closer to the limit; by default as
        rarely as will do, and not more than once

    Raises
    ------
    MeshError
        If the mesh is not closed.
    OptionError
        If `surface` is not a QuadMesh, or `degree` or `split` is out of its range.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> smooth_patches(build_scaffold(strut).mesh).bezier.degree
    5
    """
    check_kind(surface, QuadMesh)
    if split is not None:
        split = as_count(split, "split")
    degree = as_count(degree, "degree")
    if degree not in DEGREES:
        raise OptionError(f"degree is {degree}; need 4 or 5")
    if degree < 5 and split == 0:
        raise OptionError(f"degree is {degree} and split 0; need split 1 or more, or degree 5")
    control = Subdivision(surface, NO_CREASES, np.arange(len(surface.quads)))
    if split is not None:
        patches = _patched(control, degree, split)
    else:
        patches = _patched(control, degree, 0 if degree == 5 else 1)
        if degree == 5 and len(patches.turned):
            finer = _patched(control, degree, 1)
            patches = patches if len(finer.turned) else finer
    if len(patches.turned):
        _log.warning(
            "%s over, that on quad %d first; a finer mesh may help",
            counted(len(patches.turned), "patch turns", "patches turn"),
            patches.quad_of_patch[patches.turned[0]],
        )
    return patches


def _patched(control: Subdivision, degree: int, split: int) -> Patches:
    """Return the patches of a control mesh whose quads are cut in four `split` times."""
    coarse = Connectivity.of(control.mesh, control.creases)
    is_cap = coarse.is_crease[coarse.edge_of_side].all(axis=1)
    is_flat = np.repeat(is_cap, 4**split)
    control, connectivity = _split(control, coarse, split)
    net = ControlNet(connectivity, degree)
    system = G1System(net, is_flat)

    patches = bicubic_patches(connectivity, control.mesh.vertices, is_flat)
    patches = _tensor(elevation(3, degree), patches)
    near = net.gathered(patches.reshape(len(patches), -1, 3))
    fitted = _fitted(connectivity, control.mesh, degree)
    near[system.is_free] = net.gathered(fitted.reshape(len(fitted), -1, 3))[system.is_free]
    patches = system.solved(near)[net.of_patch].reshape(patches.shape)
    return Patches(BezierMesh(connectivity.quads, patches), control, is_flat)


def _split(
    control: Subdivision, coarse: Connectivity, levels: int
) -> tuple[Subdivision, Connectivity]:
    """Return the control mesh with each quad cut in four `levels` times."""
    if levels == 0:
        return control, coarse
    fine, points = subdivided(coarse, control.mesh.vertices, levels)
    quads = np.repeat(control.quad_of_quad, 4**levels)
    mesh = QuadMesh(points, fine.quads)
    return Subdivision(mesh, fine.edges[fine.is_crease], quads), fine


def _fitted(connectivity: Connectivity, mesh: QuadMesh, degree: int) -> Floats:
    """Return the patches nearest to samples of the limit surface, (f, d + 1, d + 1, 3).

    Each for itself, in the sum of squared distances at equal parameters.
    """
    fine, points = subdivided(connectivity, mesh.vertices, SAMPLE_LEVELS)
    limits = limit_points(fine, points)
    at_samples = bernstein(degree, np.linspace(0, 1, 2**SAMPLE_LEVELS + 1))
    least_squares = np.asarray(np.linalg.pinv(at_samples), dtype=np.float64)
    return _tensor(least_squares, as_grids(limits[fine.quads], SAMPLE_LEVELS))


def _tensor(matrix: Floats, patches: Floats) -> Floats:
    """Return `matrix` applied along both directions of `patches` (f, k, k, 3)."""
    along_v = np.einsum("bj,fijk->fibk", matrix, patches, optimize=True)
    applied: Floats = np.einsum("ai,fibk->fabk", matrix, along_v, optimize=True)
    return applied
