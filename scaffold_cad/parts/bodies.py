"""B-reps of scaffolds that are sound: their faces do not cross."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Ints
from scaffold_cad.base.backends import need
from scaffold_cad.base.topology import component_labels
from scaffold_cad.errors import BrepError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth import Caps, Patches, crossing_struts
from scaffold_cad.smooth.patches import patches_around
from scaffold_cad.solid import manifolds, to_solid
from scaffold_cad.solid.roundstruts import ROUND_SIDES

if TYPE_CHECKING:
    from build123d import Shape
    from manifold3d import Manifold

MOST_TRIANGLES = 10_000
"""Most triangles of a union that become faces: CAD programs are slow with more."""

NAMED = 5
"""Struts that an error names."""


@dataclass(frozen=True, eq=False)
class BodySurface:
    """The faces of a scaffold's B-rep, and the struts whose faces may cross others."""

    scaffold: Scaffold
    """The scaffold."""
    faces: QuadMesh | Patches
    """One face a quad."""
    overlapping: Ints
    """Struts that are not known to keep apart from the others, ascending."""


def body_surface(scaffold: Scaffold, *, smooth: bool = False, caps: Caps = "round") -> BodySurface:
    """Return the faces of a scaffold, tested: see `crossing_struts` and `Scaffold.embedding`.

    Parameters
    ----------
    smooth : whether nodes are smooth and struts round, see `to_brep`
    caps : of the smooth solid, see `smooth_patches`
    """
    if not smooth:
        return BodySurface(scaffold, scaffold.mesh, scaffold.embedding().left_out)
    # Patches that turn over are among those that cross, and so reported.
    patches = patches_around(scaffold, caps=caps)
    return BodySurface(scaffold, patches, crossing_struts(patches, scaffold))


def sound_body(surface: BodySurface, *, unite: bool = False) -> Shape:
    """Return the B-rep of a scaffold whose struts keep apart, or of their union.

    Parameters
    ----------
    unite : whether struts that overlap are united. The union is made of triangles, each of
        which becomes a plane face; round struts get 16 sides

    Returns
    -------
    build123d Solid, or a Compound of several

    Raises
    ------
    BrepError
        If struts overlap and `unite` is not asked for, or the union has too many triangles.
    """
    overlapping, struts = surface.overlapping, len(surface.scaffold.skeleton.edges)
    if len(overlapping) == 0:
        return to_brep(surface.faces)
    if not unite:
        raise BrepError(
            f"{len(overlapping)} of {struts} struts may overlap others "
            f"(edges {_listed(overlapping)}) and the faces of a B-rep would cross; need struts "
            "apart (smaller radii, larger cells), or unite=True for a B-rep of the triangles of "
            "their union, or to_mesh_shape(to_solid(scaffold)) for a mesh"
        )
    sides = ROUND_SIDES if isinstance(surface.faces, Patches) else 4
    return solid_of_union(surface.scaffold, sides=sides)


def solid_of_union(scaffold: Scaffold, *, sides: int) -> Shape:
    """Return the union of a scaffold's struts as a B-rep, each triangle a plane face.

    Raises
    ------
    BrepError
        If it has more than 10 000 triangles, or one without area.
    """
    return solid_of_manifold(to_solid(scaffold, sides=sides))


def solid_of_manifold(manifold: Manifold) -> Shape:
    """Return a manifold3d solid as a B-rep, each triangle a plane face.

    Raises
    ------
    BrepError
        If it has more than 10 000 triangles, or one without area.
    """
    mesh = manifolds.manifold_triangles(manifold)
    if len(mesh.triangles) > MOST_TRIANGLES:
        raise BrepError(
            f"the union of the struts has {len(mesh.triangles)} triangles; need "
            f"{MOST_TRIANGLES} or less for a B-rep (to_mesh_shape(to_solid(scaffold)) shows and "
            "exports any number)"
        )
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtmeshes

    return occtmeshes.solid_of_triangles(mesh.vertices, mesh.triangles, _shell_of_triangle(mesh))


def _shell_of_triangle(mesh: TriangleMesh) -> Ints:
    """Return the shell of each triangle, shape (t,)."""
    links = mesh.triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    part = component_labels(links, len(mesh.vertices))
    _, shell = np.unique(part[mesh.triangles[:, 0]], return_inverse=True)
    return shell.reshape(-1)


def _listed(edges: Ints) -> str:
    shown = ", ".join(str(edge) for edge in edges[:NAMED].tolist())
    return shown if len(edges) <= NAMED else f"{shown}, ..."
