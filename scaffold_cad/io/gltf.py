"""glTF: the bones of skins are read, meshes are written as GLB (binary glTF 2.0)."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.io._document import member, number, parsed_document, read_document
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, check_size
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products import to_trimesh

_MM = 1000.0
"""mm in a meter, glTF's unit."""

_MAGIC = b"glTF"
_JSON_CHUNK = b"JSON"


def _recognizes(head: bytes) -> bool:
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    return head.startswith(_MAGIC) or (text.startswith(b"{") and b'"asset"' in text)


@register_reader("glTF", ".gltf", ".glb", recognizes=_recognizes)
def read_gltf(path: Path) -> RawSkeleton:
    """Read the skins of a glTF or GLB file, which have no radii.

    Each joint of a skin is a node, and is joined to the nearest joint above it in the hierarchy.
    The pose is that of the file's node transforms, which exporters set to the rest pose;
    animations, and the meshes that hang on the bones, are left out. glTF measures in meters with
    y up: (x, y, z) m becomes (x, -z, y) mm, as `write` turns it the other way for GLB.
    """
    check_size(path, LARGEST_FILE)
    with path.open("rb") as stream:
        binary = stream.read(4) == _MAGIC
    document = parsed_document(path, _glb_text(path)) if binary else read_document(path)
    skins = member(path, document, "skins", list) if "skins" in document else []
    rows = member(path, document, "nodes", list) if skins else []
    joints = [
        _index(path, joint, len(rows), "a joint of a skin")
        for k, skin in enumerate(skins)
        for joint in member(path, skin, "joints", list, f"skin {k}")
    ]
    if not joints:
        raise FormatError(f"{path} has no skin; need one with joints")
    order, parent = _hierarchy(path, rows)
    place, above = _pose(path, rows, order, parent, frozenset(joints))
    bones = np.unique(np.asarray(joints, dtype=np.intp))
    child = bones[above[bones] >= 0]
    edges = np.searchsorted(bones, np.stack([above[child], child], axis=1))
    x, y, z = place[bones].T
    return RawSkeleton(np.stack([x, -z, y], axis=1) * _MM, edges, unit="m")


def _glb_text(path: Path) -> str:
    """Return the JSON of a binary glTF file."""
    data = path.read_bytes()
    if len(data) < 20:
        raise FormatError(f"{path} ends within its header; need 20 bytes and more")
    version, length, chunk = struct.unpack_from("<III", data, 4)
    if version != 2 or data[16:20] != _JSON_CHUNK:
        raise FormatError(f"{path} is not GLB of version 2 that begins with JSON; need that")
    if length != len(data) or 20 + chunk > length:
        raise FormatError(f"{path} has {len(data)} bytes; need {max(length, 20 + chunk)}")
    return data[20 : 20 + chunk].decode("utf-8", errors="replace")


def _hierarchy(path: Path, rows: list[Any]) -> tuple[list[int], Ints]:
    """Return the nodes, parents before children, and the parent of each, -1 without one."""
    parent = np.full(len(rows), -1, dtype=np.intp)
    children = []
    for k, row in enumerate(rows):
        if not isinstance(row, dict):
            raise FormatError(f"{path} has {str(row)[:80]!r} as node {k}; need an object")
        found = member(path, row, "children", list, f"node {k}") if "children" in row else []
        children.append([_index(path, child, len(rows), f"a child of node {k}") for child in found])
        for child in children[k]:
            if parent[child] >= 0:
                raise FormatError(f"{path} has node {child} below two others; need one at most")
            parent[child] = k
    order = np.flatnonzero(parent < 0).tolist()
    for node in order:  # grows as it goes
        order += children[node]
    if len(order) < len(rows):
        raise FormatError(f"{path} has nodes below themselves; need a hierarchy")
    return order, parent


def _pose(
    path: Path, rows: list[Any], order: list[int], parent: Ints, joints: frozenset[int]
) -> tuple[Floats, Ints]:
    """Return the place of each node, m, and the nearest joint above it, -1 without one."""
    world = np.empty((len(rows), 4, 4))
    above = np.full(len(rows), -1, dtype=np.intp)
    for node in order:
        local, up = _transform(path, rows[node], node), parent[node]
        world[node] = local if up < 0 else world[up] @ local
        if up >= 0:
            above[node] = up if int(up) in joints else above[up]
    return world[:, :3, 3], above


def _transform(path: Path, row: Any, node: int) -> Floats:
    """Return the transform of a node to its parent, shape (4, 4), for columns."""
    if "matrix" in row:
        return np.reshape(_numbers(path, row, "matrix", node, 16), (4, 4)).T
    transform = np.eye(4)
    scale = _numbers(path, row, "scale", node, 3) if "scale" in row else [1.0, 1.0, 1.0]
    if "rotation" in row:
        transform[:3, :3] = _rotation(*_numbers(path, row, "rotation", node, 4))
    transform[:3, :3] *= scale
    if "translation" in row:
        transform[:3, 3] = _numbers(path, row, "translation", node, 3)
    return transform


def _rotation(x: float, y: float, z: float, w: float) -> Floats:
    """Return the matrix of a unit quaternion."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _numbers(path: Path, row: Any, key: str, node: int, count: int) -> list[float]:
    values = member(path, row, key, list, f"node {node}")
    if len(values) != count:
        raise FormatError(f"{path} has {len(values)} numbers as {key} of node {node}; need {count}")
    found = [number(path, value, f"{key} of node {node}") for value in values]
    if max(map(abs, found)) > 1e12:
        raise FormatError(f"{path} has {max(found, key=abs):g} in {key} of node {node}; need 1e12")
    return found


def _index(path: Path, value: Any, count: int, where: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < count:
        raise FormatError(f"{path} has {str(value)[:80]} as {where}; need 0 to {count - 1}")
    return value


@register_writer(".glb", name="GLB", skeletons=False, names_unit=True)
def write_glb_content(content: Content, path: Path) -> None:
    """Write the triangles of what `write` is given."""
    write_glb(content.triangles(), path)


def write_glb(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` as glTF has it: in meters, y up, so (x, y, z) mm is at (x, z, -y) / 1000.

    Its positions are in mm, below a node that scales them: divided by 1000 their 32-bit numbers
    would be rounded again, and would not be those that were checked for crossings.
    """
    turned = to_trimesh(TriangleMesh(mesh.vertices[:, [0, 2, 1]] * (1, 1, -1), mesh.triangles))
    scene = turned.scene()
    scene.apply_transform(np.diag([1 / _MM, 1 / _MM, 1 / _MM, 1.0]))
    path.write_bytes(scene.export(file_type="glb"))
