"""What struts cost as they become more: `python -m tests.benchmarks.growth [--most 1e5]`.

Each size of a BCC lattice is worked on in a process of its own. Printed are the seconds of the
processor and the peak of memory for 1 000 struts, without what the imports take, and in brackets
how much larger they are than those of the smallest lattice: 1 is a cost in proportion.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection

from scaffold_cad.lattice import tile
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts

COUNTS = (5, 11, 23, 50)
"""Cells along each side: some 10³, 10⁴, 10⁵ and 10⁶ struts."""


def scaffold(skeleton: Skeleton) -> None:
    build_scaffold(skeleton)


def solve(skeleton: Skeleton) -> None:
    round_struts(skeleton)


def solid(skeleton: Skeleton) -> None:
    round_mesh(round_struts(skeleton), 8)


WORKS: dict[str, Callable[[Skeleton], None]] = {
    "scaffold": scaffold,
    "round struts": solve,
    "round solid, 8 sides": solid,
}


def measure(name: str, count: int, sender: Connection) -> None:
    """Send the number of struts, and the seconds and megabytes of a work on a lattice."""
    work = WORKS[name]
    work(tile("bcc", 10.0, 2, radius=0.7))  # for the imports, and what is kept
    before = _peak()
    skeleton = tile("bcc", 10.0, count, radius=0.7)
    start = time.process_time()
    work(skeleton)
    sender.send((len(skeleton.edges), time.process_time() - start, _peak() - before))


def _peak() -> float:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)


def main() -> None:
    """Measure and print a line a work and size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=float, default=1.2e6, help="struts, default: 1.2e6")
    most = parser.parse_args().most
    print(f"{'':22}{'struts':>10}{'a thousand':>20}{'':>12}")
    for name in WORKS:
        first: tuple[float, float] | None = None
        for count in COUNTS:
            if 8 * count**3 > most:
                break
            context = get_context("spawn")
            receiver, sender = context.Pipe(duplex=False)
            process = context.Process(target=measure, args=(name, count, sender))
            process.start()
            sender.close()
            struts, seconds, megabytes = receiver.recv()
            process.join()
            each = 1e3 * seconds / struts, 1e3 * megabytes / struts
            first = first or each
            print(
                f"{name:22}{struts:>10}{1e3 * each[0]:>9.1f} ms ({each[0] / first[0]:.2f})"
                f"{each[1]:>9.2f} MB ({each[1] / first[1]:.2f})",
                flush=True,
            )


if __name__ == "__main__":
    main()
