"""B-rep shells and solids of quad and Bézier meshes, for build123d.

A quad becomes one face: on a plane where its corners are coplanar, else on its bilinear patch;
a patch of higher degree stays as it is. build123d is imported when the first shape is made.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import check_choice
from scaffold_cad.base.arrays import place_text
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import check_there
from scaffold_cad.base.packed import PACKED_SUFFIX, unpacked
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import length
from scaffold_cad.brep.analytic import AnalyticBrep
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.brepfiles import check_brep_file
from scaffold_cad.errors import BrepError, FormatError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.shells import check_oriented, check_solid, quads_of_shells
from scaffold_cad.mesh.trianglemesh import TriangleMesh, have_distinct_corners

if TYPE_CHECKING:
    from build123d import Shape

BREP_SUFFIXES = (".step", ".stp", PACKED_SUFFIX, ".brep")
"""Suffixes of the formats of B-reps that are read and written."""

Kind = Literal["solid", "shell"]
"""What a mesh becomes: solids, or shells, which may be open."""

LEAST_SIZE = 2e-7
"""Least length of an edge and least height of a quad, mm: twice the tolerance of CAD systems."""

TESSELLATION_DISTANCE = 0.01
"""Largest distance between a face and its triangles, mm; OCCT lets a few triangles at the seam of a
sphere be up to 2.2 times as far off."""

TESSELLATION_SHARE = 2e-5
"""The same of large shapes, in their diagonals: from 0.5 m on a shape has as many triangles in any
size. Within 0.01 mm a ball of 1 m has 500 000, and one of 10 m takes gigabytes."""

TESSELLATION_MOST = 1e-3
"""The same at most: up to 10 mm a shape has as many triangles in any size. Where small faces are
narrower than the distance OCCT finds no triangles for them."""

TESSELLATION_ANGLE = 0.3
"""Largest angle between neighboring triangles of a face, rad. It makes rounds smaller than the
distance 21-gons, of 98.5 % of their area; a smaller angle takes up to 40 times as many triangles on
the thin patches of a smooth strut."""


def brep_of_patches(mesh: QuadMesh | BezierMesh, kind: Kind = "solid") -> Shape:
    """Return the B-rep of `mesh`: see `to_brep`."""
    check_choice(kind, "kind", get_args(Kind))
    patches = BezierMesh.bilinear(mesh) if isinstance(mesh, QuadMesh) else mesh
    if kind == "solid":
        check_solid(patches.mesh)
    else:
        check_oriented(patches.mesh)
    check_sizes(patches)

    edge = patches.mesh.edge_of_half_edge
    is_open = (np.bincount(edge)[edge] == 1).reshape(-1, 4).any(axis=1)  # (f,)
    shells = quads_of_shells(patches.mesh)
    closed = [not is_open[quads].any() for quads in shells]

    need("build123d", "a B-rep")
    from scaffold_cad.brep import occt

    return occt.make_shape(patches, [quads.tolist() for quads in shells], closed, kind)


def brep_of_faces(faces: AnalyticBrep, kind: Kind = "solid") -> Shape:
    """Return the B-rep of analytic faces: solids, or the shells that bound them.

    Raises
    ------
    BrepError
        If an edge is too short for CAD systems.
    OptionError
        If there is no such kind.
    MissingBackendError
        If build123d is not installed.
    """
    check_choice(kind, "kind", get_args(Kind))
    check_edges(faces)
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtanalytic

    return occtanalytic.make_shape(faces, kind)


def check_edges(faces: AnalyticBrep) -> None:
    """Raise unless every edge between two vertices is longer than the tolerance of CAD systems.

    Raises
    ------
    BrepError
        If one is too short; its place is named.
    """
    ends = faces.vertices[faces.edges.ends]  # (e, 2, 3)
    spans = length(ends[:, 1] - ends[:, 0])
    is_arc = faces.edges.ends[:, 0] != faces.edges.ends[:, 1]
    short = np.flatnonzero(is_arc & (spans < LEAST_SIZE))
    if len(short):
        raise BrepError(
            f"an edge at {place_text(ends[short[0], 0])} is {spans[short[0]]:g} mm long; "
            f"need {LEAST_SIZE:g} mm or more (larger radii or longer struts)"
        )


def check_sizes(patches: BezierMesh) -> None:
    """Raise unless every edge and every quad is larger than the tolerance of CAD systems.

    Raises
    ------
    BrepError
        If an edge is too short or a quad of degree 1 has no area; it is named.
    """
    ends = patches.edge_control_points[:, [0, -1]]  # (e, 2, 3)
    spans = length(ends[:, 1] - ends[:, 0])
    short = np.flatnonzero(spans < LEAST_SIZE)
    if len(short):
        a, b = patches.mesh.edges[short[0]].tolist()
        raise BrepError(
            f"the edge between vertices {a} and {b} is {spans[short[0]]:g} mm long; "
            f"need {LEAST_SIZE:g} mm or more"
        )
    if patches.degree > 1:
        return
    corners = patches.mesh.vertices[patches.quads]  # (f, 4, 3)
    ahead = np.roll(corners, -1, axis=1) - corners
    areas = length(np.cross(ahead, np.roll(ahead, -1, axis=1))).max(axis=1)  # (f,)
    heights = areas / length(ahead).max(axis=1)
    thin = np.flatnonzero(heights < LEAST_SIZE)
    if len(thin):
        raise BrepError(
            f"quad {thin[0]} is {heights[thin[0]]:g} mm wide; need {LEAST_SIZE:g} mm or more"
        )


def tessellated(
    shape: Shape, angle: float = TESSELLATION_ANGLE, *, coarser: float = 1.0
) -> TriangleMesh:
    """Return the triangles of a build123d shape, at most `tessellation_distance` off its faces.

    Faces share the vertices of their edges: the triangles of a solid are closed.

    Parameters
    ----------
    angle : largest angle between neighboring triangles of a face, rad
    coarser : factor of the distance

    Raises
    ------
    BrepError
        If a face has no triangles, as one that is not finite.
    """
    from scaffold_cad.brep import occt

    points, triangles = occt.tessellate(shape, coarser * tessellation_distance(shape), angle)
    same_place = cKDTree(points).query_pairs(LEAST_SIZE / 2, output_type="ndarray")
    vertex = component_labels(same_place, len(points))  # one for each point
    _, first = np.unique(vertex, return_index=True)
    welded = vertex[triangles]
    # At a pole or a tip a triangle has two corners in one place.
    return TriangleMesh(points[first], welded[have_distinct_corners(welded)])


def tessellation_distance(shape: Shape) -> float:
    """Return how far triangles of a shape with curved faces may be off these, mm."""
    diagonal = float(shape.bounding_box(optimal=False).diagonal)
    most = max(TESSELLATION_MOST * diagonal, LEAST_SIZE)
    return min(max(TESSELLATION_DISTANCE, TESSELLATION_SHARE * diagonal), most)


def tessellation_error(shape: Shape) -> float:
    """Return how far the triangles of `tessellated` may be off a shape's faces, mm."""
    from build123d import GeomType

    is_plane = all(face.geom_type == GeomType.PLANE for face in shape.faces())
    return 0.0 if is_plane else tessellation_distance(shape)


