"""The check against seeded faults and against slicers: `python -m tests.validation.printability`.

Slicers exit with 0 on every broken mesh and repair it silently; none sees a surface that crosses
itself. So the faults that are put into good solids here are the reference for the check, and the
slicers are for what they count: parts, triangles turned over, volume, filament.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from scaffold_cad import TriangleMesh, build_scaffold, read_skeleton, tile, to_solid
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.io.stl import write_stl
from scaffold_cad.printability import PROCESSES, Report, check_printability, read_triangles
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from tests.meshes import torus
from tests.skeletons import NAMED

ROOT = Path(__file__).parents[2]
SLICER = "prusa-slicer"
ADMESH = "admesh"

POWDER = replace(PROCESSES["sls"], least_opening=0.0)
"""Laser sintering without the search for pockets: the faults are in the surface."""

Random = np.random.Generator

# ---------------------------------------------------------------------------------------------
# Good solids
# ---------------------------------------------------------------------------------------------


def good_solid(random: Random) -> TriangleMesh:
    """Return a solid without fault: one of seven kinds, turned and of any size."""
    kind = _KINDS[random.integers(len(_KINDS))]
    mesh = kind(random)
    matrix = np.linalg.qr(random.normal(size=(3, 3)))[0]
    matrix *= np.linalg.det(matrix) * random.uniform(0.5, 3.0)
    return TriangleMesh(mesh.vertices @ matrix + random.uniform(-20, 20, 3), mesh.triangles)


def _of_skeleton(skeleton: Skeleton, collars: bool = False) -> TriangleMesh:
    return manifold_triangles(to_solid(build_scaffold(skeleton, collars=collars)))


def _named(random: Random) -> TriangleMesh:
    skeleton = list(NAMED.values())[random.integers(len(NAMED))]
    if skeleton.component_count > 1:
        return _named(random)
    return _of_skeleton(skeleton.scaled(random.uniform(0.5, 2.0)), bool(random.integers(2)))


def _tree(random: Random) -> TriangleMesh:
    count = int(random.integers(3, 12))
    nodes = [np.zeros(3)]
    edges = []
    for node in range(1, count):
        parent = int(random.integers(node))
        step = random.normal(size=3)
        nodes.append(nodes[parent] + step / np.linalg.norm(step) * random.uniform(8, 14))
        edges.append((parent, node))
    skeleton = Skeleton(np.array(nodes), np.array(edges), random.uniform(0.3, 0.6, count))
    mesh = _of_skeleton(skeleton.cleaned().skeleton)
    return mesh if len(to_solid(mesh).decompose()) == 1 else _tree(random)


def _lattice(random: Random) -> TriangleMesh:
    cell = ("sc", "bcc", "fcc", "octet", "kelvin", "diamond")[random.integers(6)]
    counts = tuple(int(count) for count in random.integers(1, 3, 3))
    size = random.uniform(5, 10)
    skeleton = tile(cell, size, counts, radius=size * random.uniform(0.03, 0.06))
    largest = np.bincount(skeleton.component_of_node).argmax()
    kept = skeleton.component_of_node == largest  # diamond cells have loose corners
    number = np.cumsum(kept) - 1
    edges = number[skeleton.edges[kept[skeleton.edges].all(axis=1)]]
    return _of_skeleton(Skeleton(skeleton.nodes[kept], edges, skeleton.radii[kept]))


def _torus(random: Random) -> TriangleMesh:
    around, across = (int(count) for count in random.integers(5, 20, 2))
    mesh = torus(around, across, seed=int(random.integers(2**32)))
    return TriangleMesh(mesh.vertices, mesh.triangles)


def _union(random: Random) -> TriangleMesh:
    import manifold3d

    parts = [manifold3d.Manifold.cube((4, 4, 4), center=True)]
    for _ in range(int(random.integers(1, 4))):
        across = manifold3d.Manifold.cylinder(
            random.uniform(6, 12), random.uniform(0.5, 1.5), circular_segments=12, center=True
        )
        parts.append(across.rotate(random.uniform(0, 360, 3).tolist()))
    return manifold_triangles(manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add))


def _pierced(random: Random) -> TriangleMesh:
    import manifold3d

    ball = manifold3d.Manifold.sphere(random.uniform(4, 6), circular_segments=20)
    hole = manifold3d.Manifold.cylinder(
        20, random.uniform(0.5, 2), circular_segments=10, center=True
    )
    return manifold_triangles(ball - hole.rotate(random.uniform(0, 360, 3).tolist()))


def _frame(random: Random) -> TriangleMesh:
    skeleton = NAMED[("tripod", "k4", "elbow", "cross")[random.integers(4)]]
    scaffold = build_scaffold(skeleton.scaled(2.0))
    mesh = scaffold.mesh
    return _of_skeleton(
        Skeleton(mesh.vertices, mesh.edges, np.array(random.uniform(0.05, 0.15))), collars=True
    )


_KINDS = (_named, _tree, _lattice, _torus, _union, _pierced, _frame)

# ---------------------------------------------------------------------------------------------
# Faults
# ---------------------------------------------------------------------------------------------


def _hole(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    lost = random.choice(len(mesh.triangles), int(random.integers(1, 4)), replace=False)
    return TriangleMesh(mesh.vertices, np.delete(mesh.triangles, lost, axis=0))


def _flipped(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    turned = random.choice(len(mesh.triangles), int(random.integers(1, 4)), replace=False)
    triangles = mesh.triangles.copy()
    triangles[turned] = triangles[turned, ::-1]
    return TriangleMesh(mesh.vertices, triangles)


def _inside_out(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1])


def _self_overlap(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    """Add the solid once more a little beside itself, or a small body within it."""
    if random.integers(2):
        return _with(mesh, _tetrahedron_within(mesh, random))
    shift = random.normal(size=3)
    shift *= random.uniform(0.02, 0.2) * _thickness(mesh) / np.linalg.norm(shift)
    return _with(mesh, TriangleMesh(mesh.vertices + shift, mesh.triangles))


def _crossing_tube(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    """Return, whatever the solid, a tube that goes through itself: one surface, closed."""
    height = random.uniform(-0.5, 0.5)
    nodes = np.array([[-10, 0, 0], [10, 0, 0], [4, 9, 0], [0, -9, height]], dtype=np.float64)
    nodes[1:3] += random.uniform(-1, 1, (2, 3))
    edges = np.array([[0, 1], [1, 2], [2, 3]])
    if random.integers(2):
        edges = np.concatenate([edges, [[3, 0]]])
    tube = build_scaffold(Skeleton(nodes, edges, np.array(random.uniform(0.5, 1.2)))).mesh
    return TriangleMesh(tube.vertices, tube.triangles)


def _four_at_an_edge(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    """Hang a tetrahedron on an edge of the solid, from outside."""
    row = mesh.triangles[random.integers(len(mesh.triangles))]
    a, b, c = mesh.vertices[row]
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    side = np.cross(normal, b - a)
    length = np.linalg.norm(b - a) * random.uniform(0.1, 0.5)
    side *= length / np.linalg.norm(side)
    middle = (a + b) / 2 + normal * length
    vertices = np.concatenate([mesh.vertices, [middle - side, middle + side]])
    v, w, p, q = row[0], row[1], len(mesh.vertices), len(mesh.vertices) + 1
    body = np.array([[v, w, p], [w, v, q], [v, p, q], [w, q, p]])
    if TriangleMesh(vertices, body).signed_volume < 0:
        body = body[:, ::-1]
    return TriangleMesh(vertices, np.concatenate([mesh.triangles, body]))


def _degenerate(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    """Split an edge on one of its sides only and close the slit, or repeat a corner."""
    chosen = int(random.integers(len(mesh.triangles)))
    a, b, c = mesh.triangles[chosen]
    if random.integers(2):
        return TriangleMesh(mesh.vertices, np.concatenate([mesh.triangles, [[a, b, b]]]))
    middle = len(mesh.vertices)
    vertices = np.concatenate([mesh.vertices, [(mesh.vertices[a] + mesh.vertices[b]) / 2]])
    new = [[a, middle, c], [middle, b, c], [a, b, middle]]
    kept = np.delete(mesh.triangles, chosen, axis=0)
    return TriangleMesh(vertices, np.concatenate([kept, new]))


def _void(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    hollow = _tetrahedron_within(mesh, random)
    return _with(mesh, TriangleMesh(hollow.vertices, hollow.triangles[:, ::-1]))


def _tetrahedron_within(mesh: TriangleMesh, random: Random) -> TriangleMesh:
    """Return a small outward tetrahedron inside the solid, clear of its surface."""
    while True:
        corners = mesh.vertices[mesh.triangles[random.integers(len(mesh.triangles))]]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        center = corners.mean(axis=0) - 0.2 * _thickness(mesh) * normal / np.linalg.norm(normal)
        shape = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
        rows = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
        body = TriangleMesh(center + 0.03 * _thickness(mesh) * shape, rows)
        if math.isclose((to_solid(mesh) ^ to_solid(body)).volume(), body.signed_volume):
            return body


def _thickness(mesh: TriangleMesh) -> float:
    """Return a length of the order of the solid's thickness: volume over area."""
    corners = mesh.vertices[mesh.triangles]
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 4.0 * mesh.signed_volume / float(np.linalg.norm(sides, axis=1).sum() / 2)


