"""DXF: lines, polylines and curves of the model space, through ezdxf."""

from __future__ import annotations

import logging
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import LARGEST_COORDINATE, Points
from scaffold_cad.base.backends import need
from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton, joined_polylines
from scaffold_cad.io._text import check_size
from scaffold_cad.io.register import register_reader

CURVES = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")
"""Entities that become edges."""

SAGITTA = 1e-3
"""How far an edge may be from its curve, as a fraction of the curve's size."""

LARGEST_DXF = 2**26
"""Most bytes of a DXF file: ezdxf makes objects of every tag."""

_BINARY = b"AutoCAD Binary DXF"
_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    words = head.removeprefix(b"\xef\xbb\xbf").split(maxsplit=2)[:2]
    comment = words[:1] == [b"999"] and b"SECTION" in head
    return words == [b"0", b"SECTION"] or comment or head.startswith(_BINARY)


@register_reader("DXF", ".dxf", recognizes=_recognizes)
def read_dxf(path: Path) -> RawSkeleton:
    """Read the lines, polylines and curves of a DXF file, text or binary, which has no radii.

    Curves become edges within `SAGITTA`. Lengths are in the unit that the header names, or in mm
    where it names none, as in R12. Entities join where they have equal points. Blocks, which are
    not taken apart, other entities, and meshes that are POLYLINEs are left out with a warning.
    """
    need("ezdxf", "a DXF file")
    check_size(path, LARGEST_DXF)
    data = path.read_bytes()
    _refuse_cut(path, data)
    import ezdxf
    from ezdxf import units

    try:
        document = ezdxf.readfile(path)
        # Where the header has no unit, ezdxf takes meters.
        unit = document.units if b"$INSUNITS" in data else 0
        scale = units.conversion_factor(unit, units.MM) if unit else 1.0
        polylines, left_out = _polylines(document)
    except (OSError, MemoryError):
        raise
    except Exception as error:  # of the many things that ezdxf raises for damaged files
        raise FormatError(f"{path} is not a sound DXF file: {error}; need one") from None
    if left_out:
        names = ", ".join(f"{count} {name}" for name, count in sorted(left_out.items()))
        _log.warning("%s: left out %s", path, names)
    if not polylines:
        raise FormatError(f"{path} has no curves in its model space; need {', '.join(CURVES)}")
    name = units.unit_name(unit).lower() if unit else None
    return joined_polylines([points * scale for points in polylines], name)


def _refuse_cut(path: Path, data: bytes) -> None:
    """Raise unless the file ends as DXF files do: ezdxf reads those that were cut short."""
    end = b"\0EOF\0" if data.startswith(_BINARY) else b"EOF"
    if not data.rstrip(b" \t\r\n\x1a").endswith(end):
        raise FormatError(f"{path} does not end with EOF: it was cut short; need the whole file")


def _polylines(document: Any) -> tuple[list[Points], Counter[str]]:
    """Return the points of each curve in the drawing's unit, and what was left out."""
    polylines = []
    left_out: Counter[str] = Counter()
    for entity in document.modelspace():
        kind = entity.dxftype()
        is_mesh = kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)
        if kind in CURVES and not is_mesh:
            polylines.append(_points(entity))
        else:
            left_out[kind] += 1
    return [points for points in polylines if len(points) > 1], left_out


def _points(entity: Any) -> Points:
    """Return points along a curve, shape (k, 3)."""
    from ezdxf.path import make_path

    curve = make_path(entity)
    corners = np.array([tuple(point) for point in curve.control_vertices()]).reshape(-1, 3)
    if not (np.abs(corners) <= LARGEST_COORDINATE).all():
        raise ValueError(f"a {entity.dxftype()} reaches beyond {LARGEST_COORDINATE:g} mm")
    size = float(np.linalg.norm(np.ptp(corners, axis=0))) if len(corners) else 0.0
    if not (curve.has_curves and size > 0):
        return corners
    return np.array([tuple(point) for point in curve.flattening(SAGITTA * size)])
