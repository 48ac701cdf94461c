"""The number QUAD_SIDE of `scaffold_cad.mesh.remeshing`: `python -m tests.benchmarks.remeshing`.

Quads are wanted as large as squares of a size. A square of side 1 is a third of a triangle, whose
side is then 2.63; triangles come out a little larger than wanted, as edges are halved and drawn
together within limits. For each factor the mean area of quads over the square's is printed, for
shapes and sizes; the last line has the factor at which the median over all of them is 1.
"""

from __future__ import annotations

import numpy as np
import trimesh

from scaffold_cad.mesh import TriangleMesh, remeshing

FACTORS = (2.4, 2.6, 2.8, 3.0)
SIZES = (1.5, 2.0, 3.0)
SHAPES = {
    "ball": trimesh.creation.icosphere(3, 20.0),
    "torus": trimesh.creation.torus(20.0, 6.0, major_sections=60, minor_sections=24),
    "box": trimesh.creation.box((30, 20, 25)),
    "rod": trimesh.creation.cylinder(10, 30, sections=64),
}


def mean_area(shape: trimesh.Trimesh, size: float, factor: float) -> float:
    """Return the mean area of quads of a wanted size, over that of a square."""
    before = remeshing.QUAD_SIDE
    remeshing.QUAD_SIDE = factor
    try:
        quads = remeshing.quadrangulated(TriangleMesh(shape.vertices, shape.faces), size)
    finally:
        remeshing.QUAD_SIDE = before
    return float(shape.area) / len(quads.quads) / size**2


def main() -> None:
    """Print a row per shape and size, and the factor that is right in the median."""
    print(f"{'shape':<8}{'size':>6}" + "".join(f"{factor:>8.2f}" for factor in FACTORS))
    rows = []
    for name, shape in SHAPES.items():
        for size in SIZES:
            areas = [mean_area(shape, size, factor) for factor in FACTORS]
            rows.append(areas)
            print(f"{name:<8}{size:>6g}" + "".join(f"{area:>8.3f}" for area in areas), flush=True)
    medians = np.median(rows, axis=0)
    print(f"{'median':<14}" + "".join(f"{area:>8.3f}" for area in medians))
    print(f"area 1 at {np.interp(0.0, np.log(medians), FACTORS):.2f}")


if __name__ == "__main__":
    main()
