from __future__ import annotations

import re
import zipfile
from pathlib import Path

import lib3mf
import numpy as np
import pytest
import trimesh

from scaffold_cad import build_scaffold, write
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton, read_triangles
from scaffold_cad.io.threemf import archive
from scaffold_cad.io.threemf.surfaces import write_3mf
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from tests.io.test_reading import written
from tests.skeletons import STICK_FIGURE

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
RELATIONSHIPS = """<?xml version="1.0" encoding="utf-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
  <Relationship Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    Target="/3D/3dmodel.model" Id="rel0"/>
</Relationships>"""
VERTICES = (
    '<vertices><vertex x="0" y="0" z="0"/><vertex x="10 " y=" 0" z="0"/>'
    '<vertex x="10" y="1e1" z="0"/><vertex x="99" y="99" z="99"/></vertices>'
)
TWO_BEAMS = '<b:beam v1="0" v2="1" r1="1" r2="2"/><b:beam v1="1" v2="2 "/>'
SOLID = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9 " y="0" z="0"/>'
    '<vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/></vertices><triangles>'
    '<triangle v1="0" v2="2" v3="1 "/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>'
)
"""A closed tetrahedron of 121.5 mm³."""
ITEM = '<item objectid="1"/>'


def mesh(beams: str = TWO_BEAMS, lattice: str = 'radius="1.5" minlength="0.1"') -> str:
    """Return a mesh with a lattice on four vertices."""
    return (
        f"<mesh>{VERTICES}<triangles/><b:beamlattice {lattice}><b:beams>{beams}</b:beams>"
        "</b:beamlattice></mesh>"
    )


def component(identifier: int, transform: str = "", path: str = "") -> str:
    moved = f'transform="{transform}"' if transform else ""
    elsewhere = f'p:path="{path}"' if path else ""
    return f'<component objectid="{identifier}" {moved} {elsewhere}/>'


def doubled(identifier: int) -> str:
    """Return two components that are the same object."""
    return f"<components>{component(identifier)}{component(identifier)}</components>"


def model(objects: list[str], items: str = ITEM, unit: str = 'unit="millimeter"') -> str:
    """Return a model part; objects are numbered from 1."""
    resources = "".join(
        f'<object id="{k}" type="model">{content}</object>'
        for k, content in enumerate(objects, start=1)
    )
    return (
        f'<?xml version="1.0"?><model {unit} xmlns="{CORE}"'
        ' xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"'
        ' xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">\n'
        f"<resources>{resources}</resources>\n<build>{items}</build></model>"
    )


def packed(folder: Path, text: str, others: dict[str, str] | None = None) -> Path:
    """Write an archive of a model part and others."""
    path = folder / "lattice.3mf"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", RELATIONSHIPS)
        archive.writestr("3D/3dmodel.model", text)
        for name, content in (others or {}).items():
            archive.writestr(name, content)
    return path


def test_beams_become_edges_and_vertices_without_a_beam_are_left_out(tmp_path: Path) -> None:
    raw = read_raw(packed(tmp_path, model([mesh()])))
    assert raw.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0]]
    assert raw.edges.tolist() == [[0, 1], [1, 2]]


@pytest.mark.parametrize(
    ("beams", "radii"),
    [
        ('<b:beam v1="0" v2="1"/>', [[1.5, 1.5]]),
        ('<b:beam v1="0" v2="1" r1="3"/>', [[3, 3]]),
        ('<b:beam v1="0" v2="1" r2="3"/>', [[1.5, 3]]),
        ('<b:beam v1="0" v2="1" r1="3" r2="0.5 "/>', [[3, 0.5]]),
        (
            '<b:beam v1="0" v2="1" r1="3" r2="0.5"/><b:beam v1="1" v2="2" r1="0.7"/>',
            [[3, 0.5], [0.7, 0.7]],
        ),
    ],
)
def test_beams_keep_the_radii_of_their_ends_which_have_defaults(
    tmp_path: Path, beams: str, radii: list[list[float]]
) -> None:
    raw = read_raw(packed(tmp_path, model([mesh(beams)])))
    assert raw.edge_radii is not None
    assert raw.edge_radii.tolist() == radii


