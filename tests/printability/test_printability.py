"""Printability: what is found in surfaces, struts, directions and parts, and how it is told."""

from __future__ import annotations

import json
import math
from base64 import b64decode
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from scaffold_cad import (
    QuadMesh,
    Scaffold,
    TriangleMesh,
    build_scaffold,
    catmull_clark,
    round_struts,
    smooth_patches,
    solidified,
    tile,
    to_solid,
    to_trimesh,
    write,
)
from scaffold_cad.errors import FormatError, MeshError, OptionError
from scaffold_cad.io.stl import write_stl
from scaffold_cad.printability import (
    MATERIALS,
    PROCESSES,
    Finding,
    Process,
    Report,
    assert_printable,
    check_printability,
    read_triangles,
)
from scaffold_cad.printability.direction import floating_groups
from scaffold_cad.printability.gaps import flat_ends, free_ends, narrow_gaps
from scaffold_cad.printability.nesting import winding_numbers
from scaffold_cad.printability.page import page
from scaffold_cad.printability.triangletopology import TriangleTopology
from scaffold_cad.printability.walls import thin_walls
from scaffold_cad.scaffold.stars import Section
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.struts.options import Ends
from tests.meshes import CUBE, INSIDE_OUT_CUBE, OPEN_CUBE, TORUS, TWO_CUBES
from tests.skeletons import ELBOW, JACK, K4, NAMED, STRUT, TWO_STRUTS, polyline, star
from tests.validation.printability import (
    FAULTS,
    POWDER,
    alarms,
    faulty_solid,
    good_solid,
    is_named,
    through_stl,
)

if TYPE_CHECKING:
    from manifold3d import Manifold

FDM = PROCESSES["fdm"]
SLS = PROCESSES["sls"]


def triangles_of(mesh: QuadMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.triangles)


def box(width: float, depth: float, height: float, floor: float = 0.0) -> TriangleMesh:
    size = np.array([width, depth, height]) / 2
    mesh = CUBE.moved(CUBE.vertices * size + [0, 0, floor + height / 2])
    return triangles_of(mesh)


def joined(*meshes: TriangleMesh) -> TriangleMesh:
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + k for mesh, k in zip(meshes, first, strict=False)]),
    )


HOLLOW = joined(
    box(10, 10, 10), TriangleMesh(box(2, 3, 4, 3).vertices, box(2, 3, 4).triangles[:, ::-1])
)
"""A box of 1000 mm³ around a void of 24 mm³."""

# -- surfaces ---------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", FAULTS)
@pytest.mark.parametrize("seed", range(2))
def test_a_seeded_fault_is_found_by_name(kind: str, seed: int) -> None:
    report = check_printability(faulty_solid(kind, seed), POWDER)
    assert is_named(kind, report), report
    again = check_printability(through_stl(faulty_solid(kind, seed)), POWDER)
    assert is_named(kind, again), again


@pytest.mark.parametrize("seed", range(10))
def test_a_good_solid_raises_no_alarm(seed: int) -> None:
    solid = good_solid(np.random.default_rng(1000 + seed))
    assert alarms(check_printability(solid, POWDER)) == set()
    assert alarms(check_printability(through_stl(solid), POWDER)) == set()


@pytest.mark.parametrize("name", NAMED)
def test_scaffolds_of_named_skeletons_have_one_handle_a_loop(name: str) -> None:
    report = check_printability(NAMED[name])
    assert report.printable, report
    value = report["genus"].value
    assert value["genus"] == value["loops"] == NAMED[name].loop_count


def test_an_open_cube_has_one_hole_of_four_edges_and_its_places() -> None:
    finding = check_printability(OPEN_CUBE)["watertight"]
    assert finding.verdict == "failure"
    assert finding.value == {"open_edges": 4, "holes": 1}
    middles = {tuple(place) for place in finding.places.tolist()}
    assert middles == {(-1, 0, 1), (1, 0, 1), (0, -1, 1), (0, 1, 1)}


def test_an_inside_out_cube_is_told_from_a_void() -> None:
    report = check_printability(INSIDE_OUT_CUBE)
    assert {finding.name for finding in report.failures} == {"orientation", "volume"}
    assert report["voids"].value["count"] == 0


@pytest.mark.parametrize(("process", "verdict"), [("sls", "failure"), ("fdm", "warning")])
def test_a_void_is_measured_and_keeps_powder_in(process: str, verdict: str) -> None:
    report = check_printability(HOLLOW, process)
    finding = report["voids"]
    assert finding.verdict == verdict
    assert finding.value["volumes_mm3"] == pytest.approx([24.0])
    assert report["components"].value == {"count": 1, "shells": 2}
    assert report["volume"].value["volume_mm3"] == pytest.approx(976.0)


def test_a_body_loose_in_a_void_is_a_part_of_its_own() -> None:
    report = check_printability(joined(HOLLOW, box(0.5, 0.5, 0.5, 5)))
    assert report["overlapping_shells"].verdict == "ok"
    assert report["voids"].value["count"] == 1
    assert report["components"].value["count"] == 2


def test_a_body_within_another_is_an_overlap_though_nothing_crosses() -> None:
    report = check_printability(joined(box(10, 10, 10), box(1, 1, 1, 4)))
    assert report["overlapping_shells"].value == {"buried_shells": 1}
    assert report["self_intersections"].verdict == "ok"


def test_cubes_that_touch_along_an_edge_fail_once_welded_and_two_apart_are_two_parts() -> None:
    shifted = TriangleMesh(CUBE.vertices + np.array([2, 2, 0]), CUBE.triangles)
    report = check_printability(through_stl(joined(triangles_of(CUBE), shifted)))
    assert report["manifold_edges"].value == {"crowded_edges": 1, "most_triangles": 4}
    assert check_printability(TWO_CUBES)["components"].value["count"] == 2


def test_cubes_that_touch_in_a_corner_are_pinched_there() -> None:
    shifted = TriangleMesh(CUBE.vertices + np.array([2, 2, 2]), CUBE.triangles)
    report = check_printability(through_stl(joined(triangles_of(CUBE), shifted)))
    finding = report["manifold_vertices"]
    assert finding.verdict == "warning"
    assert finding.places.tolist() == [[1, 1, 1]]
    assert report.printable


