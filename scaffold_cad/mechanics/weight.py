"""Struts under their own weight."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.mechanics.beamstruts import Beams
from scaffold_cad.mechanics.elements import first_by_second, second_end
from scaffold_cad.mechanics.sections import sections_at

EVEN = 1e-9
"""Logarithm of a strut's radii over each other that is taken for 0; no unit."""

_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


def clamped_by_weight(beams: Beams, gravity: Floats) -> Floats:
    """Return the forces on clamped ends of struts under their own weight, (m, 2, 6).

    The strut is a cantilever, held at its first end, that bends under its weight; what brings its
    second end back is the force there. What hangs beyond a place is a frustum.

    Parameters
    ----------
    gravity : (3,) float64, acceleration, m/s²
    """
    lengths = beams.skeleton.lengths[:, None]
    directions = beams.skeleton.directions[::2]
    along = gravity @ directions.T  # (m,)
    across = gravity - along[:, None] * directions  # (m, 3)
    place, step = _sampled(beams)  # (m, s)
    section = sections_at(beams.edge_radii, place / lengths, beams.hollow)
    lever, near, far = lengths - place, section.radius, beams.edge_radii[:, 1:]
    frustum = np.pi * (1.0 - beams.hollow**2) * beams.material.density * 1e-9 * lever
    beyond = frustum / 3.0 * (near**2 + near * far + far**2)  # kg
    moment = frustum * lever / 12.0 * (near**2 + 2.0 * near * far + 3.0 * far**2)  # kg mm
    material = beams.material
    bending = material.young * section.inertia
    shear = material.shear_factor(beams.hollow) * material.shear_modulus * section.area
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


def _sampled(beams: Beams) -> tuple[Floats, Floats]:
    """Return places along what deforms of struts, and the lengths they stand for, (m, s), mm.

    From one to the next radii grow by a factor: that is how fast a cone's stiffness changes.
    """
    lengths = beams.skeleton.lengths[:, None]
    start, stop = beams.rigid[:, :1], lengths - beams.rigid[:, 1:]
    ends = np.concatenate([start, stop], axis=1) / lengths
    radius = sections_at(beams.edge_radii, ends, beams.hollow).radius
    growth = np.log(radius[:, 1:] / radius[:, :1])
    growth = np.where(np.abs(growth) < EVEN, EVEN, growth)
    part = (1.0 + _PLACES) / 2.0
    scale = (stop - start) / np.expm1(growth)
    place = start + scale * np.expm1(growth * part)
    return place, scale * growth * np.exp(growth * part) * _WEIGHTS / 2.0
