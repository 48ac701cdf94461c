"""Files of layers, read back by small readers of our own and by lib3mf."""

from __future__ import annotations

import json
import re
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree
from zipfile import ZipFile

import numpy as np
import pytest

from scaffold_cad import Layer, Skeleton, round_struts, slices, tile, write_layers
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io.stacks import STACK_SUFFIXES
from scaffold_cad.io.stacks.images import raster
from scaffold_cad.layers import Layers
from tests.skeletons import STRUT, TETRAPOD

Polygons = list[Floats]

RINGS = round_struts(tile("sc", 4.0, 1, radius=0.5), wall=0.2)
"""Struts whose layers have holes, and islands in none."""


def made() -> Layers:
    return slices(RINGS, thickness=0.25)


def area(polygons: Polygons) -> float:
    return float(
        sum((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2 for x, y in (p.T for p in polygons))
    )


def header_of(data: bytes) -> tuple[dict[str, str], bytes]:
    head, rest = data.split(b"$$HEADEREND", 1)
    lines = [line[2:].partition("/") for line in head.decode("ascii").splitlines()]
    return {name: value for name, _, value in lines}, rest


def read_binary_cli(path: Path) -> list[tuple[float, Polygons, list[int]]]:
    header, rest = header_of(path.read_bytes())
    assert "BINARY" in header
    found: list[tuple[float, Polygons, list[int]]] = []
    at = 0
    while at < len(rest):
        (command,) = struct.unpack_from("<H", rest, at)
        if command == 127:
            found.append((struct.unpack_from("<f", rest, at + 2)[0], [], []))
            at += 6
            continue
        assert command == 130
        part, turn, count = struct.unpack_from("<3i", rest, at + 2)
        assert part == 1
        points = np.frombuffer(rest, "<f4", 2 * count, at + 14).reshape(-1, 2)
        found[-1][1].append(points.astype(float))
        found[-1][2].append(turn)
        at += 14 + 8 * count
    assert int(header["LAYERS"]) == len(found)
    return found


def read_text_cli(path: Path) -> list[tuple[float, Polygons, list[int]]]:
    header, rest = header_of(path.read_bytes())
    assert "ASCII" in header
    first, *lines, last = rest.decode("ascii").split()
    assert (first, last) == ("$$GEOMETRYSTART", "$$GEOMETRYEND")
    found: list[tuple[float, Polygons, list[int]]] = []
    for line in lines:
        name, _, values = line.partition("/")
        if name == "$$LAYER":
            found.append((float(values), [], []))
            continue
        assert name == "$$POLYLINE"
        part, turn, count, *numbers = values.split(",")
        assert part == "1"
        points = np.array(numbers, dtype=float).reshape(-1, 2)
        assert len(points) == int(count)
        found[-1][1].append(points)
        found[-1][2].append(int(turn))
    assert int(header["LAYERS"]) == len(found)
    return found


@pytest.mark.parametrize("text", [False, True])
def test_a_cli_file_holds_the_layers(text: bool, tmp_path: Path) -> None:
    path = tmp_path / "rings.cli"
    write_layers(made(), path, text=text)
    layers = list(made())
    found = (read_text_cli if text else read_binary_cli)(path)
    assert [top for top, _, _ in found] == pytest.approx([layer.top for layer in layers], abs=1e-6)
    for (_, polygons, turns), layer in zip(found, layers, strict=True):
        assert [one[0].tolist() for one in polygons] == [one[-1].tolist() for one in polygons]
        for one, other in zip(polygons, layer.loops, strict=True):
            assert one[:-1] == pytest.approx(other, abs=1e-6)
        assert turns == (layer.areas > 0).astype(int).tolist()
    assert any(0 in turns for _, _, turns in found)


def test_a_label_has_no_sign_that_means_something(tmp_path: Path) -> None:
    path = tmp_path / 'ä,"b$.cli'
    write_layers(made(), path)
    assert header_of(path.read_bytes())[0]["LABEL"] == "1,___b_"
    write_layers(made(), path, label="left bracket")
    assert header_of(path.read_bytes())[0]["LABEL"] == "1,left bracket"


def test_a_3mf_file_holds_the_layers_as_lib3mf_reads_them(tmp_path: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    path = tmp_path / "rings.3mf"
    write_layers(made(), path)
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    stacks = model.GetSliceStacks()
    assert stacks.MoveNext()
    stack = stacks.GetCurrentSliceStack()
    layers = list(made())
    assert stack.GetBottomZ() == pytest.approx(layers[0].top - 0.25, abs=1e-6)
    assert stack.GetSliceCount() == len(layers)
    for number, layer in enumerate(layers):
        slice_ = stack.GetSlice(number)
        corners = np.array([list(corner.Coordinates) for corner in slice_.GetVertices()])
        polygons = [list(slice_.GetPolygonIndices(k)) for k in range(slice_.GetPolygonCount())]
        assert slice_.GetZTop() == pytest.approx(layer.top, abs=1e-6)
        assert all(one[0] == one[-1] for one in polygons)
        assert area([corners[one[:-1]] for one in polygons]) == pytest.approx(layer.area, abs=1e-4)
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    assert meshes.GetCurrentMeshObject().IsManifoldAndOriented()


def test_a_slice_stack_needs_thick_layers(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="3MF slices need the thickness of the layers"):
        write_layers(slices(STRUT, [0.5]), tmp_path / "a.3mf")


def test_a_drawing_has_a_path_a_layer(tmp_path: Path) -> None:
    path = tmp_path / "rings.svg"
    write_layers(made(), path)
    root = ElementTree.parse(path).getroot()
    groups = root.findall("{*}g")
    layers = list(made())
    assert len(groups) == len(layers)
    x, y, wide, high = map(float, root.attrib["viewBox"].split())
    for group, layer in zip(groups, layers, strict=True):
        height = group.attrib["{http://slic3r.org/namespaces/slic3r}z"]
        assert float(height) == pytest.approx(layer.top, abs=1e-6)
        shown = group[0].attrib["d"]
        polygons = [
            np.array(re.findall(r"[-\d.]+", part), dtype=float).reshape(-1, 2)
            for part in shown.split("Z")[:-1]
        ]
        assert -area(polygons) == pytest.approx(layer.area, abs=1e-4)
        corners = np.concatenate([np.array([[x, y]]), *polygons])
        assert (corners >= [x, y]).all()
        assert (corners <= [x + wide, y + high]).all()


def read_png(data: bytes) -> np.ndarray:
    """Return the pixels of an image of one bit each, without filters."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, shape, depth = 8, b"", (0, 0), b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        chunk = data[at + 8 : at + 8 + size]
        (check,) = struct.unpack_from(">I", data, at + 8 + size)
        assert check == zlib.crc32(kind + chunk)
        if kind == b"IHDR":
            shape, depth = struct.unpack_from(">II", chunk), chunk[8:]
        packed += chunk if kind == b"IDAT" else b""
        at += 12 + size
    assert (kind, depth) == (b"IEND", b"\x01\0\0\0\0")
    columns, rows = shape
    lines = np.frombuffer(zlib.decompress(packed), dtype=np.uint8).reshape(rows, -1)
    assert (lines[:, 0] == 0).all()
    return np.unpackbits(lines[:, 1:], axis=1, count=columns)


def test_images_are_white_where_it_is_solid(tmp_path: Path) -> None:
    path, pixel = tmp_path / "rings.zip", 0.02
    write_layers(made(), path, pixel=pixel)
    layers = list(made())
    with ZipFile(path) as archive:
        about = json.loads(archive.read("layers.json"))
        images = [read_png(archive.read(name)) for name in about["files"]]
    assert about["tops_mm"] == pytest.approx([layer.top for layer in layers], abs=1e-6)
    assert len(images) == len(layers)
    low = np.array(about["lower_left_mm"])
    for image, layer in zip(images, layers, strict=True):
        assert image.shape == (about["rows"], about["columns"])
        around = sum(np.linalg.norm(np.diff(one, axis=0), axis=1).sum() for one in layer.loops)
        assert image.sum() * pixel**2 == pytest.approx(layer.area, abs=0.5 * pixel * around + 1e-9)
        if not layer.loops:
            continue
        row, column = np.nonzero(image[::-1])
        white = low + pixel * (np.stack([column, row], axis=1) + 0.5)
        assert np.ptp(white, axis=0) == pytest.approx(np.ptp(layer.points, axis=0), abs=2 * pixel)


def test_pixels_are_the_same_in_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    (layer,) = slices(TETRAPOD, [1.0])
    low = layer.bounds[0] - 0.3
    whole = np.concatenate(list(raster(layer, low, 0.05, 300, 290)))
    monkeypatch.setattr("scaffold_cad.io.stacks.images.BAND", 2000)
    assert np.array_equal(np.concatenate(list(raster(layer, low, 0.05, 300, 290))), whole)
    assert whole.sum() * 0.05**2 == pytest.approx(layer.area, rel=0.01)


@pytest.mark.parametrize("suffix", STACK_SUFFIXES)
def test_empty_layers_are_written(suffix: str, tmp_path: Path) -> None:
    apart = Skeleton([[0, 0, 0], [4, 0, 0], [0, 0, 4], [4, 0, 4]], [[0, 1], [2, 3]], 0.5)
    layers = slices(apart, thickness=0.5)
    path = tmp_path / f"apart{suffix}"
    write_layers(layers, path, pixel=0.1 if suffix == ".zip" else None)
    assert path.stat().st_size > 0


@pytest.mark.parametrize("suffix", STACK_SUFFIXES)
def test_the_same_layers_give_the_same_bytes(suffix: str, tmp_path: Path) -> None:
    pixel = 0.1 if suffix == ".zip" else None
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write_layers(made(), tmp_path / name / f"part{suffix}", pixel=pixel)
    first, second = ((tmp_path / name / f"part{suffix}").read_bytes() for name in ("a", "b"))
    assert first == second


@pytest.mark.parametrize("suffix", STACK_SUFFIXES)
def test_after_an_error_the_old_file_is_still_there(suffix: str, tmp_path: Path) -> None:
    def broken() -> Iterator[Layer]:
        yield next(made())
        raise ValueError("the second layer")

    whole = made()
    path = tmp_path / f"part{suffix}"
    path.write_bytes(b"old")
    layers = Layers(broken(), whole.heights, whole.thickness, whole.box)
    with pytest.raises(ValueError, match="the second layer"):
        write_layers(layers, path, pixel=0.1 if suffix == ".zip" else None)
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    assert path.read_bytes() == b"old"


def test_layers_that_were_taken_are_not_left_out_of_a_file(tmp_path: Path) -> None:
    layers = slices(tile("sc", 5.0, 1, radius=0.5), thickness=1.0)
    next(layers)
    with pytest.raises(OptionError, match=r"1 of 7 layers are taken already, .*; need those"):
        write_layers(layers, tmp_path / "late.cli")
    assert not list(tmp_path.iterdir())


def test_write_layers_refuses_what_it_cannot_write(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"its suffix is '.stl'; layers need one of .3mf"):
        write_layers(made(), tmp_path / "a.stl")
    with pytest.raises(OptionError, match=r"text is for .cli files; a.svg is not one"):
        write_layers(made(), tmp_path / "a.svg", text=True)
    with pytest.raises(OptionError, match=r"label is for .cli files; a.svg is not one"):
        write_layers(made(), tmp_path / "a.svg", label="a")
    with pytest.raises(OptionError, match=r"pixel is for .zip files: a.svg"):
        write_layers(made(), tmp_path / "a.svg", pixel=0.1)
    with pytest.raises(OptionError, match=r"pixel is not given; need it, mm: a.zip"):
        write_layers(made(), tmp_path / "a.zip")
    with pytest.raises(OptionError, match=r"pixel is 1e-12 mm, which .* pixels .* mm or more"):
        write_layers(made(), tmp_path / "a.zip", pixel=1e-12)
    with pytest.raises(OptionError, match=r"pixel is 1e-06 mm, .*; need 4e-05 mm or more"):
        write_layers(made(), tmp_path / "a.zip", pixel=1e-6)
    with pytest.raises(FormatError, match="there are no layers; need at least one"):
        write_layers(slices(STRUT, []), tmp_path / "a.cli")
    with pytest.raises(OptionError, match="got a list; need a Layers"):
        write_layers(list(made()), tmp_path / "a.cli")  # type: ignore[arg-type]


@pytest.mark.parametrize(("distance", "fits"), [(2e4, True), (2e5, False)])
def test_binary_polygons_far_away_are_valid_or_refused(
    distance: float, fits: bool, tmp_path: Path
) -> None:
    struts = round_struts(tile("kelvin", 10.0, 1, radius=0.6).moved_by([distance, 0, 0]))
    path = tmp_path / "far.cli"
    if not fits:
        need = r"32-bit numbers up to 2000\d+ mm are 0.0156 mm apart, .* of 0.37 mm; need 1.56 mm"
        with pytest.raises(FormatError, match=need):
            write_layers(slices(struts, thickness=0.37), path)
        assert not path.exists()
        write_layers(slices(struts, thickness=0.37), path, text=True)
        return
    write_layers(slices(struts, thickness=0.37), path)
    found = [one for _, polygons, _ in read_binary_cli(path) for one in polygons]
    assert len(found) > 100
    assert not any(crosses_itself(one) for one in found)


def crosses_itself(polygon: Floats) -> bool:
    """Whether sides of a polygon (k, 2), which ends where it began, meet beside their corners."""
    polygon = polygon[np.append(True, (np.diff(polygon, axis=0) != 0).any(axis=1))]
    start, end = polygon[:-1] - polygon[0], polygon[1:] - polygon[0]
    side = end - start

    def left(points: Floats) -> Floats:  # of each side, (k, k)
        way = points[None] - start[:, None]
        return np.sign(side[:, None, 0] * way[..., 1] - side[:, None, 1] * way[..., 0])

    parted = left(start) * left(end) <= 0  # a side by the line of another one
    low, high = np.minimum(start, end), np.maximum(start, end)
    near = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    ahead = np.abs(np.subtract.outer(np.arange(len(side)), np.arange(len(side))))
    apart = (ahead > 1) & (ahead < len(side) - 1)
    return bool((parted & parted.T & near & apart).any())


@pytest.mark.parametrize("suffix", [".svg", ".3mf", ".zip"])
def test_layers_thinner_than_numbers_of_text_are_refused(suffix: str, tmp_path: Path) -> None:
    layers = slices(STRUT.scaled(1e-5), thickness=5e-6)
    pixel = 1e-5 if suffix == ".zip" else None
    with pytest.raises(FormatError, match=r"numbers of text are 1e-06 mm apart, .*need 0.0001 mm"):
        write_layers(layers, tmp_path / f"a{suffix}", pixel=pixel)
