"""How the tuned constants of partitions stand: `python -m tests.benchmarks.tuning [--stars 100]`.

Each constant is multiplied by 0.8 and by 1.25, or replaced by its alternatives, all others as they
are, and the relative clearances of the same random stars are printed. A constant is well chosen if
no change makes them better by more than the spread of the sample in most columns.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import numpy as np

from scaffold_cad.partition import dual, matching, partition_spheres, relax
from tests.validation.star_families import drawn

CONSTANTS = (
    (relax, "SHORT_ARC"),
    (relax, "SHORT_ARC_RATIO"),
    (relax, "FLOW_SHARPNESS"),
    (relax, "FLOW_STEP"),
    (relax, "NEWTON_SHARPNESS"),
    (relax, "NEWTON_STEP"),
    (relax, "DAMPING"),
    (dual, "LONG_ARC"),
    (dual, "TINY_ARC"),
    (dual, "WIDE_GAP"),
    (dual, "MANY_ARCS"),
    (dual, "MOST_BURDEN"),
    (dual, "ONCE"),
    (dual, "AGAIN"),
    (matching, "PENALTIES"),
)
ALTERNATIVES = {
    (dual, "ONCE"): ((0.52, 1.02, -0.36),),  # what `tests.benchmarks.gains` fits
    (dual, "AGAIN"): ((0.30, 0.28, 0.0),),
    (matching, "TENURE"): ((1,), (4,), (8,), (1, 1, 1, 2, 2, 3, 5, 8, 14), (2, 3, 5)),
}
"""Other values of constants that are tried: of `TENURE` even ones, the same in order, and few."""
FACTORS = (0.8, 1.25)
VALENCIES = (5, 8, 12, 16)


def scaled(value: Any, factor: float) -> Any:
    """Return a constant, a number or several, times a factor."""
    return tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value


@contextmanager
def replaced(module: ModuleType, name: str, value: Any) -> Iterator[None]:
    """Give a constant another value for a while."""
    before = getattr(module, name)
    setattr(module, name, value)
    try:
        yield
    finally:
        setattr(module, name, before)


def row(title: str, stars: int) -> None:
    """Print the median and the 1 % quantile of each valency."""
    cells = []
    for valency in VALENCIES:
        directions = drawn("uniform", np.random.default_rng(valency), stars, valency)
        found = partition_spheres(directions).relative_clearance
        cells.append(f"{np.median(found):.4f} {np.quantile(found, 0.01):.4f}")
    print(f"{title:<40}" + "   ".join(cells), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stars", type=int, default=100)
    parser.add_argument("names", nargs="*", help="constants, all by default")
    options = parser.parse_args()
    stars = options.stars
    print(f"{'valency':<40}" + "   ".join(f"{valency:<13}" for valency in VALENCIES))
    row("as they are", stars)
    for module, name in dict.fromkeys([*CONSTANTS, *ALTERNATIVES]):
        if options.names and name not in options.names:
            continue
        value = getattr(module, name)
        factors = FACTORS if (module, name) in CONSTANTS else ()
        tried = {f"{name} x {factor:g}": scaled(value, factor) for factor in factors}
        tried |= {f"{name} {other}": other for other in ALTERNATIVES.get((module, name), ())}
        for title, other in tried.items():
            with replaced(module, name, other):
                row(title, stars)


if __name__ == "__main__":
    main()
