"""Round struts against what was asked for, on the STEP file as read back.

`python -m tests.validation.struts --frames 300` makes random frames (trees, foams, trusses, rings,
with a radius for each member), writes them, reads them by OCCT, and prints how far cylinders are
from their struts, whether the solid is valid, and the volume against the struts' union by Monte
Carlo.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
from build123d import GeomType, Shape, import_step

from scaffold_cad import RoundStruts, Skeleton, delaunay_foam, round_struts, voronoi_foam, write
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.errors import SkeletonError
from scaffold_cad.struts.surface import triangulated
from scaffold_cad.struts.walls import walls

KINDS = ("tree", "foam", "truss", "ring")
SAMPLES = 2_000_000
WALL = 0.4
"""Wall of hollow frames, in radii of the thinnest strut."""
BOX = [[0, 0, 0], [60, 60, 60]]


def frame(kind: str, generator: np.random.Generator) -> Skeleton:
    """Return a random frame with a radius for each member, 0.5 to 2 parts of a thin one."""
    seed = int(generator.integers(1 << 30))
    if kind == "tree":
        bare = _tree(int(generator.integers(4, 15)), generator)
    elif kind == "foam":
        bare = voronoi_foam(int(generator.integers(4, 9)), BOX, 1.0, seed)
    elif kind == "truss":
        bare = _truss(int(generator.integers(5, 9)), seed)
    else:
        count = int(generator.integers(4, 9))
        angle = np.sort(
            2 * np.pi * (np.arange(count) + generator.uniform(-0.3, 0.3, count)) / count
        )
        nodes = np.stack([30 * np.cos(angle), 30 * np.sin(angle), generator.normal(0, 4, count)], 1)
        edges = np.stack([np.arange(count), np.roll(np.arange(count), -1)], axis=1)
        bare = Skeleton(nodes, edges, 1.0)
    thin = 0.06 * float(np.median(bare.lengths))
    return bare.with_edge_radii(thin * generator.uniform(0.5, 2.0, len(bare.edges)))


def _truss(count: int, seed: int) -> Skeleton:
    """Return a foam of few points, of the first seed from `seed` on that leaves a strut."""
    try:
        return delaunay_foam(count, BOX, 1.0, seed)
    except SkeletonError:
        return _truss(count, seed + 1)


def _tree(count: int, generator: np.random.Generator) -> Skeleton:
    """Return a tree whose branches leave each other at 35 degrees or more."""
    nodes, edges, ways = [np.zeros(3)], [], {0: []}
    while len(nodes) < count:
        parent = int(generator.integers(len(nodes)))
        way = generator.normal(size=3)
        way /= np.linalg.norm(way)
        if len(ways[parent]) >= 5 or any(way @ other > 0.82 for other in ways[parent]):
            continue
        ways[parent].append(way)
        ways[len(nodes)] = [-way]
        edges.append((parent, len(nodes)))
        nodes.append(nodes[parent] + generator.uniform(20, 40) * way)
    return Skeleton(nodes, edges, 1.0)


def cylinder_errors(shape: Shape, struts: RoundStruts) -> Floats:
    """Return how far each cylinder is off its strut in radius and axis, in radii, (c, 2)."""
    runs = struts.runs
    found = []
    for face in shape.faces():
        if face.geom_type != GeomType.CYLINDER:
            continue
        axis = face.axis_of_rotation
        origin, direction = np.array(tuple(axis.position)), np.array(tuple(axis.direction))
        start, end = np.moveaxis(runs.nodes[runs.edges], 1, 0)
        off = [
            np.linalg.norm(np.cross(point - origin, direction), axis=1) for point in (start, end)
        ]
        size = np.abs(runs.radii[:, 0] - face.radius)
        run = int((np.maximum(*off) + size).argmin())
        radius = runs.radii[run, 0]
        found.append((size[run] / radius, max(off[0][run], off[1][run]) / radius))
    return np.reshape(found, (-1, 2))


def union_volume(skeleton: Skeleton, generator: np.random.Generator) -> tuple[float, float]:
    """Return the volume of the struts' union by Monte Carlo, without fillets, and its error."""
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    reach = skeleton.edge_radii.max()
    low, high = skeleton.nodes.min(axis=0) - reach, skeleton.nodes.max(axis=0) + reach
    points: Points = generator.uniform(low, high, (SAMPLES, 3))
    inside = np.zeros(SAMPLES, dtype=bool)
    inner = skeleton.valency[skeleton.edges] > 1
    for a, b, (near, far), ball in zip(start, end, skeleton.edge_radii, inner, strict=True):
        axis = b - a
        along = (points - a) @ axis / (axis @ axis)
        across = np.linalg.norm(points - a - along[:, None] * axis, axis=1)
        inside |= (along >= 0) & (along <= 1) & (across <= near + along * (far - near))
        for place, radius, is_ball in ((a, near, ball[0]), (b, far, ball[1])):
            if is_ball:
                inside |= np.linalg.norm(points - place, axis=1) <= radius
    share = inside.mean()
    box = float(np.prod(high - low))
    return box * share, box * float(np.sqrt(share * (1 - share) / SAMPLES))


def least_walls(skeleton: Skeleton) -> Floats:
    """Return the least wall at each node of the hollow frame, over what is asked for."""
    wall = WALL * float(skeleton.edge_radii.min())
    found = walls(round_struts(skeleton, wall=wall, ends="open"))
    nodes = found.nodes[np.isfinite(found.nodes)]
    return np.concatenate([nodes, found.curves]) / wall


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    radius, axis, ratios, invalid, crowded, nodes, proved = [], [], [], 0, 0, 0, 0
    thin: list[Floats] = []
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "frame.step"
        for number in range(options.frames):
            skeleton = frame(KINDS[number % len(KINDS)], generator)
            struts = round_struts(skeleton)
            nodes += int((struts.runs.valency > 1).sum())
            proved += int(((struts.runs.valency > 1) & ~struts.crowded).sum())
            if len(struts.overlapping):
                crowded += 1
                continue
            write(struts, path)
            shape = import_step(path)
            invalid += not shape.is_valid
            errors = cylinder_errors(shape, struts)
            radius.append(errors[:, 0].max(initial=0))
            axis.append(errors[:, 1].max(initial=0))
            volume, _ = union_volume(skeleton, generator)
            thin.append(least_walls(skeleton))
            ratios.append(triangulated(struts, 16).mesh.signed_volume / volume)
    print(f"{options.frames} frames in {time.perf_counter() - began:.0f} s; {crowded} have nodes")
    print("or struts without room of their own, and are united in meshes instead")
    print(f"nodes with a proved blend and room: {proved} of {nodes}")
    print(f"invalid after re-import: {invalid} of {len(ratios)}")
    print(
        f"largest error of a cylinder's radius {max(radius):.1e}, of its axis {max(axis):.1e} radii"
    )
    print(
        f"volume over the union without fillets: {min(ratios):.4f} to {max(ratios):.4f}, "
        f"median {np.median(ratios):.4f}"
    )
    wall = np.concatenate(thin)
    print(
        f"least wall at nodes of hollow frames, over what is asked: {wall.min():.3f}; at "
        f"{(wall >= 0.95).mean():.2%} of {len(wall)} nodes 0.95 or more"
    )


if __name__ == "__main__":
    main()
