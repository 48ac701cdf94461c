"""Where `scaffold-cad lattice` puts cells: on a tube, a sphere or the face of a part."""

from __future__ import annotations

import argparse
from pathlib import Path

from scaffold_cad.brep import read_brep
from scaffold_cad.cli import fields, sizes
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import face_map
from scaffold_cad.lattice import CellMap, CylinderMap, SphereMap


def add_maps(where: argparse._MutuallyExclusiveGroup, parser: argparse.ArgumentParser) -> None:
    """Add the options that name a map."""
    where.add_argument(
        "--cylinder",
        type=sizes.three_sizes,
        metavar="RxHxT",
        help="wall of a tube, mm: inner radius, height and thickness",
    )
    where.add_argument(
        "--sphere",
        type=sizes.two_sizes,
        metavar="RxT",
        help="wall of a sphere: inner radius, thickness",
    )
    where.add_argument(
        "--face", type=Path, metavar="PART", help="a face of a part: .step .brep (the largest one)"
    )
    parser.add_argument(
        "--face-number", type=int, metavar="N", help="which face, from 0, in the order of the file"
    )
    parser.add_argument(
        "--thickness",
        type=fields.number,
        metavar="T",
        help="of the layer on the face, mm, a number or a file as for --radius; < 0 for its back",
    )


def map_of(options: argparse.Namespace) -> CellMap | None:
    """Return the map that options name, or None.

    Raises
    ------
    OptionError
        If an option stands without the one it belongs to, or there is no such face.
    """
    if options.face is None and (options.thickness is not None or options.face_number is not None):
        raise OptionError("--thickness and --face-number are of a face; need --face")
    if options.cylinder is not None:
        return CylinderMap(*options.cylinder)
    if options.sphere is not None:
        return SphereMap(*options.sphere)
    if options.face is None:
        return None
    if options.thickness is None:
        raise OptionError("--face needs the --thickness of the layer on it")
    faces = read_brep(options.face).faces()
    number = options.face_number
    if number is None:
        return face_map(max(faces, key=lambda face: face.area), options.thickness)
    if not 0 <= number < len(faces):
        raise OptionError(f"--face-number is {number}; need 0 to {len(faces) - 1}")
    return face_map(faces[number], options.thickness)
