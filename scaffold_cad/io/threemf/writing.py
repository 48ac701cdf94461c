"""3MF files through lib3mf: objects of triangles, of beams, or of both, in mm."""

from __future__ import annotations

from ctypes import c_uint64, string_at
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np

from scaffold_cad.base.arrays import Floats, Points, Triangles
from scaffold_cad.base.backends import need
from scaffold_cad.errors import FormatError
from scaffold_cad.products.assembly import Assembly
from scaffold_cad.skeleton.beams import BeamLattice

BEAM = np.dtype([("ends", "<u4", 2), ("radii", "<f8", 2), ("caps", "<i4", 2)])
"""A beam as lib3mf takes it, without gaps between the fields."""

BALL = np.dtype([("node", "<u4"), ("radius", "<f8")])
"""A ball as lib3mf takes it."""

LEAST_RADIUS = 1e-6
"""Least radius that six decimals can hold, mm."""

SHORTEST_BEAM = 1e-6
"""Length below which a program may leave out a beam, mm."""


def write_3mf_assembly(assembly: Assembly, path: Path) -> None:
    """Write beam lattices and meshes with 32-bit coordinates; the same always give the same bytes.

    A beam tapers between the radii of its ends. lib3mf writes six decimals of coordinates and
    radii.

    Parameters
    ----------
    assembly : each mesh of a lattice, and what it is clipped to, is a TriangleMesh or None

    Raises
    ------
    FormatError
        If a radius is too small for that; the node is named.
    MissingBackendError
        If lib3mf is not installed.
    """
    for lattice in assembly.lattices:
        check_sizes(lattice.skeleton.radii, "has radius")
        check_sizes(lattice.skeleton.edge_radii.min(axis=1), "is of an edge of radius")
        check_sizes(np.where(lattice.balls > 0, lattice.balls, np.inf), "has a ball of radius")
    package = _Package()
    for lattice in assembly.lattices:
        package.build(_add_lattice(package, lattice))
    for mesh in assembly.meshes:
        package.build(package.add_mesh(mesh.vertices, mesh.triangles))
    package.write(path)


def _add_lattice(package: _Package, lattice: BeamLattice) -> Any:
    """Add a lattice as an object, and return it."""
    skeleton, mesh = lattice.skeleton, lattice.mesh
    # An object may only name those before it.
    clip, shown = (
        None if part is None else package.add_mesh(part.vertices, part.triangles)
        for part in (lattice.clip, lattice.representation)
    )
    points, faces = skeleton.nodes, np.zeros((0, 3), dtype=np.intp)
    if mesh is not None:
        points = np.concatenate([points, mesh.vertices])
        faces = mesh.triangles + len(skeleton.nodes)
    body = package.add_mesh(points, faces)
    beams = np.zeros(len(skeleton.edges), dtype=BEAM)
    beams["ends"], beams["radii"], beams["caps"] = skeleton.edges, skeleton.edge_radii, lattice.caps
    package.add_beams(body, beams)
    if clip is not None:
        package.clip_beams(body, clip, lattice.clipping)
    if shown is not None:
        body.BeamLattice().SetRepresentation(shown.GetUniqueResourceID())
    balls = np.flatnonzero(lattice.balls)
    if len(balls):
        rows = np.zeros(len(balls), dtype=BALL)
        rows["node"], rows["radius"] = balls, lattice.balls[balls]
        package.add_balls(body, rows)
    return body


def check_sizes(radii: Floats, what: str) -> None:
    """Raise unless six decimals can hold each radius."""
    thin = np.flatnonzero(radii < LEAST_RADIUS)
    if len(thin):
        raise FormatError(
            f"node {thin[0]} {what} {radii[thin[0]]:g} mm; a beam lattice needs "
            f"{LEAST_RADIUS:g} mm or more"
        )


