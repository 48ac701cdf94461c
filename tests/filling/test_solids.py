"""Parts filled with a lattice as B-reps: one valid solid, with true cylinders in its skin."""

from __future__ import annotations

import logging
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import (
    Axis,
    Box,
    BuildLine,
    BuildPart,
    BuildSketch,
    Compound,
    Cylinder,
    GeomType,
    Polyline,
    Pos,
    Sphere,
    Spline,
    Vertex,
    extrude,
    fillet,
    make_face,
)

from scaffold_cad import Skeleton, round_struts, write
from scaffold_cad.brep import read_brep
from scaffold_cad.errors import BrepError, OptionError
from scaffold_cad.filling import lattice_part, lattice_solid, strut_part, strut_solid
from scaffold_cad.filling.solids import filled_solid, hollow_solid
from scaffold_cad.parts import LatticeFill

RADIUS = 0.6


def plate() -> Any:
    """Return a plate with two holes, rounded corners and a rim of a fillet wider than these."""
    block = Box(20, 14, 8) - Pos(4, 1, 0) * Cylinder(2.5, 8) - Pos(-5, -1, 0) * Cylinder(2, 8)
    block = fillet(block.edges().filter_by(Axis.Z).filter_by(GeomType.LINE), 3)
    return fillet(block.faces().sort_by(Axis.Z)[-1].outer_wire().edges(), 2)


def knob() -> Any:
    """Return a cylinder with a fillet wider than the flat it leaves."""
    block = Cylinder(5, 8)
    return fillet(block.edges().sort_by(Axis.Z)[-1], 3.5)


def thin_tube() -> Any:
    """Return a wall of 2 mm, whose insides struts meet in many places."""
    return Cylinder(7, 4) - Cylinder(5, 4)


def wave() -> Any:
    """Return a block whose upper face is free-form."""
    with BuildPart() as part:
        with BuildSketch():
            with BuildLine():
                Spline((0, 0), (5, 2), (10, -1), (14, 3))
                Polyline((14, 3), (14, -8), (0, -8), (0, 0))
            make_face()
        extrude(amount=10)
    return part.part


@pytest.mark.parametrize(
    ("body", "size", "radius", "skin"),
    [
        (thin_tube, 4.0, 0.3, 0.4),
        (plate, 8.0, RADIUS, 1.2),
        (knob, 5.0, 0.4, 1.0),
        (wave, 8.0, RADIUS, 1.2),
    ],
)
def test_a_part_with_a_skin_is_one_valid_solid_with_true_cylinders(
    body: Any, size: float, radius: float, skin: float, tmp_path: Path
) -> None:
    part = body()
    solid = lattice_solid(part, "bcc", size, radius, skin=skin)
    assert solid.is_valid
    of_triangles = lattice_part(part, "bcc", size, radius, skin=skin, sides=16)
    assert solid.volume == pytest.approx(of_triangles.volume(), rel=5e-3)
    struts = [
        face
        for face in solid.faces().filter_by(GeomType.CYLINDER)
        if face.radius == pytest.approx(radius, abs=1e-9)
    ]
    # Diagonals of cells, each cut by the skin's inside or whole.
    along = np.array([tuple(face.axis_of_rotation.direction) for face in struts])
    np.testing.assert_allclose(np.abs(along), np.sqrt(1 / 3), atol=1e-9)
    assert len(struts) > 20

    write(solid, tmp_path / "part.step")
    read = read_brep(tmp_path / "part.step").solids()
    assert len(read) == 1
    assert read[0].is_valid
    # OCCT's integrals over faces with many holes are off by up to 1e-4.
    assert read[0].volume == pytest.approx(solid.volume, rel=1e-4)
    radii = [face.radius for face in read[0].faces().filter_by(GeomType.CYLINDER)]
    assert np.isclose(radii, radius, atol=1e-6).sum() == len(struts)


