"""The surface of whatever has one: shapes of build123d and their builders, and meshes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import build123d as bd
import pytest

from scaffold_cad import RoundStruts, TriangleMesh, round_struts, solidified
from scaffold_cad.errors import OptionError
from scaffold_cad.io.write import write
from scaffold_cad.printability import read_triangles
from scaffold_cad.products import surfaces
from scaffold_cad.products.surfaces import surface_of, triangles_of
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.viewers import to_shape
from tests.meshes import CUBE
from tests.skeletons import K4, TRIPOD


def block() -> bd.BuildPart:
    with bd.BuildPart() as builder:
        bd.Box(2, 3, 4)
    return builder


@pytest.mark.parametrize("what", [block(), block().part], ids=["builder", "part"])
@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".obj", ".ply"])
def test_builders_are_written_as_their_parts(what: Any, suffix: str, tmp_path: Path) -> None:
    assert triangles_of(what).signed_volume == pytest.approx(24.0)
    write(what, tmp_path / f"block{suffix}")
    mesh = read_triangles(tmp_path / f"block{suffix}")
    assert mesh is not None
    assert mesh.signed_volume == pytest.approx(24.0, rel=1e-6)


def test_builders_are_written_to_step(tmp_path: Path) -> None:
    write(block(), tmp_path / "block.step")
    assert bd.import_step(tmp_path / "block.step").volume == pytest.approx(24.0)


@pytest.mark.parametrize("name", ["block.stl", "block.step"])
def test_a_builder_without_a_shape_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="the BuildPart holds no shape yet; need one"):
        write(bd.BuildPart(), tmp_path / name)
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    "what",
    [
        SimpleNamespace(vertices=list, faces=list),
        SimpleNamespace(vertices=CUBE.vertices),
        SimpleNamespace(vertices=CUBE.vertices, faces=None, triangles=None),
        K4,
        "cube",
        None,
    ],
)
def test_what_has_no_arrays_of_triangles_has_no_surface(what: Any) -> None:
    assert surface_of(what) is None
    with pytest.raises(OptionError, match="; need a build123d solid"):
        triangles_of(what)


def test_solids_are_shown_and_written_with_what_tells_of_them(tmp_path: Path) -> None:
    solid = solidified(build_scaffold(K4))
    assert triangles_of(solid).signed_volume == pytest.approx(solid.manifold.volume())
    assert len(to_shape(solid).faces()) == 1
    write(solid, tmp_path / "solid.stl")
    mesh = read_triangles(tmp_path / "solid.stl")
    assert mesh is not None
    assert mesh.signed_volume == pytest.approx(solid.manifold.volume(), rel=1e-5)


@pytest.mark.parametrize("empty", [bd.Part(), bd.Box(1, 1, 1) - bd.Box(2, 2, 2), [bd.Sketch()]])
def test_empty_shapes_are_refused(empty: object, tmp_path: Path) -> None:
    for call in (triangles_of, lambda shape: write(shape, tmp_path / "empty.step")):
        with pytest.raises(OptionError, match="is empty; need a shape"):
            call(empty)
    assert not list(tmp_path.iterdir())


def test_of_a_list_only_one_shape_is_taken() -> None:
    cubes = [bd.Box(1, 1, 1), bd.Pos(5, 0, 0) * bd.Box(1, 1, 1)]
    assert len(triangles_of(cubes[0].solids()).triangles) == 12
    with pytest.raises(OptionError, match="the list holds 2 shapes; need one, such as their sum"):
        triangles_of(cubes)


def test_the_next_format_has_the_surface_that_the_first_one_made(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    made: list[float] = []

    def counted(struts: RoundStruts, sides: int, factor: float) -> TriangleMesh:
        made.append(factor)
        return round_mesh(struts, sides, factor)

    monkeypatch.setattr(surfaces, "round_mesh", counted)
    tripod = round_struts(TRIPOD)
    for suffix in (".stl", ".3mf", ".ply", ".glb"):
        write(tripod, tmp_path / f"tripod{suffix}")
    assert made == [1.0]
    write(tripod, tmp_path / "tripod.stl", sides=8)
    write(round_struts(TRIPOD), tmp_path / "tripod.stl", sides=8)
    assert len(made) == 3