def test_a_lattice_without_a_radius_takes_that_of_the_nearest_beam(tmp_path: Path) -> None:
    path = packed(tmp_path, model([mesh(lattice='minlength="0.1"')]))
    assert read_skeleton(path).radii.tolist() == [1, 2, 2]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("", 1),
        ('unit="micron"', 0.001),
        ('unit="centimeter"', 10),
        ('unit="inch"', 25.4),
        ('unit="foot"', 304.8),
        ('unit="meter"', 1000),
    ],
)
def test_units_become_millimeters_in_positions_radii_and_transforms(
    tmp_path: Path, unit: str, factor: float
) -> None:
    item = '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 7"/>'
    raw = read_raw(packed(tmp_path, model([mesh()], item, unit)))
    assert raw.edge_radii is not None
    np.testing.assert_allclose(raw.nodes[2], np.array([10, 10, 7]) * factor)
    np.testing.assert_allclose(raw.edge_radii, np.array([[1, 2], [1.5, 1.5]]) * factor)


def test_every_item_of_the_build_is_placed_and_other_objects_are_not(tmp_path: Path) -> None:
    items = '<item objectid="1"/><item objectid="1" transform="0 1 0 -1 0 0 0 0 1 100 0 0"/>'
    raw = read_raw(packed(tmp_path, model([mesh(), mesh()], items)))
    assert raw.edges.tolist() == [[0, 1], [1, 2], [3, 4], [4, 5]]
    np.testing.assert_allclose(raw.nodes[3:], [[100, 0, 0], [100, 10, 0], [90, 10, 0]])


def test_components_are_placed_in_each_other_with_radii_scaled(tmp_path: Path) -> None:
    inner = f"<components>{component(1, '2 0 0 0 2 0 0 0 2 5 0 0')}{component(1)}</components>"
    outer = f"<components>{component(2, '1 0 0 0 1 0 0 0 -1 0 0 1')}</components>"
    item = '<item objectid="3" transform="1 0 0 0 1 0 0 0 1 0 1000 0"/>'
    raw = read_raw(packed(tmp_path, model([mesh(), inner, outer], item)))
    expected = [[5, 1000, 1], [25, 1000, 1], [25, 1020, 1], [0, 1000, 1], [10, 1000, 1]]
    np.testing.assert_allclose(raw.nodes[:5], expected)
    np.testing.assert_allclose(raw.edge_radii, [[2, 4], [3, 3], [1, 2], [1.5, 1.5]])


def test_objects_in_other_parts_are_found_whatever_the_case_of_their_name(tmp_path: Path) -> None:
    root = model([f"<components>{component(1, path='/3D/Objects/one%20.model')}</components>"])
    other = {"3D/objects/One .model": model([mesh()], items="", unit='unit="centimeter"')}
    raw = read_raw(packed(tmp_path, root, other))
    assert raw.nodes.tolist() == [[0, 0, 0], [100, 0, 0], [100, 100, 0]]


def test_an_item_may_name_another_part(tmp_path: Path) -> None:
    root = model([], items='<item objectid="1" p:path="/3D/other.model"/>')
    raw = read_raw(packed(tmp_path, root, {"3D/other.model": model([mesh()])}))
    assert len(raw.edges) == 2


def test_vertices_of_other_extensions_are_not_taken_for_those_of_the_mesh(tmp_path: Path) -> None:
    alien = '<s:vertex xmlns:s="http://example.com/slice" x="5" y="5"/>'
    raw = read_raw(packed(tmp_path, model([alien + mesh()])))
    assert raw.nodes[0].tolist() == [0, 0, 0]


@pytest.mark.parametrize("name", ["clippingmode", "clipping"])
def test_a_skeleton_leaves_clipping_out_says_so_and_is_refused_where_strict(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, name: str
) -> None:
    lattice = f'radius="1" minlength="1" {name}="inside" clippingmesh="2"'
    path = packed(tmp_path, model([mesh(lattice=lattice), SOLID]))
    assert len(read_skeleton(path).edges) == 2
    said = "the clipping of 1 lattice (what is inside stays)"
    assert f"left out {said}" in caplog.text
    with pytest.raises(FormatError, match=rf"lattice\.3mf holds also {re.escape(said)}; need"):
        read_skeleton(path, strict=True)


