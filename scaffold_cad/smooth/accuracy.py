"""How far smooth patches are from what was asked: joins, the limit surface, radii of struts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Radii, UnitVectors
from scaffold_cad.base.vectors import angle_between, any_perpendicular, dot, length, normalize
from scaffold_cad.brep.beziermesh import side_indices
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth.connectivity import Connectivity
from scaffold_cad.smooth.limits import limit
from scaffold_cad.smooth.patches import Patches
from scaffold_cad.smooth.subdivision import catmull_clark

EDGE_SAMPLES = 33
"""Points on each edge at which the normals of its two patches are compared."""

PATCH_SAMPLES = 9
"""Points in each direction at which a patch is looked at."""

LIMIT_LEVELS = 4
"""Subdivisions after which the limit surface is sampled."""


@dataclass(frozen=True, eq=False)
class Deviation(Frozen):
    """How far smooth patches are from what was asked."""

    normal_jump: float
    """Largest angle between the normals of two patches on an edge that is no crease, rad."""
    limit_distance: float
    """Largest distance of a patch from the Catmull-Clark limit surface, mm."""
    turned: Ints
    """Patches that are folded or inside out; none if all is well."""
    strut_radii: Floats
    """Least, mean and greatest radius in the middle of each strut, shape (m, 3), mm; nan for a
    strut whose surface does not reach there."""
    asked_radii: Radii
    """Radius of the skeleton there, shape (m,), mm."""
    strut_offsets: Floats
    """Distance of the section's centre from the strut's axis there, shape (m,), mm; nan as above.
    Large where the surface rounds bends off."""

    @property
    def radius_range(self) -> tuple[float, float]:
        """Least and greatest radius in the middle of a strut, as parts of those asked.

        nan if the surface reaches the middle of none.
        """
        if np.isnan(self.strut_radii).all():
            return np.nan, np.nan
        parts = self.strut_radii / self.asked_radii[:, None]
        return float(np.nanmin(parts[:, 0])), float(np.nanmax(parts[:, 2]))

    @property
    def greatest_offset(self) -> float:
        """Greatest distance of a strut's axis from the section's centre, in radii; nan as above."""
        if np.isnan(self.strut_offsets).all():
            return np.nan
        return float(np.nanmax(self.strut_offsets / self.asked_radii))

    def __str__(self) -> str:
        least, greatest = self.radius_range
        return "\n".join(
            [
                f"normals across edges: {np.degrees(self.normal_jump):.1e}° apart at most",
                f"Catmull-Clark limit: {self.limit_distance:.3g} mm away at most",
                f"patches that turn over: {len(self.turned)}",
                f"radii in mid-strut: {least:.3f} to {greatest:.3f} of those asked",
                f"axes in mid-strut: {self.greatest_offset:.3f} radii off centre at most",
            ]
        )


def deviation(patches: Patches, scaffold: Scaffold) -> Deviation:
    """Return how far the smooth patches of `scaffold` are from what was asked.

    Parameters
    ----------
    patches : of `smooth_patches(scaffold)`, with any options

    Raises
    ------
    OptionError
        If `patches` or `scaffold` is none.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, smooth_patches
    >>> from scaffold_cad.smooth import deviation
    >>> elbow = Skeleton([[0, 0, 0], [20, 0, 0], [20, 20, 0]], [[0, 1], [1, 2]], 1.0)
    >>> scaffold = build_scaffold(elbow, collars=True)
    >>> print(deviation(smooth_patches(scaffold), scaffold))  # doctest: +ELLIPSIS
    normals across edges: ...° apart at most
    Catmull-Clark limit: ... mm away at most
    patches that turn over: 0
    radii in mid-strut: 0.985 to 1.013 of those asked
    axes in mid-strut: 0.000 radii off centre at most
    """
    check_kind(patches, Patches)
    check_kind(scaffold, Scaffold)
    points, _ = patches.sampled(2 * PATCH_SAMPLES - 1)
    strut = scaffold.edge_of_quad[patches.quad_of_patch]
    fine = _grid_mesh(points)
    skeleton = scaffold.skeleton
    sections = mid_strut_sections(fine, np.repeat(strut, len(fine.quads) // len(strut)), skeleton)
    return Deviation(
        normal_jump=float(normal_jumps(patches).max(initial=0.0)),
        limit_distance=float(limit_distances(patches).max(initial=0.0)),
        turned=patches.turned,
        strut_radii=sections.radii,
        asked_radii=skeleton.radii[skeleton.edges].mean(axis=1),
        strut_offsets=sections.offsets,
    )


def normal_jumps(patches: Patches, samples: int = EDGE_SAMPLES) -> Floats:
    """Return the largest angle between the normals of the two patches on each edge, (e,), rad.

    Edges around and inside flat caps are left out.
    """
    connectivity = Connectivity.of(patches.control.mesh, patches.control.creases)
    _, normals = patches.sampled(samples)
    sides = connectivity.sides_of_edge
    smooth = ~patches.is_flat[sides >> 2].any(axis=1)
    one, other = (_along_sides(normals, sides[smooth, k]) for k in range(2))
    jumps: Floats = angle_between(one, other[:, ::-1]).max(axis=1)
    return jumps


def limit_distances(patches: Patches, samples: int = PATCH_SAMPLES) -> Floats:
    """Return the largest distance of each patch from the Catmull-Clark limit surface, (f,), mm."""
    control = patches.control
    fine = catmull_clark(control.mesh, LIMIT_LEVELS, control.creases)
    surface = limit(fine.mesh, fine.creases)
    points, _ = patches.sampled(samples)
    _, nearest = cKDTree(surface.points).query(points.reshape(-1, 3))
    away = points.reshape(-1, 3) - surface.points[nearest]
    distance = np.abs(dot(away, surface.normals[nearest])).reshape(len(points), -1)
    distance[patches.is_flat] = 0.0  # in the plane of their creases
    largest: Floats = distance.max(axis=1)
    return largest


@dataclass(frozen=True, eq=False)
class MidStrutSections:
    """The sections of a surface with the planes across the middles of struts.

    nan for a strut whose surface does not reach there.
    """

    radii: Floats
    """Least, mean and greatest distance from the centre of the nearest circle, shape (m, 3), mm."""
    offsets: Floats
    """Distance of that centre from the strut's axis, shape (m,), mm."""


