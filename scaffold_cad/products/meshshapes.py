"""Meshes as build123d shapes: to look at and to export as meshes, not B-reps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.backends import need
from scaffold_cad.errors import MeshError
from scaffold_cad.products.surfaces import triangles_of

if TYPE_CHECKING:
    from build123d import Face


@checks_keywords()
def to_mesh_shape(what: Any) -> Face:
    """Return a mesh as one build123d Face that carries its triangles and no surface.

    It is what build123d's own `import_stl` returns: viewers show it and `export_stl` writes it,
    however many triangles there are. It is not a solid: it has no volume, booleans and fillets do
    not work on it, and a STEP file of it holds triangles at best.

    Parameters
    ----------
    what : a manifold3d Manifold, a TriangleMesh, a QuadMesh, a trimesh Trimesh, or a Scaffold,
        whose overlapping struts are united

    Raises
    ------
    MeshError
        If it has no triangles.
    OptionError
        If it is not a mesh.
    MissingBackendError
        If build123d is not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> from scaffold_cad.products import to_mesh_shape
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round(to_mesh_shape(build_scaffold(strut)).bounding_box().size.X, 6)
    9.0
    """
    mesh = triangles_of(what)
    if len(mesh.triangles) == 0:
        raise MeshError(f"the {type(what).__name__} has no triangles; need at least one")
    need("build123d", "a shape of triangles")
    from scaffold_cad.brep import occtmeshes

    return occtmeshes.triangulated_face(mesh.vertices, mesh.triangles)
