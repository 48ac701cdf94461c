"""Round sections, full or hollow, along struts whose radius changes evenly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.materials import Material


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
    its second end makes, in closed form; those of a plane are inverted. With the radius a u +
    b (1 - u) the integrals over u in 0..1 of u²/r⁴, u (1 - u)/r⁴ and 1/r² are 1/(3 a³ b),
    1/(6 a² b²) and 1/(a b), all by Feynman's formula.

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
    length = lengths - rigid.sum(axis=1)  # of what deforms
    share = np.stack([rigid[:, 0] / lengths, 1.0 - rigid[:, 1] / lengths], axis=1)
    a, b = sections_at(edge_radii, share, hollow).radius.T
    area = np.pi * (1.0 - hollow**2)  # over r²
    inertia = np.pi / 4.0 * (1.0 - hollow**4)  # over r⁴
    per_area = length / (area * a * b)
    # Of u (1 - u)/I, u²/I and (1 - u)²/I; a load at the second end has the lever
    # u length + what is rigid there.
    middle = length / (inertia * 6.0 * a * a * b * b)
    near, far = middle * 2.0 * b / a, middle * 2.0 * a / b
    once, whole, end = near + middle, near + 2.0 * middle + far, rigid[:, 1]
    shearing = per_area / (material.shear_factor(hollow) * material.shear_modulus)
    by_force = (length**2 * near + 2.0 * length * end * once + end**2 * whole) / material.young
    by_force += shearing
    both = (length * once + end * whole) / material.young
    by_moment = whole / material.young
    # by_force by_moment - both², with near far = 4 middle².
    determinant = 3.0 * (length * middle / material.young) ** 2 + shearing * by_moment
    return Stiffnesses(
        axial=material.young / per_area,
        twisting=2.0 * material.shear_modulus / whole,
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
