"""smooth_patches: the smooth solid as G1 Bézier patches, for a B-rep."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arguments import as_count, check_kind
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.brep.bernstein import bernstein, elevation
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth.bicubic import bicubic_patches
from scaffold_cad.smooth.connectivity import NO_CREASES, Connectivity
from scaffold_cad.smooth.control import Caps, ControlMesh, control_mesh
from scaffold_cad.smooth.controlnet import ControlNet
from scaffold_cad.smooth.g1 import G1System
from scaffold_cad.smooth.grids import as_grids
from scaffold_cad.smooth.limits import limit, limit_points
from scaffold_cad.smooth.subdivision import catmull_clark, subdivided

_log = logging.getLogger(__name__)

DEGREES = (4, 5)
"""Degrees that leave a surface free enough to be smooth; 4 does on patches that are not long."""

TURN_SAMPLES = 9
"""Points in each direction at which a patch is looked at for folds."""

SAMPLE_LEVELS = 3
"""Subdivisions after which the limit surface is sampled: 9 × 9 points a patch."""


@dataclass(frozen=True, eq=False)
class Patches(Frozen):
    """A closed surface of Bézier patches that join with one tangent plane."""

    bezier: BezierMesh
    """The patches; their quads are those of `control`."""
    control: ControlMesh
    """The mesh whose Catmull-Clark limit they follow, and the creases across which they do not
    join smoothly; one patch a quad."""
    is_flat: Bools
    """Whether each patch is a part of a flat cap, shape (f,)."""
    edge_of_patch: Ints | None
    """Edge of the skeleton that each patch is around, shape (f,); None around a bare mesh."""

    @property
    def quad_of_patch(self) -> Ints:
        """Quad of the scaffold, or of the mesh given, that each patch is a part of, shape (f,)."""
        return self.control.quad_of_quad

    @cached_property
    def turned(self) -> Ints:
        """Patches that are folded or inside out; none if all is well.

        Those whose normals at two neighbouring points are more than a right angle apart, or whose
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
        centre = normals[:, TURN_SAMPLES // 2, TURN_SAMPLES // 2]
        return np.flatnonzero(~self.is_flat & ((least <= 0) | (dot(centre, outward) <= 0)))

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


def smooth_patches(
    surface: Scaffold | QuadMesh, degree: int = 5, split: int | None = None, caps: Caps = "round"
) -> Patches:
    """Return the smooth solid around a scaffold as Bézier patches: one a quad, all joins G1.

    Where one a quad would fold, as long struts between nodes of high valency without collars may,
    the quads are cut in four. Where that does not help, because struts overlap or leave a node
    close to each other without collars, a warning is logged. Whether patches far from each other
    cross is not looked at here: `crossing_struts` does.

    Parameters
    ----------
    surface : a scaffold, whose struts get the radii of its skeleton; or a closed quad mesh, whose
        Catmull-Clark limit is followed as it is
    degree : 5 or 4, of the patches in both directions; 5 is fairer, and 4 needs quads cut in four
    split : how often each quad is cut in four first, for patches closer to the limit; by default as
        rarely as will do, and not more than once
    caps : of a scaffold, see `control_mesh`; a flat cap meets its strut in an edge

    Raises
    ------
    MeshError
        If the mesh is not closed.
    OptionError
        If `surface` is none, or `degree`, `split` or `caps` is out of its range.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, smooth_patches
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> smooth_patches(build_scaffold(strut)).bezier.degree
    5
    """
    patches = patches_around(surface, degree, split, caps)
    if len(patches.turned):
        _log.warning(
            "%d patches turn over, that on quad %d first; collars or smaller radii may help",
            len(patches.turned),
            patches.quad_of_patch[patches.turned[0]],
        )
    return patches


def patches_around(
    surface: Scaffold | QuadMesh, degree: int = 5, split: int | None = None, caps: Caps = "round"
) -> Patches:
    """Return the patches of `smooth_patches` without a warning, for those who look at `turned`."""
    check_kind(surface, Scaffold, QuadMesh)
    if split is not None:
        split = as_count(split, "split")
    degree = as_count(degree, "degree")
    if degree not in DEGREES:
        raise OptionError(f"degree is {degree}; need 4 or 5")
    if degree < 5 and split == 0:
        raise OptionError(f"degree is {degree} and split 0; need split 1 or more, or degree 5")
    edges = None
    if isinstance(surface, Scaffold):
        control = control_mesh(surface, caps)
        edges = surface.edge_of_quad[control.quad_of_quad]
    else:
        control = ControlMesh(surface, NO_CREASES, np.arange(len(surface.quads)))
    if split is not None:
        return _patched(control, edges, degree, split)
    if degree < 5:
        return _patched(control, edges, degree, 1)
    patches = _patched(control, edges, degree, 0)
    if len(patches.turned) == 0:
        return patches
    finer = _patched(control, edges, degree, 1)
    return patches if len(finer.turned) else finer


def _patched(control: ControlMesh, edges: Ints | None, degree: int, split: int) -> Patches:
    """Return the patches of a control mesh whose quads are cut in four `split` times.

    Parameters
    ----------
    edges : of the skeleton, that each quad is around, if there is one
    """
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
    of_patch = None if edges is None else np.repeat(edges, 4**split)
    return Patches(BezierMesh(connectivity.quads, patches), control, is_flat, of_patch)


def _split(
    control: ControlMesh, coarse: Connectivity, levels: int
) -> tuple[ControlMesh, Connectivity]:
    """Return the control mesh with each quad cut in four `levels` times."""
    if levels == 0:
        return control, coarse
    fine, points = subdivided(coarse, control.mesh.vertices, levels)
    quads = np.repeat(control.quad_of_quad, 4**levels)
    mesh = QuadMesh(points, fine.quads)
    return ControlMesh(mesh, fine.edges[fine.is_crease], quads), fine


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
