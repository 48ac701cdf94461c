"""Projected scaffolds beside marching cubes: `python -m tests.benchmarks.convolution [NAME ...]`.

Both approximate the same convolution surface. How far a place is off it is taken to first order,
|f − 1| / |∇f|, in median radii of the skeleton, at vertices and at the middles of faces. Marching
cubes run on the coarsest grid whose faces are as near on average. They need scikit-image.
"""

from __future__ import annotations

import argparse
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Ints, Points
from scaffold_cad.base.vectors import length
from scaffold_cad.convolution import ConvolutionField, project
from scaffold_cad.io import read_skeleton
from scaffold_cad.mesh.subdivision import catmull_clark
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton

ROOT = Path(__file__).parents[2]
LEVELS = (1, 2, 3)
FINEST = 8.0
"""Most cells a median radius that marching cubes are tried with."""


@dataclass(frozen=True, eq=False)
class Faces:
    """A surface of polygons."""

    vertices: Points
    """Vertex positions, shape (v, 3), mm."""
    faces: Ints
    """Vertex indices of each face, shape (f, 3 or 4)."""


def woman() -> Skeleton:
    return read_skeleton(ROOT / "examples" / "skeletons" / "stick_woman.json")


def hand() -> Skeleton:
    return read_skeleton(ROOT / ".." / "shared" / "data" / "hand.graph", radius=3.0)


CASES: dict[str, Callable[[], Skeleton]] = {"stick woman": woman, "hand.graph": hand}


def main() -> None:
    """Make all surfaces and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="only cases whose name holds one of these")
    names = parser.parse_args().names
    logging.disable(logging.WARNING)
    with_peer = find_spec("skimage") is not None
    if not with_peer:
        print("scikit-image is not installed: marching cubes are left out")
    print(
        f"{'':38}{'time':>9}{'faces':>9}{'vertices off, mean/max':>26}{'faces off, mean/max':>24}"
    )
    for name, make in CASES.items():
        if names and not any(part in name for part in names):
            continue
        skeleton = make()
        field = ConvolutionField(skeleton)
        wanted = [report_projection(name, skeleton, field, levels) for levels in LEVELS]
        if with_peer:
            for distance in wanted:
                report_marching_cubes(name, field, distance)


def report_projection(name: str, skeleton: Skeleton, field: ConvolutionField, levels: int) -> float:
    """Print a line for the projected scaffold; return the mean distance of its faces."""

    def make() -> Faces:
        scaffold = build_scaffold(skeleton, collars=True)
        mesh = project(catmull_clark(scaffold.mesh, levels, scaffold.mesh.edges).mesh, field)
        return Faces(mesh.vertices, mesh.quads)

    return report(f"{name}, scaffold of {levels} levels", field, make)


def report_marching_cubes(name: str, field: ConvolutionField, distance: float) -> None:
    """Print a line for the coarsest marching cubes whose faces are as near, or for the finest."""
    cells = 1.0
    while cells <= FINEST:
        made = marching_cubes(field, cells)
        mean = distances(field, made.vertices[made.faces].mean(axis=1)).mean()
        if mean <= distance:
            break
        cells *= max(1.05, np.sqrt(mean / distance))  # the distance falls with the cell's square
    cells = min(cells, FINEST)
    title = f"{name}, cubes of 1/{cells:.1f} radius"
    report(title, field, lambda: marching_cubes(field, cells))


def report(title: str, field: ConvolutionField, make: Callable[[], Faces]) -> float:
    """Print how long a surface takes and how near it is; return the mean distance of its faces."""
    start = time.process_time()
    made = make()
    seconds = time.process_time() - start
    at_vertices = distances(field, made.vertices)
    at_faces = distances(field, made.vertices[made.faces].mean(axis=1))
    columns = [f"{off.mean():.1e} / {off.max():.1e} r" for off in (at_vertices, at_faces)]
    print(
        f"{title:38}{seconds:>7.2f} s{len(made.faces):>9}{columns[0]:>26}{columns[1]:>24}",
        flush=True,
    )
    return float(at_faces.mean())


def distances(field: ConvolutionField, points: Points) -> Points:
    """Return how far off the surface the points are to first order, (n,), in median radii."""
    samples = field.samples(points)
    slopes = np.maximum(length(samples.gradients), 1e-9)
    return np.abs(samples.values - 1) / slopes / np.median(field.skeleton.radii)


def marching_cubes(field: ConvolutionField, cells: float) -> Faces:
    """Return the surface as triangles on a grid of `cells` cells a median radius."""
    from skimage.measure import marching_cubes

    skeleton = field.skeleton
    step = float(np.median(skeleton.radii)) / cells
    margin = field.integrand.support * skeleton.radii[:, None] + step
    low, high = (skeleton.nodes - margin).min(axis=0), (skeleton.nodes + margin).max(axis=0)
    axes = [np.arange(a, b + step, step) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = field.value(grid.reshape(-1, 3)).reshape(grid.shape[:3])
    vertices, faces, _, _ = marching_cubes(values, 1.0, spacing=(step, step, step))
    return Faces(low + vertices.astype(np.float64), faces.astype(np.intp))


if __name__ == "__main__":
    main()
