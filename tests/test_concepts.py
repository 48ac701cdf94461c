"""The table of calls in the page of concepts: each call works and gives what the table says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import scaffold_cad
from scaffold_cad import mechanics, round_struts, slices
from tests.skeletons import TRIPOD

PAGE = Path(__file__).parents[1] / "docs" / "concepts.md"
SKELETON = Path(__file__).parents[1] / "examples" / "skeletons" / "star_4.json"

GIVES = {
    "read_skeleton": "Skeleton",
    "Skeleton": "Skeleton",
    "Skeleton.from_edges": "Skeleton",
    "tile": "Skeleton",
    "lattice_on": "MappedLattice",
    "PeriodicLattice": "PeriodicLattice",
    "fill": "Skeleton",
    "voronoi_foam": "Skeleton",
    "lattice_part": "Manifold",
    "lattice_solid": "Solid",
    "strut_part": "Manifold",
    "strut_solid": "Solid",
    "build_scaffold": "Scaffold",
    "round_struts": "RoundStruts",
    "to_solid": "Manifold",
    "solidified": "Solidified",
    "to_brep": "Solid",
    "ScaffoldSolid": "ScaffoldSolid",
    "RoundStrutsSolid": "RoundStrutsSolid",
    "StrutFrame": "StrutFrame",
    "LatticeBox": "LatticeBox",
    "LatticeFill": "LatticeFill",
    "thicken": "Manifold",
    "frame_scaffold": "Scaffold",
    "slices": "Layers",
    "write_layers": "NoneType",
    "beam_model": "BeamSolution",
    "write": "NoneType",
    "check_printability": "Report",
}
"""The type of what each call of the table gives, by what is called."""


def calls() -> list[str]:
    """Return the calls of the table, but for `show`, which needs a viewer."""
    table = PAGE.read_text("utf-8").split("| you have | you want | call |\n")[1].split("\n\n")[0]
    rows = re.findall(r"^\| .+ \| .+ \| (.+) \|$", table, flags=re.MULTILINE)
    spans = [span for row in rows for span in re.findall(r"`([^`]+\))`", row)]
    return [span for span in spans if not span.startswith("show(")]


def names() -> dict[str, Any]:
    """Return what the calls of the table take."""
    build123d = pytest.importorskip("build123d")
    known = {name: getattr(scaffold_cad, name) for name in dir(scaffold_cad)}
    return known | {
        "beam_model": mechanics.beam_model,
        "path": SKELETON,
        "nodes": TRIPOD.nodes,
        "edges": TRIPOD.edges,
        "radii": TRIPOD.radii,
        "shapes": build123d.Edge.make_line((0, 0, 0), (9, 0, 0)),
        "cell": "bcc",
        "size": 6.0,
        "counts": 2,
        "radius": 0.5,
        "mapping": scaffold_cad.BoxMap((12, 12, 12)),
        "region": [[0, 0, 0], [12, 12, 12]],
        "count": 10,
        "body": build123d.Solid.make_box(12, 12, 12),
        "skin": 1.0,
        "skeleton": TRIPOD,
        "scaffold": scaffold_cad.build_scaffold(TRIPOD),
        "struts": round_struts(TRIPOD),
        "layers": slices(round_struts(TRIPOD), thickness=0.5),
        "material": "steel",
        "supports": mechanics.Support([1]),
        "loads": mechanics.Load([2], (0, 0, -1)),
    }


@pytest.mark.parametrize("call", calls())
def test_a_call_of_the_table_gives_what_it_says(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    given = eval(call, names())
    assert type(given).__name__ == GIVES[call.split("(")[0]]
    if given is None:
        assert [path.stat().st_size > 0 for path in tmp_path.iterdir()] == [True]


def test_the_table_has_all_that_makes_something() -> None:
    assert {call.split("(")[0] for call in calls()} == set(GIVES)
