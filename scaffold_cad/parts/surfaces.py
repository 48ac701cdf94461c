"""The triangles of whatever has a surface."""

from __future__ import annotations

import sys
from typing import Any

from scaffold_cad import brep, manifolds
from scaffold_cad.errors import OptionError
from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.solid import to_solid
from scaffold_cad.trianglemesh import TriangleMesh


def triangles_of(what: Any) -> TriangleMesh:
    """Return the triangles of `what`; those of a build123d shape are at most 0.01 mm off it.

    Parameters
    ----------
    what : a build123d shape, a manifold3d Manifold, a Scaffold, whose overlapping struts are
        united, or a mesh: anything with arrays `vertices`, and `triangles` or `faces` (t, 3)

    Raises
    ------
    OptionError
        If it is none of these.
    """
    if is_instance(what, "build123d", "Shape"):
        return brep.tessellated(what)
    if is_instance(what, "manifold3d", "Manifold"):
        return manifolds.manifold_triangles(what)
    if isinstance(what, Scaffold):
        return manifolds.manifold_triangles(to_solid(what))
    # Of trimesh: its `triangles` are positions.
    triangles = getattr(what, "triangles" if isinstance(what, QuadMesh) else "faces", None)
    if triangles is None:
        triangles = getattr(what, "triangles", None)
    if triangles is None or not hasattr(what, "vertices"):
        raise OptionError(
            f"the body is a {type(what).__name__}; need a build123d solid or a triangle mesh"
        )
    return TriangleMesh(what.vertices, triangles)


def is_instance(what: Any, module: str, name: str) -> bool:
    """Return whether `what` is of a class of an optional package, without importing that."""
    loaded = sys.modules.get(module)
    return loaded is not None and isinstance(what, getattr(loaded, name))
