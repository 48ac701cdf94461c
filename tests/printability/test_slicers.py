"""What slicers see of solids and of broken ones; skipped where they are not installed."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import TriangleMesh, build_scaffold, tile, to_solid
from scaffold_cad.io.stl import write_stl
from scaffold_cad.printability import check_printability
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from tests.meshes import CUBE, OPEN_CUBE
from tests.skeletons import K4, NAMED
from tests.validation.printability import (
    ADMESH,
    POWDER,
    SLICER,
    Seen,
    faulty_solid,
    filament_volume,
    is_named,
    seen_by_admesh,
    seen_by_slicer,
)

needs_slicer = pytest.mark.skipif(
    shutil.which(SLICER) is None, reason=f"{SLICER} is not installed (Debian package {SLICER})"
)
needs_admesh = pytest.mark.skipif(
    shutil.which(ADMESH) is None, reason=f"{ADMESH} is not installed (Debian package {ADMESH})"
)
TOOLS = [
    pytest.param(seen_by_slicer, marks=needs_slicer, id=SLICER),
    pytest.param(seen_by_admesh, marks=needs_admesh, id=ADMESH),
]
pytestmark = pytest.mark.slicer

See = Callable[[Path], Seen]


def solid_of(skeleton: Skeleton) -> TriangleMesh:
    return manifold_triangles(to_solid(build_scaffold(skeleton)))


def cut_flat(mesh: TriangleMesh, depth: float) -> TriangleMesh:
    """Return a solid without its lowest `depth`, so that it stands on faces."""
    floor = float(mesh.vertices[:, 2].min()) + depth
    return manifold_triangles(to_solid(mesh).trim_by_plane((0, 0, 1), floor))


@pytest.mark.parametrize("see", TOOLS)
@pytest.mark.parametrize("name", ["bcc_star", "k4", "stick_figure", "trefoil", "two_struts"])
def test_tools_agree_on_parts_and_volume(name: str, see: See, tmp_path: Path) -> None:
    report = check_printability(NAMED[name])
    write_stl(report.mesh, tmp_path / "part.stl")
    seen = see(tmp_path / "part.stl")
    assert seen.manifold
    assert seen.reversed_facets == 0
    assert seen.parts == report["components"].value["count"]
    assert seen.volume == pytest.approx(report["volume"].value["volume_mm3"], rel=1e-5)


@pytest.mark.parametrize("see", TOOLS)
def test_tools_see_a_hole_as_the_check_does(see: See, tmp_path: Path) -> None:
    mesh = TriangleMesh(OPEN_CUBE.vertices, OPEN_CUBE.triangles)
    write_stl(mesh, tmp_path / "open.stl")
    assert not see(tmp_path / "open.stl").manifold
    assert check_printability(mesh)["watertight"].verdict == "failure"


@pytest.mark.parametrize("see", TOOLS)
@pytest.mark.parametrize("kind", ["self-crossing tube", "self-overlap"])
@pytest.mark.parametrize("seed", range(3))
def test_tools_take_for_whole_what_crosses_itself(
    kind: str, seed: int, see: See, tmp_path: Path
) -> None:
    mesh = faulty_solid(kind, seed)
    write_stl(mesh, tmp_path / "part.stl")
    assert see(tmp_path / "part.stl").manifold
    report = check_printability(mesh, POWDER)
    assert not report.printable
    assert is_named(kind, report)


def box() -> TriangleMesh:
    return TriangleMesh(CUBE.vertices * np.array([8, 8, 6]), CUBE.triangles)


def k4() -> TriangleMesh:
    return solid_of(K4.scaled(1.5))


def bcc() -> TriangleMesh:
    return cut_flat(solid_of(tile("bcc", 15.0, 1, radius=1.5)), 1.0)


@needs_slicer
@pytest.mark.parametrize("make", [box, k4, bcc])
def test_the_filament_at_full_infill_has_the_volume_of_the_solid(
    make: Callable[[], TriangleMesh], tmp_path: Path
) -> None:
    mesh = make()
    report = check_printability(mesh, "fdm")
    assert report["plate_contact"].verdict == "ok"
    write_stl(mesh, tmp_path / "part.stl")
    volume = report["volume"].value["volume_mm3"]
    assert filament_volume(tmp_path / "part.stl", tmp_path) == pytest.approx(volume, rel=0.03)


@needs_slicer
def test_a_part_that_stands_on_an_edge_is_refused_by_the_slicer_as_the_check_warns(
    tmp_path: Path,
) -> None:
    y, z = 20.0 * CUBE.vertices[:, 1], 20.0 * CUBE.vertices[:, 2]
    turned = np.stack([20.0 * CUBE.vertices[:, 0], y - z, y + z], axis=1)
    mesh = TriangleMesh(turned, CUBE.triangles)
    assert check_printability(mesh, "fdm")["plate_contact"].verdict == "warning"
    write_stl(mesh, tmp_path / "part.stl")
    with pytest.raises(subprocess.CalledProcessError) as refused:
        filament_volume(tmp_path / "part.stl", tmp_path)
    assert "no extrusions in the first layer" in refused.value.stdout + refused.value.stderr
