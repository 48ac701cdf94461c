"""Scaffolds: the counts that the paper proves, closed forms, and what stays when nodes move."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from scaffold_cad.base.vectors import dot, length, rotate
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.printability.thickness import thickness_of
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.stars import APOTHEM
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.overlaps import LEAST_ANGLE, overlapping_half_edges
from tests import skeletons as named
from tests.skeletons import polyline, star
from tests.strategies import skeletons

NAMED = {name: value for name, value in sorted(vars(named).items()) if isinstance(value, Skeleton)}

OPTIONS = st.fixed_dictionaries(
    {
        "fit": st.sampled_from(["enclose", "paper"]),
        "section": st.sampled_from(sorted(APOTHEM)),
        "collars": st.booleans(),
    }
)


def check_counts(scaffold: Scaffold) -> None:
    """Assert what the paper proves of the scaffold's refined skeleton."""
    refined, mesh = scaffold.refined, scaffold.mesh
    n, m = len(refined.nodes), len(refined.edges)
    valency = refined.valency
    vertices = np.where(valency >= 3, valency + 2, 4)
    assert len(mesh.quads) == 4 * m + len(refined.extremities)
    assert len(mesh.vertices) == vertices.sum()
    np.testing.assert_array_equal(np.bincount(scaffold.node_of_vertex, minlength=n), vertices)
    assert mesh.euler_characteristic == 2 * (n - m)
    assert len(np.unique(mesh.quads)) == len(mesh.vertices)
    assert all(len(set(row)) == 4 for row in mesh.quads.tolist())
    mesh.check_closed()
    assert mesh.signed_volume > 0


@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize("collars", [False, True])
def test_counts_of_named_skeletons(name: str, collars: bool) -> None:
    check_counts(build_scaffold(NAMED[name], collars=collars))


@given(skeletons(), OPTIONS)
def test_counts_of_random_skeletons(skeleton: Skeleton, options: dict[str, object]) -> None:
    scaffold = build_scaffold(skeleton, **options)  # type: ignore[arg-type]
    check_counts(scaffold)
    if not options["collars"] and not scaffold.refinement.collared.any():
        assert scaffold.refined is skeleton
        assert len(scaffold.mesh.quads) == 4 * len(skeleton.edges) + len(skeleton.extremities)


@given(skeletons())
def test_quads_belong_to_the_edge_that_they_surround(skeleton: Skeleton) -> None:
    scaffold = build_scaffold(skeleton)
    nodes = scaffold.node_of_vertex[scaffold.mesh.quads]  # (f, 4)
    ends = skeleton.edges[scaffold.edge_of_quad]
    at_ends = (nodes == ends[:, :1]) | (nodes == ends[:, 1:])
    assert (at_ends | (nodes >= len(skeleton.nodes))).all()  # those of bevels come later
    sleeves = np.bincount(scaffold.edge_of_quad[: 4 * len(scaffold.refined.edges)])
    np.testing.assert_array_equal(sleeves, 4 + 4 * scaffold.refinement.collared.sum(axis=1))


@given(skeletons())
def test_every_end_of_an_edge_has_four_sides_and_is_ringed_by_its_section(
    skeleton: Skeleton,
) -> None:
    scaffold = build_scaffold(skeleton)
    for side in (0, 1):
        ring = scaffold.mesh.vertices[scaffold.sleeves[:, side]]
        spokes = ring - scaffold.refined.nodes[scaffold.refined.edges[:, side]][:, None, :]
        axis = scaffold.refined.directions[::2][:, None, :]
        areas = dot(np.cross(spokes, np.roll(spokes, -1, axis=1)), axis)
        assert (areas.sum(axis=1) > 0).all()


@pytest.mark.parametrize(
    ("section", "area"), [("circumscribed", 4.0), ("area", np.pi), ("inscribed", 2.0)]
)
def test_volume_of_a_strut(section: str, area: float) -> None:
    scaffold = build_scaffold(named.STRUT.with_radii(1.5), section=section)  # type: ignore[arg-type]
    assert scaffold.mesh.signed_volume == pytest.approx(area * 1.5**2 * 10, rel=1e-12)


