"""Stresses in struts of round section from the forces at their ends."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.mechanics.sections import sections_at

STATIONS = np.linspace(0.0, 1.0, 5)
"""Places along a strut at which its section's stress is computed, besides those of `_worst`."""

TOWARDS_THIN = np.array([0.0, 0.4, 0.7])
"""Places from where bending is worst to the thin end of a cone, as parts of that length."""


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
    inner = np.stack([-end_forces[:, 0], end_forces[:, 1]], axis=1)  # (m, 2, 6)
    even = np.broadcast_to(STATIONS, (len(spans), len(STATIONS)))
    stations = np.concatenate([even, _worst(inner[:, :, 3:], directions, edge_radii)], axis=1)
    section = sections_at(edge_radii, stations, hollow)  # (m, s)
    place = stations[:, :, None]
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


def _worst(moments: Floats, directions: UnitVectors, edge_radii: Floats) -> Floats:
    """Return where bending and twisting strain cones most, and places next to it, (m, s) in 0..1.

    The square of their stress at the rim is a quadratic over the radius to the sixth, whose slope
    is 0 at the roots of a quadratic.

    Parameters
    ----------
    moments : (m, 2, 3) float64, at both ends
    """
    start, change = moments[:, 0], moments[:, 1] - moments[:, 0]
    # A moment t along the axis strains as sqrt(3)/2 of it across: m² less t²/4.
    turn, turned = dot(start, directions), dot(change, directions)
    once = dot(start, start) - turn**2 / 4
    twice = 2.0 * dot(start, change) - turn * turned / 2
    thrice = dot(change, change) - turned**2 / 4
    radius, growth = edge_radii[:, 0], edge_radii[:, 1] - edge_radii[:, 0]
    square = -4.0 * growth * thrice
    line = 2.0 * thrice * radius - 5.0 * growth * twice
    rest = twice * radius - 6.0 * growth * once
    root = np.sqrt(np.maximum(line**2 - 4.0 * square * rest, 0.0))
    far = -(line + np.copysign(root, line)) / 2.0
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.stack([far / square, rest / far], axis=1)
    worst = np.clip(np.nan_to_num(places), 0.0, 1.0)  # (m, 2)
    thin = np.where(growth < 0, 1.0, 0.0)
    # An axial force moves the place towards the thin end.
    between = worst + TOWARDS_THIN[:, None, None] * (thin[:, None] - worst)  # (t, m, 2)
    return np.concatenate(between, axis=1)
