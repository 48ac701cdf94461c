"""Files are data, never trusted: cut short, damaged, or made to harm."""

from __future__ import annotations

import base64
import json
import re
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scaffold_cad.cli import main
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton, read_with_repairs
from scaffold_cad.io.threemf.archive import SMALL_PART
from tests.fuzz.members import MEMBERS
from tests.fuzz.mutation import mutated
from tests.fuzz.reading import outcome
from tests.fuzz.samples import RHINO, SAMPLES
from tests.io.test_reading import written

OPEN_ENDED = ("lines.obj", "rhino.obj", "cell.wire", "neuron.swc", "removed.graph", "path.cgal")
OPEN_ENDED += ("path.polylines.txt", "path.tgf", "members.csv", "german.csv", "tables.csv")
OPEN_ENDED += ("path.tsv", "tree.csv", "beams.inp", "parts.inp", "free.dat", "model.tcl")
OPEN_ENDED += ("pyskelton.graph", "libigl.tgf", "plane.wire", "elbow.pdb", "bare.ent")
"""Formats whose files may end after any line, so that one that was cut may still be whole."""


@pytest.mark.parametrize("name", SAMPLES)
def test_samples_are_read(tmp_path: Path, name: str) -> None:
    assert outcome(written(tmp_path, name, SAMPLES[name])).edges > 0


@pytest.mark.parametrize("name", SAMPLES)
def test_a_file_that_was_cut_short_is_refused_or_read_whole(tmp_path: Path, name: str) -> None:
    content = SAMPLES[name]
    path = written(tmp_path, name, content)
    whole = outcome(path).edges
    step = max(1, len(content) // 120)
    for length in range(0, len(content), step):
        path.write_bytes(content[:length])
        found = outcome(path)
        if found.message:
            assert str(path) in found.message
        else:
            assert name in OPEN_ENDED or found.edges == whole, length


@pytest.mark.parametrize("name", SAMPLES)
def test_a_damaged_file_is_read_or_refused_by_name(
    tmp_path_factory: pytest.TempPathFactory, name: str
) -> None:
    path = tmp_path_factory.mktemp("damaged") / name

    @settings(max_examples=15, database=None, suppress_health_check=list(HealthCheck))
    @given(st.data())
    def check(data: st.DataObject) -> None:
        path.write_bytes(data.draw(mutated(SAMPLES[name])))
        found = outcome(path)
        assert found.edges > 0 or str(path) in found.message

    check()


@pytest.mark.parametrize("name", ["ours.json", "arm.gltf", "old_frame.json", "molecule.cjson"])
def test_deep_json_is_refused(tmp_path: Path, name: str) -> None:
    head = SAMPLES[name].split(b"[")[0]
    path = written(tmp_path, name, head + b"[" * 200_000)
    with pytest.raises(FormatError, match="nested too deeply"):
        read_raw(path)


@pytest.mark.parametrize(
    ("name", "head"),
    [
        ("bomb.gxl", "<gxl>&d;</gxl>"),
        ("bomb.vtp", '<VTKFile type="PolyData"><Piece>&d;</Piece></VTKFile>'),
    ],
)
def test_entities_are_refused(tmp_path: Path, name: str, head: str) -> None:
    entities = '<!ENTITY a "aaaaaaaaaa">' + "".join(
        f'<!ENTITY {new} "{f"&{old};" * 10}">' for old, new in ("ab", "bc", "cd")
    )
    path = written(tmp_path, name, f"<!DOCTYPE x [{entities}]>{head}")
    with pytest.raises(FormatError, match="declares a document type or entities; need none"):
        read_raw(path)


def test_an_external_entity_is_refused(tmp_path: Path) -> None:
    secret = written(tmp_path, "secret.txt", "1 2 3")
    text = f'<!DOCTYPE gxl [<!ENTITY s SYSTEM "file://{secret}">]><gxl>&s;</gxl>'
    with pytest.raises(FormatError, match="declares a document type or entities; need none"):
        read_raw(written(tmp_path, "outside.gxl", text))


def test_a_zip_bomb_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "bomb.3mf"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", b" " * (SMALL_PART + 1))
    with pytest.raises(FormatError, match=r"unpacks _rels/\.rels to \d+ times its size; need"):
        read_raw(path)


def test_a_part_that_lies_about_its_size_is_refused(tmp_path: Path) -> None:
    content = bytearray(SAMPLES["beams.3mf"])
    for signature, at in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        start = content.find(signature)
        struct.pack_into("<I", content, start + at, 5)
    with pytest.raises(FormatError, match=r"lies\.3mf"):
        read_raw(written(tmp_path, "lies.3mf", bytes(content)))


def test_a_part_outside_the_archive_is_not_looked_for(tmp_path: Path) -> None:
    written(tmp_path, "secret.model", "<model/>")
    path = tmp_path / "outside.3mf"
    relations = SAMPLES["beams.3mf"]
    with zipfile.ZipFile(written(tmp_path, "sound.3mf", relations)) as archive:
        text = archive.read("_rels/.rels").decode().replace("/3D/3dmodel.model", "../secret.model")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("_rels/.rels", text)
    with pytest.raises(FormatError, match=r"has no part \.\./secret\.model; need it"):
        read_raw(path)


def test_a_packed_array_that_grows_is_refused(tmp_path: Path) -> None:
    block = zlib.compress(b"\0" * 10**6)
    for size, message in ((24, "a block of 25 bytes instead of 24"), (2**31, "bytes, more than")):
        header = struct.pack("<4I", 1, size, size, len(block))
        text = (base64.b64encode(header) + base64.b64encode(block)).decode()
        content = (
            '<VTKFile type="PolyData" compressor="vtkZLibDataCompressor"><Piece NumberOfPoints="1">'
            f'<Points><DataArray type="Float64" format="binary">{text}</DataArray></Points>'
            "</Piece></VTKFile>"
        )
        with pytest.raises(FormatError, match=message):
            read_raw(written(tmp_path, "grows.vtp", content))


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("text.vtk", b"POINTS 4", b"POINTS 999999999999999999", "ends within 29+7 numbers"),
        ("binary.vtk", b"CELLS 2 6", b"CELLS 2 999999999999", "ends within 999999999999 numbers"),
        ("text.vtk", b"LINES 2 7", b"LINES 2 -7", "need a count, 0 or more, as word 3"),
        ("faces.ply", b"vertex 4", b"vertex 999999999999", "ends within 9+ elements 'vertex'"),
        ("tetrahedron.off", b"4 4 6", b"4 999999999 6", "8 lines of 4 vertices and 9+ faces"),
        ("water.xyz", b"3 water", b"999999999999", "has 3 atoms; need 999999999999"),
        ("path.cgal", b"2 10", b"99999999999999999999 10", "line 2: N is 9+ with 6 numbers"),
    ],
)
def test_absurd_counts_are_refused(
    tmp_path: Path, name: str, old: bytes, new: bytes, message: str
) -> None:
    content = SAMPLES[name].replace(old, new)
    assert content != SAMPLES[name]
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, name, content))


