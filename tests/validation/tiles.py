"""Round nodes of tiles against those of the whole lattice, for all named cells; some minutes.

Run as ``python -m tests.validation.tiles``.
"""

from __future__ import annotations

from time import perf_counter

from threadpoolctl import threadpool_limits

from scaffold_cad import PeriodicLattice, cells, delaunay_foam
from scaffold_cad.tiles import tiles
from tests.tiles.test_tiling import BOX, check_nodes


def main() -> None:
    """Compare, and say how long each took; raise at the first difference."""
    threadpool_limits(1)  # last bits of matrices depend on how many threads make them
    for name in cells():
        start = perf_counter()
        lattice = PeriodicLattice(name, 8.0, (3, 2, 2), radius=0.25)
        check_nodes(tiles(lattice, block=(2, 1, 1)), lattice.skeleton())
        print(f"{name}: the same bits ({perf_counter() - start:.0f} s)", flush=True)
    foam = delaunay_foam(8, BOX, 0.3, seed=6)
    check_nodes(tiles(foam, block=20.0), foam)
    print("a Delaunay foam: the same bits")


if __name__ == "__main__":
    main()
