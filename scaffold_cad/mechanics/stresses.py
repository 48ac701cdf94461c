"""Stresses in struts of round section from the forces at their ends."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.mechanics.sections import sections_at

STATIONS = np.linspace(0.0, 1.0, 5)
"""Places along a strut at which its section's stress is computed."""


def largest_stresses(
    end_forces: Floats, spans: Points, directions: UnitVectors, edge_radii: Floats, hollow: float
) -> Floats:
    """Return the largest von Mises stress in each strut, (m,), MPa.

    At the rim bending and axial force meet twisting; on the neutral axis the axial force meets
    twisting and the shear force, 4/3 of its mean in a full circle and 2 in a thin tube. Forces
    between the ends run evenly from one to the other, own weight included.

    Parameters
    ----------
    end_forces : (m, 2, 6) float64, on the strut, N and N mm
    spans, directions : (m, 3) float64
    edge_radii : (m, 2) float64, mm
    hollow : inner over outer radius
    """
    section = sections_at(edge_radii, STATIONS, hollow)  # (m, s)
    place = STATIONS[None, :, None]
    inner = np.stack([-end_forces[:, 0], end_forces[:, 1]], axis=1)  # (m, 2, 6)
    force = inner[:, None, 0, :3] * (1 - place) + inner[:, None, 1, :3] * place  # (m, s, 3)
    # Balance about the station: the first end's moment and force, and half the weight's bow.
    weight = end_forces[:, 0, :3] + end_forces[:, 1, :3]  # (m, 3), minus the weight
    bow = np.cross(spans, weight)[:, None] * (place * (1 - place) / 2)
    straight = inner[:, None, 0, 3:] * (1 - place) + inner[:, None, 1, 3:] * place
    moment = straight + bow
    axis = np.broadcast_to(directions[:, None], moment.shape)
    axial, twisting = np.abs(dot(force, axis)), np.abs(dot(moment, axis))
    shear = length(force - dot(force, axis)[..., None] * axis)
    bending = length(moment - dot(moment, axis)[..., None] * axis)
    normal = axial / section.area
    by_twist = twisting * section.radius / section.torsion
    across = (4.0 / 3.0) * (1.0 + hollow + hollow**2) / (1.0 + hollow**2)
    rim = np.hypot(normal + bending * section.radius / section.inertia, np.sqrt(3) * by_twist)
    middle = np.hypot(normal, np.sqrt(3) * (by_twist + across * shear / section.area))
    largest: Floats = np.maximum(rim, middle).max(axis=1)
    return largest