def test_an_stl_that_is_shorter_than_it_says_is_refused(tmp_path: Path) -> None:
    content = bytearray(SAMPLES["binary.stl"])
    struct.pack_into("<I", content, 80, 2**32 - 1)
    with pytest.raises(FormatError, match=r"has 284 bytes; need 214748364834, as its header says"):
        read_raw(written(tmp_path, "short.stl", bytes(content)))


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("lines.obj", b"v 10 10 5", b"v 1e300 10 5"),
        ("neuron.swc", b"2 3 10", b"2 3 inf"),
        ("mocap.bvh", b"0 10 0", b"0 1e300 0"),
        ("path.tgf", b"10, 0", b"-inf, 0"),
        ("molecule.cjson", b"[0, 0, 0, 1.5", b"[0, 0, 0, 1e300"),
        ("arm.gltf", b"[0.01", b"[1e300"),
        ("old_frame.json", b'"X": 10.0', b'"X": 1e999'),
        ("r12.dxf", b"\n20\n10\n", b"\n20\n1e300\n"),
        ("vessels.gxl", b"<float>10<", b"<float>1e300<"),
        ("text.vtk", b"10 10 5", b"10 10 1e300"),
        ("text.vtp", b"10.0 10.0 5.0", b"10.0 10.0 1e300"),
        ("text.stl", b"vertex 10.0", b"vertex 1e300"),
        ("tetrahedron.off", b"0 0 10\n", b"0 0 1e300\n"),
    ],
)
def test_absurd_coordinates_are_refused(tmp_path: Path, name: str, old: bytes, new: bytes) -> None:
    content = SAMPLES[name].replace(old, new)
    assert content != SAMPLES[name]
    path = written(tmp_path, name, content)
    with pytest.raises(FormatError, match=path.name):
        read_raw(path)


