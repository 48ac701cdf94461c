"""B-reps of beam lattices and meshes that stand together: several bodies, or one of facets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad import brep
from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import place_text
from scaffold_cad.errors import BrepError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.assembly import Assembly, assembly_solid, models_of
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.facets import faceted
from scaffold_cad.products.models import Make
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.skeleton.beams import BeamLattice
from scaffold_cad.solid.beamsolids import solid_of_mesh
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.struts import round_struts

if TYPE_CHECKING:
    from build123d import Shape

HIDDEN = 1 + 1e-9
"""Radius of a ball, in radii of its node, up to which it is taken for a part of the node."""


def assembly_brep(
    assembly: Assembly, make: Make = round_struts, *, overlaps: Overlaps = "refuse"
) -> Shape:
    """Return the B-rep of an assembly: each lattice a body, and each mesh, its plane faces joined.

    The bodies are not united, and may overlap. With overlaps="unite" there is one body instead, of
    the plane triangles of `assembly_solid`: clipped, and with its balls.

    Parameters
    ----------
    make : what makes a RoundStruts or a Scaffold of a skeleton
    overlaps : of the struts of a lattice, see `to_brep`

    Returns
    -------
    build123d Compound, its children labeled; or a Solid of triangles

    Raises
    ------
    BrepError
        If beams are clipped or have balls, unless all is united; if struts overlap and are refused;
        if there are too many triangles.
    MeshError
        If a mesh is not closed.
    MissingBackendError
        If build123d is not installed.

    Examples
    --------
    >>> from scaffold_cad import BeamLattice, Skeleton, TriangleMesh
    >>> from scaffold_cad.products.assembly import Assembly
    >>> from scaffold_cad.products.assemblybreps import assembly_brep
    >>> strut = Skeleton([[0, 0, 0], [0, 0, 10]], [[0, 1]], 1.0)
    >>> corners = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> wedge = TriangleMesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> both = assembly_brep(Assembly([BeamLattice(strut)], [wedge]))
    >>> [len(body.faces()) for body in both.children]
    [3, 4]
    """
    check_kind(assembly, Assembly)
    if overlaps == "unite":
        solid = assembly_solid(assembly, make=make)
        return brep.with_plane_faces(faceted(manifold_triangles(solid)))
    for lattice in assembly.lattices:
        _check_exact(lattice)
    bodies = [to_brep(model, overlaps=overlaps) for model in models_of(assembly, make)]
    meshes = [*assembly.meshes, *(o.mesh for o in assembly.lattices if o.mesh is not None)]
    names = [f"beams {k}" for k in range(len(bodies))] + [f"mesh {k}" for k in range(len(meshes))]
    return brep.bodies(dict(zip(names, [*bodies, *map(_solid, meshes)], strict=True)))


def _solid(mesh: TriangleMesh) -> Shape:
    solid_of_mesh(mesh)  # refuses one that is open, or inside out
    return brep.with_plane_faces(faceted(mesh))


def _check_exact(lattice: BeamLattice) -> None:
    """Raise if a lattice has what exact faces of struts do not have."""
    found = []
    if lattice.clip is not None:
        found.append(f"are clipped to what is {lattice.clipping} of a mesh")
    balls = np.flatnonzero(lattice.balls > HIDDEN * lattice.skeleton.radii)
    if len(balls):
        place = place_text(lattice.skeleton.nodes[balls[0]])
        found.append(
            f"have a ball of radius {lattice.balls[balls[0]]:g} mm at node {balls[0]}, {place}"
        )
    if found:
        raise BrepError(
            f"beams {' and '.join(found)}, which their exact faces are not; need a mesh format "
            "(.stl, .3mf, ...), or overlaps='unite' for plane triangles"
        )
