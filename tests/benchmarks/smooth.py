"""Smooth solids, how good and how fast: `python -m tests.benchmarks.smooth [NAME ...]`.

Each skeleton becomes a solid of G1 patches, a STEP file and again a solid.

control, solve, write   time of the processor for the control mesh, the patches, the file
all/coarse              time from the skeleton to the file over that of the coarse scaffold's
jump, valid, volume     of what was read back: largest angle between normals across an edge, OCCT's
                        verdict, volume over that of the Catmull-Clark limit
turned                  patches whose normal turns over
off limit               largest distance from the Catmull-Clark limit, in median radii
overlaps                struts that overlap others, which no surface can keep apart
mean, any radius        in the middle of struts 6 radii long and more, over the radius asked for

Lattices of round struts are also compared with the exact union of cylinders and balls.
"""

from __future__ import annotations

import argparse
import logging
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import angle_between, any_perpendicular, length, normalize
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.io import read_skeleton
from scaffold_cad.io.write import write
from scaffold_cad.lattice import tile, voronoi_foam
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.stars import Fit
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import (
    Caps,
    Patches,
    control_mesh,
    deviation,
    smooth_mesh,
    smooth_patches,
)
from tests.skeletons import TRIPOD

DATA = Path(__file__).parents[2] / ".." / "shared" / "data"
SKELETONS = Path(__file__).parents[2] / "examples" / "skeletons"
SEGMENTS = 64
"""Sides of the cylinders and balls of the exact union."""

LONG = 6
"""Least length of a strut whose radius in the middle is compared, in radii: the middle of a shorter
one lies in the blends of its nodes."""

EDGE_SAMPLES = 33
"""Points of each edge at which normals are compared."""


@dataclass(frozen=True)
class Case:
    """A skeleton to make smooth."""

    name: str
    skeleton: Callable[[], Skeleton]
    caps: Caps = "round"
    split: int | None = None
    with_union: bool = False
    collars: bool = True
    fit: Fit = "enclose"


def hand() -> Skeleton:
    return read_skeleton(DATA / "hand.graph", radius=3.0)


def stick_woman() -> Skeleton:
    return read_skeleton(SKELETONS / "stick_woman.json")


def neuron() -> Skeleton:
    return read_skeleton(DATA / "nrn_ordering.swc").simplified(1.0)


def foam() -> Skeleton:
    return voronoi_foam(60, [[0.0] * 3, [100.0] * 3], 1.0, regularity=0.7)


CASES = [
    Case("tripod", lambda: TRIPOD),
    Case("tripod, flat caps", lambda: TRIPOD, caps="flat"),
    Case("tripod, split", lambda: TRIPOD, split=1),
    Case("tripod, no collars", lambda: TRIPOD, collars=False),
    Case("BCC 3³, struts of 17 radii", lambda: tile("bcc", 20.0, 3, radius=1.0), with_union=True),
    Case("BCC 3³, struts of 8 radii", lambda: tile("bcc", 18.5, 3, radius=2.0), with_union=True),
    Case(
        "octet 2³, struts of 14 radii", lambda: tile("octet", 20.0, 2, radius=1.0), with_union=True
    ),
    Case("BCC 6³, struts of 17 radii", lambda: tile("bcc", 20.0, 6, radius=1.0)),
    Case("stick woman", stick_woman),
    Case("stick woman, no collars", stick_woman, collars=False),
    Case("foam of 60 cells", foam),
    Case("hand.graph", hand),
    Case("hand.graph, no collars", hand, collars=False),
    Case("nrn_ordering.swc", neuron),
    Case("nrn_ordering.swc, no collars", neuron, collars=False),
]


