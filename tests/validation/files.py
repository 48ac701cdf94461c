"""Files of real skeletons, as read back by programs that had no part in making them.

``python -m tests.validation.files [NAME …] [--seconds 120]`` writes every skeleton of
../shared/data and ../shared/data/reported at 1, 2 and 4 times its radii: square, round, and the
frame of the square one, in every format of meshes and as STEP. trimesh, lib3mf and OCCT read them,
CGAL looks for crossings in exact arithmetic, and the volume of round struts is held against a count
of random points in the struts. STEP files of round struts have facets where these overlap. Small
skeletons come first; times are those of the processor, and not the judges'. What is not written is
said: STEP files of square struts that overlap or of too many, and what took longer than allowed.
"""

from __future__ import annotations

import argparse
import hashlib
import logging
import multiprocessing
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
import trimesh

from scaffold_cad import (
    RoundStruts,
    Scaffold,
    Skeleton,
    build_scaffold,
    read_skeleton,
    round_struts,
    write,
)
from scaffold_cad.base.arrays import Points, Triangles
from scaffold_cad.errors import FormatError, ScaffoldCadError
from scaffold_cad.solid.thicken import frame_scaffold
from tests.crossings import faults_by_cgal
from tests.real_files import RADII
from tests.validation.struts import union_volume

DATA = Path(__file__).parents[2] / ".." / "shared" / "data"
RADIUS = {
    "test_mocapbank.bvh": 1.5,
    "C60-buckminsterfullerene.cjson": 0.2,
    "Leica_Disto_S910.dxf": 0.02,
    "dxf_T.dxf": 1.0,
    "dxf_X.dxf": 1.0,
    **RADII,
}
FACTORS = (1, 2, 4)
KINDS = ("square", "round", "frame")
FORMATS = (".stl", ".3mf", ".obj", ".ply", ".glb")
FRAME = 0.15
"""Radius of a frame, in median radii."""
FILLETS = 1.25
"""Largest volume of round struts over that of their union: it has fillets."""
STEP_APART = 0.02
"""Largest difference in volume of a STEP file and of the STL file, whose quads are split in two."""
MOST_FACES = 4000
"""Struts of a skeleton whose STEP file is made: one of facets has 32 faces per strut."""
JUDGED = "-"
"""What a process says when judges begin, and when they are done."""
NOTE = "("
"""What a line that is not a fault begins with."""


def skeletons() -> list[Path]:
    """Return the files, those of the fewest struts first."""
    files = [
        path
        for folder in (DATA, DATA / "reported", DATA / "reported" / "formats")
        for path in folder.glob("*.*")
        if path.is_file() and path.suffix != ".md"
    ]
    return sorted(files, key=lambda path: (size_of(path), path.name))


def size_of(path: Path) -> int:
    """Return how many struts a file has, 0 for one that holds no skeleton."""
    try:
        return len(skeleton_in(path).edges)
    except ScaffoldCadError:
        return 0


def skeleton_in(path: Path) -> Skeleton:
    """Return the skeleton in a file, its radii a twelfth of its lengths where it has none."""
    if path.name in RADIUS:
        return read_skeleton(path, RADIUS[path.name])
    try:
        return read_skeleton(path)
    except FormatError:
        bare = read_skeleton(path, 1.0)
        return bare.with_radii(float(np.median(bare.lengths)) / 12)


def read_back(path: Path) -> tuple[Points, Triangles]:
    """Return the vertices (v, 3) and triangles (t, 3) of a written file."""
    if path.suffix == ".3mf":  # lib3mf itself, without this package
        import lib3mf

        model = lib3mf.get_wrapper().CreateModel()
        model.QueryReader("3mf").ReadFromFile(str(path))
        meshes = model.GetMeshObjects()
        points, corners, count = [], [], 0
        while meshes.MoveNext():
            mesh = meshes.GetCurrentMeshObject()
            points.append(np.array([vertex.Coordinates[:] for vertex in mesh.GetVertices()]))
            corners.append(np.array([tri.Indices[:] for tri in mesh.GetTriangleIndices()]) + count)
            count += len(points[-1])
        return np.concatenate(points), np.concatenate(corners)
    mesh = trimesh.load_mesh(path, process=False)
    scale = 1000.0 if path.suffix == ".glb" else 1.0  # glTF has meters
    return scale * np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces)


def faults(path: Path, parts: int, judged: dict[bytes, str]) -> tuple[str, float]:
    """Return what is wrong with a written file, "" for nothing, and its volume.

    Parameters
    ----------
    judged : what is wrong with triangles that were read from another format, by their hash
    """
    if path.suffix == ".step":  # facets of square struts are bilinear
        from build123d import import_step

        shape = import_step(path)
        return "" if shape.is_valid and len(shape.solids()) <= parts else "invalid", shape.volume
    vertices, triangles = read_back(path)
    key = hashlib.sha256((vertices[triangles] + 0.0).tobytes()).digest()
    mesh = trimesh.Trimesh(vertices, triangles)
    if key not in judged:
        found = faults_by_cgal(vertices, triangles)
        if not mesh.is_watertight:
            found = found or "not watertight"
        if mesh.body_count > parts:
            found = found or f"{mesh.body_count} bodies for {parts}"
        judged[key] = found
    return judged[key], float(mesh.volume)


