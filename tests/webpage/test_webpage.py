"""Pages of models: what they hold, what a browser draws of them, and that nothing is missing."""

from __future__ import annotations

import json
from base64 import b64decode
from collections.abc import Callable
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad import (
    QuadMesh,
    Skeleton,
    TriangleMesh,
    build_scaffold,
    catmull_clark,
    round_struts,
    solidified,
    tile,
    to_solid,
)
from scaffold_cad.errors import FormatError, MeshError, OptionError
from scaffold_cad.printability import check_printability
from scaffold_cad.printability.page import page as report_page
from scaffold_cad.webpage import for_notebook, model_page, write_page
from scaffold_cad.webpage import page as page_module
from scaffold_cad.webpage.layers import CRIMSON, VALENCIES
from tests.browser import needs_chromium, seen_in
from tests.meshes import CUBE, OPEN_CUBE
from tests.skeletons import ELBOW, JACK, K4, RING, STICK_FIGURE, STRUT, TRIPOD


def layers_of(page: str) -> dict[str, Any]:
    scene = json.loads(page.split('type="application/json">')[1].split("</script>")[0])
    return {layer["name"]: layer for layer in scene["layers"]}


def points_of(part: dict[str, Any]) -> np.ndarray:
    return np.frombuffer(b64decode(part["points"]), dtype="<f4").reshape(-1, 3)


def test_a_scaffold_is_shown_with_its_skeleton_solid_and_worst_clearance() -> None:
    page = model_page(build_scaffold(JACK), title="jack")
    layers = layers_of(page)
    assert list(layers) == ["skeleton", "scaffold", "solid", "worst"]
    assert [name for name, layer in layers.items() if not layer["shown"]] == ["solid"]
    assert "1 of valency 6" in page
    assert "6 joints and extremities" in page
    lines, glass = layers["scaffold"]["parts"]
    mesh = build_scaffold(JACK).mesh
    assert len(b64decode(lines["rows"])) == 4 * mesh.edges.size
    assert len(b64decode(glass["rows"])) == 4 * mesh.triangles.size


def test_titles_are_text_and_nothing_comes_from_outside() -> None:
    page = model_page(build_scaffold(K4), title="<script>alert(1)</script>")
    assert "<script>alert" not in page
    assert "http" not in page
    assert "src=" not in page


@pytest.mark.parametrize("skeleton", [STRUT, ELBOW, RING], ids=["strut", "elbow", "ring"])
def test_without_branch_points_no_clearance_is_marked(skeleton: Skeleton) -> None:
    assert "worst" not in layers_of(model_page(build_scaffold(skeleton), title="plain"))


def test_far_from_the_origin_points_keep_their_digits() -> None:
    far = TRIPOD.moved(TRIPOD.nodes + 1e7)
    lines = layers_of(model_page(far, title="far"))["skeleton"]["parts"][0]
    spans = np.ptp(points_of(lines), axis=0)
    assert spans == pytest.approx(np.ptp(TRIPOD.nodes, axis=0), rel=1e-6)


def test_high_valencies_are_shown_as_one() -> None:
    corners = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
    ends = corners[np.abs(corners).sum(axis=1) % 2 == 1]  # 14
    star = Skeleton([[0, 0, 0], *(9 * ends)], [[0, 1 + end] for end in range(len(ends))], 1.0)
    assert "1 of valency 13 or more" in model_page(star, title="star")


def test_many_edges_do_not_shine_through() -> None:
    lines = {
        count: layers_of(model_page(tile("octet", 10.0, count, radius=0.5), title="octet"))
        for count in (1, 5)
    }
    through = [layers["skeleton"]["parts"][0]["through"] for layers in lines.values()]
    assert through == [True, False]


def test_another_solid_may_be_shown() -> None:
    scaffold = build_scaffold(K4)
    rods = to_solid(round_struts(K4), sides=16)
    (surface,) = layers_of(model_page(scaffold, title="k4", solid=rods))["solid"]["parts"]
    assert len(b64decode(surface["rows"])) == 4 * 3 * rods.num_tri()


