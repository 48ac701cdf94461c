"""Layers of struts: their volumes, what is cut out of them, and what is refused."""

from __future__ import annotations

import re
import shutil
import subprocess
import tracemalloc
from collections.abc import Iterable
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest

from scaffold_cad import (
    Layer,
    Skeleton,
    TriangleMesh,
    build_scaffold,
    round_struts,
    slices,
    tile,
    to_solid,
    write,
)
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.layers import nodes as parts
from scaffold_cad.layers import uniting
from scaffold_cad.solid.manifolds import manifold_triangles
from tests.meshes import CUBE, OPEN_CUBE
from tests.skeletons import JACK, STRUT, TETRAPOD, TREFOIL, TRIPOD, ZIGZAG, star
from tests.struts.chains import CROSSED_COIL, helix


def volume(layers: Iterable[Layer]) -> float:
    return sum(layer.area * layer.thickness for layer in layers)


def cube(low: float, high: float) -> TriangleMesh:
    return TriangleMesh(low + (CUBE.vertices + 1) / 2 * (high - low), CUBE.triangles)


def same(one: Layer, other: Layer) -> bool:
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("height", "points", "offsets")
    )


@pytest.mark.parametrize("sides", [16, 32])
@pytest.mark.parametrize(
    "skeleton",
    [
        TETRAPOD,
        JACK,
        ZIGZAG,
        star([[9, 0, 1], [-3, 8, -2], [-4, -7, 1], [1, 1, 9]], 1.3),
        tile("bcc", 8.0, 1, radius=0.6),
        tile("octet", 8.0, 1, radius=0.5),
    ],
    ids=["tetrapod", "jack", "zigzag", "star", "bcc", "octet"],
)
def test_layers_add_up_to_the_volume_of_the_solid(skeleton: Skeleton, sides: int) -> None:
    struts = round_struts(skeleton)
    assert not struts.crowded.any()
    exact = to_solid(struts, sides=64).volume()
    found = volume(slices(struts, thickness=0.02, sides=sides))
    assert found == pytest.approx(exact, rel=3e-3 if sides == 16 else 8e-4)


def test_crossing_cylinders_have_the_volume_of_steinmetz() -> None:
    radius, half = 1.0, 5.0
    nodes = [[-half, 0, 0], [half, 0, 0], [0, -half, 0], [0, half, 0]]
    crossing = Skeleton(nodes, [[0, 1], [2, 3]], radius)
    struts = round_struts(crossing, blend=0.001)  # next to no fillet
    assert struts.crowded_runs.all()
    exact = 2 * np.pi * radius**2 * 2 * half - 16 / 3 * radius**3
    assert volume(slices(struts, thickness=0.02, sides=64)) == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("ends", ["flat", "round", "open"])
def test_hollow_struts_are_hollow(ends: Any) -> None:
    struts = round_struts(TRIPOD, wall=0.3, ends=ends)
    exact = to_solid(struts, sides=64).volume()
    assert volume(slices(struts, thickness=0.02, sides=32)) == pytest.approx(exact, rel=3e-3)


def test_a_hollow_strut_has_rings_for_layers() -> None:
    upright = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 2.0)
    struts = round_struts(upright, wall=0.5, ends="open")
    for layer in slices(struts, [0.01, 5.0, 8.99]):
        assert layer.areas == pytest.approx([np.pi * 4, -np.pi * 1.5**2])


def test_round_ends_are_balls() -> None:
    struts = round_struts(STRUT, ends="round")
    exact = np.pi * 10 + 4 / 3 * np.pi
    assert volume(slices(struts, thickness=0.01, sides=32)) == pytest.approx(exact, rel=1e-3)


def test_square_struts_are_cut_as_their_solid() -> None:
    for scaffold in (build_scaffold(TETRAPOD), build_scaffold(tile("bcc", 4.0, 1, radius=1.2))):
        found = volume(slices(scaffold, thickness=0.01))
        assert found == pytest.approx(to_solid(scaffold).volume(), rel=1e-4)


def test_a_crowded_node_is_the_union_of_its_struts_and_a_ball() -> None:
    narrow = star([[9, 0, 0], [9, 0.8, 0], [9, 0, 1.1]], 1.0)
    struts = round_struts(narrow)
    assert struts.crowded[0]
    sharp = to_solid(round_struts(narrow, blend=1e-3), sides=32).volume()
    # The ball reaches beyond the flat ends of the struts at the node.
    found = volume(slices(struts, thickness=0.02, sides=32))
    assert sharp * 0.98 < found < sharp * 1.1


