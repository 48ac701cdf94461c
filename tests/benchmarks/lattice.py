"""How long lattices and their scaffolds take: `python -m tests.benchmarks.lattice [--large]`."""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np
import trimesh

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.filling import delaunay_foam, fill, voronoi_foam
from scaffold_cad.lattice import tile
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton

Result = TypeVar("Result")

BOX = np.array([[0.0, 0.0, 0.0], [100.0, 100.0, 100.0]])


@dataclass(frozen=True)
class Work:
    """A lattice to make, and how often to try: the best time counts."""

    name: str
    make: Callable[[], Skeleton]
    tries: int = 3
    with_scaffold: bool = True


def ball(points: Points) -> Floats:
    """Return the signed distance to a ball in the middle of the box."""
    distance: Floats = np.linalg.norm(points - 50.0, axis=1) - 50.0
    return distance


def works(large: bool) -> list[Work]:
    """Return what is timed."""
    mesh = trimesh.creation.icosphere(4, 50.0)
    mesh.apply_translation([50.0] * 3)
    chosen = [
        Work("BCC 10³", lambda: tile("bcc", 10.0, 10, radius=0.7)),
        Work("BCC 20³", lambda: tile("bcc", 10.0, 20, radius=0.7)),
        Work("octet 4³", lambda: tile("octet", 10.0, 4, radius=0.5)),
        Work("octet 8³", lambda: tile("octet", 10.0, 8, radius=0.5)),
        Work("Voronoi foam, 1005 cells", lambda: voronoi_foam(1005, BOX, 0.7)),
        # Its scaffold takes long: valencies go up to 30 and no two nodes are alike.
        Work("Delaunay truss, 1600 points", lambda: delaunay_foam(1600, BOX, 0.5), 1, large),
        Work("BCC 5 mm in a box", lambda: fill(BOX, "bcc", 5.0, 0.4), with_scaffold=False),
        Work(
            "BCC 5 mm in a function",
            lambda: fill(ball, "bcc", 5.0, 0.4, bounds=BOX),
            with_scaffold=False,
        ),
        Work(
            f"BCC 5 mm in a mesh of {len(mesh.faces)} triangles",
            lambda: fill(mesh, "bcc", 5.0, 0.4),
            with_scaffold=False,
        ),
    ]
    if large:
        chosen.append(Work("BCC 50³", lambda: tile("bcc", 10.0, 50, radius=0.7), tries=1))
    return chosen


def timed(function: Callable[[], Result], tries: int) -> tuple[Result, float]:
    """Return what `function` returns and its shortest time of `tries`, s."""
    best = np.inf
    for _ in range(tries):
        start = time.perf_counter()
        result = function()
        best = min(best, time.perf_counter() - start)
    return result, best


def peak_memory() -> float:
    """Return the most memory that this process had so far, MB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)


def main() -> None:
    """Time all works and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="a million struts too")
    options = parser.parse_args()
    print(f"{'':42}{'struts':>10}{'lattice':>10}{'scaffold':>10}{'peak so far':>13}")
    for work in works(options.large):
        skeleton, lattice_time = timed(work.make, work.tries)
        line = f"{work.name:42}{len(skeleton.edges):>10}{lattice_time:>8.3f} s"
        if work.with_scaffold:
            _, scaffold_time = timed(partial(build_scaffold, skeleton), work.tries)
            line += f"{scaffold_time:>8.3f} s"
        else:
            line += " " * 10
        print(f"{line}{peak_memory():>10.0f} MB")


if __name__ == "__main__":
    main()
