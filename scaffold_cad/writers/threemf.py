"""3MF files through lib3mf: one mesh object, in mm."""

from __future__ import annotations

from ctypes import c_uint64, string_at
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np

from scaffold_cad.backends import need
from scaffold_cad.trianglemesh import TriangleMesh


def write_3mf(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` with 32-bit coordinates; the same mesh always gives the same bytes.

    Raises
    ------
    MissingBackendError
        If lib3mf is not installed.
    """
    need("lib3mf", "a 3MF file")
    import lib3mf

    wrapper = lib3mf.Wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(lib3mf.ModelUnit.MilliMeter)
    body = model.AddMeshObject()
    vertices = mesh.vertices.astype(np.float32)
    triangles = mesh.triangles.astype(np.uint32)
    # `SetGeometry` would make a Python object of each row; the library takes the buffers.
    wrapper.checkError(
        body,
        wrapper.lib.lib3mf_meshobject_setgeometry(
            body._handle,
            c_uint64(len(vertices)),
            (lib3mf.Position * len(vertices)).from_buffer(vertices),
            c_uint64(len(triangles)),
            (lib3mf.Triangle * len(triangles)).from_buffer(triangles),
        ),
    )
    item = model.AddBuildItem(body, wrapper.GetIdentityTransform())

    digest = sha256(vertices.tobytes() + triangles.tobytes()).digest()
    for number, set_identifier in enumerate((model.SetBuildUUID, body.SetUUID, item.SetUUID)):
        set_identifier(_identifier(digest, number))
    path.write_bytes(_package(model))


def _package(model: Any) -> bytes:
    """Return the file that holds `model`.

    It is made in memory: on a full disk lib3mf would end the whole process.
    """
    from lib3mf import SeekCallback, WriteCallback

    file = BytesIO()

    def put(address: int, size: int, _: object) -> None:
        file.write(string_at(address, size))

    def seek(position: int, _: object) -> None:
        file.seek(position)

    model.QueryWriter("3mf").WriteToCallback(WriteCallback(put), SeekCallback(seek), None)
    return file.getvalue()


def _identifier(digest: bytes, number: int) -> str:
    """Return the identifier of one part of the file whose content has `digest`.

    lib3mf would draw a random one.
    """
    return str(UUID(bytes=sha256(digest + bytes([number])).digest()[:16], version=4))
