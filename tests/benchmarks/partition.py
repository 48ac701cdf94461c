"""How good and how fast partitions are: `python -m tests.benchmarks.partition [--stars 200]`.

Quality is the relative clearance: its median, 1 % quantile and worst, for each valency. Cost is
processor time a star, of many at once and of all valencies that a graph mixes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from scipy.spatial import Voronoi

from scaffold_cad.partition import Partitions, certify, partition_spheres
from scaffold_cad.partition.arcs import arc_counts
from scaffold_cad.partition.insertion import insertion_partitions
from tests.validation.star_families import FAMILIES, Stars, drawn

VALENCIES = (3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24)
STEPS = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
LATTICES = {
    "simple cubic": STEPS[np.abs(STEPS).sum(axis=1) == 1],
    "octet": STEPS[np.abs(STEPS).sum(axis=1) == 2],
    "bcc": STEPS[np.abs(STEPS).sum(axis=1) == 3],
    "diamond": np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]),
    "bcc + simple cubic": STEPS[np.abs(STEPS).sum(axis=1) % 2 == 1],
    "all 26 neighbors": STEPS[STEPS.any(axis=1)],
}


def quality(stars: int, families: list[str]) -> None:
    """Print the relative clearance of random stars."""
    print("family          valency  median   1 %   worst  most arcs  ms per star")
    for family in families:
        for valency in VALENCIES:
            found, seconds = timed(family, stars, valency, "dual")
            clearance = found.relative_clearance
            arcs = arc_counts(found.quads).max(axis=1).mean()
            print(
                f"{family:15} {valency:7} {np.median(clearance):7.3f} "
                f"{np.quantile(clearance, 0.01):6.3f} {clearance.min():6.3f} "
                f"{arcs:9.1f} {1e3 * seconds / stars:10.2f}",
                flush=True,
            )


def insertion(stars: int) -> None:
    """Print how often insertion is not certified, and how good it is where it is."""
    print("insertion: valency  without certificate  median of the certified")
    for valency in VALENCIES:
        drawn_stars = drawn("uniform", np.random.default_rng(valency), stars, valency)
        valid = certify(drawn_stars, *insertion_partitions(drawn_stars)).valid
        found = partition_spheres(drawn_stars[valid], "insertion")
        middle = np.median(found.relative_clearance) if valid.any() else np.nan
        print(f"{valency:18} {100 * (~valid).mean():18.1f} % {middle:20.3f}")


def lattices() -> None:
    """Print the partitions of the cells of lattices."""
    for name, star in LATTICES.items():
        found = partition_spheres(star[None])
        arcs = arc_counts(found.quads).max()
        print(
            f"{name:20} relative clearance {found.relative_clearance[0]:.5f}, {arcs} arcs at most"
        )


def speed() -> None:
    """Print the wall time of whole jobs."""
    random = np.random.default_rng(0)
    repeated = np.tile(drawn("uniform", random, 8, 8), (31250, 1, 1))
    jobs: dict[str, Callable[[], object]] = {
        "foam: 5000 distinct stars of valency 4": lambda: partition_spheres(foam[:5000]),
        "500 distinct stars of valencies 8 to 20": lambda: [partition_spheres(s) for s in mixed],
        "250 000 stars of valency 8, 8 distinct": lambda: partition_spheres(repeated),
        "one star of valency 100": lambda: partition_spheres(random.normal(size=(1, 100, 3))),
    }
    foam = foam_stars(random, 1200)
    mixed = [drawn("uniform", random, 500 // 13 + 1, valency) for valency in range(8, 21)]
    for name, job in jobs.items():
        start = time.perf_counter()
        job()
        print(f"{name:42} {time.perf_counter() - start:6.2f} s", flush=True)


def foam_stars(random: np.random.Generator, cells: int) -> Stars:
    """Return the stars of the inner nodes of a Voronoi foam, all of valency 4, (M, 4, 3)."""
    foam = Voronoi(random.random((cells, 3)))
    loops = [np.array(loop) for loop in foam.ridge_vertices if -1 not in loop]
    pairs = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops])
    edges = np.unique(np.sort(pairs, axis=1), axis=0)
    ends = np.concatenate([edges, edges[:, ::-1]])
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    starts, first, valency = np.unique(ends[:, 0], return_index=True, return_counts=True)
    inside = np.all((foam.vertices > 0) & (foam.vertices < 1), axis=1)
    rows = ends[first[(valency == 4) & inside[starts]][:, None] + np.arange(4)]
    return np.asarray(foam.vertices[rows[..., 1]] - foam.vertices[rows[..., 0]])


def timed(family: str, stars: int, valency: int, method: str) -> tuple[Partitions, float]:
    """Return partitions and the processor time they took, s."""
    random_stars = drawn(family, np.random.default_rng(valency), stars, valency)
    start = time.process_time()
    found = partition_spheres(random_stars, method)
    return found, time.process_time() - start


def main() -> None:
    """Print everything."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stars", type=int, default=200, help="stars of each kind")
    parser.add_argument("--families", nargs="*", default=list(FAMILIES), choices=list(FAMILIES))
    options = parser.parse_args()
    lattices()
    speed()
    insertion(options.stars)
    quality(options.stars, options.families)


if __name__ == "__main__":
    main()