def test_faces_that_only_touch_are_told_from_faces_that_cross() -> None:
    # The small cube stands on the large one, within its face.
    touching = check_printability(joined(box(4, 4, 4), box(1, 1, 1, 4)))["self_intersections"]
    crossing = check_printability(joined(box(4, 4, 4), box(1, 1, 1, 3.5)))["self_intersections"]
    assert (touching.verdict, crossing.verdict) == ("warning", "failure")
    assert touching.value["crossing_pairs"] == 0 < touching.value["touching_pairs"]


def test_crossing_faces_are_pointed_at_where_they_cross() -> None:
    report = check_printability(joined(box(4, 4, 4), box(1, 1, 1, 3.5)))
    places = report["self_intersections"].places
    assert len(places) > 0
    assert places[:, 2] == pytest.approx(np.full(len(places), 4.0))
    assert np.abs(places[:, :2]).max(axis=1) == pytest.approx(np.full(len(places), 0.5))


@given(st.tuples(*[st.floats(-3, 3)] * 3).filter(lambda p: all(abs(abs(x) - 1) > 1e-3 for x in p)))
def test_winding_numbers_tell_inside_from_outside(point: tuple[float, float, float]) -> None:
    inside = max(abs(x) for x in point) < 1
    found = winding_numbers(np.array([point]), CUBE.vertices[CUBE.triangles])
    assert found[0] == pytest.approx(float(inside), abs=1e-9)


@settings(max_examples=50)
@given(
    st.lists(st.tuples(*[st.integers(-2, 2)] * 3), min_size=3, max_size=10, unique=True),
    st.lists(st.tuples(*[st.integers(0, 2**16)] * 3), min_size=1, max_size=20),
    st.sampled_from(sorted(PROCESSES)),
)
def test_any_triangles_get_a_report(
    points: list[tuple[int, int, int]], rows: list[tuple[int, int, int]], process: str
) -> None:
    triangles = np.array(rows) % len(points)
    if not (triangles != np.roll(triangles, 1, axis=1)).all(axis=1).any():
        return
    mesh = TriangleMesh(np.array(points, dtype=float), triangles)
    report = check_printability(mesh, process, direction="best")
    told = json.loads(report.to_json())
    assert told["printable"] == report.printable
    # What `check_closed` refuses is not printable, whatever else is wrong.
    try:
        report.mesh.check_closed()
    except MeshError:
        broken = {"watertight", "manifold_edges", "winding", "degenerate_triangles"}
        assert alarms(report) & broken


def test_a_mesh_without_a_proper_triangle_is_refused() -> None:
    with pytest.raises(MeshError, match="part has no triangle of three vertices"):
        check_printability(TriangleMesh(CUBE.vertices, np.array([[0, 1, 1]])))


def test_what_has_no_surface_is_refused() -> None:
    with pytest.raises(OptionError, match=r"the body is 'cube\.stl'; need"):
        check_printability("cube.stl")


def test_a_skeleton_of_struts_is_a_skeleton() -> None:
    with pytest.raises(OptionError, match=r"need a Skeleton: scaffold\.skeleton is one"):
        check_printability(CUBE, skeleton=build_scaffold(STRUT))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "volume"),
    [
        (solidified, 40.0),
        (lambda scaffold: catmull_clark(scaffold.mesh, 0), 40.0),
        (lambda scaffold: scaffold, 40.0),
        (
            lambda scaffold: smooth_patches(scaffold.mesh),
            catmull_clark(build_scaffold(STRUT).mesh, 4).mesh.signed_volume,
        ),
    ],
    ids=["solidified", "subdivision", "scaffold", "patches"],
)
def test_all_that_has_a_surface_is_checked(make: Callable[[Scaffold], Any], volume: float) -> None:
    pytest.importorskip("build123d")
    report = check_printability(make(build_scaffold(STRUT)))
    assert report.printable, report
    assert report["volume"].value["volume_mm3"] == pytest.approx(volume, rel=0.02)


def test_round_struts_are_checked_with_their_skeleton() -> None:
    report = check_printability(round_struts(STRUT))
    assert report.printable, report
    assert report["volume"].value["volume_mm3"] == pytest.approx(10 * math.pi, rel=1e-9)
    assert report["genus"].value["loops"] == 0
    assert report["strut_diameter"].verdict == "ok"


def test_builders_of_build123d_are_checked() -> None:
    build123d = pytest.importorskip("build123d")
    with build123d.BuildPart() as builder:
        build123d.Box(2, 3, 4)
    report = check_printability(builder)
    assert report["volume"].value["volume_mm3"] == pytest.approx(24.0)


def test_solids_of_other_packages_are_checked_as_they_are() -> None:
    import trimesh

    solid = to_solid(TORUS)
    loaded = trimesh.Trimesh(TORUS.vertices, TORUS.triangles, process=False)
    volumes = {
        check_printability(what)["volume"].value["volume_mm3"] for what in (TORUS, solid, loaded)
    }
    assert max(volumes) == pytest.approx(min(volumes), rel=1e-12)


# -- struts -----------------------------------------------------------------------------------


def test_a_thin_strut_is_named_with_what_the_process_needs() -> None:
    skeleton = JACK.with_radii([1, 1, 1, 0.155, 1, 1, 1])
    finding = check_printability(skeleton, "sls")["strut_diameter"]
    assert finding.verdict == "failure"
    assert finding.value == {
        "least_mm": 0.31, "needed_mm": 0.8, "strut": 2, "thin": 1, "thinned": 0
    }  # fmt: skip
    assert "strut 2 is 0.31 mm, SLS needs 0.8: raise the radius to 0.4" in finding.advice


def test_a_strut_of_the_very_limit_is_thick_enough() -> None:
    assert_printable(STRUT.with_radii(SLS.least_diameter / 2), "sls")
    with pytest.raises(AssertionError, match=r"strut 0 is 0\.79 mm"):
        assert_printable(STRUT.with_radii(0.395), "sls")


def test_sections_within_the_circle_are_thinner_than_its_radius_says() -> None:
    scaffold = build_scaffold(STRUT, section="inscribed")
    value = check_printability(scaffold)["strut_diameter"].value
    assert value["least_mm"] == pytest.approx(math.sqrt(2.0))