def test_layers_of_sharp_nodes_that_others_cross_have_their_volume() -> None:
    tips = [[12, 0, 0], [0, 12, 0], [0, 0, 12]]
    beside = [[-1, -1, -9], [-1, -1, 9]]
    edges = [[0, 1], [0, 2], [0, 3], [4, 5]]
    struts = round_struts(Skeleton([[0, 0, 0], *tips, *beside], edges, 1.0), nodes="sharp")
    assert struts.crowded[0]
    exact = to_solid(struts, sides=32).volume()
    assert volume(slices(struts, thickness=0.05)) == pytest.approx(exact, rel=0.005)


def test_a_region_cuts_the_struts_and_a_skin_closes_them() -> None:
    struts = round_struts(tile("bcc", 4.0, 3, radius=0.4))
    body = cube(1.0, 11.0)
    solid = to_solid(struts, sides=32)
    inside = (solid ^ to_solid(body)).volume()
    cut = list(slices(struts, thickness=0.05, sides=32, region=body))
    assert volume(cut) == pytest.approx(inside, rel=1e-3)
    assert np.concatenate([layer.points for layer in cut]).min() > 1 - 1e-9
    skinned = list(slices(struts, thickness=0.05, sides=32, region=body, skin=0.5))
    wall = to_solid(body) - to_solid(cube(1.5, 10.5))
    assert volume(skinned) == pytest.approx((wall + (solid ^ to_solid(body))).volume(), rel=1e-3)
    assert skinned[0].area == pytest.approx(100)


def test_layers_do_not_depend_on_how_many_are_made_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    struts = round_struts(tile("bcc", 4.0, 2, radius=0.4), wall=0.15)
    heights = np.linspace(-0.5, 8.5, 91)
    region = cube(0.5, 7.5)
    whole = list(slices(struts, heights, region=region))
    monkeypatch.setattr(uniting, "PARTS_AT_ONCE", 1)
    single = list(slices(struts, heights, region=region))
    assert all(map(same, whole, single))
    alone = [next(slices(struts, [height], region=region)) for height in heights[::9]]
    assert all(map(same, whole[::9], alone))
    monkeypatch.setattr(parts, "NODES_AT_ONCE", 3)
    few = list(slices(struts, heights, region=region))
    assert [layer.area for layer in few] == pytest.approx([layer.area for layer in whole])


def test_layers_are_made_while_they_are_asked_for() -> None:
    layers = slices(TRIPOD, np.linspace(0, 10, 10**6))
    assert next(layers).height == 0.0


def test_memory_does_not_grow_with_the_layers(monkeypatch: pytest.MonkeyPatch) -> None:
    struts = round_struts(TETRAPOD)
    monkeypatch.setattr(uniting, "PARTS_AT_ONCE", 64)
    peaks = []
    for count in (100, 1000):
        layers = slices(struts, np.linspace(-7, 7, count))
        tracemalloc.start()
        for _ in layers:
            pass
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.3 * peaks[0]


def test_layers_begin_at_the_lowest_point_and_end_at_the_highest() -> None:
    for struts in (
        round_struts(TETRAPOD),
        round_struts(star([[9, 0, 0], [-4, 8, 0], [-4, -8, 0]])),
    ):
        z = to_solid(struts, sides=32).bounding_box()[2::3]
        layers = list(slices(struts, thickness=0.1, sides=32))
        assert layers[0].height - 0.05 == pytest.approx(z[0], abs=0.01)
        assert layers[-1].top == pytest.approx(z[1], abs=0.11)
        assert all(b.height - a.height == pytest.approx(0.1) for a, b in pairwise(layers))


def test_an_empty_layer_has_no_polygons() -> None:
    (layer,) = slices(STRUT, [99.0])
    assert (layer.loops, layer.area, len(layer.areas)) == ([], 0.0, 0)


