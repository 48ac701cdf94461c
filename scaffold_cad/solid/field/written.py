"""Fields in the numbers of files, and what these cannot hold of thin struts."""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import Floats, place_text
from scaffold_cad.base.positions import single_steps
from scaffold_cad.base.summaries import counted
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field.solid import field_solid, held_by_grids
from scaffold_cad.solid.field.struts import FieldStruts

_log = logging.getLogger(__name__)


def field_as_written(
    struts: FieldStruts, factor: float, sides: int, sag: float | Floats
) -> TriangleMesh:
    """Return the surface of a field whose coordinates are 32-bit numbers in the unit of a file.

    Struts that these cannot hold are thicker, see `report_thickened`.

    Parameters
    ----------
    factor : what lengths are multiplied with in the file
    sides, sag : of `field_solid`
    """
    if factor == 1.0:
        return field_solid(struts, sides=sides, sag=sag).mesh
    mesh = field_solid(struts.scaled(factor), sides=sides, sag=factor * sag).mesh
    return TriangleMesh(mesh.vertices / factor, mesh.triangles)


def report_thickened(struts: FieldStruts, factor: float = 1.0) -> None:
    """Log which struts of a field as written are thicker than asked for, and why."""
    held, thick = held_by_grids(struts if factor == 1.0 else struts.scaled(factor))
    if len(thick) == 0:
        return
    wanted, got = struts.radii[thick].min(axis=1), held.radii[thick].min(axis=1) / factor  # (k,)
    worst = np.argmax(got / wanted)
    ends = struts.ends[thick[worst]]
    near = place_text(ends.mean(axis=0))
    _log.warning(
        "%s too thin for the coordinates of mesh files and made thicker: that near "
        "%s has a radius of %.3g mm instead of %.3g mm, as 32-bit numbers are %.3g mm apart "
        "there and the whole is %.4g mm large",
        counted(len(thick), "strut is", "struts are"),
        near,
        got[worst],
        wanted[worst],
        single_steps(ends, factor).max(),
        np.ptp(struts.ends.reshape(-1, 3), axis=0).max(),
    )