@pytest.mark.parametrize(
    ("section", "radius"), [("circumscribed", 0.4), ("area", 0.452), ("inscribed", 0.566)]
)
def test_the_radius_that_is_advised_is_enough(section: Section, radius: float) -> None:
    def finding(radius: float) -> Finding:
        scaffold = build_scaffold(STRUT.with_radii(radius), section=section)
        return check_printability(scaffold, "sls")["strut_diameter"]

    assert finding(0.39).advice.endswith(f"raise the radius to {radius} or more")
    assert finding(radius).verdict == "ok"
    assert finding(radius - 0.001).verdict == "failure"


def test_a_skeleton_that_is_not_the_part_s_fails() -> None:
    mesh = build_scaffold(JACK).mesh
    assert check_printability(mesh, skeleton=JACK)["struts_in_part"].verdict == "ok"
    finding = check_printability(mesh, skeleton=JACK.scaled(3.0))["struts_in_part"]
    assert finding.verdict == "failure"
    assert finding.value == {"outside": 6, "cut": 0, "struts": 6}
    assert finding.text == "6 of 6 struts not in the part, strut 0 first"
    assert len(finding.places) == 6
    assert "struts_in_part" not in [one.name for one in check_printability(JACK)]


@pytest.mark.parametrize(("gap", "cut"), [(0.0, 0), (1.0, 1)])
@pytest.mark.parametrize("share", [0.3, 0.8])
def test_a_strut_that_is_cut_through_beside_its_middle_fails(
    share: float, gap: float, cut: int
) -> None:
    bars = [[0, 0, 0], [20, 0, 0], [20, 10, 0], [0, 10, 0]]
    frame = Skeleton(bars, [[0, 1], [1, 2], [2, 3], [3, 0]], 0.9)
    saw = to_solid(box(gap, 4, 4, -2)).translate((20 * share, 0, 0)) if gap else None
    whole = to_solid(round_struts(frame))
    part = whole if saw is None else whole - saw
    finding = check_printability(part, skeleton=frame)["struts_in_part"]
    assert finding.value == {"outside": 0, "cut": cut, "struts": 4}
    assert finding.verdict == ("failure" if cut else "ok")
    if cut:
        assert finding.text.startswith("1 of 4 struts cut through, strut 0 near [")
        np.testing.assert_allclose(finding.places, [[20 * share, 0, 0]], atol=0.5)


def test_slender_struts_are_warned_of() -> None:
    finding = check_printability(STRUT.with_radii(0.1), replace(SLS, least_diameter=0.1))[
        "slenderness"
    ]
    assert (finding.verdict, finding.value["greatest"]) == ("warning", pytest.approx(50.0))


BALLS = np.zeros((2, 2), dtype=bool)


@pytest.mark.parametrize(("apart", "count"), [(2.6, 0), (2.4, 1), (2.0001, 1)])
def test_the_gap_between_two_struts_is_measured(apart: float, count: int) -> None:
    nodes = np.array([[0, 0, 0], [10, 0, 0], [5, -5, apart], [5, 5, apart]], dtype=float)
    gaps = narrow_gaps(Skeleton(nodes, TWO_STRUTS.edges, 1.0), 0.5, BALLS)
    assert len(gaps.widths) == count
    assert gaps.widths == pytest.approx([apart - 2.0] * count)
    assert gaps.places.tolist() == [[5, 0, apart / 2]] * count


def test_the_gap_beside_a_tapered_strut_takes_the_radius_there() -> None:
    nodes = np.array([[0, 0, 0], [10, 0, 0], [5, -5, 3], [5, 5, 3]], dtype=float)
    gaps = narrow_gaps(Skeleton(nodes, TWO_STRUTS.edges, [0.5, 1.5, 1, 1]), 1.5, BALLS)
    assert gaps.widths == pytest.approx([3 * math.sqrt(1 - 0.1**2) - 2])  # across the slope


@pytest.mark.parametrize("lean", [0.0, 1e-9, 0.5])
def test_the_gap_between_tapered_struts_is_where_their_surfaces_are_nearest(lean: float) -> None:
    nodes = np.array([[0, 0, 0], [20, 0, 0], [0, 3.2, 0], [20, 3.2 + lean, 0.0]])
    radii = np.array([[0.5, 1.5], [0.5, 1.5]])
    struts = Skeleton(nodes, TWO_STRUTS.edges, 1.0).with_edge_radii(radii)
    share = np.linspace(0, 1, 401)[:, None]
    first, second = (a + share * (b - a) for a, b in nodes.reshape(2, 2, 3))
    radius = (0.5 + share).reshape(-1)
    wanted = np.linalg.norm(first[:, None] - second, axis=2) - radius[:, None] - radius
    assert narrow_gaps(struts, 1.0, BALLS).widths == pytest.approx([wanted.min()], abs=1e-4)
    turned = Skeleton(nodes, [[3, 2], [1, 0]], 1.0).with_edge_radii(radii[:, ::-1])
    assert narrow_gaps(turned, 1.0, BALLS).widths == pytest.approx([wanted.min()], abs=1e-4)


@pytest.mark.parametrize(
    ("second", "wanted"),
    [
        ([[10.3, 0, 0], [20, 0, 0]], 0.3),  # end to end
        ([[10.3, 0.4, 0], [20, 0.4, 0]], 0.3),
        ([[10.3, 2.4, 0], [20, 2.4, 0]], math.hypot(0.3, 0.4)),  # rim to rim
        ([[12, -9, 0], [12, 9, 0]], 1.0),  # end to side
        ([[9, 0, 1.5], [9, 0, 9]], 0.5),  # side to end
        ([[10, 0, 0], [20, 0, 0]], 0.0),
    ],
)
def test_the_gap_beside_flat_ends_is_that_of_the_ends_as_they_are(
    second: list[list[float]], wanted: float
) -> None:
    struts = Skeleton([[0, 0, 0], [10, 0, 0], *second], TWO_STRUTS.edges, 1.0)
    assert narrow_gaps(struts, 1.2, free_ends(struts)).widths == pytest.approx([wanted], abs=1e-6)
    if wanted:
        sls = replace(SLS, least_gap=1.2)
        gap = check_printability(round_struts(struts), sls)["strut_gap"].value
        assert (gap["least_mm"], gap["overlapping"]) == (pytest.approx(wanted, abs=1e-6), 0)


