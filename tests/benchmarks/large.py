"""What large lattices cost: beams of 3MF files, and tiles by one process and by two."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from joblib import parallel_config

from scaffold_cad.io import write_repeated
from scaffold_cad.io.write import write
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.tiles import Build, LatticeTiles, Slice, Work, run_tiles, tiles

BUILDS: dict[str, Work] = {
    "square tiles": Build(options={"collars": True}),
    "round tiles": Build(round=True, sides=8),
    "sliced tiles": Slice(thickness=0.04),
}


def lattice(side: int) -> PeriodicLattice:
    """Return a BCC lattice of 13 layers of cells, so that memory is that of some."""
    return PeriodicLattice("bcc", 1.0, (13, side, side), radius=0.1)


def beams(what: PeriodicLattice) -> str:
    """Write all beams, and say how many bytes each takes."""
    return _written(write, what)


def blocks(what: PeriodicLattice) -> str:
    """Write beams as repeated blocks, and say how many bytes each takes."""
    return _written(write_repeated, what)


def _written(writer: object, what: PeriodicLattice) -> str:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "beams.3mf"
        writer(what, path)  # type: ignore[operator]
        return f"{path.stat().st_size / what.strut_count:.2g} bytes per beam"


def block_of(count: int) -> LatticeTiles:
    """Return count³ BCC cells in eight tiles."""
    return tiles(PeriodicLattice("bcc", 1.0, count, radius=0.1), block=count // 2)


def in_tiles(parts: LatticeTiles, work: Work) -> str:
    """Do a work by one process; then by two, and say how much faster these are.

    The time of the row is that of one process: two are others, whose time is not ours.
    """
    walls = []
    for jobs in (1, 2):
        with tempfile.TemporaryDirectory() as folder, parallel_config("loky", n_jobs=jobs):
            if jobs == 2:  # processes take a second to start
                run_tiles(block_of(2), work, Path(folder) / "first")
            start = time.perf_counter()
            manifest = run_tiles(parts, work, Path(folder) / "all")
            walls.append(time.perf_counter() - start)
    own = parts.lattice.strut_count
    size = sum(file.bytes for file in manifest.files) / own
    gain = walls[0] / walls[1]
    return f"{size:.0f} bytes per strut; two processes {gain:.2f} times as fast as one"
