"""Hexahedra: they conform, none is inverted, and their volume is that of the struts."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from scaffold_cad import RoundStruts, Scaffold, Skeleton, build_scaffold, round_struts
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import voronoi_foam
from scaffold_cad.lattice import cells, tile
from scaffold_cad.mechanics import hexahedra
from scaffold_cad.mechanics.hexahedra.quality import FACES, hexahedron_volumes, scaled_jacobians

STRUT = Skeleton([[0, 0, 0], [0, 0, 20]], [[0, 1]], 1.5)
RING = Skeleton(
    [[10 * np.cos(t), 10 * np.sin(t), 0] for t in np.arange(12) * np.pi / 6],
    [[k, (k + 1) % 12] for k in range(12)],
    1.0,
)
CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)


def lattice(name: str, slenderness: float = 0.08, count: int = 2) -> Skeleton:
    thin = tile(name, 10.0, (count, count, count), radius=0.1)
    return thin.with_radii(float(slenderness * np.median(thin.lengths)))


def face_counts(mesh: np.ndarray) -> np.ndarray:
    faces = np.sort(mesh[:, FACES].reshape(-1, 4), axis=1)
    return np.unique(faces, axis=0, return_counts=True)[1]


def test_a_cube_is_perfect_and_a_skewed_one_has_its_integral_of_volume() -> None:
    assert scaled_jacobians(CUBE, np.arange(8)[None]) == pytest.approx([1.0])
    skewed = CUBE + np.random.default_rng(0).normal(size=(8, 3)) * 0.1
    places, weights = np.polynomial.legendre.leggauss(3)
    total, sign = 0.0, 2 * CUBE - 1
    for a, wa in zip(places, weights, strict=True):
        for b, wb in zip(places, weights, strict=True):
            for c, wc in zip(places, weights, strict=True):
                f = (1 + sign * [a, b, c]) / 2
                slope = (
                    sign
                    / 2
                    * np.stack([f[:, 1] * f[:, 2], f[:, 0] * f[:, 2], f[:, 0] * f[:, 1]], axis=1)
                )
                total += wa * wb * wc * np.linalg.det(skewed.T @ slope)
    assert hexahedron_volumes(skewed, np.arange(8)[None]) == pytest.approx([total])


@pytest.mark.parametrize("layers", [0, 2])
def test_a_strut_has_the_volume_of_its_cylinder(layers: int) -> None:
    mesh = hexahedra(build_scaffold(STRUT), layers=layers, along=4)
    assert len(mesh.hexahedra) == 4 * (4 + 8 * layers)
    assert mesh.volumes.sum() == pytest.approx(np.pi * 1.5**2 * 20, rel=1e-12)
    assert mesh.quality.min() > 0.6
    # The end faces are those of the two extremities.
    for node in (0, 1):
        on_end = mesh.points[mesh.end_of_point == node]
        np.testing.assert_allclose(on_end[:, 2], 20.0 * node, atol=1e-12)
        assert len(on_end) == 9 + 8 * layers


@pytest.mark.parametrize(("number", "name"), list(enumerate(cells())))
def test_hexahedra_of_named_cells_are_good(number: int, name: str) -> None:
    layers = number % 2
    scaffold = build_scaffold(lattice(name), collars=layers == 0)
    mesh = hexahedra(scaffold, layers=layers)
    # Sections at collars do not move: between two of them, rounding decides on which side of a
    # fifth the struts of prisms are (0.190 or more).
    between_collars = layers == 0 and name == "triangular_prism"
    assert mesh.quality.min() > (0.18 if between_collars else 0.2)
    assert len(mesh.hexahedra) == (4 + 8 * layers) * len(scaffold.refined.edges)
    counts = face_counts(mesh.hexahedra)
    assert counts.max() == 2  # they meet face to face
    assert (counts == 1).sum() == len(mesh.boundary)
    assert mesh.volumes.sum() == pytest.approx(mesh.enclosed_volume, rel=1e-12)


@pytest.mark.parametrize("name", ["bcc", "octet", "kelvin", "diamond"])
def test_layers_and_pieces_are_as_good(name: str) -> None:
    mesh = hexahedra(build_scaffold(lattice(name), collars=True), layers=2, along=2)
    assert mesh.quality.min() > 0.2
    assert face_counts(mesh.hexahedra).max() == 2
    assert mesh.volumes.sum() == pytest.approx(mesh.enclosed_volume, rel=1e-12)


@pytest.mark.parametrize("valency", [3, 4, 6, 9])
def test_random_stars_have_no_inverted_hexahedra(valency: int) -> None:
    rng = np.random.default_rng(valency)
    for _ in range(5):
        directions: list[np.ndarray] = []
        while len(directions) < valency:
            one = rng.normal(size=3)
            one /= np.linalg.norm(one)
            if all(one @ other < np.cos(np.radians(30)) for other in directions):
                directions.append(one)
        star = Skeleton(
            [[0, 0, 0], *(12 * d for d in directions)],
            [[0, k + 1] for k in range(valency)],
            1.0,
        )
        for collars in (False, True):
            mesh = hexahedra(build_scaffold(star, collars=collars))
            assert len(mesh.inverted) == 0


def test_volume_of_a_lattice_is_that_of_its_struts_united() -> None:
    # Monte Carlo over the box of a corner of four struts that stand at right angles.
    cross = Skeleton(
        [[0, 0, 0], [10, 0, 0], [-10, 0, 0], [0, 10, 0], [0, 0, 10]],
        [[0, 1], [0, 2], [0, 3], [0, 4]],
        1.5,
    )
    mesh = hexahedra(build_scaffold(cross, collars=True), relax=0)
    rng = np.random.default_rng(5)
    points = rng.uniform([-10, -2, -2], [10, 10, 10], size=(400_000, 3))
    inside = np.zeros(len(points), dtype=bool)
    for end in cross.nodes[1:]:
        axis = end / np.linalg.norm(end)
        along = points @ axis
        gap = np.linalg.norm(points - along[:, None] * axis, axis=1)
        inside |= (along > 0) & (along < 10) & (gap < 1.5)
    expected = inside.mean() * 20 * 12 * 12
    assert mesh.volumes.sum() == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize("collars", [False, True])
def test_struts_keep_their_own_radii(collars: bool) -> None:
    star = Skeleton(
        [[0, 0, 0], [20, 0, 0], [0, 20, 0], [0, 0, 20], [-20, -20, -20]],
        [[0, 1], [0, 2], [0, 3], [0, 4]],
        edge_radii=[[2.0, 2.0], [1.0, 1.0], [1.5, 0.5], [1.0, 1.0]],
    )
    mesh = hexahedra(build_scaffold(star, collars=collars))
    for edge, radius in enumerate([2.0, 1.0, 0.5, 1.0]):
        end = mesh.points[mesh.end_of_point == edge + 1] - star.nodes[edge + 1]
        expected = radius * np.sqrt(np.pi / np.sqrt(8))
        np.testing.assert_allclose(np.linalg.norm(end, axis=1).max(), expected, rtol=1e-9)
    assert mesh.quality.min() > 0.1


def test_a_ring_closes() -> None:
    mesh = hexahedra(build_scaffold(RING))
    assert len(mesh.hexahedra) == 48
    assert mesh.quality.min() > 0.5
    assert (mesh.node_of_hexahedron == -1).all()


def test_sets_name_the_edge_and_the_branch_point() -> None:
    skeleton = lattice("bcc", count=1)
    mesh = hexahedra(build_scaffold(skeleton, collars=True), along=2)
    center = int(np.flatnonzero(skeleton.valency == 8)[0])
    assert set(mesh.edge_of_hexahedron.tolist()) == set(range(8))
    touching = mesh.hexahedra[mesh.node_of_hexahedron == center]
    assert len(touching) == 8 * 4
    middle = np.flatnonzero((mesh.points == skeleton.nodes[center]).all(axis=1))
    assert np.isin(touching, middle).any(axis=1).all()


@pytest.mark.parametrize("make", [partial(build_scaffold, collars=True), round_struts])
def test_patch_test_with_scikit_fem(
    make: Callable[[Skeleton], Scaffold | RoundStruts],
) -> None:
    skfem = pytest.importorskip("skfem")
    from skfem.helpers import ddot, eye, sym_grad, trace
    from skfem.models.elasticity import lame_parameters

    mesh = hexahedra(make(lattice("octet", count=1)), sides=8, layers=1)
    # Its corners are numbered bit by bit: 000, 001, 010, 100, ...; ours run around two faces.
    order = [0, 1, 3, 4, 2, 5, 7, 6]
    grid = skfem.MeshHex(mesh.points.T.copy(), mesh.hexahedra[:, order].T.copy())
    basis = skfem.Basis(grid, skfem.ElementVector(skfem.ElementHex1()), intorder=3)
    lam, mu = lame_parameters(210e3, 0.3)

    @skfem.BilinearForm
    def stiffness(u: object, v: object, w: object) -> object:
        strain = sym_grad(u)
        return ddot(lam * eye(trace(strain), 3) + 2 * mu * strain, sym_grad(v))

    matrix = stiffness.assemble(basis)
    slope = np.random.default_rng(2).normal(size=(3, 3)) * 1e-3
    exact = (mesh.points @ slope.T).reshape(-1)
    outside = np.unique(mesh.boundary)
    held = (3 * outside[:, None] + np.arange(3)).reshape(-1)
    free = np.setdiff1d(np.arange(len(exact)), held)
    assert len(free) > 100
    found = exact.copy()
    found[free] = 0
    system = skfem.condense(matrix, x=found, D=held)
    np.testing.assert_allclose(skfem.solve(*system), exact, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"layers": -1}, "layers is -1"),
        ({"along": 0}, "along is 0"),
        ({"relax": -0.1}, "relax is -0.1"),
    ],
)
def test_bad_arguments_are_named(options: dict[str, float], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        hexahedra(build_scaffold(STRUT), **options)  # type: ignore[arg-type]


def test_a_skeleton_is_no_scaffold() -> None:
    with pytest.raises(OptionError, match="need a Scaffold"):
        hexahedra(STRUT)  # type: ignore[arg-type]


def test_hexahedra_beside_short_edges_of_foams_are_good() -> None:
    bounds = np.array([[0.0, 0.0, 0.0], [100.0, 100.0, 100.0]])
    scaffold = build_scaffold(voronoi_foam(25, bounds, 0.4))  # some edges are shorter than radii
    mesh = hexahedra(scaffold, layers=1)
    quality = scaled_jacobians(mesh.points, mesh.hexahedra)
    assert (quality < 0.2).mean() < 0.015
    kept = scaffold.embedding().kept[mesh.edge_of_hexahedron]
    assert quality[kept].min() > 0.1


def test_none_is_inverted_where_branch_points_are_closer_than_their_struts_are_thick() -> None:
    foam = voronoi_foam(6, np.array([[0.0] * 3, [50.0] * 3]), 2.0)
    assert foam.lengths.min() < 0.5 * foam.radii.min()
    scaffold = build_scaffold(foam, collars=True)
    assert not scaffold.embedding().certified
    mesh = hexahedra(scaffold)
    assert len(mesh.inverted) == 0
    assert (face_counts(mesh.hexahedra) <= 2).all()
    assert mesh.volumes.sum() == pytest.approx(mesh.enclosed_volume)
    assert len(hexahedra(scaffold, relax=0).inverted) > 0  # and so are some as they are planned