def test_what_another_library_writes_is_read(tmp_path: Path) -> None:
    wrapper = lib3mf.get_wrapper()
    written_model = wrapper.CreateModel()
    written_model.SetUnit(lib3mf.ModelUnit.Inch)
    box = written_model.AddMeshObject()
    corners = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 4)]
    for corner in corners:
        position = lib3mf.Position()
        position.Coordinates[:] = corner
        box.AddVertex(position)
    beams = [(0, 1, 0.25, 0.5), (1, 3, 0.5, 0.5), (3, 7, 0.75, 0.125)]
    for a, b, r1, r2 in beams:
        beam = lib3mf.Beam()
        beam.Indices[:] = (a, b)
        beam.Radii[:] = (r1, r2)
        beam.CapModes[:] = (0, 0)
        box.BeamLattice().AddBeam(beam)
    assembly = written_model.AddComponentsObject()
    turn = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1], [10, 20, 30]])  # 90° about z, then a shift
    transform = lib3mf.Transform()
    for row in range(4):
        transform.Fields[row][:] = turn[row].tolist()
    assembly.AddComponent(box, transform)
    assembly.AddComponent(box, wrapper.GetIdentityTransform())
    written_model.AddBuildItem(assembly, transform)
    path = tmp_path / "other.3mf"
    written_model.QueryWriter("3mf").WriteToFile(str(path))

    raw = read_raw(path)
    used = np.array([corners[k] for k in (0, 1, 3, 7)])
    once = used @ turn[:3] + turn[3]
    twice = once @ turn[:3] + turn[3]
    np.testing.assert_allclose(raw.nodes, 25.4 * np.concatenate([twice, once]))
    radii = [beam[2:] for beam in beams]
    np.testing.assert_allclose(raw.edge_radii, 25.4 * np.array(radii + radii))
    assert raw.edges.tolist() == [[0, 1], [1, 2], [2, 3], [4, 5], [5, 6], [6, 7]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (model(["<mesh/>"]), r"lattice\.3mf builds no beam lattice; need at least one beam"),
        (model([mesh()], items=""), "builds no beam lattice"),
        (
            model([mesh()], '<item objectid="7"/>'),
            "places object '7', which /3D/3dmodel.model does",
        ),
        (model([mesh()], "<item/>"), "line 3: there is no 'objectid'; need that attribute"),
        (model([mesh()], unit='unit="mile"'), "line 1: unit is 'mile'; need one of micron, mill"),
        (
            model([mesh('<b:beam v1="0" v2="4"/>')]),
            r"lattice\.3mf/3d/3dmodel\.model, line 2: v2 is '4'; need a vertex, 0 to 3",
        ),
        (model([mesh('<b:beam v1="-1" v2="2"/>')]), "line 2: v1 is '-1'; need a vertex, 0 to 3"),
        (model([mesh('<b:beam v1="a" v2="2"/>')]), "line 2: v1 is 'a'; need a vertex, 0 to 3"),
        (model([mesh('<b:beam v1="0"/>')]), "line 2: there is no 'v2'; need that attribute"),
        (model([mesh('<b:beam v1="0" v2="1" r1="x"/>')]), "line 2: r1 is 'x'; need a number"),
        (model([mesh().replace('x="99"', "")]), "line 2: there is no 'x'; need that attribute"),
        (model([mesh().replace('"99"', '"9 9"', 1)]), "line 2: x is '9 9'; need a number"),
        (
            model([mesh()], '<item objectid="1" transform="1 2 3"/>'),
            "line 3: transform is '1 2 3'; need 12 finite numbers",
        ),
        (
            model([mesh()], '<item objectid="1" transform="1 0 0 0 1 0 0 0 nan 0 0 0"/>'),
            "line 3: transform is .*; need 12 finite numbers",
        ),
        (
            model([mesh()], '<item objectid="1" transform="1 0 0 0 x 0 0 0 1 0 0 0"/>'),
            "line 3: transform is .*; need 12 finite numbers",
        ),
        (
            model([mesh()], '<item objectid="1" transform="1 0 0 0 1 0 0 0 0 0 0 0"/>'),
            "line 3: transform is '1 0 0 0 1 0 0 0 0 0 0 0'; need one that does not flatten",
        ),
        (
            model([f"<components>{component(1)}</components>"]),
            r"lattice\.3mf nests components more than 64 deep, or endlessly",
        ),
        (
            model([], '<item objectid="1" p:path="/3D/none.model"/>'),
            r"lattice\.3mf has no part /3D/none\.model; need it",
        ),
        ("<model", r"line 1: unclosed token; need well-formed XML"),
        ("", r"line 1: no element found; need well-formed XML"),
        (
            '<!DOCTYPE m [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><model>&b;</model>',
            "declares a document type or entities; need none",
        ),
        ('<?xml version="1.0" encoding="utf-7"?><model/>', "model.* need"),
        ('<?xml version="1.0" encoding="nonsense"?><model/>', "model.* need"),
    ],
)
def test_errors_name_the_part_the_line_and_the_value(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(packed(tmp_path, text))


def test_components_that_multiply_beyond_measure_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    objects = [mesh(), *(doubled(k) for k in range(1, 40))]
    path = packed(tmp_path, model(objects, '<item objectid="40"/>'))
    monkeypatch.setattr(archive, "MOST_PARTS", 1000)
    with pytest.raises(
        FormatError, match=r"lattice\.3mf builds 1099511627776 beams and .*; need at most 1000"
    ):
        read_raw(path)


def test_components_without_beams_cost_nothing_however_they_multiply(tmp_path: Path) -> None:
    objects = ["<mesh/>", *(doubled(k) for k in range(1, 60)), mesh()]
    path = packed(tmp_path, model(objects, '<item objectid="60"/><item objectid="61"/>'))
    assert len(read_raw(path).edges) == 2


@pytest.mark.parametrize("power", [20, 200, 308])
def test_what_overflows_is_refused(tmp_path: Path, power: int) -> None:
    huge = f"1e{power}"
    item = f'<item objectid="1" transform="{huge} 0 0 0 {huge} 0 0 0 {huge} 0 0 0"/>'
    far = mesh().replace('"10 "', f'"{huge}"')
    for objects, items in (([mesh()], item), ([far], ITEM), ([far], item)):
        with pytest.raises(FormatError, match=r"lattice\.3mf: (node|edge).* (is|has) .*; need "):
            read_raw(packed(tmp_path, model(objects, items, 'unit="meter"')))


def test_a_part_that_unpacks_beyond_measure_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = packed(tmp_path, model([mesh()]) + " " * 100_000)
    assert path.stat().st_size < 5000
    monkeypatch.setattr(archive, "LARGEST_FILE", 5000)
    with pytest.raises(FormatError, match=r"has 10\d+ bytes in /3D/3dmodel\.model; need at most"):
        read_raw(path)


def test_a_file_that_is_no_archive_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"x\.3mf cannot be unpacked: File is not a zip file"):
        read_raw(written(tmp_path, "x.3mf", b"PK\x03\x04 and no more"))


