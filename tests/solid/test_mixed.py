"""B-reps of struts some of which are crowded: facets there only, exact faces beside, one shell."""

from __future__ import annotations

import logging
from collections import Counter
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from scaffold_cad import to_brep, to_solid
from scaffold_cad.brep import brep_of_faces
from scaffold_cad.brep.analytic import AnalyticBrep, Surface
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.mixed import mixed_brep
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import RoundStruts, round_struts
from scaffold_cad.struts.breps.faces import brep_of_struts
from scaffold_cad.struts.options import Ends
from tests.skeletons import K4
from tests.solid.field.judges import distances

TIPS = [[20, 0, 0], [19, 3.4, 0], [-15, 8, 0], [-9, -10, 17]]
FOUR = [[0, i] for i in range(1, 5)]
NARROW = Skeleton([[0, 0, 0], *TIPS], FOUR, 1.0)
"""Four struts, two of them 10° apart: their node is crowded."""

TAPERS = Skeleton([[0, 0, 0], [20, 0, 0], [20, 2, 0], *TIPS[2:]], FOUR, [1.2, 0.5, 0.6, 1.8, 0.9])

CROSSING = Skeleton([[0, 0, 0], [40, 0, 0], [20, -16, 0.5], [20, 16, 0.5]], [[0, 1], [2, 3]], 1.0)
"""Two struts that cross in their middles."""

BESIDE = Skeleton(
    np.vstack([K4.nodes * 10, K4.nodes[:1] * 10 + [[40, 0, 0], [40, 5, 0]]]),
    np.vstack([K4.edges, [[0, 4], [0, 5]]]),
    0.3,
)

SKELETONS = {"narrow": NARROW, "tapers": TAPERS, "cross": CROSSING}


def kinds(faces: AnalyticBrep) -> Counter[Surface]:
    return Counter(Surface(kind) for kind in faces.faces.kinds.tolist())


def facets(faces: AnalyticBrep) -> int:
    """Return how many faces are triangles of clusters."""
    uses = np.diff(faces.faces.uses)[faces.faces.loops[:-1]]
    return int(((faces.faces.kinds == Surface.PLANE) & (uses == 3)).sum())


@pytest.mark.parametrize("ends", ["flat", "round"])
@pytest.mark.parametrize("skeleton", SKELETONS.values(), ids=SKELETONS)
def test_shells_are_closed_and_valid_with_the_volume_of_the_mesh(
    skeleton: Skeleton, ends: str
) -> None:
    struts = round_struts(skeleton, ends=ends)  # type: ignore[arg-type]
    assert len(struts.overlapping)
    faces = mixed_brep(struts)
    faces.check_closed()
    shape = brep_of_faces(faces)
    assert shape.is_valid
    assert len(shape.solids()) == 1
    assert shape.volume == pytest.approx(round_mesh(struts).signed_volume, rel=HOLLOW)
    assert kinds(faces)[Surface.SPHERE] == (4 if ends == "round" else 0)
    assert facets(faces) < 2000


@pytest.mark.parametrize("skeleton", SKELETONS.values(), ids=SKELETONS)
def test_struts_beside_clusters_have_their_radius_and_axis(skeleton: Skeleton) -> None:
    faces = mixed_brep(round_struts(skeleton))
    analytic = faces.faces.kinds[faces.faces.kinds < Surface.SPLINE]
    side = (analytic == Surface.CYLINDER) | (analytic == Surface.CONE)
    assert side.sum() == 4
    ends = skeleton.nodes[skeleton.edges]  # (m, 2, 3)
    for origin, axis, (radius, slant) in zip(
        faces.faces.axes.origin[side],
        faces.faces.axes.z[side],
        faces.faces.sizes[side],
        strict=True,
    ):
        off = np.linalg.norm(np.cross(ends - origin, axis), axis=2).max(axis=1)
        edge = int(off.argmin())
        assert off[edge] < 1e-12
        along = (ends[edge] - origin) @ axis
        own = radius + np.tan(slant) * along
        np.testing.assert_allclose(own, skeleton.edge_radii[edge], rtol=1e-12)


