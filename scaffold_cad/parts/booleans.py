"""Booleans of parts whose result OCCT gets wrong, noticed by their volumes and by its own check.

Where faces nearly coincide, as of round struts that meet in one plane, OCCT returns nothing, or the
parts as they were, without an error; where a seam of theirs meets an edge, faces that it finds
invalid itself. Imports build123d, as the part objects do.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from build123d import Shape
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_State

from scaffold_cad.base.arrays import Floats, place_text
from scaffold_cad.brep import tessellated
from scaffold_cad.errors import BrepError, MeshError
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.solid.manifolds import manifold_triangles, to_manifold

if TYPE_CHECKING:
    from manifold3d import Manifold

Operation: TypeAlias = Literal["union", "difference", "intersection"]
"""A boolean; a difference is of the first operand and all others."""

PRECISION = 1e-5
"""How far off volumes by OCCT may be, as a fraction of them."""

UNNOTICED = 1e-3
"""Volume that a result may lack or have too much, as a fraction of the smallest operand's."""

COARSER, MESH_ANGLE = 10.0, 0.8
"""Of the meshes by which doubtful results are looked at, usual distances and rad: coarse ones,
which take no longer than the boolean. Where they overlap, points are tried on the operands
themselves."""

NEAR = 1e-4
"""Distance from a face at which a point counts as on it, mm: parts may touch."""

_log = logging.getLogger(__name__)

SAMPLES, TRIED = 20_000, 10
"""Random points in the box of an overlap, and how many of those in it are tried."""


def check_boolean(operation: Operation, operands: Sequence[Shape], result: Shape | None) -> None:
    """Raise if the volume of a boolean's result cannot be right; warn if it is not valid.

    A union has at least the volume of its largest operand and at most that of all of them, and so
    on. Where the result has what it would have if the operands were apart, or nothing, and their
    boxes are not apart, a point is sought that shows that it is wrong. Operands without volume are
    not checked.

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
    volume = f"OCCT gives the {operation} a volume of {max(found, 0.0):.6g} mm³, which"
    if not max(least, 0.0) - slack <= found <= most + slack:
        raise _wrong(f"{volume} should be {max(least, 0.0):.6g} to {most:.6g}")
    meshed = cache(_meshed)
    if abs(found - apart) <= slack:
        for a, b in _pairs_that_meet(operation, boxes):
            place = _place_in(operands[a], operands[b], meshed, also=True)
            if place is not None:
                raise _wrong(f"{volume} cannot be: both parts are at {place} mm")
    elif found <= slack and operation == "difference" and len(operands) == 2:
        place = _place_in(operands[0], operands[1], meshed, also=False)
        if place is not None:
            raise _wrong(f"{volume} cannot be: the first part alone is at {place} mm")
    if result is not None and not result.is_valid and all(each.is_valid for each in operands):
        _tell_invalid(operation, result)


def _wrong(what: str) -> BrepError:
    return BrepError(
        f"{what}; it fails where faces nearly coincide: need one part of one skeleton that holds "
        "all struts, or a boolean of meshes: to_solid(scaffold) of parts that Mode.PRIVATE keeps "
        "out of the builder"
    )


def _tell_invalid(operation: Operation, result: Shape) -> None:
    check = BRepCheck_Analyzer(result.wrapped)
    faces = (face for face in result.faces() if not check.IsValid(face.wrapped))
    place = next((tuple(face.center()) for face in faces), None)
    _log.warning(
        "OCCT finds the %s that it made not valid%s: its volume may be right, other programs may "
        "refuse it; need one part moved by 0.01 mm",
        operation,
        "" if place is None else f", a face at {place_text(np.array(place))}",
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


def _pairs_that_meet(operation: Operation, boxes: Floats) -> list[list[int]]:
    """Return the pairs of operands that must be apart and whose boxes (k, 2, 3) are not.

    Of an intersection of three or more no pair must be.
    """
    low, high = boxes[:, 0], boxes[:, 1]
    meet = np.asarray(((low[:, None] < high) & (low < high[:, None])).all(axis=2))  # (k, k)
    if operation == "intersection" and len(boxes) > 2:
        return []
    if operation != "union":
        meet[1:] = False
    pairs: list[list[int]] = np.argwhere(np.triu(meet, 1)).tolist()
    return pairs


def _meshed(shape: Shape) -> Manifold | None:
    """Return a coarse mesh of a shape, None if it is not closed."""
    try:
        return to_manifold(tessellated(shape, MESH_ANGLE, coarser=COARSER))
    except (BrepError, MeshError):
        return None


def _place_in(
    first: Shape, second: Shape, meshed: Callable[[Shape], Manifold | None], *, also: bool
) -> tuple[float, ...] | None:
    """Return a point that is in the first shape, and also or else not in the second; mm.

    None if none is found, or a shape has no mesh.
    """
    one, other = meshed(first), meshed(second)
    if one is None or other is None:
        return None
    region = one ^ other if also else one - other
    if region.is_empty():
        return None
    inside = MeshRegion(manifold_triangles(region))
    low, high = inside.bounds
    points = low + np.random.default_rng(0).uniform(size=(SAMPLES, 3)) * (high - low)
    for point in points[inside.contains(points)][:TRIED]:
        if _is_in(first, point) and (_is_in if also else _is_out)(second, point):
            return tuple(point.round(3).tolist())
    return None


def _is_in(shape: Shape, point: Floats) -> bool:
    return TopAbs_State.TopAbs_IN in _states(shape, point)


def _is_out(shape: Shape, point: Floats) -> bool:
    return set(_states(shape, point)) == {TopAbs_State.TopAbs_OUT}


def _states(shape: Shape, point: Floats) -> list[TopAbs_State]:
    """Return where a point is, seen from each solid of a shape; on it if nearer than `NEAR`."""
    place = gp_Pnt(*point.tolist())
    solids = [solid.wrapped for solid in shape.solids()]
    return [BRepClass3d_SolidClassifier(solid, place, NEAR).State() for solid in solids]