def test_a_damaged_archive_is_refused(tmp_path: Path) -> None:
    path = packed(tmp_path, model([mesh()]))
    data = path.read_bytes()
    at = data.index(b"3D/3dmodel.model") + 40
    damaged = data[:at] + bytes(20) + data[at + 20 :]
    with pytest.raises(FormatError, match=r"broken\.3mf"):
        read_raw(written(tmp_path, "broken.3mf", damaged))


def test_an_archive_with_a_name_that_is_no_text_is_refused(tmp_path: Path) -> None:
    data = bytearray(packed(tmp_path, model([mesh()])).read_bytes())
    at = data.index(b"PK\x01\x02")
    data[at + 9] |= 0x08  # names are UTF-8
    data[at + 46] = 0xDD
    with pytest.raises(FormatError, match=r"broken\.3mf cannot be unpacked: .*codec"):
        read_raw(written(tmp_path, "broken.3mf", bytes(data)))


def test_an_archive_without_a_model_is_refused(tmp_path: Path) -> None:
    for name, content, message in [
        ("readme.txt", "", r"empty\.3mf has no part /_rels/\.rels; need it"),
        ("_rels/.rels", RELATIONSHIPS.replace("3dmodel", "x"), "names no 3D model in /_rels/.rels"),
        ("_rels/.rels", RELATIONSHIPS, r"empty\.3mf has no part /3D/3dmodel\.model; need it"),
    ]:
        with zipfile.ZipFile(tmp_path / "empty.3mf", "w") as archive:
            archive.writestr(name, content)
        with pytest.raises(FormatError, match=message):
            read_raw(tmp_path / "empty.3mf")


