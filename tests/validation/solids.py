"""Solids and frames of many skeletons, checked by libraries that had no part in making them.

``python -m tests.validation.solids [--count N] [--seed S] [--data FOLDER]`` makes the solid and the
frame of N random skeletons (trees, rings, foams, Delaunay graphs; thin, thick, and overlapping)
and of the real files at their own, twice and four times their radii. Every one must be watertight,
without self-intersection, in no more pieces than the skeleton, and hold the middle of every edge.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.filling import delaunay_foam, voronoi_foam
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.thicken import frame_scaffold
from tests.real_files import RADII, real_skeleton
from tests.skeletons import polyline
from tests.solids import check_solid_of

BOX = ((0.0, 0.0, 0.0), (40.0, 40.0, 40.0))
FRAME_RADIUS = 0.15  # of the median radius


def random_skeletons(count: int, seed: int) -> Iterator[tuple[str, Skeleton]]:
    """Yield named random skeletons that can be scaffolded, the kinds in turn."""
    kinds = (tree, ring, foam, delaunay, knot)
    for k in range(count):
        rng = np.random.default_rng([seed, k])
        kind = kinds[k % len(kinds)]
        skeleton = kind(rng)
        # From a fiftieth of the median edge's length to its half: half of them overlap.
        radius = float(np.median(skeleton.lengths)) * np.exp(rng.uniform(np.log(0.02), np.log(0.5)))
        vary = rng.uniform(0.7, 1.4, len(skeleton.nodes)) if rng.random() < 0.5 else 1.0
        yield f"{kind.__name__} {k}", skeleton.with_radii(radius * vary)


def tree(rng: np.random.Generator) -> Skeleton:
    """Return a tree that grows by steps of some 10 mm in any direction."""
    count = int(rng.integers(2, 25))
    nodes = np.zeros((count, 3))
    parents = [int(rng.integers(0, k)) for k in range(1, count)]
    for k, parent in enumerate(parents, start=1):
        step = rng.normal(size=3)
        nodes[k] = nodes[parent] + rng.uniform(5, 15) * step / np.linalg.norm(step)
    edges = np.column_stack([parents, np.arange(1, count)])
    return Skeleton(nodes, edges, 1.0).cleaned().skeleton


def ring(rng: np.random.Generator) -> Skeleton:
    """Return a closed polyline that winds in space."""
    count = int(rng.integers(3, 30))
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    wave = rng.normal(size=(3, 3))
    points = np.column_stack([10 * np.cos(angle), 10 * np.sin(angle), 0 * angle])
    for k, amplitude in enumerate(wave, start=1):
        points += np.sin((k + 1) * angle)[:, None] * amplitude
    return Skeleton(points, polyline(count, closed=True), 1.0)


def knot(rng: np.random.Generator) -> Skeleton:
    """Return a few closed and open curves that may cross each other."""
    parts = [ring(rng) for _ in range(int(rng.integers(2, 4)))]
    offsets = np.cumsum([0, *(len(part.nodes) for part in parts)])
    return Skeleton(
        np.concatenate([part.nodes + rng.normal(scale=6, size=3) for part in parts]),
        np.concatenate([part.edges + offset for part, offset in zip(parts, offsets, strict=False)]),
        1.0,
    )


def foam(rng: np.random.Generator) -> Skeleton:
    """Return a Voronoi foam."""
    return voronoi_foam(int(rng.integers(4, 14)), BOX, 1.0, seed=int(rng.integers(2**31)))


def delaunay(rng: np.random.Generator) -> Skeleton:
    """Return the edges of a Delaunay triangulation, of high valency."""
    return delaunay_foam(int(rng.integers(9, 14)), BOX, 1.0, seed=int(rng.integers(2**31)))


def real_skeletons(folder: Path) -> Iterator[tuple[str, Skeleton]]:
    """Yield the skeletons in the real files, at their own, twice and four times their radii."""
    for name in RADII if folder.is_dir() else ():
        for factor in (1, 2, 4):
            yield f"{name} x{factor}", real_skeleton(folder, name, factor)


def check(name: str, skeleton: Skeleton, done: Counter[str], *, of_scaffold: bool) -> None:
    """Make the solid and the frame of a skeleton and count how it went.

    The frame has the edges of the scaffold, some eight times as many, or of the skeleton.
    """
    scaffold = build_scaffold(skeleton, collars=len(name) % 2 == 0)
    edges = scaffold if of_scaffold else skeleton
    frame = frame_scaffold(edges, FRAME_RADIUS * float(np.median(skeleton.radii)))
    for what, made in (("solid", scaffold), ("frame", frame)):
        fault = fault_of(made)
        done[f"{what} {'failed' if fault else 'good'}"] += 1
        done[f"{what} without union"] += made.embedding().certified
        if fault:
            print(f"{name}: {what}: {fault}", flush=True)


def fault_of(scaffold: Scaffold) -> str | None:
    """Return what is wrong with the solid of a scaffold, if anything."""
    try:
        check_solid_of(scaffold.skeleton, to_solid(scaffold))
    except (AssertionError, ScaffoldCadError) as error:
        return f"{type(error).__name__}: {error}"
    return None


def main() -> int:
    """Run the validation and return how many failed, 1 at most."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--data", type=Path, default=Path(__file__).parents[2] / ".." / "shared" / "data"
    )
    options = parser.parse_args()
    done: Counter[str] = Counter()
    start = time.perf_counter()
    for k, (name, skeleton) in enumerate(random_skeletons(options.count, options.seed)):
        check(name, skeleton, done, of_scaffold=k % 4 == 0)
    for name, skeleton in real_skeletons(options.data):
        check(name, skeleton, done, of_scaffold=True)
    for what, count in sorted(done.items()):
        print(f"{what:<24}{count:>7}")
    print(f"{time.perf_counter() - start:.0f} s")
    return int(any("failed" in what for what in done))


if __name__ == "__main__":
    sys.exit(main())
