"""Random skeletons of kinds that are hard on solids, as their STL files are read back.

``python -m tests.validation.attacks [--count 2000] [--seed 1] [--kinds NAME …]`` makes the square
and the round solid of each in turn, or those of ``--solids ball sharp``, and prints what CGAL finds
in the file, what was refused and why, and where too few of the points inside struts are inside the
solid.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh

from scaffold_cad import Scaffold, Skeleton, build_scaffold, round_struts, write
from scaffold_cad.base.arrays import Points
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.filling import delaunay_foam, voronoi_foam
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.options import Nodes
from tests.crossings import faults_by_cgal
from tests.skeletons import polyline
from tests.solids import contains

Random = np.random.Generator
BOX = ((0.0, 0.0, 0.0), (40.0, 40.0, 40.0))
SOLIDS: dict[str, Nodes] = {"round": "blend", "ball": "ball", "sharp": "sharp"}
"""Kinds of round solids, and their nodes; the other kind is square."""

LEAST_INSIDE = 0.98
"""Share of points deep in the struts that are inside a solid. Curves pass beside the middles of
their edges. Of square struts, whose quads are twisted beside branch points, only points inside the
scaffold count; where they cross themselves, straight struts take their place."""


def directions(count: int, random: Random) -> Points:
    """Return unit vectors at random, (count, 3)."""
    found = random.normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def star(tips: Points, radius: float = 1.0) -> Skeleton:
    """Return struts from the origin to `tips`."""
    ends = np.arange(1, len(tips) + 1)
    nodes = np.concatenate([np.zeros((1, 3)), tips])
    return Skeleton(nodes, np.column_stack([np.zeros_like(ends), ends]), radius)


def chain(points: Points, radius: float = 1.0, *, closed: bool = False) -> Skeleton:
    """Return a polyline."""
    return Skeleton(points, polyline(len(points), closed=closed), radius)


def bundle(random: Random) -> Skeleton:
    """Return struts that leave a node at a fiftieth of a degree."""
    return star(30 * (np.array([0, 0, 1.0]) + 3.5e-4 * random.normal(size=(5, 3))))


def crowded_star(random: Random) -> Skeleton:
    """Return a star of 100 struts."""
    return star(30 * directions(100, random))


def fan(random: Random) -> Skeleton:
    """Return struts on one side of their node."""
    return star(20 * (directions(6, random) * 0.5 + np.array([1.0, 0, 0])))


def flat_star(random: Random) -> Skeleton:
    """Return a star in a plane, at random angles."""
    angle = random.uniform(0, 2 * np.pi, 5)
    return star(20 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1))


def spike(random: Random) -> Skeleton:
    """Return a strut whose radius varies a thousandfold."""
    return chain(directions(3, random) * 30).with_radii([5.0, 0.005, random.uniform(0.005, 5)])


def swallowed(random: Random) -> Skeleton:
    """Return a node deep inside another's ball."""
    some = star(np.concatenate([directions(3, random) * 3, directions(2, random) * 20]))
    return some.with_radii([5.0, 1, 1, 1, 1, 1])


def coincident(random: Random) -> Skeleton:
    """Return the same part twice, almost at one place."""
    part = star(15 * directions(4, random))
    moved = part.moved(part.nodes + 2.5e-6 * directions(1, random))
    return both(part, moved)


def both(first: Skeleton, second: Skeleton) -> Skeleton:
    """Return two skeletons as one, not joined."""
    return Skeleton(
        np.concatenate([first.nodes, second.nodes]),
        np.concatenate([first.edges, second.edges + len(first.nodes)]),
        np.concatenate([first.radii, second.radii]),
    )


def comb(random: Random) -> Skeleton:
    """Return teeth side by side, closer than they are wide or not."""
    pitch = random.uniform(1.5, 4)
    back = np.column_stack([pitch * np.arange(12), np.zeros(12), np.zeros(12)])
    tips = back + np.array([0, 15.0, 0])
    teeth = np.column_stack([np.arange(12), np.arange(12) + 12])
    return Skeleton(np.concatenate([back, tips]), np.concatenate([polyline(12), teeth]), 1.0)


def knot(random: Random) -> Skeleton:
    """Return a closed curve that is knotted."""
    p, q = ((2, 3), (3, 2), (2, 5), (3, 4))[random.integers(4)]
    t = np.linspace(0, 2 * np.pi, int(random.integers(24, 90)), endpoint=False)
    reach = 10 + 4 * np.cos(q * t)
    return chain(
        np.stack([reach * np.cos(p * t), reach * np.sin(p * t), 4 * np.sin(q * t)], axis=1),
        closed=True,
    )