NO_TRIANGLES = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int))
NO_QUADS = QuadMesh(np.zeros((0, 3)), np.zeros((0, 4), dtype=int))
NO_NODES = Skeleton(np.zeros((0, 3)), np.zeros((0, 2), dtype=int), np.zeros(0))

SHOWN: dict[str, Callable[[], Any]] = {
    "skeleton": lambda: K4,
    "scaffold": lambda: build_scaffold(K4),
    "quads": lambda: build_scaffold(K4).mesh,
    "triangles": lambda: CUBE,
    "open": lambda: OPEN_CUBE,
    "no nodes": lambda: NO_NODES,
    "no triangles": lambda: NO_TRIANGLES,
    "no quads": lambda: NO_QUADS,
    "solid": lambda: solidified(build_scaffold(K4)),
    "round struts": lambda: round_struts(K4),
}


@pytest.mark.parametrize("kind", SHOWN)
def test_notebooks_show_a_page_in_a_frame(kind: str) -> None:
    what = SHOWN[kind]()
    shown = what._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    assert shown.count('"') == 8  # of four attributes
    page = unescape(shown.split('srcdoc="')[1].split('"')[0])
    assert page == model_page(what, title=type(what).__name__)


def test_notebooks_are_not_given_large_models(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_module, "NOTEBOOK_FACES", 4 * len(build_scaffold(K4).mesh.quads))
    assert for_notebook(build_scaffold(K4)).startswith("<iframe")
    told = for_notebook(build_scaffold(STICK_FIGURE))
    assert told.startswith("<p>Scaffold: ")
    assert "write_page" in told


