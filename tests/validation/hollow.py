"""Hollow struts of kinds that overlap, as their STL and STEP files are read back.

``python -m tests.validation.hollow [--count 200] [--seed 1] [--kinds NAME …]`` makes random
skeletons with walls of 0.15 to 0.4 of the least radius, and prints what CGAL or OCCT finds wrong in
a file, what is refused and why, where walls are thinner than 0.9 of what was asked for, and where
struts are not hollow that have room for it. A thin wall that a warning gave beforehand is told, not
faulty. Times are those of making the file.

Two volumes are printed. What is filled of the insides of struts, though it is more than a wall from
the outside, is a fault from `FILLED` on. The volume over that of the places within a wall of the
outside is larger, too, where struts cross: webs and fillets between them are solid.
"""

from __future__ import annotations

import argparse
import logging
import re
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import numpy as np
import trimesh

from scaffold_cad import Skeleton, round_struts, write
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.struts.options import Ends
from tests.crossings import faults_by_cgal
from tests.skeletons import polyline
from tests.validation import attacks
from tests.validation.attacks import Random, chain, directions, star
from tests.walls import Side, eroded_volume, filled_volume, of_solids, walls_between

LEAST_WALL = 0.9
"""Least wall over what was asked for."""

TELLING = 0.05
"""Most that a wall may be thinner than is told, over what was asked for."""

FILLED = 0.05
"""Most of the insides of struts that is filled, over the volume of walls."""

APART = 0.01
"""By how much less than that of a wall a volume may be, beside the error of a count."""

RESULTS = ("good", "thick", "told", "faulty", "refused", "slow")
"""Columns of the table."""

SIDES = 16
"""Of polygons in files of meshes."""


def dense_star(random: Random) -> Skeleton:
    """Return a star of so many struts that they overlap far from its middle."""
    return star(12 * directions(int(random.integers(8, 30)), random))


def crotch(random: Random) -> Skeleton:
    """Return two or three struts that leave a node at 4 to 25 degrees."""
    angle, count = np.radians(random.uniform(4, 25)), int(random.integers(2, 4))
    turn = angle * np.arange(count)
    return star(25 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1))


def short_links(random: Random) -> Skeleton:
    """Return a strut whose ends are links shorter than its wall, some on a branch point."""
    size = random.uniform(0.05, 0.4)
    points = np.array([[0.0, 0, 0], [0, 0, size], [0, 0.3 * size, 2 * size], [0, 0, 3 * size]])
    if random.random() < 0.5:
        return chain(np.concatenate([points, [[2.0, 0, 15]], [[0.0, 3, 30]]]))
    nodes = np.concatenate([points[::-1], 12 * directions(2, random)])
    edges = np.concatenate([polyline(4), [[0, 4], [0, 5]]])
    return Skeleton(nodes - points[-1], edges, 1.0)


def dense_lattice(random: Random) -> Skeleton:
    """Return cells of struts as thick as half their length."""
    size, count = random.uniform(2.0, 3.5), 2
    grid = np.stack(np.meshgrid(*[np.arange(count + 1)] * 3), axis=-1).reshape(-1, 3)
    one, other = np.triu_indices(len(grid), 1)
    near = np.abs(grid[one] - grid[other]).sum(axis=1) == 1
    nodes = size * grid + random.normal(0, 0.1, grid.shape)
    return Skeleton(nodes, np.column_stack([one, other])[near], 1.0)


KINDS: dict[str, Callable[[Random], Skeleton]] = {
    kind.__name__: kind
    for kind in (dense_star, crotch, short_links, dense_lattice, attacks.fan, attacks.flat_star,
                 attacks.swallowed, attacks.comb, attacks.knot, attacks.tree, attacks.zigzag,
                 attacks.hairpin, attacks.crossing, attacks.planar, attacks.balls, attacks.members,
                 attacks.foam, attacks.truss, attacks.helix, attacks.bundle)
}  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """What is found of one file."""

    fault: str
    """"" for none."""
    wall: float
    """Least wall over that asked for."""
    thin: float
    """Share of places inside whose wall is thinner than `LEAST_WALL`."""
    volume: float
    """Volume over that of the places within a wall of the outside."""
    filled: float
    """What of the insides of struts is filled, over the volume of these places."""


def written(skeleton: Skeleton, wall: float, ends: Ends, path: Path) -> list[float]:
    """Write hollow struts with closed ends to a file; return the walls that warnings tell of."""
    told = Told()
    log = logging.getLogger("scaffold_cad")
    log.addHandler(told)
    try:
        made = round_struts(skeleton, wall=wall, ends=ends)
        if path.suffix == ".step":
            write(made, path, overlaps="unite")
        else:
            write(made, path, overlaps="unite", sides=SIDES)
    finally:
        log.removeHandler(told)
    return told.walls


class Told(logging.Handler):
    """The walls that warnings tell of."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.walls: list[float] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep the wall that a warning gives."""
        self.walls += [float(each) for each in re.findall(r"thin as (\S+) mm", record.getMessage())]