class _Package:
    """A lib3mf model in the making. Arrays go to the library as buffers.

    Its own Python methods would make an object of each row.
    """

    def __init__(self) -> None:
        need("lib3mf", "a 3MF file")
        import lib3mf

        self._lib3mf = lib3mf
        self._wrapper = lib3mf.Wrapper()
        self._model = self._wrapper.CreateModel()
        self._model.SetUnit(lib3mf.ModelUnit.MilliMeter)
        self._objects: list[Any] = []
        self._items: list[Any] = []
        self._digest = sha256()
        self._extent = 0.0

    def add_mesh(self, points: Points, faces: Triangles) -> Any:
        """Add an object of triangles and return it."""
        body = self._model.AddMeshObject()
        vertices, triangles = points.astype(np.float32), faces.astype(np.uint32)
        self._call(
            body,
            "meshobject_setgeometry",
            (self._lib3mf.Position, vertices),
            (self._lib3mf.Triangle, triangles),
        )
        self._extent = max(self._extent, float(np.abs(vertices).max(initial=0.0)))
        self._objects.append(body)
        return body

    def add_beams(self, body: Any, beams: np.ndarray) -> None:
        """Add beams between the vertices of an object."""
        lattice = body.BeamLattice()
        lattice.SetMinLength(SHORTEST_BEAM)
        self._call(lattice, "beamlattice_setbeams", (self._lib3mf.Beam, beams))

    def clip_beams(self, body: Any, clip: Any, clipping: str) -> None:
        """Cut the beams of an object to what is inside or outside of another."""
        modes = self._lib3mf.BeamLatticeClipMode
        mode = modes.Outside if clipping == "outside" else modes.Inside
        body.BeamLattice().SetClipping(mode, clip.GetUniqueResourceID())

    def add_balls(self, body: Any, balls: np.ndarray) -> None:
        """Add balls at vertices of an object where beams end."""
        lattice = body.BeamLattice()
        # lib3mf asks for a default radius; each ball here has its own.
        lattice.SetBallOptions(self._lib3mf.BeamLatticeBallMode.Mixed, float(balls["radius"][0]))
        self._call(lattice, "beamlattice_setballs", (self._lib3mf.Ball, balls))

    def build(self, body: Any) -> None:
        """Put an object on the plate."""
        self._items.append(self._model.AddBuildItem(body, self._wrapper.GetIdentityTransform()))

    def write(self, path: Path) -> None:
        """Write the file, made in memory: on a full disk lib3mf would end the whole process."""
        digest = self._digest.digest()
        setters = [part.SetUUID for part in (*self._objects, *self._items)]
        for number, set_identifier in enumerate([self._model.SetBuildUUID, *setters]):
            set_identifier(_identifier(digest, number))
        file = BytesIO()

        def put(address: int, size: int, _: object) -> None:
            file.write(string_at(address, size))

        def seek(position: int, _: object) -> None:
            file.seek(position)

        writer = self._model.QueryWriter("3mf")
        writer.SetDecimalPrecision(decimals_of(self._extent))
        writer.WriteToCallback(
            self._lib3mf.WriteCallback(put), self._lib3mf.SeekCallback(seek), None
        )
        path.write_bytes(file.getvalue())

    def _call(self, of: Any, function: str, *tables: tuple[Any, np.ndarray]) -> None:
        """Call a function of the library with the rows of arrays."""
        arguments: list[Any] = []
        for kind, rows in tables:
            self._digest.update(function.encode() + rows.tobytes())
            arguments += [c_uint64(len(rows)), (kind * len(rows)).from_buffer(rows)]
        called = getattr(self._wrapper.lib, f"lib3mf_{function}")
        self._wrapper.checkError(of, called(of._handle, *arguments))


def decimals_of(extent: float) -> int:
    """Return how many decimals tell 32-bit coordinates apart, those of small parts more than 6."""
    return int(np.clip(7 - np.floor(np.log10(max(extent, 1e-9))), 6, 16))


def _identifier(digest: bytes, number: int) -> str:
    """Return the identifier of one part of the file whose content has `digest`.

    lib3mf would draw a random one.
    """
    return str(UUID(bytes=sha256(digest + bytes([number])).digest()[:16], version=4))
