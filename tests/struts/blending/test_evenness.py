import numpy as np

from scaffold_cad.base.vectors import angle_between
from scaffold_cad.partition import certify, partition_spheres
from scaffold_cad.partition.certificate import corners_of
from scaffold_cad.struts import blends
from scaffold_cad.struts.blending.bends import bend_partitions
from scaffold_cad.struts.blending.evenness import even
from tests.struts.stars import CUBIC, random_stars, stars_of

RNG = np.random.default_rng(6)


def shortest(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    corners = corners_of(vertices, quads)
    return angle_between(corners, np.roll(corners, -1, axis=2)).min(axis=(1, 2))


def test_even_vertices_are_certified_and_their_arcs_longer() -> None:
    some = partition_spheres(random_stars(200, 6, 30, RNG))
    moved = even(some.directions, some.vertices, some.quads, 0.15)
    assert certify(some.directions, moved, some.quads).valid.all()
    before, after = shortest(some.vertices, some.quads), shortest(moved, some.quads)
    assert np.quantile(after, 0.05) > 1.5 * np.quantile(before, 0.05)


def test_vertices_keep_away_from_directions() -> None:
    # Three struts of a truss to one side, 45 and 60° apart, whose quads share a vertex.
    diagonals = np.array([[-1, 1, -1], [0, -1, -1], [1, 0, -1]], dtype=np.float64)
    diagonals /= np.linalg.norm(diagonals, axis=1, keepdims=True)
    truss = partition_spheres(np.concatenate([diagonals, [[0, 0, 1], [0, 0, -1]]])[None])
    moved = even(truss.directions, truss.vertices, truss.quads, 0.3)
    nearest = (moved @ truss.directions.transpose(0, 2, 1)).max()
    assert np.degrees(np.arccos(nearest)) > 5
    (found,) = blends(stars_of(truss.directions))
    assert found.proved.all()
    assert found.shapes.sound.all()


def test_a_cube_stays_a_cube() -> None:
    cube = partition_spheres(CUBIC[None])
    assert np.allclose(even(cube.directions, cube.vertices, cube.quads, 0.3), cube.vertices)


def test_bends_are_cut_into_certified_half_spheres() -> None:
    pairs = random_stars(50, 2, 5, RNG)
    pairs = np.concatenate([pairs, [[[0.0, 0, 1], [0, 0, -1]]]])
    found = bend_partitions(pairs)
    certificate = certify(pairs, found.vertices, found.quads)
    assert certificate.valid.all()
    assert np.allclose(certificate.clearance, found.clearance)