@pytest.mark.parametrize(
    ("options", "flat"),
    [
        ({}, 2),
        ({"wall": 0.1, "ends": "open"}, 2),
        ({"wall": 0.3, "ends": "flat"}, 2),
        ({"ends": "round"}, 0),
        ({"wall": 0.1, "ends": "round"}, 0),
    ],
)
def test_flat_ends_are_those_that_a_mesh_closes_across_the_node(
    options: dict[str, Any], flat: int
) -> None:
    along = np.linspace(0, 3, 13)
    nodes = np.column_stack([3000 + 10 * np.cos(along), 10 * np.sin(along), 5 * along])
    helix = Skeleton(nodes, polyline(13), 1.5)
    made = round_struts(helix, **options)
    mesh = manifold_triangles(to_solid(made))
    assert flat_ends(helix, mesh).sum() == flat


def test_the_gap_beside_balls_at_ends_is_that_of_the_balls() -> None:
    struts = Skeleton([[0, 0, 0], [10, 0, 0], [12.3, 0, 0], [20, 0, 0]], TWO_STRUTS.edges, 1.0)
    solid = round_struts(struts, ends="round")
    hollow = round_struts(struts, ends="round", wall=0.2)
    for made in (solid, hollow):
        gap = check_printability(made, replace(SLS, least_gap=0.5))["strut_gap"]
        assert gap.value["least_mm"] == pytest.approx(0.3)


def test_gaps_before_some_flat_ends_are_those_of_each_pair_alone() -> None:
    random = np.random.default_rng(8)
    pairs = random.uniform(-3, 3, (20, 4, 3))
    pairs[:, 2:, 2] += 3.0
    radii, flat = random.uniform(0.2, 1.5, (40, 2)), random.random((40, 2)) < 0.5
    order = random.permutation(40)
    places = pairs + 100.0 * np.arange(20)[:, None, None] * [1, 0, 0]
    edges = np.arange(80).reshape(-1, 2)
    together = Skeleton(places.reshape(-1, 3), edges[order], 1.0).with_edge_radii(radii[order])
    gaps = narrow_gaps(together, 50.0, flat[order])
    assert len(gaps.widths) == 20
    found = np.empty(20)
    found[order[gaps.first] // 2] = gaps.widths
    for k, nodes in enumerate(pairs):
        own = slice(2 * k, 2 * k + 2)
        alone = Skeleton(nodes, TWO_STRUTS.edges, 1.0).with_edge_radii(radii[own])
        assert narrow_gaps(alone, 50.0, flat[own]).widths == pytest.approx([found[k]], abs=1e-6)


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32 - 1))
def test_no_gap_is_lost_by_the_search_by_boxes(seed: int) -> None:
    random = np.random.default_rng(seed)
    nodes = random.uniform(0, 12, (24, 3))
    skeleton = Skeleton(nodes, np.arange(24).reshape(-1, 2), random.uniform(0.1, 1.0, 24))
    gaps = narrow_gaps(skeleton, 1.0, np.zeros((12, 2), dtype=bool))
    found = {
        tuple(sorted(pair)) for pair in zip(gaps.first.tolist(), gaps.second.tolist(), strict=True)
    }
    share = np.linspace(0, 1, 41)[:, None]
    for i in range(12):
        for j in range(i):
            ends, others = skeleton.edges[[i, j]]
            p = nodes[ends[0]] + share * (nodes[ends[1]] - nodes[ends[0]])
            q = nodes[others[0]] + share * (nodes[others[1]] - nodes[others[0]])
            r = skeleton.radii[ends[0]] + share * np.ptp(skeleton.radii[ends]) * np.sign(
                skeleton.radii[ends[1]] - skeleton.radii[ends[0]]
            )
            s = skeleton.radii[others[0]] + share * np.ptp(skeleton.radii[others]) * np.sign(
                skeleton.radii[others[1]] - skeleton.radii[others[0]]
            )
            distance = np.linalg.norm(p[:, None] - q[None], axis=2)
            row, column = np.unravel_index(distance.argmin(), distance.shape)
            width = distance[row, column] - r[row, 0] - s[column, 0]
            # The samples are farther apart than the nearest points, by a step at most.
            if width < 0.2:
                assert (j, i) in found


# -- directions -------------------------------------------------------------------------------


def test_a_table_hangs_over_but_not_upside_down() -> None:
    table = to_solid(box(2, 2, 5)) + to_solid(box(10, 10, 1, 5))
    report = check_printability(table, "fdm")
    assert report["supports"].value["area_mm2"] == pytest.approx(96.0)
    assert report["plate_contact"].value["area_mm2"] == pytest.approx(4.0)
    best = report["best_direction"].value
    assert best["direction"] == [0, 0, -1]
    assert report["best_direction"].text.endswith("supports 0 mm² instead of 96")
    turned = check_printability(table, "fdm", direction="best")
    assert turned["supports"].verdict == "ok"
    assert turned["plate_contact"].value["area_mm2"] == pytest.approx(100.0)
    assert "supports" not in turned["best_direction"].text  # no better than it is