@pytest.mark.parametrize("wall", [None, 0.3])
def test_struts_that_overlap_are_united_under_a_skin(wall: float | None) -> None:
    nodes = [[-9, 0, -1], [9, 0, -1], [0, -9, 0], [0, 9, 0], [5, 0, -9], [5, 0, 9]]
    crossing = Skeleton(nodes, [[0, 1], [2, 3], [4, 5]], 1.0)
    solid = strut_solid(Box(16, 16, 16), crossing, skin=1.5, wall=wall, overlaps="unite")
    assert solid.is_valid
    assert len(solid.shells()) == (2 if wall is None else 3)
    of_triangles = strut_part(Box(16, 16, 16), crossing, skin=1.5, wall=wall, sides=32)
    assert solid.volume == pytest.approx(of_triangles.volume(), rel=1e-3)
    kinds = {face.geom_type for face in solid.faces()}
    assert kinds == {GeomType.PLANE, GeomType.CYLINDER}
    with pytest.raises(OptionError, match="overlaps is 'allow' with a skin; need 'refuse' or"):
        strut_solid(Box(16, 16, 16), crossing, skin=1.5, overlaps="allow")


def test_the_skin_is_as_thick_as_asked() -> None:
    solid = lattice_solid(Box(20, 20, 20), "bcc", 10.0, RADIUS, skin=1.5)
    planes = solid.faces().filter_by(GeomType.PLANE)
    heights = sorted({round(abs(tuple(face.center())[k]), 6) for k, face in _flat(planes)})
    assert heights == [8.5, 10.0]


def _flat(planes: Any) -> list[tuple[int, Any]]:
    return [(int(np.abs(tuple(face.normal_at())).argmax()), face) for face in planes]


def test_square_struts_get_a_skin_too() -> None:
    solid = lattice_solid(Box(16, 16, 16), "bcc", 8.0, RADIUS, skin=1.5, section="square")
    assert solid.is_valid
    round_ones = lattice_solid(Box(16, 16, 16), "bcc", 8.0, RADIUS, skin=1.5)
    void, round_void = 16**3 - solid.volume, 16**3 - round_ones.volume
    assert 0.9 * round_void < void < round_void


def test_lattice_fill_takes_a_skin() -> None:
    part = LatticeFill(
        Box(16, 16, 16), "bcc", 8.0, RADIUS, skin=1.5, section="round", label="filled"
    )
    assert part.is_valid
    assert part.label == "filled"
    assert part.volume == pytest.approx(
        lattice_solid(Box(16, 16, 16), "bcc", 8.0, RADIUS, skin=1.5).volume
    )
    assert (part.skeleton.radii == RADIUS).all()
    hollow = LatticeFill(Box(10, 10, 10), "bcc", 8.0, 0.6, skin=1.5, section="round", wall=0.15)
    assert hollow.is_valid
    assert len(hollow.shells()) == 3
    with pytest.raises(OptionError, match="keep or dangling is given with a skin"):
        LatticeFill(Box(16, 16, 16), "bcc", 8.0, RADIUS, skin=1.5, keep="whole")


def test_a_function_gives_cones() -> None:
    solid = lattice_solid(
        Box(16, 16, 16), "bcc", 8.0, lambda points: 0.5 + 0.01 * (points[:, 2] + 8), skin=1.2
    )
    assert solid.is_valid
    assert len(solid.faces().filter_by(GeomType.CONE)) > 20


def dumbbell() -> Any:
    """Return two boxes joined by a bar that is thinner than two skins."""
    return Box(9, 9, 9) + Pos(9, 0, 0) * Box(12, 2, 2) + Pos(18, 0, 0) * Box(9, 9, 9)


