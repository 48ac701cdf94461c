"""Hollow struts: their volume, their shells, and walls that cannot be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from build123d import GeomType, Shape, import_step
from OCP.BRepAdaptor import BRepAdaptor_Surface
from scipy.spatial import cKDTree

from scaffold_cad import Skeleton, delaunay_foam, round_struts, to_brep, write
from scaffold_cad.base.arrays import Floats, place_text
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.hollow.gaps import Gaps, surface_samples
from scaffold_cad.struts.hollow.walls import walls
from scaffold_cad.struts.meshes.surface import triangulated
from scaffold_cad.struts.options import Ends
from tests.struts.stars import FIVE_TUBES

TUBE = Skeleton([[0, 0, 0], [0, 0, 20]], [[0, 1]], 5.0)
ELBOWS = Skeleton([[0, 0, 0], [40, 0, 0], [0, 40, 0], [0, 0, 40]], [[0, 1], [0, 2], [0, 3]], 6.0)
HOLLOW = {
    "open": np.pi * (25 - 16) * 20,
    "flat": np.pi * (25 * 20 - 16 * 18),
    "round": np.pi * (25 - 16) * 20 + 4 / 3 * np.pi * (125 - 64),
}


@pytest.mark.parametrize("ends", ["open", "flat", "round"])
def test_a_hollow_tube_has_the_volume_of_its_wall(ends: Ends) -> None:
    struts = round_struts(TUBE, ends=ends, wall=1.0)
    body = to_brep(struts)
    assert body.is_valid
    assert body.volume == pytest.approx(HOLLOW[ends], rel=1e-9)
    mesh: TriangleMesh = triangulated(struts, 64).mesh
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(HOLLOW[ends], rel=2e-3)
    assert walls(struts).least == 1.0


TUBES = np.array([17.5, 16, 14, 9, 9])
FIVE = Skeleton(
    np.vstack([np.zeros(3), 90 * FIVE_TUBES / np.linalg.norm(FIVE_TUBES, axis=1)[:, None]]),
    [[0, tip] for tip in range(1, 6)],
    edge_radii=TUBES,
)


def wall_of(shape: Shape, count: int) -> float:
    """Return the least distance between the patches inside and outside of a node at the origin."""
    outer: list[Floats] = []
    inner: list[Floats] = []
    for face in shape.faces():
        if face.geom_type != GeomType.BSPLINE:
            continue
        center = np.array(tuple(face.center()))
        is_outer = np.array(tuple(face.normal_at(face.center()))) @ center > 0
        surface = BRepAdaptor_Surface(face.wrapped)
        at = np.linspace(0, 1, count if is_outer else count // 2)
        points = [surface.Value(u, v) for u in at for v in at]
        (outer if is_outer else inner).append(np.array([[p.X(), p.Y(), p.Z()] for p in points]))
    assert len(outer) == len(inner)
    return float(cKDTree(np.concatenate(outer)).query(np.concatenate(inner))[0].min())


@pytest.mark.parametrize("blend", [None, 5.0])
def test_walls_of_reported_five_tubes_are_those_asked_for(
    blend: float | None, tmp_path: Path
) -> None:
    struts = round_struts(FIVE, wall=3.0, ends="open", blend=blend)
    write(struts, tmp_path / "node.step")
    body = import_step(tmp_path / "node.step")
    assert body.is_valid
    measured = wall_of(body, 40)
    assert 0.95 * 3 < measured <= 3.01
    assert walls(struts).least == pytest.approx(measured, rel=0.01)
    radii = {round(f.radius, 6) for f in body.faces() if f.geom_type == GeomType.CYLINDER}
    assert radii == {17.5, 16, 14, 9, 14.5, 13, 11, 6}


def test_walls_of_cones_are_as_thick_across_the_cone() -> None:
    funnel = Skeleton([[0, 0, 0], [10, 0, 0]], [[0, 1]], edge_radii=[[8, 2]])
    struts = round_struts(funnel, wall=1.0, ends="open")
    assert struts.inner is not None
    lean = np.hypot(1, 0.6)
    assert struts.inner.runs.radii == pytest.approx(np.array([[8 - lean, 2 - lean]]))
    with pytest.raises(OptionError, match=r"edge 0 near \[.*\] mm has radius 2 mm; need a wall"):
        round_struts(funnel, wall=1.9)


@pytest.mark.parametrize("radii", [[8, 2], [2, 8]])
def test_round_ends_of_cones_have_one_center_inside_and_outside(radii: list[int]) -> None:
    funnel = Skeleton([[0, 0, 0], [10, 0, 0]], [[0, 1]], edge_radii=[radii])
    body = to_brep(round_struts(funnel, wall=1.0, ends="round"))
    assert body.is_valid
    balls = [
        BRepAdaptor_Surface(f.wrapped).Sphere() for f in body.faces().filter_by(GeomType.SPHERE)
    ]
    assert len(balls) == 4
    for place in {round(ball.Location().X(), 6) for ball in balls}:
        sizes = [ball.Radius() for ball in balls if abs(ball.Location().X() - place) < 1e-5]
        assert np.ptp(sizes) == pytest.approx(1.0)


def test_walls_are_told_node_by_node() -> None:
    turn = np.linspace(0, 2 * np.pi, 25)
    spring = np.stack([60 + 20 * np.cos(turn), 60 + 20 * np.sin(turn), 3 * turn], axis=1)
    edges = np.vstack([ELBOWS.edges, 4 + np.stack([np.arange(24), np.arange(1, 25)], axis=1)])
    both = Skeleton(np.vstack([ELBOWS.nodes, spring]), edges, 4.0)
    struts = round_struts(both, wall=1.5, ends="open")
    assert len(struts.overlapping) == 0
    found = walls(struts)
    assert np.isfinite(found.nodes).tolist() == [True] + [False] * 28
    assert found.nodes[0] == pytest.approx(1.5, rel=0.05)
    assert found.curves == pytest.approx([1.5], rel=0.01)
    assert found.least == min(1.5, found.nodes[0], found.curves[0])


@pytest.mark.parametrize(("ends", "shells"), [("open", 1), ("flat", 2), ("round", 2)])
def test_a_hollow_node_is_one_valid_solid(ends: Ends, shells: int) -> None:
    struts = round_struts(ELBOWS, ends=ends, wall=1.5)
    body = to_brep(struts)
    assert body.is_valid
    assert len(body.solids()) == 1
    assert len(body.shells()) == shells
    assert body.volume < to_brep(round_struts(ELBOWS, ends="round")).volume
    assert walls(struts).least > 0.95 * 1.5
    triangulated(struts, 16).mesh.check_closed()


def test_a_wall_as_thick_as_a_strut_is_refused() -> None:
    with pytest.raises(
        OptionError, match=r"wall is 5 mm, and edge 0 near \[.*\] mm has radius 5 mm"
    ):
        round_struts(TUBE, wall=5.0)


def test_closed_ends_need_room() -> None:
    short = Skeleton([[0, 0, 0], [0, 0, 3]], [[0, 1]], 5.0)
    with pytest.raises(
        OptionError, match=r"edge 0 near .* is 3 mm long; need more than its closed ends"
    ):
        round_struts(short, wall=2.0)


def test_open_ends_need_a_wall() -> None:
    with pytest.raises(OptionError, match="ends is 'open' without a wall; need wall="):
        round_struts(TUBE, ends="open")


def test_solid_struts_have_no_wall_to_measure() -> None:
    with pytest.raises(OptionError, match="the struts are solid; need wall="):
        walls(round_struts(TUBE))


def test_what_is_past_the_collars_is_measured_to_the_struts() -> None:
    tips = np.concatenate([np.zeros((1, 3)), 40.0 * np.eye(3)])
    star = Skeleton(tips, [[0, 1], [0, 2], [0, 3]], 3.0)
    outer, inner = round_struts(star, blend=0.3), round_struts(star.with_radii(1.0), blend=4.0)
    (wide,), (narrow,) = outer.blended, inner.blended
    assert (narrow.shapes.collar_distances > wide.shapes.collar_distances + 1.0).all()
    (least,) = Gaps(wide.shapes).least(narrow.shapes)
    assert 1.0 < least <= 2.0 + 1e-6


def test_nodes_whose_wall_no_inside_leaves_are_told(caplog: pytest.LogCaptureFixture) -> None:
    foam = delaunay_foam(8, [[0, 0, 0], [60, 60, 60]], 1.0, seed=3)
    around = foam.edges[(foam.edges == 1).any(axis=1)]  # a node of six struts
    tips, elbow = foam.nodes[np.setdiff1d(around, 1)], [[90, 0, 0], [90, 20, 0], [110, 0, 0]]
    edges = [[0, k] for k in range(1, 7)] + [[7, 8], [7, 9]]
    nodes = np.concatenate([foam.nodes[[1]], tips, elbow])
    struts = round_struts(Skeleton(nodes, edges, 2.0), wall=1.7, ends="open")
    assert struts.inner is not None
    assert np.flatnonzero(struts.inner.crowded & ~struts.crowded).tolist() == [0]
    place = place_text(foam.nodes[1])
    assert f"no inside of node 0 leaves a wall of 1.7 mm at {place}; it is crowded" in caplog.text
    assert "need a wall of 1.53 mm, thicker struts" in caplog.text
    found = walls(struts).nodes
    assert np.flatnonzero(np.isfinite(found)).tolist() == [7]
    assert np.nanmin(found) >= 0.95 * 1.7


def test_thin_walls_of_large_balls_are_measured_between_samples_too() -> None:
    nodes = np.array([[0.0, 0, 0], [12.0, 0, 0], [-8.0, 10.0, 0]])
    ball = Skeleton(nodes, [[0, 1], [0, 2]], [4.0, 0.5, 0.5], edge_radii=np.full((2, 2), 0.5))
    struts = round_struts(ball, wall=0.1, ends="open")
    assert struts.inner is not None
    assert len(struts.overlapping) == 0
    outer, inner = struts.blended[0].shapes, struts.inner.blended[0].shapes
    points, _ = surface_samples(outer, 161)
    inside, _ = surface_samples(inner, 45)
    distances, _ = cKDTree(points[0]).query(inside[0])
    assert distances.min() > 0.95 * 0.1
    assert walls(struts).least < distances.min() + 0.01 * 0.1
