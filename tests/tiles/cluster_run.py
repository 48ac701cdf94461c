"""Builds a lattice by tiles on a cluster of two processes of this machine; a test ends it halfway.

Run as ``python -m tests.tiles.cluster_run FOLDER``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from scaffold_cad import PeriodicLattice
from scaffold_cad.tiles import Build, run_tiles, tiles

LATTICE = PeriodicLattice("bcc", 6.0, 3, radius=0.5)
BLOCK = 1
WORK = Build(options={"collars": True})


def main(folder: Path) -> None:
    """Build all tiles that are missing in a folder, and the file of them all."""
    from dask.distributed import Client, LocalCluster
    from joblib import parallel_config

    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(folder)
        ) as cluster,
        Client(cluster),
        parallel_config(backend="dask"),
    ):
        manifest = run_tiles(tiles(LATTICE, block=BLOCK), WORK, folder / "tiles")
    manifest.joined(WORK, folder / "all.stl")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
