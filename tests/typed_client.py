"""A program of a user, for `mypy --strict`: every call here is one that the types must allow.

`test_typing.py` checks and runs it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad import (
    BeamLattice,
    ConvolutionField,
    QuadMesh,
    Skeleton,
    TriangleMesh,
    UnitCell,
    build_scaffold,
    catmull_clark,
    check_skeleton,
    delaunay_foam,
    fill,
    frame_scaffold,
    mapped,
    partition_sphere,
    partition_spheres,
    project,
    relative_density,
    rotation_minimizing_frames,
    round_struts,
    self_intersections,
    smooth_patches,
    solidified,
    solve_radius,
    thicken,
    tile,
    to_solid,
    voronoi_foam,
    write,
)
from scaffold_cad.io import RawSkeleton

NODES = [[0, 0, 0], [20, 0, 0], [0, 20, 0], [0, 0, 20]]
BOX = [[0, 0, 0], [20, 20, 20]]


def skeletons() -> Skeleton:
    """Return a skeleton; others are made of lists, tuples, numbers and arrays."""
    strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    check_skeleton(strut.scaled(2).moved([(0, 0, 0), (0, 0, 9)]).with_radii([1, 2]))
    tripod = Skeleton(NODES, [(0, 1), (0, 2), (0, 3)], [3.0, 2, 2, 1])
    tripod = Skeleton(np.array(NODES), tripod.edges, np.float32(2)).cleaned().skeleton
    longest = tripod.with_edges(tripod.lengths == tripod.lengths.max())
    check_skeleton(longest.with_edges([0]).simplified(0.1))
    RawSkeleton(NODES, [[0, 1]])
    return tripod.moved(tripod.nodes * [1.2, 1.0, 0.9])


def scaffolds(folder: Path) -> None:
    """Build scaffolds and what is made from them."""
    skeleton = skeletons()
    scaffold = build_scaffold(skeleton, fit="paper", section="round", collars=True)
    again = build_scaffold(skeleton.moved(skeleton.nodes + 1), like=scaffold)
    angles = np.degrees(np.nanmin(again.clearance)), np.degrees(again.twist.max())
    write(scaffold, folder / f"{angles[0]:.0f}.stl")
    kept: int = scaffold.embedding().kept.sum()
    solid = solidified(scaffold)
    assert solid.manifold.volume() > 0
    assert kept == len(skeleton.edges) - len(solid.united_edges)
    write(thicken(scaffold, 0.2), folder / "frame.stl")
    write(frame_scaffold(scaffold, radius=0.2).mesh, str(folder / "frame.obj"))
    struts = round_struts(skeleton.with_radii(1.0), blend=0.5, ends="round")
    assert struts.exact.all()
    assert to_solid(struts, sides=8).volume() < solidified(struts, sides=16).manifold.volume()
    write(struts, folder / "struts.stl", overlaps="refuse", sides=8)
    write(struts, folder / "struts.step", overlaps="unite")
    write(smooth_patches(frame_scaffold(skeleton, 1).mesh, split=1), folder / "patches.step")
    field = ConvolutionField(skeleton, "cauchy", width=1)
    field.value([[0, 0, 0]]) + field.samples(skeleton.nodes[:1]).values
    coarse = build_scaffold(skeleton, collars=True).mesh
    project(catmull_clark(coarse, levels=2, creases=coarse.edges).mesh, field)
    write(BeamLattice(skeleton, balls=1.0), folder / "beams.3mf")
    write(BeamLattice(skeleton, [1, 0, 0, 0], mesh=solid.manifold), folder / "both.3mf")


def meshes() -> None:
    """Make meshes of lists."""
    corners = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    cube = QuadMesh(corners, quads)
    assert to_solid(cube.moved(2 * cube.vertices)).volume() == 8
    assert len(self_intersections(TriangleMesh(corners, cube.triangles))) == 0
    catmull_clark(cube, 1).mesh.check_closed()


def lattices() -> None:
    """Make lattices of cells, in boxes and of chance."""
    cell = UnitCell("diagonal", [[0, 0, 0], [1, 1, 1]], [[0, 1]], proportions=[1, 1, 2])
    tile(cell, 10, 2, radius=1)
    octets = tile("octet", (8, 8, 4), (2, 2, 1), radius=lambda points: 0.3 + points[:, 2] / 20)
    mapped(octets, lambda points: points * [1, 1, 2])
    fill(BOX, "bcc", 5.0, 0.5)
    voronoi_foam(9, BOX, 0.5)
    delaunay_foam(9, np.array(BOX), 0.5)
    assert relative_density("sc", 5.0, solve_radius("sc", [5, 5, 5], 0.1)) < 0.11


def partitions() -> None:
    """Cut spheres, and carry frames."""
    star = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1]]
    alone = partition_sphere(star, neighbors=[(0, 1)])
    many = partition_spheres([star, star], "dual")
    again = partition_spheres(many.directions, like=many.quads, near=many.vertices)
    assert alone.relative_clearance > 0
    assert again.relative_clearance.shape == (2,)
    rotation_minimizing_frames([[0, 0, 0], [1, 0, 0], [2, 1, 0]], [0, 0, 1])[-1]


def mistakes() -> None:
    """Mistakes that the types must not allow: an unused ignore is an error."""
    build_scaffold(NODES)  # type: ignore[arg-type]
    build_scaffold(skeletons(), fit="encloses")  # type: ignore[arg-type]
    Skeleton(NODES)  # type: ignore[call-arg]
    skeletons().nodes = np.zeros((4, 3))  # type: ignore[misc]


def main(folder: Path) -> None:
    """Do all but the mistakes."""
    scaffolds(folder)
    meshes()
    lattices()
    partitions()