def test_an_elbow_is_mitered_without_getting_thin() -> None:
    # A miter cut through the joint keeps the volume of both straight struts.
    scaffold = build_scaffold(named.ELBOW)
    assert scaffold.mesh.signed_volume == pytest.approx(4 * 20, rel=1e-12)


def test_simple_cubic_node_is_a_cube() -> None:
    scaffold = build_scaffold(named.JACK)
    at_node = scaffold.mesh.vertices[scaffold.node_of_vertex == 0]
    np.testing.assert_allclose(np.abs(at_node), 1.0, atol=1e-6)
    # Six square struts of length 10 that start in a cube of side 2.
    assert scaffold.mesh.signed_volume == pytest.approx(8 + 6 * 4 * 9, rel=1e-6)


def test_paper_fit_puts_partition_vertices_on_the_sphere() -> None:
    scaffold = build_scaffold(named.STICK_FIGURE, fit="paper")
    skeleton = named.STICK_FIGURE
    for node in skeleton.branch_points:
        corners = scaffold.mesh.vertices[scaffold.node_of_vertex == node]
        np.testing.assert_allclose(
            length(corners - skeleton.nodes[node]), skeleton.radii[node], rtol=1e-12
        )


@given(skeletons())
def test_enclosing_fit_cuts_no_strut_thinner_than_the_papers(skeleton: Skeleton) -> None:
    enclose, paper = (build_scaffold(skeleton, fit=fit) for fit in ("enclose", "paper"))
    stars = enclose.stars
    if len(stars.vertices) == 0:
        return
    for scaffold in (enclose, paper):
        assert np.isfinite(scaffold.mesh.vertices).all()
    assert scaffold_sides(enclose).min() >= scaffold_sides(paper).min() - 1e-9


def scaffold_sides(scaffold: Scaffold) -> np.ndarray:
    """Return the distance of each spherical quad's sides from its axis, in radii of its node."""
    skeleton = scaffold.skeleton
    half_edges = np.flatnonzero(scaffold.stars.corners[:, 0] >= 0)
    node = skeleton.edges.reshape(-1)[half_edges]
    spokes = scaffold.mesh.vertices[scaffold.stars.corners[half_edges]]
    spokes = spokes - skeleton.nodes[node][:, None, :]
    axis = skeleton.directions[half_edges][:, None, :]
    flat = spokes - dot(spokes, np.broadcast_to(axis, spokes.shape))[..., None] * axis
    side = np.roll(flat, -1, axis=1) - flat
    part = np.clip(-dot(flat, side) / np.maximum(dot(side, side), 1e-300), 0, 1)
    return length(flat + part[..., None] * side) / skeleton.radii[node][:, None]


def test_enclosing_fit_lets_every_section_pass_where_struts_are_long() -> None:
    for skeleton in (named.TRIPOD, named.TETRAPOD, named.JACK, named.BCC_STAR, named.PLANAR_Y):
        assert scaffold_sides(build_scaffold(skeleton)).min() >= 1 - 1e-9


def test_collars_keep_struts_straight_and_their_section_constant() -> None:
    scaffold = build_scaffold(named.TETRAPOD.scaled(2.0).with_radii(1.0), collars=True)
    assert scaffold.refinement.collared.tolist() == [[True, False]] * 4
    assert len(scaffold.refined.joints) == 4
    collars = scaffold.refined.joints
    for collar in collars:
        corners = scaffold.mesh.vertices[scaffold.node_of_vertex == collar]
        np.testing.assert_allclose(
            length(corners - scaffold.refined.nodes[collar]), np.sqrt(2), rtol=1e-12
        )


def test_a_strut_too_short_for_two_collars_gets_one_or_none() -> None:
    def joints(distance: float) -> int:
        both = Skeleton(
            np.array(
                [[0, 0, 0], [distance, 0, 0]]
                + [[x * 20.0, y * 20.0, 0] for x in (-1, 2) for y in (-1, 1)]
            ),
            np.array([[0, 1], [0, 2], [0, 3], [1, 4], [1, 5]]),
            np.array(1.0),
        )
        return int(build_scaffold(both, collars=True).refinement.collared[0].sum())

    counts = [joints(distance) for distance in (30.0, 4.0, 0.2)]
    assert counts[0] == 2
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] == 0


