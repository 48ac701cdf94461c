"""Solids of scaffolds: whole, without crossings, and holding their skeleton, whatever overlaps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import Manifold

from scaffold_cad.errors import MeshError
from scaffold_cad.io.write import write
from scaffold_cad.lattice import tile
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.embedding import Embedding
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import solid, solidified, to_solid
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.solid.pieces import Pieces, solid_pieces
from scaffold_cad.struts import round_struts
from tests import skeletons as named
from tests.crossings import check_as_written, check_whole
from tests.meshes import CUBE
from tests.real_files import RADII, real_skeleton
from tests.scaffold.test_embedding import CROSSING, DOUBLED_BACK, NARROW, OVERLAPPING_SPHERES
from tests.skeletons import polyline
from tests.solids import check_solid_of, contains
from tests.strategies import skeletons
from tests.validation.attacks import deep_points, swallowed


def test_an_embedded_scaffold_is_taken_as_it_is() -> None:
    scaffold = build_scaffold(named.TETRAPOD)
    result = solidified(scaffold)
    assert len(result.united_edges) == 0
    assert result.manifold.num_vert() == len(scaffold.mesh.vertices)
    assert result.manifold.num_tri() == 2 * len(scaffold.mesh.quads)
    assert result.manifold.volume() > 0
    assert result.manifold.genus() == 0


def test_genus_of_the_solid_counts_the_loops_of_a_lattice() -> None:
    lattice = tile("bcc", 10.0, (2, 2, 2), radius=0.4)
    assert to_solid(build_scaffold(lattice)).genus() == lattice.loop_count


def test_a_bare_mesh_is_taken_as_it_is() -> None:
    assert to_solid(CUBE).volume() == pytest.approx(CUBE.signed_volume, rel=1e-12)


@pytest.mark.parametrize("skeleton", [CROSSING, OVERLAPPING_SPHERES, NARROW, DOUBLED_BACK])
def test_overlapping_struts_are_united_and_named(skeleton: Skeleton) -> None:
    result = solidified(build_scaffold(skeleton))
    assert len(result.united_edges)
    check_solid_of(skeleton, result.manifold)


def test_two_crossing_bars_have_the_volume_of_their_union() -> None:
    plus = Skeleton([[-10, 0, 0], [10, 0, 0], [0, -10, 0.5], [0, 10, 0.5]], [[0, 1], [2, 3]], 1.0)
    manifold = to_solid(build_scaffold(plus))
    # Square bars of side 2 and length 20, apart by half a millimeter: 2 x 2 x 1.5 in common.
    assert manifold.volume() == pytest.approx(2 * 80 - 6, rel=1e-3)
    assert manifold.genus() == 0


def test_bars_that_touch_along_an_edge_do_so_no_longer(tmp_path: Path) -> None:
    nodes = [[0, 0, 0], [0, 0, 10], [2, 2, 0], [2, 2, 10]]
    bars = build_scaffold(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))
    write(bars, tmp_path / "bars.stl")
    read = trimesh.load_mesh(tmp_path / "bars.stl")  # by the positions alone
    assert read.is_watertight
    assert read.volume == pytest.approx(80, rel=0.01)


def test_struts_that_leave_their_cones_are_as_thick_as_in_the_scaffold() -> None:
    skeleton = swallowed(np.random.default_rng([74, 170]))
    scaffold = build_scaffold(skeleton)
    assert not scaffold.embedding().within_cone[3].all()
    points = deep_points(skeleton)
    built = TriangleMesh(scaffold.mesh.vertices, scaffold.mesh.triangles)
    held = contains(manifold_triangles(to_solid(scaffold)), points[contains(built, points)])
    assert held.mean() > 0.99


def test_a_ring_too_thick_for_its_hole_is_filled() -> None:
    angle = np.linspace(0, 2 * np.pi, 13)[:-1]
    points = np.column_stack([3 * np.cos(angle), 3 * np.sin(angle), 0 * angle])
    ring = Skeleton(points, polyline(12, closed=True), 2.5)
    check_solid_of(ring, to_solid(build_scaffold(ring)))


@given(skeletons(), st.sampled_from([1.0, 2.0, 4.0]), st.booleans())
@settings(max_examples=25)
def test_solids_of_random_skeletons(skeleton: Skeleton, factor: float, collars: bool) -> None:
    thick = skeleton.with_radii(factor * skeleton.radii)
    check_solid_of(thick, to_solid(build_scaffold(thick, collars=collars)))


@pytest.mark.parametrize("name", [name for name in RADII if name != "nrn_ordering.swc"])
@pytest.mark.parametrize("factor", [1, 4])
def test_solids_of_real_files(shared_data: Path, name: str, factor: int) -> None:
    skeleton = real_skeleton(shared_data, name, factor)
    check_solid_of(skeleton, to_solid(build_scaffold(skeleton)))


def test_only_struts_near_a_fault_are_made_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    wide = [[0, 0, 0], [40, 0, 0]]
    crosses = [[[x, -9, 0.5], [x, 9, 0.5]] for x in (10, 30)]
    nodes = np.concatenate([wide, *crosses])
    skeleton = Skeleton(nodes, [[0, 1], [2, 3], [4, 5]], 1.0)
    asked = []
    clean = solid.clean_surface

    def faulty_twice(manifold: Manifold, factor: float) -> TriangleMesh:
        if len(asked) < 3:
            raise solid.FaultySurfaceError("has a fault", np.array([[10.0, 5.0, 0.5]]))
        return clean(manifold, factor)

    def pieces(scaffold: Scaffold, embedded: Embedding, wobble: np.ndarray) -> Pieces:
        asked.append(wobble)
        return solid_pieces(scaffold, embedded, wobble)

    monkeypatch.setattr(solid, "clean_surface", faulty_twice)
    monkeypatch.setattr(solid, "solid_pieces", pieces)
    result = solid.solidified(build_scaffold(skeleton))
    check_solid_of(skeleton, result.manifold)
    assert len(asked) == 3
    for tries, wobble in enumerate(asked):
        expected = np.zeros(6)
        expected[[2, 3]] = solid.WOBBLES[tries]
        np.testing.assert_array_equal(wobble, expected)


def test_a_union_that_comes_apart_is_made_anew(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    calls: list[float] = []
    clean = solid.clean_surface

    def apart_once(manifold: Manifold, factor: float) -> TriangleMesh:
        calls.append(manifold.volume())
        crumb = Manifold.cube([0.1] * 3).translate([0.0, 0.0, 9.0])
        return clean(manifold + crumb if len(calls) == 1 else manifold, factor)

    monkeypatch.setattr(solid, "clean_surface", apart_once)
    caplog.set_level("DEBUG", "scaffold_cad")
    result = solid.solidified(build_scaffold(OVERLAPPING_SPHERES), factor=0.5)
    bodies = OVERLAPPING_SPHERES.component_count
    assert f"comes apart in {bodies + 1} bodies where the skeleton has {bodies}" in caplog.text
    assert len(calls) == 2
    check_solid_of(OVERLAPPING_SPHERES, result.manifold)


@pytest.mark.parametrize("factor", [1.0, 0.001])
@pytest.mark.parametrize("own", [1.0, 0.5], ids=["radii of nodes", "radii of their own"])
def test_where_no_union_is_clean_struts_are_round_of_the_same_section(
    own: float, factor: float, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def faulty(manifold: Manifold, factor: float) -> TriangleMesh:
        raise solid.FaultySurfaceError("has a fault", np.zeros((0, 3)))

    skeleton = CROSSING.with_edge_radii(own * CROSSING.edge_radii, CROSSING.radii)
    scaffold = build_scaffold(skeleton, collars=own < 1)
    square = solid.solidified(scaffold)
    monkeypatch.setattr(solid, "clean_surface", faulty)
    result = solid.solidified(scaffold, factor=factor)
    assert "the union of 2 overlapping struts has a fault" in caplog.text
    check_solid_of(CROSSING, result.manifold)
    assert result.manifold.volume() == pytest.approx(square.manifold.volume(), rel=0.05)
    assert result.united_edges.tolist() == [0, 1, 2]


def test_thin_rods_far_away_are_one_solid_as_written(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    random, radius = np.random.default_rng(0), 0.02
    centers, ways = 4 * radius * random.uniform(-1, 1, (8, 3)), random.normal(size=(8, 3))
    ways *= 15 * radius / np.linalg.norm(ways, axis=1)[:, None]
    nodes = np.stack([centers - ways, centers + ways], axis=1).reshape(-1, 3) + 7.6e4
    rods = Skeleton(nodes, np.arange(16).reshape(-1, 2), radius)
    made = to_solid(build_scaffold(rods))
    check_as_written(manifold_triangles(made))
    near = build_scaffold(rods.moved_by([-7.6e4] * 3))
    assert made.volume() == pytest.approx(to_solid(near).volume(), rel=0.15)
    monkeypatch.setattr(solid, "_clean_union", lambda *_: None)
    check_as_written(manifold_triangles(to_solid(build_scaffold(rods))))
    assert "has a radius of 0.125 mm instead of 0.0226 mm" in caplog.text


@pytest.mark.parametrize(("steps", "error"), [(8.0, 0.05), (16.0, 0.01)])
def test_unions_of_thin_struts_far_away_keep_their_volume(steps: float, error: float) -> None:
    arms = np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [-6, -6, 3], [0, 0, 9], [5, -6, -5]])
    star = [[0, k] for k in range(1, 6)]
    radius = steps * 2.0**-7  # steps of 32-bit coordinates at 1e5 mm
    scaffold = build_scaffold(Skeleton(arms + 1e5, star, radius), collars=True)
    assert to_solid(scaffold).volume() == pytest.approx(scaffold.mesh.signed_volume, rel=error)


@pytest.mark.parametrize(("make", "steps"), [(round_struts, 16), (build_scaffold, 2)])
def test_struts_that_files_cannot_hold_so_far_away_are_refused(
    make: Callable[[Skeleton], Any], steps: int, tmp_path: Path
) -> None:
    arms = np.array([[0.0, 0, 0], [9, 0, 0], [-3, 8, 0], [-3, -8, 1]])
    star, away = [[0, 1], [0, 2], [0, 3]], np.array([9e6, 0, 0])  # steps of 1 mm
    near, far = (make(Skeleton(steps * arms + at, star, steps)) for at in (0.0, away))
    assert to_solid(far).volume() == pytest.approx(to_solid(near).volume(), rel=0.03)
    thin = make(Skeleton(steps * arms + away, star, 0.9 * steps))
    with pytest.raises(MeshError, match=rf"edge 0 near .* 1 mm apart; need {steps} mm or"):
        write(thin, tmp_path / "thin.stl")


def test_a_thin_strut_near_the_origin_is_held_whatever_else_is_far_away(tmp_path: Path) -> None:
    nodes = [[0, 0, 0], [9, 0, 0], [9e6, 0, 0], [9e6, 900, 0]]
    both = Skeleton(nodes, [[0, 1], [2, 3]], [0.5, 0.5, 90, 90])
    write(round_struts(both), tmp_path / "both.stl")
    volumes = sorted(part.volume for part in trimesh.load(tmp_path / "both.stl").split())
    assert volumes == pytest.approx([np.pi * 0.5**2 * 9, np.pi * 90**2 * 900], rel=0.01)


@pytest.mark.parametrize("shift", [2.5e-6, 1e-3])
def test_a_part_beside_itself_is_one_solid_as_written(shift: float) -> None:
    arms = np.array([[0.0, 0, 0], [-1.9, -2.8, -0.7], [13, 4, 5], [-8, 11, 4], [3, -6, 12]])
    star = [[0, 1], [0, 2], [0, 3], [0, 4]]
    moved = arms + shift * np.array([0.6, 0.0, 0.8])
    twice = Skeleton(np.concatenate([arms, moved]), [*star, *(np.array(star) + 5).tolist()], 1.0)
    for made in (build_scaffold(twice), round_struts(twice)):
        solids = to_solid(made).decompose()
        assert len(solids) == 1
        check_as_written(manifold_triangles(solids[0]))


@pytest.mark.parametrize(
    ("suffix", "options", "millimeters"),
    [(".stl", {}, 1), (".stl", {"units": "in"}, 25.4), (".stl", {"units": "m"}, 1000),
     (".glb", {}, 1000)],
)  # fmt: skip
def test_a_union_is_whole_as_it_is_written(
    shared_data: Path, tmp_path: Path, suffix: str, options: dict[str, str], millimeters: float
) -> None:
    scaffold = build_scaffold(real_skeleton(shared_data, "nrn_ordering.swc"))
    path = tmp_path / f"neuron{suffix}"
    write(scaffold, path, **options)
    read = trimesh.load_mesh(path, process=False)
    mesh = TriangleMesh(np.asarray(read.vertices, dtype=np.float64), np.asarray(read.faces))
    size = np.ptp(scaffold.mesh.vertices, axis=0).max()
    assert np.ptp(mesh.vertices, axis=0).max() == pytest.approx(size / millimeters, rel=0.01)
    check_whole(mesh)


FAR_OUT = np.array([1e6, 3e5, -2e5])
"""1 km from the origin, where 32-bit coordinates are 0.0625 mm apart, mm."""


def a_star_far_out(radius: float) -> Skeleton:
    tips = 10 * radius * np.array([[1, 0.3, 0.2], [-0.4, 0.9, -0.1], [-0.5, -0.6, 0.6]])
    return Skeleton(FAR_OUT + np.vstack([np.zeros(3), tips]), [[0, 1], [0, 2], [0, 3]], radius)


@pytest.mark.parametrize("radius", [0.07, 0.1, 0.2, 2.0])
def test_embedded_struts_are_whole_as_written_far_from_the_origin(radius: float) -> None:
    scaffold = build_scaffold(a_star_far_out(radius))
    assert scaffold.embedding().certified
    check_as_written(manifold_triangles(to_solid(scaffold)))


def test_what_is_certified_with_room_holds_wherever_vertices_are_rounded_to() -> None:
    scaffold = build_scaffold(named.TETRAPOD)
    embedded = scaffold.embedding()
    rounded = scaffold.mesh.vertices.astype(np.float32)
    assert embedded.room > np.abs(rounded - scaffold.mesh.vertices).max()
    far = build_scaffold(a_star_far_out(0.2)).embedding()
    assert far.certified
    assert far.room < 1e-6


def test_printed_results_are_one_short_line() -> None:
    tripod = Skeleton(
        [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0
    ).with_edge_radii([1.0, 0.8, 0.5])
    assert str(tripod) == "Skeleton: 4 nodes, 3 edges, 9 x 9 x 9 mm, radii 0.5 to 1 mm"
    struts = round_struts(tripod)
    assert str(struts) == (
        "RoundStruts: 3 of 3 struts exact, 0 crowded nodes, 9 x 9 x 9 mm, radii 0.5 to 1 mm"
    )
    solid = solidified(struts)
    count, volume = solid.manifold.num_tri(), solid.manifold.volume()
    assert str(solid) == f"Solidified: {count} triangles, {volume:g} mm³, 0 struts united"
