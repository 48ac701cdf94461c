"""Analytic B-reps of round struts: as OCCT builds them, and as it reads them from STEP files."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad.errors import BrepError
from scaffold_cad.io.write import write
from scaffold_cad.products.breps import to_brep
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.struts import Ends, round_struts
from scaffold_cad.struts.breps.faces import brep_of_struts
from tests.skeletons import CUBE, ELBOW, JACK, K4, NAMED, STRUT, TAPER, TRIPOD, TWO_STRUTS

bd = pytest.importorskip("build123d")

CLOSED = {
    "elbow": ELBOW,
    "tripod": TRIPOD,
    "jack": JACK,
    "k4": K4,
    "cube": CUBE,
    "bcc_star": NAMED["bcc_star"],
    "stick_figure": NAMED["stick_figure"],
}


def frustum(strut: Skeleton) -> float:
    """Return the volume of a strut between flat ends, mm³."""
    a, b = strut.radii
    return float(np.pi * strut.lengths[0] * (a**2 + a * b + b**2) / 3)


@pytest.mark.parametrize(
    ("skeleton", "ends", "volume"),
    [
        (STRUT, "flat", 10 * np.pi),
        (STRUT, "round", 10 * np.pi + 4 / 3 * np.pi),
        (TAPER, "flat", frustum(TAPER)),
    ],
    ids=["cylinder", "capsule", "frustum"],
)
def test_volumes_in_closed_form(skeleton: Skeleton, ends: Ends, volume: float) -> None:
    solid = to_brep(round_struts(skeleton, ends=ends))
    assert solid.is_valid
    assert solid.is_manifold or ends == "round"  # for build123d no sphere is: its poles are edges
    assert solid.volume == pytest.approx(volume, rel=1e-9)


def test_round_ends_of_a_cone_are_parts_of_spheres() -> None:
    solid = to_brep(round_struts(TAPER, ends="round"))
    assert solid.is_valid
    kinds = sorted(face.geom_type.name for face in solid.faces())
    assert kinds == ["CONE", "SPHERE", "SPHERE"]
    (a, b), length = TAPER.radii, TAPER.lengths[0]
    slope = (b - a) / length
    spheres = sorted(face.radius for face in solid.faces().filter_by(bd.GeomType.SPHERE))
    assert spheres == pytest.approx(sorted([a * np.hypot(1, slope), b * np.hypot(1, slope)]))
    caps = 0.0
    for radius, outward in ((a, -slope), (b, slope)):
        size, center = radius * np.hypot(1, slope), radius * outward
        height = size + center  # from the circle to the tip
        caps += np.pi * height**2 * (3 * size - height) / 3
    assert solid.volume == pytest.approx(frustum(TAPER) + caps, rel=1e-9)


@pytest.mark.parametrize("skeleton", CLOSED.values(), ids=CLOSED)
def test_solids_are_valid_and_their_cylinders_exact(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    solid = to_brep(struts)
    assert solid.is_valid
    assert solid.is_manifold
    assert len(solid.solids()) == 1
    cylinders = solid.faces().filter_by(bd.GeomType.CYLINDER)
    exact = struts.runs.slopes[0::2] == 0
    np.testing.assert_allclose(
        sorted(face.radius for face in cylinders), np.sort(struts.runs.radii[exact, 0]), rtol=1e-15
    )
    assert len(solid.faces().filter_by(bd.GeomType.CONE)) == (~exact).sum()
    mesh = to_solid(struts, sides=64)
    assert solid.volume == pytest.approx(mesh.volume(), rel=0.005)


def axes_of(shape: Any) -> np.ndarray:
    """Return the radius of each cylinder, a point of its axis, and the axis, shape (c, 7)."""
    rows = []
    for face in shape.faces().filter_by(bd.GeomType.CYLINDER):
        axis = face.axis_of_rotation
        rows.append([face.radius, *tuple(axis.position), *tuple(axis.direction)])
    return np.array(rows).reshape(-1, 7)


@pytest.mark.parametrize("ends", ["flat", "round"])
@pytest.mark.parametrize("skeleton", CLOSED.values(), ids=CLOSED)
def test_step_files_read_back_as_one_valid_solid(
    skeleton: Skeleton, ends: Ends, tmp_path: Path
) -> None:
    struts = round_struts(skeleton, ends=ends)
    path = tmp_path / "struts.step"
    write(struts, path)
    read = bd.import_step(path)
    (solid,) = read.solids()
    assert solid.is_valid
    assert solid.volume == pytest.approx(to_brep(struts).volume, rel=1e-7)
    starts, spans = (skeleton.nodes[skeleton.edges[:, k]] for k in (0, 1))
    spans = spans - starts
    exact = struts.runs.slopes[0::2] == 0
    found = axes_of(solid)
    assert len(found) == exact.sum()
    for radius, *axis in found:
        place, ahead = np.array(axis[:3]), np.array(axis[3:])
        off = np.linalg.norm(np.cross(starts - place, ahead), axis=1)
        off += np.linalg.norm(np.cross(spans, ahead), axis=1)
        edge = int(off.argmin())
        assert off[edge] < 1e-9
        assert radius == pytest.approx(skeleton.radii[skeleton.edges[edge, 0]], abs=1e-9)


def test_faces_of_step_files_are_named(tmp_path: Path) -> None:
    struts = round_struts(TRIPOD)
    write(struts, tmp_path / "named.step")
    text = (tmp_path / "named.step").read_text(encoding="ascii")
    names = re.findall(r"ADVANCED_FACE\('(.*?)'", text)
    assert sorted(names) == sorted(brep_of_struts(struts).face_names)
    assert text.count("CYLINDRICAL_SURFACE") == 3


@pytest.mark.parametrize("suffix", [".step", ".brep"])
def test_separate_parts_are_separate_solids(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"two{suffix}"
    write(round_struts(TWO_STRUTS), path)
    read = bd.import_step(path) if suffix == ".step" else bd.import_brep(path)
    assert [solid.volume for solid in read.solids()] == pytest.approx([10 * np.pi] * 2)


def test_step_files_need_no_cad_kernel(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from scaffold_cad import Skeleton, round_struts, write\n"
        "strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)\n"
        "write(round_struts(strut), sys.argv[1])\n"
        "print({'build123d', 'OCP'} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "strut.step")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "set()"


def test_shells_are_shells() -> None:
    shell = to_brep(round_struts(TRIPOD), "shell")
    assert isinstance(shell, bd.Shell)
    assert shell.is_valid


def test_normals_agree_across_collars() -> None:
    solid = to_brep(round_struts(TRIPOD))
    cylinders = solid.faces().filter_by(bd.GeomType.CYLINDER)
    others = (bd.GeomType.CYLINDER, bd.GeomType.PLANE)
    patches = [face for face in solid.faces() if face.geom_type not in others]
    assert len(patches) == 12
    looked_at = 0
    for face in cylinders:
        for edge in face.edges().filter_by(bd.GeomType.CIRCLE):
            place = edge @ 0.3
            for patch in patches:
                if any(one.is_same(edge) for one in patch.edges()):
                    turn = face.normal_at(place).get_angle(patch.normal_at(place))
                    assert turn < 1e-3  # degrees
                    looked_at += 1
    assert looked_at >= 12


def test_open_shells_are_named_by_their_edge() -> None:
    faces = brep_of_struts(round_struts(STRUT))
    forward = faces.faces.forward.copy()
    forward[0] = not forward[0]
    wrong = replace(faces, faces=replace(faces.faces, forward=forward))
    with pytest.raises(BrepError, match=r"edge \d+ from \[.*\] mm is used .* times forward and"):
        wrong.check_closed()


@pytest.mark.parametrize("options", [{}, {"nodes": "ball"}, {"nodes": "sharp"}, {"wall": 40.0}])
def test_solids_of_large_radii_are_valid(options: dict[str, Any]) -> None:
    turns = np.array([0, 0.3, 0.6])
    spring = np.stack([9000 + 900 * np.cos(turns), 900 * np.sin(turns), 300 * turns], axis=1)
    nodes = [*(600 * TRIPOD.nodes), *spring]
    edges = [*TRIPOD.edges, [4, 5], [5, 6]]
    frame = Skeleton(nodes, edges, 1.0).with_edge_radii([500, 400, 300, 90, 90])
    assert to_brep(round_struts(frame, **options)).is_valid
