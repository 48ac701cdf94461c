"""The partitions of all branch points of a skeleton: where they leave an edge least room."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, TriangleMesh, build_scaffold, partition_sphere
from scaffold_cad.mesh.subdivision import catmull_clark
from scaffold_cad.mesh.subdivision.limits import limit
from scaffold_cad.printability.thickness import thickness_of
from scaffold_cad.scaffold.stars import worst_clearance
from tests.skeletons import ELBOW, JACK, K4, RING, STICK_FIGURE, STRUT, TRIPOD
from tests.struts.stars import random_stars


@pytest.mark.parametrize("skeleton", [TRIPOD, K4, JACK, STICK_FIGURE], ids=lambda s: len(s.nodes))
def test_worst_clearance_is_the_smallest_of_all_partitions(skeleton: Skeleton) -> None:
    worst = worst_clearance(skeleton, build_scaffold(skeleton).clearance)
    assert worst is not None
    relative = {
        node: partition_sphere(
            skeleton.directions[
                skeleton.incidence.at_nodes(np.array([node]), skeleton.valency[node])[0]
            ]
        ).relative_clearance
        for node in skeleton.branch_points.tolist()
    }
    assert worst.relative == pytest.approx(min(relative.values()), abs=1e-6)
    assert worst.relative == pytest.approx(relative[worst.node], abs=1e-6)
    assert worst.node == skeleton.edges[worst.edge][worst.half_edge % 2]


@pytest.mark.parametrize("skeleton", [STRUT, ELBOW, RING], ids=["strut", "elbow", "ring"])
def test_without_branch_points_there_is_no_clearance(skeleton: Skeleton) -> None:
    assert worst_clearance(skeleton, build_scaffold(skeleton).clearance) is None


def test_the_round_section_is_the_one_whose_limit_has_the_radius() -> None:
    chain = Skeleton([[0, 0, 2.0 * k] for k in range(9)], [[k, k + 1] for k in range(8)], 1.0)
    tube = build_scaffold(chain, section="round").mesh
    points = limit(catmull_clark(tube, 2).mesh).points
    ring = points[np.abs(points[:, 2] - 8.0) < 1e-9]
    radii = np.linalg.norm(ring[:, :2], axis=1)
    assert len(ring) == 16
    assert (radii.min() + radii.max()) / 2 == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(("degrees", "most"), [(50.0, 0.1), (30.0, 0.25)])
def test_few_struts_of_random_nodes_are_thin(degrees: float, most: float) -> None:
    random = np.random.default_rng(3)
    nodes, edges = [], []
    for valency in (3, 4, 5, 6):
        for star in random_stars(8, valency, degrees, random):
            edges += [[len(nodes), len(nodes) + 1 + k] for k in range(valency)]
            nodes += [*([0.0, 0.0, 60.0 * len(edges)] + 20 * np.vstack([np.zeros(3), star]))]
    stars = Skeleton(nodes, edges, 1.0)
    mesh = build_scaffold(stars).mesh
    share = thickness_of(stars, TriangleMesh(mesh.vertices, mesh.triangles)).diameters / 2
    assert (share < 0.9).mean() < most
    assert share.min() > 0.5
