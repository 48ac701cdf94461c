"""Booleans of parts whose result OCCT gets wrong, noticed by their volumes.

Where faces nearly coincide, as of round struts that meet in one plane, OCCT returns nothing, or the
parts as they were, and tells nobody. Imports build123d, as `objects` does.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add, sub, xor
from typing import Literal, TypeAlias

import numpy as np
from build123d import Shape
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps

from scaffold_cad.arrays import Bools, Floats
from scaffold_cad.brep import tessellated
from scaffold_cad.errors import BrepError, MeshError
from scaffold_cad.manifolds import to_manifold

Operation: TypeAlias = Literal["union", "difference", "intersection"]
"""A boolean; a difference is of the first operand and all others."""

PRECISION = 1e-5
"""How far off volumes by OCCT may be, as a fraction of them."""

UNNOTICED = 1e-3
"""Volume that a result may lack or have too much, as a fraction of the smallest operand's."""

SHARED = 0.01
"""Volume by which meshes of the operands must contradict a result, as a fraction of the smallest
operand's: meshes of rounds that touch are a little into each other."""

MESH_DISTANCE, MESH_ANGLE = 0.1, 0.8
"""Of these meshes, mm and rad: coarse ones, which take as long as the boolean at most."""


def check_boolean(operation: Operation, operands: Sequence[Shape], result: Shape | None) -> None:
    """Raise if the volume of a boolean's result cannot be right.

    A union has at least the volume of its largest operand and at most that of all of them, and so
    on. Where the result has what it would have if the operands were apart, or nothing, and their
    boxes are not apart, that is compared with what their meshes say. Operands without volume are
    not looked at.

    Parameters
    ----------
    operands : at least two, but for a union of the solids in one

    Raises
    ------
    BrepError
        If it cannot; the message tells the ways out.
    """
    if not all(operand.solids() for operand in operands):
        return
    if operation == "union":  # also of the solids of an operand with each other
        operands = [solid for operand in operands for solid in operand.solids()]
    boxes = np.array([_box(operand) for operand in operands])
    middle = boxes[0].mean(axis=0)
    volumes = np.array([_volume(operand, middle) for operand in operands])
    found = 0.0 if result is None or not result.solids() else _volume(result, middle)
    first, total = volumes[0], volumes.sum()
    least, apart = {
        "union": (volumes.max(), total),
        "difference": (2 * first - total, first),
        "intersection": (0.0, 0.0),
    }[operation]
    most = volumes.min() if operation == "intersection" else apart
    if not (volumes > 0).all():
        return
    slack = UNNOTICED * volumes.min() + PRECISION * total
    if not max(least, 0.0) - slack <= found <= most + slack:
        raise _wrong(operation, found, f"{max(least, 0.0):.6g} to {most:.6g}")
    suspicious = abs(found - apart) <= slack or found <= slack
    if suspicious and _meet(operation, boxes):
        expected = _by_meshes(operation, operands, volumes)
        if expected is not None and abs(found - expected) > SHARED * volumes.min() + slack:
            raise _wrong(operation, found, f"some {expected:.4g}")


def _wrong(operation: Operation, found: float, expected: str) -> BrepError:
    return BrepError(
        f"OCCT gives the {operation} a volume of {max(found, 0.0):.6g} mm³, which should be "
        f"{expected}: it fails where faces nearly coincide; need one part of one skeleton that "
        "holds all struts, or a boolean of meshes: to_solid(scaffold) of parts that Mode.PRIVATE "
        "keeps out of the builder"
    )


def _volume(shape: Shape, origin: Floats) -> float:
    """Return the volume of solids, mm³; summed up from near them, where it is most exact."""
    properties = GProp_GProps(gp_Pnt(*origin.tolist()))
    BRepGProp.VolumeProperties_s(shape.wrapped, properties)
    return float(properties.Mass())


def _box(shape: Shape) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the lowest and the highest corner of a box around a shape, mm."""
    box = shape.bounding_box(optimal=False)
    return tuple(box.min), tuple(box.max)


def _meet(operation: Operation, boxes: Floats) -> bool:
    """Return whether boxes (k, 2, 3) that the operation compares are not apart."""
    low, high = boxes[:, 0], boxes[:, 1]
    meet: Bools = np.asarray(
        ((low[:, None] < high[None]) & (low[None] < high[:, None])).all(axis=2)
    )  # (k, k)
    if operation == "union":
        return bool(np.triu(meet, 1).any())
    return bool(meet[0, 1:].any())


def _by_meshes(operation: Operation, operands: Sequence[Shape], volumes: Floats) -> float | None:
    """Return the result's volume by what meshes of the operands share, mm³.

    None if one of the meshes is not closed.
    """
    try:
        meshes = [
            to_manifold(tessellated(operand, MESH_DISTANCE, MESH_ANGLE)) for operand in operands
        ]
    except (BrepError, MeshError):
        return None
    if operation == "intersection":
        return float(reduce(xor, meshes).volume())
    if operation == "union":
        shared = sum(mesh.volume() for mesh in meshes) - reduce(add, meshes).volume()
        return float(volumes.sum() - shared)
    cut_off = meshes[0].volume() - reduce(sub, meshes).volume()
    return float(volumes[0] - cut_off)
