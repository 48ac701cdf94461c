"""Smooth solids turn corners at joints: their volume, their axis, no cliff and no crossing."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.scaffold.stars import Section
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import Caps, control_mesh, smooth_mesh
from scaffold_cad.smooth.bends import COLLARED_STRAY, STRAY, bends_of
from tests.benchmarks.smooth import union_of_struts
from tests.skeletons import RING, polyline

LENGTHS = [8, 9, 10, 11, 12, 14, 16, 20]


def elbow(degrees: float, length: float, radii: Floats | float = 1.0) -> Skeleton:
    """Return two edges with an angle between them."""
    angle = np.radians(degrees)
    ends = length * np.array([[1, 0, 0], [0, 0, 0], [np.cos(angle), np.sin(angle), 0]])
    return Skeleton(ends, [[0, 1], [1, 2]], radii)


def zigzag(degrees: float, length: float, *, turn: float = 180.0) -> Skeleton:
    """Return five edges with an angle between neighbours; `turn` other than 180° makes a screw."""
    nodes, frame = [np.zeros(3)], np.eye(3)
    bend, twist = np.radians(180 - degrees), np.radians(turn)
    about_z = [[np.cos(twist), -np.sin(twist), 0], [np.sin(twist), np.cos(twist), 0], [0, 0, 1]]
    about_x = [[1, 0, 0], [0, np.cos(bend), -np.sin(bend)], [0, np.sin(bend), np.cos(bend)]]
    for _ in range(5):
        nodes.append(nodes[-1] + length * frame[:, 2])
        frame = frame @ about_z @ about_x
    return Skeleton(np.array(nodes), polyline(6), 1.0)


def volume_part(
    skeleton: Skeleton, *, collars: bool = True, section: Section = "circumscribed"
) -> float:
    """Return the volume of the smooth solid over that of the union of round struts and balls."""
    scaffold = build_scaffold(skeleton, collars=collars, section=section)
    return smooth_mesh(scaffold, 4).mesh.signed_volume / union_of_struts(skeleton)


def is_inside(mesh: QuadMesh, points: Points) -> Bools:
    """Return whether points (k, 3) are inside a closed mesh, by the solid angle that it fills."""
    spokes = mesh.vertices[mesh.triangles] - points[:, None, None]  # (k, t, 3, 3)
    a, b, c = np.moveaxis(spokes, 2, 0)
    la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
    ab, bc, ca = ((x * y).sum(axis=2) for x, y in ((a, b), (b, c), (c, a)))
    volume = (a * np.cross(b, c)).sum(axis=2)
    half = np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
    inside: Bools = half.sum(axis=1) > np.pi
    return inside


def crosses(skeleton: Skeleton, collars: bool, caps: Caps) -> bool:
    fine = smooth_mesh(build_scaffold(skeleton, collars=collars), 3, caps).mesh
    return len(self_intersections(fine)) > 0


@pytest.mark.parametrize("collars", [True, False])
@pytest.mark.parametrize("degrees", [30, 45, 60, 90, 120, 150])
def test_elbows_have_the_volume_of_their_struts_whatever_their_length(
    degrees: float, collars: bool
) -> None:
    parts = [volume_part(elbow(degrees, length), collars=collars) for length in LENGTHS]
    assert parts == pytest.approx(np.ones(len(parts)), abs=0.05 if degrees > 30 else 0.06)
    assert np.abs(np.diff(parts)).max() < 0.03
    for caps in ("round", "flat"):
        assert not any(crosses(elbow(degrees, length), collars, caps) for length in (8, 11))


@pytest.mark.parametrize(
    ("degrees", "turn"),
    [(45, 180), (60, 180), (90, 180), (120, 180), (150, 180), (60, 70), (90, 70), (120, 70)],
)
def test_chains_of_bends_have_the_volume_of_their_struts(degrees: float, turn: float) -> None:
    for length in (8.0, 10.0, 12.0, 20.0):
        chain = zigzag(degrees, length, turn=turn)
        assert volume_part(chain) == pytest.approx(1, abs=0.035)
        assert not crosses(chain, True, "round")


@pytest.mark.parametrize("radii", [[1.0, 2.0, 1.0], [2.0, 1.0, 2.0], [1.0, 1.5, 2.0]])
@pytest.mark.parametrize("degrees", [60, 90, 120])
def test_bends_between_unequal_radii_keep_their_volume(degrees: float, radii: list[float]) -> None:
    for length in (12.0, 16.0, 24.0):
        skeleton = elbow(degrees, length, np.array(radii))
        assert volume_part(skeleton) == pytest.approx(1, abs=0.04)
        assert not crosses(skeleton, True, "round")


@pytest.mark.parametrize("degrees", [60, 90, 120])
@pytest.mark.parametrize("collars", [True, False])
def test_the_axis_of_an_elbow_is_inside_with_room_around_it(degrees: float, collars: bool) -> None:
    skeleton = elbow(degrees, 20.0)
    mesh = smooth_mesh(build_scaffold(skeleton, collars=collars), 2).mesh
    share = np.linspace(0, 1, 41)[:, None]
    corner, ends = skeleton.nodes[1], skeleton.nodes[[0, 2]]
    axis = np.concatenate([corner + share * (end - corner) for end in ends])
    around = np.concatenate([axis + 0.8 * offset for offset in [*np.eye(3), *-np.eye(3)]])
    assert is_inside(mesh, around).all()


@pytest.mark.parametrize("degrees", [60, 90, 120])
def test_bends_do_not_depend_on_the_scaffolds_section(degrees: float) -> None:
    parts = [
        volume_part(elbow(degrees, 10.0), section=section)
        for section in ("circumscribed", "inscribed", "area", "round")
    ]
    assert parts == pytest.approx(np.full(4, parts[0]), abs=0.003)


@pytest.mark.parametrize(("collars", "most"), [(True, COLLARED_STRAY), (False, STRAY)])
def test_bends_that_the_limit_hardly_rounds_get_no_sections(collars: bool, most: float) -> None:
    # The axis passes the joint as far off as a third of the length times cos 75°.
    length = 3 * most / np.cos(np.radians(75))
    for factor, sections in ((0.99, 0), (1.01, 2)):
        scaffold = build_scaffold(elbow(150, factor * length), collars=collars)
        assert len(bends_of(scaffold).leaving) == sections / 2
    assert len(control_mesh(build_scaffold(RING)).mesh.quads) == 4 * 12


def test_sections_move_closer_together_on_short_edges_before_they_are_left_out() -> None:
    for length, added in ((6.0, 4), (2.0, 4), (0.9, 4), (0.5, 0)):
        scaffold = build_scaffold(elbow(60, length), collars=True)
        assert len(control_mesh(scaffold).mesh.quads) == 10 + 4 * added


def test_a_bend_next_to_a_branch_point_stays_clear_of_it() -> None:
    nodes = [[0, 0, 0], [5, 0, 0], [5, 9, 0], [-9, 3, 0], [-9, -3, 2], [0, 0, 9]]
    skeleton = Skeleton(nodes, [[0, 1], [1, 2], [0, 3], [0, 4], [0, 5]], 1.0)
    for collars in (True, False):
        scaffold = build_scaffold(skeleton, collars=collars)
        assert len(bends_of(scaffold).leaving) == 1
        assert not crosses(skeleton, collars, "round")
