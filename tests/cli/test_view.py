"""The command `view`: what it writes and opens, and what it refuses."""

from __future__ import annotations

import json
import tempfile
import webbrowser
from base64 import b64decode
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pytest

from scaffold_cad import build_scaffold, to_solid, write
from scaffold_cad.cli import main
from scaffold_cad.io import skeleton_to_json
from tests.scaffold.test_embedding import CROSSING
from tests.skeletons import K4


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the addresses that a browser is asked to open; none is opened."""
    addresses: list[str] = []

    def open_(address: str) -> bool:
        addresses.append(address)
        return True

    monkeypatch.setattr(webbrowser, "open", open_)
    return addresses


@pytest.fixture
def k4(tmp_path: Path) -> str:
    path = tmp_path / "k4.json"
    write(K4, path)
    return str(path)


def layers_of(page: Path) -> dict[str, Any]:
    text = page.read_text(encoding="utf-8")
    scene = json.loads(text.split('type="application/json">')[1].split("</script>")[0])
    return {layer["name"]: layer for layer in scene["layers"]}


def test_a_temporary_page_is_opened(
    k4: str,
    tmp_path: Path,
    opened: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert main(["view", k4]) == 0
    page = Path(capsys.readouterr().out.strip())
    assert page.name == "k4.html"
    assert page.parent.parent == tmp_path
    assert [unquote(address) for address in opened] == [f"file://{page}"]
    assert list(layers_of(page)) == ["skeleton", "scaffold", "solid", "worst"]


def test_a_page_is_written_and_not_opened(k4: str, tmp_path: Path, opened: list[str]) -> None:
    page = tmp_path / "page.html"
    assert main(["view", k4, "--no-open", "-o", str(page)]) == 0
    assert opened == []
    layers = layers_of(page)
    (surface,) = layers["solid"]["parts"]
    rows = np.frombuffer(b64decode(surface["rows"]), dtype="<u4")
    assert len(rows) == 3 * to_solid(build_scaffold(K4)).num_tri()
    lines = layers["skeleton"]["parts"][0]
    assert len(b64decode(lines["rows"])) == 4 * K4.edges.size


def test_the_solid_may_be_round_or_a_frame(k4: str, tmp_path: Path, opened: list[str]) -> None:
    sizes = []
    for product in ("scaffold", "round", "frame"):
        page = tmp_path / f"{product}.html"
        more = ["--strut-radius", "0.1"] if product == "frame" else []
        assert main(["view", k4, "--no-open", "-o", str(page), "--as", product, *more]) == 0
        (surface,) = layers_of(page)["solid"]["parts"]
        sizes.append(len(surface["rows"]))
    assert sizes[0] < sizes[1]
    assert sizes[0] < sizes[2]


@pytest.mark.parametrize("suffix", [".stl", ".3mf"])
def test_meshes_are_shown_as_they_are(suffix: str, tmp_path: Path, opened: list[str]) -> None:
    solid, page = tmp_path / f"k4{suffix}", tmp_path / "page.html"
    write(build_scaffold(K4), solid)
    assert main(["view", str(solid), "--no-open", "-o", str(page)]) == 0
    assert list(layers_of(page)) == ["solid"]


@pytest.mark.parametrize(
    "option",
    ["--as frame", "--collars", "--fit paper", "--section area", "--strut-radius 1", "--radius 1"],
)
def test_options_of_skeletons_are_refused_for_a_mesh(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(build_scaffold(K4), tmp_path / "k4.stl")
    page = tmp_path / "page.html"
    assert main(["view", str(tmp_path / "k4.stl"), *option.split(), "-o", str(page)]) == 2
    assert f"{option.split()[0]} is for skeletons" in capsys.readouterr().err
    assert not page.exists()


@pytest.mark.parametrize("product", [[], ["--as", "round"]])
def test_the_radius_of_a_frame_is_refused_for_other_solids(
    k4: str, product: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.html"
    assert main(["view", k4, "--strut-radius", "3", *product, "-o", str(page)]) == 2
    assert "--strut-radius is for --as frame" in capsys.readouterr().err
    assert not page.exists()


def test_without_a_browser_the_page_is_named(
    k4: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(webbrowser, "open", lambda address: False)
    page = tmp_path / "page.html"
    assert main(["view", k4, "-o", str(page)]) == 0
    assert f"no browser could be opened: open {page} in one" in capsys.readouterr().err


def test_what_is_no_page_is_not_written(
    k4: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments in (["view", k4, "--no-open", "-o"], ["check", k4, "--html"]):
        assert main([*arguments, str(tmp_path / "v.txt")]) == 2
        assert "v.txt: it is a page; need .html" in capsys.readouterr().err
    assert not (tmp_path / "v.txt").exists()


def test_bad_input_writes_and_opens_nothing(
    k4: str, tmp_path: Path, opened: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "bad.json"
    bad.write_text("{", encoding="utf-8")
    assert main(["view", str(bad), "-o", str(tmp_path / "page.html")]) == 2
    assert main(["view", k4, "-o", str(tmp_path / "missing" / "page.html")]) == 2
    assert "there is no folder" in capsys.readouterr().err
    assert opened == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.json", "k4.json"]


def test_overlaps_of_what_is_shown_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "crossing.json"
    source.write_text(skeleton_to_json(CROSSING))
    page = str(tmp_path / "page.html")
    assert main(["view", str(source), "--no-open", "--as", "round", "-o", page]) == 0
    assert capsys.readouterr().err.count("; they are united") == 1
