"""Material: what a strut is made of, in N, mm and MPa; and a few known by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arguments import (
    as_number,
    as_real,
    check_choice,
    check_kind,
    checks_keywords,
)
from scaffold_cad.errors import OptionError

STIFFEST = 1e9
"""Largest Young's modulus that is believed, MPa; its inverse is the least. Diamond has 1e6."""


@checks_keywords()
@dataclass(frozen=True)
class Material:
    """An isotropic linear elastic material.

    Raises
    ------
    OptionError
        If a number is out of its range.

    Examples
    --------
    >>> Material(young=210e3, poisson=0.3, density=7850).shear_modulus
    80769.23076923077
    """

    young: float
    """Young's modulus, MPa."""
    poisson: float = 0.3
    """Poisson's ratio, more than -1 and less than 0.5."""
    density: float = 0.0
    """Mass by volume, kg/m³."""
    strength: float = float("inf")
    """Stress that no strut may exceed (yield stress over the safety factor), MPa."""
    name: str = ""
    """What it is called."""

    def __post_init__(self) -> None:
        young = as_number(self.young, "Young's modulus", unit=" MPa")
        if not 1.0 / STIFFEST <= young <= STIFFEST:
            raise OptionError(
                f"Young's modulus is {young:g} MPa; need {1.0 / STIFFEST:g} to {STIFFEST:g} MPa"
            )
        as_number(self.density, "density", unit=" kg/m³", or_zero=True)
        if not as_real(self.strength, "strength") > 0:
            raise OptionError(f"strength is {self.strength:g} MPa; need > 0")
        if not -1 < as_real(self.poisson, "Poisson's ratio") < 0.5:
            raise OptionError(
                f"Poisson's ratio is {self.poisson:g}; need more than -1, less than 0.5"
            )

    @property
    def shear_modulus(self) -> float:
        """Shear modulus, MPa."""
        return self.young / (2.0 * (1.0 + self.poisson))

    def shear_factor(self, hollow: float = 0.0) -> float:
        """Return the shear factor of a round section.

        Parameters
        ----------
        hollow : inner over outer radius, 0 for a full section

        References
        ----------
        Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33, 1966.
        """
        nu, square = self.poisson, hollow**2
        ring = (1.0 + square) ** 2
        factor = 6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * square)
        return float(np.minimum(factor, 1.0))


MATERIALS = {
    material.name: material
    for material in (
        Material(210e3, 0.30, 7850.0, 235.0, "steel"),
        Material(193e3, 0.30, 7990.0, 205.0, "stainless"),
        Material(70e3, 0.33, 2680.0, 200.0, "aluminum"),
        Material(114e3, 0.34, 4430.0, 830.0, "titanium"),
        Material(1.7e3, 0.39, 1010.0, 45.0, "pa12"),
        Material(3.3e3, 0.35, 1240.0, 50.0, "pla"),
        Material(2.1e3, 0.38, 1270.0, 45.0, "petg"),
        Material(2.2e3, 0.35, 1040.0, 38.0, "abs"),
    )
}
"""Round numbers for drafts (S235, 316L, AlSi10Mg, Ti-6Al-4V, nylon of a powder bed, printed
plastics along their layers): take those of the data sheet for parts that carry something."""


def as_material(material: Material | str) -> Material:
    """Return `material`, looked up if it is a name."""
    if isinstance(material, str):
        name = material.strip().lower()
        check_choice(name, "material", MATERIALS, or_else="a Material")
        return MATERIALS[name]
    check_kind(material, Material, "name of one", name="material")
    return material
