"""`python -m tests.fuzz.geometry --cases 300`: degenerate skeletons through to their solids.

Scales from 1e-6 to 1e6, offsets up to 1e6, nodes nearly on a line or nearly at one place, radii
from 1e-3 to 10 times the shortest strut. Each case ends in a valid solid or in an error of the
package; what does neither is printed with its number, and `--case N` runs it alone.
"""

from __future__ import annotations

import argparse
import logging
import signal
import sys
import time
import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from scaffold_cad import build_scaffold, self_intersections, solidified
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.io import read_with_repairs, skeleton_to_json
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from tests.skeletons import NAMED

SCALES = (1e-6, 1e-3, 1.0, 1e3, 1e6)
OFFSETS = (0.0, 1.0, 1e3, 1e6)
"""How far from the origin, mm."""
NEAR = (0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
"""How near to a line or to each other nodes come, in edge lengths; 0 leaves them as they are."""
THICKNESSES = (1e-3, 1e-2, 0.05, 0.2, 0.5, 1.0, 3.0, 10.0)
"""Radius in lengths of the shortest strut."""
LONGEST = 60
"""Seconds that a case may take."""


@dataclass(frozen=True)
class Case:
    """A degenerate skeleton and how it is built."""

    skeleton: Skeleton
    options: dict[str, Any]
    text: str
    """What makes it degenerate."""


def case(number: int) -> Case:
    """Return the case of this number, always the same."""
    rng = np.random.default_rng(number)
    name = str(rng.choice([*NAMED, "random", "random", "random"]))
    skeleton = _random(rng) if name == "random" else NAMED[name]
    near, kind = float(rng.choice(NEAR)), str(rng.choice(["line", "place"]))
    if near:
        skeleton = (_nearly_straight if kind == "line" else _nearly_twice)(skeleton, near, rng)
    thickness = float(rng.choice(THICKNESSES))
    spread = rng.uniform(0.3, 1.0, len(skeleton.nodes)) if rng.random() < 0.3 else 1.0
    skeleton = skeleton.with_radii(thickness * skeleton.lengths.min() * np.asarray(spread))
    scale, offset = float(rng.choice(SCALES)), float(rng.choice(OFFSETS))
    skeleton = skeleton.scaled(scale)
    skeleton = skeleton.moved(skeleton.nodes + offset * rng.choice([-1, 0, 1], 3))
    options = {
        "fit": str(rng.choice(["enclose", "paper"])),
        "section": str(rng.choice(["inscribed", "circumscribed", "area"])),
        "collars": bool(rng.random() < 0.5),
    }
    text = f"{name}, {kind} {near:g}, radius {thickness:g}, scale {scale:g}, offset {offset:g}"
    return Case(skeleton, options, f"{text}, {options}")


def _random(rng: np.random.Generator) -> Skeleton:
    """Return a random connected graph on up to 12 nodes, with crossings and narrow angles."""
    count = int(rng.integers(3, 13))
    nodes = rng.uniform(-10, 10, (count, 3))
    edges = {(int(rng.integers(0, k)), k) for k in range(1, count)}
    for a, b in rng.integers(0, count, (count, 2)).tolist():
        if a != b:
            edges.add((min(a, b), max(a, b)))
    return Skeleton(nodes, np.array(sorted(edges)), np.array(1.0))


def _nearly_straight(skeleton: Skeleton, near: float, rng: np.random.Generator) -> Skeleton:
    """Put a new extremity `near` beside the line of an edge, in either direction from a node."""
    edge = int(rng.integers(0, len(skeleton.edges)))
    a, b = skeleton.edges[edge].tolist()
    span = skeleton.nodes[b] - skeleton.nodes[a]
    side = np.cross(span, rng.normal(size=3))
    side *= np.linalg.norm(span) * near / np.linalg.norm(side)
    tip = skeleton.nodes[a] + float(rng.choice([-1.0, 0.5, 1.5])) * span + side
    return _with_tip(skeleton, a, tip)


def _nearly_twice(skeleton: Skeleton, near: float, rng: np.random.Generator) -> Skeleton:
    """Put a new node `near` a node, joined to it or to a neighbor of it."""
    edge = int(rng.integers(0, len(skeleton.edges)))
    a, b = rng.permutation(skeleton.edges[edge]).tolist()
    step = rng.normal(size=3)
    step *= skeleton.lengths[edge] * near / np.linalg.norm(step)
    return _with_tip(skeleton, int(rng.choice([a, b])), skeleton.nodes[a] + step)


def _with_tip(skeleton: Skeleton, node: int, tip: np.ndarray) -> Skeleton:
    nodes = np.concatenate([skeleton.nodes, tip[None]])
    edges = np.concatenate([skeleton.edges, [[node, len(skeleton.nodes)]]])
    return Skeleton(nodes, edges, np.array(1.0))


def fault_of(found: Case, path: Path) -> tuple[str, str]:
    """Return what became of a case, and its fault or "".

    Raises
    ------
    ScaffoldCadError
        If the package refuses it.
    """
    path.write_text(skeleton_to_json(found.skeleton), encoding="utf-8")
    skeleton = read_with_repairs(path).skeleton
    solid = solidified(build_scaffold(skeleton, **found.options))
    kind = "united" if len(solid.united_edges) else "as built"
    status = solid.manifold.status().name
    if status != "NoError":
        return kind, f"status is {status}"
    mesh = manifold_triangles(solid.manifold)
    mesh.check_closed()
    if not solid.manifold.volume() > 0:
        return kind, f"volume is {solid.manifold.volume():g}"
    crossings = len(self_intersections(mesh))
    return kind, f"{crossings} self-intersections" if crossings else ""


def _too_long(*_: object) -> None:
    raise TimeoutError(f"more than {LONGEST} s")


def main() -> int:
    """Run cases; return 1 if any failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--case", type=int, help="run this one alone, its error with a traceback")
    options = parser.parse_args()
    logging.disable(logging.WARNING)
    warnings.simplefilter("error")
    signal.signal(signal.SIGALRM, _too_long)
    counts: Counter[str] = Counter()
    failed = 0
    with TemporaryDirectory() as folder:
        path = Path(folder) / "case.json"
        if options.case is not None:
            print(case(options.case).text)
            print(fault_of(case(options.case), path))
            return 0
        for number in range(options.first, options.first + options.cases):
            found = case(number)
            start = time.perf_counter()
            signal.alarm(LONGEST)
            try:
                kind, fault = fault_of(found, path)
            except ScaffoldCadError as error:
                kind, fault = f"refused: {type(error).__name__}", ""
                print(f"{number}: {found.text}: {error}", flush=True)
            except Exception as error:
                kind, fault = "failed", f"{type(error).__name__}: {error}"
            finally:
                signal.alarm(0)
            if fault:
                failed += 1
                kind = "failed"
                print(f"FAILED {number}: {found.text}: {fault}", flush=True)
            if time.perf_counter() - start > LONGEST / 6:
                print(f"slow {number}: {time.perf_counter() - start:.0f} s: {found.text}")
            counts[kind] += 1
    print(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