@pytest.mark.parametrize(
    ("body", "options", "error", "message"),
    [
        (lambda: Box(9, 9, 2), {"skin": 1.5}, OptionError, "skin is 1.5 mm, which fills the body"),
        (lambda: Box(9, 9, 9), {"skin": 0.0}, OptionError, "skin is 0 mm; need > 0"),
        (lambda: Vertex(), {"skin": 1.0}, OptionError, "the body has 0 solids; need one"),
        (lambda: [0, 1], {"skin": 1.0}, OptionError, "the body is a list; need a build123d solid"),
        (
            lambda: Compound([Box(9, 9, 9), Pos(20, 0, 0) * Box(9, 9, 9)]),
            {"skin": 1.0},
            OptionError,
            "the body has 2 solids; need one",
        ),
        (
            lambda: Box(9, 9, 9),
            {"skin": 1.0, "radius": 4.0, "overlaps": "unite"},
            BrepError,
            "the struts fill the body; need thinner ones",
        ),
        (dumbbell, {"skin": 1.2}, BrepError, r"OCCT cannot move the faces .* by 1.2 mm"),
        (
            lambda: Box(9, 9, 9),
            {"skin": 1.0, "radius": 2.5},
            BrepError,
            "joints.*, or overlaps='unite' .*lattice_part and strut_part make it",
        ),
        (lambda: Box(80, 80, 80), {"skin": 1.0}, BrepError, r"has \d+ struts, .* need 5000"),
        (lambda: Box(9, 9, 9), {"skin": 1.0, "section": "oval"}, OptionError, "section is 'oval'"),
    ],
)
def test_what_cannot_be_is_refused(
    body: Any, options: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        lattice_solid(body(), "bcc", 8.0, **{"radius": RADIUS, **options})


def test_voids_of_a_body_have_a_skin_too() -> None:
    body = Box(20, 14, 14) - Pos(-4, 0, 0) * Box(4, 4, 4) - Pos(5, 0, 0) * Sphere(2)
    lines = [[[-12, 0, 0], [12, 0, 0]], [[-4, -9, 0], [-4, 9, 0]], [[5, 0, -9], [5, 0, 9]]]
    struts = Skeleton(np.concatenate(lines), [[0, 1], [2, 3], [4, 5]], RADIUS).joined(1e-6)
    part = strut_solid(body, struts, skin=1.0)
    assert part.is_valid
    assert len(part.shells()) == 4
    kept = (18 * 12 * 12 - 6**3 - 4 / 3 * np.pi * 3**3) - (body.volume - part.volume)
    rods = [2 + 3 + 1, 3 + 3, 3 + 3]
    assert kept == pytest.approx(np.pi * RADIUS**2 * sum(rods), rel=0.02)


def test_a_sphere_away_from_the_origin_is_hollowed() -> None:
    hollow = hollow_solid(Pos(5, 1, -2) * Sphere(6), 1.0)
    assert hollow.inner.volume == pytest.approx(4 / 3 * np.pi * 5**3, rel=1e-9)
    assert tuple(hollow.inner.center()) == pytest.approx((5, 1, -2), abs=1e-9)


def test_a_loose_skin_around_a_void_is_refused() -> None:
    body, rod = Box(16, 16, 16) - Pos(4, 4, 4) * Box(2, 2, 2), [[-9, -4, -4], [9, -4, -4]]
    with pytest.raises(BrepError, match="hangs loose between them, such as the skin around a void"):
        strut_solid(body, Skeleton(rod, [[0, 1]], RADIUS), skin=1.0)


def promised(body: Any, caplog: pytest.LogCaptureFixture, **options: Any) -> tuple[float, int]:
    """Return the seconds that are logged before struts of a body are cut, and how many faces."""
    hollow, cross = hollow_solid(body, 1.0), [[-9, 0, 0], [9, 0, 0], [0, 0, -9], [0, 0, 9]]
    struts = round_struts(Skeleton(cross, [[0, 1], [2, 3]], RADIUS).joined(1e-6), **options)
    caplog.clear()
    with caplog.at_level(logging.INFO, "scaffold_cad.filling"):
        filled_solid(hollow, lambda _: struts.skeleton, lambda _: struts)
    (text,) = [each.message for each in caplog.records if "OCCT takes" in each.message]
    match = re.fullmatch(r"OCCT takes some ([\d.]+) s for 4 struts of (\d+) faces", text)
    assert match
    return float(match[1]), int(match[2])


def test_times_told_are_longer_for_curved_skins_and_hollow_struts(
    caplog: pytest.LogCaptureFixture,
) -> None:
    flat, faces = promised(Box(14, 14, 14), caplog)
    assert flat == pytest.approx(0.003 * faces, abs=0.05)
    curved, _ = promised(Sphere(7), caplog)
    assert curved == pytest.approx(0.003 * faces + 4 * 0.1, abs=0.05)
    hollow, more = promised(Box(14, 14, 14), caplog, wall=0.2)
    assert more > 1.8 * faces
    assert hollow == pytest.approx(0.006 * more, abs=0.05)
