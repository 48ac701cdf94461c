"""Findings on a part as a whole: its size, volume, mass and files."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.printability.processes import Process, density_of
from scaffold_cad.printability.report import Finding
from scaffold_cad.printability.standing import fits_into
from scaffold_cad.printability.triangletopology import TriangleTopology

STL_HEADER, STL_TRIANGLE = 84, 50  # bytes of a binary STL file


def part_findings(
    surface: TriangleTopology, size: tuple[float, float, float], process: Process, material: str
) -> Iterator[Finding]:
    """Yield what there is to say of a part.

    Parameters
    ----------
    surface : of the part
    size : extent as it stands on the plate, mm
    material : a name in `MATERIALS`
    """
    extent = np.ptp(surface.mesh.vertices, axis=0)
    yield _build_volume(size, extent, process)
    volume = surface.mesh.signed_volume
    solid = surface.closed and volume > 0
    yield Finding(
        "volume",
        "part",
        "ok" if volume > 0 else "failure",
        {"volume_mm3": volume},
        f"{volume:.6g} mm³" + ("" if solid else ", of a surface that bounds no solid"),
        "" if volume > 0 else "need > 0: are the triangles clockwise seen from outside?",
    )
    density = density_of(material)
    mass = max(volume, 0.0) * density / 1000.0
    yield Finding(
        "mass",
        "part",
        "note",
        {"mass_g": mass, "material": material, "density_g_cm3": density},
        f"{mass:.4g} g of {material}, {density:g} g/cm³",
    )
    box = float(extent.prod())
    relative = volume / box if box > 0 else None
    yield Finding(
        "relative_density",
        "part",
        "note",
        None if relative is None else {"relative_density": relative},
        "none: the part is flat" if relative is None else f"{relative:.3g} of its bounding box",
    )
    count = len(surface.mesh.triangles)
    size_of_file = STL_HEADER + STL_TRIANGLE * count
    yield Finding(
        "triangles",
        "part",
        "note",
        {"count": count, "stl_bytes": size_of_file},
        f"{count}, {size_of_file / 1e6:.3g} MB as binary STL",
    )


def _build_volume(size: tuple[float, float, float], extent: Floats, process: Process) -> Finding:
    fits = fits_into(size, process.build_volume)
    lies = bool((np.sort(extent) <= np.sort(process.build_volume)).all())
    other = "stand it on another side, on which it fits, " if lies else ""
    needed = " x ".join(f"{extent:g}" for extent in process.build_volume)
    return Finding(
        "build_volume",
        "part",
        "ok" if fits else "failure",
        {"size_mm": list(size), "build_volume_mm": list(process.build_volume)},
        " x ".join(f"{extent:.4g}" for extent in size)
        + f" mm, {'within' if fits else 'larger than'} {needed}",
        "" if fits else other + "scale it down, cut it, or take a larger build volume",
    )