def test_a_locked_archive_is_refused(tmp_path: Path) -> None:
    path = packed(tmp_path, model([mesh()]))
    data = bytearray(path.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = data.find(signature)
        while at >= 0:
            data[at + offset] |= 1  # the flag of encryption
            at = data.find(signature, at + 4)
    with pytest.raises(FormatError, match=r"cannot be unpacked: .* encrypted"):
        read_raw(written(tmp_path, "locked.3mf", bytes(data)))


def test_meshes_are_read_as_beams_are_components_in_other_parts_and_sloppy_numbers_included(
    tmp_path: Path,
) -> None:
    moved = "1 0 0 0 1 0 0 0 1 0 0 100"
    placed = component(1, moved, "/3D/Objects/one.model") + component(2)
    root = model([f"<components>{placed}</components>", SOLID])
    others = {"3D/objects/One.model": model([SOLID], items="", unit='unit="centimeter"')}
    mesh = read_triangles(packed(tmp_path, root, others))
    assert mesh is not None
    assert len(mesh.triangles) == 8
    assert mesh.signed_volume == pytest.approx(121.5 * 1001)
    np.testing.assert_allclose([mesh.vertices[0], mesh.vertices[4]], [[0, 0, 100], [0, 0, 0]])


def test_a_mirrored_mesh_stays_outward(tmp_path: Path) -> None:
    item = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    mesh = read_triangles(packed(tmp_path, model([SOLID], item)))
    assert mesh is not None
    assert mesh.signed_volume == pytest.approx(121.5)


def test_what_lib3mf_writes_is_read_as_lib3mf_reads_it(tmp_path: Path) -> None:
    write(build_scaffold(STICK_FIGURE), tmp_path / "figure.3mf")
    mesh = read_triangles(tmp_path / "figure.3mf")
    assert mesh is not None
    found = lib3mf.get_wrapper().CreateModel()
    found.QueryReader("3mf").ReadFromFile(str(tmp_path / "figure.3mf"))
    bodies = found.GetMeshObjects()
    assert bodies.MoveNext()
    body = bodies.GetCurrentMeshObject()
    places = [list(vertex.Coordinates) for vertex in body.GetVertices()]
    np.testing.assert_array_equal(mesh.vertices.astype(np.float32), np.float32(places))
    rows = [list(row.Indices) for row in body.GetTriangleIndices()]
    np.testing.assert_array_equal(mesh.triangles, rows)


def test_beams_clipped_to_what_is_not_there_are_refused(tmp_path: Path) -> None:
    lattice = 'radius="1" minlength="1" clippingmode="inside" clippingmesh="2"'
    with pytest.raises(
        FormatError, match=r"clips beams to object '2', or .* which is not a mesh in /3D"
    ):
        read_raw(packed(tmp_path, model([mesh(lattice=lattice)])))
    lattice = 'radius="1" minlength="1" clippingmode="inside"'
    with pytest.raises(FormatError, match="clippingmode is 'inside'; need the attribute clippingm"):
        read_raw(packed(tmp_path, model([mesh(lattice=lattice)])))


def test_a_long_chain_of_components_is_read_in_any_order(tmp_path: Path) -> None:
    chain = [f"<components>{component(k)}</components>" for k in range(1, 60)]
    path = packed(tmp_path, model([mesh(), *chain], '<item objectid="60"/><item objectid="1"/>'))
    assert len(read_raw(path).edges) == 4


def test_objects_that_multiply_beyond_measure_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archive, "MOST_PIECES", 3)
    path = packed(tmp_path, model([mesh(), doubled(1), doubled(2)], '<item objectid="3"/>'))
    with pytest.raises(FormatError, match=r"lattice\.3mf builds 4 objects; need at most 3"):
        read_raw(path)


def test_a_reader_has_the_32_bit_numbers_within_a_step(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    corners = random.uniform(-12, 12, (4, 3)) * random.choice([1.0, 0.1, 0.01], (4, 3))
    faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    mesh = TriangleMesh(corners.astype(np.float32), faces)
    if mesh.signed_volume < 0:
        mesh = TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1])
    write(mesh, tmp_path / "corners.3mf")
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(tmp_path / "corners.3mf"))
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    read = [vertex.Coordinates[:] for vertex in meshes.GetCurrentMeshObject().GetVertices()]
    np.testing.assert_allclose(
        np.sort(read, axis=0), np.sort(mesh.vertices, axis=0), rtol=2**-23, atol=1e-9
    )


@pytest.mark.parametrize("extent", [1e-3, 1.0, 33.0, 1e6])
def test_readers_get_the_coordinates_that_were_written(extent: float, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    points = extent * rng.uniform(-1, 1, (40, 3)).astype(np.float32).astype(np.float64)
    points = points.astype(np.float32).astype(np.float64)
    mesh = TriangleMesh(points, np.arange(40)[:39].reshape(-1, 3))
    write_3mf(mesh, tmp_path / "mesh.3mf")
    read = trimesh.load(tmp_path / "mesh.3mf", process=False, force="mesh")
    np.testing.assert_array_equal(read.vertices.astype(np.float32)[:39], points[:39])
    wrapper = lib3mf.Wrapper()
    model = wrapper.CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(tmp_path / "mesh.3mf"))
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    vertices = meshes.GetCurrentMeshObject().GetVertices()
    read = np.array([list(each.Coordinates) for each in vertices])
    np.testing.assert_array_equal(read[:39], points[:39])
