"""Maps of cells on build123d faces and on meshes of any library."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords, described
from scaffold_cad.base.arrays import Points
from scaffold_cad.base.backends import need
from scaffold_cad.base.builders import built
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.fill import HasTriangles
from scaffold_cad.lattice.maps import BetweenMap, QuadMap, SurfaceMap
from scaffold_cad.lattice.maps.grading import sizes_at
from scaffold_cad.lattice.maps.surfaces import Height
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.remeshing import quadrangulated
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.mesh.welding import welded, without_repeated_corners
from scaffold_cad.products.surfaces import triangles_of

if TYPE_CHECKING:
    from build123d import Face, Shape


@checks_keywords()
def face_map(face: Face, thickness: Height, offset: Height = 0.0) -> SurfaceMap:
    """Return the map of cells on a build123d face: u and v along it, w along its normal.

    Cells follow the face's own parameters and are trimmed to its borders; where it closes, as
    around a pipe, they close.

    Parameters
    ----------
    face : trimmed or not; or a sketch, a builder or another shape that has this one face
    thickness : of the layer, mm, a number or a function of positions on the face (n, 3) that
        returns (n,), such as a height field; negative for a layer at the back
    offset : height at which the layer begins, likewise

    Raises
    ------
    OptionError
        If `face` is not one face, or the thickness is 0.
    BrepError
        If the face has no area in its parameters.
    MissingBackendError
        If build123d is not installed.

    Examples
    --------
    >>> from build123d import Cylinder, GeomType
    >>> from scaffold_cad import face_map, tile
    >>> pipe = Cylinder(10, 30).faces().filter_by(GeomType.CYLINDER)[0]
    >>> sleeve = tile("kelvin", 3.0, radius=0.3, on=face_map(pipe, 3.0))
    >>> sleeve.component_count
    1
    """
    need("build123d", "a map of cells on its face")
    from scaffold_cad.brep.facesurfaces import FaceSurface

    return SurfaceMap(FaceSurface.of(_only_face(face)), thickness, offset)


@checks_keywords()
def between_faces(lower: Face, upper: Face) -> BetweenMap:
    """Return the map of cells between two build123d faces: w runs straight from one to the other.

    Parameters of one face are matched with those of the other so that they are near each other.

    Raises
    ------
    OptionError
        If one is not one face, or only one of them closes.
    BrepError
        If a face has no area in its parameters.
    MissingBackendError
        If build123d is not installed.

    Examples
    --------
    >>> from build123d import Location, Rectangle
    >>> from scaffold_cad import between_faces, tile
    >>> floor = Rectangle(20, 20).face()
    >>> core = tile("bcc", 5.0, radius=0.5, on=between_faces(floor, Location((0, 0, 10)) * floor))
    >>> float(core.nodes[:, 2].max()) <= 10
    True
    """
    need("build123d", "a map of cells between its faces")
    from scaffold_cad.brep.facesurfaces import FaceSurface

    return BetweenMap(FaceSurface.of(_only_face(lower)), FaceSurface.of(_only_face(upper)))


def _only_face(what: Any) -> Any:
    """Return a face, or the face of a shape that has one, as a sketch."""
    shape = built(what)
    if not callable(getattr(shape, "faces", None)):
        raise OptionError(f"got {described(what)}; need a build123d Face")
    faces = shape.faces()
    if len(faces) != 1:
        raise OptionError(
            f"the {type(shape).__name__} has {len(faces)} faces; need one Face, such as .faces()[0]"
        )
    return faces[0]


@checks_keywords()
def mesh_map(
    mesh: QuadMesh | TriangleMesh | HasTriangles | Shape,
    thickness: Height,
    offset: Height = 0.0,
    *,
    size: float | Callable[[Points], ArrayLike] | None = None,
) -> QuadMap:
    """Return the map of cells on the quads of a mesh.

    Parameters
    ----------
    mesh : a quad mesh, whose quads are taken as they are; or a triangle mesh of any library or a
        build123d shape, which is remeshed in quads of about `size`, one per cell (`counts=(1, 1,
        k)`); edges between faces at 60° and more are kept
    thickness, offset : of the layer, see `face_map`
    size : of the quads, mm, or a function of positions (n, 3) that returns (n,) sizes, as a `Field`
        is; for triangles only

    Raises
    ------
    OptionError
        If triangles come without a size, or quads with one.
    MeshError
        If the mesh is not a surface.

    Examples
    --------
    >>> from scaffold_cad import QuadMesh, mesh_map, tile
    >>> square = QuadMesh([[0, 0, 0], [5, 0, 0], [5, 5, 0], [0, 5, 0]], [[0, 1, 2, 3]])
    >>> layer = tile("bcc", counts=(1, 1, 1), radius=0.5, on=mesh_map(square, thickness=5.0))
    >>> len(layer.edges)
    8
    """
    if isinstance(mesh, QuadMesh) and size is None:
        return QuadMap(mesh, thickness, offset)
    name = "size of the quads"
    side = partial(sizes_at, size) if callable(size) else as_number(size, name)
    surface = without_repeated_corners(welded(triangles_of(mesh)))
    return QuadMap(quadrangulated(surface, side), thickness, offset)