def test_more_nodes_than_asked_for_are_refused_with_an_estimate(tmp_path: Path) -> None:
    path = written(tmp_path, "lines.obj", SAMPLES["lines.obj"])
    assert len(read_skeleton(path, 1.0, max_nodes=4).nodes) == 4
    message = r"has 4 nodes and 3 edges; need at most 3 nodes: .* about \S+ GB of memory"
    for strict in (False, True):
        with pytest.raises(FormatError, match=message):
            read_skeleton(path, 1.0, strict, max_nodes=3)


@pytest.mark.parametrize("command", ["info", "build"])
def test_the_command_line_guards_memory(
    tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, "curve.obj", RHINO)
    target = ["-o", str(tmp_path / "out.stl"), "--radius", "1"] if command == "build" else []
    assert main([command, str(path), "--max-nodes", "1", *target]) == 2
    error = capsys.readouterr().err
    assert error.startswith("scaffold-cad: ")
    assert "need at most 1 nodes" in error
    assert "--max-nodes" in error
    assert not (tmp_path / "out.stl").exists()


def test_numbers_of_thousands_of_digits_are_refused(tmp_path: Path) -> None:
    content = json.dumps({"node_list": [], "element_list": []}).replace("[]", "9" * 10**5, 1)
    with pytest.raises(FormatError, match="need finite numbers"):
        read_raw(written(tmp_path, "long.json", content))


@pytest.mark.parametrize("wobble", [0.0, 1e-5])
def test_a_bundle_of_thousands_of_overlapping_edges_becomes_a_path(
    tmp_path: Path, wobble: float
) -> None:
    count = 3000
    rng = np.random.default_rng(0)
    places = rng.permutation(np.arange(1, count))
    rows = [f"v {x} {wobble * rng.uniform(-1, 1)} 0" for x in [0, *places]]
    rows += [f"l 1 {k}" for k in range(2, count + 1)]
    cleaning = read_with_repairs(written(tmp_path, "bundle.obj", "\n".join(rows)), 0.01)
    assert cleaning.skeleton.valency.max() == 2
    assert len(cleaning.skeleton.edges) == count - 1


def test_all_pairs_of_points_on_a_line_become_a_path(tmp_path: Path) -> None:
    rows = [f"v {k} 0 0" for k in range(60)]
    rows += [f"l {a} {b}" for a in range(1, 61) for b in range(1, a)]
    cleaning = read_with_repairs(written(tmp_path, "line.obj", "\n".join(rows)), 0.01)
    assert cleaning.skeleton.lengths.tolist() == [1.0] * 59
    assert len(cleaning.skeleton.extremities) == 2


@pytest.mark.parametrize(
    ("name", "head", "repeated"),
    [
        ("again.vtp", b'<VTKFile type="PolyData">', b"<AppendedData "),
        ("again.vtk", b"# vtk DataFile Version 3.0\na\nASCII\n", b"POINTS 0 float\n"),
        ("again.gxl", b"", b"<!DOCTYPE"),
    ],
)
def test_a_section_that_is_repeated_endlessly_is_refused(
    tmp_path: Path, name: str, head: bytes, repeated: bytes
) -> None:
    found = outcome(written(tmp_path, name, head + repeated * 10_000))
    assert name in found.message


@pytest.mark.parametrize("name", MEMBERS)
def test_whole_numbers_that_are_none_are_refused_or_text(tmp_path: Path, name: str) -> None:
    content = MEMBERS[name]
    for found in re.finditer(rb"(?<![\w.])\d+(?![\w.])", content):
        for word in (b"9" * 5000, "²".encode(), b"\x1e" + found[0]):
            changed = content[: found.start()] + word + content[found.end() :]
            assert outcome(written(tmp_path, name, changed)).fault == ""