@pytest.mark.parametrize("seed", range(6))
def test_the_best_direction_needs_no_more_support_than_the_one_given(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tips = rng.normal(size=(5, 3)) * 20
    star = Skeleton([[0, 0, 0], *tips], [[0, k] for k in range(1, 6)], 2.0)
    solid = to_solid(build_scaffold(star, section="area", collars=True))
    for direction in rng.normal(size=(3, 3)):
        report = check_printability(solid, "fdm", direction=direction)
        best = check_printability(
            solid, "fdm", direction=report["best_direction"].value["direction"]
        )
        needed, least = (one["supports"].value["area_mm2"] for one in (report, best))
        assert least <= needed * (1 + 1e-9)


@pytest.mark.parametrize("seed", [3, 7, 13, 19])
def test_of_many_directions_none_needs_much_less_support_than_the_best(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = to_trimesh(round_struts(star((rng.normal(size=(5, 3)) * 20).tolist())), sides=8)

    def support(up: np.ndarray) -> float:
        slope = -mesh.face_normals @ up
        return float((mesh.area_faces * slope)[slope > math.cos(math.radians(45))].sum())

    report = check_printability(mesh, "fdm", direction="best")
    others = rng.normal(size=(300, 3))
    least = min(support(other / np.linalg.norm(other)) for other in others)
    assert report["supports"].value["area_mm2"] < least + 0.002 * mesh.area


def test_the_best_direction_is_one_in_which_the_part_fits() -> None:
    rod = box(10, 10, 290)
    assert check_printability(rod, POWDER)["build_volume"].verdict == "ok"
    report = check_printability(rod, POWDER, direction="best")
    assert report["build_volume"].verdict == "ok"
    lying = check_printability(rod, POWDER, direction=[1, 0, 0])
    assert lying["build_volume"].verdict == "failure"
    assert lying["best_direction"].value["direction"] == pytest.approx(report.direction)
    plate = TriangleMesh([[0, 0, 0], [290, 0, 0], [0, 10, 0]], [[0, 1, 2]])  # without a volume
    assert check_printability(plate, POWDER, direction="best")["build_volume"].verdict == "ok"


@pytest.mark.parametrize(("degrees", "area"), [(44.0, True), (45.0, False), (46.0, False)])
def test_faces_hang_over_below_the_angle_of_the_process(degrees: float, area: bool) -> None:
    # A wedge whose lower face rises from the plate at the angle.
    rise = 10 * math.tan(math.radians(degrees))
    mesh = box(10, 4, rise)
    lean = mesh.vertices + np.array([1, 0, 0]) * (10 / rise * mesh.vertices[:, 2:])
    report = check_printability(TriangleMesh(lean, mesh.triangles), "fdm")
    assert (report["supports"].value["area_mm2"] > 0) == area


def test_what_rounding_turns_below_the_angle_hangs_over_neither_in_area_nor_in_count() -> None:
    wedge = box(0.3, 0.3, 0.3)
    turned = wedge.vertices + np.array([1, 0, 0]) * wedge.vertices[:, 2:] + [77.1, 41.15, 17.64]
    rounded = turned.astype(np.float32).astype(np.float64)
    fine = replace(FDM, layer=0.01)
    report = check_printability(TriangleMesh(rounded, wedge.triangles), fine)
    assert report["supports"].value == {"area_mm2": 0.0, "facets": 0}


def test_without_supports_what_hangs_over_cannot_be_printed() -> None:
    tee = star([[10, 0, 0], [-10, 0, 0], [0, 0, -10]])
    assert check_printability(tee, "fdm").printable
    failed = {finding.name for finding in check_printability(tee, "fdm", supports=False).failures}
    assert failed == {"strut_overhang", "islands", "supports"}
    assert_printable(tee, "sls", supports=False)


@pytest.mark.parametrize(
    ("middle", "overhanging"),
    [
        ([[8, 0, 20]], 0),
        ([[x, 0, 20] for x in (2, 4, 6, 8)], 0),
        ([[11, 0, 20]], 1),
        ([[x, 0, 20] for x in (3, 6, 9, 12)], 4),  # short links of a long gap
        ([[4, 0, 22], [8, 0, 20]], 0),
    ],
)
def test_what_crosses_a_short_gap_is_a_bridge(middle: list[Any], overhanging: int) -> None:
    nodes = [[0, 0, 0], [0, 0, 20], *middle, [middle[-1][0], 0, 0]]
    gate = Skeleton(nodes, [[k, k + 1] for k in range(len(nodes) - 1)], 1.0)
    assert check_printability(gate, "fdm")["strut_overhang"].value["overhanging"] == overhanging
    narrow = replace(FDM, longest_bridge=3.0)
    links = len(middle)
    assert check_printability(gate, narrow)["strut_overhang"].value["overhanging"] == links


@pytest.mark.parametrize("size", [6.0, 9.0])
def test_struts_that_cross_a_gap_in_a_level_node_are_bridges(size: float) -> None:
    corners = [[x, y, z] for x in (0, size) for y in (0, size) for z in (0, 20)]
    edges = [[0, 1], [2, 3], [4, 5], [6, 7], *([k, 8] for k in (1, 3, 5, 7))]
    cross = Skeleton([*corners, [size / 2, size / 2, 20]], edges, 1.0)
    value = check_printability(cross, "fdm")["strut_overhang"].value
    assert value["overhanging"] == (4 if size * math.sqrt(2) > FDM.longest_bridge else 0)


def test_struts_that_nothing_holds_at_one_end_hang_over() -> None:
    leg = [[0, 0, 0], [0, 0, 20], [5, 0, 20]]
    named = {1: "1 strut needs support, being below 45°", 2: "2 struts need support, being"}
    for tip, count in (([5, 0, 30], 1), ([9, 0, 20], 2), ([9, 0, 22], 2)):
        arm = Skeleton([*leg, tip], [[0, 1], [1, 2], [2, 3]], 1.0)
        found = check_printability(arm, "fdm")["strut_overhang"]
        assert found.value["overhanging"] == count
        assert found.advice.startswith(named[count])


def test_a_node_below_all_around_it_begins_in_mid_air() -> None:
    # A leg to the plate, an arm, and a hand that hangs from it.
    arm = Skeleton([[0, 0, 0], [0, 0, 20], [10, 0, 20], [10, 0, 12]], [[0, 1], [1, 2], [2, 3]], 1.0)
    report = check_printability(arm, "fdm")
    assert report["floating_nodes"].value == {"count": 1, "nodes": [3]}
    assert report["islands"].value["count"] == 1
    over = check_printability(arm, "fdm", direction=[0, 0, -1])
    assert over["floating_nodes"].value["count"] == 0
    assert check_printability(arm, "sls")["floating_nodes"].verdict == "note"


def test_a_level_set_floats_as_one_and_a_held_one_does_not() -> None:
    heights = np.array([5.0, 5.0, 9.0, 0.0])
    edges = np.array([[0, 1], [1, 2]])
    clear = heights > 1
    group, floating = floating_groups(heights, edges, clear, 1e-9)
    assert floating.tolist() == [group[0]] == [group[1]]
    _, held = floating_groups(heights, np.array([[0, 1], [1, 2], [3, 0]]), clear, 1e-9)
    assert held.tolist() == []


def test_the_floor_of_a_hollow_is_no_island() -> None:
    assert check_printability(HOLLOW, "fdm")["islands"].value["count"] == 0


def test_a_level_face_far_from_the_origin_has_no_islands() -> None:
    table = manifold_triangles(to_solid(box(2, 2, 5)) + to_solid(box(10, 10, 1, 5)))
    turn = Rotation.from_euler("xyz", [35, 15, 5], degrees=True)
    far = turn.apply(table.vertices.copy()) + np.array([1e4, 1e4 / 3, -1e4 / 7])
    rounded = TriangleMesh(far.astype(np.float32).astype(np.float64), table.triangles)
    report = check_printability(rounded, "fdm", direction=turn.apply([0, 0, 1]))
    assert report["islands"].value["count"] == 0
    assert report["supports"].value["area_mm2"] == pytest.approx(96.0, rel=1e-4)


def test_struts_that_mesh_files_cannot_hold_are_not_checked_either() -> None:
    with pytest.raises(
        MeshError, match=r"edge 0 near .* has radius 1 mm, where 32-bit coordinates"
    ):
        check_printability(STRUT.moved_by([1e7, 0, 0]))


@pytest.mark.parametrize(
    "direction", [[0, 0, 0], [1, 0], [math.nan, 0, 1], "up", ["x", "y", "z"], None]
)
def test_a_bad_direction_is_refused(direction: Any) -> None:
    with pytest.raises(OptionError, match="build direction is"):
        check_printability(CUBE, direction=direction)


@pytest.mark.parametrize("size", [1e-300, 1.0, 1e300])
def test_the_length_of_a_direction_does_not_matter(size: float) -> None:
    assert check_printability(CUBE, direction=[0, size, 0]).direction.tolist() == [0, 1, 0]


def jar(opening: float) -> Manifold:
    """Return a cube of 20 mm with a hollow of 16 mm and a round opening at its top."""
    hollow = to_solid(box(20, 20, 20)) - to_solid(box(16, 16, 16, 2))
    drill = type(hollow).cylinder(10, opening / 2, circular_segments=32)
    return hollow - drill.translate((0, 0, 15))


@pytest.mark.parametrize(("opening", "pockets"), [(2.0, 1), (6.0, 0)])
def test_a_jar_with_a_narrow_opening_keeps_its_powder(opening: float, pockets: int) -> None:
    report = check_printability(jar(opening), "sls")
    assert report["voids"].value["count"] == 0
    finding = report["drainage"]
    assert finding.value["pockets"] == pockets
    assert finding.verdict == ("warning" if pockets else "ok")
    # The center of a ball a third smaller than 3.5 mm has a cube of 13.7 mm, give or take a step of
    # 0.6 mm on either side.
    side = finding.value["volume_mm3"] ** (1 / 3)
    assert side == pytest.approx(pockets * 13.7, abs=pockets * 1.2)
    assert (np.abs(finding.places - [0, 0, 10]) < 8).all()
    assert check_printability(jar(opening), "fdm")["drainage"].verdict == "ok"


def test_a_solid_block_has_no_pocket_and_a_huge_part_is_not_looked_at() -> None:
    assert check_printability(box(20, 20, 20), "sls")["drainage"].value["pockets"] == 0
    assert check_printability(box(160, 160, 290), "sls")["drainage"].value is None


# -- parts ------------------------------------------------------------------------------------


def test_size_mass_and_density_of_a_box() -> None:
    report = check_printability(box(20, 10, 5), "lpbf")
    assert report["build_volume"].value["size_mm"] == pytest.approx([20, 10, 5])
    assert report["mass"].value["mass_g"] == pytest.approx(4.41)
    assert report["relative_density"].value["relative_density"] == pytest.approx(1.0)
    assert report["triangles"].value == {"count": 12, "stl_bytes": 84 + 600}
    heavy = check_printability(box(20, 10, 5), "lpbf", material="in718")
    assert heavy["mass"].value["mass_g"] == pytest.approx(MATERIALS["in718"])


@pytest.mark.parametrize(
    ("size", "fits"),
    [((249, 200, 209), True), ((200, 249, 209), True), ((209, 200, 249), False)],
)
def test_a_part_may_be_turned_on_the_plate_only(size: tuple[float, ...], fits: bool) -> None:
    report = check_printability(box(*size), "fdm")
    assert report.printable == fits
    advised = "stand it on another side" in report["build_volume"].advice
    assert advised == (not fits)
    too_large = check_printability(box(300, 300, 300), "fdm")["build_volume"].advice
    assert too_large.startswith("scale it down")


def test_a_long_part_is_turned_about_the_vertical_to_fit() -> None:
    report = check_printability(box(280, 4, 4), "fdm")
    assert report.printable
    width, depth, height = report["build_volume"].value["size_mm"]
    assert (max(width, depth) < 250, min(width, depth) < 210) == (True, True)
    assert height == pytest.approx(4)
    assert not check_printability(box(330, 4, 4), "fdm").printable


def test_the_printed_volume_of_the_file_is_its_size(tmp_path: Path) -> None:
    report = check_printability(TORUS)
    write_stl(report.mesh, tmp_path / "torus.stl")
    assert (tmp_path / "torus.stl").stat().st_size == report["triangles"].value["stl_bytes"]


def test_unknown_names_and_negative_limits_are_refused() -> None:
    with pytest.raises(OptionError, match="process is 'glue'; need one of fdm, sla, sls, lpbf"):
        check_printability(CUBE, "glue")
    with pytest.raises(OptionError, match=r"process is a list; need one of .*, or a Process"):
        check_printability(CUBE, [])  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="material is 'cheese'"):
        check_printability(CUBE, material="cheese")
    with pytest.raises(OptionError, match=r"material is \['pla'\]"):
        check_printability(CUBE, material=["pla"])  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="layer of a process is 'thin'; need a number"):
        replace(SLS, layer="thin")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="least_gap of a process is -1; need >= 0"):
        replace(SLS, least_gap=-1)
    with pytest.raises(OptionError, match="build_volume of a process is nan"):
        replace(SLS, build_volume=(1, 2, math.nan))
    with pytest.raises(
        OptionError, match=r"build_volume of a process is \(1, 2\); need a tuple of 3"
    ):
        replace(SLS, build_volume=(1, 2))  # type: ignore[arg-type]
    with pytest.raises(
        OptionError, match="overhang_angle of a process is 45 rad; need at most pi/2"
    ):
        replace(SLS, overhang_angle=45)
    with pytest.raises(OptionError, match="supports is 'no'; need True or False"):
        check_printability(CUBE, supports="no")  # type: ignore[arg-type]


