"""The certificate of embedding: no false promise, and no needless doubt for plain lattices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from scaffold_cad.lattice import tile
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.shares import Share
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.pieces import solid_pieces, surface_of
from tests import skeletons as named
from tests.skeletons import NAMED, star
from tests.strategies import hinged_stars, skeletons

CROSSING = Skeleton(
    [[-10, 0, 0], [10, 0, 0], [0, -10, 0.5], [0, 10, 0.5], [30, 0, 0], [40, 0, 0]],
    [[0, 1], [2, 3], [4, 5]],
    1.0,
)
"""Two struts that cross without a common node, and one apart from both."""

OVERLAPPING_SPHERES = Skeleton(
    [[0, 0, 0], [1, 0, 0], [6, 10, 0], [-10, 5, 3], [-5, -10, 1], [11, -5, -3]],
    [[0, 1], [0, 2], [0, 3], [1, 4], [1, 5]],
    2.0,
)
"""Two branch points closer than their radii."""

NARROW = star([[20, 0, 0], [20 * np.cos(0.035), 20 * np.sin(0.035), 0], [-10, 0, 5]])
"""Two struts of radius 1 that leave a branch point 2 degrees apart."""

DOUBLED_BACK = Skeleton([[0, 0, 0], [10, 0, 0], [0.5, 1.5, 0]], [[0, 1], [1, 2]], 1.0)
"""Two struts that meet at a joint under 9 degrees."""

FOLDED = Skeleton(
    [
        [0, 0, 0],
        [5.5, 0, 0],
        [3.87, 1.65, 0],
        [4.24, -0.38, -2.66],
        [3.6, -3.3, 1.15],
        [-1, 5, 0.6],
    ],
    [[0, 1], [1, 2], [0, 3], [0, 4], [0, 5]],
    [1.62, 0.08, 0.25, 0.56, 0.56, 0.56],
)
"""A strut that folds back at a thin joint into its thick branch point, across its collar."""


def check_promise(scaffold: Scaffold) -> None:
    """Assert that what is kept does not cross itself, by a test that knows nothing of struts."""
    embedded = scaffold.embedding()
    kept = surface_of(scaffold, Share(embedded.kept, embedded.kept_nodes), embedded.within_cone)
    pieces = solid_pieces(scaffold, embedded, np.zeros(len(scaffold.skeleton.nodes)))
    for surface in (kept, *pieces.surfaces):
        if len(surface.triangles):
            surface.check_closed()
            assert surface.signed_volume > 0
            assert len(self_intersections(surface)) == 0
    if embedded.certified:
        assert len(self_intersections(scaffold.mesh)) == 0


@given(skeletons())
def test_what_is_kept_never_crosses_itself(skeleton: Skeleton) -> None:
    check_promise(build_scaffold(skeleton))
    check_promise(build_scaffold(skeleton, collars=True))


@given(hinged_stars())
def test_thick_branch_points_are_kept_apart_from_folded_arms(skeleton: Skeleton) -> None:
    check_promise(build_scaffold(skeleton, collars=True))


def test_blend_that_reaches_beyond_the_next_joint_is_found() -> None:
    scaffold = build_scaffold(FOLDED, collars=True)
    assert len(self_intersections(scaffold.mesh)) > 0
    assert scaffold.embedding().within_cone[0].tolist() == [True, False]
    check_promise(scaffold)


@pytest.mark.parametrize("skeleton", [CROSSING, OVERLAPPING_SPHERES, NARROW, DOUBLED_BACK])
@pytest.mark.parametrize("fit", ["enclose", "paper"])
def test_overlaps_are_found(skeleton: Skeleton, fit: str) -> None:
    scaffold = build_scaffold(skeleton, fit=fit)  # type: ignore[arg-type]
    assert not scaffold.embedding().certified
    check_promise(scaffold)


def test_struts_that_cross_are_named_as_a_pair() -> None:
    embedded = build_scaffold(CROSSING).embedding()
    assert embedded.conflicts.tolist() == [[0, 1]]
    assert embedded.left_out.tolist() == [0, 1]
    assert embedded.within_cone.all()
    assert embedded.uncrossed.all()


def test_branch_points_closer_than_their_spheres_are_left_out() -> None:
    embedded = build_scaffold(OVERLAPPING_SPHERES, fit="paper").embedding()
    assert not embedded.kept_nodes[:2].any()
    assert embedded.kept_nodes[2:].all()
    assert len(embedded.left_out) == 5


@pytest.mark.parametrize("name", NAMED)
def test_thin_named_skeletons_are_certified(name: str) -> None:
    skeleton = NAMED[name]
    thin = skeleton.with_radii(0.05 * float(skeleton.lengths.min()))
    assert build_scaffold(thin).embedding().certified


@pytest.mark.parametrize("cell", ["sc", "bcc", "fcc", "octet", "kelvin", "diamond"])
@pytest.mark.parametrize("collars", [False, True])
def test_thin_lattices_are_certified(cell: str, collars: bool) -> None:
    lattice = tile(cell, 10.0, (2, 2, 2), radius=0.3)
    scaffold = build_scaffold(lattice, collars=collars)
    assert scaffold.embedding().certified
    assert len(self_intersections(scaffold.mesh)) == 0


def test_the_report_is_computed_once() -> None:
    scaffold = build_scaffold(named.TRIPOD)
    assert scaffold.embedding() is scaffold.embedding()