@given(
    skeletons(),
    st.floats(0.1, 10.0),
    st.floats(-np.pi, np.pi),
    st.sampled_from(np.eye(3).tolist()),
)
@settings(max_examples=40)
def test_the_scaffold_follows_when_the_skeleton_turns_moves_and_grows(
    skeleton: Skeleton, factor: float, angle: float, axis: list[float]
) -> None:
    scaffold = build_scaffold(skeleton)

    def follow(points: np.ndarray) -> np.ndarray:
        turned = rotate(points, np.array([axis]), np.array([angle]))
        return factor * turned + np.array([3.0, -5.0, 7.0])

    moved = Skeleton(follow(skeleton.nodes), skeleton.edges, factor * skeleton.radii)
    again = build_scaffold(moved, like=scaffold)
    has_branch = np.isin(
        scaffold.refined.component_of_node,
        scaffold.refined.component_of_node[scaffold.refined.branch_points],
    )
    # The first section of a component without branch points is free to turn about its strut.
    rows = has_branch[scaffold.node_of_vertex]
    centers = again.refined.nodes[scaffold.node_of_vertex]
    away = length(again.mesh.vertices - follow(scaffold.mesh.vertices))
    # Partitions are relaxed again and may settle a little elsewhere.
    assert (away[rows] < 0.2 * length(again.mesh.vertices - centers)[rows]).all()


@given(skeletons(), st.integers(0, 2**32 - 1), OPTIONS)
@settings(max_examples=40)
def test_a_moved_skeleton_keeps_its_quads(
    skeleton: Skeleton, seed: int, options: dict[str, object]
) -> None:
    scaffold = build_scaffold(skeleton, **options)  # type: ignore[arg-type]
    shift = np.random.default_rng(seed).normal(scale=0.02, size=skeleton.nodes.shape)
    moved = build_scaffold(skeleton.moved(skeleton.nodes + shift), like=scaffold)
    assert moved.mesh.quads is scaffold.mesh.quads
    assert moved.options == scaffold.options
    check_counts(moved)
    again = build_scaffold(skeleton, like=moved)
    assert again.mesh.quads is scaffold.mesh.quads


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fit": "nonsense"}, "fit is 'nonsense'; need one of enclose, paper"),
        ({"fit": "paper"}, "fit is 'paper'; need 'enclose' or nothing, as `like` keeps its opt"),
        ({"collars": True}, "collars is True; need False or nothing"),
        ({"section": "inscribed"}, "section is 'inscribed'; need 'area' or nothing"),
        ({"method": "lune"}, "method is 'lune'; need 'dual' or nothing"),
    ],
)
def test_like_refuses_other_options(options: Any, message: str) -> None:
    scaffold = build_scaffold(named.TRIPOD, section="area")
    assert build_scaffold(named.TRIPOD, like=scaffold, section="area").options == scaffold.options
    with pytest.raises(OptionError, match=message):
        build_scaffold(named.TRIPOD, like=scaffold, **options)


@pytest.mark.parametrize("collars", ["no", 1, None])
def test_collars_are_asked_for_by_true_or_false(collars: Any) -> None:
    with pytest.raises(OptionError, match=r"collars is \S+; need True or False"):
        build_scaffold(named.TRIPOD, collars=collars)


def test_like_refuses_other_edges() -> None:
    with pytest.raises(SkeletonError, match=r"`like` has 2 nodes and 1 edges of its own; need the"):
        build_scaffold(named.ELBOW, like=build_scaffold(named.STRUT))


def test_the_same_skeleton_gives_the_same_scaffold() -> None:
    first, second = (build_scaffold(named.STICK_FIGURE, collars=True) for _ in range(2))
    np.testing.assert_array_equal(first.mesh.vertices, second.mesh.vertices)
    np.testing.assert_array_equal(first.mesh.quads, second.mesh.quads)


def test_twist_is_least_and_spread_over_the_branch() -> None:
    scaffold = build_scaffold(named.TREFOIL)
    assert np.abs(scaffold.twist).max() <= np.pi / 4 + 1e-4
    sleeves = (
        scaffold.mesh.vertices[scaffold.sleeves]
        - named.TREFOIL.nodes[named.TREFOIL.edges][:, :, None, :]
    )
    # Corner j of a section faces corner j of the next one: the greatest turn is a small one.
    near, far = sleeves[:, 0, 0], sleeves[:, 1, 0]
    cosine = dot(near, far) / (length(near) * length(far))
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 45


