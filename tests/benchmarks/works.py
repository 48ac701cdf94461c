"""The usual work, its aims and its peers, each measured in a process of its own."""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.filling import voronoi_foam
from scaffold_cad.io.write import write
from scaffold_cad.lattice import PeriodicLattice, tile
from scaffold_cad.layers import slices
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.struts import RoundStruts, round_struts
from tests.benchmarks import large, peers
from tests.struts.stars import random_stars

LAYER = 0.04
"""Thickness of layers, mm."""

SEED = 1
STAR_LENGTH = 12.0
"""Length of the struts of random stars, mm: of radii about 1."""

BOX = np.array([[0.0, 0.0, 0.0], [100.0, 100.0, 100.0]])


@dataclass(frozen=True)
class Result:
    """What one piece of work took."""

    seconds: float
    megabytes: float
    """Peak of the whole process, the making of the skeleton included."""
    told: str
    """What the work says of itself."""


def bcc(count: int) -> Skeleton:
    return tile("bcc", 10.0, count, radius=0.7)


def octet(count: int) -> Skeleton:
    return tile("octet", 10.0, count, radius=0.5)


def foam() -> Skeleton:
    return voronoi_foam(1005, BOX, 0.7)


def stars(count: int, valency: int, spread: float) -> Skeleton:
    """Return random stars apart from each other, with radii between 1 / `spread` and `spread`."""
    rng = np.random.default_rng(SEED)
    directions = random_stars(count, valency, 30.0, rng)  # (count, N, 3)
    centers = STAR_LENGTH * 3 * np.stack([np.arange(count), np.zeros(count), np.zeros(count)], 1)
    ends = centers[:, None] + STAR_LENGTH * directions
    nodes = np.concatenate([centers, ends.reshape(-1, 3)])
    edges = [np.repeat(np.arange(count), valency), count + np.arange(count * valency)]
    radii = np.exp(rng.uniform(-np.log(spread), np.log(spread), count * valency))
    return Skeleton(nodes, np.stack(edges, axis=1), np.ones(len(nodes)), edge_radii=radii)


def blends_of_stars(skeleton: Skeleton) -> None:
    round_struts(skeleton)


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


def struts(cell: str, count: int, radius: float) -> RoundStruts:
    return round_struts(tile(cell, 1.0, count, radius=radius))


def layers_of_struts(made: RoundStruts) -> None:
    top = float(made.skeleton.nodes[:, 2].max())
    for _ in slices(made, np.arange(LAYER / 2, top, LAYER)):
        pass


def layers_of_lattice(lattice: PeriodicLattice) -> None:
    """Cut as many layers as a layer of cells has, in the middle."""
    middle = lattice.counts[2] // 2
    for _ in slices(lattice, middle + LAYER * (np.arange(round(1 / LAYER)) + 0.5)):
        pass


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    make: Callable[[], Any]
    ours: Callable[[Any], str | None]
    aim: float
    """Time to reach, s."""
    peer: Callable[[Skeleton], None] | None = None
    package: str = ""
    """What the peer needs."""
    count: int = 0
    """Of the things that are made, to tell how many a second."""
    unit: str = ""
    """What they are."""
    small: Callable[[], Any] = lambda: bcc(1)
    """What is worked on first, for the imports, which count for nobody."""
    times: float = 1.0
    """How often the work would have to be done for all of it, which is not measured."""


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
    *(
        Row(
            f"blends, N = {valency}, {kind} radii",
            partial(stars, 1000, valency, spread),
            blends_of_stars,
            aim,
            UNION,
            "manifold3d",
            count=1000,
            unit="nodes",
        )
        for valency, kind, spread, aim in (
            (4, "equal", 1.0, 1.0),
            (4, "mixed", 2.0, 2.0),
            (6, "equal", 1.0, 5.0),
            (6, "mixed", 2.0, 8.0),
        )
    ),
    Row("STEP, BCC 1³", lambda: bcc(1), step, 0.2, FUSE, "build123d"),
    Row("STEP, BCC 3³", lambda: bcc(3), step, 1.0),
    Row("STEP, BCC 6³", lambda: bcc(6), step, 6.0),
    Row("STEP, octet 2³", lambda: octet(2), step, 1.2),
    Row("round STEP, BCC 6³", lambda: bcc(6), round_step, 2.0),
    Row("STL, BCC 50³", lambda: bcc(50), stl, 20.0),
    # Four struts of a cell are at each height of BCC, eight or twelve of octet.
    Row(
        "layers, BCC 8³, 40 µm",
        lambda: struts("bcc", 8, 0.07),
        layers_of_struts,
        0.5,
        count=4 * 8**3 * 25,
        unit="sections",
        small=lambda: struts("bcc", 1, 0.07),
    ),
    Row(
        "layers, octet 5³, 40 µm",
        lambda: struts("octet", 5, 0.05),
        layers_of_struts,
        0.3,
        count=27_500,
        unit="sections",
        small=lambda: struts("bcc", 1, 0.07),
    ),
    Row(
        "layers, BCC 500³, 25",
        lambda: PeriodicLattice("bcc", 1.0, 500, radius=0.1),
        layers_of_lattice,
        250.0,
        count=4 * 500**2 * 25,
        unit="sections",
        small=lambda: PeriodicLattice("bcc", 1.0, 1, radius=0.1),
        times=500,
    ),
    Row(
        "beams, BCC 13 × 200²",
        lambda: large.lattice(200),
        large.beams,
        4.0,
        count=8 * 13 * 200**2,
        unit="beams",
        small=lambda: large.lattice(2),
    ),
    Row(
        "blocks, BCC 13 × 200²",
        lambda: large.lattice(200),
        large.blocks,
        0.1,
        count=8 * 13 * 200**2,
        unit="beams",
        small=lambda: large.lattice(2),
    ),
    *(
        Row(
            f"{name}, BCC {side}³",
            partial(large.block_of, side),
            partial(large.in_tiles, work=work),
            aim,
            count=8 * side**3,
            unit="struts",
            small=partial(large.block_of, 2),
        )
        for (name, work), side, aim in zip(
            large.BUILDS.items(), (24, 12, 12), (8.0, 20.0, 30.0), strict=True
        )
    ),
]


def measure(row: Row, work: Callable[[Any], str | None], patience: float) -> Result | None:
    """Return what `work` takes in a process of its own; None if it fails or takes too long."""
    receiver, sender = Pipe(duplex=False)
    place = ROWS.index(row), work is not row.ours
    process = get_context("spawn").Process(target=_run, args=(*place, sender))
    process.start()
    sender.close()
    result: Result | None = None
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
        work(row.small())
    skeleton = row.make()
    start = time.process_time()
    told = work(skeleton)
    seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    megabytes = peak / (2**20 if sys.platform == "darwin" else 2**10)
    sender.send(Result(seconds, megabytes, told or ""))