def complete(random: Random) -> Skeleton:
    """Return all edges between 20 points."""
    i, j = np.triu_indices(20, 1)
    return Skeleton(random.uniform(0, 60, (20, 3)), np.column_stack([i, j]), 0.5)


def collinear(random: Random) -> Skeleton:
    """Return a strut cut at thousands of places."""
    count = int(random.integers(100, 3000))
    return chain(np.sort(random.uniform(0, 100, count))[:, None] * directions(1, random))


def tiny(random: Random) -> Skeleton:
    """Return a tree of some 1e-5 mm."""
    return tree(random).scaled(1e-6)


def huge(random: Random) -> Skeleton:
    """Return a tree of some 1e6 mm."""
    return tree(random).scaled(1e5)


def far(random: Random) -> Skeleton:
    """Return a tree 10 m from the origin."""
    part = tree(random)
    return part.moved(part.nodes + 1e4 * directions(1, random))


def tree(random: Random) -> Skeleton:
    """Return a tree that grows in any direction."""
    count = int(random.integers(3, 25))
    nodes, parents = np.zeros((count, 3)), [int(random.integers(0, k)) for k in range(1, count)]
    for k, parent in enumerate(parents, start=1):
        nodes[k] = nodes[parent] + random.uniform(5, 15) * directions(1, random)[0]
    return Skeleton(nodes, np.column_stack([parents, np.arange(1, count)]), random.uniform(0.3, 2))


def zigzag(random: Random) -> Skeleton:
    """Return a polyline with sharp bends."""
    angle = random.uniform(0.05, 1.0)
    x = 20 * np.sin(angle / 2) * np.arange(8)
    return chain(np.stack([x, 20 * np.cos(angle / 2) * (np.arange(8) % 2), 0 * x], axis=1))


def hairpin(random: Random) -> Skeleton:
    """Return a polyline that runs back beside itself."""
    gap = random.uniform(0.5, 3)
    return chain(
        np.array([[0, 0, 0], [30, 0, 0], [30 + gap, gap / 2, 0], [30, gap, 0], [0, gap, 0]])
    )


def crossing(random: Random) -> Skeleton:
    """Return rods that cross without a node, at small angles among others."""
    centers, ways = random.uniform(-5, 5, (6, 3)), directions(6, random)
    ways[1:3] = ways[0] + 0.04 * random.normal(size=(2, 3))
    nodes = np.stack([centers - 15 * ways, centers + 15 * ways], axis=1).reshape(-1, 3)
    return Skeleton(nodes, np.arange(12).reshape(-1, 2), 1.0)


def planar(random: Random) -> Skeleton:
    """Return rods in one plane that cross each other."""
    rods = crossing(random)
    return rods.moved(rods.nodes * [1, 1, 0])


def touching(random: Random) -> Skeleton:
    """Return parallel rods that touch exactly."""
    places = np.array([[0, 0], [2, 0], [0, 2], [4, 2], [4, 4]]) * random.choice([1.0, 0.7, 3.1])
    nodes = np.stack([np.column_stack([places, 0 * places[:, 0]]),
                      np.column_stack([places, 0 * places[:, 0] + 20])], axis=1)  # fmt: skip
    return Skeleton(nodes.reshape(-1, 3), np.arange(10).reshape(-1, 2), places[1, 0] / 2)


def balls(random: Random) -> Skeleton:
    """Return big balls on thin necks."""
    part = tree(random)
    radii = np.where(random.random(len(part.nodes)) < 0.4, 4.0, 0.5)
    return Skeleton(part.nodes, part.edges, radii, edge_radii=0.5)


def members(random: Random) -> Skeleton:
    """Return a foam with a radius for each member."""
    part = voronoi_foam(int(random.integers(4, 12)), BOX, 1.0, seed=int(random.integers(2**31)))
    return part.with_edge_radii(random.uniform(0.3, 2.5, len(part.edges)))


def foam(random: Random) -> Skeleton:
    """Return a Voronoi foam, thin or thick."""
    seed = int(random.integers(2**31))
    return voronoi_foam(int(random.integers(4, 14)), BOX, random.uniform(0.2, 4), seed=seed)


