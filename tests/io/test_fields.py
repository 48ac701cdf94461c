"""Fields in files: what pyvista writes is read back, tables, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.base.fields import Field, PointField
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import read_field

BROKEN_IMAGE = """<VTKFile type="ImageData"><ImageData Origin="0 0" Spacing="1 1 1">
<Piece Extent="0 1 0 1 0 1"/></ImageData></VTKFile>"""


def linear(points: np.ndarray) -> np.ndarray:
    return np.asarray(1.0 + points @ [0.1, 0.2, 0.3])


@pytest.fixture
def places() -> np.ndarray:
    return np.random.default_rng(0).uniform([1.5, 2.5, 2.5], [4.5, 6.0, 4.9], (40, 3))


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("data", ["points", "cells"])
def test_images_of_vtk_are_read(
    tmp_path: Path, places: np.ndarray, data: str, binary: bool
) -> None:
    pyvista = pytest.importorskip("pyvista")
    image = pyvista.ImageData(dimensions=(9, 7, 6), spacing=(0.5, 1.0, 0.75), origin=(1, 1, 2))
    if data == "points":
        image.point_data["density"] = linear(np.asarray(image.points))
    else:
        image.cell_data["density"] = linear(np.asarray(image.cell_centers().points))
    image.save(tmp_path / "field.vti", binary=binary)
    field = read_field(tmp_path / "field.vti")
    assert isinstance(field, Field)
    np.testing.assert_allclose(field(places), linear(places), rtol=1e-6)


def test_point_data_of_meshes_are_read_by_name(tmp_path: Path, places: np.ndarray) -> None:
    pyvista = pytest.importorskip("pyvista")
    mesh = pyvista.ImageData(dimensions=(6, 8, 6)).cast_to_unstructured_grid()
    mesh.point_data["stress"] = linear(np.asarray(mesh.points))
    mesh.point_data["other"] = np.zeros(mesh.n_points)
    mesh.save(tmp_path / "result.vtu")
    field = read_field(tmp_path / "result.vtu", "stress")
    assert isinstance(field, PointField)
    np.testing.assert_allclose(field(places), linear(places), rtol=1e-5)
    with pytest.raises(FormatError, match=r"the data .* in PointData; need name= one of them"):
        read_field(tmp_path / "result.vtu")
    with pytest.raises(FormatError, match=r"no data 'strain' in PointData, but .*'stress'"):
        read_field(tmp_path / "result.vtu", "strain")


@pytest.mark.parametrize("heading", ["", "x,y,z,value\n", "# made by hand\n"])
def test_tables_are_read(tmp_path: Path, places: np.ndarray, heading: str) -> None:
    points = np.random.default_rng(1).uniform(0, 9, (400, 3))
    rows = [",".join(map(repr, [*p.tolist(), float(linear(p))])) for p in points]
    path = tmp_path / "field.csv"
    path.write_text(heading + "\n".join(rows) + "\n", "utf-8")
    np.testing.assert_allclose(read_field(path)(places), linear(places), rtol=1e-9)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("x;y;z;r\n0;0;0;0,5\n10;0;0;1,5\n", None),  # decimal commas
        ("0 0 0 0.5\n10 0 0 1.5\n", None),
        ("made by hand\n0\t0\t0\t0.5\n10\t0\t0\t1.5\n", None),
        ("r,z,y,x\n0.5,0,0,0\n1.5,0,0,10\n", None),
        ("x [m],y [m],z [m],r [mm]\n0,0,0,0.5\n0.01,0,0,1.5\n", None),
        ("node,x,y,z,heat,radius (cm)\n7,0,0,0,3,0.05\n8,10,0,0,3,0.15\n", "radius"),
        ('"mises","Points:0","Points:1","Points:2"\n0.5,0,0,0\n1.5,10,0,0\n', "mises"),
    ],
)
def test_headings_tell_the_columns_of_a_table(tmp_path: Path, text: str, name: str | None) -> None:
    (tmp_path / "field.csv").write_text(text, "utf-8")
    field = read_field(tmp_path / "field.csv", name)
    np.testing.assert_allclose(field(np.array([[0.0, 0, 0], [10, 0, 0]])), [0.5, 1.5])


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("field.csv", "x,y,z,a,b\n0,0,0,1,2\n", "has the data 'a', 'b'; need name= one of them"),
        ("field.csv", "a,b,c,d\n0,0,0,1\n", "headings 'a, b, c, d' above 4 columns; need one for"),
        ("field.csv", "x,y,z\n0,0,0,1\n", "headings 'x, y, z' above 4 columns; need one for each"),
        ("field.csv", "x [px],y,z,r\n0,0,0,1\n", r"column 'x \[px\]' has no unit of length; need"),
        ("field.csv", "x,y,z\n0,0,0\n", "line 2: '0 0 0' is too short; need x, y, z and a value"),
        ("field.stl", "solid", "is of no format of fields; need one of .vti"),
        ("field.csv", "x,y,z\n", "has no line of numbers"),
        ("field.csv", "0,0,0,1\n0,0,1\n", "line 2.*too short"),
        ("field.csv", "0,0,0,1\n0,0,1,a\n", "line 2.*'a' is not a number"),
        ("field.vti", '<VTKFile type="PolyData"/>', "holds PolyData; need ImageData"),
        (
            "field.vti",
            BROKEN_IMAGE,
            "has Origin '0 0'; need 3 numbers",
        ),
    ],
)
def test_faults_are_named(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text, "utf-8")
    with pytest.raises((FormatError, OptionError), match=message):
        read_field(tmp_path / name)
