"""Named quad meshes for tests: small, with volumes known in closed form. Lengths in mm."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.mesh.quadmesh import QuadMesh

CUBE = QuadMesh(
    np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float),
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)
"""Side 2 around the origin, volume 8; all quads flat."""

INSIDE_OUT_CUBE = QuadMesh(CUBE.vertices, CUBE.quads[:, ::-1])
"""The cube with clockwise quads: closed, volume -8."""

OPEN_CUBE = QuadMesh(CUBE.vertices, CUBE.quads[:5])
"""The cube without its quad at z = 1, which has the vertices 1, 5, 7 and 3."""

TWO_CUBES = QuadMesh(
    np.concatenate([CUBE.vertices, CUBE.vertices + np.array([5, 0, 0])]),
    np.stack([CUBE.quads, CUBE.quads + 8], axis=1).reshape(-1, 4),
)
"""Two cubes apart, volume 16, their quads by turns."""

DART_PRISM = QuadMesh(
    np.array([[x, y, z] for z in (0, 3) for x, y in ((0, 0), (3, 1), (6, 0), (3, 5))], float),
    [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
)
"""Height 3 over a flat quad of area 12 that is not convex; volume 36."""

TWIST = np.pi / 6
"""Angle between the sections of the twisted tube, rad."""


def twisted_tube(layers: int, *, radius: float = 2.0, height: float = 3.0) -> QuadMesh:
    """Return square sections on the z axis with corners at `radius`, each turned by `TWIST`."""
    level, corner = np.divmod(np.arange(4 * (layers + 1)), 4)
    angle = corner * np.pi / 2 + level * TWIST
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), height * level], axis=1)
    low = 4 * np.arange(layers)[:, None] + np.arange(4)  # (layers, 4)
    nearby = 4 * np.arange(layers)[:, None] + (np.arange(4) + 1) % 4
    sides = np.stack([low, nearby, nearby + 4, low + 4], axis=2).reshape(-1, 4)
    caps = [[3, 2, 1, 0], 4 * layers + np.arange(4)]
    return QuadMesh(vertices, np.concatenate([sides, caps]))


def twisted_tube_volume(layers: int, *, radius: float = 2.0, height: float = 3.0) -> float:
    """Return its volume, mm³.

    At a share t of a layer the section is a square whose corners are on straight lines: its area
    is 2 r² (1 − 2 t (1 − t) (1 − cos θ)).
    """
    return layers * 2 * radius**2 * height * (1 - (1 - np.cos(TWIST)) / 3)


TWISTED_TUBE = twisted_tube(4)
"""Four layers; its sides are not flat."""


def torus(around: int, across: int, *, seed: int | None = None) -> QuadMesh:
    """Return a torus of quads with radii 10 and 4; `seed` moves its vertices a little."""
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    u, v = 2 * np.pi * i / around, 2 * np.pi * j / across
    reach = 10 + 4 * np.cos(v)
    vertices = np.stack([reach * np.cos(u), reach * np.sin(u), 4 * np.sin(v)], axis=2)
    if seed is not None:
        size = 1 / max(around, across)
        vertices += np.random.default_rng(seed).uniform(-size, size, vertices.shape)

    def number(i: Floats, j: Floats) -> Floats:
        return (i % around) * across + j % across

    quads = np.stack(
        [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)], axis=2
    )
    return QuadMesh(vertices.reshape(-1, 3), quads.reshape(-1, 4))


TORUS = torus(12, 8, seed=1)
"""96 quads, none of them flat, genus 1."""


def elevated(mesh: QuadMesh, degree: int) -> Floats:
    """Return the control points of `degree` of the bilinear patches, (f, degree + 1, .., 3)."""
    u, v = np.meshgrid(*[np.linspace(0, 1, degree + 1)] * 2, indexing="ij")
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=2)
    return np.einsum("ijk,fkx->fijx", weights, mesh.vertices[mesh.quads])


def pillow(height: float) -> BezierMesh:
    """Return the cube with patches of degree 2 whose middle control point is `height` further out.

    The middle Bernstein polynomial has mean 1/3: a face of area 4 gains 4/9 of `height`.
    """
    points = elevated(CUBE, 2)
    points[:, 1, 1] *= 1 + height
    return BezierMesh(CUBE.quads, points)


def ball(degree: int) -> BezierMesh:
    """Return the cube with its control points of `degree` moved onto the sphere of radius √3."""
    points = elevated(CUBE, degree)
    lengths = np.linalg.norm(points, axis=3, keepdims=True)
    return BezierMesh(CUBE.quads, points * np.sqrt(3) / lengths)
