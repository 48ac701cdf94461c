"""show() finds the viewer at hand and gives it what it takes, under the right name."""

from __future__ import annotations

import logging
import subprocess
import sys
from importlib.util import find_spec
from types import ModuleType, SimpleNamespace
from typing import Any

import build123d as bd
import numpy as np
import pytest

from scaffold_cad.brep.g1 import smooth_patches
from scaffold_cad.errors import BrepError, MissingBackendError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision import catmull_clark
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products import to_trimesh
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import Solidified
from scaffold_cad.solid.manifolds import to_manifold
from scaffold_cad.struts import round_struts
from scaffold_cad.viewers import show, to_cadquery, to_shape
from tests.meshes import CUBE
from tests.skeletons import STICK_FIGURE, TRIPOD

HAS_CADQUERY = find_spec("cadquery") is not None


class Viewer(ModuleType):
    """An OCP CAD Viewer as far as `show` sees it."""

    def __init__(self, name: str, port: int | None) -> None:
        super().__init__(name)
        self.port = port
        self.shown: list[tuple[Any, str]] = []

    def get_port(self) -> int | None:
        return self.port

    def show_object(self, what: Any, name: str) -> None:
        self.shown.append((what, name))


@pytest.fixture(autouse=True)
def no_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is at hand unless a test says so."""
    for name in ("ocp_vscode", "ocp_viewer", "IPython"):
        monkeypatch.setitem(sys.modules, name, None)  # as if not installed
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr("scaffold_cad.viewers.hosts.find_spec", lambda name: None)


def open_viewer(monkeypatch: pytest.MonkeyPatch, name: str, port: int | None = 3939) -> Viewer:
    viewer = Viewer(name, port)
    monkeypatch.setitem(sys.modules, name, viewer)
    return viewer


def test_viewers_are_imported_without_build123d() -> None:
    program = (
        "import sys, scaffold_cad.viewers; "
        "print({'build123d', 'OCP', 'IPython', 'cadquery', 'ocp_vscode'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr


# --- what is shown ---


def test_skeleton_is_shown_by_its_edges() -> None:
    assert len(to_shape(STICK_FIGURE).edges()) == len(STICK_FIGURE.edges)


CROSSING = Skeleton([[0, 0, 0], [20, 0, 0], [10, -8, 0.5], [10, 8, 0.5]], [[0, 1], [2, 3]], 1.0)


def test_scaffold_is_shown_by_its_faces() -> None:
    scaffold = build_scaffold(TRIPOD)
    assert len(to_shape(scaffold).faces()) == len(scaffold.mesh.quads)


@pytest.mark.parametrize("make", [build_scaffold, round_struts])
def test_struts_that_overlap_are_shown_by_the_one_rule(
    make: Any, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    crossing = make(CROSSING)
    assert len(to_shape(crossing).faces()) == 1
    assert [record.levelname for record in caplog.records] == ["INFO"]
    with pytest.raises(BrepError, match="2 of 2 struts overlap others"):
        to_shape(crossing, overlaps="refuse")
    caplog.clear()
    assert len(to_shape(crossing, overlaps="allow").faces()) > 1
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    with pytest.raises(OptionError, match="did you mean 'unite'"):
        to_shape(crossing, overlaps="unit")  # type: ignore[arg-type]


def test_patches_are_shown_by_their_faces() -> None:
    patches = smooth_patches(build_scaffold(TRIPOD).mesh)
    assert len(to_shape(patches).faces()) == len(patches.bezier.quads)
    assert len(to_shape(patches.bezier).faces()) == len(patches.bezier.quads)


def test_round_struts_are_shown_by_their_faces() -> None:
    shape = to_shape(round_struts(TRIPOD))
    assert len(shape.faces().filter_by(bd.GeomType.CYLINDER)) == 3
    assert shape.is_valid


def test_many_round_struts_are_shown_as_triangles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.viewers.shapes.MOST_STRUTS", 2)
    assert len(to_shape(round_struts(TRIPOD)).faces()) == 1


@pytest.mark.parametrize(
    "mesh_of",
    [
        to_manifold,
        lambda mesh: Solidified(to_manifold(mesh), np.zeros(0, dtype=np.intp), []),
        lambda mesh: TriangleMesh(mesh.vertices, mesh.triangles),
        to_trimesh,
    ],
    ids=["manifold", "solidified", "triangles", "trimesh"],
)
def test_triangles_are_shown_as_triangles(mesh_of: Any) -> None:
    shape = to_shape(mesh_of(CUBE))
    assert isinstance(shape, bd.Face)
    assert len(shape.tessellate(0.1)[1]) == 12


def test_many_quads_are_shown_as_triangles(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = catmull_clark(build_scaffold(TRIPOD).mesh, 1)
    assert len(to_shape(mesh).faces()) == len(mesh.mesh.quads)
    monkeypatch.setattr("scaffold_cad.viewers.shapes.MOST_QUADS", len(mesh.mesh.quads) - 1)
    assert len(to_shape(mesh).faces()) == 1


def test_quads_that_are_no_faces_are_shown_as_triangles() -> None:
    thin = QuadMesh(CUBE.vertices * [1.0, 1.0, 1e-8], CUBE.quads)
    assert len(to_shape(thin).tessellate(0.1)[1]) == 12


def test_shapes_and_builders_are_shown_as_they_are() -> None:
    box = bd.Box(1, 2, 3)
    assert to_shape(box) is box
    with bd.BuildPart() as part:
        bd.Box(1, 2, 3)
    with bd.BuildSketch() as sketch:
        bd.Circle(3)
    assert to_shape(part).volume == pytest.approx(6)
    assert to_shape(sketch).area == pytest.approx(np.pi * 9)
    with pytest.raises(OptionError, match="the BuildPart holds no shape yet; need one"):
        to_shape(bd.BuildPart())


def test_what_has_no_shape_is_refused() -> None:
    with pytest.raises(OptionError, match="; need a build123d solid, a manifold3d"):
        to_shape("tripod")


# --- where it is shown ---


def test_without_a_viewer_the_error_says_what_was_looked_for() -> None:
    looked_for = r"looked for CQ-editor .* Jupyter .*ocp_vscode or ocp_viewer.* need one"
    with pytest.raises(MissingBackendError, match=looked_for):
        show(TRIPOD)


@pytest.mark.parametrize("name", ["ocp_vscode", "ocp_viewer"])
def test_open_ocp_viewer_gets_shapes_under_their_names(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = open_viewer(monkeypatch, name)
    tripod = TRIPOD
    show(tripod)
    show(tripod, name="legs")
    show(bd.Box(1, 1, 1))
    labeled = [bd.Box(1, 1, 1)]
    labeled[0].label = "cube"
    show(labeled[0])
    assert [name for _, name in viewer.shown] == ["tripod", "legs", "Box", "cube"]
    assert len(viewer.shown[0][0].edges()) == 3


def test_installed_ocp_viewer_is_used_if_it_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    closed = Viewer("ocp_vscode", None)
    viewer = Viewer("ocp_viewer", 3939)
    installed = {"ocp_vscode": closed, "ocp_viewer": viewer}
    monkeypatch.setattr("scaffold_cad.viewers.hosts.find_spec", installed.get)
    monkeypatch.setattr("scaffold_cad.viewers.hosts.import_module", installed.__getitem__)
    show(TRIPOD)
    assert (len(closed.shown), len(viewer.shown)) == (0, 1)


def test_closed_ocp_viewer_is_no_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    open_viewer(monkeypatch, "ocp_vscode", None)
    with pytest.raises(MissingBackendError, match="no viewer"):
        show(TRIPOD)


def test_notebook_displays_the_object_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[object] = []
    shell = SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    display = SimpleNamespace(display=shown.append)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    show(TRIPOD)
    assert shown == [TRIPOD]
    patches = smooth_patches(build_scaffold(TRIPOD).mesh)
    for what in (to_manifold(CUBE), bd.Box(1, 2, 3), patches):
        show(what)
    triangles = [len(one.triangles) for one in shown[1:] if isinstance(one, TriangleMesh)]
    assert triangles[:2] == [12, 12]
    assert triangles[2] > 2 * len(patches.bezier.quads)


def test_ipython_in_a_terminal_is_no_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = SimpleNamespace(get_ipython=lambda: SimpleNamespace())
    monkeypatch.setitem(sys.modules, "IPython", terminal)
    with pytest.raises(MissingBackendError, match="no viewer"):
        show(TRIPOD)


def run_in_cq_editor(program: str) -> list[tuple[Any, str, dict]]:
    """Run a program as CQ-editor does; return what it shows."""
    shown: list[tuple[Any, str, dict]] = []

    def show_object(what: Any, name: str | None = None, options: dict = {}) -> None:  # noqa: B006
        shown.append((what, name or "", options))

    show_object.__module__ = "cq_editor.widgets.debugger"
    script = ModuleType("__cq_main__")
    script.__dict__["show_object"] = show_object
    exec(compile(program, "<cq_editor-string>", "exec"), script.__dict__)
    return shown


PROGRAM = """
from build123d import Box
from scaffold_cad.viewers import show
box = Box(1, 2, 3)
box.color = (1.0, 0.5, 0.0, 0.25)
def from_within():
    show(Box(1, 1, 1), name="small")
