"""Every named cell on a map of each kind: certified, or why not.

`python -m tests.validation.maps` prints the table that `docs/lattices.md` shows.
"""

from __future__ import annotations

import numpy as np
from build123d import Axis, Box, Cylinder, Face, GeomType, Pos, Vector

from scaffold_cad import (
    BoxMap,
    CellMap,
    CylinderMap,
    QuadMesh,
    SphereMap,
    between_faces,
    build_scaffold,
    cells,
    check_skeleton,
    face_map,
    lattice_on,
    mesh_map,
)
from scaffold_cad.errors import ScaffoldCadError

THIN = 0.02
"""Radius of struts, in lengths of the shortest one."""


def _wave(height: float) -> Face:
    rows = [
        [Vector(x, y, height + 3 * np.sin(x / 6) * np.cos(y / 7)) for y in range(0, 41, 8)]
        for x in range(0, 61, 6)
    ]
    return Face.make_surface_from_array_of_points(rows)


def maps() -> dict[str, tuple[CellMap, tuple[int, int, int]]]:
    """Return a map of each kind and counts of cells on it."""
    pipe = Cylinder(20, 30).faces().filter_by(GeomType.CYLINDER)[0]
    plate = Box(40, 30, 5) - Pos(8, 3, 0) * Cylinder(5, 9)
    quads = QuadMesh(
        [[x, y, 0.1 * x * y] for x in (0, 9, 18) for y in (0, 9)], [[0, 2, 3, 1], [2, 4, 5, 3]]
    )
    return {
        "box": (BoxMap([20, 20, 20], axes=[[1, 1, 0], [-1, 1, 0], [0, 0, 1]]), (2, 2, 2)),
        "tube": (CylinderMap(20, 20, 5), (20, 4, 1)),
        "sphere": (SphereMap(20, 5), (5, 5, 1)),
        "band": (SphereMap(20, 5, latitudes=[-0.6, 0.9]), (20, 6, 1)),
        "pipe's face": (face_map(pipe, 5.0), (20, 5, 1)),
        "trimmed face": (face_map(plate.faces().sort_by(Axis.Z)[-1], 5.0), (8, 6, 1)),
        "free face": (face_map(_wave(0.0), 4.0), (12, 8, 1)),
        "two faces": (between_faces(_wave(0.0), _wave(8.0)), (10, 7, 1)),
        "quads": (mesh_map(quads, 4.0), (2, 2, 1)),
    }


def outcome(name: str, mapping: CellMap, counts: tuple[int, int, int]) -> str:
    """Return "certified" or what is wrong."""
    try:
        skeleton = lattice_on(mapping, name, radius=1.0, counts=counts).skeleton
        check_skeleton(skeleton)
        thin = skeleton.with_radii(THIN * float(np.percentile(skeleton.lengths, 2)))
        embedding = build_scaffold(thin, collars=True).embedding()
    except ScaffoldCadError as error:
        return str(error)
    return "certified" if embedding.certified else f"{len(embedding.left_out)} struts overlap"


def main() -> None:
    """Print the table, and the reasons below it."""
    kinds = maps()
    print("| cell |", " | ".join(kinds), "|")
    print("|---|", "---|" * len(kinds), sep="")
    reasons = []
    for name in cells():
        marks = []
        for kind, (mapping, counts) in kinds.items():
            found = outcome(name, mapping, counts)
            marks.append("yes" if found == "certified" else "no")
            if found != "certified":
                reasons.append(f"{name} on {kind}: {found}")
        print(f"| `{name}` |", " | ".join(marks), "|", flush=True)
    print("\n".join(reasons))


if __name__ == "__main__":
    main()
