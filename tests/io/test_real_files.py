"""Files that nobody on the project wrote, counted by others (SOURCES.md beside them)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.io import read_raw, read_skeleton, read_with_repairs
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.skeleton.repair import Repairs

SOUND = {
    # name: nodes, edges, loops, largest valency, branch points, joints, extremities, diagonal,
    # least length
    "nrn_ordering.swc": (3783, 3782, 0, 9, 57, 3660, 66, 543, 0.27),
    "test_morph.swc": (29, 28, 0, 3, 13, 1, 15, 527, 1),
    "hand.graph": (47, 46, 0, 5, 2, 39, 6, 265, 7.31),
    "wolf.graph": (66, 65, 0, 5, 6, 48, 12, 0.921, 0.00923),
    "pattern1065.wire": (39, 54, 16, 6, 15, 24, 0, 1.73, 0.25),
    "pyramid.3mf": (123, 391, 269, 10, 123, 0, 0, 233, 5),
    "Box_Simple.3mf": (8, 12, 5, 3, 8, 0, 0, 173, 100),
    "mina_vase.obj": (84, 116, 33, 4, 49, 1, 34, 191, 6.11),
    "saddle.obj": (32, 40, 9, 4, 16, 0, 16, 15, 2),
    "bear_skel-poly.polylines.txt": (314, 313, 0, 3, 5, 302, 7, 1.74, 0.000996),
    "C60-buckminsterfullerene.cjson": (60, 90, 31, 3, 60, 0, 0, 11.8, 1.39),
    "topopt-100_S1_03-14-2019_w_layer.json": (88, 132, 45, 7, 52, 0, 36, 263, 5),
    "Leica_Disto_S910.dxf": (11, 10, 0, 2, 0, 9, 2, 2.02, 0.036),
}
"""Those whose graph cleaning does not change, but for welding and removed nodes."""

RADII = {
    "nrn_ordering.swc": (0.114, 5.44),
    "test_morph.swc": (1.5, 6),
    "pyramid.3mf": (1.92, 4.91),
    "Box_Simple.3mf": (10, 15),
    "topopt-100_S1_03-14-2019_w_layer.json": (1.5, 1.5),
}
"""Least and largest radius of those that have radii."""


def found(folder: Path, name: str) -> Path:
    path = folder / name
    if not path.is_file():
        pytest.skip(f"no {name} beside the repository")
    return path


@pytest.mark.parametrize("name", SOUND)
def test_counts_are_those_of_the_source(shared_data: Path, name: str) -> None:
    skeleton = read_skeleton(found(shared_data, name), None if name in RADII else 0.001)
    check_skeleton(skeleton)
    nodes, edges, loops, valency, branch_points, joints, extremities, diagonal, least = SOUND[name]
    assert (len(skeleton.nodes), len(skeleton.edges)) == (nodes, edges)
    assert (skeleton.component_count, skeleton.loop_count) == (1, loops)
    assert skeleton.valency.max() == valency
    assert len(skeleton.branch_points) == branch_points
    assert len(skeleton.joints) == joints
    assert len(skeleton.extremities) == extremities
    size = np.linalg.norm(np.ptp(skeleton.nodes, axis=0))
    assert size == pytest.approx(diagonal, rel=0.005)
    assert skeleton.lengths.min() == pytest.approx(least, rel=0.02)


@pytest.mark.parametrize("name", RADII)
def test_radii_are_those_of_the_source(shared_data: Path, name: str) -> None:
    radii = read_skeleton(found(shared_data, name)).radii
    assert (radii.min(), radii.max()) == pytest.approx(RADII[name], rel=0.005)


def test_the_fork_at_the_soma_shows_after_repair(shared_data: Path) -> None:
    cleaning = read_with_repairs(found(shared_data, "simple.swc"))
    assert cleaning.repairs == Repairs(radii_replaced=4, nodes_welded=2, zero_length_edges=2)
    skeleton = cleaning.skeleton
    assert (len(skeleton.nodes), len(skeleton.edges)) == (7, 6)
    assert sorted(skeleton.valency.tolist()) == [1, 1, 1, 1, 2, 3, 3]
    assert set(skeleton.radii.tolist()) == {1.0}


def test_bones_that_coincide_at_the_chest_are_welded(shared_data: Path) -> None:
    path = found(shared_data, "test_mocapbank.bvh")
    raw = Skeleton(read_raw(path).nodes, read_raw(path).edges, np.array(1.0))
    assert (len(raw.nodes), len(raw.edges), raw.valency.max()) == (24, 23, 4)
    assert (len(raw.branch_points), len(raw.joints), len(raw.extremities)) == (2, 17, 5)
    assert raw.lengths.min() == pytest.approx(9.97, rel=0.001)
    assert np.linalg.norm(np.ptp(raw.nodes, axis=0)) == pytest.approx(174, rel=0.005)
    repairs = read_with_repairs(path, 1.0).repairs
    assert repairs == Repairs(nodes_welded=2, duplicate_edges=2)


def test_every_real_file_is_read(shared_data: Path) -> None:
    paths = [path for path in shared_data.iterdir() if path.is_file() and path.suffix != ".md"]
    for path in paths:
        radius = None if read_raw(path).radii is not None else 0.01
        check_skeleton(read_skeleton(path, radius))
    assert paths


@pytest.mark.parametrize(
    ("name", "repairs"),
    [
        ("hand.graph", Repairs(nodes_without_position=34)),
        ("saddle.obj", Repairs(nodes_welded=48)),
        ("pattern1065.wire", Repairs()),
        ("bear_skel-poly.polylines.txt", Repairs()),
    ],
)
def test_repairs_are_those_that_the_file_needs(
    shared_data: Path, name: str, repairs: Repairs
) -> None:
    assert read_with_repairs(found(shared_data, name), 1.0).repairs == repairs


def test_raw_counts_are_those_before_repair(shared_data: Path) -> None:
    hand = read_raw(found(shared_data, "hand.graph"))
    assert (len(hand.nodes), len(hand.edges), hand.radii) == (81, 46, None)
    assert np.isnan(hand.nodes).any(axis=1).sum() == 34
