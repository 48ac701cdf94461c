"""Round struts against what was asked for, on the STEP file as read back.

`python -m tests.validation.struts --frames 300` makes random frames (trees, foams, trusses, rings,
with a radius for each member), writes them, reads them by OCCT, and prints how far cylinders are
from their struts, whether the solid is valid and smooth, and the volume against the struts' union
and its rolling-ball fillets by Monte Carlo; and how thick walls are in the same frames, hollow.
Where struts or nodes have no room the file has facets there: how many, and the same figures.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
from build123d import GeomType, Shape, import_step

from scaffold_cad import RoundStruts, Skeleton, delaunay_foam, round_struts, voronoi_foam, write
from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.errors import SkeletonError
from tests.validation.fillets import fillet_volume
from tests.validation.reread import SAG, axes_outside, least_wall, worst_join

KINDS = ("tree", "foam", "truss", "ring")
SAMPLES = 1_000_000
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
    """Return how far each cylinder is off its strut in radius and axis, in radii, (c, 2).

    Those between cut curves and clusters are along the curve at one of its circles.
    """
    runs, curves = struts.runs, struts.curves
    start, end = np.moveaxis(runs.nodes[runs.edges], 1, 0)
    ahead = curves.centers + curves.radii[:, None] * curves.tangents
    axes = np.concatenate([start, curves.centers]), np.concatenate([end, ahead])
    radii = np.concatenate([runs.radii[:, 0], curves.radii])
    found = []
    for face in shape.faces():
        if face.geom_type != GeomType.CYLINDER:
            continue
        axis = face.axis_of_rotation
        origin, direction = np.array(tuple(axis.position)), np.array(tuple(axis.direction))
        off = [np.linalg.norm(np.cross(point - origin, direction), axis=1) for point in axes]
        size = np.abs(radii - face.radius)
        own = int((np.maximum(*off) + size).argmin())
        found.append((size[own] / radii[own], max(off[0][own], off[1][own]) / radii[own]))
    return np.reshape(found, (-1, 2))


def with_cylinder(shape: Shape, struts: RoundStruts) -> set[int]:
    """Return the runs on whose axis a cylinder of their radius is."""
    runs = struts.runs
    found = set()
    for face in shape.faces().filter_by(GeomType.CYLINDER):
        axis = face.axis_of_rotation
        origin, direction = np.array(tuple(axis.position)), np.array(tuple(axis.direction))
        off = np.linalg.norm(np.cross(runs.nodes[runs.edges] - origin, direction), axis=2)
        error = off.max(axis=1) + np.abs(runs.radii[:, 0] - face.radius)
        found.update(np.flatnonzero(error < 1e-6 * runs.radii[:, 0]).tolist())
    return found


def union_volume(skeleton: Skeleton, generator: np.random.Generator) -> tuple[float, float]:
    """Return the volume of the struts' union by Monte Carlo, without fillets, and its error.

    Points are drawn in the cones and balls that it is the union of, and count the less the more of
    these they are in. Ends are flat: links of a chain shorter than it is thick end at its plane.

    References
    ----------
    Karp, Luby, Monte-Carlo algorithms for enumeration and reliability problems, FOCS 1983.
    """
    pieces = _pieces(skeleton)
    start, end, radii = pieces
    axis = np.linalg.norm(end - start, axis=1)
    near, far = radii.T
    volumes = np.pi / 3 * axis * (near * near + near * far + far * far)
    volumes[axis == 0] = 4 / 3 * np.pi * near[axis == 0] ** 3
    chosen = generator.choice(len(volumes), SAMPLES, p=volumes / volumes.sum())
    points = _drawn((start[chosen], end[chosen], radii[chosen]), generator)
    order = np.argsort(points[:, 0])
    points = points[order]
    planes = _end_planes(skeleton)
    beyond = ((points - planes[0][chosen[order]]) * planes[1][chosen[order]]).sum(axis=1) > 0
    count = np.zeros(SAMPLES, dtype=np.intp)
    low = np.minimum(start, end)[:, 0] - radii.max(axis=1)
    high = np.maximum(start, end)[:, 0] + radii.max(axis=1)
    slices = np.searchsorted(points[:, 0], np.stack([low, high]))
    for first, last, *piece, tip, outward in zip(*slices, *pieces, *planes, strict=True):
        some = points[first:last]
        count[first:last] += _is_in(some, *piece) & ((some - tip) @ outward <= 0)
    share = 1.0 / np.maximum(count, 1)  # a point on a border may be in none
    share[beyond] = 0.0
    total = float(volumes.sum())
    return total * float(share.mean()), total * float(share.std() / np.sqrt(SAMPLES))


def _pieces(skeleton: Skeleton) -> tuple[Points, Points, Floats]:
    """Return cones by their ends (p, 3) and radii (p, 2); those of no length are balls."""
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    inner = (skeleton.valency[skeleton.edges] > 1).T  # (2, m)
    balls = [(place[own], radius[own]) for place, radius, own
             in zip((start, end), skeleton.edge_radii.T, inner, strict=True)]  # fmt: skip
    centers = np.concatenate([place for place, _ in balls])
    sizes = np.concatenate([radius for _, radius in balls])
    return (
        np.concatenate([start, centers]),
        np.concatenate([end, centers]),
        np.concatenate([skeleton.edge_radii, np.stack([sizes, sizes], axis=1)]),
    )


def _end_planes(skeleton: Skeleton) -> tuple[Points, Points]:
    """Return points and outward normals, (p, 3), of the planes at which cones and balls end.

    Normals of those that end at none are 0.
    """
    edges, near = skeleton.edges.tolist(), skeleton.edge_radii
    at: dict[int, list[int]] = {}
    for edge, pair in enumerate(edges):
        for node in pair:
            at.setdefault(node, []).append(edge)
    tips = np.zeros((len(edges), 2, 3))  # of the joint at each end of an edge
    outward = np.zeros((len(edges), 2, 3))
    for leaf in np.flatnonzero(skeleton.valency == 1).tolist():
        node, edge, normal, reach = leaf, at[leaf][0], None, 0.0
        while True:
            other = sum(edges[edge]) - node
            way = skeleton.nodes[node] - skeleton.nodes[other]
            way /= np.linalg.norm(way)
            if normal is None:
                normal, reach = way, float(near[edge, edges[edge].index(leaf)])
            elif way @ normal < 0.5 or near[edge].max() > 1.5 * reach:
                break
            tips[edge], outward[edge] = skeleton.nodes[leaf], normal
            depth = (skeleton.nodes[leaf] - skeleton.nodes[other]) @ normal
            if len(at[other]) != 2 or depth > near[edge].max():
                break
            node, edge = other, sum(at[other]) - edge
    inner = (skeleton.valency[skeleton.edges] > 1).T  # (2, m)
    balls = [(tips[own, side], outward[own, side]) for side, own in enumerate(inner)]
    return (
        np.concatenate([tips[:, 0], *(tip for tip, _ in balls)]),
        np.concatenate([outward[:, 0], *(normal for _, normal in balls)]),
    )


def _drawn(pieces: tuple[Points, Points, Floats], generator: np.random.Generator) -> Points:
    """Return a point in each piece, (p, 3), all places in it as likely."""
    start, end, radii = pieces
    length = np.linalg.norm(end - start, axis=1)
    ball = length == 0
    way = generator.normal(size=start.shape)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    near, far = radii.T
    size = np.cbrt(near**3 + generator.random(len(near)) * (far**3 - near**3))
    even = np.isclose(near, far)
    along = np.where(even, generator.random(len(near)), 0.0)
    along[~even] = ((size - near)[~even]) / (far - near)[~even]
    axis = (end - start) / np.where(ball, 1.0, length)[:, None]
    across = np.where(ball[:, None], way, way - (way * axis).sum(axis=1, keepdims=True) * axis)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    power = np.where(ball, 1 / 3, 1 / 2)
    reach = (near + along * (far - near)) * generator.random(len(near)) ** power
    found: Points = start + along[:, None] * (end - start) + reach[:, None] * across
    return found


def _is_in(points: Points, start: Points, end: Points, radii: Floats) -> Bools:
    """Return which points are in a cone, or in a ball if it has no length."""
    axis = end - start
    long = float(axis @ axis)
    along = (points - start) @ axis / long if long else np.zeros(len(points))
    across = np.linalg.norm(points - start - along[:, None] * axis, axis=1)
    found: Bools = (
        (along >= 0) & (along <= 1) & (across <= radii[0] + along * (radii[1] - radii[0]))
    )
    return found


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    radius, axis, ratios, mixed, facets = [], [], [], [], []
    joins, walls = [], []
    invalid, nodes, proved, struts_of, exact, outside = 0, 0, 0, 0, 0, 0
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "frame.step"
        for number in range(options.frames):
            skeleton = frame(KINDS[number % len(KINDS)], generator)
            struts = round_struts(skeleton)
            nodes += int((struts.runs.valency > 1).sum())
            proved += int(((struts.runs.valency > 1) & ~struts.crowded).sum())
            write(struts, path, overlaps="unite")
            shape = import_step(path)
            invalid += not (shape.is_valid and len(shape.solids()) == skeleton.component_count)
            errors = cylinder_errors(shape, struts)
            radius.append(errors[:, 0].max(initial=0))
            axis.append(errors[:, 1].max(initial=0))
            outside += axes_outside(shape, skeleton)
            volume, _ = union_volume(skeleton, generator)
            if len(struts.overlapping):
                mixed.append(shape.volume / volume)
                planes = shape.faces().filter_by(GeomType.PLANE)
                facets.append(sum(len(face.edges()) == 3 for face in planes))
                struts_of += len(struts.runs.edges)
                exact += len(with_cylinder(shape, struts))
                continue
            joins.append(worst_join(shape))
            fillets = fillet_volume(skeleton, np.nan_to_num(struts.fillet), generator)
            ratios.append(shape.volume / np.array([volume, volume + fillets]))
            wall = WALL * float(skeleton.edge_radii.min())
            hollow = round_struts(skeleton, wall=wall, ends="open")
            if len(hollow.overlapping) == 0:
                write(hollow, path)
                walls.append(least_wall(import_step(path), wall))
    print(f"{options.frames} frames in {time.perf_counter() - began:.0f} s")
    print(f"nodes with a proved blend and room: {proved} of {nodes}")
    print(f"invalid after re-import: {invalid} of {options.frames}; "
          f"points of axes that are not inside: {outside}")  # fmt: skip
    print(
        f"largest error of a cylinder's radius {max(radius):.1e}, of its axis {max(axis):.1e} radii"
    )
    print(f"largest angle between normals at an edge of two curved faces: {max(joins):.1e} degrees")
    for what, found in zip(("", " with its fillets"), np.transpose(ratios), strict=True):
        print(
            f"volume over the struts' union{what}: {found.min():.4f} to {found.max():.4f}, "
            f"median {np.median(found):.4f}"
        )
    if mixed:
        print(
            f"{len(mixed)} frames have nodes or struts without room: {min(facets)} to "
            f"{max(facets)} facets there, median {np.median(facets):.0f}; {exact} of {struts_of} "
            f"struts have a cylinder; volume over the union {min(mixed):.4f} to {max(mixed):.4f}"
        )
    print(
        f"least wall of {len(walls)} hollow frames, over what is asked: {min(walls):.3f}, less "
        f"{SAG:g} for triangles"
    )


if __name__ == "__main__":
    main()
