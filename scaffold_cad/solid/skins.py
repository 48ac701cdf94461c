"""What is inside the skin of a body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.insets import inset
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.erosion import eroded

if TYPE_CHECKING:
    from manifold3d import Manifold


def inside_of(surface: TriangleMesh, outer: Manifold, skin: float) -> Manifold:
    """Return what is inside the skin of a body.

    Parameters
    ----------
    surface, outer : the body, as a closed surface and as a solid
    skin : thickness, mm

    Raises
    ------
    OptionError
        If it fills the body.
    MeshError
        If the body is tightly curved and has too many triangles.
    """
    full = OptionError(f"skin is {skin:g} mm, which fills the body; need less")
    if 2 * skin >= np.ptp(surface.vertices, axis=0).min():  # which erosion takes long to find
        raise full
    inner = inset(surface, skin)
    solid = eroded(outer, skin) if inner is None else manifolds.to_manifold(inner)
    if solid.is_empty():
        raise full
    return solid
