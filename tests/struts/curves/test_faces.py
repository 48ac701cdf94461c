"""Faces of curves: four splines a curve, as read back from STEP."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from build123d import GeomType, Shape, import_step
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.gp import gp_Pnt, gp_Vec

from scaffold_cad.io.write import write
from scaffold_cad.products import to_brep
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.breps.faces import brep_of_struts
from scaffold_cad.struts.meshes.surface import triangulated
from tests.skeletons import TREFOIL
from tests.struts.chains import HOOK, TAPERED, circle, helix

CHAINS = {"trefoil": TREFOIL, "tapered": TAPERED, "hook": HOOK, "helix": helix(60)}


def read_back(skeleton: Skeleton, folder: Path) -> Shape:
    write(round_struts(skeleton), folder / "curve.step")
    return import_step(folder / "curve.step")


def at(surface: object, u: float, v: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the point and the unit normal of a surface of OCCT."""
    point, by_u, by_v = gp_Pnt(), gp_Vec(), gp_Vec()
    surface.D1(u, v, point, by_u, by_v)  # type: ignore[attr-defined]
    normal = np.cross(*([one.X(), one.Y(), one.Z()] for one in (by_u, by_v)))
    return np.array([point.X(), point.Y(), point.Z()]), normal / np.linalg.norm(normal)


@pytest.mark.parametrize("name", CHAINS)
def test_curves_are_valid_solids_with_few_faces(name: str, tmp_path: Path) -> None:
    skeleton = CHAINS[name]
    shape = read_back(skeleton, tmp_path)
    assert shape.is_valid
    assert len(shape.solids()) == 1
    splines = [face for face in shape.faces() if face.geom_type == GeomType.BSPLINE]
    assert len(splines) == (8 if skeleton is TREFOIL else 4)
    assert len(shape.faces()) == 8  # of open curves, with two straight ends and their discs
    mesh = triangulated(round_struts(skeleton), 48).mesh
    assert shape.volume == pytest.approx(mesh.signed_volume, rel=1e-3)


@pytest.mark.parametrize("name", CHAINS)
def test_circles_and_normals_at_joints_survive_the_file(name: str, tmp_path: Path) -> None:
    skeleton = CHAINS[name]
    joints, radii = skeleton.nodes, skeleton.radii
    seen = set()
    for face in read_back(skeleton, tmp_path).faces():
        if face.geom_type != GeomType.BSPLINE:
            continue
        surface = BRepAdaptor_Surface(face.wrapped).BSpline()
        for number in range(2, surface.NbVKnots()):
            v = surface.VKnot(number)
            for u in np.linspace(0, 1, 7).tolist():
                point, normal = at(surface, u, v)
                away = np.linalg.norm(joints - point, axis=1)
                node = int(np.abs(away - radii).argmin())
                assert away[node] == pytest.approx(radii[node], rel=1e-6)
                for side in (-1e-9, 1e-9):
                    assert np.degrees(np.linalg.norm(at(surface, u, v + side)[1] - normal)) < 1e-3
                seen.add(node)
    assert len(seen) >= len(skeleton.joints) - 2


def test_a_circle_has_the_volume_of_its_torus() -> None:
    assert to_brep(round_struts(circle(24))).volume == pytest.approx(2 * np.pi**2 * 10, rel=2e-5)


def test_hollow_curves_have_an_inside(tmp_path: Path) -> None:
    for skeleton, ends in ((helix(60), "open"), (TREFOIL, "flat")):
        struts = round_struts(skeleton, wall=0.3, ends=ends)  # type: ignore[arg-type]
        write(struts, tmp_path / "hollow.step")
        shape = import_step(tmp_path / "hollow.step")
        assert shape.is_valid
        solid = to_brep(round_struts(skeleton)).volume
        assert shape.volume == pytest.approx((1 - 0.7**2) * solid, rel=2e-3)


def test_faces_are_named_by_their_lowest_joint() -> None:
    names = brep_of_struts(round_struts(HOOK)).face_names
    assert names.count("curve 1") == 4
    assert sorted(set(names)) == ["curve 1", "end 0", "end 13", "strut 0", "strut 12"]
