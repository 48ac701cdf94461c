"""The usual work, its aims and its peers, each measured in a process of its own."""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from scaffold_cad.filling import voronoi_foam
from scaffold_cad.io.write import write
from scaffold_cad.lattice import tile
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.struts import round_struts
from tests.benchmarks import peers

BOX = np.array([[0.0, 0.0, 0.0], [100.0, 100.0, 100.0]])


@dataclass(frozen=True)
class Result:
    """What one piece of work took."""

    seconds: float
    megabytes: float
    """Peak of the whole process, the making of the skeleton included."""


def bcc(count: int) -> Skeleton:
    return tile("bcc", 10.0, count, radius=0.7)


def octet(count: int) -> Skeleton:
    return tile("octet", 10.0, count, radius=0.5)


def foam() -> Skeleton:
    return voronoi_foam(1005, BOX, 0.7)


def scaffold(skeleton: Skeleton) -> None:
    build_scaffold(skeleton)


def solid(skeleton: Skeleton) -> None:
    to_solid(build_scaffold(skeleton))


def round_solid(skeleton: Skeleton) -> None:
    to_solid(round_struts(skeleton), sides=8)


def round_step(skeleton: Skeleton) -> None:
    with tempfile.TemporaryDirectory() as folder:
        write(round_struts(skeleton), Path(folder) / "out.step")


def stl(skeleton: Skeleton) -> None:
    _written(skeleton, ".stl")


def step(skeleton: Skeleton) -> None:
    _written(skeleton, ".step")


def _written(skeleton: Skeleton, suffix: str) -> None:
    made = build_scaffold(skeleton, collars=suffix == ".step")
    with tempfile.TemporaryDirectory() as folder:
        write(made.mesh, Path(folder) / f"out{suffix}")


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    make: Callable[[], Skeleton]
    ours: Callable[[Skeleton], None]
    aim: float
    """Time to reach, s."""
    peer: Callable[[Skeleton], None] | None = None
    package: str = ""
    """What the peer needs."""


FEQ, UNION, FUSE = peers.pygel_feq, peers.manifold_union, peers.build123d_fuse

ROWS = [
    Row("scaffold, BCC 10³", lambda: bcc(10), scaffold, 0.1, FEQ, "pygel3d"),
    Row("scaffold, BCC 20³", lambda: bcc(20), scaffold, 0.8, FEQ, "pygel3d"),
    Row("scaffold, BCC 50³", lambda: bcc(50), scaffold, 12.0),
    Row("scaffold, octet 4³", lambda: octet(4), scaffold, 0.05),
    Row("scaffold, octet 8³", lambda: octet(8), scaffold, 0.3),
    Row("scaffold, foam", foam, scaffold, 0.5, FEQ, "pygel3d"),
    Row("valid solid, foam", foam, solid, 10.0, UNION, "manifold3d"),
    Row("round solid, BCC 10³", lambda: bcc(10), round_solid, 0.8, UNION, "manifold3d"),
    Row("round solid, octet 8³", lambda: octet(8), round_solid, 2.0, UNION, "manifold3d"),
    Row("STEP, BCC 1³", lambda: bcc(1), step, 0.2, FUSE, "build123d"),
    Row("STEP, BCC 3³", lambda: bcc(3), step, 1.0),
    Row("STEP, BCC 6³", lambda: bcc(6), step, 6.0),
    Row("STEP, octet 2³", lambda: octet(2), step, 1.2),
    Row("round STEP, BCC 6³", lambda: bcc(6), round_step, 2.0),
    Row("STL, BCC 50³", lambda: bcc(50), stl, 20.0),
]


def measure(row: Row, work: Callable[[Skeleton], None], patience: float) -> Result | None:
    """Return what `work` takes in a process of its own; None if it fails or takes too long."""
    receiver, sender = Pipe(duplex=False)
    place = ROWS.index(row), work is not row.ours
    process = get_context("spawn").Process(target=_run, args=(*place, sender))
    process.start()
    sender.close()
    result = None
    try:
        if receiver.poll(patience):
            result = receiver.recv()
    except EOFError:  # it crashed
        pass
    process.kill()
    process.join()
    return result


def _run(number: int, is_peer: bool, sender: Connection) -> None:
    row = ROWS[number]
    work = row.peer if is_peer and row.peer is not None else row.ours
    if not is_peer:
        work(bcc(1))  # imports, which count for nobody
    skeleton = row.make()
    start = time.process_time()
    work(skeleton)
    seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    sender.send(Result(seconds, peak / (2**20 if sys.platform == "darwin" else 2**10)))