def test_a_process_of_ones_own_is_taken() -> None:
    own = Process("clay", 5.0, 2.0, 10.0, math.radians(60), 0.0, 0.0, 1.0, (500, 500, 500))
    report = check_printability(ELBOW, own)
    assert "CLAY needs 5" in report["strut_diameter"].advice
    assert report.as_dict()["process"] == "clay"


# -- reports ----------------------------------------------------------------------------------


def test_a_report_is_a_table_and_json_with_the_same_findings() -> None:
    report = check_printability(K4, "fdm", name="k4")
    told = json.loads(report.to_json())
    assert told["printable"] is True
    assert list(told["findings"]) == [finding.name for finding in report]
    table = str(report)
    assert table.startswith("k4: printable by fdm; look at")
    for finding in report:
        assert finding.text in table
        assert finding.name in report
        assert report[finding.name] is finding
    with pytest.raises(KeyError, match="'color' was not checked"):
        report["color"]


def test_the_keys_of_the_json_form_are_what_they_were() -> None:
    report = check_printability(K4)
    assert [finding.name for finding in report] == [
        "watertight",
        "manifold_edges",
        "winding",
        "manifold_vertices",
        "degenerate_triangles",
        "orientation",
        "overlapping_shells",
        "voids",
        "components",
        "self_intersections",
        "genus",
        "strut_diameter",
        "slenderness",
        "strut_gap",
        "strut_overhang",
        "floating_nodes",
        "islands",
        "supports",
        "plate_contact",
        "best_direction",
        "drainage",
        "wall_thickness",
        "build_volume",
        "volume",
        "mass",
        "relative_density",
        "triangles",
    ]


