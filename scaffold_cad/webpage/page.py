"""Pages that show a skeleton, a scaffold or a solid, for browsers and notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from importlib.resources import files
from os import PathLike
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from scaffold_cad.base.arguments import as_path, checks_keywords, described
from scaffold_cad.base.files import replacing
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import surface_of
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import Solidified, solidified
from scaffold_cad.struts import RoundStruts
from scaffold_cad.webpage.layers import (
    ShownLayer,
    quads_layer,
    skeleton_layer,
    solid_layer,
    worst_layer,
)
from scaffold_cad.webpage.scene import Scene, filled

if TYPE_CHECKING:
    from manifold3d import Manifold

    from scaffold_cad.mesh.subdivision import Subdivision

NOTEBOOK_FACES = 100_000
"""Most triangles, or edges, of what is shown in a notebook: they are kept in its file."""

NOTEBOOK_HEIGHT = 480
"""Height of a page in a notebook, pixels."""

Model: TypeAlias = "Shown | Subdivision | Manifold"
"""What a page can show."""


@checks_keywords()
def write_page(what: Model, path: str | PathLike[str], *, solid: Model | None = None) -> None:
    """Write a page that shows `what`, named after its file, whole or not at all.

    Parameters
    ----------
    what : see `model_page`
    path : of the page
    solid : see `model_page`

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    path = as_path(path)
    text = model_page(what, title=path.stem, solid=solid)
    with replacing(path) as fresh:
        fresh.write_text(text, encoding="utf-8")


@checks_keywords()
def model_page(what: Model, *, title: str, solid: Model | None = None) -> str:
    """Return an HTML page that shows `what` and refers to nothing outside itself.

    Its layers can be shown and hidden; the page's address tells which are shown, as in
    `page.html#skeleton,solid`.

    Parameters
    ----------
    what : a skeleton; a scaffold, which is shown with its skeleton, its solid and its worst
        clearance; round struts, with their skeleton; a mesh or a solid
    title : of the page
    solid : what the layer of a scaffold's solid shows, by default `solidified(what)`

    Raises
    ------
    OptionError
        If `what` is something else.
    MeshError
        If the scaffold has no solid.
    """
    if isinstance(what, Skeleton):
        return layers_page(title, _counts(what), [skeleton_layer(what)])
    if isinstance(what, Scaffold):
        layers = _scaffold_layers(what, _surface(solidified(what) if solid is None else solid))
        return layers_page(title, _counts(what.skeleton), layers)
    if isinstance(what, RoundStruts):
        layers = [skeleton_layer(what.skeleton), solid_layer(_surface(what), shown=True)]
        return layers_page(title, _counts(what.skeleton), layers)
    mesh = _surface(what)
    volume = f"volume {mesh.signed_volume:.6g} mm³"
    if isinstance(mesh, QuadMesh):
        return layers_page(title, volume, [quads_layer(mesh, "mesh")])
    return layers_page(title, volume, [solid_layer(mesh, shown=True)])


@checks_keywords()
def for_notebook(what: Shown) -> str:
    """Return `what` as HTML for a notebook, or a line of text where that would be too much."""
    name = type(what).__name__
    count = _face_count(what)
    if count > NOTEBOOK_FACES:
        return (
            f"<p>{name}: {count} triangles or edges are too many for a notebook; "
            "<code>scaffold_cad.webpage.write_page</code> writes a page of its own.</p>"
        )
    try:
        page = model_page(what, title=name)
    except MeshError as error:  # a display must not end a cell
        return f"<p>{name}: {escape(str(error))}</p>"
    return (
        f'<iframe srcdoc="{escape(page)}" width="100%" height="{NOTEBOOK_HEIGHT}" '
        'style="border: none"></iframe>'
    )


def _face_count(what: Shown) -> int:
    """Return about how many triangles, or edges, a page of `what` holds."""
    if isinstance(what, Skeleton):
        return len(what.edges)
    if isinstance(what, Scaffold):
        return 4 * len(what.mesh.quads)  # as a scaffold and as a solid
    if isinstance(what, Solidified):
        return int(what.manifold.num_tri())
    return len(_surface(what).triangles)


def _surface(what: Model) -> QuadMesh | TriangleMesh:
    mesh = surface_of(what)
    if mesh is None:
        raise OptionError(
            f"a page cannot show {described(what)}; need a Skeleton, a Scaffold, "
            "RoundStruts, a mesh or a manifold3d Manifold"
        )
    return mesh


def _counts(skeleton: Skeleton) -> str:
    nodes, edges = counted(len(skeleton.nodes), "node"), counted(len(skeleton.edges), "edge")
    return f"{nodes}, {edges}, {counted(skeleton.loop_count, 'loop')}"


def _scaffold_layers(scaffold: Scaffold, solid: QuadMesh | TriangleMesh) -> list[ShownLayer]:
    layers = [
        skeleton_layer(scaffold.skeleton),
        quads_layer(scaffold.mesh, "scaffold"),
        solid_layer(solid, shown=False),
    ]
    worst = worst_layer(scaffold)
    return layers if worst is None else [*layers, worst]


def layers_page(title: str, summary: str, layers: Iterable[ShownLayer]) -> str:
    """Return a page of layers that can be shown and hidden, with a line of summary."""
    shown = list(layers)
    return filled(
        files("scaffold_cad.webpage").joinpath("model.html").read_text("utf-8"),
        Scene(tuple(one.layer for one in shown), np.array([0.0, 0.0, 1.0])),
        title=escape(title),
        summary=escape(summary),
        layers="\n".join(_switch(one) for one in shown),
    )


def _switch(shown: ShownLayer) -> str:
    """Return the checkbox of a layer, and its legend."""
    checked = " checked" if shown.layer.shown else ""
    place = f' data-layer="{shown.layer.name}" title="look at it"' if shown.is_place else ""
    rows = "".join(
        f'<li{place}><i style="background: {color}"></i>{escape(meaning)}</li>'
        for color, meaning in shown.legend
    )
    return (
        f'<label><input type="checkbox" value="{shown.layer.name}"{checked}> '
        f"{escape(shown.label)}</label>" + (f"<ul>{rows}</ul>" if rows else "")
    )
