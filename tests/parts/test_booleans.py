"""Booleans of parts by OCCT hold what they must, agree with manifold3d, and are refused if not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import build123d as bd
import pytest

from scaffold_cad.brep import tessellated
from scaffold_cad.errors import BrepError
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.parts import LatticeBox, RoundStrutsSolid, ScaffoldSolid, skeletonpart
from scaffold_cad.parts.booleans import Operation, check_boolean
from scaffold_cad.solid.manifolds import to_manifold
from tests.skeletons import NAMED, STRUT

BOX = bd.Pos(3, 2, 1) * bd.Box(13, 11, 9)
"""Cuts every named skeleton somewhere."""

CUBE = bd.Box(2, 2, 2)
BESIDE = bd.Pos(1, 0.5, 0.5) * CUBE
"""Shares 2.25 mm³ with it."""

INTERLEAVED = [bd.Torus(10, 1), bd.Pos(10, 0, 0) * bd.Rot(90, 0, 0) * bd.Torus(10, 1)]
"""Links of a chain: apart, and their boxes are not."""

PIN = bd.Cylinder(1, 10)
BUSH = bd.Cylinder(3, 8) - bd.Cylinder(1.02, 8)
"""Closer to each other than coarse meshes can tell."""


@pytest.mark.parametrize("part", [ScaffoldSolid, RoundStrutsSolid])
@pytest.mark.parametrize("name", ["tripod", "cross"])
def test_unions_cuts_and_intersections_add_up(name: str, part: type) -> None:
    solid = part(NAMED[name])
    surface = tessellated(solid)
    assert len(self_intersections(surface)) == 0
    shared = (solid & BOX).volume
    reference = to_manifold(surface) ^ to_manifold(tessellated(BOX))
    assert shared == pytest.approx(reference.volume(), rel=0.01)
    assert (solid + BOX).volume == pytest.approx(solid.volume + BOX.volume - shared, rel=1e-4)
    assert (BOX - solid).volume == pytest.approx(BOX.volume - shared, rel=1e-4)
    assert (solid - BOX).volume == pytest.approx(solid.volume - shared, rel=1e-4)


@pytest.mark.parametrize("place", [bd.Pos(0, 0, 0), bd.Pos(1000, -500, 2000)])
@pytest.mark.parametrize(
    ("operation", "operands", "result"),
    [
        ("union", [CUBE, BESIDE], CUBE + BESIDE),
        ("union", [CUBE, bd.Pos(5, 0, 0) * CUBE], bd.Compound([CUBE, bd.Pos(5, 0, 0) * CUBE])),
        ("union", [CUBE, bd.Box(1, 1, 1)], CUBE),
        ("union", INTERLEAVED, bd.Compound(INTERLEAVED)),
        ("union", [bd.Compound([CUBE, BESIDE])], CUBE + BESIDE),
        ("difference", [CUBE, BESIDE], CUBE - BESIDE),
        ("difference", INTERLEAVED, INTERLEAVED[0]),
        ("difference", [CUBE, bd.Box(3, 3, 3)], None),
        ("difference", [CUBE, bd.Pos(0, 0, 2) * CUBE], CUBE),
        ("intersection", [CUBE, BESIDE], CUBE & BESIDE),
        ("intersection", [CUBE, bd.Box(3, 3, 3)], CUBE),
        ("intersection", INTERLEAVED, None),
        ("intersection", [CUBE, bd.Face.make_rect(1, 1)], None),
        ("union", [PIN, BUSH], bd.Compound([PIN, BUSH])),
        ("difference", [BUSH, PIN], BUSH),
    ],
)
def test_results_that_are_right_pass(
    place: bd.Location, operation: Operation, operands: Sequence[Any], result: Any
) -> None:
    moved = None if result is None else place * result
    check_boolean(operation, [place * operand for operand in operands], moved)


@pytest.mark.parametrize(
    ("operation", "operands", "result", "complaint"),
    [
        ("union", [CUBE, BESIDE], None, "union a volume of 0 mm³, which should be 8 to 16; it"),
        ("union", [CUBE, BESIDE], bd.Box(2, 2, 1), "of 4 mm³, which should be 8 to 16"),
        ("union", [CUBE, BESIDE], bd.Compound([CUBE, BESIDE]), "cannot be: both parts are at"),
        ("union", [bd.Compound([CUBE, BESIDE])], bd.Compound([CUBE, BESIDE]), "both parts are at"),
        ("difference", [CUBE, BESIDE], CUBE, r"a volume of 8 mm³, .* both parts are at \("),
        ("difference", [CUBE, BESIDE], None, r"be: the first part alone is at \("),
        ("difference", [CUBE, bd.Box(1, 1, 1)], None, "of 0 mm³, which should be 7 to 8"),
        ("intersection", [CUBE, BESIDE], None, r"intersection .* of 0 mm³, .* both parts are"),
        ("intersection", [CUBE, bd.Box(1, 1, 1)], CUBE, "should be 0 to 1; it fails where faces"),
    ],
)
def test_results_that_cannot_be_right_are_refused(
    operation: Operation, operands: Sequence[Any], result: Any, complaint: str
) -> None:
    with pytest.raises(BrepError, match=complaint):
        check_boolean(operation, operands, result)


def test_round_lattices_side_by_side_are_united() -> None:
    block = LatticeBox("bcc", 10, 10, 10, 10, radius=1, section="round")
    beside = bd.Pos(10, 0, 0) * block
    reference = to_manifold(tessellated(block)) + to_manifold(tessellated(beside))
    both = block + beside
    assert both.is_valid
    assert len(both.solids()) == 1
    assert both.volume == pytest.approx(reference.volume(), rel=0.005)


def test_what_occt_loses_is_refused_with_a_way_out(monkeypatch: pytest.MonkeyPatch) -> None:
    bar = ScaffoldSolid(STRUT)
    lost = bd.Part()
    monkeypatch.setattr(bd.Part, "__add__", lambda self, other: lost)
    monkeypatch.setattr(bd.BasePartObject, "__add__", lambda self, other: lost, raising=False)
    with pytest.raises(BrepError, match="need one part of one skeleton that holds all struts"):
        bar + bd.Box(4, 4, 4)


@pytest.fixture
def checks(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, list[float], float]]:
    """Return what is checked: the operation, the volumes of its operands, that of its result."""
    calls: list[tuple[str, list[float], float]] = []

    def record(operation: str, operands: Sequence[Any], result: Any) -> None:
        calls.append((operation, [round(one.volume) for one in operands], round(result.volume)))

    monkeypatch.setattr(skeletonpart, "check_boolean", record)
    return calls


def test_operators_with_a_part_are_checked(
    checks: list[tuple[str, list[float], float]],
) -> None:
    bar = ScaffoldSolid(STRUT)  # 10 x 2 x 2 mm
    block = bd.Part(bd.Pos(10, 0, 0) * bd.Box(4, 4, 4))
    assert bar.volume == pytest.approx(40)
    for left, right in ((bar, block), (block, bar)):
        first, second = round(left.volume), round(right.volume)
        checks.clear()
        assert (left + right).volume == pytest.approx(96)
        assert (left - right).volume == pytest.approx(first - 8)
        assert (left & right).volume == pytest.approx(8)
        assert checks == [
            ("union", [first, second], 96),
            ("difference", [first, second], first - 8),
            ("intersection", [first, second], 8),
        ]
    checks.clear()
    assert (bar + (one for one in [block, None])).volume == pytest.approx(96)
    assert (bar - [block]).volume == pytest.approx(32)
    assert (bar + None).volume == pytest.approx(40)
    assert [call[:2] for call in checks] == [("union", [40, 64]), ("difference", [40, 64])]
    with pytest.raises(TypeError):
        1 + bar
    with pytest.raises(TypeError):
        1 - bar
    with pytest.raises(TypeError):
        1 & bar


def test_parts_in_a_builder_are_checked(checks: list[tuple[str, list[float], float]]) -> None:
    with bd.BuildPart() as first:
        ScaffoldSolid(STRUT)
    assert first.part.volume == pytest.approx(40)
    assert checks == []  # nothing is united with one part
    with bd.BuildPart():
        with bd.Locations((0, 0, 0), (0, 10, 0)):
            ScaffoldSolid(STRUT)
        ScaffoldSolid(STRUT, mode=bd.Mode.PRIVATE)
        bd.Box(4, 4, 4)
        ScaffoldSolid(STRUT, mode=bd.Mode.SUBTRACT)
        with bd.Locations((0, 1.5, 0)):
            ScaffoldSolid(STRUT, mode=bd.Mode.INTERSECT)
        ScaffoldSolid(STRUT, mode=bd.Mode.REPLACE)
    assert [call[:2] for call in checks[:2]] == [
        ("union", [80]),
        ("difference", [136, 40]),
    ]
    assert [call[0] for call in checks] == ["union", "difference", "intersection"]


def test_a_union_that_occt_finds_invalid_is_told(caplog: pytest.LogCaptureFixture) -> None:
    lattice = LatticeBox("bcc", 10, 10, 10, 10, radius=0.8, section="round", align=None)
    plate = bd.Box(10, 10, 2, align=(bd.Align.MIN, bd.Align.MIN, bd.Align.MAX))
    both = lattice + plate
    told = "OCCT finds the union that it made not valid, a face at" in caplog.text
    assert told == (not both.is_valid)  # which depends on its version


def test_a_union_that_is_valid_is_not_told(caplog: pytest.LogCaptureFixture) -> None:
    bar = RoundStrutsSolid(STRUT)
    assert (bar + bd.Box(4, 4, 4)).is_valid
    assert caplog.text == ""
