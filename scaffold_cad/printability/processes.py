"""What printing processes and materials ask for: limits and densities.

Where a comment names a page, the number was read there. Where it says "not checked", it is a
customary one that was not compared with a source: look it up for your machine and material.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from scaffold_cad.base.arguments import as_number, check_choice, checks_keywords
from scaffold_cad.errors import OptionError


@checks_keywords()
@dataclass(frozen=True)
class Process:
    """The limits of a printing process; `dataclasses.replace` gives one with others."""

    name: str
    """Such as "sls"."""
    least_diameter: float
    """Thinnest strut or wall that comes out whole, mm."""
    least_gap: float
    """Narrowest gap between two struts that stays open, mm."""
    greatest_slenderness: float
    """Length of a strut over its diameter above which it bends or breaks in the making."""
    overhang_angle: float
    """Angle to the plate below which a downward face needs support, rad; 0 where none does."""
    longest_bridge: float
    """Gap between two held places that flat struts cross without support all the same, mm."""
    least_opening: float
    """Narrowest hole through which powder or resin leaves a hollow, mm; 0 where nothing must."""
    layer: float
    """Height of a layer, mm: what lies less above the plate stands on it."""
    build_volume: tuple[float, float, float]
    """Greatest width, depth and height of a part, mm."""

    def __post_init__(self) -> None:
        for field in fields(self)[1:]:
            values = getattr(self, field.name)
            for value in values if isinstance(values, tuple) else (values,):
                name = f"{field.name} of a process"
                as_number(value, name, unit="", or_zero=field.name != "build_volume")
        if not isinstance(self.build_volume, tuple) or len(self.build_volume) != 3:
            raise OptionError(
                f"build_volume of a process is {self.build_volume!r}; need a tuple of 3 numbers"
            )
        if self.overhang_angle > math.pi / 2:
            raise OptionError(
                f"overhang_angle of a process is {self.overhang_angle:g} rad; need at most pi/2"
            )

    @property
    def encloses(self) -> bool:
        """Whether a void without opening keeps powder or resin that must come out."""
        return self.least_opening > 0


# "Rules" is the table of 3D Hubs, Design Rules for 3D Printing: scribd.com/document/739102674.
PROCESSES: dict[str, Process] = {
    # Rules: walls of 0.8 mm, taken for struts, though it asks for pins of 3 mm; gaps of 0.5 mm,
    # 45°, bridges of 10 mm. Layers: bicester3d.co.uk/guides/design-for-3d-printing. Volume: the
    # Original Prusa i3 MK3 in PrusaSlicer 2.5.0. Not checked: slenderness.
    "fdm": Process("fdm", 0.8, 0.5, 20.0, math.radians(45), 10.0, 0.0, 0.2, (250, 210, 210)),
    # Rules: pins of 0.5 mm, gaps of 0.5 mm, though it would support every overhang and asks for
    # openings of 4 mm; 2.5 mm: support.jlcpcb.com/article/170-3d-printing-design-guidelines.
    # Volume and layers: the Form 4 in github.com/VT-DISCO-LAB/Getting-Started-in-the-Discovery-Lab.
    # Not checked: slenderness, angle, bridge.
    "sla": Process("sla", 0.5, 0.5, 15.0, math.radians(45), 2.0, 2.5, 0.05, (200, 125, 210)),
    # Pins 0.8 mm, gaps 0.5 mm: hlhprototypes.com/sls-3d-printing-design-tips; features 0.8 mm and
    # openings of 3.5 mm: addema.se/guides-sls. Powder supports every face.
    # Not checked: slenderness, layer, build volume.
    "sls": Process("sls", 0.8, 0.5, 30.0, 0.0, 0.0, 3.5, 0.11, (165, 165, 300)),
    # 45°, openings of 2 mm, gaps of 0.2 mm (for parts that fit, 0.5 mm for parts that move):
    # arti90.com/en/design-clues. Rules: bridges of 2 mm; walls of 0.4 mm, taken for struts, though
    # it asks for pins of 1 mm. Layers of 40 µm: the EOS M 290 in EOS's data sheet of Ti64 Grade 5.
    # Not checked: slenderness, build volume.
    "lpbf": Process("lpbf", 0.4, 0.2, 20.0, math.radians(45), 2.0, 2.0, 0.04, (250, 250, 325)),
}
"""The presets by name."""


MATERIALS: dict[str, float] = {
    # Generic filaments of PrusaSlicer 2.5.0.
    "pla": 1.24,
    "petg": 1.27,
    "abs": 1.04,
    "tpu": 1.22,
    # additive.tools/materials/pa12, sintered.
    "pa12": 0.93,
    # EOS's data sheets for the M 290: at least that.
    "316l": 7.97,
    "alsi10mg": 2.66,
    # Customary values, not checked against a source.
    "resin": 1.18,
    "ti6al4v": 4.41,
    "in718": 8.15,
}
"""Density of each material by name, g/cm³."""

USUAL_MATERIAL = {"fdm": "pla", "sla": "resin", "sls": "pa12", "lpbf": "ti6al4v"}
"""What each process mostly prints."""


def process_named(process: str | Process) -> Process:
    """Return the preset of that name, or the process given.

    Raises
    ------
    OptionError
        If there is no preset of that name, or it is neither a name nor a process.
    """
    if isinstance(process, Process):
        return process
    check_choice(process, "process", PROCESSES, or_else="a Process")
    return PROCESSES[process]


def density_of(material: str) -> float:
    """Return the density of a material, g/cm³.

    Raises
    ------
    OptionError
        If it is not known.
    """
    check_choice(material, "material", MATERIALS)
    return MATERIALS[material]
