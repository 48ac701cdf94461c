"""Struts that reach into a body: a lattice, a foam or one's own, cut flush or under a skin."""

from __future__ import annotations

import build123d as bd
import manifold3d
import numpy as np
import pytest
import trimesh

from scaffold_cad import (
    Skeleton,
    lattice_part,
    round_struts,
    strut_part,
    strut_solid,
    tile,
    voronoi_foam,
)
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling.cleaning import without_crumbs, without_pockets
from scaffold_cad.filling.flush import flush_box, trimmed_box
from scaffold_cad.filling.models import sided_maker
from scaffold_cad.filling.reaching import movable
from scaffold_cad.mesh.pieces import pieces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.manifolds import manifold_triangles, to_manifold
from tests.meshes import CUBE

BOX = [[-12.0, -12.0, -8.0], [12.0, 12.0, 8.0]]


@pytest.mark.parametrize("sides", [4, 8])
def test_a_lattice_without_a_skin_is_cut_flush_as_in_a_box(sides: int) -> None:
    body = trimesh.creation.box((24.0, 24.0, 16.0))
    part = lattice_part(body, "bcc", 8.0, 0.6, sides=sides)
    flush = flush_box(BOX, "bcc", 8.0, 0.6, sides=sides)
    assert part.volume() == pytest.approx(flush.volume(), rel=1e-5)
    np.testing.assert_allclose(part.bounding_box(), np.ravel(BOX), rtol=0, atol=1e-6)


def test_struts_reach_the_ends_of_a_part_as_if_they_went_on() -> None:
    # Layers of cells are alike: the end is cut through nodes as the plane between layers is.
    body = bd.Solid.make_cylinder(12.0, 16.0)
    part = lattice_part(body, "bcc", 8.0, 0.6, sides=16)
    end, middle = (part.slice(z).area() for z in (0.01, 8.01))
    assert end == pytest.approx(middle, rel=1e-3)


def test_a_foam_fills_a_body_under_a_skin() -> None:
    foam = voronoi_foam(None, [[-15] * 3, [15] * 3], 0.6, size=6, regularity=0.6)
    ball = trimesh.creation.icosphere(3, 10.0)
    part = strut_part(ball, foam, skin=1.0)
    pieces = pieces_of(manifold_triangles(part))
    assert (pieces.volumes > 0).sum() == 1
    assert pieces.volumes.max() == pytest.approx(ball.volume, rel=1e-5)
    wall = ball.volume * (1 - 0.9**3)
    assert wall < part.volume() < 0.6 * ball.volume


def test_struts_of_their_own_radii_fill_a_solid() -> None:
    cross = Skeleton(
        [[-9, 0, 0], [9, 0, 0], [0, 0, -9], [0, 0, 9], [0, 0, 0]],
        [[0, 4], [4, 1], [2, 4], [4, 3]],
        1.0,
    ).with_edge_radii([1.0, 1.0, 1.5, 1.5])
    part = strut_solid(bd.Box(16, 16, 16), cross, skin=1.5)
    assert part.is_valid
    radii = {round(face.radius, 9) for face in part.faces().filter_by(bd.GeomType.CYLINDER)}
    assert radii == {1.0, 1.5}
    of_triangles = strut_part(bd.Box(16, 16, 16), cross, skin=1.5, section="round", sides=32)
    assert of_triangles.volume() == pytest.approx(part.volume, rel=2e-3)


def test_struts_beside_the_body_are_no_filling() -> None:
    lattice = tile("bcc", 8.0, 2, radius=0.5)
    body = trimesh.creation.box((10.0, 10.0, 10.0))
    for struts in (lattice.moved(lattice.nodes + 100.0), lattice.with_edges([])):
        with pytest.raises(SkeletonError, match=r"no strut is in the body from \[-5, -5, -5\] mm"):
            strut_part(body, struts)
    with pytest.raises(OptionError, match="need a Skeleton"):
        strut_part(body, round_struts(lattice))  # type: ignore[arg-type]


def test_struts_beside_a_box_are_not_trimmed() -> None:
    away = movable(tile("bcc", 8.0, 2, radius=0.5))
    with pytest.raises(SkeletonError, match=r"no strut is in the box from \[90, 90, 90\] mm"):
        trimmed_box([[90] * 3, [99] * 3], away, sided_maker(4), 4)


def test_rods_right_through_a_body_stay() -> None:
    rod = Skeleton([[-9, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    body = trimesh.creation.box((10.0, 10.0, 10.0))
    assert strut_part(body, rod, sides=32).volume() == pytest.approx(np.pi * 10, rel=1e-6)
    part = strut_part(body, rod, sides=32, skin=1.0)
    assert part.volume() == pytest.approx(1000 - 8**3 + np.pi * 8, rel=1e-6)


def test_struts_of_a_lattice_right_through_a_body_need_a_skin() -> None:
    body = trimesh.creation.box((4.0, 10.0, 4.0))
    with pytest.raises(SkeletonError, match=r"the middles of 1 alone are.*need nodes in it"):
        lattice_part(body, "sc", 16.0, 0.2, origin=[0.0, -8.0, 0.0])
    part = lattice_part(body, "sc", 16.0, 0.2, origin=[0.0, -8.0, 0.0], skin=1.0, sides=32)
    assert part.volume() == pytest.approx(160 - 32 + np.pi * 0.2**2 * 8, rel=1e-5)


def cubes(*placed: tuple[float, float, bool]) -> TriangleMesh:
    """Return cubes of a side, along x from where they begin, or voids of that shape."""
    count = len(CUBE.vertices)
    low = CUBE.vertices.min(axis=0)
    side = float(np.ptp(CUBE.vertices[:, 0]))
    points = [(CUBE.vertices - low) / side * size + [at, 0.1, 0.1] for at, size, _ in placed]
    faces = [
        k * count + (CUBE.triangles[:, ::-1] if void else CUBE.triangles)
        for k, (_, _, void) in enumerate(placed)
    ]
    return TriangleMesh(np.concatenate(points), np.concatenate(faces))


def test_crumbs_go_and_voids_stay() -> None:
    part = to_manifold(cubes((0, 10, False), (1, 5, True), (12, 1, False), (12.2, 0.5, True)))
    left = without_crumbs(part)
    assert left.volume() == pytest.approx(1000 - 125, rel=1e-6)
    assert sorted(pieces_of(manifold_triangles(left)).volumes) == pytest.approx([-125, 1000])


def test_voids_stay_that_only_the_box_of_a_crumb_holds() -> None:
    whole = to_manifold(cubes((0, 10, False), (7, 2, True)))  # the void is at [7, 0.1, 0.1]
    bars = [
        manifold3d.Manifold.cube(sides).translate(place)
        for sides, place in (((8, 0.2, 0.2), (6, 11, -1)), ((0.2, 14, 0.2), (13.8, -2, -1)))
    ]
    bars.append(manifold3d.Manifold.cube((0.2, 0.2, 6)).translate((13.8, -2, -1)))
    left = without_crumbs(whole + bars[0] + bars[1] + bars[2])
    assert sorted(pieces_of(manifold_triangles(left)).volumes) == pytest.approx([-8, 1000])


def test_pockets_go_and_other_voids_stay(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    part = to_manifold(cubes((0, 10, False), (1, 5, True), (7, 0.5, True)))
    left = without_pockets(part, 1.0)
    assert left.volume() == pytest.approx(1000 - 125, rel=1e-6)
    assert "1 closed pocket of 0.125 mm³ filled" in caplog.text
    assert without_pockets(part, 0.5).volume() == part.volume()
