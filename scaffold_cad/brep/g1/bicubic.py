"""Bicubic patches near the Catmull-Clark limit surface: exact where a quad's vertices are regular.

References
----------
Loop, Schaefer, Approximating Catmull-Clark subdivision surfaces with bicubic patches, ACM TOG
27(1), 2008.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.mesh.subdivision.connectivity import Connectivity


def smooth_valence(connectivity: Connectivity) -> Ints:
    """Return the valence of each vertex, but 4, the regular one, on creases and where unused, (v,).

    Beside a crease the surface goes on as if its mirror image lay on the other side.
    """
    regular = (connectivity.crease_valence > 0) | (connectivity.valence == 0)
    return np.where(regular, 4, connectivity.valence)


def bicubic_patches(connectivity: Connectivity, points: Points, is_flat: Bools) -> Floats:
    """Return the control points of one bicubic patch per quad, (f, 4, 4, 3), mm.

    Parameters
    ----------
    is_flat : (f,) bool, the quads of flat caps: their patches lie in the plane of the creases
        around them
    """
    quads, on_crease = connectivity.quads, connectivity.is_crease[connectivity.edge_of_side]
    valence = smooth_valence(connectivity)[quads][..., None]  # (f, 4, 1)
    corners = points[quads]  # (f, 4, 3)
    ahead, back = np.roll(corners, -1, axis=1), np.roll(corners, 1, axis=1)
    inner = valence * corners + 2 * ahead + 2 * back + np.roll(corners, -2, axis=1)
    inner = (inner / (valence + 5)).reshape(-1, 3)  # beside the start of each side
    vertex = _corners(connectivity, points, inner)

    twin = connectivity.twin
    after = (twin & ~3) | ((twin + 1) & 3)
    start = ((inner + inner[after]) / 2).reshape(-1, 4, 3)  # on each side, next to its start
    start[on_crease] = ((2 * corners + ahead) / 3)[on_crease]
    straight = is_flat[:, None] & ~on_crease
    start[straight] = ((2 * vertex[quads] + vertex[np.roll(quads, -1, axis=1)]) / 3)[straight]
    end = start.reshape(-1, 3)[twin].reshape(-1, 4, 3)

    patches = np.empty((len(quads), 4, 4, 3))
    places = [(0, 0), (3, 0), (3, 3), (0, 3)]
    for k, (i, j) in enumerate(places):
        p, q = places[(k + 1) % 4]
        di, dj = (p - i) // 3, (q - j) // 3  # along the side; inwards is (−dj, di)
        patches[:, i, j] = vertex[quads[:, k]]
        patches[:, i + di, j + dj] = start[:, k]
        patches[:, p - di, q - dj] = end[:, k]
        patches[:, i + di - dj, j + dj + di] = inner.reshape(-1, 4, 3)[:, k]
    patches[is_flat] = filled(patches[is_flat])
    return patches


def filled(patches: Floats) -> Floats:
    """Return `patches` (k, d + 1, d + 1, 3) with their inner points spread between their sides.

    Coons's rule.
    """
    share = np.linspace(0, 1, patches.shape[1])
    u, v = share[:, None, None], share[None, :, None]
    first, last = patches[:, :, :1], patches[:, :, -1:]
    left, right = patches[:, :1], patches[:, -1:]
    across = (1 - v) * first + v * last
    along = (1 - u) * left + u * right
    corners = (1 - v) * along[:, :, :1] + v * along[:, :, -1:]
    spread: Floats = across + along - corners
    return spread


def _corners(connectivity: Connectivity, points: Points, inner: Points) -> Points:
    """Return where the patches' corners lie, (v, 3): the mean of the inner points around each."""
    owners = connectivity.quads.reshape(-1, 1)
    valence = np.maximum(connectivity.valence, 1)[:, None]
    corners = connectivity.sum_at_vertices(owners, inner) / valence
    creased = connectivity.crease_valence > 0
    if creased.any():
        along = (4 * points + connectivity.sum_of_crease_neighbors(points)) / 6
        corners[creased] = along[creased]
    return corners
