"""How blends are fitted: the ways that are tried in turn until one is proved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats
from scaffold_cad.struts.blending.layouts import Layout

RAY_STEPS = 2
"""Newton steps along rays from the node to arcs."""
FIRST_STEPS = 1
"""Newton steps of the first samples; one step a round follows."""


@dataclass(frozen=True)
class Stage:
    """Rounds of a fit with patches that are cut and sampled in one way."""

    layout: Layout
    """How patches are cut and sampled."""
    rounds: tuple[tuple[float, int], ...]
    """Weights of the thin-plate energy, and for how many rounds each.

    Stiff rounds first: there the samples slide along the surface until patches are even.
    """
    lifted: bool = False
    """Whether samples that are deep inside a strut are lifted, see `AIM`: once patches are even."""


@dataclass(frozen=True)
class Recipe:
    """One way to fit a blend."""

    stages: tuple[Stage, ...]
    """What is done in turn, each beginning where the one before has ended."""
    openness: float
    """Weight of the pull of the partition's vertices away from near struts."""
    pinch: float = 0.5
    """Whether patches start from the collar, in its middle, as fast as they are long along the
    strut (1) or in a straight line (0)."""
    swell: float = 1.0
    """Factor of ρ. More than 1 only where nothing else is proved: wide fillets fold less."""
    momentum: float = 0.7
    """Part of its last move that a sample goes on along the surface."""
    kept: int = 1
    """Rounds for which samples are held against the same planes: 2 where they move little."""
    least: float = 0.0
    """Fillet radius from which on it is tried, in radii of the thinnest strut."""
    most: float = np.inf
    """Fillet radius up to which it is tried."""
    urge: float = 0.5
    """How much further samples inside the union are moved than those outside; stable below 1."""

    def suits(self, fillets: Floats) -> Bools:
        """Return for which fillets (M,) it is tried, in radii of the thinnest strut, (M,)."""
        return np.asarray((fillets >= self.least) & (fillets <= self.most))

    @property
    def layout(self) -> Layout:
        """How the patches of the blend are cut."""
        return self.stages[-1].layout

    @property
    def is_fitted(self) -> bool:
        """Whether anything is fitted; patches are straight from arcs to collars if not."""
        return any(stage.rounds for stage in self.stages)

    @property
    def samples(self) -> int:
        """Most samples of a patch."""
        return max(len(stage.layout.weights) for stage in self.stages)


# What each recipe and the numbers of the first are for: `python -m tests.benchmarks.recipes`.
WHOLE, DENSE = Layout(1, 1, 5), Layout(1, 1, 7)
CUT, FINE = Layout(2, 2, 4), Layout(4, 4, 4)
SHORT = (
    Stage(WHOLE, ((1e-2, 1), (1e-3, 5), (1e-4, 5))),
    Stage(DENSE, ((1e-5, 3), (1e-6, 3)), lifted=True),
)
STIFF = ((1e-2, 1), (1e-3, 5), (1e-4, 10), (1e-5, 8))
COARSE = ((1e-3, 6), (1e-4, 8), (1e-5, 6))
LONG = ((1e-4, 6), (1e-3, 4), (1e-4, 10), (1e-5, 8), (1e-6, 6))
"""For struts that part late: at first soft, or stiff patches pull the far side of the node in."""
SOFT = ((1e-4, 8), (1e-5, 8))
STIFFER = ((1e-3, 4), *SOFT)
"""For many small pieces, which begin with a surface that is nearly right."""

TIGHT = 0.01
"""Fillet radius, in radii of the thinnest strut, below which it is as good as an edge: there the
costly recipes take two thirds of the time and prove one node in six."""
SPARE = 0.06
"""Fillet radius below which patches cut in two prove few nodes (4 of 102 random ones, with which
those cut in four do as well) and take a fifth of the time."""
WIDE = 3.0
"""Fillet radius above which what the first recipe leaves unproved no other one proves (0 of 149
random nodes of 3 to 6 struts, `python -m tests.benchmarks.recipes --blend 5`)."""

RECIPES = (
    Recipe(SHORT, 0.3, kept=2),
    Recipe((Stage(WHOLE, STIFF),), 0.15, pinch=1.0, most=WIDE),
    Recipe((Stage(WHOLE, LONG),), 0.0, pinch=1.0, most=WIDE),
    Recipe((Stage(CUT, COARSE),), 0.15, pinch=1.0, least=SPARE, most=WIDE),
    Recipe((Stage(WHOLE, LONG), Stage(FINE, SOFT)), 0.0, pinch=1.0, least=TIGHT, most=WIDE),
    Recipe(
        (Stage(WHOLE, LONG), Stage(FINE, SOFT)), 0.0, pinch=1.0, swell=1.6, least=TIGHT, most=WIDE
    ),
    Recipe(
        (Stage(WHOLE, LONG), Stage(FINE, STIFFER)),
        0.15,
        pinch=1.0,
        swell=1.6,
        least=TIGHT,
        most=WIDE,
    ),
)
"""Tried in this order, each for the nodes that the ones before left unproved, deep inside or
bulging, and whose fillets it suits."""

ROUGH = (Stage(WHOLE, ()),)
"""What is done where nothing has room: patches are straight from arcs to collars."""

FINER = (
    (Stage(Layout(2, 2, 5), ((1e-5, 4),), lifted=True), np.inf),
    (Stage(Layout(2, 4, 5), ((1e-5, 8),), lifted=True), WIDE),
    (Stage(FINE, ((3e-5, 16),), lifted=True), WIDE),
)
"""What is tried in turn for blends that are proved but deep inside a strut or bulge, each beginning
with them, and up to which fillet radius in radii of the thinnest strut. The patch of a thin strut
beside thick ones is long and has its fillet at one end: one polynomial along it cuts into the strut
on the way. Soft patches have the best fit but fold first.
"""

MOST_DEPTH = 0.02
"""Depth inside a strut, over its radius, above which more is tried."""
MOST_BULGE = 0.2
"""Distance outside the filleted union, over the least radius, above which more is tried."""
AIM = 0.006
"""Such a depth to which samples are lifted: between them it is more."""
