"""Frames: edges of scaffolds and skeletons as struts of the radius asked for."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.solid.thicken import frame_scaffold, thicken
from tests import skeletons as named
from tests.meshes import CUBE
from tests.solids import check_solid_of


def test_the_edges_of_a_cube_become_a_frame_of_genus_five() -> None:
    frame = thicken(CUBE, 0.1)
    assert frame.genus() == 12 - 8 + 1
    scaffold = frame_scaffold(CUBE, 0.1)
    assert len(scaffold.skeleton.edges) == 12
    check_solid_of(scaffold.skeleton, frame)


def test_struts_of_a_frame_have_the_section_asked_for() -> None:
    scaffold = frame_scaffold(CUBE, 0.1)
    middle = scaffold.refined.joints
    corners = scaffold.mesh.vertices[np.isin(scaffold.node_of_vertex, middle)]
    centers = scaffold.refined.nodes[
        scaffold.node_of_vertex[np.isin(scaffold.node_of_vertex, middle)]
    ]
    np.testing.assert_allclose(np.linalg.norm(corners - centers, axis=1), 0.1 * np.sqrt(2))


def test_a_scaffolds_frame_has_a_strut_an_edge_of_its_mesh() -> None:
    scaffold = build_scaffold(named.TRIPOD)
    frame = frame_scaffold(scaffold, 0.1)
    np.testing.assert_array_equal(frame.skeleton.edges, scaffold.mesh.edges)
    check_solid_of(frame.skeleton, thicken(scaffold, 0.1))


def test_a_skeleton_gets_the_radius_instead_of_its_own() -> None:
    scaffold = frame_scaffold(named.STICK_FIGURE, 0.2)
    np.testing.assert_array_equal(scaffold.skeleton.radii, 0.2)
    np.testing.assert_array_equal(scaffold.skeleton.edges, named.STICK_FIGURE.edges)
    check_solid_of(named.STICK_FIGURE, thicken(named.STICK_FIGURE, 0.2))


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan, np.inf])
def test_a_radius_must_be_a_number_above_zero(radius: float) -> None:
    with pytest.raises(OptionError, match=f"radius is {radius:g} mm; need > 0"):
        thicken(named.STRUT, radius)


def test_the_radius_may_be_a_function_of_positions() -> None:
    frame = frame_scaffold(named.STRUT, lambda nodes: 0.5 + nodes[:, 0] / 100)
    np.testing.assert_allclose(frame.skeleton.radii, 0.5 + named.STRUT.nodes[:, 0] / 100)