def check(path: Path, factor: float, kind: str) -> Iterator[str]:
    """Yield what is wrong with the files of one skeleton, one line a fault.

    Before the judges begin it yields `JUDGED`, and once more when they are done; lines that begin
    with `NOTE` are not faults.
    """
    skeleton = skeleton_in(path)
    skeleton = skeleton.with_edge_radii(factor * skeleton.edge_radii)
    made = made_of(skeleton, kind)
    volumes: dict[str, float] = {}
    judged: dict[bytes, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (*FORMATS, ".step"):
            if suffix == ".step" and (why := why_no_step(made)):
                yield f"{NOTE}no STEP: {why})"
                continue
            file = Path(folder) / f"written{suffix}"
            write(made, file, overlaps="unite")
            yield JUDGED
            found, volumes[suffix] = faults(file, skeleton.component_count, judged)
            yield JUDGED
            if found:
                yield f"{suffix}: {found}"
    for suffix, volume in volumes.items():
        most = STEP_APART if suffix == ".step" else 1e-5
        if abs(volume / volumes[".stl"] - 1) > most:
            yield f"{suffix}: volume {volume:g} beside {volumes['.stl']:g} of .stl"
    if kind == "round":
        yield JUDGED
        union, error = union_volume(skeleton, np.random.default_rng(0))
        yield JUDGED
        ratio = volumes[".stl"] / union
        if not 0.99 - 3 * error / union < ratio < FILLETS:
            yield f"volume is {ratio:.3f} of the struts' union"


def why_no_step(made: Scaffold | RoundStruts) -> str:
    """Return why no STEP file is written, "" if one is."""
    if isinstance(made, Scaffold) and (count := len(made.embedding().left_out)):
        return f"{count} struts overlap"
    count = len(made.skeleton.edges)
    return "" if count < MOST_FACES else f"{count} struts"


def made_of(skeleton: Skeleton, kind: str) -> Scaffold | RoundStruts:
    """Return what is written of a skeleton."""
    if kind == "round":
        return round_struts(skeleton)
    square = build_scaffold(skeleton)
    if kind == "square":
        return square
    return frame_scaffold(square, FRAME * float(np.median(skeleton.radii)))


def run(path: Path, factor: float, kind: str, seconds: float, told: Connection) -> None:
    """Check one skeleton in a process of its own, which ends when its processor time is over.

    The time of the judges does not count.
    """
    logging.disable(logging.WARNING)
    left, judging, began = seconds, False, time.process_time()
    signal.setitimer(signal.ITIMER_PROF, left)
    try:
        for line in check(path, factor, kind):
            if line != JUDGED:
                told.send(line)
                continue
            judging = not judging
            if judging:
                left -= time.process_time() - began
            began = time.process_time()
            signal.setitimer(signal.ITIMER_PROF, 0 if judging else max(left, 0.01))
    except ScaffoldCadError as error:
        told.send(f"refused: {str(error)[:150]}")
    except BaseException as error:  # what no user should see
        told.send(f"{type(error).__name__}: {str(error)[:150]}")
    signal.setitimer(signal.ITIMER_PROF, 0)
    left -= 0.0 if judging else time.process_time() - began
    told.send((seconds - left, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6))


def outcome(path: Path, factor: float, kind: str, seconds: float) -> tuple[list[str], float, float]:
    """Return the faults of one skeleton, the seconds, and the greatest memory in GB."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__, "build123d", "lib3mf", "manifold3d"])
    ours, told = context.Pipe(duplex=False)
    process = context.Process(target=run, args=(path, factor, kind, seconds, told))
    process.start()
    told.close()
    found: list[str] = []
    try:
        while isinstance(line := ours.recv(), str):
            found.append(line)
        process.join()
        return found, *line
    except EOFError:
        process.join()
        over = process.exitcode == -signal.SIGPROF
        found.append(f"not done in {seconds:.0f} s" if over else f"ended: {process.exitcode}")
        return found, seconds, 0.0


def grade(found: list[str]) -> str:
    """Return the column of the last line that a skeleton is counted in."""
    lines = [line for line in found if not line.startswith(NOTE)]
    if not lines:
        return "good"
    if len(lines) == 1 and lines[0].startswith(("refused", "not done")):
        return "refused" if lines[0].startswith("refused") else "over time"
    return "with a fault"


def main() -> int:
    """Print one line a skeleton and kind; return how many had a fault, 1 at most."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="files, all by default")
    parser.add_argument("--seconds", type=float, default=120.0, help="of processor time for one")
    parser.add_argument("--factors", type=float, nargs="*", default=FACTORS)
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=KINDS)
    options = parser.parse_args()
    logging.disable(logging.WARNING)
    done: Counter[str] = Counter()
    for path in skeletons():
        if options.names and path.name not in options.names:
            continue
        for factor in options.factors:
            for kind in options.kinds:
                found, seconds, memory = outcome(path, factor, kind, options.seconds)
                done[grade(found)] += 1
                what = f"{path.name[:40]:<40} x{factor:<3g} {kind:<6}"
                print(f"{what} {seconds:6.1f} s {memory:5.2f} GB  {'; '.join(found)}", flush=True)
    print(", ".join(f"{count} {what}" for what, count in sorted(done.items())))
    return int(done["with a fault"] > 0)


if __name__ == "__main__":
    sys.exit(main())