def test_polygons_lie_within_the_circles_of_their_struts() -> None:
    faces = mixed_brep(round_struts(CROSSING))
    count = np.diff(faces.faces.loops)
    rings = np.flatnonzero((faces.faces.kinds == Surface.PLANE) & (count == 2))
    assert len(rings) == 4
    for ring in rings.tolist():
        outer, inner = range(faces.faces.loops[ring], faces.faces.loops[ring + 1])
        uses = slice(faces.faces.uses[inner], faces.faces.uses[inner + 1])
        points = faces.vertices[np.unique(faces.edges.ends[faces.faces.edge[uses]])]
        middle, normal = faces.faces.axes.origin[ring], faces.faces.axes.z[ring]
        np.testing.assert_allclose((points - middle) @ normal, 0.0, atol=1e-12)
        away = np.linalg.norm(points - middle, axis=1)
        assert (away < 0.998).all()
        assert (away > 0.99).all()
        assert faces.faces.uses[outer + 1] - faces.faces.uses[outer] == 1  # one whole circle


def test_what_is_not_crowded_is_as_without_clusters() -> None:
    struts = round_struts(BESIDE)
    assert np.flatnonzero(struts.crowded).tolist() == [0]
    found, alone = kinds(mixed_brep(struts)), kinds(brep_of_struts(round_struts(K4)))
    # Three nodes of the four stay, with the struts between them.
    assert found[Surface.SPLINE] == alone[Surface.SPLINE] * 3 / 4
    assert found[Surface.CYLINDER] == alone[Surface.CYLINDER] + 2


def test_faces_are_named_after_struts_and_clusters() -> None:
    narrow = mixed_brep(round_struts(NARROW)).face_names
    assert set(narrow) == {
        "cluster of node 0",
        *(f"strut {k}" for k in range(4)),
        *(f"end {k}" for k in range(1, 5)),
    }
    crossing = mixed_brep(round_struts(CROSSING)).face_names
    assert Counter(crossing)["strut 0"] == 2
    assert "cluster of struts 0, 1" in crossing


def test_clusters_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    mixed_brep(round_struts(NARROW))
    assert len(caplog.records) == 1
    assert "plane facets at 1 cluster (cluster of node 0); all else is exact" in caplog.text


def test_what_is_all_crowded_is_all_facets() -> None:
    beside = Skeleton([[0, 0, 0], [9, 0, 0], [0, 1, 0], [9, 1, 0]], [[0, 1], [2, 3]], 1.0)
    struts = round_struts(beside)
    faces = mixed_brep(struts)
    faces.check_closed()
    assert kinds(faces) == {Surface.PLANE: len(faces.faces.kinds)}
    shape = brep_of_faces(faces)
    assert shape.is_valid
    assert shape.volume == pytest.approx(round_mesh(struts).signed_volume, rel=0.01)


def test_parts_that_do_not_touch_are_solids_of_their_own() -> None:
    apart = CROSSING.moved(CROSSING.nodes + np.array([0, 0, 50]))
    both = Skeleton(
        np.vstack([CROSSING.nodes, apart.nodes, [[0, 0, 90], [9, 0, 90]]]),
        np.vstack([CROSSING.edges, apart.edges + 4, [[8, 9]]]),
        1.0,
    )
    shape = brep_of_faces(mixed_brep(round_struts(both)))
    assert shape.is_valid
    assert len(shape.solids()) == 3


def test_where_nothing_is_crowded_all_faces_are_exact() -> None:
    struts = round_struts(K4)
    assert kinds(mixed_brep(struts)) == kinds(brep_of_struts(struts))


