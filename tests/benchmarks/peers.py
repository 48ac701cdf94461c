"""The same work done by other packages, where they are installed; none of them is needed."""

from __future__ import annotations

import numpy as np

from scaffold_cad.skeleton import Skeleton

SIDES = 8
"""Sides of the cylinders that manifold3d unites."""


def manifold_union(skeleton: Skeleton) -> None:
    """Unite a cylinder per strut and a ball per node by manifold3d."""
    import manifold3d

    parts = [
        manifold3d.Manifold.sphere(radius, SIDES).translate(node)
        for node, radius in zip(skeleton.nodes.tolist(), skeleton.radii.tolist(), strict=True)
    ]
    for edge, span in zip(skeleton.edges.tolist(), skeleton.lengths.tolist(), strict=True):
        start, end = skeleton.nodes[edge]
        radii = skeleton.radii[edge].tolist()
        strut = manifold3d.Manifold.cylinder(span, *radii, SIDES)
        frame = np.column_stack([_axes((end - start) / span), start])
        parts.append(strut.transform(frame))
    manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add).num_tri()


def build123d_fuse(skeleton: Skeleton) -> None:
    """Fuse a cylinder per strut and a ball per node by build123d."""
    import build123d as bd

    parts: list[bd.Solid] = [
        bd.Solid.make_sphere(radius, angle1=-90).moved(bd.Location(node))
        for node, radius in zip(skeleton.nodes.tolist(), skeleton.radii.tolist(), strict=True)
    ]
    for a, b in skeleton.edges.tolist():
        start, end = bd.Vector(*skeleton.nodes[a]), bd.Vector(*skeleton.nodes[b])
        plane = bd.Plane(start, z_dir=end - start)
        parts.append(bd.Solid.make_cylinder(skeleton.radii[a], (end - start).length, plane))
    if parts[0].fuse(*parts[1:]).volume <= 0:
        raise RuntimeError("build123d made no solid")


def pygel_feq(skeleton: Skeleton) -> None:
    """Build PyGEL3D's face extrusion quad mesh."""
    from pygel3d import graph, hmesh

    gel = graph.Graph()
    for node in skeleton.nodes.tolist():
        gel.add_node(node)
    for a, b in skeleton.edges.tolist():
        gel.connect_nodes(a, b)
    hmesh.skeleton_to_feq(gel, skeleton.radii.tolist())


def _axes(z: np.ndarray) -> np.ndarray:
    """Return a rotation matrix whose last column is `z`."""
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
