"""Struts under their own weight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.mechanics.elements import first_by_second, second_end
from scaffold_cad.mechanics.sections import GAUSS_PLACES, GAUSS_WEIGHTS, sections_at

if TYPE_CHECKING:
    from scaffold_cad.mechanics.beams import BeamModel


def clamped_by_weight(model: BeamModel) -> Floats:
    """Return the forces on clamped ends of struts under their own weight, (m, 2, 6).

    The strut is a cantilever, held at its first end, that bends under its weight; what brings its
    second end back is the force there. All integrals are exact but for the taper's fractions.
    """
    lengths = model.skeleton.lengths[:, None]
    directions, gravity = model.skeleton.directions[::2], model.gravity
    along = gravity @ directions.T  # (m,)
    across = gravity - along[:, None] * directions  # (m, 3)
    start, stop = model.rigid[:, :1], lengths - model.rigid[:, 1:]
    place = start + (stop - start) * GAUSS_PLACES  # (m, s)
    step = (stop - start) * GAUSS_WEIGHTS
    section = sections_at(model.edge_radii, place / lengths, model.hollow)
    # Mass beyond each place, and its first moment about the place: again by Gauss's rule.
    inner = place[:, :, None] + (lengths - place)[:, :, None] * GAUSS_PLACES  # (m, s, s)
    weights = (lengths - place)[:, :, None] * GAUSS_WEIGHTS
    a, b = model.edge_radii.T[:, :, None, None]
    radius = a + (b - a) * inner / lengths[:, :, None]
    by_length = np.pi * radius**2 * (1.0 - model.hollow**2) * model.material.density * 1e-9
    beyond = (weights * by_length).sum(axis=2)  # kg
    moment = (weights * by_length * (inner - place[:, :, None])).sum(axis=2)  # kg mm
    material = model.material
    bending = material.young * section.inertia
    shear = material.shear_factor(model.hollow) * material.shear_modulus * section.area
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
    second = -np.einsum("mij,mj->mi", second_end(directions, model.stiffnesses), free)
    masses = model.masses
    r0, r1 = model.edge_radii.T
    # Center of mass of a cone's frustum, from the first end.
    center = (r0**2 + 2 * r0 * r1 + 3 * r1**2) / (4 * (r0**2 + r0 * r1 + r1**2))
    weight = masses[:, None] * gravity
    turning = np.cross(center[:, None] * model.spans, weight)
    first = np.einsum("mij,mj->mi", first_by_second(model.spans), second)
    first[:, :3] -= weight
    first[:, 3:] -= turning
    return np.stack([first, second], axis=1)