def test_curves_and_tori_beside_clusters_stay() -> None:
    angle = np.linspace(0, np.pi, 9)
    arc = np.stack([10 * np.cos(angle) - 30, 10 * np.sin(angle), 0 * angle], axis=1)
    nodes = np.vstack([NARROW.nodes, arc[::-1][1:] - [[0, -9, 0]], [[-15, 30, 0]]])
    edges = [*FOUR, *([i, i + 1] for i in range(5, 12)), [3, 13]]
    struts: RoundStruts = round_struts(Skeleton(nodes, edges, 1.0), bend="torus")
    faces = mixed_brep(struts)
    faces.check_closed()
    found = kinds(faces)
    assert found[Surface.TORUS] == 1
    assert found[Surface.SPLINE] > 0
    assert brep_of_faces(faces).is_valid


# --- hollow struts ---

HOLLOW = 0.012
"""Volume that facets may add: inside they are polygons in the circles, so that no wall is thin."""

OUTSIDE_ONLY = CROSSING.moved(CROSSING.nodes * [1, 1, 3])
"""Two struts that cross, with walls of 0.4 by their outsides only."""


@pytest.mark.parametrize(
    ("skeleton", "voids", "ends"),
    [
        pytest.param(NARROW, 1, "flat", id="narrow flat"),
        pytest.param(CROSSING, 1, "flat", id="cross flat"),
        pytest.param(CROSSING, 1, "open", id="cross open"),
        pytest.param(CROSSING, 1, "round", id="cross round"),
        pytest.param(OUTSIDE_ONLY, 2, "open", id="outside open"),
        pytest.param(OUTSIDE_ONLY, 2, "round", id="outside round"),
    ],
)
def test_hollow_struts_are_hollow_in_clusters_too(
    skeleton: Skeleton, voids: int, ends: str
) -> None:
    struts = round_struts(skeleton, wall=0.4, ends=ends)  # type: ignore[arg-type]
    faces = mixed_brep(struts)
    faces.check_closed()
    assert len(faces.solid) == 1 + (voids if ends != "open" else 0)
    shape = brep_of_faces(faces)
    assert shape.is_valid
    assert len(shape.solids()) == 1
    # Facets inside are a wall further along each strut than those outside.
    assert shape.volume == pytest.approx(round_mesh(struts).signed_volume, rel=HOLLOW)
    analytic = faces.faces.kinds[faces.faces.kinds < Surface.SPLINE]
    sizes = faces.faces.sizes[analytic == Surface.CYLINDER, 0]
    assert sorted(set(sizes.round(12).tolist())) == [0.6, 1.0]


@pytest.mark.parametrize("ends", ["flat", "round"])
def test_voids_are_in_their_own_strut_beside_a_larger_cluster(ends: Ends) -> None:
    beside = np.array([[18.0, 2, 4], [22, 7, 5]])
    nodes = np.concatenate([CROSSING.nodes, beside])
    turned = Rotation.from_rotvec([0.6, 0.5, 0.4]).apply(nodes)
    both = Skeleton(turned, np.concatenate([CROSSING.edges, [[4, 5]]]), 1.0)
    shape = brep_of_faces(mixed_brep(round_struts(both, wall=0.3, ends=ends)))
    assert sorted(len(solid.shells()) for solid in shape.solids()) == [2, 2]
    small = min(shape.solids(), key=lambda solid: float(solid.volume))
    length = float(np.linalg.norm(np.ptp(beside, axis=0)))
    caps = 4 / 3 * (1 - 0.7**3) if ends == "round" else 0.6 * 0.7**2
    assert small.volume == pytest.approx(np.pi * (length * (1 - 0.7**2) + caps), rel=1e-6)


