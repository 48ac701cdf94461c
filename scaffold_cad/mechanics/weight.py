"""Struts under their own weight."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.mechanics.beamstruts import Beams
from scaffold_cad.mechanics.elements import first_by_second, second_end
from scaffold_cad.mechanics.sections import GAUSS_PLACES, GAUSS_WEIGHTS, sections_at


def clamped_by_weight(beams: Beams, gravity: Floats) -> Floats:
    """Return the forces on clamped ends of struts under their own weight, (m, 2, 6).

    The strut is a cantilever, held at its first end, that bends under its weight; what brings its
    second end back is the force there. All integrals are exact but for the taper's fractions.

    Parameters
    ----------
    gravity : (3,) float64, acceleration, m/s²
    """
    lengths = beams.skeleton.lengths[:, None]
    directions = beams.skeleton.directions[::2]
    along = gravity @ directions.T  # (m,)
    across = gravity - along[:, None] * directions  # (m, 3)
    start, stop = beams.rigid[:, :1], lengths - beams.rigid[:, 1:]
    place = start + (stop - start) * GAUSS_PLACES  # (m, s)
    step = (stop - start) * GAUSS_WEIGHTS
    section = sections_at(beams.edge_radii, place / lengths, beams.hollow)
    # Mass beyond each place, and its first moment about the place: again by Gauss's rule.
    inner = place[:, :, None] + (lengths - place)[:, :, None] * GAUSS_PLACES  # (m, s, s)
    weights = (lengths - place)[:, :, None] * GAUSS_WEIGHTS
    a, b = beams.edge_radii.T[:, :, None, None]
    radius = a + (b - a) * inner / lengths[:, :, None]
    by_length = np.pi * radius**2 * (1.0 - beams.hollow**2) * beams.material.density * 1e-9
    beyond = (weights * by_length).sum(axis=2)  # kg
    moment = (weights * by_length * (inner - place[:, :, None])).sum(axis=2)  # kg mm
    material = beams.material
    bending = material.young * section.inertia
    shear = material.shear_factor(beams.hollow) * material.shear_modulus * section.area
    lever = lengths - place
    stretch = (step * beyond / (material.young * section.area)).sum(axis=1) * along
    sag = (step * (moment * lever / bending + beyond / shear)).sum(axis=1)
    tilt = (step * moment / bending).sum(axis=1)
    free = np.concatenate(
        [
            stretch[:, None] * directions + sag[:, None] * across,
            tilt[:, None] * np.cross(directions, across),
        ],
        axis=1,
    )
    second = -np.einsum("mij,mj->mi", second_end(directions, beams.stiffnesses), free)
    masses = beams.masses
    r0, r1 = beams.edge_radii.T
    # Center of mass of a cone's frustum, from the first end.
    center = (r0**2 + 2 * r0 * r1 + 3 * r1**2) / (4 * (r0**2 + r0 * r1 + r1**2))
    weight = masses[:, None] * gravity
    turning = np.cross(center[:, None] * beams.spans, weight)
    first = np.einsum("mij,mj->mi", first_by_second(beams.spans), second)
    first[:, :3] -= weight
    first[:, 3:] -= turning
    return np.stack([first, second], axis=1)
