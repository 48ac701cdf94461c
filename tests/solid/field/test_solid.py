from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.solid.field import cells, estimates, field_solid, field_struts
from scaffold_cad.solid.field import solid as field
from scaffold_cad.solid.field.nets import skeleton_struts
from tests.solid.field.judges import check_exact, manifold_vertices, sampled_volume
from tests.validation.attacks import balls

TRIPOD = np.array([[[0, 0, 0], [30, 0, 0]], [[0, 0, 0], [0, 30, 0]], [[0, 0, 0], [9, 9, 30.0]]])
"""Three struts from one node, mm."""

SLANTED = np.array([[[0.1, 0.2, 0.3], [30.1, 40.2, 50.3]]])
"""A strut at no angle to the grid, mm."""


def complete_graph(count: int, seed: int = 3) -> np.ndarray:
    """Return the struts between all of some points on a sphere of radius 20."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points *= 20 / np.linalg.norm(points, axis=1)[:, None]
    return points[np.stack(np.triu_indices(count, 1), axis=1)]


def random_struts(seed: int, *, spread: float = 10.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return ends, radii that vary tenfold along struts, and flat ends."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 8))
    ends = rng.normal(size=(count, 2, 3)) * spread
    return ends, 10 ** rng.uniform(-0.6, 0.4, size=(count, 2)), rng.random((count, 2)) < 0.5


@pytest.mark.parametrize("radius", [1.0, 1.13, 17.5])
def test_a_cylinder_has_its_volume(radius: float) -> None:
    ends = SLANTED * radius / 4
    solid = field_solid(field_struts(ends, radius, flat=True), cell=radius / 6)
    exact = np.pi * radius**2 * np.linalg.norm(ends[0, 1] - ends[0, 0])
    assert solid.mesh.signed_volume == pytest.approx(exact, rel=1e-3)
    check_exact(solid.mesh)


@pytest.mark.parametrize(("cell", "error"), [(None, 5e-3), (1 / 6, 1e-3)])
def test_a_ball_has_its_volume(cell: float | None, error: float) -> None:
    solid = field_solid(field_struts([], [], balls=[[0.1, 0.2, 0.3]], ball_radii=1.0), cell=cell)
    assert solid.mesh.signed_volume == pytest.approx(4 / 3 * np.pi, rel=error)
    check_exact(solid.mesh)


def test_a_cone_has_its_volume() -> None:
    solid = field_solid(field_struts(SLANTED / 10, [[1.0, 0.3]], flat=True))
    exact = np.pi * np.sqrt(50) * (1 + 0.3 + 0.09) / 3
    assert solid.mesh.signed_volume == pytest.approx(exact, rel=5e-3)


def test_without_equal_volume_vertices_are_on_the_cylinder() -> None:
    solid = field_solid(field_struts(SLANTED, 3.0), equal_volume=False)
    axis = (SLANTED[0, 1] - SLANTED[0, 0]) / np.linalg.norm(SLANTED[0, 1] - SLANTED[0, 0])
    way = solid.mesh.vertices - SLANTED[0, 0]
    along = way @ axis
    between = (along > 0) & (along < 70)
    away = np.linalg.norm(way - along[:, None] * axis, axis=1)[between]
    far = np.abs(away - 3.0)
    assert np.median(far) < 1e-3  # vertices near grid points stand beside the surface
    assert far.max() < 0.03 * 3.0


def test_volume_of_overlapping_struts_is_that_of_their_union() -> None:
    struts = field_struts(complete_graph(8), 1.0, blend=0)
    solid = field_solid(struts)
    volume, deviation = sampled_volume(struts)
    assert abs(solid.mesh.signed_volume - volume) < 0.005 * volume + 4 * deviation
    check_exact(solid.mesh)


def test_fillets_add_what_a_rolling_ball_leaves() -> None:
    # Two long cylinders that cross at right angles against the same without a fillet.
    cross = [[[-9, 0, 0], [9, 0, 0]], [[0, -9, 0], [0, 9, 0]]]
    sharp, filleted = (
        field_solid(field_struts(cross, 2.0, blend=blend), cell=0.25).mesh.signed_volume
        for blend in (0.0, 1.0)
    )
    # Where planes meet at right angles the fillet's section is (1 - pi / 4) blend²; the crease of
    # the cylinders is longer than 8 radii and less sharp.
    assert 0.3 * (1 - np.pi / 4) * 16 < filleted - sharp < (1 - np.pi / 4) * 32


@pytest.mark.parametrize("shift", [0.0, 2.5e-6])
def test_the_same_part_twice_is_the_part_once(shift: float) -> None:
    once = field_solid(field_struts(TRIPOD, 2.0))
    twice = field_solid(field_struts(np.concatenate([TRIPOD, TRIPOD + shift]), 2.0))
    assert twice.mesh.signed_volume == pytest.approx(once.mesh.signed_volume, rel=1e-3)
    check_exact(twice.mesh)


def test_flat_ends_at_one_place_leave_no_crumbs_beside_their_rims() -> None:
    ends = np.concatenate([SLANTED, SLANTED + np.array([1.5e-6, 0, -2e-6])])
    solid = field_solid(field_struts(ends, 4.0, flat=True))
    assert (solid.components, solid.cavities) == (1, 0)
    once = field_solid(field_struts(SLANTED, 4.0, flat=True))
    assert solid.mesh.signed_volume == pytest.approx(once.mesh.signed_volume, rel=1e-3)


def test_big_balls_on_thin_struts_are_closed() -> None:
    skeleton = balls(np.random.default_rng([1, 16]))
    struts = skeleton_struts(skeleton, blend=0.25, flat_ends=True)
    check_exact(field_solid(struts).mesh)


def test_a_straight_chain_is_one_cylinder() -> None:
    chain = np.linspace(0, 1, 21)[:, None] * [30, 40, 50]
    pieces = field_solid(field_struts(np.stack([chain[:-1], chain[1:]], axis=1), 3.0))
    whole = field_solid(field_struts([chain[[0, -1]]], 3.0))
    assert pieces.mesh.signed_volume == pytest.approx(whole.mesh.signed_volume, rel=1e-4)


HARD = {
    "crossing at 2.5 degrees": field_struts(
        [[[-50, 0, 0], [50, 0, 0]], [[-49.952, -2.181, 0], [49.952, 2.181, 0]]], 2.0
    ),
    "touching along a line": field_struts([[[0, 0, 0], [30, 0, 0]], [[0, 2, 0], [30, 2, 0]]], 1.0),
    "nearly touching": field_struts(
        [[[0, 0, 0], [30, 0, 0]], [[15, -10, 2.0001], [15, 10, 2.0001]]], 1.0, blend=0
    ),
    "a bundle at 0.02 degrees": field_struts(
        [[[0, 0, 0], [40 * np.cos(a), 40 * np.sin(a), 0]] for a in np.radians(0.02) * np.arange(8)],
        1.0,
    ),
    "radii from 1 to 1000": field_struts([[[0, 0, 0], [4000, 0, 0]]], [[1000.0, 1.0]]),
    "a cone steeper than its length": field_struts([[[0, 0, 0], [1, 0, 0]]], [[5.0, 0.5]]),
    "1e-5 mm": field_struts(TRIPOD * 1e-5, 2e-5),
    "1e6 mm": field_struts(TRIPOD * 1e5, 2e5),
    "10 m from the origin": field_struts(TRIPOD + np.array([10000, -3000, 200]), 2.0),
    "76 m from the origin": field_struts(TRIPOD + np.array([76000, 0, 0]), 1.0),
    "a star of valency 50": field_struts([[[0, 0, 0], p] for p in complete_graph(51)[:50, 1]], 1.0),
    "a long strut": field_struts([[[0, 0, 0], [1200, 4, 2]]], 1.0),
}


@pytest.mark.parametrize("name", HARD)
def test_what_is_written_is_closed_and_free_of_crossings(name: str) -> None:
    solid = field_solid(HARD[name])
    check_exact(solid.mesh)
    assert solid.components == 1
    assert solid.mesh.signed_volume > 0


@pytest.mark.parametrize("seed", range(6))
def test_random_struts_of_several_cell_sizes_are_closed_and_free_of_crossings(seed: int) -> None:
    ends, radii, flat = random_struts(seed, spread=3.0 if seed % 2 else 10.0)
    solid = field_solid(field_struts(ends, radii, flat=flat))
    assert solid.cells[1] > solid.cells[0]
    check_exact(solid.mesh)


def test_triangles_around_each_vertex_are_one_fan() -> None:
    ends, radii, flat = random_struts(1, spread=2.0)
    assert manifold_vertices(field_solid(field_struts(ends, radii, flat=flat)).mesh)


def test_a_thin_strut_does_not_vanish_in_large_cells() -> None:
    struts = field_struts([[[0, 0, 0], [40, 3, 5]], [[0, 0, 0], [0, 0, 20]]], [0.1, 5.0])
    solid = field_solid(struts, cell=4.0)
    assert solid.components == 1
    assert solid.mesh.vertices[:, 0].max() == pytest.approx(40.1, abs=0.05)


def test_struts_apart_are_components_and_a_shell_has_a_cavity() -> None:
    apart = field_solid(field_struts([[[0, 0, 0], [9, 0, 0]], [[0, 9, 0], [9, 9, 0]]], 1.0))
    assert (apart.components, apart.cavities) == (2, 0)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    box = field_solid(field_struts([], [], balls=3 * corners, ball_radii=4.4, ball_blend=0))
    assert (box.components, box.cavities) == (1, 1)


def test_a_thick_end_with_the_fillets_of_a_thin_one_stays_in_its_grid() -> None:
    tip = [-14.733887371561151, 9.831004829764954, -24.212887208246958]
    ends = [
        [[18.28435500777989, 15.555186734865678, -17.992179623184434], tip],
        [tip, [26.91010725264008, 9.571906696946892, -9.177403218577192]],
    ]
    radii = [[5.0, 0.005], [0.005, 2.344991899823108]]
    check_exact(field_solid(field_struts(ends, radii, flat=[[1, 0], [0, 1]], blend=0.0025)).mesh)


def test_a_strut_thinner_than_32_bit_numbers_can_tell_is_thickened_and_said() -> None:
    far = field_solid(field_struts(TRIPOD + np.array([76e6, 0, 0]), [1.0, 500.0, 500.0]))
    assert far.thickened.tolist() == [0]
    check_exact(far.mesh)
    assert field_solid(field_struts(TRIPOD, 1.0)).thickened.tolist() == []


def test_what_does_not_fit_is_refused_with_an_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cells, "MOST_GROUPS", 1000)
    message = r"cells or more and .* GB of memory; need at most 8e\+03 cells"
    with pytest.raises(OptionError, match=message):
        field_solid(field_struts(TRIPOD, 1.0), cell=0.1)


def test_what_is_larger_than_the_machine_is_refused_before_it_is_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cells, "machine_memory", lambda: 1e6)
    with pytest.raises(OptionError, match=r"need at most 2\.6e\+03 cells here"):
        field_solid(field_struts(TRIPOD, 1.0), cell=0.1)


def test_what_is_far_too_large_is_refused_before_cells_are_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cells, "_refined", None)
    with pytest.raises(OptionError, match=r"needs some .*e\+08 cells or more and .* GB of memory"):
        field_solid(field_struts(complete_graph(20), 0.5), cell=0.01)


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize(("count", "radius"), [(2, 1.0), (4, 0.7), (5, 1.2)])
def test_cells_are_estimated(
    count: int, radius: float, flat: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(estimates, "FEW_CELLS", 0.0)
    told = []
    monkeypatch.setattr(field, "_foretell", told.append)
    struts = field_struts(complete_graph(count), radius, flat=flat)
    made = field_solid(struts, cell=radius / 4)
    assert told[0].cells == pytest.approx(made.cell_count, rel=0.35)


def test_a_cell_must_be_positive() -> None:
    with pytest.raises(OptionError, match="cell is -1 mm; need > 0"):
        field_solid(field_struts(TRIPOD, 1.0), cell=-1.0)


def test_the_same_struts_in_another_order_give_the_same_vertices() -> None:
    struts = complete_graph(6)
    one = field_solid(field_struts(struts, 1.0)).mesh
    other = field_solid(field_struts(struts[::-1, ::-1], 1.0)).mesh
    assert len(one.triangles) == len(other.triangles)
    assert other.signed_volume == pytest.approx(one.signed_volume, rel=1e-9)