def test_slices_refuses_what_it_cannot_cut() -> None:
    with pytest.raises(OptionError, match="need either heights or the thickness of layers"):
        slices(STRUT)
    with pytest.raises(OptionError, match="need either heights or the thickness of layers"):
        slices(STRUT, [1.0], thickness=0.1)
    with pytest.raises(OptionError, match=r"heights go from 2 to 1 mm; need each above"):
        slices(STRUT, [2.0, 1.0])
    with pytest.raises(OptionError, match=r"heights have shape \(1, 1\); need \(n,\), mm"):
        slices(STRUT, [[2.0]])
    with pytest.raises(OptionError, match="height 1 is nan mm; need finite numbers"):
        slices(STRUT, [1.0, np.nan])
    with pytest.raises(OptionError, match="thickness is 0 mm; need > 0"):
        slices(STRUT, thickness=0.0)
    with pytest.raises(OptionError, match=r"thickness is 1e\+09 mm for .* mm; need less than"):
        slices(STRUT, thickness=1e9)
    with pytest.raises(OptionError, match=r"2e\+09 layers; need at most 10000000"):
        slices(STRUT, thickness=1e-9)
    with pytest.raises(OptionError, match="sides is 10; need a multiple of 4"):
        slices(STRUT, [1.0], sides=10)
    with pytest.raises(OptionError, match="sides is for round struts; got a Scaffold"):
        slices(build_scaffold(STRUT), [1.0], sides=8)
    with pytest.raises(OptionError, match="skin is given without a region; need one"):
        slices(STRUT, [1.0], skin=1.0)
    with pytest.raises(MeshError, match="no triangle runs along the edge"):
        slices(OPEN_CUBE, [1.0])
    with pytest.raises(OptionError, match="the body is 7; need a build123d solid"):
        slices(7, [1.0])


def areas_of_slicer(mesh: TriangleMesh, thickness: float, folder: Path) -> list[float]:
    """Return the area of each layer that prusa-slicer shows to a resin printer, mm²."""
    image = pytest.importorskip("PIL.Image")
    write(mesh, folder / "part.stl")
    command = ["prusa-slicer", "--export-sla", "--printer-technology", "SLA", "part.stl"]
    command += ["--layer-height", str(thickness), "--initial-layer-height", str(thickness)]
    command += ["--supports-enable=0", "--pad-enable=0", "--faded-layers=3", "-o", "out.sl1"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    found = []
    with ZipFile(folder / "out.sl1") as archive:
        for name in sorted(archive.namelist()):
            if re.fullmatch(r"out\d+\.png", name):
                pixels = np.array(image.open(BytesIO(archive.read(name))))
                found.append(float(pixels.mean() / 255 * 120 * 68))  # of its display, mm
    return found


@pytest.mark.slicer
@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="needs prusa-slicer")
def test_layers_have_the_area_of_those_of_a_slicer(tmp_path: Path) -> None:
    struts = round_struts(tile("bcc", 6.0, 1, radius=0.6))
    mesh = manifold_triangles(to_solid(struts, sides=32))
    theirs = areas_of_slicer(mesh, 0.2, tmp_path)
    ours = [layer.area for layer in slices(struts, thickness=0.2, sides=32)]
    assert len(ours) - len(theirs) in (0, 1)  # it leaves out what is thinner than half a layer
    assert ours[: len(theirs)] == pytest.approx(theirs, abs=0.03)


@pytest.mark.parametrize("skeleton", [TREFOIL, helix(60, wire=np.linspace(0.6, 1.4, 60))])
def test_layers_of_curves_have_their_volume(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    assert struts.curves.curved.any()
    found = volume(slices(struts, thickness=0.05, sides=16))
    assert found == pytest.approx(to_solid(struts, sides=16).volume(), rel=2e-3)


def test_layers_of_a_crossed_curve_have_its_volume() -> None:
    struts = round_struts(CROSSED_COIL)
    assert 0 < len(struts.overlapping) < 8
    found = volume(slices(struts, thickness=0.05, sides=16))
    assert found == pytest.approx(to_solid(struts, sides=16).volume(), rel=5e-3)


def test_layers_of_sockets_have_their_volume() -> None:
    tube = Skeleton([[0, 0, 0], [20, 0, 0]], [[0, 1]], 5.0)
    sockets = {0: (3.0, 4.0), 1: (4.5, 6.0)}
    struts = round_struts(tube, wall=1.0, ends="open", sockets=sockets)
    found = volume(slices(struts, thickness=0.05, sides=32))
    assert found == pytest.approx(to_solid(struts, sides=32).volume(), rel=5e-3)
