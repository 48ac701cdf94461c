"""Foams in parts and meshes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from build123d import Box, Cylinder, Vector

from scaffold_cad import build_scaffold, check_skeleton, delaunay_foam, to_solid, voronoi_foam
from scaffold_cad.errors import OptionError


def test_a_foam_in_a_mesh_is_one_component_within_it() -> None:
    ring = trimesh.creation.torus(20.0, 7.0)
    foam = voronoi_foam(250, ring, 0.4, seed=1, regularity=0.5)
    check_skeleton(foam)
    assert foam.component_count == 1
    gaps = np.hypot(np.hypot(foam.nodes[:, 0], foam.nodes[:, 1]) - 20, foam.nodes[:, 2])
    assert gaps.max() < 7.1  # the mesh has flat faces
    solid = to_solid(build_scaffold(foam, collars=True))
    assert len(solid.decompose()) == 1
    assert foam.loop_count > 100  # around each cell's faces, and around the ring


def test_a_foam_in_a_build123d_part_leaves_its_hole_free() -> None:
    part = Box(40, 40, 20) - Cylinder(10, 30)
    for foam in (voronoi_foam, delaunay_foam):
        skeleton = foam(400, part, 0.4, seed=2)
        check_skeleton(skeleton)
        middles = skeleton.nodes[skeleton.edges].mean(axis=1)
        assert np.hypot(middles[:, 0], middles[:, 1]).min() > 9.9
        solid = part.solids()[0]
        assert all(solid.is_inside(Vector(*point), 1e-3) for point in middles[::53])


def test_a_function_needs_bounds() -> None:
    with pytest.raises(OptionError, match="a function without bounds"):
        voronoi_foam(50, lambda points: points[:, 0], 0.4)