def truss(random: Random) -> Skeleton:
    """Return a Delaunay truss, of high valency."""
    seed = int(random.integers(2**31))
    return delaunay_foam(int(random.integers(6, 14)), BOX, random.uniform(0.2, 3), seed=seed)


def helix(random: Random) -> Skeleton:
    """Return a spring whose windings may touch."""
    t = np.linspace(0, 8 * np.pi, 160)
    return chain(np.stack([8 * np.cos(t), 8 * np.sin(t), random.uniform(0.2, 0.6) * t], axis=1))


KINDS: dict[str, Callable[[Random], Skeleton]] = {
    kind.__name__: kind
    for kind in (bundle, crowded_star, fan, flat_star, spike, swallowed, coincident, comb, knot,
                 complete, collinear, tiny, huge, far, tree, zigzag, hairpin, crossing, planar,
                 touching, balls, members, foam, truss, helix)
}  # fmt: skip


def faults(skeleton: Skeleton, kind: str) -> tuple[str, float]:
    """Return what is wrong with the file of a solid, and the share of struts inside it."""
    made = (
        build_scaffold(skeleton) if kind == "square" else round_struts(skeleton, nodes=SOLIDS[kind])
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "solid.stl"
        write(made, path)
        read = trimesh.load_mesh(path, process=False)
    found = faults_by_cgal(np.asarray(read.vertices, np.float64), read.faces)
    whole = trimesh.Trimesh(read.vertices, read.faces)
    points = deep_points(skeleton)
    if isinstance(made, Scaffold):
        points = points[contains(TriangleMesh(made.mesh.vertices, made.mesh.triangles), points)]
    inside = contains(TriangleMesh(whole.vertices, whole.faces), points).mean()
    if whole.body_count > skeleton.component_count:
        found = found or f"{whole.body_count} bodies for {skeleton.component_count}"
    if inside < LEAST_INSIDE:
        found = found or f"only {inside:.3f} inside"
    return found, float(inside)


def deep_points(skeleton: Skeleton, count: int = 400) -> Points:
    """Return points within 0.9 of the radius of struts, none near their ends, (count, 3)."""
    random = np.random.default_rng(0)
    edge = random.integers(len(skeleton.edges), size=count)
    t = random.uniform(0.15, 0.85, (count, 1))
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges[edge]], 1, 0)
    radii = skeleton.edge_radii[edge]
    axis = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
    off = directions(count, random)
    off -= (off * axis).sum(axis=1, keepdims=True) * axis
    off /= np.linalg.norm(off, axis=1, keepdims=True)
    reach = 0.9 * random.uniform(0, 1, (count, 1)) * (radii[:, :1] * (1 - t) + radii[:, 1:] * t)
    return start + t * (end - start) + reach * off


def main() -> int:
    """Print the table; return whether a file is at fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=len(KINDS) * 4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument(
        "--solids", nargs="*", choices=["square", *SOLIDS], default=["square", "round"]
    )
    options = parser.parse_args()
    logging.disable(logging.WARNING)
    done: Counter[tuple[str, str, str]] = Counter()
    seconds: dict[tuple[str, str], float] = {}
    for k in range(options.count):
        name = options.kinds[k % len(options.kinds)]
        try:
            skeleton = KINDS[name](np.random.default_rng([options.seed, k]))
        except ScaffoldCadError as error:  # as for foams of a few points
            print(f"{name} {k}: none made: {error}", flush=True)
            continue
        for solid in options.solids:
            began = time.perf_counter()
            try:
                found, _ = faults(skeleton, solid)
                outcome = "faulty" if found else "good"
            except ScaffoldCadError as error:
                found, outcome = f"refused: {error}", "refused"
            done[name, solid, outcome] += 1
            took = time.perf_counter() - began
            seconds[name, solid] = max(seconds.get((name, solid), 0.0), took)
            if found:
                print(f"{name} {k} {solid}: {found[:200]}", flush=True)
    for (name, solid), most in sorted(seconds.items()):
        counts = [done[name, solid, outcome] for outcome in ("good", "faulty", "refused")]
        print(f"{name:<14}{solid:<8}{counts[0]:>6} good{counts[1]:>5} faulty{counts[2]:>5} refused"
              f"{most:>8.1f} s at most")  # fmt: skip
    return int(any(outcome == "faulty" for _, _, outcome in done))


if __name__ == "__main__":
    sys.exit(main())
