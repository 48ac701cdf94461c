"""What large lattices cost a strut: `python -m tests.benchmarks.tiles`.

Beams of 3MF files a second and bytes a beam, tiles of square and of round struts a second, and how
much faster two processes are than one. Times are of the processor but for the last.

No other package writes beams that it does not hold: nTop and the like publish no rates. An STL file
of 16-sided struts takes some 6 kB a strut (`docs/large.md`).
"""

from __future__ import annotations

import resource
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from joblib import parallel_config

from scaffold_cad import PeriodicLattice, write
from scaffold_cad.io import write_repeated
from scaffold_cad.tiles import Build, Work, run_tiles, tiles

WORKS = {
    "square": Build(options={"collars": True}),
    "round": Build(round=True, sides=8),
}


def beams(folder: Path) -> None:
    """Print the rates of both writers of 3MF beams."""
    lattice = PeriodicLattice("bcc", 1.0, (13, 200, 200), radius=0.1)
    for writer in (write, write_repeated):
        start = time.process_time()
        writer(lattice, folder / "beams.3mf")
        spent = time.process_time() - start
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
        print(
            f"{writer.__name__}: {lattice.strut_count / spent:.3g} beams a second, "
            f"{(folder / 'beams.3mf').stat().st_size / lattice.strut_count:.3g} bytes a beam, "
            f"peak {peak:.0f} MB"
        )


def building(name: str, work: Work, folder: Path) -> None:
    """Print the rate of tiles, and the gain of a second process."""
    parts = tiles(PeriodicLattice("bcc", 1.0, 24, radius=0.1), block=12)
    own = 8 * 24**3
    walls = {}
    for jobs in (1, 2):
        start, spent = time.perf_counter(), time.process_time()
        with parallel_config(backend="loky", n_jobs=jobs):
            manifest = run_tiles(parts, work, folder / f"{name}{jobs}")
        walls[jobs] = time.perf_counter() - start
        if jobs == 1:
            spent = time.process_time() - spent
    size = sum(file.bytes for file in manifest.files)
    print(
        f"{name} tiles: {spent / own * 1e6:.0f} s a million struts, {size / own:.0f} bytes a "
        f"strut, two processes {walls[1] / walls[2]:.2f} times as fast as one"
    )


def main() -> None:
    """Measure and print."""
    with TemporaryDirectory() as folder:
        beams(Path(folder))
        for name, work in WORKS.items():
            building(name, work, Path(folder))


if __name__ == "__main__":
    main()
