"""Fillet radii by node: each node has that of its own number, in surfaces, fields and layers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scaffold_cad import PeriodicLattice, Skeleton, round_struts, slices, to_solid
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.errors import OptionError

STAR = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9], [-6, -6, -6]], dtype=np.float64)
EDGES = np.array([[0, 1], [0, 2], [0, 3], [0, 4]])
ONE = Skeleton(STAR, EDGES, 1.0)
BOTH = Skeleton(np.vstack([STAR, STAR + np.array([40, 0, 0])]), np.vstack([EDGES, EDGES + 5]), 1.0)
BLENDS = np.repeat([0.3, 0.9], 5)


def by_place(nodes: Points) -> Floats:
    return np.where(nodes[:, 0] < 20, 0.3, 0.9)


@pytest.mark.parametrize(
    ("blend", "wall"), [(BLENDS, None), (BLENDS.tolist(), 0.3), (by_place, None)]
)
def test_each_node_has_its_own_fillet(blend: Any, wall: float | None) -> None:
    struts = round_struts(BOTH, blend=blend, wall=wall)
    np.testing.assert_allclose(struts.fillet[[0, 5]], [0.3, 0.9])
    alone = [to_solid(round_struts(ONE, blend=one, wall=wall)).volume() for one in (0.3, 0.9)]
    # What is inside moves where walls are too thin, by 32-bit numbers that differ with the place.
    off = (1e-9 if wall is None else 1e-4) * sum(alone)
    assert abs(alone[1] - alone[0]) > 3 * off  # a wall is as thick beside any fillet
    assert to_solid(struts).volume() == pytest.approx(sum(alone), abs=off)


def test_crowded_nodes_have_their_own_fillet() -> None:
    thick = Skeleton(BOTH.nodes, BOTH.edges, 2.6)
    whole = round_struts(thick, blend=BLENDS)
    single = [round_struts(Skeleton(STAR, EDGES, 2.6), blend=one) for one in (0.3, 0.9)]
    heights = [-1.0, 0.5, 2.0]
    for found, *alone in zip(
        slices(whole, heights), *(slices(each, heights) for each in single), strict=True
    ):
        assert found.area == pytest.approx(sum(layer.area for layer in alone), rel=1e-4)


def rising(nodes: Points) -> Floats:
    return np.asarray(0.03 + 0.01 * nodes[:, 2])


def test_a_lattice_has_fillets_by_place() -> None:
    lattice = PeriodicLattice("bcc", 1.0, (1, 1, 3), radius=0.1, blend=rising)
    whole = round_struts(lattice.skeleton(), blend=rising)
    heights = np.linspace(0.1, 2.9, 4)
    for found, wanted in zip(slices(lattice, heights), slices(whole, heights), strict=True):
        assert found.area == pytest.approx(wanted.area, rel=1e-6)
    larger = lattice.scaled(2.0)
    points = np.array([[0.0, 0.0, 4.0]])
    assert callable(larger.blend)
    np.testing.assert_allclose(larger.blend(points), 2 * rising(points / 2))


@pytest.mark.parametrize(
    ("blend", "said"),
    [
        (0.0, "blend is 0"),
        ([0.5, 0.5], r"blend has shape \(2,\); need one number, or \(5,\), mm"),
        ([0.5, 0.5, -1.0, 0.5, 0.5], r"blend of node 2 at \[.*\] mm is -1 mm; need > 0"),
        (lambda nodes: nodes, r"blend has shape \(5, 3\)"),
        ([0.5, 0.5, np.nan, 0.5, 0.5], r"blend of node 2 at \[.*\] mm is nan mm; need > 0"),
    ],
)
def test_fillets_that_do_not_fit_are_refused(blend: Any, said: str) -> None:
    with pytest.raises(OptionError, match=said):
        round_struts(ONE, blend=blend)
