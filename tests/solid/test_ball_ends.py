"""Balls at extremities: nodes that are thicker than their only strut."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, slices, write
from scaffold_cad.errors import BrepError, OptionError
from scaffold_cad.mechanics import hexahedra
from scaffold_cad.products import to_brep
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import Nodes
from tests.crossings import check_as_written
from tests.solid.field.judges import thicknesses
from tests.solids import contains

DUMBBELL = Skeleton([[0, 0, 0], [20, 0, 0]], [[0, 1]], [1.5, 3.0], edge_radii=1.0)
PIN = Skeleton([[0, 0, 0], [3, 4, 10]], [[0, 1]], [1.0, 3.2], edge_radii=[[1.0, 3.0]])
STAR = Skeleton(
    [[0, 0, 0], [12, 0, 0], [0, 12, 0], [0, -3, 12]],
    [[0, 1], [0, 2], [0, 3]],
    [1.0, 3.0, 1.0, 2.0],
    edge_radii=1.0,
)
WATER = Skeleton(
    [[0, 0, 0], [9.6, 0, 0], [-2.4, 9.3, 0]], [[0, 1], [0, 2]], [3.8, 3.0, 2.7], edge_radii=1.5
)
CROSSED = Skeleton(
    [[0, 0, 0], [20, 0, 0], [18, -10, 2.5], [18, 10, 2.5]],
    [[0, 1], [2, 3]],
    [1.5, 3.0, 1.0, 1.0],
    edge_radii=1.0,
)
"""A strut through a ball."""


def volume(length: float, balls: tuple[float, float], radii: tuple[float, float]) -> float:
    """Return the volume of a cone and the balls around its ends: of frustum and of two caps."""
    slope = (radii[1] - radii[0]) / length
    found, places, rings = 0.0, [], []
    for size, radius, growth in zip(balls, radii, (slope, -slope), strict=True):
        roots = np.roots([1 + growth**2, 2 * radius * growth, radius**2 - size**2])
        out = max(roots.max(), 0.0)
        found += np.pi * (size + out) ** 2 * (2 * size - out) / 3 if size > radius else 0.0
        places.append(out)
        rings.append(radius + growth * out)
    a, b = rings
    return float(found + np.pi * (length - sum(places)) * (a * a + a * b + b * b) / 3)


@pytest.mark.parametrize("nodes", ["blend", "sharp"])
@pytest.mark.parametrize(
    ("skeleton", "exact"),
    [
        (DUMBBELL, volume(20.0, (1.5, 3.0), (1.0, 1.0))),
        (PIN, volume(np.sqrt(125.0), (1.0, 3.2), (1.0, 3.0))),
        (PIN.scaled(0.01), volume(np.sqrt(125.0), (1.0, 3.2), (1.0, 3.0)) * 1e-6),
    ],
    ids=["dumbbell", "pin", "small pin"],
)
def test_balls_have_their_volume(skeleton: Skeleton, exact: float, nodes: Nodes) -> None:
    struts = round_struts(skeleton, nodes=nodes)
    assert len(struts.overlapping) == 0
    solid = to_brep(struts)
    assert solid.is_valid
    assert solid.volume == pytest.approx(exact, rel=1e-9)
    mesh = round_mesh(struts)
    check_as_written(mesh)
    assert mesh.signed_volume == pytest.approx(exact, rel=1e-5)
    thickness = 0.004 * float(np.ptp(mesh.vertices[:, 2]))
    layers = sum(layer.area for layer in slices(struts, thickness=thickness)) * thickness
    assert layers == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("sides", [8, 12, 64])
def test_points_of_meshes_are_near_the_ball(sides: int) -> None:
    mesh = round_mesh(round_struts(DUMBBELL), sides=sides)
    mesh.check_closed()
    away = np.linalg.norm(mesh.vertices - DUMBBELL.nodes[1], axis=1)
    beyond = away[mesh.vertices[:, 0] > 20 - np.sqrt(8.0) + 1e-6]
    assert len(beyond) > sides * sides / 4
    step = 2 * np.pi / sides
    assert 3.0 < beyond.min() < beyond.max() < 3.0 * (1 + step**2 / 4)


@pytest.mark.parametrize("nodes", ["blend", "sharp"])
def test_atoms_are_spheres_in_step_files(tmp_path: Path, nodes: Nodes) -> None:
    build123d = pytest.importorskip("build123d")
    struts = round_struts(WATER, nodes=nodes)
    path = tmp_path / "water.step"
    write(struts, path)
    solid = build123d.import_step(path)
    assert solid.is_valid
    sizes: dict[str, list[float]] = {"SPHERE": [], "CYLINDER": []}
    for face in solid.faces():
        if face.geom_type.name in sizes:
            sizes[face.geom_type.name].append(face.radius)
    assert sizes["CYLINDER"] == [1.5, 1.5]
    assert sizes["SPHERE"][-2:] == [3.0, 2.7]
    assert set(sizes["SPHERE"][:-2]) == (set() if nodes == "blend" else {3.8})
    assert round_mesh(struts).signed_volume == pytest.approx(solid.volume, rel=2e-4)
    if nodes == "sharp":
        half = [volume(float(size), (3.8, ball), (1.5, 1.5)) for size, ball in _bonds()]
        assert solid.volume == pytest.approx(sum(half) - 4 / 3 * np.pi * 3.8**3, rel=1e-5)


def _bonds() -> list[tuple[float, float]]:
    """Return the length of each bond of water, and the ball at its end, mm."""
    return list(zip(WATER.lengths.tolist(), [3.0, 2.7], strict=True))


@pytest.mark.parametrize("ends", ["flat", "round", "open"])
def test_balls_are_hollow_where_struts_are(ends: str) -> None:
    struts = round_struts(STAR, wall=0.3, ends=ends)  # type: ignore[arg-type]
    assert len(struts.overlapping) == 0
    mesh = round_mesh(struts, sides=64)
    check_as_written(mesh)
    solid = to_brep(struts)
    assert solid.is_valid
    assert mesh.signed_volume == pytest.approx(solid.volume, rel=1e-5)
    ways = np.random.default_rng(0).normal(size=(200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    ways = ways[ways[:, 0] > -0.5]  # away from the strut
    center = np.array([12.0, 0, 0])
    assert contains(mesh, center + 2.97 * ways).all()
    assert contains(mesh, center + 2.73 * ways).all()
    assert not contains(mesh, center + 2.67 * ways).any()
    assert not contains(mesh, center + 3.03 * ways).any()


def test_walls_of_hollow_balls_are_as_thick_as_asked_between_triangles() -> None:
    mesh = round_mesh(round_struts(DUMBBELL, wall=0.3), 16)
    assert thicknesses(mesh).min() > 0.95 * 0.3  # 0.83 where rings inside had other latitudes


def test_walls_of_a_hollow_dumbbell_have_their_volume() -> None:
    exact = volume(20.0, (1.5, 3.0), (1.0, 1.0)) - volume(20.0, (1.2, 2.7), (0.7, 0.7))
    struts = round_struts(DUMBBELL, wall=0.3, ends="open")
    assert to_brep(struts).volume == pytest.approx(exact, rel=1e-9)
    assert round_mesh(struts).signed_volume == pytest.approx(exact, rel=1e-5)


def test_curves_end_in_balls() -> None:
    angle = np.linspace(0, 2, 12)
    points = np.stack([20 * np.cos(angle), 20 * np.sin(angle), 0 * angle], axis=1)
    edges = np.stack([np.arange(11), np.arange(1, 12)], axis=1)
    arc = Skeleton(points, edges, [2.3, *[1.0] * 10, 1.2], edge_radii=1.0)
    struts = round_struts(arc, wall=0.3, ends="open")
    assert len(struts.curves.curved) == 11
    solid = to_brep(struts)
    assert solid.is_valid
    spheres = sorted(face.radius for face in solid.faces() if face.geom_type.name == "SPHERE")
    assert spheres == pytest.approx([0.9, 1.2, 2.0, 2.3], abs=1e-12)
    mesh = round_mesh(struts)
    check_as_written(mesh)
    assert mesh.signed_volume == pytest.approx(solid.volume, rel=1e-4)


@pytest.mark.parametrize(("gap", "overlapping"), [(0.01, []), (-0.01, [0, 1])])
def test_balls_keep_apart_from_other_struts(gap: float, overlapping: list[int]) -> None:
    height = 4.0 + gap
    way = np.array([0.0, np.sin(0.6), np.cos(0.6)])  # no axis of the ball's strut
    across = np.array([0.0, np.cos(0.6), -np.sin(0.6)])
    ends = np.array([20.0, 0, 0]) + height * way + 9 * np.array([[-1], [1]]) * across
    nodes = np.concatenate([DUMBBELL.nodes, ends])
    both = Skeleton(nodes, [[0, 1], [2, 3]], [1.5, 3.0, 1.0, 1.0], edge_radii=1.0)
    assert round_struts(both).overlapping.tolist() == overlapping


@pytest.mark.parametrize(("nodes", "wall"), [("blend", None), ("blend", 0.3), ("sharp", None)])
def test_balls_that_overlap_others_are_facets_where_asked(nodes: Nodes, wall: float | None) -> None:
    struts = round_struts(CROSSED, wall=wall, nodes=nodes)
    with pytest.raises(BrepError, match=r"2 of 2 struts overlap others .*\(edges 0, 1;"):
        to_brep(struts)
    solid = to_brep(struts, overlaps="unite")
    assert solid.is_valid
    spheres = [face.radius for face in solid.faces() if face.geom_type.name == "SPHERE"]
    assert spheres == pytest.approx([1.5] if wall is None else [1.5, 1.2])
    mesh = round_mesh(struts)
    check_as_written(mesh)
    # Walls are thicker between triangles than between the exact faces that a B-rep keeps.
    assert mesh.signed_volume == pytest.approx(solid.volume, rel=0.005 if wall is None else 0.02)


def test_struts_shorter_than_their_balls_are_fields() -> None:
    short = Skeleton([[0, 0, 0], [4, 0, 0]], [[0, 1]], 3.0, edge_radii=1.0)
    struts = round_struts(short)
    assert struts.overlapping.tolist() == [0]
    mesh = round_mesh(struts)
    check_as_written(mesh)
    caps = 2 * np.pi * (3.0 - 2.0) ** 2 * (2 * 3.0 + 2.0) / 3  # what both balls have
    assert mesh.signed_volume == pytest.approx(2 * 36 * np.pi - caps, rel=0.01)  # and a fillet


def test_struts_made_like_others_have_their_balls() -> None:
    still = round_struts(WATER)
    nodes = np.add(WATER.nodes, [[0, 0, 0], [0, 2, 0], [0, 0, 1]])
    bent = Skeleton(nodes, WATER.edges, WATER.radii, 1.5)
    moved = round_mesh(round_struts(bent, like=still))
    check_as_written(moved)
    assert np.array_equal(moved.triangles, round_mesh(still).triangles)
    thinner = Skeleton(WATER.nodes, WATER.edges, [3.8, 1.5, 2.7], edge_radii=1.5)
    with pytest.raises(OptionError, match=r"like has balls at ends \[1, 2\], not \[2\]"):
        round_struts(thinner, like=still)


def test_sockets_are_for_ends_that_are_open() -> None:
    with pytest.raises(
        OptionError, match=r"socket at node 1 at \[20, 0, 0\] mm is in a ball of rad"
    ):
        round_struts(DUMBBELL, wall=0.3, ends="open", sockets={1: (0.8, 2)})


def test_balls_have_no_hexahedra() -> None:
    with pytest.raises(OptionError, match=r"node 1 at \[9\.6, 0, 0\] mm is a ball at an extremity"):
        hexahedra(round_struts(WATER))
