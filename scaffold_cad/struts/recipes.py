"""How blends are fitted: the ways that are tried in turn until one is proved."""

from __future__ import annotations

from dataclasses import dataclass

from scaffold_cad.struts.layouts import Layout

RAY_STEPS = 4
"""Newton steps along rays from the node to arcs."""
FIRST_STEPS = 2
"""Newton steps of the first samples; one step a round follows."""


@dataclass(frozen=True)
class Recipe:
    """One way to fit a blend."""

    layout: Layout
    """How patches are cut and sampled."""
    rounds: tuple[tuple[float, int], ...]
    """Weights of the thin-plate energy, and for how many rounds each.

    Stiff rounds first: there the samples slide along the surface until patches are even.
    """
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
    urge: float = 0.5
    """How much further samples inside the union are moved than those outside; stable below 1."""


WHOLE = Layout(1, 1, 5)
CUT = Layout(2, 2, 4)
SHORT = ((1e-2, 1), (1e-3, 5), (1e-4, 5), (1e-5, 3), (1e-6, 3))
STIFF = ((1e-2, 1), (1e-3, 5), (1e-4, 10), (1e-5, 8))
COARSE = ((1e-3, 6), (1e-4, 8), (1e-5, 6))
LONG = ((1e-4, 6), (1e-3, 4), (1e-4, 10), (1e-5, 8), (1e-6, 6))
"""For struts that part late: at first soft, or stiff patches pull the far side of the node in."""

RECIPES = (
    Recipe(WHOLE, SHORT, 0.3, kept=2),
    Recipe(WHOLE, STIFF, 0.15, pinch=1.0),
    Recipe(WHOLE, LONG, 0.0, pinch=1.0),
    Recipe(CUT, COARSE, 0.3),
    Recipe(CUT, COARSE, 0.15, pinch=1.0),
    Recipe(CUT, LONG, 0.0, pinch=1.0),
    Recipe(WHOLE, STIFF, 0.15, pinch=1.0, swell=1.25),
    Recipe(CUT, COARSE, 0.15, pinch=1.0, swell=1.25),
    Recipe(WHOLE, STIFF, 0.15, pinch=1.0, swell=1.6),
    Recipe(CUT, COARSE, 0.15, pinch=1.0, swell=1.6),
)
"""Tried in this order, each for the nodes that the ones before left unproved or deep inside."""

MOST_DEPTH = 0.02
"""Depth inside a strut, over its radius, above which another recipe is tried."""