def mid_strut_sections(mesh: QuadMesh, strut_of_quad: Ints, skeleton: Skeleton) -> MidStrutSections:
    """Return the section in the middle of each strut.

    Parameters
    ----------
    mesh : a fine mesh of the surface
    strut_of_quad : (f,) intp, the skeleton edge that each of its quads belongs to
    """
    ends = skeleton.nodes[skeleton.edges]
    axes, middles = normalize(ends[:, 1] - ends[:, 0]), ends.mean(axis=1)
    strut = np.repeat(strut_of_quad, 4)
    corners = mesh.vertices[mesh.half_edges]  # (4 f, 2, 3)
    height = dot(corners - middles[strut][:, None], axes[strut][:, None])
    across = (height[:, 0] < 0) & (height[:, 1] >= 0)
    # Not edges that lie in the plane but for rounding.
    across &= np.diff(height)[:, 0] > 1e-6 * length(corners[:, 1] - corners[:, 0])
    strut, corners, height = strut[across], corners[across], height[across]
    share = (height[:, 0] / (height[:, 0] - height[:, 1]))[:, None]
    points = (1 - share) * corners[:, 0] + share * corners[:, 1]

    count = np.bincount(strut, minlength=len(axes))
    centres = _centres(points - middles[strut], strut, axes)
    distance = length(points - middles[strut] - centres[strut])
    radii = np.full((len(axes), 3), np.nan)
    radii[strut] = [np.inf, 0.0, 0.0]
    np.minimum.at(radii[:, 0], strut, distance)
    np.add.at(radii[:, 1], strut, distance)
    np.maximum.at(radii[:, 2], strut, distance)
    radii[:, 1] /= np.maximum(count, 1)
    offsets = np.where(count > 0, length(centres), np.nan)
    return MidStrutSections(radii, offsets)


def _centres(points: Points, strut: Ints, axes: UnitVectors) -> Points:
    """Return the centre of the circle nearest to the points around each strut, (m, 3), mm.

    From the middle of the strut. Unlike the points' mean, it does not lean to where they are dense.

    Parameters
    ----------
    points : (k, 3) float64, mm, in the plane across the middle of their strut, from there
    strut : (k,) intp, the strut that each is around
    axes : (m, 3) float64, directions of the struts
    """
    x = any_perpendicular(axes)
    y = np.cross(axes, x)
    places = np.stack([dot(points, x[strut]), dot(points, y[strut])], axis=1)
    # A circle around c is where p² = 2 c·p + constant.
    terms = np.column_stack([2 * places, np.ones(len(places))])
    squares = np.zeros((len(axes), 3, 3))
    sums = np.zeros((len(axes), 3))
    np.add.at(squares, strut, terms[:, :, None] * terms[:, None])
    np.add.at(sums, strut, terms * dot(places, places)[:, None])
    centres = np.einsum("mij,mj->mi", np.linalg.pinv(squares), sums)[:, :2]
    found: Points = centres[:, :1] * x + centres[:, 1:] * y
    return found


def _along_sides(grids: Floats, sides: Ints) -> Floats:
    """Return the values of `grids` (f, n, n, 3) along `sides` of their patches, (k, n, 3)."""
    count = grids.shape[1]
    rows = side_indices(count - 1)[sides & 3]
    values: Floats = grids.reshape(len(grids), -1, 3)[(sides >> 2)[:, None], rows]
    return values


def _grid_mesh(points: Floats) -> QuadMesh:
    """Return the grids (f, n, n, 3) as one mesh, each with vertices of its own."""
    patches, count = points.shape[:2]
    place = np.arange(count**2).reshape(count, count)
    cells = np.stack([place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]], axis=2)
    quads = np.arange(patches)[:, None, None] * count**2 + cells.reshape(-1, 4)
    return QuadMesh(points.reshape(-1, 3), quads.reshape(-1, 4))
