"""Skins with drain holes: no void stays closed, and the check of printability agrees."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from build123d import Box, Cylinder, Sphere

from scaffold_cad import check_printability, lattice_part, self_intersections, to_trimesh
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.solid.manifolds import manifold_triangles

BOX = trimesh.creation.box((30.0, 24.0, 16.0))


@pytest.mark.parametrize(
    "body", [BOX, trimesh.creation.icosphere(3, 15.0), Box(40, 30, 20) - Cylinder(6, 30)],
    ids=["box", "ball", "block with a bore"],
)  # fmt: skip
def test_drained_parts_have_no_closed_void_and_are_clean(body: object) -> None:
    closed = lattice_part(body, "bcc", 8.0, 0.7, skin=1.2)  # type: ignore[arg-type]
    part = lattice_part(body, "bcc", 8.0, 0.7, skin=1.2, drain=2.5)  # type: ignore[arg-type]
    assert any(shell.volume() < 0 for shell in closed.decompose())
    assert all(shell.volume() > 0 for shell in part.decompose())
    assert len(part.decompose()) == 1
    assert len(self_intersections(manifold_triangles(part))) == 0
    # What two holes take is about two discs of the skin.
    lost = closed.volume() - part.volume()
    assert lost == pytest.approx(2 * np.pi * 1.25**2 * 1.2, rel=0.5)


def test_the_check_of_printability_finds_no_pocket() -> None:
    part = lattice_part(BOX, "bcc", 8.0, 0.7, skin=1.2, drain=4.0)
    (finding,) = [one for one in check_printability(part).findings if one.name == "drainage"]
    assert finding.verdict == "ok"


def test_a_skin_too_thin_for_holes_is_refused_with_the_place() -> None:
    with pytest.raises(OptionError, match=r"a drain hole of 3 mm at \[.* mm goes .* past"):
        lattice_part(Sphere(8), "bcc", 8.0, 0.5, skin=0.05, drain=3)


def test_holes_are_where_they_are_asked_for() -> None:
    place = np.array([3.9, -3.7, 8.0])
    part = lattice_part(BOX, "bcc", 8.0, 0.7, skin=1.2, drain=3.0, drain_places=[place])
    vertices = manifold_triangles(part).vertices
    on_top = vertices[np.abs(vertices[:, 2] - 8.0) < 1e-6]
    rim = np.hypot(on_top[:, 0] - 3.9, on_top[:, 1] + 3.7)
    assert np.isclose(rim, 1.5, atol=0.01).sum() >= 12
    assert all(shell.volume() > 0 for shell in part.decompose())


def test_holes_that_are_chosen_keep_from_edges_and_have_the_area_of_their_circle() -> None:
    closed, part = (
        to_trimesh(lattice_part(BOX, "bcc", 8.0, 0.7, skin=1.2, **drain))
        for drain in ({}, {"drain": 4.0})
    )
    corners = part.vertices[part.faces]
    half = np.array([15.0, 12.0, 8.0])
    for axis in range(3):
        for side in (-1, 1):
            flat = np.isclose(corners[:, :, axis], side * half[axis], atol=1e-6).all(axis=1)
            lost = 4 * np.delete(half, axis).prod() - part.area_faces[flat].sum()
            holes = lost / (np.pi * 2**2)  # a hole that reaches an edge would take less
            assert holes == pytest.approx(round(holes), abs=2e-3)
    assert closed.volume - part.volume > 2 * np.pi * 2**2 * 1.2 * 0.99


@pytest.mark.parametrize(
    ("diameter", "place", "message"),
    [
        (4.0, [100, 0, 0], r"\[100, 0, 0\] mm of a drain hole is 85 mm from the surface"),
        (4.0, [15, 12, 0], r"4 mm at \[15, 12, 0\] mm goes 2 mm past the surface"),
        (23.0, [6, 0, 8], r"23 mm at \[6, 0, 8\] mm goes 2.5 mm past the surface; need"),
        (30.0, [0, 0, 8], r"30 mm are wider than all voids: the largest is as a ball of 2\d"),
    ],
)
def test_holes_without_room_are_refused(diameter: float, place: object, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        lattice_part(BOX, "bcc", 8.0, 0.7, skin=1.2, drain=diameter, drain_places=[place])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"drain": 2.0}, "drain holes are given without a skin"),
        ({"skin": 1.0, "drain_places": [[0, 0, 8]]}, "given without drain, their diameter"),
        ({"skin": 1.0, "drain": 0.0}, "^drain is 0 mm; need > 0"),
        ({"skin": 1.0, "drain": 1.0, "drain_places": [[0, 0]]}, "places of drain holes has shape"),
    ],
)
def test_options_that_contradict_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        lattice_part(BOX, "bcc", 8.0, 0.7, **options)  # type: ignore[arg-type]


def test_a_void_that_no_place_reaches_is_named() -> None:
    two = trimesh.util.concatenate([BOX, BOX.copy().apply_translation([60.0, 0.0, 0.0])])
    with pytest.raises(MeshError, match=r"voids? stays? closed, one around \[.*\] mm"):
        lattice_part(two, "bcc", 8.0, 0.7, skin=1.2, drain=3.0, drain_places=[[3.9, -3.7, 8.0]])


def test_lengths_that_files_cannot_hold_are_refused() -> None:
    with pytest.raises(OptionError, match=r"skin is 1e-09 mm; need 6.1e-05 mm or more this far"):
        lattice_part(Box(16, 16, 16), "bcc", 8.0, 0.50763, skin=1e-9)
    with pytest.raises(OptionError, match=r"drain is 1e-09 mm; need 6.1e-05 mm or more this far"):
        lattice_part(Box(16, 16, 16), "bcc", 8.0, 0.50763, skin=1.0, drain=1e-9)


def test_thin_holes_need_no_more_places_than_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.filling.drains.MOST_SQUARES", 3000)
    part = lattice_part(Box(16, 16, 16), "bcc", 8.0, 0.7, skin=1.0, drain=0.01)
    assert sum(shell.volume() < 0 for shell in part.decompose()) == 0