def read_brep(path: Path) -> Shape:
    """Return the shapes in a STEP or a BREP file, in mm.

    Raises
    ------
    FormatError
        If the file cannot be read or holds no solid.
    """
    shape = read_shape(path)
    if not shape.solids():
        raise FormatError(f"{path} holds no solid; need one")
    return shape


def read_shape(path: Path) -> Shape:
    """Return the shapes in a file of a CAD format, in mm.

    Raises
    ------
    FormatError
        If it cannot be read.
    """
    check_there(path)
    need("build123d", f"a {path.suffix[1:].upper()} file")
    from scaffold_cad.brep import occt

    is_brep = path.suffix.lower() == ".brep"
    if is_brep:
        check_brep_file(path)
    read = occt.import_brep if is_brep else occt.import_step
    with unpacked(path) as plain:
        try:
            return read(plain)
        except (OSError, RuntimeError, ValueError) as error:
            raise FormatError(f"{path} cannot be read: {error}") from None


def export_step(shape: Shape, path: Path, *, write_pcurves: bool = False) -> None:
    """Write a build123d shape to a STEP file in mm.

    Parameters
    ----------
    shape : any build123d shape; its labels and colors are kept
    path : of the file; `write` writes it whole or not at all
    write_pcurves : whether each edge is also written in the parameters of its faces, for programs
        that ask for it; it doubles the file

    Raises
    ------
    OSError
        If OCCT cannot write the file.
    """
    need("build123d", "a STEP file")
    from scaffold_cad.brep import occt

    if not occt.export_step(shape, path, write_pcurves=write_pcurves):
        raise OSError("OCCT could not write it")


def export_brep(shape: Shape, path: Path) -> None:
    """Write a build123d shape to a BREP file, OCCT's own format.

    Raises
    ------
    OSError
        If OCCT cannot write the file.
    """
    need("build123d", "a BREP file")
    from scaffold_cad.brep import occt

    if not occt.export_brep(shape, path):
        raise OSError("OCCT could not write it")
