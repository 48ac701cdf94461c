"""Loops of closed meshes at heights."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.layers.loops import MeshSections, cycles
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from tests.meshes import CUBE


def box() -> TriangleMesh:
    """Return the cube from 0 to 1."""
    return TriangleMesh((CUBE.vertices + 1) / 2, CUBE.triangles)


def areas(sections: MeshSections, heights: list[float]) -> list[float]:
    found = [0.0] * len(heights)
    for loops in sections.loops(np.array(heights)):
        for level, polygons in enumerate(loops.by_level(len(heights))):
            for one in polygons:
                x, y = one.T
                found[level] += float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)
    return found


def test_cycles_are_labeled_by_their_least_item_and_ranked_from_it() -> None:
    label, rank = cycles(np.array([3, 1, 4, 2, 0]))
    assert label.tolist() == [0, 1, 0, 0, 0]
    assert rank.tolist() == [0, 0, 2, 1, 3]


@pytest.mark.parametrize("seed", range(5))
def test_cycles_of_a_random_permutation(seed: int) -> None:
    after = np.random.default_rng(seed).permutation(200)
    label, rank = cycles(after)
    for start in np.unique(label).tolist():
        item = start
        for step in range(int((label == start).sum())):
            assert (label[item], rank[item]) == (start, step)
            item = after[item]
        assert item == start


def test_a_box_has_rectangles_for_sections_also_at_its_vertices() -> None:
    assert areas(MeshSections(box()), [-1.0, 0.0, 0.25, 1.0, 1.5]) == [0.0, 0.0, 1.0, 1.0, 0.0]


def test_holes_run_the_other_way_round() -> None:
    outer, inner = box(), box()
    hollow = TriangleMesh(
        np.concatenate([3 * outer.vertices, inner.vertices + 1]),
        np.concatenate([outer.triangles, inner.triangles[:, ::-1] + 8]),
    )
    assert areas(MeshSections(hollow), [0.5, 1.5, 2.5]) == pytest.approx([9, 8, 9])


def test_heights_may_come_a_few_at_a_time() -> None:
    whole = MeshSections(box())
    apart = MeshSections(box())
    assert areas(whole, [0.2, 0.8]) == areas(apart, [0.2]) + areas(apart, [0.8])
