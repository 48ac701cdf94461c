"""Seams: tubes that are cut off at planes and joined to rings, also beside folds."""

import numpy as np
import pytest

from scaffold_cad.base.arrays import Points
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.remainder import Cuts
from scaffold_cad.solid.clusters.seams import Seamed, seamed
from scaffold_cad.solid.clusters.spans import CUT

AROUND = 24
HEIGHTS = np.array([-0.8, -0.4, 0.02, 0.24, 0.32, 0.44])
"""Rings of vertices: the largest gap in the window of planes is that from the third to the fourth,
the second largest that to the fifth."""

CUTS = Cuts(
    span=np.zeros(1, dtype=np.intp),
    base=np.zeros((1, 3)),
    outward=np.array([[0.0, 0.0, 1.0]]),
    radius=np.ones(1),
    slope=np.zeros(1),
    node=np.zeros(1, dtype=np.intp),
)
RING = np.arange(8)[None]
ANGLE = np.pi / 4 * np.arange(8)
POINTS: Points = np.stack([np.cos(ANGLE), np.sin(ANGLE), np.full(8, CUT)], axis=1)


def tube(folded: list[int], past: float = 0.5) -> TriangleMesh:
    """Return a tube of radius 1 about z, closed at its ends, with some rings that turn back.

    There one vertex is `past` the next one, in sides.
    """
    step = 2 * np.pi / AROUND
    angle = np.tile(step * np.arange(AROUND), (len(HEIGHTS), 1))  # (rings, AROUND)
    angle[folded, 7] += (1.0 + past) * step
    height = np.repeat(HEIGHTS[:, None], AROUND, axis=1)
    rings = np.stack([np.cos(angle), np.sin(angle), height], axis=2).reshape(-1, 3)
    low = np.arange(len(rings) - AROUND).reshape(-1, AROUND)
    ahead = np.roll(low, -1, axis=1)
    sides = [(low, ahead, ahead + AROUND), (low, ahead + AROUND, low + AROUND)]
    tips = np.array([[0.0, 0.0, HEIGHTS[0] - 0.5], [0.0, 0.0, HEIGHTS[-1] + 0.5]])
    bottom, top = low[0], low[-1] + AROUND
    sides += [(np.roll(bottom, -1), bottom, np.full(AROUND, len(rings)))]
    sides += [(top, np.roll(top, -1), np.full(AROUND, len(rings) + 1))]
    triangles = [np.stack(side, axis=-1).reshape(-1, 3) for side in sides]
    points = np.concatenate([rings, tips]).astype(np.float32)
    return TriangleMesh(points, np.concatenate(triangles))


def seam_of(folded: list[int], past: float = 0.5) -> Seamed:
    return seamed(tube(folded, past), CUTS, POINTS, RING, np.array([[1.0, 0.0, 0.0]]))


def open_sides(made: Seamed) -> int:
    t = made.triangles
    ends = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    count = len(POINTS) + len(made.vertices)
    forth, back = ends @ [count, 1], ends @ [1, count]
    assert len(np.unique(forth)) == len(forth)
    return int((~np.isin(forth, back)).sum())


@pytest.mark.parametrize(("folded", "low", "high"), [([], 0.02, 0.24), ([2], 0.24, 0.32)])
def test_tubes_are_cut_at_the_largest_gap_without_a_fold(
    folded: list[int], low: float, high: float
) -> None:
    made = seam_of(folded)
    assert made.failed.tolist() == []
    assert open_sides(made) == len(POINTS)  # open at the ring only
    used = np.unique(made.triangles)
    tall = np.concatenate([POINTS, made.vertices])[used, 2]
    loop = tall[(tall > low + 0.01) & (tall < high - 0.01)]
    assert len(loop) == 2 * AROUND  # each side and each diagonal of the gap is cut
    np.testing.assert_allclose(loop, (low + high) / 2, atol=1e-6)
    assert np.sort(tall[tall > high]).tolist() == [pytest.approx(CUT)] * len(POINTS)
    if not folded:
        mesh = TriangleMesh(np.concatenate([POINTS, made.vertices]), made.triangles)
        assert len(self_intersections(mesh)) == 0


def test_where_every_gap_has_a_fold_seams_fail() -> None:
    assert seam_of([2, 3, 4]).failed.tolist() == [0]


def test_slivers_in_every_gap_are_drawn_together() -> None:
    made = seam_of([2, 3, 4, 5], past=0.02)
    assert made.failed.tolist() == []
    assert open_sides(made) == len(POINTS)
    mesh = TriangleMesh(np.concatenate([POINTS, made.vertices]), made.triangles)
    assert len(self_intersections(mesh)) == 0
    assert len(self_intersections(tube([2, 3, 4, 5], past=0.02))) > 0
