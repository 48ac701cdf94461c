"""Fields made again only where their struts have changed."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.remade import Remade, groups_of
from scaffold_cad.solid.field import FieldStruts, field_solid, field_struts
from tests.solid.field.judges import check_exact

PAIR = np.array([[[0, 0, 0], [8, 0, 0]], [[4, 0, 0], [4, 6, 0]]], dtype=np.float64)


def pairs(*longer: float) -> FieldStruts:
    """Return pairs of struts that meet, far from each other, the first strut of each so longer."""
    ends = np.concatenate([PAIR + np.array([0, 0, 20.0 * k]) for k in range(len(longer))])
    ends[::2, 1, 0] += longer
    return field_struts(ends, 1.0)


def test_struts_that_come_near_each_other_are_one_group() -> None:
    assert groups_of(pairs(0, 0, 0)).tolist() == [0, 0, 1, 1, 2, 2]
    near = field_struts([[[0, 0, 0], [9, 0, 0]], [[0, 2.5, 0], [9, 2.5, 0]]], 1.0)
    assert groups_of(near).tolist() == [0, 0]


def test_only_groups_with_other_struts_are_made_again() -> None:
    asked: list[FieldStruts] = []

    def make(struts: FieldStruts) -> TriangleMesh:
        asked.append(struts)
        return field_solid(struts).mesh

    remade = Remade(make)
    first = remade.surface(pairs(0, 0, 0))
    second = remade.surface(pairs(0, 3, 0))
    assert [len(struts.radii) for struts in asked] == [6, 2]
    assert asked[1].ends[:, :, 2].tolist() == [[20, 20], [20, 20]]
    check_exact(second)
    assert second.signed_volume == pytest.approx(first.signed_volume + 3 * np.pi, rel=1e-3)
    stays = np.flatnonzero(first.vertices[:, 2] < 10)
    assert {*map(tuple, first.vertices[stays])} <= {*map(tuple, second.vertices)}
    assert remade.surface(pairs(0, 3, 0)).signed_volume == pytest.approx(second.signed_volume)
    assert len(asked) == 2


def test_groups_that_are_gone_have_no_surface() -> None:
    remade = Remade(lambda struts: field_solid(struts).mesh)
    both = remade.surface(pairs(0, 0))
    one = remade.surface(pairs(0))
    check_exact(one)
    assert one.signed_volume == pytest.approx(both.signed_volume / 2, rel=1e-3)