show(box)
from_within()
"""


@pytest.mark.skipif(not HAS_CADQUERY, reason="CadQuery is not installed")
def test_cq_editor_gets_cadquery_shapes_with_names_and_colors() -> None:
    import cadquery

    (box, name, options), (small, other, none) = run_in_cq_editor(PROGRAM)
    assert isinstance(box, cadquery.Shape)
    assert (name, other) == ("box", "small")
    assert box.Volume() == pytest.approx(6)
    assert small.Volume() == pytest.approx(1)
    assert options["color"] == pytest.approx((1.0, 0.5, 0.0), abs=0.01)
    assert options["alpha"] == pytest.approx(0.25)
    assert none == {}


@pytest.mark.skipif(not HAS_CADQUERY, reason="CadQuery is not installed")
def test_cadquery_goes_on_from_a_part() -> None:
    import cadquery

    box = cadquery.Workplane(to_cadquery(bd.Box(10, 10, 10)))
    assert box.faces(">Z").workplane().hole(2).val().Volume() == pytest.approx(1000 - np.pi * 10)


@pytest.mark.skipif(HAS_CADQUERY, reason="CadQuery is installed")
def test_without_cadquery_the_error_says_so() -> None:
    with pytest.raises(MissingBackendError, match="a CadQuery shape needs cadquery"):
        to_cadquery(bd.Box(1, 1, 1))
    with pytest.raises(MissingBackendError, match="a CadQuery shape needs cadquery"):
        run_in_cq_editor(PROGRAM)


def test_show_object_of_another_program_is_not_cq_editors() -> None:
    script = ModuleType("__main__")
    script.__dict__["show_object"] = lambda *_: None
    with pytest.raises(MissingBackendError, match="no viewer"):
        exec(PROGRAM, script.__dict__)
