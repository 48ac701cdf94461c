"""`strength --tiles`: stiffness and stresses tile by tile, solved at once between the two."""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from scaffold_cad.base.arrays import Bools, Points
from scaffold_cad.base.files import check_target
from scaffold_cad.cli import source, tiled
from scaffold_cad.errors import FormatError

if TYPE_CHECKING:
    from scaffold_cad.mechanics import Loading, Material
    from scaffold_cad.skeleton import Skeleton

REPORT = "report.json"
"""File of the sums and extremes beside the tiles'."""


@dataclass(frozen=True)
class At:
    """Marks the nodes at some places, which tiles know where they know no numbers of nodes."""

    places: tuple[tuple[float, float, float], ...]
    """Positions of nodes of the whole, mm: those of tiles are the same to the last bit."""

    def __call__(self, nodes: Points) -> Bools:
        """Return which of positions (n, 3) are at one of the places, (n,)."""
        known = set(self.places)
        return np.array([tuple(node) in known for node in nodes.tolist()], dtype=np.bool_)


def check(options: argparse.Namespace) -> None:
    """Raise where tiles do not make what is asked for."""
    source.refuse(options, ["size", "html"], "is not for --tiles")
    if options.output is not None:
        check_target(options.output)
        if options.output.suffix.lower() != ".npy":
            raise FormatError(
                f"cannot write {options.output}: --tiles write a row per strut, as .npy"
            )


def solve(
    options: argparse.Namespace,
    skeleton: Skeleton,
    material: Material,
    loading: Loading,
    *,
    gravity: tuple[float, float, float],
) -> dict[str, Any]:
    """Return sums and extremes of all struts, and write the row of each if an output is given."""
    parts = tiled.cut(skeleton, options)
    from scaffold_cad.tiles import LoadCase, Stiffness, Strength

    supports = tuple(_placed(each, skeleton) for each in loading.supports)
    loads = tuple(_placed(each, skeleton) for each in loading.loads)
    case = LoadCase(material, supports, loads, gravity=gravity, hollow=options.hollow)
    moved = tiled.make(parts, Stiffness(case), options, "moved.bin", "stiffness")
    work = Strength(case, str(moved))
    report = tiled.make(parts, work, options, REPORT, "strength")
    if options.output is not None:
        tiled.make(parts, work, options, part="strength")
    found: dict[str, Any] = json.loads(report.read_text("utf-8"))
    return found


def _placed(item: Any, skeleton: Skeleton) -> Any:
    """Return a support or a load by the places of its nodes, where it has their numbers."""
    if callable(item.where):
        return item
    places = skeleton.nodes[np.asarray(item.where)].tolist()
    return replace(item, where=At(tuple(map(tuple, places))))


def print_table(report: dict[str, Any]) -> None:
    """Print the sums and extremes, and the struts that are used most by their places."""
    rows = {name: value for name, value in report.items() if name != "most_used"}
    width = max(len(name) for name in rows)
    for name, value in rows.items():
        shown = str(value) if isinstance(value, int) else f"{value:.5g}"
        print(f"{name.replace('_', ' '):<{width}}  {shown}")
    print(f"\n{'from mm':>30} {'to mm':>30} {'stress MPa':>11} {'utilization':>12}")
    for row in report["most_used"]:
        ends = (", ".join(f"{row[f'{axis}{end}_mm']:.6g}" for axis in "xyz") for end in (1, 2))
        start, stop = ends
        print(f"{start:>30} {stop:>30} {row['stress_MPa']:>11.4g} {row['utilization']:>12.3f}")
