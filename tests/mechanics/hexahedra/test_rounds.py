"""Hexahedra of round struts: they conform, none is inverted, outer points are on the surface."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad import RoundStruts, Skeleton, build_scaffold, round_struts, to_brep, to_solid
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import cells
from scaffold_cad.mechanics import Hexahedra, hexahedra, write_hexahedra
from tests.mechanics.hexahedra.test_builder import RING, STRUT, face_counts, lattice
from tests.skeletons import CUBE, ELBOW, K4, TAPER, TRIPOD

MIXED = Skeleton(
    [[0, 0, 0], [20, 0, 0], [0, 20, 0], [0, 0, 20], [-20, -20, -20]],
    [[0, 1], [2, 0], [0, 3], [4, 0]],
    edge_radii=[[2.0, 2.0], [1.0, 1.0], [1.5, 0.5], [1.0, 1.0]],
)


def stars(valency: int, least: float, count: int) -> Skeleton:
    """Return random stars side by side, with angles of at least `least` degrees."""
    rng = np.random.default_rng(valency)
    nodes, edges = [], []
    for k in range(count):
        directions: list[np.ndarray] = []
        while len(directions) < valency:
            one = rng.normal(size=3)
            one /= np.linalg.norm(one)
            if all(one @ other < np.cos(np.radians(least)) for other in directions):
                directions.append(one)
        first = len(nodes)
        nodes += [
            np.array([40.0 * k, 0, 0]),
            *(np.array([40.0 * k, 0, 0]) + 12 * np.array(directions)),
        ]
        edges += [[first, first + 1 + j] for j in range(valency)]
    return Skeleton(nodes, edges, 1.0)


def check_conforms(mesh: Hexahedra) -> None:
    counts = face_counts(mesh.hexahedra)
    assert counts.max() == 2
    assert (counts == 1).sum() == len(mesh.boundary)
    assert len(np.unique(mesh.hexahedra)) == len(mesh.points)
    assert mesh.volumes.sum() == pytest.approx(mesh.enclosed_volume, rel=1e-12)


def off_surface(struts: RoundStruts, mesh: Hexahedra) -> np.ndarray:
    """Return how far outer points between collars are from their cylinder or cone, mm."""
    runs, found = struts.runs, []
    outside = np.unique(mesh.boundary)
    for run, (start, end) in enumerate(runs.nodes[runs.edges]):
        own = np.intersect1d(outside, mesh.hexahedra[mesh.edge_of_hexahedron == run])
        points = mesh.points[own[mesh.end_of_point[own] < 0]]
        axis = (end - start) / runs.lengths[run]
        along = (points - start) @ axis
        gap = np.linalg.norm(points - start - along[:, None] * axis, axis=1)
        share = along / runs.lengths[run]
        radius = (1 - share) * runs.radii[run, 0] + share * runs.radii[run, 1]
        near, far = struts.collar[2 * run], runs.lengths[run] - struts.collar[2 * run + 1]
        found.append(np.abs(gap - radius)[(along > near - 1e-9) & (along < far + 1e-9)])
    return np.concatenate(found)


@pytest.mark.parametrize(("sides", "layers"), [(8, 0), (8, 2), (16, 0), (16, 1), (24, 2)])
def test_a_strut_has_the_volume_of_its_prism(sides: int, layers: int) -> None:
    mesh = hexahedra(round_struts(STRUT), sides=sides, layers=layers, along=3)
    assert len(mesh.hexahedra) == 3 * (sides * sides // 16 + sides * layers)
    area = sides / 2 * np.sin(2 * np.pi / sides) * 1.5**2
    assert mesh.volumes.sum() == pytest.approx(20 * area, rel=1e-12)
    assert mesh.quality.min() > (0.8 if layers else 0.35)
    check_conforms(mesh)
    for node in (0, 1):
        np.testing.assert_allclose(
            mesh.points[mesh.end_of_point == node][:, 2], 20.0 * node, atol=1e-12
        )


@pytest.mark.parametrize("name", [name for name in cells() if name != "fbcc"])
def test_no_hexahedron_of_a_named_cell_is_below_a_fifth(name: str) -> None:
    mesh = hexahedra(round_struts(lattice(name)), sides=8, layers=1)
    assert mesh.quality.min() > 0.19
    check_conforms(mesh)


@pytest.mark.parametrize("name", ["bcc", "octet", "kelvin", "diamond"])
def test_more_sides_layers_and_pieces_are_as_good(name: str) -> None:
    mesh = hexahedra(round_struts(lattice(name, count=1)), sides=24, layers=2, along=2)
    assert mesh.quality.min() > 0.19
    check_conforms(mesh)


@pytest.mark.parametrize(("valency", "least"), [(3, 45), (4, 45), (6, 60)])
def test_random_stars_have_no_inverted_hexahedra(valency: int, least: float) -> None:
    struts = round_struts(stars(valency, least, 5))
    assert not struts.crowded.any()
    mesh = hexahedra(struts)
    assert mesh.quality.min() > 0.1
    check_conforms(mesh)


@pytest.mark.parametrize(
    "skeleton", [TRIPOD, ELBOW, K4, CUBE, TAPER, MIXED], ids=lambda each: str(len(each.edges))
)
def test_outer_points_of_straight_parts_are_on_their_cylinder_or_cone(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    mesh = hexahedra(struts, along=3)
    check_conforms(mesh)
    assert mesh.quality.min() > 0.1
    distance = off_surface(struts, mesh)
    assert len(distance) >= 2 * 16 * len(skeleton.edges)
    assert distance.max() < 1e-9 * skeleton.edge_radii.min()


def test_outer_points_at_nodes_are_on_the_faces_as_occt_sees_them() -> None:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt

    struts = round_struts(stars(4, 35, 1))
    still, mesh = hexahedra(struts, relax=0), hexahedra(struts, relax=0.3)
    outside = np.unique(mesh.boundary)
    assert (mesh.points[outside] != still.points[outside]).any()  # some slid along the surface
    shell = to_brep(struts).shell().wrapped
    for point in mesh.points[outside[mesh.end_of_point[outside] < 0]][::5]:
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point.tolist())).Vertex()
        assert BRepExtrema_DistShapeShape(vertex, shell).Value() < 2e-6


def test_a_ring_of_a_curve_closes() -> None:
    struts = round_struts(RING, joints="curve")
    assert struts.curves.closed.tolist() == [True]
    mesh = hexahedra(struts)
    check_conforms(mesh)
    assert mesh.quality.min() > 0.5
    assert set(mesh.edge_of_hexahedron.tolist()) == set(range(12))
    # The curve is nearly a torus.
    outside = mesh.points[np.unique(mesh.boundary)]
    center = np.hypot(outside[:, 0], outside[:, 1]) - 10
    np.testing.assert_allclose(np.hypot(center, outside[:, 2]), 1.0, atol=1e-3)


def test_an_elbow_follows_its_torus() -> None:
    mesh = hexahedra(round_struts(ELBOW, bend="torus"), sides=24)
    check_conforms(mesh)
    assert mesh.quality.min() > 0.5


def test_round_ends_are_on_their_spheres() -> None:
    mesh = hexahedra(round_struts(STRUT, ends="round"))
    check_conforms(mesh)
    assert mesh.quality.min() > 0.3
    for node, height in enumerate((0.0, 20.0)):
        at_end = mesh.points[mesh.end_of_point == node] - [0, 0, height]
        np.testing.assert_allclose(np.linalg.norm(at_end, axis=1), 1.5, rtol=1e-12)
        assert np.abs(at_end[:, 2]).max() == pytest.approx(1.5)
    solid = np.pi * 1.5**2 * 20 + 4 / 3 * np.pi * 1.5**3
    assert mesh.volumes.sum() == pytest.approx(solid, rel=0.035)


def test_volumes_tend_to_that_of_the_struts() -> None:
    struts = round_struts(TRIPOD)
    exact = to_brep(struts).volume
    missing = [1 - hexahedra(struts, sides=n).volumes.sum() / exact for n in (8, 16, 32)]
    # A polygon lacks 1 - sin(2π/n) / (2π/n) of its circle: a quarter with twice the sides.
    assert missing == pytest.approx([0.0997, 0.0255, 0.0064], rel=0.15)


@pytest.mark.parametrize("sides", [8, 16])
@pytest.mark.parametrize("along", [1, 3])
@pytest.mark.parametrize("far", [1.5, 4.0])
def test_a_strut_keeps_the_volume_of_its_cylinder_or_cone(
    sides: int, along: int, far: float
) -> None:
    struts = round_struts(Skeleton([[0, 0, 0], [3, 4, 12]], [[0, 1]], [1.5, far]))
    mesh = hexahedra(struts, sides=sides, along=along, keep="volume")
    exact = np.pi * 13 * (1.5**2 + 1.5 * far + far**2) / 3
    assert mesh.volumes.sum() == pytest.approx(exact, rel=1e-9)
    for node, place in enumerate(struts.skeleton.nodes):
        flat = mesh.points[mesh.end_of_point == node] - place
        np.testing.assert_allclose(flat @ [3, 4, 12], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("skeleton", "sides", "layers", "most"),
    [
        *((one, 8, 1, 0.005) for one in (TRIPOD, ELBOW, K4, MIXED, CUBE)),
        *((one, 16, 0, 0.002) for one in (TRIPOD, K4, lattice("octet", count=1))),
        *((one, 16, 2, 0.002) for one in (ELBOW, MIXED, CUBE)),
    ],
)
def test_nodes_keep_the_volume_of_the_solid(
    skeleton: Skeleton, sides: int, layers: int, most: float
) -> None:
    struts = round_struts(skeleton)
    exact, kept = (
        hexahedra(struts, sides=sides, layers=layers, keep=keep) for keep in ("surface", "volume")
    )
    solid = to_solid(struts, sides=48).volume()
    assert exact.volumes.sum() < (1 - 4 * most) * solid
    assert kept.volumes.sum() == pytest.approx(solid, rel=most)
    assert (kept.quality >= np.minimum(exact.quality, 0.2)).all()
    np.testing.assert_array_equal(kept.hexahedra, exact.hexahedra)
    inside = np.setdiff1d(np.arange(len(kept.points)), kept.boundary)
    np.testing.assert_array_equal(kept.points[inside], exact.points[inside])


def test_round_ends_and_curves_keep_their_volume() -> None:
    mesh = hexahedra(round_struts(STRUT, ends="round"), keep="volume")
    solid = np.pi * 1.5**2 * 20 + 4 / 3 * np.pi * 1.5**3
    assert mesh.volumes.sum() == pytest.approx(solid, rel=2e-4)
    ring = round_struts(RING)
    assert hexahedra(ring, keep="volume").volumes.sum() == pytest.approx(
        to_solid(ring, sides=64).volume(), rel=1e-3
    )


@pytest.mark.parametrize("name", ["fbcc", "triangular_prism", "bccz"])
def test_no_hexahedron_gets_worse_than_asked_for_as_volume_is_kept(name: str) -> None:
    struts = round_struts(lattice(name, count=1))
    before = hexahedra(struts, sides=8)
    assert before.quality.min() > 0.2 - 1e-3
    after = hexahedra(struts, sides=8, keep="volume")
    assert (after.quality >= np.minimum(before.quality, 0.2)).all()
    assert after.volumes.sum() > 1.08 * before.volumes.sum()


def test_round_ends_may_be_missing() -> None:
    mesh = hexahedra(round_struts(CUBE, ends="round"))
    flat = hexahedra(round_struts(CUBE))
    np.testing.assert_array_equal(mesh.points, flat.points)


def test_sets_name_edges_nodes_and_ends_also_where_a_run_passes_joints() -> None:
    row = Skeleton([[10 * k, 0, 0] for k in range(4)], [[1, 0], [1, 2], [2, 3]], 1.0)
    mesh = hexahedra(round_struts(row), along=2)
    assert np.bincount(mesh.edge_of_hexahedron).tolist() == [64, 64, 64]
    middles = mesh.points[mesh.hexahedra].mean(axis=1)[:, 0]
    assert (middles[mesh.edge_of_hexahedron == 1] // 10 == 1).all()
    star = hexahedra(round_struts(TRIPOD), along=2)
    assert set(star.node_of_hexahedron.tolist()) == {-1, 0}
    assert set(star.end_of_point.tolist()) == {-1, 1, 2, 3}


def test_files_keep_what_hexahedra_belong_to(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    mesh = hexahedra(round_struts(TRIPOD))
    write_hexahedra(mesh, tmp_path / "tripod.vtu")
    read = meshio.read(tmp_path / "tripod.vtu")
    np.testing.assert_array_equal(read.cells_dict["hexahedron"], mesh.hexahedra)
    np.testing.assert_array_equal(read.cell_data["strut"][0], mesh.edge_of_hexahedron)
    np.testing.assert_array_equal(read.cell_data["node"][0], mesh.node_of_hexahedron)
    np.testing.assert_array_equal(read.point_data["end"], mesh.end_of_point)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"sides": 12}, "sides is 12; need a multiple of 8"),
        ({"layers": -1}, "layers is -1"),
        ({"along": 0}, "along is 0"),
        ({"keep": "volum"}, "keep is 'volum'.*did you mean 'volume'"),
    ],
)
def test_bad_arguments_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        hexahedra(round_struts(STRUT), **options)


def test_scaffolds_have_eight_sides() -> None:
    with pytest.raises(OptionError, match="sides is 16 for a scaffold; need 8"):
        hexahedra(build_scaffold(STRUT), sides=16)
    with pytest.raises(OptionError, match="keep is 'volume' for a scaffold; need round struts"):
        hexahedra(build_scaffold(STRUT), keep="volume")


def test_struts_without_patches_of_their_own_are_named() -> None:
    with pytest.raises(OptionError, match=r"with a wall of 0\.5 mm have no hexahedra; need solid"):
        hexahedra(round_struts(STRUT, wall=0.5))
    with pytest.raises(OptionError, match="nodes='sharp' have no hexahedra; need nodes='blend'"):
        hexahedra(round_struts(TRIPOD, nodes="sharp"))
    narrow = Skeleton([[0, 0, 0], [9, 0, 0], [9, 1, 0], [0, 9, 0]], [[0, 1], [0, 2], [0, 3]], 1.0)
    with pytest.raises(OptionError, match=r"node 0 at \[0, 0, 0\] mm is crowded"):
        hexahedra(round_struts(narrow))
    crossing = Skeleton([[0, 0, 0], [9, 0, 0], [4, -5, 0.5], [4, 5, 0.5]], [[0, 1], [2, 3]], 1.0)
    with pytest.raises(OptionError, match=r"strut 0 overlaps others near .* need thinner struts"):
        hexahedra(round_struts(crossing))
