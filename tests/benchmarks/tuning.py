"""How the tuned constants of partitions stand: `python -m tests.benchmarks.tuning [--stars 100]`.

Each constant is multiplied by 0.8 and by 1.25, all others as they are, and the relative
clearances of the same random stars are printed. A constant is well chosen if neither change makes
them better by more than the spread of the sample in most columns.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

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
    (matching, "PENALTIES"),
)
FACTORS = (0.8, 1.25)
VALENCIES = (5, 8, 12, 16)


@contextmanager
def scaled(module: ModuleType, name: str, factor: float) -> Iterator[None]:
    """Multiply a constant, a number or several, for a while."""
    value = getattr(module, name)
    several = isinstance(value, tuple)
    setattr(module, name, tuple(factor * v for v in value) if several else factor * value)
    try:
        yield
    finally:
        setattr(module, name, value)


def row(title: str, stars: int) -> None:
    """Print the median and the 1 % quantile of each valency."""
    cells = []
    for valency in VALENCIES:
        directions = drawn("uniform", np.random.default_rng(valency), stars, valency)
        found = partition_spheres(directions).relative_clearance
        cells.append(f"{np.median(found):.4f} {np.quantile(found, 0.01):.4f}")
    print(f"{title:<28}" + "   ".join(cells), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stars", type=int, default=100)
    stars = parser.parse_args().stars
    print(f"{'valency':<28}" + "   ".join(f"{valency:<13}" for valency in VALENCIES))
    row("as they are", stars)
    for module, name in CONSTANTS:
        for factor in FACTORS:
            with scaled(module, name, factor):
                row(f"{name} x {factor:g}", stars)


if __name__ == "__main__":
    main()
