"""Finding the viewer at hand, and showing objects in it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from types import FrameType
from typing import Any, TypeAlias

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.errors import MissingBackendError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.products.surfaces import triangles_of
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import Solidified
from scaffold_cad.struts import RoundStruts
from scaffold_cad.viewers.cadquery import to_cadquery
from scaffold_cad.viewers.shapes import to_shape

OCP_VIEWERS = ("ocp_vscode", "ocp_viewer")
"""Modules with the same functions: OCP CAD Viewer in VS Code, and by itself in a browser."""

Display: TypeAlias = Callable[[Any, str, Overlaps], None]
"""Shows an object under a name, struts that overlap by a rule."""


@checks_keywords()
def show(what: Any, name: str | None = None, *, overlaps: Overlaps = "unite") -> None:
    """Show `what` in CQ-editor, in a notebook, or in an OCP CAD Viewer that is open.

    Objects are added to those that a script has shown before. In CQ-editor and OCP CAD Viewer a
    skeleton is shown by its edges, and a scaffold by its faces; a notebook draws what the package
    has made as at the end of a cell, and the triangles of anything else.

    Parameters
    ----------
    what : anything that `to_shape` knows
    name : of the object in the viewer; by default the name of the caller's variable that holds it
    overlaps : what becomes of struts that overlap in CQ-editor and OCP CAD Viewer, see `to_shape`;
        a notebook draws a scaffold and its united solid

    Raises
    ------
    MissingBackendError
        If there is no viewer; the message says what was looked for.
    OptionError
        If it is nothing that can be shown.
    BrepError
        If struts overlap and are refused.

    Examples
    --------
    >>> from scaffold_cad import show, tile
    >>> show(tile("bcc", 8.0, 2, radius=1.0))  # doctest: +SKIP
    """
    caller = _caller()
    display = _in_cq_editor(caller) or _in_loaded_ocp_viewer() or _in_notebook() or _in_ocp_viewer()
    if display is None:
        raise MissingBackendError(
            "there is no viewer: looked for CQ-editor (running the script), a Jupyter notebook, "
            "and an open OCP CAD Viewer (ocp_vscode or ocp_viewer; run: python -m ocp_viewer); "
            "need one of them, or a file of write() for another program"
        )
    display(what, _name_of(what, caller) if name is None else name, overlaps)


def _caller() -> FrameType:
    """Return the frame that called the package: the first one that runs none of its modules."""
    frame = sys._getframe(1)
    while str(frame.f_globals.get("__name__")).startswith("scaffold_cad.") and frame.f_back:
        frame = frame.f_back
    return frame


def _in_cq_editor(caller: FrameType) -> Display | None:
    """Return how to show in CQ-editor, which gives its scripts a global `show_object`."""
    for frame in _and_callers(caller):
        show_object: Any = frame.f_globals.get("show_object")
        if (getattr(show_object, "__module__", None) or "").startswith("cq_editor."):
            return lambda what, name, overlaps: show_object(
                to_cadquery(what, overlaps), name=name, options=_cq_options(what)
            )
    return None


def _cq_options(what: Any) -> dict[str, Any]:
    """Return what CQ-editor calls the color of a build123d shape."""
    color = getattr(what, "color", None)
    if color is None:
        return {}
    *rgb, alpha = (float(part) for part in color)
    return {"color": tuple(rgb), "alpha": alpha}


def _in_loaded_ocp_viewer() -> Display | None:
    """Return how to show in an OCP CAD Viewer that the script itself has imported."""
    return _first(name for name in OCP_VIEWERS if name in sys.modules)


def _in_ocp_viewer() -> Display | None:
    """Return how to show in an OCP CAD Viewer that is open."""
    return _first(name for name in OCP_VIEWERS if find_spec(name) is not None)


def _first(modules: Iterator[str]) -> Display | None:
    """Return how to show in the first of these OCP CAD Viewers that is open."""
    for viewer in map(import_module, modules):
        if viewer.get_port() is not None:
            show_object = viewer.show_object
            return lambda what, name, overlaps: show_object(to_shape(what, overlaps), name=name)
    return None


def _in_notebook() -> Display | None:
    """Return how to show in the notebook that is running, if any."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None or not hasattr(shell, "kernel"):  # a terminal has none
        return None
    display = import_module("IPython.display").display
    return lambda what, _name, _overlaps: display(_drawable(what))


def _drawable(what: Any) -> Any:
    """Return what a notebook draws of `what`: itself, or its triangles."""
    if isinstance(what, Skeleton | Scaffold | RoundStruts | QuadMesh | TriangleMesh | Solidified):
        return what
    try:
        return triangles_of(what)
    except OptionError:
        return triangles_of(to_shape(what))


def _name_of(what: Any, caller: FrameType) -> str:
    """Return the caller's variable that is `what`, its label, or the name of its class."""
    for variables in (caller.f_locals, caller.f_globals):
        for name, value in variables.items():
            if value is what and not name.startswith("_"):
                return name
    return getattr(what, "label", "") or type(what).__name__


def _and_callers(frame: FrameType | None) -> Iterator[FrameType]:
    """Yield a frame and those that called it."""
    while frame is not None:
        yield frame
        frame = frame.f_back
