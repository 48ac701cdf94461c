"""Every program of the gallery is short, has a picture, and what it writes is a solid."""

from __future__ import annotations

import ast
import re
import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad import (
    QuadMesh,
    TriangleMesh,
    check_printability,
    read_skeleton,
    to_solid,
)
from scaffold_cad.mesh import self_intersections
from scaffold_cad.printability import PROCESSES
from tests.test_examples import CHECKS

ROOT = Path(__file__).parents[1]
GALLERY = ROOT / "examples" / "gallery"
PICTURES = ROOT / "docs" / "images" / "gallery"
ON_SURFACES = ("shoe_sole", "helmet", "pipe_sleeve")
LARGE_SLS = replace(PROCESSES["sls"], build_volume=(340.0, 340.0, 600.0))
"""Laser sintering in a machine that takes a helmet."""
NAMES = sorted(path.stem for path in GALLERY.glob("*.py"))


def quads_of(path: Path) -> QuadMesh:
    text = path.read_text(encoding="utf-8")
    vertices = np.array(re.findall(r"^v (\S+) (\S+) (\S+)$", text, flags=re.MULTILINE), dtype=float)
    quads = np.array(
        re.findall(r"^f (\d+) (\d+) (\d+) (\d+)$", text, flags=re.MULTILINE), dtype=int
    )
    return QuadMesh(vertices, quads - 1)


def check_obj(path: Path) -> None:
    """Quads around a solid that nowhere crosses itself."""
    mesh = quads_of(path)
    assert to_solid(mesh).volume() > 0
    assert len(self_intersections(TriangleMesh(mesh.vertices, mesh.triangles))) == 0


def check_swc(path: Path) -> None:
    """A tree."""
    assert read_skeleton(path, strict=True).loop_count == 0


ALL_CHECKS = CHECKS | {".obj": check_obj, ".swc": check_swc}


@pytest.mark.parametrize("name", NAMES)
def test_program_writes_solids(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(GALLERY / f"{name}.py"), run_name="__main__")
    written = sorted(tmp_path.iterdir())
    assert any(path.name.startswith(name) for path in written)
    for path in written:
        ALL_CHECKS[path.suffix](path)
        if path.suffix == ".obj":
            assert (quads_of(path).quads == quads_of(written[0]).quads).all()
        if name in ON_SURFACES and path.suffix == ".stl":
            assert check_printability(trimesh.load(path), LARGE_SLS).printable


@pytest.mark.parametrize("name", NAMES)
def test_program_is_short_and_says_what_it_makes(name: str) -> None:
    text = (GALLERY / f"{name}.py").read_text(encoding="utf-8")
    body = ast.parse(text).body
    about = ast.get_docstring(ast.parse(text), clean=True)
    assert about
    code = text.splitlines()[body[1].lineno - 1 :]
    assert len([line for line in code if line.strip()]) <= 40


@pytest.mark.parametrize("name", [*ON_SURFACES, "filled_bracket"])
def test_lattices_on_surfaces_take_20_lines(name: str) -> None:
    assert len((GALLERY / f"{name}.py").read_text(encoding="utf-8").splitlines()) <= 20


def test_every_program_has_a_small_picture_and_is_listed() -> None:
    page = (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
    gallery = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert len(NAMES) == 19
    assert sorted(path.stem for path in PICTURES.glob("*.png")) == NAMES
    for name in NAMES:
        picture = (PICTURES / f"{name}.png").read_bytes()
        assert picture.startswith(b"\x89PNG")
        assert len(picture) < 100_000
        assert f"(gallery/{name}.py)" in page
        assert f"(images/gallery/{name}.png)" in gallery
        assert f"docs/images/gallery/{name}.png" in page
