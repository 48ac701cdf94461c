"""Rhino files (.3dm): their curves, through rhino3dm."""

from __future__ import annotations

import logging
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.apart import Arrays, run_apart
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.backends import need
from scaffold_cad.errors import FormatError
from scaffold_cad.io._curves import flattened
from scaffold_cad.io._raw import RawSkeleton, joined_polylines
from scaffold_cad.io._text import LARGEST_FILE, check_size
from scaffold_cad.io._units import length_of
from scaffold_cad.io.register import register_reader

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    return head.startswith(b"3D Geometry File Format")


@register_reader("Rhino", ".3dm", recognizes=_recognizes)
def read_rhino(path: Path) -> RawSkeleton:
    """Read the lines, polylines and curves of a Rhino file, which has no radii.

    Curves become edges within 1/1000 of their size, and join where they have equal points. Lengths
    are in the unit of the file. Instances of blocks, surfaces and meshes are left out with a
    warning.
    """
    need("rhino3dm", "a 3DM file")
    check_size(path, LARGEST_FILE)
    found = run_apart(curve_arrays, path)
    name = str(found["unit"])
    scale = length_of(name)
    if scale is None:
        _log.warning("%s: lengths are in the unit %s, taken as mm", path, name)
    if len(found["left_out"]):
        _log.warning("%s: left out %s", path, ", ".join(found["left_out"].tolist()))
    ends = found["ends"]
    if not len(ends):
        raise FormatError(f"{path} has no curves; need lines, polylines or curves")
    lines = np.split(found["points"] * (scale or 1.0), ends[:-1])
    return joined_polylines(lines, None if scale is None else name.lower())


def curve_arrays(path: Path) -> Arrays:
    """Return the points of all curves, where each ends among them, the unit, and what is left out.

    Run in a process of its own: rhino3dm may end it on damaged files.
    """
    import rhino3dm

    try:
        document: Any = rhino3dm.File3dm.Read(str(path))
    except Exception as error:  # of a library in C++
        raise FormatError(f"{path} is not a sound 3DM file: {error!r:.200}; need one") from None
    if document is None:
        raise FormatError(f"{path} is not a sound 3DM file; need one of Rhino 3 or later")
    lines, left_out = [], Counter[str]()
    for k in range(len(document.Objects)):
        item = document.Objects[k]
        points = _points(item.Geometry, rhino3dm)
        if points is None:
            left_out[type(item.Geometry).__name__] += 1
        elif len(points) > 1:
            lines.append(points)
    return {
        "points": np.concatenate([np.zeros((0, 3)), *lines]),
        "ends": np.cumsum([len(line) for line in lines], dtype=np.intp),
        "unit": np.array(str(document.Settings.ModelUnitSystem).rpartition(".")[2]),
        "left_out": np.array([f"{count} {kind}" for kind, count in sorted(left_out.items())]),
    }


def _points(geometry: Any, rhino3dm: Any) -> Points | None:
    """Return points along a curve, shape (k, 3), or None if it is something else."""
    if not isinstance(geometry, rhino3dm.Curve):
        return None
    if isinstance(geometry, rhino3dm.PolylineCurve):
        found = [geometry.Point(k) for k in range(geometry.PointCount)]
        return np.array([(point.X, point.Y, point.Z) for point in found])
    if isinstance(geometry, rhino3dm.PolyCurve):
        pieces = [_points(geometry.SegmentCurve(k), rhino3dm) for k in range(geometry.SegmentCount)]
        known = [piece for piece in pieces if piece is not None]
        return np.concatenate(known) if known else None
    if isinstance(geometry, rhino3dm.NurbsCurve) and geometry.Degree == 1:
        found = geometry.Points
        rows = np.array([(p.X, p.Y, p.Z, p.W) for p in map(found.__getitem__, range(len(found)))])
        places: Points = rows[:, :3] / rows[:, 3:]
        return places
    start, end = geometry.Domain.T0, geometry.Domain.T1

    def curve(parameters: Floats) -> Points:
        found = [geometry.PointAt(start + t * (end - start)) for t in parameters.tolist()]
        return np.array([(point.X, point.Y, point.Z) for point in found])

    straight = isinstance(geometry, rhino3dm.LineCurve)
    return curve(np.array([0.0, 1.0])) if straight else flattened(curve)
