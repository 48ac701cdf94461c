"""How long a self-intersection test takes: `python -m tests.benchmarks.intersections [--large]`.

Each mesh is tested in a process of its own, so that its peak of memory is its own.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np

from scaffold_cad.lattice import tile
from scaffold_cad.mesh.intersections import Triangulated, self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import build_scaffold


@dataclass(frozen=True)
class Work:
    """A mesh to test, of a size that grows with `scale`."""

    name: str
    make: Callable[[float], Triangulated]


def scaffold_of(cell: str, counts: float) -> Triangulated:
    """Return the scaffold of a lattice, its struts collared."""
    skeleton = tile(cell, 10.0, round(counts), radius=0.5)
    return build_scaffold(skeleton, collars=True).mesh


def boxes(counts: float) -> QuadMesh:
    """Return rows of cubes that stand apart, each face cut into 5 by 5 quads."""
    steps = np.arange(6)
    u, v = (grid.reshape(-1) for grid in np.meshgrid(steps, steps, indexing="ij"))
    faces = [
        np.roll(np.stack([u[::turn], v, np.full(36, level)], axis=1), axis, axis=1)
        for axis in range(3)
        for turn, level in ((1, 5), (-1, 0))
    ]
    points, numbers = np.unique(np.concatenate(faces), axis=0, return_inverse=True)
    corner = (6 * steps[:5, None] + steps[:5]).reshape(-1)
    quads = np.stack([corner, corner + 6, corner + 7, corner + 1], axis=1)
    quads = numbers[(36 * np.arange(6)[:, None, None] + quads).reshape(-1, 4)]
    places = 7.0 * np.stack(np.meshgrid(*[np.arange(round(counts))] * 3), axis=-1).reshape(-1, 1, 3)
    starts = len(points) * np.arange(len(places))[:, None, None]
    return QuadMesh((places + points).reshape(-1, 3), (starts + quads).reshape(-1, 4))


def turned(mesh: QuadMesh) -> QuadMesh:
    """Return the mesh at an angle to the axes: faces that were flat are so but for rounding."""
    rotation, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    return mesh.moved(mesh.vertices @ rotation)


def strewn(side: float) -> TriangleMesh:
    """Return triangles of sizes from 0.005 to 1.5, one a unit of volume, strewn in a cube."""
    count = round(side**3)
    generator = np.random.default_rng(0)
    sizes = np.exp(generator.uniform(*np.log([0.005, 1.5]), (count, 1, 1)))
    places = generator.uniform(0.0, side, (count, 1, 3))
    corners = places + sizes * generator.normal(size=(count, 3, 3))
    return TriangleMesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


WORKS = [
    Work("scaffold of BCC", lambda scale: scaffold_of("bcc", 8 * scale)),
    Work("scaffold of octet", lambda scale: scaffold_of("octet", 5.5 * scale)),
    Work("boxes", lambda scale: boxes(7 * scale)),
    Work("boxes at an angle", lambda scale: turned(boxes(7 * scale))),
    Work("strewn triangles", lambda scale: strewn(46.4 * scale)),
]
"""About 10^5 triangles each at scale 1."""


def measure(number: int, scale: float) -> None:
    """Test one mesh and print a line."""
    mesh = WORKS[number].make(scale)
    count = len(mesh.triangles)
    start = time.perf_counter(), time.process_time()
    pairs = self_intersections(mesh)
    wall, processor = time.perf_counter() - start[0], time.process_time() - start[1]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    peak /= 2**20 if sys.platform == "darwin" else 2**10
    print(
        f"{WORKS[number].name:20}{count:>10}{len(pairs):>10}"
        f"{wall:>8.2f} s{processor:>8.2f} s{peak:>9.0f} MB",
        flush=True,
    )


def main() -> None:
    """Test all meshes and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="10^6 triangles instead of 10^5")
    options = parser.parse_args()
    print(f"{'':20}{'triangles':>10}{'pairs':>10}{'wall':>10}{'processor':>10}{'peak':>12}")
    for number in range(len(WORKS)):
        scale = 10 ** (1 / 3) if options.large else 1.0
        process = get_context("spawn").Process(target=measure, args=(number, scale))
        process.start()
        process.join()


if __name__ == "__main__":
    main()
