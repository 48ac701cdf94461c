"""3MF files through lib3mf: one object of triangles or of beams, in mm."""

from __future__ import annotations

from ctypes import c_uint64, string_at
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np

from scaffold_cad.arrays import Points, Triangles
from scaffold_cad.backends import need
from scaffold_cad.errors import FormatError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.trianglemesh import TriangleMesh

BEAM = np.dtype([("ends", "<u4", 2), ("radii", "<f8", 2), ("caps", "<i4", 2)])
"""A beam as lib3mf takes it, without gaps between the fields."""

LEAST_RADIUS = 1e-6
"""Least radius that six decimals can hold, mm."""

SHORTEST_BEAM = 1e-6
"""Length below which a program may leave out a beam, mm."""


def write_3mf(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` with 32-bit coordinates; the same mesh always gives the same bytes.

    Raises
    ------
    MissingBackendError
        If lib3mf is not installed.
    """
    _write(path, mesh.vertices, mesh.triangles, None)


def write_3mf_beams(skeleton: Skeleton, path: Path) -> None:
    """Write `skeleton` as a beam lattice with 32-bit coordinates, always with the same bytes.

    A beam tapers from the radius of one node to that of the other and ends in spheres: together
    they are the solid of round struts with a ball at each node. lib3mf writes six
    decimals of coordinates and radii.

    Raises
    ------
    FormatError
        If a radius is too small for that; the node is named.
    MissingBackendError
        If lib3mf is not installed.
    """
    thin = np.flatnonzero(skeleton.radii < LEAST_RADIUS)
    if len(thin):
        raise FormatError(
            f"node {thin[0]} has radius {skeleton.radii[thin[0]]:g} mm; a beam lattice needs "
            f"{LEAST_RADIUS:g} mm or more"
        )
    beams = np.zeros(len(skeleton.edges), dtype=BEAM)  # all ends are spheres
    beams["ends"] = skeleton.edges
    beams["radii"] = skeleton.radii[skeleton.edges]
    _write(path, skeleton.nodes, np.zeros((0, 3), dtype=np.intp), beams)


def _write(path: Path, points: Points, faces: Triangles, beams: np.ndarray | None) -> None:
    """Write one object of triangles, of beams, or of both."""
    need("lib3mf", "a 3MF file")
    import lib3mf

    wrapper = lib3mf.Wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(lib3mf.ModelUnit.MilliMeter)
    body = model.AddMeshObject()
    vertices = points.astype(np.float32)
    triangles = faces.astype(np.uint32)
    digest = sha256(vertices.tobytes() + triangles.tobytes())
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
    if beams is not None:
        lattice = body.BeamLattice()
        lattice.SetMinLength(SHORTEST_BEAM)
        wrapper.checkError(
            lattice,
            wrapper.lib.lib3mf_beamlattice_setbeams(
                lattice._handle,
                c_uint64(len(beams)),
                (lib3mf.Beam * len(beams)).from_buffer(beams),
            ),
        )
        digest.update(beams.tobytes())
    item = model.AddBuildItem(body, wrapper.GetIdentityTransform())

    for number, set_identifier in enumerate((model.SetBuildUUID, body.SetUUID, item.SetUUID)):
        set_identifier(_identifier(digest.digest(), number))
    path.write_bytes(_package(model, _decimals(vertices)))


def _decimals(vertices: np.ndarray) -> int:
    """Return how many decimals tell 32-bit coordinates apart, those of small parts more than 6."""
    extent = max(float(np.abs(vertices).max(initial=0.0)), 1e-9)
    return int(np.clip(7 - np.floor(np.log10(extent)), 6, 16))


def _package(model: Any, decimals: int) -> bytes:
    """Return the file that holds `model`, its coordinates with so many `decimals`.

    It is made in memory: on a full disk lib3mf would end the whole process.
    """
    from lib3mf import SeekCallback, WriteCallback

    file = BytesIO()

    def put(address: int, size: int, _: object) -> None:
        file.write(string_at(address, size))

    def seek(position: int, _: object) -> None:
        file.seek(position)

    writer = model.QueryWriter("3mf")
    writer.SetDecimalPrecision(decimals)
    writer.WriteToCallback(WriteCallback(put), SeekCallback(seek), None)
    return file.getvalue()


def _identifier(digest: bytes, number: int) -> str:
    """Return the identifier of one part of the file whose content has `digest`.

    lib3mf would draw a random one.
    """
    return str(UUID(bytes=sha256(digest + bytes([number])).digest()[:16], version=4))