def test_the_page_holds_the_report_and_nothing_from_outside() -> None:
    report = check_printability(OPEN_CUBE, name="<script>alert(1)</script>")
    text = page(report)
    assert "<script>alert" not in text
    assert "not printable by sls" in text
    assert "http" not in text
    scene = json.loads(text.split('type="application/json">')[1].split("</script>")[0])
    layers = {layer["name"]: layer for layer in scene["layers"]}
    assert layers["watertight"]["shown"]
    (marks,) = layers["watertight"]["parts"]
    assert len(b64decode(marks["points"])) == 4 * 3 * 4  # open edges, coordinates, bytes


# -- walls ------------------------------------------------------------------------------------


TRIPOD = star([[20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 20.0]], 4.0)


@pytest.mark.parametrize("wall", [0.3, 0.7, 1.0])
@pytest.mark.parametrize("ends", ["open", "flat", "round"])
def test_walls_of_hollow_struts_are_measured(wall: float, ends: Ends) -> None:
    report = check_printability(round_struts(TRIPOD, wall=wall, ends=ends), "sls")
    found = report["wall_thickness"]
    assert found.verdict == ("failure" if wall < 0.8 else "ok")
    if wall < 0.8:
        assert found.value is not None
        assert found.value["least_mm"] == pytest.approx(wall, rel=0.04)
        assert f"{found.value['least_mm']:.3g} mm near" in found.text


@pytest.mark.parametrize(("thickness", "limit"), [(0.5, 0.6), (0.5, 0.45), (3.0, 3.5)])
@pytest.mark.parametrize("turn", [0, 0.3])
def test_skins_are_measured_without_a_skeleton(thickness: float, limit: float, turn: float) -> None:
    hull = to_solid(box(20, 16, 12)) - to_solid(
        box(20 - 2 * thickness, 16 - 2 * thickness, 12 - 2 * thickness, thickness)
    )
    turned = hull.rotate((40 * turn, 70 * turn, 50 * turn))
    surface = TriangleTopology(manifold_triangles(turned))
    walls = thin_walls(surface, limit)
    assert (len(walls.thickness) == len(surface.triangles)) == (thickness < limit)
    assert walls.thickness == pytest.approx(thickness, abs=1e-5)


def test_what_is_beside_an_edge_is_no_wall() -> None:
    wedge = np.array([[0, 0, 0], [9, 0, 0], [9, 0, 2], [0, 9, 0], [9, 9, 0], [9, 9, 2]], float)
    triangles = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [0, 3, 5]]
    mesh = TriangleMesh(wedge[:, [0, 1, 2]], [row[::-1] for row in [*triangles, [0, 5, 2]]])
    assert check_printability(mesh)["wall_thickness"].verdict == "ok"


def test_walls_of_an_open_surface_are_not_measured() -> None:
    assert check_printability(OPEN_CUBE)["wall_thickness"].verdict == "note"


@pytest.mark.parametrize(("side", "is_wall"), [(2e-3, False), (0.03, False), (0.3, True)])
def test_folds_that_are_too_small_to_be_seen_are_no_walls(side: float, is_wall: bool) -> None:
    # A fin of a thousandth of a millimeter stands on a block.
    whole = to_solid(box(10, 10, 10)) + to_solid(box(side, 1e-3, side + 1, 9))
    found = check_printability(whole, "fdm")["wall_thickness"]
    assert (found.verdict == "failure") == is_wall
    if is_wall:
        assert found.value is not None
        assert found.value["least_mm"] == pytest.approx(1e-3, rel=0.01)


# -- files ------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".obj", ".ply"])
def test_files_are_checked_as_what_was_written(suffix: str, tmp_path: Path) -> None:
    write(build_scaffold(K4), tmp_path / f"k4{suffix}")
    mesh = read_triangles(tmp_path / f"k4{suffix}")
    assert mesh is not None
    report = check_printability(mesh)
    assert report.printable, report
    ours = check_printability(K4)
    assert report["genus"].value["genus"] == 3
    volume = ours["volume"].value["volume_mm3"]
    assert report["volume"].value["volume_mm3"] == pytest.approx(volume, rel=1e-6)


