"""Round sections, full or hollow, along struts whose radius changes evenly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.materials import Material

_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
GAUSS_PLACES = (1.0 + _PLACES) / 2.0
"""Places in 0..1 at which a strut is sampled to integrate along it."""
GAUSS_WEIGHTS = _WEIGHTS / 2.0
"""Their weights, which add up to 1."""


@dataclass(frozen=True, eq=False)
class Sections:
    """Properties of round sections, arrays of one shape."""

    radius: Floats
    """Outer radius, mm."""
    area: Floats
    """mm²."""
    inertia: Floats
    """Second moment of area about any diameter, mm⁴; the polar one is twice it."""

    @property
    def torsion(self) -> Floats:
        """Torsion constant, mm⁴: that of a circle is its polar moment of area."""
        return 2.0 * self.inertia


def sections_at(edge_radii: Floats, places: Floats, hollow: float) -> Sections:
    """Return the sections at `places` (s,) in 0..1 along struts.

    Parameters
    ----------
    edge_radii : (m, 2) float64, mm
    places : (s,) or (m, s) float64
    hollow : inner over outer radius
    """
    radius = edge_radii[:, :1] * (1.0 - places) + edge_radii[:, 1:] * places  # (m, s)
    return Sections(
        radius,
        np.pi * radius**2 * (1.0 - hollow**2),
        np.pi / 4.0 * radius**4 * (1.0 - hollow**4),
    )


@dataclass(frozen=True, eq=False)
class Stiffnesses:
    """Stiffness of a strut's second end while the first one is held, each of shape (m,)."""

    axial: Floats
    """Force along the strut by displacement, N/mm."""
    twisting: Floats
    """Moment along the strut by rotation, N mm."""
    shear: Floats
    """Force across the strut by displacement, N/mm."""
    coupling: Floats
    """Moment by displacement across, N; also force across by rotation."""
    bending: Floats
    """Moment across the strut by rotation, N mm."""


def end_stiffnesses(
    lengths: Floats, edge_radii: Floats, material: Material, hollow: float, rigid: Floats
) -> Stiffnesses:
    """Return the stiffnesses of Timoshenko beams, exact for even and tapered sections.

    The flexibilities are integrals along the strut of the moments and forces that a unit load at
    its second end makes; those of a plane are inverted.

    Parameters
    ----------
    lengths : (m,) float64, mm
    edge_radii : (m, 2) float64, mm
    hollow : inner over outer radius
    rigid : (m, 2) float64, mm; length at each end that does not deform

    References
    ----------
    Przemieniecki, Theory of Matrix Structural Analysis, 1968, section 5.6 (even sections).
    """
    start, stop = rigid[:, :1], lengths[:, None] - rigid[:, 1:]  # (m, 1)
    along = start + (stop - start) * GAUSS_PLACES  # (m, s)
    section = sections_at(edge_radii, along / lengths[:, None], hollow)
    lever = lengths[:, None] - along  # to the second end
    step = (stop - start) * GAUSS_WEIGHTS
    bending = material.young * section.inertia
    shear = material.shear_factor(hollow) * material.shear_modulus * section.area
    by_force = (step * (lever**2 / bending + 1.0 / shear)).sum(axis=1)
    both = (step * lever / bending).sum(axis=1)
    by_moment = (step / bending).sum(axis=1)
    determinant = by_force * by_moment - both**2
    return Stiffnesses(
        axial=1.0 / (step / (material.young * section.area)).sum(axis=1),
        twisting=1.0 / (step / (material.shear_modulus * section.torsion)).sum(axis=1),
        shear=by_moment / determinant,
        coupling=-both / determinant,
        bending=by_force / determinant,
    )


def as_hollow(value: float) -> float:
    """Return the inner over the outer radius of sections, 0 or more and less than 1."""
    ratio = as_number(value, "hollow", unit="", or_zero=True)
    if not ratio < 1:
        raise OptionError(f"hollow is {ratio:g}; need 0 or more, less than 1")
    return ratio


def volumes(lengths: Floats, edge_radii: Floats, hollow: float) -> Floats:
    """Return the volume of each strut counted from node to node, (m,), mm³."""
    a, b = edge_radii.T
    volume: Floats = np.pi / 3.0 * lengths * (a * a + a * b + b * b) * (1.0 - hollow**2)
    return volume


def euler_loads(
    lengths: Floats, edge_radii: Floats, material: Material, hollow: float, effective_length: float
) -> Floats:
    """Return the compression at which each strut buckles by itself, (m,), N.

    Exact for even struts and full cones that are hinged at both ends (`effective_length` 1).

    References
    ----------
    Timoshenko and Gere, Theory of Elastic Stability, 1961, section 2.12.
    """
    inertia = np.pi / 4.0 * edge_radii.prod(axis=1) ** 2 * (1.0 - hollow**4)
    load: Floats = np.pi**2 * material.young * inertia / (effective_length * lengths) ** 2
    return load
