"""Where `scaffold-cad lattice` puts cells: on a tube, a sphere, faces or the surface of a part."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from scaffold_cad.brep import read_shape
from scaffold_cad.cli import fields, sizes, source
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.filling import between_faces, face_map, mesh_map
from scaffold_cad.io import read_triangles
from scaffold_cad.lattice import CellMap, CylinderMap, SphereMap

TUBE, BALL = "RxHxT", "RxT"
"""Inner radius, height and thickness of a wall."""


def add_maps(where: argparse._MutuallyExclusiveGroup, parser: argparse.ArgumentParser) -> None:
    """Add the options that name a map."""
    where.add_argument(
        "--cylinder",
        type=sizes.lengths_of(TUBE),
        metavar=TUBE,
        help="wall of a tube, mm: inner radius, height and thickness",
    )
    where.add_argument(
        "--sphere",
        type=sizes.lengths_of(BALL),
        metavar=BALL,
        help="wall of a sphere: inner radius, thickness",
    )
    where.add_argument(
        "--face", type=Path, metavar="PART", help="a face of a part: .step .brep (the largest one)"
    )
    where.add_argument(
        "--surface",
        type=Path,
        metavar="PART",
        help="the whole surface of a part or a mesh, in quads of --size: .step .brep .stl .3mf "
        ".obj .ply",
    )
    parser.add_argument(
        "--face-number",
        type=int,
        metavar="N",
        help="number of the face, from 0, in the order of the file",
    )
    parser.add_argument(
        "--to-face",
        type=int,
        metavar="N",
        help="fill the space between the face and this face of the same file",
    )
    parser.add_argument(
        "--thickness",
        type=fields.number,
        metavar="T",
        help="thickness of the layer on a face or a surface, mm, a number or a file as for "
        "--radius; < 0 for its back side",
    )


def map_of(options: argparse.Namespace) -> CellMap | None:
    """Return the map that options name, or None.

    Raises
    ------
    OptionError
        If an option stands without the one it belongs to, or there is no such face.
    FormatError
        If a file holds no face or no surface.
    """
    if options.face is None:
        source.refuse(options, ["face_number", "to_face"], "is of a face; need --face")
    if options.face is None and options.surface is None:
        source.refuse(options, ["thickness"], "is of a layer; need --face or --surface")
    if options.cylinder is not None:
        return CylinderMap(*options.cylinder)
    if options.sphere is not None:
        return SphereMap(*options.sphere)
    if options.surface is not None:
        return _surface_map(options)
    return None if options.face is None else _face_map(options)


def _surface_map(options: argparse.Namespace) -> CellMap:
    """Return the map on the whole surface of a part."""
    if options.thickness is None:
        raise OptionError("--surface needs the --thickness of the layer on it")
    size = options.size
    if not callable(size):
        size = np.broadcast_to(size, 3)
        if size[0] != size[1]:
            raise OptionError(f"--size is {size.tolist()}; need two equal ones along --surface")
        size = float(size[0])
    mesh = read_triangles(options.surface)
    if mesh is None:
        raise FormatError(f"{options.surface} holds no surface; need a mesh or a solid")
    return mesh_map(mesh, options.thickness, size=size)


def _face_map(options: argparse.Namespace) -> CellMap:
    """Return the map on a face, or between two."""
    if (options.thickness is None) == (options.to_face is None):
        raise OptionError("--face needs either the --thickness of the layer on it or --to-face")
    faces = read_shape(options.face).faces()
    if not faces:
        raise FormatError(f"{options.face} holds no face of CAD; need a STEP or BREP file with one")
    for flag, number in (
        ("--face-number", options.face_number),
        ("--to-face", options.to_face),
    ):
        if number is not None and not 0 <= number < len(faces):
            raise OptionError(f"{flag} is {number}; need 0 to {len(faces) - 1}")
    number = options.face_number
    face = max(faces, key=lambda one: one.area) if number is None else faces[number]
    if options.to_face is None:
        return face_map(face, options.thickness)
    if face is faces[options.to_face] or number == options.to_face:
        raise OptionError(f"--to-face is {options.to_face}, the face itself; need another one")
    return between_faces(face, faces[options.to_face])
