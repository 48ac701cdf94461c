"""Units of length, by the names that files and people have for them."""

from __future__ import annotations

from scaffold_cad.base.arguments import as_number, described, did_you_mean
from scaffold_cad.errors import OptionError

MILLIMETERS = {
    "nm": 1e-6,
    "um": 1e-3,
    "mm": 1.0,
    "cm": 10.0,
    "dm": 100.0,
    "m": 1000.0,
    "km": 1e6,
    "in": 25.4,
    "ft": 304.8,
    "yd": 914.4,
    "mil": 0.0254,
}
"""Length of each unit, mm, by its short name."""

_NAMES = {
    "nanometer": "nm",
    "micrometer": "um",
    "micron": "um",
    "µm": "um",
    "μm": "um",
    "millimeter": "mm",
    "centimeter": "cm",
    "decimeter": "dm",
    "meter": "m",
    "kilometer": "km",
    "inch": "in",
    "inches": "in",
    '"': "in",
    "foot": "ft",
    "feet": "ft",
    "yard": "yd",
    "thou": "mil",
}
"""Short names by other names."""


def length_of(name: str) -> float | None:
    """Return the length of a unit, mm, or None if it is not known.

    Examples
    --------
    >>> from scaffold_cad.io._units import length_of
    >>> length_of("Inches"), length_of("metres"), length_of("parsec")
    (25.4, 1000.0, None)
    """
    known = name.strip().lower().replace("metre", "meter")
    for candidate in (known, known.removesuffix("s")):
        short = _NAMES.get(candidate, candidate)
        if short in MILLIMETERS:
            return MILLIMETERS[short]
    return None


def factor_of(units: str | None, scale: float | None) -> float:
    """Return what lengths are multiplied with: mm in one of `units`, times `scale`.

    Raises
    ------
    OptionError
        If the unit is not known, or the scale is not > 0.
    """
    factor = 1.0
    if units is not None:
        known = length_of(units) if isinstance(units, str) else None
        if known is None:
            near = did_you_mean(units, [*MILLIMETERS, *_NAMES])
            short = ", ".join(MILLIMETERS)
            raise OptionError(f"units is {described(units)}; need one of {short}{near}")
        factor = known
    return factor if scale is None else factor * as_number(scale, "scale", unit="")