def main() -> None:
    """Make all solids and print what they are like."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="only cases whose name holds one of these")
    names = parser.parse_args().names
    logging.disable(logging.WARNING)
    with tempfile.TemporaryDirectory() as folder:
        made(CASES[0], Path(folder))  # imports, which count for nobody
        print_row([title for title, _ in COLUMNS])
        for case in CASES:
            if not names or any(name in case.name for name in names):
                report(case, Path(folder))


COLUMNS = [
    ("", 30),
    ("patches", 8),
    ("control", 9),
    ("solve", 9),
    ("write", 9),
    ("all/coarse", 11),
    ("size", 10),
    ("jump", 11),
    ("valid", 6),
    ("volume", 8),
    ("turned", 7),
    ("off limit", 10),
    ("overlaps", 9),
    ("mean radius", 14),
    ("any radius", 14),
]
"""Titles of the columns and how wide they are."""


@dataclass(frozen=True, eq=False)
class Made:
    """A smooth solid in a file, and how long its parts took, s."""

    scaffold: Scaffold
    patches: Patches
    build: float
    coarse: float
    control: float
    patching: float
    writing: float

    @property
    def times_coarse(self) -> float:
        """How many times as long as the coarse solid the smooth one took, from the skeleton on."""
        return (self.build + self.patching + self.writing) / (self.build + self.coarse)


def made(case: Case, folder: Path) -> Made:
    """Write the STEP files of one skeleton, `smooth.step` and `coarse.step`."""
    skeleton = case.skeleton()
    clock = [time.process_time()]
    scaffold = build_scaffold(skeleton, collars=case.collars, fit=case.fit)
    clock.append(time.process_time())
    write(scaffold.mesh, folder / "coarse.step")
    clock.append(time.process_time())
    control_mesh(scaffold, case.caps)
    clock.append(time.process_time())
    patches = smooth_patches(scaffold, split=case.split, caps=case.caps)
    clock.append(time.process_time())
    write(patches, folder / "smooth.step")
    clock.append(time.process_time())
    return Made(scaffold, patches, *np.diff(clock).tolist())


def report(case: Case, folder: Path) -> None:
    """Print how good and how fast the smooth solid of one skeleton is."""
    from build123d import import_step

    skeleton = case.skeleton()
    result = made(case, folder)
    scaffold, patches = result.scaffold, result.patches
    path = folder / "smooth.step"
    read = import_step(path)
    found = deviation(patches, scaffold)
    levels = 4 if len(scaffold.mesh.quads) < 5000 else 3
    fine = smooth_mesh(scaffold, levels, case.caps).mesh.signed_volume
    wanted = skeleton.radii[skeleton.edges].mean(axis=1)
    long = skeleton.lengths >= LONG * wanted
    least, mean, most = (found.strut_radii[long] / wanted[long, None]).T
    cells = [
        case.name,
        str(len(patches.bezier.quads)),
        f"{result.control:.2f} s",
        f"{result.patching - result.control:.2f} s",
        f"{result.writing:.2f} s",
        f"{result.times_coarse:.1f}",
        f"{path.stat().st_size / 1e6:.2f} MB",
        f"{np.degrees(jumps_of_shape(read).max()):.1e}°",
        "yes" if read.is_valid else "NO",
        f"{read.volume / fine:.4f}",
        str(len(found.turned)),
        f"{found.limit_distance / np.median(skeleton.radii):.3f} r",
        str(len(scaffold.embedding().left_out)),
        f"{np.nanmin(mean):.3f}–{np.nanmax(mean):.3f}",
        f"{np.nanmin(least):.3f}–{np.nanmax(most):.3f}",
    ]
    print_row(cells)
    if case.with_union:
        union = union_of_struts(skeleton)
        print(f"{'':30}volume over the exact union's: {read.volume / union:.4f}")


def print_row(cells: list[str]) -> None:
    """Print a line of the table."""
    padded = [
        f"{cell:{width}}" if width > 20 else f"{cell:>{width}}"
        for cell, (_, width) in zip(cells, COLUMNS, strict=True)
    ]
    print("".join(padded), flush=True)


def union_of_struts(skeleton: Skeleton) -> float:
    """Return the volume of the union of round struts and balls at their nodes, mm³."""
    # A regular polygon of the circle's area, and a ball of its volume.
    widened = 1 / np.sqrt(np.sinc(2 / SEGMENTS))
    ball = manifold3d.Manifold.sphere(1.0, SEGMENTS)
    grown = (4 / 3 * np.pi / ball.volume()) ** (1 / 3)
    parts = []
    for a, b in skeleton.edges:
        start, span = skeleton.nodes[a], skeleton.nodes[b] - skeleton.nodes[a]
        z = normalize(span)
        x = any_perpendicular(z)
        low, high = widened * skeleton.radii[[a, b]]
        strut = manifold3d.Manifold.cylinder(float(length(span)), low, high, SEGMENTS)
        parts.append(strut.transform(np.column_stack([x, np.cross(z, x), z, start])))
    for node, radius in zip(skeleton.nodes, skeleton.radii, strict=True):
        parts.append(ball.scale([grown * radius] * 3).translate(node.tolist()))
    union = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    return float(union.volume())


def jumps_of_shape(shape: Any) -> Floats:
    """Return the angles between the normals of the faces at their common sides, (k,), rad.

    From the poles of the shape's own surfaces; plane faces are flat caps and left out.
    """
    curved = [face for face in shape.faces() if face.geom_type.name != "PLANE"]
    poles = np.array([poles_of_face(face) for face in curved])
    degree = poles.shape[1] - 1
    at = np.linspace(0, 1, EDGE_SAMPLES)
    value, slope = bernstein(degree, at), bernstein(degree, at, 1)

    def grid(u: Floats, v: Floats) -> Floats:
        return np.einsum("ai,bj,fijk->fabk", u, v, poles, optimize=True)

    def sides(values: Floats) -> Floats:
        around = [values[:, :, 0], values[:, -1], values[:, ::-1, -1], values[:, 0, ::-1]]
        return np.stack(around, axis=1).reshape(-1, EDGE_SAMPLES, 3)

    points = sides(grid(value, value))
    normals = sides(normalize(np.cross(grid(slope, value), grid(value, slope))))
    # Sides that run along the same points the other way round.
    key = points[:, [0, EDGE_SAMPLES // 2, -1]].reshape(-1, 9)
    back = points[:, [-1, EDGE_SAMPLES // 2, 0]].reshape(-1, 9)
    distance, twin = cKDTree(key).query(back)
    met = distance < 1e-6
    jumps: Floats = angle_between(normals[met], normals[twin[met]][:, ::-1]).max(axis=1)
    return jumps


def poles_of_face(face: Any) -> Floats:
    """Return the poles of a face's Bézier surface, turned outwards, (d + 1, d + 1, 3)."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation

    surface = BRep_Tool.Surface_s(face.wrapped)
    count = (surface.NbUPoles(), surface.NbVPoles())
    poles = np.empty((*count, 3))
    for i, j in np.ndindex(count):
        pole = surface.Pole(i + 1, j + 1)
        poles[i, j] = pole.X(), pole.Y(), pole.Z()
    reversed_face = face.wrapped.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
    return poles.transpose(1, 0, 2) if reversed_face else poles


if __name__ == "__main__":
    main()
