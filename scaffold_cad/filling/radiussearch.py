"""The radius at which a measured density is the one wanted, with few measurements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from scaffold_cad.errors import OptionError
from scaffold_cad.filling.innercell import Capsules

DENSITY_ACCURACY = 1e-3
"""Relative difference from the wanted density at which a radius is good enough."""

NEAR = 0.01
"""The same for the largest density that is reached, where it is jumped over."""

LARGEST_STEPS = 30
"""Densities measured before the search for a radius is given up."""

SLOPES = (0.5, 2.0)
"""Least and greatest growth of the measured density, as a power of the estimated one's, but where
it jumps, as voids close."""

FILLED = 1.0 - 1e-9
"""Density from which on a cell counts as full."""

Tried: TypeAlias = tuple[float, float]
"""A radius, mm, and its density."""


@dataclass(frozen=True)
class Found:
    """The radius with the density wanted, or that with the largest one below it."""

    wanted: float
    """Density wanted."""
    radius: float
    """Mm."""
    density: float
    """Its density."""
    beyond: Tried | None
    """The next larger radius tried, where the density wanted is jumped over; else none."""

    @property
    def accuracy(self) -> float:
        """Relative difference from `density` at which another one is the same."""
        return DENSITY_ACCURACY if self.beyond is None else NEAR

    def radius_or_raise(self) -> float:
        """Return the radius with the density wanted.

        Raises
        ------
        OptionError
            If there is none: the densities beside are named.
        """
        if self.beyond is None:
            return self.radius
        radius, density = self.beyond
        raise OptionError(
            f"no radius gives relative density {self.wanted:g}, as voids between struts close: "
            f"struts of {self.radius:.5g} mm give {self.density:.3g}, of {radius:.5g} mm "
            f"{density:.3g}; need {self.density:.3g} or less"
        )


def found_radius(
    density: Callable[[float], float],
    wanted: float,
    estimate: Capsules,
    first: float | None = None,
) -> Found:
    """Return the radius with the density wanted, or what is beside where it is jumped over.

    The measured density is a slowly varying multiple of the estimated one: secant steps on the
    logarithm of the one against that of the other are almost right from the first.

    Parameters
    ----------
    density : measures that of a radius, mm
    first : radius tried first, mm; by default the estimated one

    Raises
    ------
    OptionError
        If the density is neither reached nor jumped over.
    """
    # The largest radius tried that is too thin, and the least that is too thick.
    thin, thick = (estimate.radii[0], 0.0), (np.inf, np.inf)
    slope, before = 1.0, (np.nan, np.nan)
    radius = estimate.radius(wanted) if first is None else first
    for _ in range(LARGEST_STEPS):
        found = density(radius)
        ratio = found / wanted
        if abs(ratio - 1) <= DENSITY_ACCURACY:
            return Found(wanted, radius, found, None)
        if ratio < 1:
            thin = max(thin, (radius, found))
        else:
            thick = min(thick, (radius, found))
        if _is_jumped_over(thin, thick, wanted, estimate):
            return Found(wanted, *thin, thick)
        here = (np.log(estimate.density(radius)), np.log(ratio))
        secant = (here[1] - before[1]) / (here[0] - before[0])
        slope = float(np.clip(secant, *SLOPES)) if np.isfinite(secant) else slope
        following = estimate.radius(float(np.exp(here[0] - here[1] / slope)))
        if thin[1] > 0 and (found > FILLED or not thin[0] < following < thick[0]):
            following = float(np.sqrt(thin[0] * min(thick[0], estimate.radii[1])))
        if following == radius:
            break
        radius, before = following, here
    raise OptionError(
        f"no radius gives relative density {wanted:g}: "
        f"the last one tried, {radius:g} mm, gives {wanted * ratio:.3g}; need a density that "
        "struts of these cells have"
    )


def _is_jumped_over(thin: Tried, thick: Tried, wanted: float, estimate: Capsules) -> bool:
    """Return whether two radii are so near that no density between theirs is reached."""
    if thin[1] == 0 or thick[1] == np.inf:  # not tried yet
        return False
    growth = (estimate.density(thick[0]) / estimate.density(thin[0])) ** SLOPES[1]
    return bool(thin[1] * growth < wanted < thick[1] / growth)