def outcome(
    path: Path, skeleton: Skeleton, wall: float, told: list[float], random: Random
) -> Outcome:
    """Return what is found of a file of hollow struts with closed ends."""
    if path.suffix == ".step":
        fault, outer, inner, volume = of_solids(path, wall)
    else:
        raw = trimesh.load_mesh(path, process=False)
        fault = faults_by_cgal(np.asarray(raw.vertices, np.float64), raw.faces)
        read = trimesh.Trimesh(raw.vertices, raw.faces)
        volume = float(read.volume)
        if not read.is_watertight:
            fault = fault or "not watertight"
        shells = read.split(only_watertight=False)
        outer = Side([shell for shell in shells if shell.volume > 0], [])
        inner = Side([shell for shell in shells if shell.volume <= 0], [])
    parts = skeleton.component_count
    if len(outer.meshes) > parts:
        fault = fault or f"{len(outer.meshes)} bodies for {parts}"
    if not inner.meshes:
        return Outcome(fault or "not hollow", 0.0, 1.0, 0.0, 1.0)
    outside, inside = outer.whole, inner.whole
    walls = walls_between(outer, inner, wall, random)
    expected, error = eroded_volume(outside, wall, random)
    ratio = volume / expected
    filled = filled_volume(skeleton, outside, inside, wall, random) / expected
    least = float(walls.min()) / wall
    if least < LEAST_WALL:
        is_told = min(told, default=np.inf) < (least + TELLING) * wall
        fault = fault or f"{'told' if is_told else 'wall'} {least:.3f}"
    if ratio < 1.0 - APART - 3 * error / expected:
        fault = fault or f"volume {ratio:.3f} of that of a wall"
    if filled > FILLED:
        fault = fault or f"filled {filled:.3f} of the volume of a wall"
    return Outcome(fault, least, float((walls < LEAST_WALL * wall).mean()), ratio, filled)


def grade(found: Outcome) -> str:
    """Return the column of the table that an outcome is counted in."""
    if found.fault.startswith("filled"):
        return "thick"
    if found.fault.startswith("told"):
        return "told"
    return "faulty" if found.fault else "good"


@contextmanager
def limit(seconds: float) -> Iterator[None]:
    """Raise a TimeoutError after so much time of the processor."""

    def over(_: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"not done in {seconds:.0f} s")

    before = signal.signal(signal.SIGPROF, over)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def main() -> int:
    """Print the table; return whether a file is at fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument("--every", action="store_true", help="print good ones too")
    parser.add_argument("--formats", nargs="*", default=[".stl", ".step"])
    options = parser.parse_args()
    logging.lastResort = None
    done: Counter[tuple[str, str, str]] = Counter()
    walls: dict[tuple[str, str], list[float]] = defaultdict(list)
    ratios: dict[tuple[str, str], list[float]] = defaultdict(list)
    filled: dict[tuple[str, str], list[float]] = defaultdict(list)
    seconds: Counter[tuple[str, str]] = Counter()
    for k in range(options.first, options.first + options.count):
        name = list(KINDS)[k % len(KINDS)]
        if name not in options.kinds:
            continue
        random = np.random.default_rng([options.seed, k])
        skeleton = KINDS[name](random)
        wall = random.uniform(0.15, 0.4) * float(skeleton.edge_radii.min())
        for suffix in options.formats:
            ends: Ends = "round" if (k // len(KINDS) + (suffix == ".step")) % 2 else "flat"
            began = time.process_time()
            took = options.seconds
            try:
                with tempfile.TemporaryDirectory() as folder:
                    path = Path(folder) / f"solid{suffix}"
                    with limit(options.seconds):
                        told = written(skeleton, wall, ends, path)
                    took = time.process_time() - began
                    found = outcome(path, skeleton, wall, told, random)
                result, text = grade(found), found.fault
                walls[name, suffix].append(found.wall)
                ratios[name, suffix].append(found.volume)
                text += f" ({found.thin:.2%} thin)" if found.thin else ""
                text += f" [wall {found.wall:.3f}, volume {found.volume:.3f}, filled "
                text += f"{found.filled:.3f}]"
                filled[name, suffix].append(found.filled)
            except TimeoutError as error:
                result, text = "slow", str(error)
            except ScaffoldCadError as error:
                took = time.process_time() - began
                result, text = "refused", f"refused: {error}"
            done[name, suffix, result] += 1
            seconds[name, suffix] = max(seconds[name, suffix], took)
            if result != "good" or options.every:
                print(f"{name} {k} {suffix} wall {wall:.3f} {took:.0f} s: {text[:220]}", flush=True)
    for (name, suffix), most in sorted(seconds.items()):
        counts = "".join(f"{done[name, suffix, result]:>4} {result}" for result in RESULTS)
        wall, ratio = walls[name, suffix], ratios[name, suffix]
        print(
            f"{name:<14}{suffix:<6}{counts}  walls {min(wall, default=0):.3f}  volume "
            f"{min(ratio, default=0):.3f} to {max(ratio, default=0):.3f}  filled "
            f"{max(filled[name, suffix], default=0):.3f}  {most:.1f} s at most"
        )
    return int(any(result == "faulty" for _, _, result in done))


if __name__ == "__main__":
    sys.exit(main())
