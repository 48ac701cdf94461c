"""Faces of round struts: how many, closed, named, and of the radii asked for."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.brep.analytic import Surface
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import Ends, round_struts
from scaffold_cad.struts.breps.faces import brep_of_struts
from tests.skeletons import BCC_STAR, CUBE, ELBOW, JACK, K4, NAMED, STRUT, TAPER, TWO_STRUTS

STICK = NAMED["stick_figure"]


@pytest.mark.parametrize("ends", ["flat", "round"])
@pytest.mark.parametrize(
    "skeleton",
    [STRUT, TAPER, ELBOW, JACK, BCC_STAR, K4, CUBE, TWO_STRUTS, STICK],
    ids=["strut", "taper", "elbow", "jack", "bcc", "k4", "cube", "two", "stick"],
)
def test_shells_are_closed_and_faces_counted(skeleton: Skeleton, ends: Ends) -> None:
    struts = round_struts(skeleton, ends=ends)
    faces = brep_of_struts(struts)
    faces.check_closed()
    kinds = faces.faces.kinds
    runs, valency = struts.runs, struts.runs.valency
    assert ((kinds == Surface.CYLINDER) | (kinds == Surface.CONE)).sum() == len(runs.edges)
    assert (kinds == Surface.SPLINE).sum() == 4 * valency[valency > 1].sum()
    cap = Surface.PLANE if ends == "flat" else Surface.SPHERE
    assert (kinds == cap).sum() == len(skeleton.extremities)
    assert len(np.unique(faces.faces.shell)) == skeleton.component_count


def test_radii_and_axes_are_those_of_the_skeleton() -> None:
    faces = brep_of_struts(round_struts(K4))
    cylinders = faces.faces.kinds[faces.faces.kinds != Surface.SPLINE] == Surface.CYLINDER
    assert cylinders.sum() == 6
    np.testing.assert_allclose(faces.faces.sizes[cylinders, 0], K4.radii[0], rtol=1e-15)
    axes, origins = faces.faces.axes.z[cylinders], faces.faces.axes.origin[cylinders]
    ends = K4.nodes[K4.edges]
    for axis, origin in zip(axes, origins, strict=True):
        off = np.linalg.norm(np.cross(ends - origin, axis), axis=2).max(axis=1)  # of each edge
        assert np.sort(off)[0] < 1e-12


def test_cones_have_the_taper_of_their_strut() -> None:
    faces = brep_of_struts(round_struts(TAPER))
    (size,) = faces.faces.sizes[
        faces.faces.kinds[faces.faces.kinds != Surface.SPLINE] == Surface.CONE
    ]
    taper = abs(TAPER.radii[1] - TAPER.radii[0]) / TAPER.lengths[0]
    assert np.tan(abs(size[1])) == pytest.approx(taper, rel=1e-12)


def test_faces_are_named_after_struts_nodes_and_ends() -> None:
    names = brep_of_struts(round_struts(JACK)).face_names
    assert sorted(set(names)) == sorted(
        [*(f"strut {k}" for k in range(6)), "node 0", *(f"end {k}" for k in range(1, 7))]
    )
    assert names.count("node 0") == 24


def test_a_chain_that_goes_straight_on_is_one_cylinder() -> None:
    line = Skeleton([[0, 0, 0], [5, 0, 0], [9, 0, 0]], [[0, 1], [1, 2]], 1.0)
    faces = brep_of_struts(round_struts(line))
    assert faces.face_names == ["end 0", "end 2", "strut 0"]


@pytest.mark.parametrize("name", ["k4", "cube", "bcc_star"])
def test_vertices_of_rings_are_on_their_circles(name: str) -> None:
    skeleton = NAMED[name]
    faces = brep_of_struts(round_struts(skeleton))
    lines, circles, _ = faces.edges.counts
    ends = faces.vertices[faces.edges.ends[lines : lines + circles]]  # (c, 2, 3)
    away = np.linalg.norm(ends - faces.edges.circles.origin[:, None], axis=2)
    np.testing.assert_allclose(away, np.stack([faces.edges.radii] * 2, axis=1), rtol=1e-12)
