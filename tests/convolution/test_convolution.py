"""Fields of convolution surfaces against quadrature, and meshes projected onto the surfaces."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from scaffold_cad import (
    QuadMesh,
    Skeleton,
    build_scaffold,
    catmull_clark,
    read_skeleton,
    self_intersections,
    to_trimesh,
)
from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.convolution import ConvolutionField, KernelName, project
from scaffold_cad.convolution.kernels import Cauchy, CompactCubic, Kernel, Pairs, tip_reach
from scaffold_cad.convolution.nearby import all_pairs, nearby_pairs
from scaffold_cad.convolution.projection import _feet
from scaffold_cad.errors import MeshError, OptionError, SkeletonError
from tests.real_files import real_skeleton
from tests.skeletons import (
    FIGURE_EIGHT,
    JACK,
    K4,
    NAMED,
    STICK_FIGURE,
    STRUT,
    TAPER,
    TRIPOD,
    ZIGZAG,
)
from tests.strategies import skeletons

KERNELS: tuple[KernelName, ...] = ("compact-cubic", "cauchy")
WITH_WIDTHS = [CompactCubic(1.25), CompactCubic(2.0), CompactCubic(4.0), Cauchy(0.5), Cauchy(1.5)]
WOMAN = Path(__file__).parents[2] / "examples" / "skeletons" / "stick_woman.json"


def height(kernel: Kernel, square: float) -> float:
    """Return the kernel at the squared distance `square` in radii."""
    share = square / kernel.width**2
    return max(1 - share, 0) ** 3 if isinstance(kernel, CompactCubic) else 1 / (1 + share) ** 2


def descent(kernel: Kernel, square: float) -> float:
    """Return its derivative there."""
    share = square / kernel.width**2
    if isinstance(kernel, CompactCubic):
        return -3 * max(1 - share, 0) ** 2 / kernel.width**2
    return -2 / (1 + share) ** 3 / kernel.width**2


def check_against_quadrature(
    kernel: Kernel, along: float, off: float, size: float, first: float, last: float
) -> None:
    row = [np.array([value]) for value in (along, off * off, size, first, last)]
    integrals = kernel.over(Pairs(*row))
    slopes = integrals.slopes()

    def radius(s: float) -> float:
        return first + (last - first) * s / size

    def square(s: float) -> float:
        return ((along - s) ** 2 + off * off) / radius(s) ** 2

    # Where the compact kernel ends its third derivative jumps.
    slope = (last - first) / size
    grown = kernel.width**2
    roots = np.roots(
        [
            1 - grown * slope * slope,
            -2 * (along + grown * first * slope),
            along * along + off * off - grown * first * first,
        ]
    )
    kinks = [float(root.real) for root in roots if root.imag == 0 and 0 < root.real < size]

    def integral(function: object) -> float:
        nodes = [0.0, *sorted(kinks), size]
        parts = [
            quad(function, a, b, epsabs=1e-12, epsrel=1e-12, limit=200)[0]
            for a, b in pairwise(nodes)
        ]
        return float(sum(parts)) / kernel.norm

    value = integral(lambda s: height(kernel, square(s)) / radius(s))
    ahead = integral(lambda s: 2 * descent(kernel, square(s)) * (along - s) / radius(s) ** 3)
    away = integral(lambda s: 2 * descent(kernel, square(s)) / radius(s) ** 3)
    assert integrals.values()[0] == pytest.approx(value, rel=1e-9, abs=1e-9)
    assert slopes.along[0] == pytest.approx(ahead, rel=1e-9, abs=1e-9)
    assert slopes.off[0] == pytest.approx(away, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("kernel", WITH_WIDTHS, ids=str)
@settings(max_examples=25)
@given(
    share=st.floats(-1.0, 2.0),
    off=st.one_of(st.just(0.0), st.floats(0.0, 4.0)),
    size=st.floats(0.1, 20.0),
    first=st.floats(0.2, 3.0),
    ratio=st.one_of(st.just(1.0), st.floats(0.5, 8.0)),
)
def test_integrals_agree_with_quadrature(
    kernel: Kernel, share: float, off: float, size: float, first: float, ratio: float
) -> None:
    check_against_quadrature(kernel, share * size, off, size, first, first * ratio)


@pytest.mark.parametrize("kernel", WITH_WIDTHS, ids=str)
@pytest.mark.parametrize(
    ("along", "off", "size", "first", "last"),
    [
        (0.0, 0.0, 5.0, 1.0, 1.0),  # at its start
        (-1e-12, 0.0, 5.0, 1.0, 1.0),
        (5.0, 0.0, 5.0, 1.0, 1.0),  # at its end
        (2.5, 2.0, 5.0, 1.0, 1.0),  # where the support of width 2 ends
        (2.0, 0.5, 5.0, 1.0, 1.0 + 1e-12),
        (2.0, 0.5, 5.0, 1.0, 1.0 - 1e-7),
        (-1.0, 0.0, 4.0, 1.0, 5.0),  # at the apex of its cone
        (-1.0, 1e-9, 4.0, 1.0, 5.0),
        (0.0, 1.0, 1.0, 0.5, 5.0),  # a radius that grows faster than the edge
        (500.0, 1.0, 1000.0, 1.0, 1.1),
    ],
)
def test_integrals_agree_with_quadrature_in_special_places(
    kernel: Kernel, along: float, off: float, size: float, first: float, last: float
) -> None:
    if size == 1000:  # quadrature needs to know where the kernel is
        shift = along - 10
        radii = (first + (last - first) * s / size for s in (shift, shift + 20))
        if isinstance(kernel, CompactCubic):
            check_against_quadrature(kernel, 10.0, off, 20.0, *radii)
        return
    check_against_quadrature(kernel, along, off, size, first, last)


@pytest.mark.parametrize("kernel", WITH_WIDTHS, ids=str)
def test_field_of_an_endless_edge(kernel: Kernel) -> None:
    radius, size = 0.7, 2e4
    x = np.linspace(0, 3, 31)
    k = np.ones_like(x)
    pairs = Pairs(k * size / 2, (radius * x) ** 2, k * size, k * radius, k * radius)
    width = kernel.width
    if isinstance(kernel, CompactCubic):
        wanted = (np.maximum(width**2 - x**2, 0) / (width**2 - 1)) ** 3.5
    else:
        wanted = ((width**2 + 1) / (width**2 + x**2)) ** 1.5
    values = kernel.over(pairs).values()
    assert values == pytest.approx(wanted, abs=1e-11)
    assert values[10] == pytest.approx(1.0, abs=1e-11)
    power = values[x < min(width, 2.9)] ** kernel.exponent
    assert np.diff(power, 2) == pytest.approx(np.diff(power, 2)[0], abs=1e-6)  # a parabola


@pytest.mark.parametrize("kernel", WITH_WIDTHS, ids=str)
def test_surface_of_half_an_edge_ends_at_its_reach(kernel: Kernel) -> None:
    reach = tip_reach(kernel)
    assert -2 * kernel.width < reach < 1
    one = np.ones(1)
    pairs = Pairs((100 + reach) * one, 0 * one, 100 * one, one, one)
    assert kernel.over(pairs).values()[0] == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("kernel", KERNELS)
def test_surface_of_a_long_strut_is_its_cylinder_and_ends_a_radius_beyond_it(
    kernel: KernelName,
) -> None:
    strut = Skeleton([[0, 0, 0], [0, 300, 400]], [[0, 1]], 2.5)
    field = ConvolutionField(strut, kernel)
    axis = np.array([0, 0.6, 0.8])
    around = [np.array([1.0, 0, 0]), np.array([0, 0.8, -0.6])]
    middle = strut.nodes.mean(axis=0)
    assert field.value([middle + 2.5 * way for way in around]) == pytest.approx(1, abs=1e-6)
    tips = [-2.5 * axis, strut.nodes[1] + 2.5 * axis]
    assert field.value(tips) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize(("slope", "most"), [(0.1, 0.012), (0.2, 0.04)])
def test_surface_of_a_taper_is_as_near_the_radii_as_said(
    kernel: KernelName, slope: float, most: float
) -> None:
    taper = Skeleton([[0, 0, 0], [200, 0, 0]], [[0, 1]], [1.0, 1.0 + 200 * slope])
    radius = 1.0 + 100 * slope
    near = radius * np.array([1.0, 1 + most])
    points = np.stack([np.full(2, 100.0), near, np.zeros(2)], axis=1)
    inside, outside = ConvolutionField(taper, kernel).value(points)
    assert inside > 1 > outside


def places(skeleton: Skeleton, count: int, seed: int = 0) -> Points:
    """Return points within two radii or so of the skeleton, (count, 3)."""
    random = np.random.default_rng(seed)
    edge = skeleton.edges[random.integers(len(skeleton.edges), size=count)]
    share = random.uniform(size=(count, 1))
    foot = (1 - share) * skeleton.nodes[edge[:, 0]] + share * skeleton.nodes[edge[:, 1]]
    reach = skeleton.radii[edge].min(axis=1)[:, None]
    return foot + reach * random.normal(size=(count, 3))


@pytest.mark.parametrize("kernel", KERNELS)
@given(skeletons())
@settings(max_examples=20)
def test_gradient_agrees_with_finite_differences(kernel: KernelName, skeleton: Skeleton) -> None:
    field = ConvolutionField(skeleton, kernel)
    points = places(skeleton, 20)
    step = 1e-5 * skeleton.radii.min()
    ahead, back = (
        field.value((points[:, None] + sign * step * np.eye(3)).reshape(-1, 3)).reshape(-1, 3)
        for sign in (1, -1)
    )
    wanted = (ahead - back) / (2 * step)
    gradient = field.gradient(points)
    most = np.abs(gradient).max(axis=1)[:, None] + 1 / skeleton.radii.max()
    assert (np.abs(gradient - wanted) <= 1e-5 * most + 1e-14 / step).all()
    assert np.array_equal(field.samples(points).gradients, gradient)
    assert np.array_equal(field.samples(points).values, field.value(points))


@pytest.mark.parametrize("kernel", KERNELS)
@given(skeletons())
@settings(max_examples=20)
def test_skeleton_lies_inside_its_surface(kernel: KernelName, skeleton: Skeleton) -> None:
    field = ConvolutionField(skeleton, kernel)
    share = np.linspace(0, 1, 9)[:, None, None]
    starts, ends = skeleton.nodes[skeleton.edges.T]
    assert (field.value(((1 - share) * starts + share * ends).reshape(-1, 3)) > 1).all()


@pytest.mark.parametrize("kernel", KERNELS)
@given(skeletons(), st.integers(0, 1000), st.sampled_from([1e-6, 0.1, 25.4, 1e6]))
@settings(max_examples=15)
def test_field_follows_a_skeleton_that_is_turned_moved_and_scaled(
    kernel: KernelName, skeleton: Skeleton, seed: int, factor: float
) -> None:
    random = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)  # no mirror
    shift = random.uniform(-100, 100, 3)
    moved = skeleton.moved(skeleton.nodes @ turn.T + shift).scaled(factor)
    points = places(skeleton, 20)
    before = ConvolutionField(skeleton, kernel).samples(points)
    after = ConvolutionField(moved, kernel).samples(factor * (points @ turn.T + shift))
    assert after.values == pytest.approx(before.values, rel=1e-9, abs=1e-9)
    most = 1e-9 * (np.abs(before.gradients).max() + 1)
    assert factor * after.gradients @ turn == pytest.approx(before.gradients, rel=1e-9, abs=most)


@pytest.mark.parametrize("kernel", KERNELS)
@given(skeletons(), st.floats(0.05, 0.95))
@settings(max_examples=15)
def test_edges_cut_in_two_have_the_field_of_the_whole(
    kernel: KernelName, skeleton: Skeleton, share: float
) -> None:
    def mixed(values: Floats) -> Floats:
        return (1 - share) * values[skeleton.edges[:, 0]] + share * values[skeleton.edges[:, 1]]

    count = len(skeleton.nodes)
    middles = count + np.arange(len(skeleton.edges))
    halves = [skeleton.edges[:, 0], middles, middles, skeleton.edges[:, 1]]
    cut = Skeleton(
        np.concatenate([skeleton.nodes, mixed(skeleton.nodes)]),
        np.stack(halves, axis=1).reshape(-1, 2),
        np.concatenate([skeleton.radii, mixed(skeleton.radii)]),
    )
    points = places(skeleton, 20)
    whole, sum_of_parts = (
        ConvolutionField(which, kernel).samples(points) for which in (skeleton, cut)
    )
    assert sum_of_parts.values == pytest.approx(whole.values, rel=1e-10, abs=1e-10)
    most = 1e-10 * (np.abs(whole.gradients).max() + 1)
    assert sum_of_parts.gradients == pytest.approx(whole.gradients, rel=1e-10, abs=most)


@given(skeletons(), st.floats(1.1, 4.0))
@settings(max_examples=20)
def test_compact_field_is_the_sum_over_all_edges_and_0_beyond_its_width(
    skeleton: Skeleton, width: float
) -> None:
    field = ConvolutionField(skeleton, width=width)
    points = np.concatenate([places(skeleton, 100), 3 * places(skeleton, 20, seed=1)])
    axes = field.axes
    total, is_near = np.zeros(len(points)), np.zeros(len(points), dtype=bool)
    for edge in range(len(axes.lengths)):
        offsets = points - axes.starts[edge]
        along = offsets @ axes.directions[edge]
        off = length(offsets - along[:, None] * axes.directions[edge]) ** 2
        ones = np.ones(len(points))
        first, last = axes.radii[edge]
        row = (along, off, ones * axes.lengths[edge], ones * first, ones * last)
        total += field.integrand.over(Pairs(*row)).values()
        beyond = along - np.clip(along, 0, axes.lengths[edge])
        is_near |= np.sqrt(off + beyond**2) < width * max(first, last)
    assert field.value(points) == pytest.approx(total, rel=1e-12, abs=1e-12)
    assert (field.value(points[~is_near]) == 0).all()
    assert (field.gradient(points[~is_near]) == 0).all()


def together(blocks: Iterable[tuple[Ints, Ints]]) -> Ints:
    """Return the pairs of a point and an edge that the blocks stand for, (2, k)."""
    parts = [np.stack(np.broadcast_arrays(*block)).reshape(2, -1) for block in blocks]
    return np.concatenate(parts, axis=1)


def test_nearby_pairs_are_few_and_hold_all_within_reach() -> None:
    random = np.random.default_rng(2)
    starts = random.uniform(0, 100, (300, 3))
    ends = starts + random.normal(size=(300, 3)) * random.choice([1, 30], (300, 1))
    reaches = random.uniform(0.5, 3, 300)
    points = random.uniform(-10, 110, (4000, 3))
    found = together(nearby_pairs(points, starts, ends, reaches))
    spans = ends - starts
    share = np.einsum("pex,ex->pe", points[:, None] - starts, spans) / dot(spans, spans)
    feet = starts + np.clip(share, 0, 1)[..., None] * spans
    within = np.argwhere(length(points[:, None] - feet) <= reaches)
    keys = 300 * found[0] + found[1]
    assert len(np.unique(keys)) == len(keys)
    assert np.isin(300 * within[:, 0] + within[:, 1], keys).all()
    assert len(keys) < 0.3 * 300 * 4000


def test_all_pairs_come_once() -> None:
    pairs = together(all_pairs(70, 1000))
    assert np.array_equal(pairs[0] * 1000 + pairs[1], np.arange(70000))


def test_field_far_from_the_origin() -> None:
    points = places(ZIGZAG, 50)
    far = np.array([1e6, -2e6, 5e5])
    moved = ConvolutionField(ZIGZAG.moved(ZIGZAG.nodes + far))
    assert moved.value(points + far) == pytest.approx(
        ConvolutionField(ZIGZAG).value(points), abs=1e-8
    )


@pytest.mark.parametrize("kernel", KERNELS)
def test_no_points_have_no_values(kernel: KernelName) -> None:
    field = ConvolutionField(TRIPOD, kernel)
    assert field.value([]).shape == (0,)
    assert field.gradient([]).shape == (0, 3)


def test_options_out_of_range_are_refused() -> None:
    with pytest.raises(OptionError, match="kernel is 'gauss'; need one of compact-cubic, cauchy"):
        ConvolutionField(STRUT, "gauss")  # type: ignore[arg-type]
    wanted = "need > 1 and at most 100 radii"
    for width in (1.0, 100.1, np.inf, np.nan):
        with pytest.raises(OptionError, match=f"compact-cubic kernel is {width:g}; {wanted}"):
            ConvolutionField(STRUT, width=width)
    wanted = "need > 0 and at most 50 radii"
    for width in (-1.0, 0.0, 51.0):
        with pytest.raises(OptionError, match=f"cauchy kernel is {width:g}; {wanted}"):
            ConvolutionField(STRUT, "cauchy", width=width)
    with pytest.raises(OptionError, match="width of the compact-cubic kernel is '2'; need a numb"):
        ConvolutionField(STRUT, width="2")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match=r"points has shape \(3,\); need \(n, 3\)"):
        ConvolutionField(STRUT).value([0, 0, 0])
    with pytest.raises(SkeletonError, match=r"edge 0 joins node 0 at \[0, 0, 0\] mm to itself"):
        ConvolutionField(Skeleton([[0, 0, 0], [1, 0, 0]], [[0, 0], [0, 1]], 1.0))


@pytest.mark.parametrize(("kernel", "width"), [("compact-cubic", 100.0), ("cauchy", 50.0)])
def test_the_widest_kernels_have_a_surface_around_long_struts(
    kernel: KernelName, width: float
) -> None:
    field = ConvolutionField(Skeleton([[0, 0, 0], [2e4, 0, 0]], [[0, 1]], 1.0), kernel, width)
    assert field.value([[1e4, 1, 0], [-1, 0, 0]]) == pytest.approx(1.0, abs=0.01)


def test_feet_are_the_nearest_points_of_the_skeleton() -> None:
    random = np.random.default_rng(5)
    nodes = random.uniform(-50, 50, (60, 3))
    edges = np.stack([np.arange(59), np.arange(1, 60)], axis=1)
    skeleton = Skeleton(nodes, edges, random.uniform(1, 3, 60))
    points = random.uniform(-80, 80, (500, 3))
    feet, radii = _feet(points, skeleton)
    starts, spans = nodes[:-1], nodes[1:] - nodes[:-1]
    share = np.einsum("pex,ex->pe", points[:, None] - starts, spans) / dot(spans, spans)
    share = np.clip(share, 0, 1)
    every = starts + share[..., None] * spans
    nearest = length(points[:, None] - every).argmin(axis=1)
    rows = np.arange(500)
    np.testing.assert_allclose(feet, every[rows, nearest])
    first, last = skeleton.radii[nearest], skeleton.radii[nearest + 1]
    np.testing.assert_allclose(radii, first + share[rows, nearest] * (last - first))


def test_foot_on_a_long_edge_beside_another() -> None:
    nodes = [[0, 0, 0], [1000, 0, 0], [500, 5, 0], [515, 5, 0]]
    skeleton = Skeleton(nodes, [[0, 1], [2, 3]], [1, 3, 1, 1])
    feet, radii = _feet(np.array([[507.9, 0.5, 0]]), skeleton)
    np.testing.assert_allclose(feet, [[507.9, 0, 0]])
    np.testing.assert_allclose(radii, [1 + 2 * 0.5079])


def test_mesh_that_stays_folded_is_told_of(caplog: pytest.LogCaptureFixture) -> None:
    field = ConvolutionField(FIGURE_EIGHT)
    project(around(FIGURE_EIGHT), field)
    assert not caplog.records
    far = catmull_clark(build_scaffold(FIGURE_EIGHT).mesh, levels=2).mesh  # rounds its bends off
    moved = project(far, field)
    corners = moved.vertices[moved.quads]
    ahead = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(ahead, -np.roll(ahead, 1, axis=1))
    folded = (dot(normals, field.gradient(moved.vertices)[moved.quads]) >= 0).any(axis=1)
    assert folded.any()
    (record,) = caplog.records
    assert record.levelname == "WARNING"
    assert f"{folded.sum()} quads of the mesh on the convolution surface" in record.getMessage()
    assert "with collars" in record.getMessage()


def check_projected(mesh: QuadMesh, skeleton: Skeleton, field: ConvolutionField) -> QuadMesh:
    """Project and check all that is promised of a mesh near the surface."""
    moved = project(mesh, field)
    assert moved.quads is mesh.quads
    assert np.abs(field.value(moved.vertices) - 1).max() <= 1e-9
    moved.check_closed()
    solid = to_trimesh(moved)
    assert solid.is_watertight
    assert solid.volume > 0
    assert moved.euler_characteristic == 2 * (len(skeleton.nodes) - len(skeleton.edges))
    assert len(self_intersections(moved)) == 0
    corners = moved.vertices[moved.quads]
    ahead = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(ahead, -np.roll(ahead, 1, axis=1))
    inward = field.gradient(moved.vertices)[moved.quads]
    assert (dot(normals, inward) < 0).all()
    return moved


def around(skeleton: Skeleton, levels: int = 2) -> QuadMesh:
    mesh = build_scaffold(skeleton, collars=True).mesh
    return catmull_clark(mesh, levels, mesh.edges).mesh


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_projected_mesh_is_on_the_surface_and_clean(kernel: KernelName, skeleton: Skeleton) -> None:
    check_projected(around(skeleton), skeleton, ConvolutionField(skeleton, kernel))


def test_projected_scaffold_of_the_stick_woman() -> None:
    woman = read_skeleton(WOMAN, strict=True)
    mesh = around(woman)
    moved = check_projected(mesh, woman, ConvolutionField(woman))
    # The squares of the scaffold are around circles: 4/π of their area.
    assert moved.signed_volume == pytest.approx(mesh.signed_volume * np.pi / 4, rel=0.05)


FOLDS = pytest.mark.xfail(strict=True, reason="a few quads stay folded, which a warning tells")


@pytest.mark.parametrize(
    "name", ["hand.graph", "simple.swc", pytest.param("test_morph.swc", marks=FOLDS)]
)
def test_projected_scaffolds_of_real_files(shared_data: Path, name: str) -> None:
    skeleton = real_skeleton(shared_data, name)
    check_projected(around(skeleton), skeleton, ConvolutionField(skeleton))


@pytest.mark.parametrize("levels", [0, 1, 3])
def test_any_subdivision_can_be_projected(levels: int) -> None:
    scaffold = build_scaffold(TRIPOD, collars=True)
    mesh = catmull_clark(scaffold.mesh, levels).mesh
    check_projected(mesh, TRIPOD, ConvolutionField(TRIPOD))


@pytest.mark.parametrize("kernel", KERNELS)
def test_radius_in_the_middle_of_long_struts_is_as_asked(kernel: KernelName) -> None:
    strut = Skeleton([[0, 0, 0], [60, 0, 0], [60, 50, 10]], [[0, 1], [1, 2]], [2.0, 2.0, 2.0])
    field = ConvolutionField(strut, kernel)
    mesh = project(around(strut, 3), field)
    x = mesh.vertices[:, 0]
    middle = mesh.vertices[(x > 15) & (x < 45)]
    assert len(middle) >= 32
    assert length(middle[:, 1:]) == pytest.approx(2.0, rel=0.02)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("factor", [0.2, 0.6, 1.7, 4.0])
def test_vertices_far_off_come_to_the_surface(kernel: KernelName, factor: float) -> None:
    mesh = around(STRUT)
    axis = np.array([1.0, 0, 0])
    foot = np.clip(mesh.vertices @ axis, 0, 10)[:, None] * axis
    field = ConvolutionField(STRUT, kernel)
    off = mesh.moved(foot + factor * (mesh.vertices - foot))
    moved = check_projected(off, STRUT, field)
    # Corners of the flat ends slide by a radius at most.
    assert length(moved.vertices - project(mesh, field).vertices).max() < 1.2


def test_struts_have_their_own_radii_beside_a_thicker_node() -> None:
    nodes, edges = [[-40, 0, 0], [0, 0, 0], [40, 0, 0]], [[0, 1], [1, 2]]
    field = ConvolutionField(Skeleton(nodes, edges, edge_radii=[3.0, 0.5]))
    assert field.value([[-20, 3, 0], [20, 0, 0.5], [40.5, 0, 0]]) == pytest.approx(1.0)


def test_vertex_inside_a_blend_comes_out() -> None:
    # So deep between six struts that the field has hardly a slope.
    mesh = around(JACK)
    field = ConvolutionField(JACK, width=3.0)
    points = np.array(mesh.vertices)
    near = length(points).argmin()
    points[near] *= 1e-3
    moved = project(mesh.moved(points), field)
    assert dot(moved.vertices[near], points[near]) > 0
    assert np.abs(field.value(moved.vertices) - 1).max() <= 1e-9


def test_vertices_on_the_skeleton_find_a_way_out_between_their_neighbors() -> None:
    mesh = around(JACK)
    points = np.array(mesh.vertices)
    points[[7, 9]] = 0.0  # between six edges, nothing else says which way is out
    check_projected(mesh.moved(points), JACK, ConvolutionField(JACK))


def test_vertex_that_has_no_way_to_the_surface_is_named() -> None:
    mesh = around(JACK, 0)
    flat = mesh.moved(np.zeros_like(mesh.vertices))
    found = rf"vertex 0 at \[0, 0, 0\] mm finds no .*\({len(flat.vertices)} vertices do not"
    with pytest.raises(MeshError, match=found):
        project(flat, ConvolutionField(JACK))


@pytest.mark.parametrize(
    ("tolerance", "width"),
    [pytest.param(1.5, 1.5, marks=FOLDS), (1.5, 2.0), (3.0, 1.5), (3.0, 2.0)],
)
def test_quads_folded_in_the_palm_of_a_hand_are_unfolded(
    shared_data: Path, tolerance: float, width: float
) -> None:
    hand = real_skeleton(shared_data, "hand.graph").simplified(tolerance)
    field = ConvolutionField(hand, width=width)
    moved = check_projected(around(hand), hand, field)
    middles = field.samples(moved.vertices[moved.quads].mean(axis=1))
    off = np.abs(middles.values - 1) / length(middles.gradients)
    assert off.max() < 0.25 * hand.radii.min()


def test_quads_folded_in_a_fork_are_unfolded() -> None:
    field = ConvolutionField(FIGURE_EIGHT, "cauchy")
    mesh = around(FIGURE_EIGHT)
    moved = check_projected(mesh, FIGURE_EIGHT, field)
    assert length(moved.vertices - mesh.vertices).max() < 1.6  # of radius 1; corners are √2 out


@pytest.mark.parametrize("skeleton", [K4, STICK_FIGURE, TAPER], ids=["k4", "stick", "taper"])
def test_projecting_twice_moves_nothing(skeleton: Skeleton) -> None:
    field = ConvolutionField(skeleton)
    once = project(around(skeleton), field)
    assert np.array_equal(project(once, field).vertices, once.vertices)