def test_a_scaffold_without_a_solid_does_not_end_a_notebook_cell(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(scaffold: object) -> None:
        raise MeshError("crosses <itself>")

    monkeypatch.setattr(page_module, "solidified", refuse)
    assert for_notebook(build_scaffold(K4)) == "<p>Scaffold: crosses &lt;itself&gt;</p>"


def test_subdivisions_and_manifolds_are_shown_and_other_things_refused() -> None:
    fine = catmull_clark(build_scaffold(K4).mesh, levels=1)
    assert list(layers_of(model_page(fine, title="fine"))) == ["mesh"]
    solid = to_solid(catmull_clark(build_scaffold(STRUT).mesh).mesh)
    assert list(layers_of(model_page(solid, title="ball"))) == ["solid"]
    with pytest.raises(OptionError, match="cannot show 3; need a Skeleton"):
        model_page(3, title="three")  # type: ignore[arg-type]


def test_pages_are_written_whole_or_not_at_all(tmp_path: Path) -> None:
    write_page(K4, tmp_path / "k4.html")
    assert "<title>k4</title>" in (tmp_path / "k4.html").read_text(encoding="utf-8")
    with pytest.raises(FormatError, match="there is no folder"):
        write_page(K4, tmp_path / "missing" / "k4.html")
    assert [path.name for path in tmp_path.iterdir()] == ["k4.html"]


# -- in a browser -----------------------------------------------------------------------------


@needs_chromium
def test_the_browser_draws_layers_and_hides_them(tmp_path: Path) -> None:
    page = model_page(build_scaffold(STICK_FIGURE), title="figure")
    seen = seen_in(
        page,
        """
        const boxes = ["skeleton", "scaffold", "solid", "worst"].map(name => box(name));
        const first = boxes.map(one => one.checked), all = pixels();
        for (const one of boxes) if (one.checked) one.click();
        const blank = pixels(), address = location.hash, changes = {};
        for (const one of boxes) {
          one.click();
          changes[one.value] = unlike(pixels(), blank);
          one.click();
        }
        boxes[2].click();
        return { first, address, changes, all: unlike(all, blank), after: location.hash,
                 title: document.title };
        """,
        tmp_path,
    )
    assert seen["title"] == "figure"
    assert seen["first"] == [True, True, False, True]
    assert (seen["address"], seen["after"]) == ("", "#solid")
    assert min(seen["changes"].values()) > 100
    assert seen["all"] > max(seen["changes"]["scaffold"], seen["changes"]["worst"])
    assert seen["changes"]["solid"] > seen["changes"]["skeleton"]


@needs_chromium
def test_the_address_tells_what_is_shown(tmp_path: Path) -> None:
    seen = seen_in(
        model_page(build_scaffold(STICK_FIGURE), title="figure"),
        """
        const checked = () =>
          [...document.querySelectorAll("input:checked")].map(one => one.value);
        const before = checked(), solid = pixels();
        history.replaceState(null, "", "#skeleton");
        window.dispatchEvent(new HashChangeEvent("hashchange"));
        return { before, after: checked(), changed: unlike(solid, pixels()) };
        """,
        tmp_path,
        fragment="#solid",
    )
    assert seen["before"] == ["solid"]
    assert seen["after"] == ["skeleton"]
    assert seen["changed"] > 100


@needs_chromium
def test_branch_points_have_the_color_of_their_valency(tmp_path: Path) -> None:
    legs = Skeleton(
        [[0, 0, 0], [9, 0, 0], [-9, 0, 0], [0, 9, 0], [0, -9, 0], [12, 6, 0], [12, -6, 0]],
        [[0, 1], [0, 2], [0, 3], [0, 4], [1, 5], [1, 6]],
        1.0,
    )
    seen = seen_in(
        model_page(build_scaffold(legs), title="legs"),
        f"""
        box("worst").click();
        const colors = {json.dumps(VALENCIES)}, found = pixels();
        return Object.keys(colors).filter(n => count(found, colors[n]) > 20).map(Number)
        """,
        tmp_path,
    )
    assert seen == [3, 4]


@needs_chromium
def test_the_worst_clearance_is_marked_and_found_by_a_click(tmp_path: Path) -> None:
    seen = seen_in(
        model_page(build_scaffold(STICK_FIGURE), title="figure"),
        f"""
        const first = pixels(), marked = count(first, "{CRIMSON}");
        document.querySelector("li[data-layer=worst]").click();
        const near = pixels();
        box("worst").click();
        return [marked, unlike(first, near), count(near, "{CRIMSON}"),
                count(pixels(), "{CRIMSON}")];
        """,
        tmp_path,
    )
    marked, moved, near, hidden = seen
    assert marked > 50
    assert moved > 1000
    assert near > marked  # the strut that is marked is longer now
    assert hidden == 0


@needs_chromium
def test_a_notebook_draws_and_toggles(tmp_path: Path) -> None:
    notebook = f"<!DOCTYPE html><body>{build_scaffold(K4)._repr_html_()}</body>"
    seen = seen_in(
        notebook,
        """
        const frame = frames[0], before = pixels(frame);
        box("scaffold", frame).click();
        return unlike(before, pixels(frame));
        """,
        tmp_path,
    )
    assert seen > 1000


@needs_chromium
def test_the_report_shows_the_places_of_a_clicked_row(tmp_path: Path) -> None:
    seen = seen_in(
        report_page(check_printability(OPEN_CUBE, name="open")),
        """
        const row = document.querySelector('tr[data-name="watertight"]'), before = pixels();
        const marks = count(before, "#c71a24");
        row.click();
        const after = pixels(), chosen = row.classList.contains("shown");
        row.click();
        return { marks, chosen, moved: unlike(before, after),
                 released: row.classList.contains("shown") };
        """,
        tmp_path,
    )
    assert seen["marks"] > 50
    assert seen["chosen"]
    assert not seen["released"]
    assert seen["moved"] > 1000


@needs_chromium
def test_a_browser_without_webgl_says_so(tmp_path: Path) -> None:
    page = model_page(build_scaffold(K4), title="k4")
    script = 'return document.getElementById("hint").textContent;'
    assert "has no WebGL 2" in seen_in(page, script, tmp_path, webgl=False)
