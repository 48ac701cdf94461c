"""Skeletons from build123d's edges and back: welded, split where they meet, near their curves."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import build123d as bd
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GCPnts import GCPnts_TangentialDeflection

from scaffold_cad.base.arrays import Points
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.parts import ScaffoldSolid
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton, check_skeleton
from tests.skeletons import NAMED, STICK_FIGURE, TREFOIL


def distances(skeleton: Skeleton, points: Points) -> Points:
    """Distance of each point from the nearest edge of the skeleton, mm."""
    starts, ends = skeleton.nodes[skeleton.edges[:, 0]], skeleton.nodes[skeleton.edges[:, 1]]
    k, m = len(points), len(starts)
    p = np.repeat(points, m, axis=0)
    _, foot = nearest_on_segments(p, p, np.tile(starts, (k, 1)), np.tile(ends, (k, 1)))
    return np.linalg.norm(p - foot, axis=1).reshape(k, m).min(axis=1)


def along(edge: bd.Edge, count: int = 200) -> Points:
    return np.array([tuple(edge @ t) for t in np.linspace(0, 1, count)])


def at(skeleton: Skeleton, point: Iterable[float]) -> int:
    """The node at a point."""
    gaps = np.linalg.norm(skeleton.nodes - np.array([*point]), axis=1)
    node = int(np.argmin(gaps))
    assert gaps[node] < 1e-4
    return node


CURVES = {
    "circle": bd.Edge.make_circle(20),
    "ellipse": bd.Edge.make_ellipse(30, 8),
    "helix": bd.Edge.make_helix(pitch=8, height=30, radius=10),
    "spline": bd.Edge.make_spline([(0, 0, 0), (10, 12, 3), (20, -6, 8), (30, 0, 0)]),
    "bezier": bd.Edge.make_bezier((0, 0, 0), (30, 50, 0), (-20, 50, 9), (10, 0, 5)),
    "arc": bd.Edge.make_three_point_arc((0, 0, 0), (50, 1, 0), (100, 0, 0)),
}


@pytest.mark.parametrize("tolerance", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("name", CURVES)
def test_chain_is_within_the_tolerance_of_its_curve(name: str, tolerance: float) -> None:
    curve = CURVES[name]
    skeleton = Skeleton.from_edges(curve, 1.0, tolerance=tolerance)
    assert distances(skeleton, along(curve)).max() <= tolerance * (1 + 1e-6)
    for node in skeleton.nodes:
        assert curve.distance_to(bd.Vertex(*node)) < 1e-6


def test_circle_is_a_ring_of_twelve_or_more() -> None:
    ring = Skeleton.from_edges(bd.Edge.make_circle(2), 0.3, tolerance=1.0)
    assert len(ring.edges) == len(ring.nodes) >= 12
    assert ring.loop_count == 1
    assert len(ring.extremities) == 0


def test_straight_edges_have_no_joints() -> None:
    wire = bd.Wire.make_polygon([(0, 0, 0), (10, 0, 0), (10, 10, 0)], close=False)
    skeleton = Skeleton.from_edges(wire, 1.0)
    assert len(skeleton.edges) == 2
    assert len(skeleton.joints) == 1


def test_an_end_on_the_middle_of_an_edge_splits_it() -> None:
    bar = bd.Edge.make_line((0, 0, 0), (20, 0, 0))
    post = bd.Edge.make_line((8, 0, 0), (8, 0, 15))
    skeleton = Skeleton.from_edges([bar, post], 1.0)
    assert len(skeleton.edges) == 3
    assert skeleton.branch_points.tolist() == [at(skeleton, (8, 0, 0))]


def test_an_end_on_the_middle_of_an_arc_splits_it() -> None:
    arc = bd.Edge.make_circle(20, start_angle=0, end_angle=180)
    spoke = bd.Edge.make_line((0, 0, 0), (20 * np.cos(1.0), 20 * np.sin(1.0), 0))
    skeleton = Skeleton.from_edges([arc, spoke], 1.0, tolerance=0.5)
    assert skeleton.component_count == 1
    assert skeleton.branch_points.tolist() == [at(skeleton, spoke @ 1)]
    assert len(skeleton.extremities) == 3


def test_edges_that_cross_share_a_node() -> None:
    one = bd.Edge.make_line((-10, 0, 0), (10, 0, 0))
    other = bd.Edge.make_line((0, -10, 0), (0, 10, 0))
    skeleton = Skeleton.from_edges([one, other], 1.0)
    assert (len(skeleton.nodes), len(skeleton.edges)) == (5, 4)
    assert skeleton.valency[at(skeleton, (0, 0, 0))] == 4


def test_a_line_through_a_circle_shares_two_nodes_with_it() -> None:
    line = bd.Edge.make_line((-30, 5, 0), (30, 5, 0))
    skeleton = Skeleton.from_edges([bd.Edge.make_circle(13), line], 1.0, tolerance=0.5)
    assert sorted(skeleton.branch_points) == sorted(
        [at(skeleton, (-12, 5, 0)), at(skeleton, (12, 5, 0))]
    )
    assert skeleton.loop_count == 2


def test_edges_that_pass_each_other_stay_apart() -> None:
    one = bd.Edge.make_line((-10, 0, 0), (10, 0, 0))
    other = bd.Edge.make_line((0, -10, 0.01), (0, 10, 0.01))
    assert Skeleton.from_edges([one, other], 1.0).component_count == 2
    assert Skeleton.from_edges([one, other], 1.0, contact=0.02).component_count == 1


def test_edges_that_cover_each_other_are_one() -> None:
    one = bd.Edge.make_line((0, 0, 0), (10, 0, 0))
    other = bd.Edge.make_line((15, 0, 0), (5, 0, 0))
    skeleton = Skeleton.from_edges([one, other, one], 1.0)
    assert sorted(skeleton.nodes[:, 0]) == pytest.approx([0, 5, 10, 15])
    assert len(skeleton.edges) == 3


def test_an_edge_given_twice_counts_once() -> None:
    line, arc = bd.Edge.make_line((0, 0, 0), (10, 0, 0)), bd.Edge.make_circle(5)
    for again in (line, bd.Edge(line.wrapped.Reversed())):
        assert len(Skeleton.from_edges([line, again], 0.5).edges) == 1
    once = Skeleton.from_edges(arc, 0.5)
    assert len(Skeleton.from_edges([arc, arc], 0.5).edges) == len(once.edges)
    sketch = bd.Rectangle(4, 3)
    assert len(Skeleton.from_edges([sketch, sketch.wire()], 0.5).edges) == 4


EIGHT = [(-10, 5, 0), (-10, -5, 0), (10, 5, 0), (10, -5, 0), (-10, 5, 0)]
"""Corners of a curve that passes the origin twice."""


@pytest.mark.parametrize(
    "curve",
    [
        bd.Edge.make_spline([bd.Vector(*p) for p in EIGHT[:-1]], periodic=True),
        bd.Edge.make_spline([(0, 0, 0), (10, 0, 0), (10, 10, 0), (5, -5, 0)]),
        bd.Edge.make_bezier((0, 0, 0), (30, 30, 0), (-20, 30, 0), (10, 0, 0)),
    ],
    ids=["eight", "loop", "bezier"],
)
@pytest.mark.parametrize("tolerance", [0.5, 0.05])
def test_a_curve_that_crosses_itself_is_split_there(curve: bd.Edge, tolerance: float) -> None:
    skeleton = Skeleton.from_edges(curve, 0.2, tolerance=tolerance)
    assert [skeleton.valency[node] for node in skeleton.branch_points] == [4]
    assert skeleton.loop_count == 1 + curve.is_closed
    assert distances(skeleton, along(curve)).max() <= tolerance * (1 + 1e-6)
    crossing = bd.Vertex(*skeleton.nodes[skeleton.branch_points[0]])
    assert curve.distance_to(crossing) < 1e-4


@pytest.mark.parametrize(
    "curve",
    [
        bd.Edge.make_helix(5, 50, 10),
        bd.Edge.make_spline([(0, 0, 0), (10, 5, 0), (20, 0, 5), (10, -8, 0)], periodic=True),
    ],
    ids=["helix", "ring"],
)
def test_a_curve_that_winds_and_does_not_cross_itself_is_sampled_as_one(curve: bd.Edge) -> None:
    skeleton = Skeleton.from_edges(curve, 0.2, tolerance=0.1)
    once = GCPnts_TangentialDeflection(BRepAdaptor_Curve(curve.wrapped), np.pi / 6, 0.1)
    assert len(skeleton.edges) == once.NbPoints() - 1
    assert distances(skeleton, along(curve)).max() <= 0.1 * (1 + 1e-6)


def test_sketches_wires_and_lists_give_their_edges() -> None:
    sketch = bd.RectangleRounded(40, 20, 5)
    skeleton = Skeleton.from_edges(sketch, 1.0)
    assert skeleton.loop_count == 1
    assert np.ptp(skeleton.nodes, axis=0) == pytest.approx((40, 20, 0), abs=0.2)
    mixed = [sketch, bd.Pos(0, 0, 10) * sketch.wire(), bd.Line((0, 10, 0), (0, 10, 10))]
    assert Skeleton.from_edges(mixed, 1.0).component_count == 1
    with bd.BuildLine() as builder:
        bd.Line((0, 0), (10, 0))
        bd.RadiusArc((10, 0), (10, 10), -6)
    for curves in (builder.line, builder, [builder]):
        assert Skeleton.from_edges(curves, 1.0).component_count == 1


def test_edges_of_a_box_are_a_frame() -> None:
    skeleton = Skeleton.from_edges(bd.Box(30, 20, 10), 1.0)
    assert (len(skeleton.nodes), len(skeleton.edges)) == (8, 12)
    assert ScaffoldSolid(skeleton).is_valid


def test_poles_are_no_edges() -> None:
    skeleton = Skeleton.from_edges(bd.Sphere(10), 0.5)
    assert len(skeleton.extremities) == 2  # the seam from pole to pole
    check_skeleton(skeleton)


def test_radius_may_be_a_function_of_places() -> None:
    line = bd.Edge.make_line((0, 0, 0), (0, 0, 10))
    skeleton = Skeleton.from_edges(line, lambda points: 1 + points[:, 2] / 10)
    assert skeleton.radii[at(skeleton, (0, 0, 10))] == pytest.approx(2.0)
    assert skeleton.radii[at(skeleton, (0, 0, 0))] == pytest.approx(1.0)
    with pytest.raises(OptionError, match="radius is 0 mm; need > 0"):
        Skeleton.from_edges(line, 0.0)


def test_each_shape_may_have_its_radius() -> None:
    bar, post = bd.Line((0, 0, 0), (20, 0, 0)), bd.Line((10, -5, 0), (10, 5, 0))
    skeleton = Skeleton.from_edges([bar, post], [1.0, 0.5])
    along_bar = (skeleton.nodes[skeleton.edges][..., 1] == 0).all(axis=1)
    assert along_bar.sum() == 2
    np.testing.assert_array_equal(skeleton.edge_radii[along_bar], 1.0)
    np.testing.assert_array_equal(skeleton.edge_radii[~along_bar], 0.5)
    assert skeleton.radii[at(skeleton, (10, 0, 0))] == 1.0


def test_each_edge_of_a_wire_may_have_its_radius() -> None:
    wire = bd.Polyline((0, 0, 0), (10, 0, 0), (10, 10, 0))
    for radius in ([1.0, 0.5], np.array([1.0, 0.5])):
        skeleton = Skeleton.from_edges([wire], radius)
        assert skeleton.radii[at(skeleton, (10, 10, 0))] == 0.5
        assert sorted(skeleton.edge_radii[:, 0]) == [0.5, 1.0]


def test_curves_that_cover_each_other_have_the_larger_radius() -> None:
    long, short = bd.Line((0, 0, 0), (20, 0, 0)), bd.Line((5, 0, 0), (15, 0, 0))
    for curves, radii in (([long, short], [0.5, 1.0]), ([short, long, short], [1.0, 0.5, 0.7])):
        skeleton = Skeleton.from_edges(curves, radii)
        along = np.argsort(skeleton.nodes[skeleton.edges][:, :, 0].mean(axis=1))
        assert skeleton.edge_radii[along, 0].tolist() == [0.5, 1.0, 0.5]


@pytest.mark.parametrize(
    ("radii", "message"),
    [
        (
            [1.0, 2.0, 3.0, 4.0],
            r"has shape \(4,\); need 2, one for each shape, or 3, one for each e",
        ),
        ([1.0, -1.0], "radius of shape 1 is -1 mm; need > 0"),
        ([1.0, 1.0, float("nan")], "radius of edge 2 is nan mm; need > 0"),
        ([1.0, "thick"], "radius is not an array of numbers"),
    ],
)
def test_radii_that_do_not_fit_the_shapes_are_refused(radii: Any, message: str) -> None:
    shapes = [bd.Polyline((0, 0, 0), (10, 0, 0), (10, 10, 0)), bd.Line((0, 0, 0), (0, 0, 9))]
    with pytest.raises(OptionError, match=message):
        Skeleton.from_edges(shapes, radii)


@pytest.mark.parametrize("name", ["tolerance", "contact"])
def test_distances_must_be_positive(name: str) -> None:
    line = bd.Edge.make_line((0, 0, 0), (0, 0, 10))
    with pytest.raises(OptionError, match=f"{name} is 0 mm; need > 0"):
        Skeleton.from_edges(line, 1.0, **{name: 0.0})


def test_what_has_no_edges_is_refused() -> None:
    with pytest.raises(SkeletonError, match="the shapes have no edges; need at least one"):
        Skeleton.from_edges([], 1.0)
    with pytest.raises(SkeletonError, match="the shapes have no edges; need at least one"):
        Skeleton.from_edges(bd.Vertex(0, 0, 0), 1.0)
    with pytest.raises(OptionError, match="'wire' is not a shape of build123d; need edges"):
        Skeleton.from_edges(["wire"], 1.0)
    with pytest.raises(OptionError, match="None is not a shape of build123d; need edges"):
        Skeleton.from_edges(None, 1.0)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="the BuildLine holds no shape yet; need one"):
        Skeleton.from_edges(bd.BuildLine(), 1.0)


def test_an_edge_of_no_length_is_no_wire() -> None:
    skeleton = Skeleton([[0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0, 1], [1, 2]], 0.1)
    with pytest.raises(SkeletonError, match="edge 1 is 0 mm long; need more than 1e-07"):
        skeleton.to_wire_compound()


@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_skeleton_comes_back_from_its_wires(skeleton: Skeleton) -> None:
    wires = skeleton.to_wire_compound()
    back = Skeleton.from_edges(wires, 1.0)
    ends = [tuple(tuple(np.round(p, 6)) for p in back.nodes[pair]) for pair in back.edges]
    asked = [tuple(tuple(np.round(p, 6)) for p in skeleton.nodes[pair]) for pair in skeleton.edges]
    assert sorted(map(sorted, ends)) == sorted(map(sorted, asked))


def test_wires_are_in_the_order_of_the_edges_and_share_their_ends() -> None:
    wires = STICK_FIGURE.to_wire_compound()
    assert isinstance(wires, bd.Curve)
    edges = wires.edges()
    assert len(edges) == len(STICK_FIGURE.edges)
    assert len(wires.vertices()) == len(STICK_FIGURE.nodes)
    for edge, (a, b), length in zip(edges, STICK_FIGURE.edges, STICK_FIGURE.lengths, strict=True):
        assert tuple(edge @ 0) == pytest.approx(STICK_FIGURE.nodes[a])
        assert tuple(edge @ 1) == pytest.approx(STICK_FIGURE.nodes[b])
        assert edge.length == pytest.approx(length)


def test_wires_of_a_ring_make_one_closed_wire() -> None:
    (wire,) = bd.Wire.combine(TREFOIL.to_wire_compound().edges())
    assert wire.is_closed
    assert wire.length == pytest.approx(TREFOIL.lengths.sum())


@given(
    st.lists(
        st.tuples(*[st.integers(-4, 4)] * 6).filter(lambda t: t[:3] != t[3:]),
        min_size=1,
        max_size=7,
    )
)
def test_lines_of_any_kind_become_a_skeleton_that_covers_them(rows: list[tuple[int, ...]]) -> None:
    lines = [bd.Edge.make_line(row[:3], row[3:]) for row in rows]
    skeleton = Skeleton.from_edges(lines, 0.1)
    check_skeleton(skeleton)
    assert max(distances(skeleton, along(line, 9)).max() for line in lines) < 1e-3
    # Nothing meets but at nodes.
    again = skeleton.cleaned(split_contacts=True, weld_distance=1e-6)
    assert again.repairs.total == 0
    assert len(build_scaffold(skeleton).mesh.quads) == 4 * len(skeleton.edges) + len(
        skeleton.extremities
    )
