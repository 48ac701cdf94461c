"""How smooth G1 patches are, and how near to the limit surface."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.base.vectors import angle_between, dot
from scaffold_cad.brep.beziermesh import side_indices
from scaffold_cad.brep.g1 import Patches
from scaffold_cad.mesh.subdivision import catmull_clark, limit
from scaffold_cad.mesh.subdivision.connectivity import Connectivity

EDGE_SAMPLES = 33
PATCH_SAMPLES = 9
LIMIT_LEVELS = 4


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


def _along_sides(grids: Floats, sides: Ints) -> Floats:
    """Return the values of `grids` (f, n, n, 3) along `sides` of their patches, (k, n, 3)."""
    count = grids.shape[1]
    rows = side_indices(count - 1)[sides & 3]
    values: Floats = grids.reshape(len(grids), -1, 3)[(sides >> 2)[:, None], rows]
    return values
