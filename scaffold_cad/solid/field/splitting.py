"""Meshes whose sides are split at new vertices, and what is wrong with these."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Ints, Points
from scaffold_cad.base.vectors import length
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.intersections.faces import boxes_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field.cells import packed, unpacked
from scaffold_cad.solid.field.grid import AROUND

NO_AREA = 1e-6
"""Least area of a triangle, as a part of its square size."""


def split_sides(vertices: Points, triangles: Ints, sides: Edges, new: Ints) -> Ints:
    """Return triangles with some of their sides split at new vertices, (t', 3)."""
    if len(sides) == 0:
        return triangles
    low, high = np.sort(sides, axis=1).T
    keys = low * len(vertices) + high
    order = np.argsort(keys)
    keys, new = keys[order], new[order]
    marks = np.zeros(len(vertices), dtype=np.bool_)
    marks[sides] = True
    touched = marks[triangles].sum(axis=1) > 1
    own = triangles[touched]
    pairs = np.sort(np.stack([own, np.roll(own, -1, axis=1)], axis=2), axis=2)  # (t, 3, 2)
    asked = pairs[..., 0] * len(vertices) + pairs[..., 1]
    at = np.minimum(np.searchsorted(keys, asked), len(keys) - 1)
    middle = np.where(keys[at] == asked, new[at], -1)  # on the side from each corner to the next
    count = (middle >= 0).sum(axis=1)
    parts = [triangles[~touched], own[count == 0]]
    # Turned so that sides that are split come first; two of them: so that the third is not.
    turn = np.where(count == 2, (middle < 0).argmax(axis=1) + 1, (middle >= 0).argmax(axis=1))
    turns = (turn[:, None] + np.arange(3)) % 3
    own, middle = (np.take_along_axis(each, turns, axis=1) for each in (own, middle))
    (a, b, c), (p, _, _) = own[count == 1].T, middle[count == 1].T
    parts += [np.stack(each, axis=1) for each in ((a, p, c), (p, b, c))]
    (a, b, c), (p, q, _) = own[count == 2].T, middle[count == 2].T
    first = length(vertices[a] - vertices[q]) < length(vertices[p] - vertices[c])
    parts.append(np.stack([p, b, q], axis=1))
    parts += [np.stack(each, axis=1)[first] for each in ((a, p, q), (a, q, c))]
    parts += [np.stack(each, axis=1)[~first] for each in ((a, p, c), (p, q, c))]
    (a, b, c), (p, q, r) = own[count == 3].T, middle[count == 3].T
    parts += [np.stack(each, axis=1) for each in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
    return np.concatenate(parts)


def faulty(mesh: TriangleMesh, around: Ints) -> Bools:
    """Return the vertices of triangles with no area or that meet others, (v,).

    Parameters
    ----------
    around : vertices whose triangles are looked at, with what is near these
    """
    marks = np.zeros(len(mesh.vertices), dtype=np.bool_)
    marks[around] = True
    own = np.flatnonzero(marks[mesh.triangles].any(axis=1))
    near = _near(mesh, own)
    some = TriangleMesh(mesh.vertices, mesh.triangles[near])
    meet = near[np.unique(self_intersections(some, weld=False))]
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles[own]], 1, 0)
    size = np.maximum(length(b - a), length(c - a))
    flat = own[length(np.cross(b - a, c - a)) < NO_AREA * size * size]
    found = np.zeros(len(mesh.vertices), dtype=np.bool_)
    found[mesh.triangles[np.append(meet, flat)]] = True
    return found


def _near(mesh: TriangleMesh, own: Ints) -> Ints:
    """Return the triangles that may meet some of them, with these, ascending.

    They are sorted into boxes of about their size.
    """
    low, high = boxes_of(mesh.vertices[mesh.triangles])
    origin, size = mesh.vertices.min(axis=0), (high - low).max(axis=1)
    least = size[own].max()
    octave = np.ceil(np.log2(np.maximum(size / least, 1.0))).astype(np.intp)
    found = []
    for number in np.unique(octave).tolist():
        rows = np.flatnonzero(octave == number)
        box = least * 2.0**number
        at = np.unique(packed(np.floor((low[own] - origin) / box).astype(np.intp)))
        # A triangle begins in the box where another one does, or in one beside it.
        keys = np.unique(packed(unpacked(at)[:, None] + AROUND - 1))
        place = packed(np.floor((low[rows] - origin) / box).astype(np.intp))
        found.append(rows[np.isin(place, keys)])
    return np.unique(np.concatenate(found))
