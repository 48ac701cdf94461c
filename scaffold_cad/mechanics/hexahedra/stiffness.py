"""Stiffness of hexahedra of an elastic material: eight corners and incompatible modes.

Plain trilinear hexahedra are too stiff when they bend. Three quadratic modes a direction, whose
slopes are taken with the Jacobian of the center so that constant strain stays exact, cure that.

References
----------
Taylor, Beresford, Wilson, A non-conforming element for stress analysis, IJNME 10, 1976.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.mechanics.materials import Material

CORNERS = np.array(
    [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
    ],
    dtype=np.float64,
)
"""Corners of the hexahedron in its own coordinates."""

GAUSS = CORNERS / np.sqrt(3.0)
"""Points at which the energy is sampled, each of weight 1."""


def elasticity(material: Material) -> Floats:
    """Return the isotropic law, stress = law · strain, in the order xx yy zz yz xz xy, (6, 6)."""
    nu = material.poisson
    lame = material.young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    law = np.zeros((6, 6))
    law[:3, :3] = lame
    law += np.diag([2.0 * material.shear_modulus] * 3 + [material.shear_modulus] * 3)
    return law


def hexahedron_stiffnesses(points: Points, hexahedra: Ints, law: Floats) -> Floats:
    """Return the stiffness of each hexahedron, (k, 24, 24), N/mm; rows x y z of each corner.

    Parameters
    ----------
    points : (p, 3) float64, mm
    hexahedra : (k, 8) intp, none inverted
    law : (6, 6) float64, MPa
    """
    corners = points[hexahedra]  # (k, 8, 3)
    center = _jacobians(corners, np.zeros(3))
    at_center = np.linalg.inv(center)
    center_size = np.linalg.det(center)
    own = np.zeros((len(corners), 24, 24))
    mixed = np.zeros((len(corners), 24, 9))
    inner = np.zeros((len(corners), 9, 9))
    for place in GAUSS:
        jacobian = _jacobians(corners, place)
        size = np.linalg.det(jacobian)
        slopes: Floats = np.linalg.inv(jacobian) @ _shape_slopes(place).T  # (k, 3, 8)
        strain = _strains(slopes)  # (k, 6, 24)
        modes = -2.0 * place * np.eye(3)  # slope of 1 - ξ² along its own coordinate
        scaled = (center_size / size)[:, None, None] * (at_center @ modes)
        extra = _strains(scaled)  # (k, 6, 9)
        stress = law @ strain * size[:, None, None]
        own += np.swapaxes(strain, 1, 2) @ stress
        mixed += np.swapaxes(stress, 1, 2) @ extra
        inner += np.swapaxes(extra, 1, 2) @ (law @ extra) * size[:, None, None]
    condensed: Floats = own - mixed @ np.linalg.solve(inner, np.swapaxes(mixed, 1, 2))
    return condensed


def _shape_slopes(place: Floats) -> Floats:
    """Return the slopes of the corners' shape functions at one place, (8, 3)."""
    factors = 1.0 + CORNERS * place  # (8, 3)
    x, y, z = factors.T
    slopes: Floats = CORNERS / 8.0 * np.stack([y * z, x * z, x * y], axis=1)
    return slopes


def _jacobians(corners: Floats, place: Floats) -> Floats:
    """Return how space changes with each own coordinate, row by row, (k, 3, 3)."""
    jacobians: Floats = np.einsum("ci,kcj->kij", _shape_slopes(place), corners)
    return jacobians


def _strains(slopes: Floats) -> Floats:
    """Return the strains that unit values make, from slopes (k, 3, n), (k, 6, 3 n)."""
    count = slopes.shape[2]
    out = np.zeros((len(slopes), 6, count, 3))
    x, y, z = np.moveaxis(slopes, 1, 0)
    out[:, 0, :, 0], out[:, 1, :, 1], out[:, 2, :, 2] = x, y, z
    out[:, 3, :, 1], out[:, 3, :, 2] = z, y
    out[:, 4, :, 0], out[:, 4, :, 2] = z, x
    out[:, 5, :, 0], out[:, 5, :, 1] = y, x
    return out.reshape(len(slopes), 6, 3 * count)
