"""Beams of a 3MF file written, counted and measured as they stream by, and read by lib3mf.

Run as ``python -m tests.validation.beams [--beams 1e8] [--lib3mf]``. Memory of the counting is the
positions of all nodes in 32 bits; that of lib3mf is some 60 bytes per beam.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from subprocess import run
from sys import executable
from tempfile import TemporaryDirectory
from zipfile import ZipFile

import numpy as np

from scaffold_cad import PeriodicLattice, write

PIECE = 1 << 24
"""Bytes of text that are looked at together."""

SPACES = bytes(
    code if chr(code) in "0123456789.-+" else 32  # all else separates numbers
    for code in range(256)
)

READ = """
import lib3mf, sys, time
start = time.process_time()
reader = (model := lib3mf.Wrapper().CreateModel()).QueryReader("3mf")
reader.ReadFromFile(sys.argv[1])
meshes = model.GetMeshObjects()
meshes.MoveNext()
mesh = meshes.GetCurrentMeshObject()
print(mesh.GetVertexCount(), mesh.BeamLattice().GetBeamCount(), reader.GetWarningCount(),
      time.process_time() - start)
"""


@dataclass(frozen=True)
class Counted:
    """What a file of beams holds."""

    vertices: int
    beams: int
    shortest: float
    """Length of the shortest beam, mm."""
    longest: float
    """Length of the longest beam, mm."""


def counted(path: Path) -> Counted:
    """Return what is in a 3MF file of one object whose beams have one radius."""
    places: list[np.ndarray] = []
    nodes = np.zeros((0, 3), dtype=np.float32)
    beams, least, most = 0, np.inf, 0.0
    for piece in lines_of(path):
        head, found, rest = piece.partition(b"<b:beams>")
        if found or not len(nodes):
            places.append(_numbers(head.partition(b"<vertices>")[2] or head, b"<vertex ", 3))
        if found:
            nodes = np.concatenate(places).astype(np.float32)
            places, piece = [], rest
        if len(nodes):
            ends = _numbers(piece, b"<b:beam ", 2).astype(np.intp)  # (k, 2)
            if len(ends):
                span = nodes[ends[:, 0]] - nodes[ends[:, 1]]
                lengths = np.sqrt((span * span).sum(axis=1))
                beams += len(ends)
                least, most = min(least, float(lengths.min())), max(most, float(lengths.max()))
    return Counted(len(nodes), beams, least, most)


def lines_of(path: Path) -> Iterator[bytes]:
    """Yield the model of a 3MF file, some whole lines at a time."""
    with ZipFile(path) as archive, archive.open("3D/3dmodel.model") as file:
        left = b""
        while piece := file.read(PIECE):
            whole, _, after = (left + piece).rpartition(b"\n")
            yield whole + b"\n"
            left = after
        yield left


def _numbers(text: bytes, tag: bytes, columns: int) -> np.ndarray:
    """Return the numbers in all elements `tag`, a line each, shape (k, columns)."""
    count = text.count(tag)
    start, end = text.find(tag), text.rfind(tag)
    if count == 0:
        return np.zeros((0, columns))
    rows = text[start : text.index(b"/>", end)].replace(b"v1", b"").replace(b"v2", b"")
    found = np.fromstring(rows.translate(SPACES), sep=" ")
    return found.reshape(count, columns)


def main() -> None:
    """Write, count and say; raise where what is read is not what was written."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--beams", type=float, default=1e6)
    parser.add_argument("--lib3mf", action="store_true", help="have lib3mf read the file too")
    options = parser.parse_args()
    side = max(1, round((options.beams / 8) ** (1 / 3)))
    deep = round(options.beams / 8 / side**2)
    lattice = PeriodicLattice("bcc", 1.0, (deep, side, side), radius=0.1)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "beams.3mf"
        start = time.process_time()
        write(lattice, path)
        print(
            f"{lattice.strut_count} beams written: {time.process_time() - start:.0f} s, {_peak()}, "
            f"{path.stat().st_size / lattice.strut_count:.2f} bytes per beam",
            flush=True,
        )
        check(path, lattice)
        if options.lib3mf:
            made = run(
                [executable, "-c", READ, str(path)], capture_output=True, text=True, check=False
            )
            print(f"lib3mf: {made.stdout.strip() or made.stderr.strip()[-300:]}")


def check(path: Path, lattice: PeriodicLattice) -> None:
    """Raise unless a file holds all beams of a BCC lattice of 1 mm, none longer than another."""
    start = time.process_time()
    found = counted(path)
    x, y, z = lattice.counts
    if found.beams != lattice.strut_count:
        raise RuntimeError(f"{found.beams} beams are in the file; need {lattice.strut_count}")
    nodes = x * y * z + (x + 1) * (y + 1) * (z + 1)
    if found.vertices != nodes:
        raise RuntimeError(f"{found.vertices} vertices are in the file; need {nodes}")
    half = np.sqrt(0.75)
    if abs(found.shortest - half) > 1e-4 or abs(found.longest - half) > 1e-4:
        raise RuntimeError(f"beams are {found.shortest} to {found.longest} mm long; need {half}")
    print(
        f"all {found.beams} beams and {nodes} vertices read back, each beam {half:.4f} mm long: "
        f"{time.process_time() - start:.0f} s, {_peak()}",
        flush=True,
    )


def _peak() -> str:
    return f"peak {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3:.0f} MB"


if __name__ == "__main__":
    main()
