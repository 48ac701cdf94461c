"""The real files that tests read, with a radius for those that hold none, mm."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.io import read_skeleton
from scaffold_cad.skeleton import Skeleton

RADII: dict[str, float | None] = {
    "simple.swc": None,
    "test_morph.swc": None,
    "nrn_ordering.swc": None,
    "hand.graph": 4.0,
    "wolf.graph": 0.01,
    "pattern1065.wire": 0.03,
    "pyramid.3mf": None,
    "Box_Simple.3mf": None,
    "mina_vase.obj": 1.0,
    "saddle.obj": 0.2,
    "bear_skel-poly.polylines.txt": 0.02,
}


def real_skeleton(folder: Path, name: str, factor: float = 1.0) -> Skeleton:
    """Return the skeleton in a real file, its radii multiplied by `factor`."""
    skeleton = read_skeleton(folder / name, RADII[name])
    return skeleton.with_radii(factor * skeleton.radii)
