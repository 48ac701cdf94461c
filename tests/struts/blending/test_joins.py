import numpy as np

from scaffold_cad.partition import partition_spheres
from scaffold_cad.partition.arcs import arc_counts, side_twins
from scaffold_cad.struts.blending.joins import shared_numbers, types_of, valences
from tests.struts.stars import random_stars

RNG = np.random.default_rng(2)
SOME = partition_spheres(random_stars(40, 5, 30, RNG))


def test_relabeled_nodes_are_of_the_same_type() -> None:
    order = RNG.permutation(5)
    names = RNG.permutation(7)
    turned = np.roll(names[SOME.quads[:, order]], 1, axis=2)
    assert (types_of(turned).type_of == types_of(turned).type_of).all()
    both = types_of(np.concatenate([SOME.quads, turned]))
    assert (both.type_of[:40] == both.type_of[40:]).all()


def test_sides_of_a_type_have_the_twins_of_the_node() -> None:
    types = types_of(SOME.quads)
    own = side_twins(SOME.quads)
    for node in range(40):
        sides, twins = types.sides[node], types.twins[types.type_of[node]]
        assert (own[node, sides] == sides[twins]).all()


def test_valences_are_twice_the_arcs() -> None:
    twins = side_twins(SOME.quads)
    counts = arc_counts(SOME.quads)
    for node in range(40):
        wanted = 2 * counts[node, SOME.quads[node].reshape(-1)]
        assert (valences(twins[node]) == wanted).all()


def test_grid_points_are_as_many_as_euler_says() -> None:
    twins = side_twins(SOME.quads)[0]
    number, count = shared_numbers(twins, 4, 3)
    # Vertices, arcs, spokes without their ends on the vertices, insides.
    assert count == 7 + 10 * 2 + 20 * 2 + 20 * 2 * 2
    assert set(number.reshape(-1)) == set(range(count))
