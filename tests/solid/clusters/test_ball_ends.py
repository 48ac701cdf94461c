"""Balls at extremities: nodes that are thicker than their only strut."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, slices
from scaffold_cad.errors import BrepError, OptionError
from scaffold_cad.products import to_brep
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import Nodes
from tests.crossings import check_as_written
from tests.solids import contains

DUMBBELL = Skeleton([[0, 0, 0], [20, 0, 0]], [[0, 1]], [1.5, 3.0], edge_radii=1.0)
STAR = Skeleton(
    [[0, 0, 0], [12, 0, 0], [0, 12, 0], [0, -3, 12]],
    [[0, 1], [0, 2], [0, 3]],
    [1.0, 3.0, 1.0, 2.0],
    edge_radii=1.0,
)


def volume_of_dumbbell() -> float:
    """Return the volume of two balls and the strut between them, less what both have."""
    found = 4 / 3 * np.pi * (1.5**3 + 3.0**3)
    rings = [np.sqrt(size**2 - 1) for size in (1.5, 3.0)]
    found += np.pi * (20 - sum(rings))
    return found - sum(
        np.pi * (2 * size**3 / 3 - size**2 * ring + ring**3 / 3)
        for size, ring in zip((1.5, 3.0), rings, strict=True)
    )


@pytest.mark.parametrize("nodes", ["blend", "sharp"])
def test_balls_have_their_volume(nodes: Nodes) -> None:
    struts = round_struts(DUMBBELL, nodes=nodes)
    mesh = round_mesh(struts)
    check_as_written(mesh)
    assert mesh.signed_volume == pytest.approx(volume_of_dumbbell(), rel=0.005)
    layers = sum(layer.area for layer in slices(struts, thickness=0.05)) * 0.05
    assert layers == pytest.approx(mesh.signed_volume, rel=0.01)


@pytest.mark.parametrize("ends", ["flat", "round", "open"])
def test_balls_are_hollow_where_struts_are(ends: str) -> None:
    struts = round_struts(STAR, wall=0.3, ends=ends)  # type: ignore[arg-type]
    mesh = round_mesh(struts)
    check_as_written(mesh)
    ways = np.random.default_rng(0).normal(size=(200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    ways = ways[ways[:, 0] > -0.5]  # away from the strut
    center = np.array([12.0, 0, 0])
    assert contains(mesh, center + 2.85 * ways).all()
    assert not contains(mesh, center + 2.6 * ways).any()
    assert not contains(mesh, center + 3.1 * ways).any()


def test_step_has_them_as_facets_where_asked() -> None:
    struts = round_struts(STAR)
    with pytest.raises(BrepError, match=r"2 of 3 struts .*or end in balls \(edges 0, 2"):
        to_brep(struts)
    solid = to_brep(struts, overlaps="unite")
    assert solid.is_valid
    assert solid.volume == pytest.approx(round_mesh(struts).signed_volume, rel=0.01)


def test_sockets_are_for_ends_that_are_open() -> None:
    with pytest.raises(
        OptionError, match=r"socket at node 1 at \[20, 0, 0\] mm is in a ball of rad"
    ):
        round_struts(DUMBBELL, wall=0.3, ends="open", sockets={1: (0.8, 2)})
