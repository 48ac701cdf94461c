"""How many sharp nodes of random stars of struts are proved, valid, and of the right volume.

`python -m tests.validation.sharp_stars [STARS]` prints a line for each family of stars: the share
proved, the shares of the B-reps of these that OCCT finds valid, the largest part by which the mesh
of 16 sides and the volume by OCCT differ, and the milliseconds of processor time a proof.

Families: N struts with a least angle between them, of equal radii, or of radii from 0.5 to 2.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from scaffold_cad import Skeleton, round_struts, to_brep, to_solid
from scaffold_cad.base.arrays import Floats
from tests.struts.stars import random_stars

STARS = 50
SEED = 1
LONG = 12.0
"""Length of the struts, in mean radii."""


def star(directions: Floats, radii: Floats) -> Skeleton:
    """Return one node with struts in some directions (N, 3), of radii (N,)."""
    count = len(directions)
    nodes = np.concatenate([np.zeros((1, 3)), LONG * directions])
    edges = np.stack([np.zeros(count, dtype=np.intp), 1 + np.arange(count)], axis=1)
    return Skeleton(nodes, edges, 1.0, edge_radii=np.stack([radii, radii], axis=1))


def row(directions: Floats, radii: Floats) -> str:
    """Return the figures of stars (K, N, 3) of struts of radii (K, N)."""
    begun = time.process_time()
    made = [round_struts(star(*one), nodes="sharp") for one in zip(directions, radii, strict=True)]
    taken = 1000 * (time.process_time() - begun) / len(made)
    proved = [struts for struts in made if not struts.crowded.any()]
    bodies = [to_brep(struts) for struts in proved]
    valid = np.array([bool(body.is_valid) for body in bodies])
    off = [
        abs(to_solid(struts).volume() / body.volume - 1.0)
        for struts, body in zip(proved, bodies, strict=True)
    ]
    return (
        f"{100 * len(proved) / len(made):6.1f} {100 * valid.mean():6.1f} "
        f"{max(off):9.1e} {taken:6.1f}"
    )


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else STARS
    rng = np.random.default_rng(SEED)
    print("                  radii proved  valid   volume     ms")
    for least in (60, 45, 30, 20):
        for valency in (3, 4, 6, 8):
            if valency == 8 and least == 60:
                continue  # there are none
            directions = random_stars(count, valency, least, rng)
            print(f"N = {valency}, {least}°      1    {row(directions, np.ones((count, valency)))}")
            radii = np.exp(rng.uniform(np.log(0.5), np.log(2), (count, valency)))
            print(f"N = {valency}, {least}°  0.5..2   {row(directions, radii)}", flush=True)


if __name__ == "__main__":
    main()
