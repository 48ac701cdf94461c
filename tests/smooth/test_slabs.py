"""Fine surfaces: every slab fits the others to the last bit, and memory does not hold them all."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io.write import write
from scaffold_cad.lattice import tile
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import fine_surface, smooth_mesh
from tests.skeletons import polyline

CELL = tile("bcc", 10.0, 1, radius=0.7)


def ring() -> Skeleton:
    angle = np.linspace(0, 2 * np.pi, 9, endpoint=False)
    nodes = 20 * np.column_stack([np.cos(angle), np.sin(angle), 0.1 * np.sin(3 * angle)])
    return Skeleton(nodes, polyline(9, closed=True), 1.0 + 0.2 * np.cos(angle))


SCAFFOLDS = {
    "cell": build_scaffold(CELL),
    "collared": build_scaffold(CELL, collars=True),
    "ring": build_scaffold(ring()),
}


@pytest.mark.parametrize("slabs", [1, 3, 16])
@pytest.mark.parametrize("levels", [0, 1, 3])
@pytest.mark.parametrize("scaffold", SCAFFOLDS.values(), ids=SCAFFOLDS)
def test_slabs_are_the_smooth_mesh_to_the_last_bit(
    scaffold: Scaffold, levels: int, slabs: int
) -> None:
    whole = smooth_mesh(scaffold, levels).mesh
    surface = fine_surface(scaffold, levels)
    runs = surface.cut(slabs)
    corners = np.concatenate([surface.corners(rows) for rows in runs])
    np.testing.assert_array_equal(corners, whole.vertices[whole.quads])
    vertices = np.concatenate([surface.vertices(rows) for rows in runs])
    quads = np.concatenate([surface.quads(rows) for rows in runs])
    assert len(vertices) == len(whole.vertices)
    np.testing.assert_array_equal(vertices[quads], corners)


def test_flat_caps_keep_their_creases() -> None:
    scaffold = SCAFFOLDS["cell"]
    whole = smooth_mesh(scaffold, 2, "flat").mesh
    surface = fine_surface(scaffold, 2, "flat")
    corners = np.concatenate([surface.corners(rows) for rows in surface.cut(5)])
    np.testing.assert_array_equal(corners, whole.vertices[whole.quads])


def test_stl_and_ply_files_are_those_of_the_mesh(tmp_path: Path) -> None:
    scaffold = SCAFFOLDS["collared"]
    write(smooth_mesh(scaffold, 2), tmp_path / "whole.stl")
    write(fine_surface(scaffold, 2), tmp_path / "slabs.stl", slabs=7)
    assert (tmp_path / "slabs.stl").read_bytes() == (tmp_path / "whole.stl").read_bytes()
    write(fine_surface(scaffold, 2), tmp_path / "slabs.ply", slabs=7)
    read = trimesh.load(tmp_path / "slabs.ply", process=False)
    assert read.is_watertight
    assert read.volume == pytest.approx(smooth_mesh(scaffold, 2).mesh.signed_volume, rel=1e-4)


def test_more_slabs_need_less_memory(tmp_path: Path) -> None:
    surface = fine_surface(SCAFFOLDS["collared"], 5)

    def peak(slabs: int) -> int:
        tracemalloc.start()
        write(surface, tmp_path / "fine.stl", slabs=slabs)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    assert peak(16) < peak(1) / 4


def test_slabs_are_for_fine_surfaces_in_stl_and_ply(tmp_path: Path) -> None:
    surface = fine_surface(SCAFFOLDS["cell"], 1)
    with pytest.raises(OptionError, match="slabs is 0; need 1 or more"):
        write(surface, tmp_path / "fine.stl", slabs=0)
    with pytest.raises(OptionError, match="slabs is for a FineSurface only"):
        write(SCAFFOLDS["cell"], tmp_path / "scaffold.stl", slabs=2)
    with pytest.raises(FormatError, match=r"goes to \.stl and \.ply only"):
        write(surface, tmp_path / "fine.3mf")
    with pytest.raises(OptionError, match="levels is -1; need 0 or more"):
        fine_surface(SCAFFOLDS["cell"], -1)
    assert not list(tmp_path.iterdir())


def test_surfaces_that_formats_cannot_count_are_refused_before_a_byte(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    surface = fine_surface(SCAFFOLDS["cell"], 14)
    triangles = 2 * surface.quad_count
    with pytest.raises(FormatError, match=rf"has {triangles} triangles; an STL file holds 4294967"):
        write(surface, tmp_path / "fine.stl")
    with pytest.raises(FormatError, match=rf"has {surface.vertex_count} vertices; a PLY file"):
        write(surface, tmp_path / "fine.ply")
    monkeypatch.setattr("scaffold_cad.io.ply.MOST_VERTICES", 10)
    with pytest.raises(FormatError, match=r"a PLY file holds 10 at most"):
        write(SCAFFOLDS["cell"], tmp_path / "scaffold.ply")
    assert not list(tmp_path.iterdir())