@pytest.mark.parametrize("wall", [0.15, 0.06])
def test_facets_beside_exact_insides_keep_the_wall(
    wall: float, caplog: pytest.LogCaptureFixture
) -> None:
    near = CROSSING.moved(CROSSING.nodes * [1, 1, (2 - wall) / np.ptp(CROSSING.nodes[:, 2])])
    brep = mixed_brep(round_struts(near, wall=wall))
    shells = [shell.tessellate(0.001, 0.05) for shell in brep_of_faces(brep).shells()]
    meshes = [trimesh.Trimesh([tuple(one) for one in points], faces) for points, faces in shells]
    outside, *inside = sorted(meshes, key=lambda mesh: -float(mesh.scale))
    facets = np.concatenate([outside.vertices, outside.vertices[outside.edges_unique].mean(axis=1)])
    facets = facets[np.abs(facets - near.nodes.mean(axis=0)).max(axis=1) < 4]
    assert distances(facets, trimesh.util.concatenate(inside)).min() > 0.95 * wall
    assert "as thin as" not in caplog.text


def test_sockets_beside_clusters_stay_and_ends_in_clusters_are_closed() -> None:
    bored = round_struts(NARROW, wall=0.3, ends="open", sockets={3: (0.6, 2.0)})
    names = Counter(mixed_brep(bored).face_names)
    assert names["socket 3 inside"] == 1
    assert sum(count for name, count in names.items() if name.startswith("end")) == 5
    short = Skeleton([[0, 0, 0], [2.6, 0, 0], [2.6, 0.7, 0], *TIPS[2:]], FOUR, 1.0)
    struts = round_struts(short, wall=0.3, ends="open")
    faces = mixed_brep(struts)
    assert {name for name in faces.face_names if "end" in name} == {"end 3", "end 4"}
    shape = brep_of_faces(faces)
    assert shape.is_valid
    assert shape.volume == pytest.approx(round_mesh(struts).signed_volume, rel=HOLLOW)


@pytest.mark.parametrize("options", [{}, {"wall": 0.6, "ends": "open"}])
def test_sharp_nodes_stay_exact_beside_a_crowded_one(options: dict[str, Any]) -> None:
    nodes = [[0, 0, 0], [20, 0, 0], [20, 3, 0.5], [0, 20, 0], [0, 0, 20]]
    nodes += [[-30, 0, 0], [-30, 20, 0], [-50, 0, 0], [-30, 0, 25]]
    edges = [[0, 1], [0, 2], [0, 3], [0, 4], [0, 5], [5, 6], [5, 7], [5, 8]]
    struts = round_struts(Skeleton(nodes, edges, 2.0), nodes="sharp", **options)
    assert np.flatnonzero(struts.crowded).tolist() == [0]
    solid = to_brep(struts, overlaps="unite")
    assert solid.is_valid
    most = HOLLOW if options else 5e-3
    assert solid.volume == pytest.approx(to_solid(struts, sides=32).volume(), rel=most)
    cylinders = [face for face in solid.faces() if face.geom_type.name == "CYLINDER"]
    assert len(cylinders) == (12 if options else 6)


@pytest.mark.parametrize(("skeleton", "wall"), [(NARROW, 0.4), (CROSSING, 0.2)])
def test_facets_of_hollow_clusters_keep_the_wall(skeleton: Skeleton, wall: float) -> None:
    shape = to_brep(round_struts(skeleton, wall=wall), overlaps="unite")
    meshes = []
    for shell in shape.shells():
        points, corners = shell.tessellate(0.01, 0.1)
        meshes.append(trimesh.Trimesh([tuple(point) for point in points], corners))
    inside, outside = sorted(meshes, key=lambda mesh: float(mesh.scale))
    walls = distances(np.concatenate([inside.vertices, inside.triangles_center]), outside)
    assert walls.min() > 0.95 * wall
    assert np.median(walls) == pytest.approx(wall, rel=0.02)


def test_open_struts_beside_those_that_cross_are_solids_of_their_own() -> None:
    tube = [[0, 0, 30], [0, 0, 50]]
    both = Skeleton([*CROSSING.nodes, *tube], [*CROSSING.edges, [4, 5]], 1.0)
    solids = to_brep(round_struts(both, wall=0.6, ends="open"), overlaps="unite").solids()
    assert [solid.is_valid for solid in solids] == [True, True]
    assert min(solid.volume for solid in solids) == pytest.approx(np.pi * 0.84 * 20)