def _with(one: TriangleMesh, other: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(
        np.concatenate([one.vertices, other.vertices]),
        np.concatenate([one.triangles, other.triangles + len(one.vertices)]),
    )


Fault = Callable[[TriangleMesh, Random], TriangleMesh]

FAULTS: dict[str, tuple[Fault, frozenset[str]]] = {
    "hole": (_hole, frozenset({"watertight"})),
    "flipped faces": (_flipped, frozenset({"winding"})),
    "inside out": (_inside_out, frozenset({"orientation"})),
    "self-overlap": (_self_overlap, frozenset({"overlapping_shells", "self_intersections"})),
    "self-crossing tube": (_crossing_tube, frozenset({"self_intersections"})),
    "edge of four faces": (_four_at_an_edge, frozenset({"manifold_edges"})),
    "degenerate faces": (_degenerate, frozenset({"degenerate_triangles"})),
    "enclosed void": (_void, frozenset({"voids"})),
}
"""How each kind of fault is made, and the findings any of which must name it."""


def faulty_solid(kind: str, seed: int) -> TriangleMesh:
    """Return a good solid with a fault of one kind."""
    random = np.random.default_rng([seed, *kind.encode()])
    return FAULTS[kind][0](good_solid(random), random)


def alarms(report: Report) -> set[str]:
    """Return the names of the findings on the surface that are not as they must be."""
    return {
        finding.name
        for finding in report
        if finding.topic == "mesh" and finding.verdict in ("warning", "failure")
    }


def is_named(kind: str, report: Report) -> bool:
    """Return whether a report names the fault of one kind."""
    return bool(alarms(report) & FAULTS[kind][1])


def through_stl(mesh: TriangleMesh) -> TriangleMesh:
    """Return a mesh as it comes back from an STL file, written with all its faults."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.stl"
        write_stl(mesh, path)
        again = read_triangles(path)
    assert again is not None
    return again


def seeded_faults(count: int) -> Iterator[str]:
    """Yield what the check says of `count` solids with faults, and of as many without."""
    kinds = list(FAULTS)
    for way, passed_on in (("as made", lambda mesh: mesh), ("from STL", through_stl)):
        missed: Counter[str] = Counter()
        for seed in range(count):
            kind = kinds[seed % len(kinds)]
            report = check_printability(passed_on(faulty_solid(kind, seed)), POWDER)
            missed[kind] += not is_named(kind, report)
        found = count - missed.total()
        which = ", ".join(f"{kind} {number}" for kind, number in missed.items() if number)
        yield f"{way}: {found} of {count} faults named{f'; missed: {which}' if which else ''}"
        false: Counter[str] = Counter()
        for seed in range(count):
            solid = passed_on(good_solid(np.random.default_rng(seed)))
            false[", ".join(sorted(alarms(check_printability(solid, POWDER))))] += 1
        del false[""]
        yield f"{way}: {false.total()} false alarms in {count} good solids {dict(false) or ''}"


# ---------------------------------------------------------------------------------------------
# Slicers
# ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Seen:
    """What a tool says of a mesh file."""

    manifold: bool
    parts: int
    reversed_facets: int
    degenerate_facets: int
    volume: float
    """mm³."""


def seen_by_slicer(path: Path) -> Seen:
    """Return what `prusa-slicer --info` says of a mesh file."""
    text = _said([SLICER, "--info", str(path)])
    return Seen(
        "manifold = yes" in text,
        int(_number(text, r"number_of_parts =\s+(\d+)")),
        int(_number(text, r"facets_reversed =\s+(\d+)", 0)),
        int(_number(text, r"degenerate_facets =\s+(\d+)", 0)),
        _number(text, r"volume = ([-\d.e+]+)"),
    )


def seen_by_admesh(path: Path) -> Seen:
    """Return what ADMesh says of an STL file, before its repairs."""
    text = _said([ADMESH, str(path)])
    return Seen(
        _number(text, r"Total disconnected facets +: +(\d+)") == 0,
        int(_number(text, r"Number of parts +: +(\d+)")),
        int(_number(text, r"Facets reversed +: +(\d+)")),
        int(_number(text, r"Degenerate facets +: +(\d+)")),
        _number(text, r"Volume +: +([-\d.e+]+)"),
    )


TOOLS: dict[str, Callable[[Path], Seen]] = {SLICER: seen_by_slicer, ADMESH: seen_by_admesh}


def faults_seen_by_tools(count: int) -> Iterator[str]:
    """Yield how many of `count` solids with each kind of fault the tools say anything about."""
    for kind in FAULTS:
        noticed: Counter[str] = Counter()
        for seed in range(count):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "part.stl"
                write_stl(faulty_solid(kind, seed), path)
                for tool, see in TOOLS.items():
                    if shutil.which(tool) is not None:
                        seen = see(path)
                        odd = seen.reversed_facets + seen.degenerate_facets
                        noticed[tool] += not (seen.manifold and odd == 0 and seen.volume > 0)
        said = ", ".join(f"{tool} notices {number}" for tool, number in noticed.items())
        yield f"{kind}: of {count} {said or 'no tool is installed'}"


def filament_volume(path: Path, folder: Path) -> float:
    """Return the volume of the filament of a sliced mesh file at 100 % infill, mm³.

    Extrusion is counted from the first layer's start to the last's end: skirt, brim and supports
    are off.
    """
    code = folder / (path.stem + ".gcode")
    options = {
        "fill-density": "100%",
        "fill-pattern": "rectilinear",
        "skirts": "0",
        "brim-width": "0",
        "nozzle-diameter": "0.4",
        "layer-height": "0.1",
        "first-layer-height": "0.1",
        "filament-diameter": "1.75",
        "extrusion-multiplier": "1",
        "infill-overlap": "15%",
    }
    words = [word for name, value in options.items() for word in (f"--{name}", value)]
    command = [SLICER, "--export-gcode", *words, "--output", str(code), str(path)]
    _said(command)
    return (
        _number(code.read_text(encoding="utf-8"), r"; filament used \[mm3?\] = ([\d.]+)")
        * math.pi
        * 0.875**2
    )


def _said(command: list[str]) -> str:
    # Some repeat bytes of the file's header.
    run = subprocess.run(
        command, capture_output=True, encoding="utf-8", errors="replace", timeout=300, check=True
    )
    return run.stdout + run.stderr


def _number(text: str, pattern: str, default: float | None = None) -> float:
    found = re.search(pattern, text)
    if found is None:
        if default is None:
            raise ValueError(f"{pattern!r} is not in {text!r}")
        return default
    return float(found[1])


# ---------------------------------------------------------------------------------------------
# Reports of real files
# ---------------------------------------------------------------------------------------------


def files_of_skeletons() -> Iterator[Path]:
    """Yield the examples' skeletons, then the real files beside the repository that can be read."""
    yield from sorted((ROOT / "examples" / "skeletons").glob("*.json"))
    shared = ROOT / ".." / "shared" / "data"
    if shared.is_dir():
        yield from sorted(path for path in shared.iterdir() if path.suffix != ".md")


def skeleton_of(path: Path) -> Skeleton:
    """Return the skeleton of a file as large as 100 mm, with radii if it has none."""
    try:
        skeleton = read_skeleton(path)
    except ScaffoldCadError:
        skeleton = read_skeleton(path, 1.0)
        skeleton = skeleton.with_radii(0.2 * float(np.median(skeleton.lengths)))
    check_skeleton(skeleton)
    return skeleton.scaled(100.0 / float(np.ptp(skeleton.nodes, axis=0).max()))


def lines_of_reports() -> Iterator[str]:
    """Yield a line per file: the verdict, and whether the slicers agree on parts and volume."""
    for path in files_of_skeletons():
        try:
            skeleton = skeleton_of(path)
            solid = to_solid(build_scaffold(skeleton))
            report = check_printability(
                solid, "fdm", skeleton=skeleton, name=path.name, direction="best"
            )
        except ScaffoldCadError as error:
            yield f"{path.name}: {error}"
            continue
        yield f"{report.summary} | {agreement(report)}"


def lines_of_outputs() -> Iterator[str]:
    """Yield a line for each mesh file that a program of the examples or the gallery writes."""
    for script in sorted((ROOT / "examples").glob("**/[!_]*.py")):
        with tempfile.TemporaryDirectory() as folder:
            # As a program is run by hand; what it says is not wanted here.
            command = [sys.executable, str(script)]
            subprocess.run(command, cwd=folder, capture_output=True, timeout=600, check=True)
            for path in sorted(Path(folder).glob("*.stl")):
                mesh = read_triangles(path)
                report = check_printability(mesh, "sls", name=f"{script.stem}/{path.name}")
                yield f"{report.summary} | {agreement(report)}"


def agreement(report: Report) -> str:
    """Return how the tools that are installed see the checked surface, in one line."""
    volume = report["volume"].value["volume_mm3"]
    parts = report["components"].value["shells"]  # slicers count those
    said = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.stl"
        write_stl(report.mesh, path)
        for tool, see in TOOLS.items():
            if shutil.which(tool) is None:
                said.append(f"{tool} is not installed")
                continue
            seen = see(path)
            agrees = seen.manifold and seen.parts == parts and seen.reversed_facets == 0
            said.append(
                f"{tool} {'agrees' if agrees else f'differs: {seen}'}, "
                f"volume {seen.volume / volume - 1:+.1e}"
            )
    return "; ".join(said)


def main() -> None:
    """Print everything."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for line in lines_of_reports():
        print(line, flush=True)
    for line in lines_of_outputs():
        print(line, flush=True)
    for line in seeded_faults(count):
        print(line, flush=True)
    for line in faults_seen_by_tools(max(count // len(FAULTS), 1)):
        print(line, flush=True)


if __name__ == "__main__":
    main()