def test_files_of_lines_or_beams_hold_no_triangles(shared_data: Path) -> None:
    assert read_triangles(shared_data / "saddle.obj") is None
    assert read_triangles(shared_data / "pyramid.3mf") is None
    assert read_triangles(shared_data / "hand.graph") is None


def test_bad_mesh_files_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"absent.stl cannot be read"):
        read_triangles(tmp_path / "absent.stl")
    (tmp_path / "bad.3mf").write_bytes(b"no archive")
    with pytest.raises(FormatError, match=r"bad.3mf cannot be unpacked"):
        read_triangles(tmp_path / "bad.3mf")
    (tmp_path / "bad.stl").write_bytes(b"solid nothing\nendsolid\n")
    with pytest.raises(FormatError, match=r"bad.stl"):
        read_triangles(tmp_path / "bad.stl")


def test_a_lattice_is_checked_as_a_whole() -> None:
    lattice = tile("bcc", 6.0, 2, radius=0.5)
    report: Report = check_printability(lattice, "lpbf")
    assert report.printable, report
    assert report["strut_overhang"].value["least_deg"] == pytest.approx(
        math.degrees(math.asin(1 / math.sqrt(3)))
    )
    assert report["floating_nodes"].value["count"] == 0


def test_struts_are_measured_where_they_are_thinner_than_asked_for() -> None:
    tripod = Skeleton(
        [[0, 0, 0], [20, 0, 0], [0, 20, 0], [0, 0, 20]], [[0, 1], [0, 2], [0, 3]], 2.0
    )
    mesh = to_trimesh(to_solid(round_struts(tripod, blend=1.0))).subdivide_to_size(0.5)
    report = check_printability(mesh, "sls", skeleton=tripod)
    assert report["strut_diameter"].verdict == "ok"
    assert report["strut_diameter"].value["least_mm"] == 4.0
    waist = 1 - 0.6 * np.exp(-(((mesh.vertices[:, 0] - 13) / 2) ** 2))
    mesh.vertices[:, 1:] *= np.where(mesh.vertices[:, 0] > 6, waist, 1.0)[:, None]
    found = check_printability(mesh, "sls", skeleton=tripod)["strut_diameter"]
    assert found.verdict == "warning"
    assert found.value["least_mm"] == pytest.approx(0.4 * 4.0, rel=0.03)
    assert found.value["strut"] == 0
    assert "strut 0 measures 1.6" in found.advice
    assert "near [13, 0, 0] mm, not 4" in found.advice
    needed = replace(SLS, least_diameter=2.0)
    failed = check_printability(mesh, needed, skeleton=tripod)["strut_diameter"]
    assert failed.verdict == "failure"
    assert "1 strut too thin: strut 0 is 1.6" in failed.advice
    assert "raise the radius to 1 or more; 1 strut thinner than asked for" in failed.advice


def test_a_notch_in_a_slender_strut_is_found_wherever_it_is() -> None:
    rings = np.array([0.0, *(60.0 + np.array([0.0, 0.1, 1.4, 1.5])), 200.0])
    radii = np.array([1.0, 1.0, 0.5, 0.5, 1.0, 1.0])
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    ring = np.concatenate([radii[:, None, None] * circle, np.broadcast_to(
        rings[:, None, None], (6, 16, 1))], axis=2)  # fmt: skip
    points = np.concatenate([ring.reshape(-1, 3), [[0, 0, 0], [0, 0, 200]]])
    first = np.arange(16)
    after = np.roll(first, -1)
    bands = [np.stack([first, after, after + 16], axis=1) + 16 * k for k in range(5)]
    bands += [np.stack([first, after + 16, first + 16], axis=1) + 16 * k for k in range(5)]
    ends = [np.stack([after, first, np.full(16, 96)], axis=1)]
    ends += [np.stack([first + 80, after + 80, np.full(16, 97)], axis=1)]
    pin = Skeleton([[0, 0, 0], [0, 0, 200]], [[0, 1]], 1.0)
    report = check_printability(TriangleMesh(points, [*np.concatenate(bands + ends)]), skeleton=pin)
    assert report["strut_diameter"].value["least_mm"] == pytest.approx(1.0, rel=0.02)


def test_struts_whose_axes_are_in_a_bore_are_in_the_part() -> None:
    pipe = round_struts(ELBOW, wall=0.4, ends="open")
    report = check_printability(solidified(pipe), "sls", skeleton=ELBOW)
    assert report["struts_in_part"].value == {"outside": 0, "cut": 0, "struts": 2}
    beside = ELBOW.moved_by([0, 0, 2.5])
    value = check_printability(solidified(pipe), "sls", skeleton=beside)["struts_in_part"].value
    assert value["outside"] == 2


def test_the_bore_and_the_facets_of_struts_are_not_thin() -> None:
    rng = np.random.default_rng(5)
    tips = rng.normal(size=(5, 3))
    tips *= 20 / np.linalg.norm(tips, axis=1)[:, None]
    star = Skeleton([[0, 0, 0], *tips], [[0, k] for k in range(1, 6)], 1.0)
    star = star.with_edge_radii([1.0, 1.2, 1.4, 1.6, 1.8])
    for struts in (round_struts(star), round_struts(star, wall=0.4, ends="open")):
        value = check_printability(struts, "sls")["strut_diameter"].value
        assert (value["least_mm"], value["thinned"]) == (2.0, 0)
    square = check_printability(build_scaffold(star, section="area", collars=True), "sls")
    assert square["strut_diameter"].value["thinned"] == 0


def test_skeletons_with_struts_of_no_length_or_without_struts_are_checked() -> None:
    mesh = to_solid(round_struts(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)))
    doubled = Skeleton([[0, 0, 0], [9, 0, 0], [9, 0, 0]], [[0, 1], [1, 2]], 1.0)
    value = check_printability(mesh, "sls", skeleton=doubled)["strut_diameter"].value
    assert (value["least_mm"], value["thinned"]) == (2.0, 0)
    bare = check_printability(mesh, "sls", skeleton=Skeleton([[0, 0, 0]], [], 1.0))
    assert "strut_diameter" not in bare.as_dict()["findings"]