def test_a_plane_ring_has_no_twist_and_plane_sides() -> None:
    angle = np.linspace(0, 2 * np.pi, 9)[:-1]
    ring = Skeleton(
        np.column_stack([10 * np.cos(angle), 10 * np.sin(angle), 0 * angle]),
        polyline(8, closed=True),
        np.array(1.0),
    )
    scaffold = build_scaffold(ring)
    np.testing.assert_allclose(scaffold.twist, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(scaffold.mesh.vertices[:, 2]), 1.0, rtol=1e-12)
    # Pappus: a square of side 2 carried once around a regular octagon.
    side = 2 * 10 * np.sin(np.pi / 8)
    assert scaffold.mesh.signed_volume == pytest.approx(4 * 8 * side, rel=1e-12)


@pytest.mark.parametrize(
    ("skeleton", "message"),
    [
        (Skeleton(np.zeros((0, 3)), np.zeros((0, 2), int), 1.0), "has no edges; need at least one"),
        (
            Skeleton([[0, 0, 0], [1, 0, 0], [5, 5, 5]], [[0, 1]], 1.0),
            r"node 2 at \[.*\] mm has no edge; need at least one \(use Skeleton.cleaned\(\)",
        ),
        (star([[10, 0, 0], [20, 0, 0], [0, 10, 0]]), r"leave node 0 at \[.*\] mm in the"),
    ],
)
def test_a_skeleton_that_cannot_be_scaffolded_is_refused(skeleton: Skeleton, message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        build_scaffold(skeleton)


@given(st.floats(-3, 3) | st.floats(-1e-8, 1e-8) | st.floats(-1e-12, 1e-12), st.floats(0, 3))
def test_edges_that_pass_the_check_are_far_enough_apart_for_a_partition(
    off: float, turn: float
) -> None:
    angle = LEAST_ANGLE * (1 + off / 10)
    axis = np.array([[0.6, 0.64, 0.48]])
    tips = [[9, 2, -3], [9 * np.cos(angle), 9 * np.sin(angle), 0], [9, 0, 0], [-4, 4, 4]]
    skeleton = star(rotate(np.array(tips), axis, np.array([turn])).tolist(), 0.1)
    sound = len(overlapping_half_edges(skeleton.nodes, skeleton.edges)) == 0
    if abs(off) > 1e-7:
        assert sound == (off > 0)
    if sound:
        build_scaffold(skeleton).mesh.check_closed()


@pytest.mark.parametrize("factor", [1e-90, 1e-12, 1e10])
def test_scaffolds_of_any_size_that_is_allowed_are_certified(factor: float) -> None:
    usual = build_scaffold(named.STICK_FIGURE)
    scaffold = build_scaffold(named.STICK_FIGURE.scaled(factor))
    assert scaffold.embedding().certified
    wanted = usual.mesh.signed_volume * factor**3
    assert scaffold.mesh.signed_volume == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("name", ["fit", "section", "method"])
def test_unknown_options_are_refused_by_name(name: str) -> None:
    with pytest.raises(OptionError, match=f"{name} is 'round-ish'; need one of "):
        build_scaffold(named.STRUT, **{name: "round-ish"})  # type: ignore[arg-type]


@pytest.mark.parametrize("height", [1.0, 2.0])
def test_struts_of_curved_shells_are_as_thick_as_asked(height: float) -> None:
    row, column = np.mgrid[:5, :5]
    x, y = 10.0 * column + 5.0 * (row % 2), 10.0 * np.sqrt(0.75) * row
    nodes = np.stack([x, y, height * np.sin(x / 15) * np.cos(y / 17) * 3], axis=2).reshape(-1, 3)
    shell = Skeleton(nodes, KDTree(nodes).query_pairs(13.0, output_type="ndarray"), 0.4)
    assert shell.valency.max() == 6
    made = build_scaffold(shell).mesh
    assert len(thickness_of(shell, TriangleMesh(made.vertices, made.triangles)).thinned) == 0
