"""The proof that curves do not cross themselves from one circle to the next but one.

A piece is the image of a cylinder, (x, y, v) ↦ A(v) + B(v) (x, y) with x² + y² ≤ 1. Where the
symmetric part of its derivative, after one turn and one scaling for the whole piece, is positive
definite, it takes no two points to one, as the cylinder is convex. That derivative is a sum, with
weights that add up to 1, of its Bernstein coefficients at the corners of a polygon around the disc:
it is enough that these are positive definite. And the piece lies between the planes of its two
circles, where its neighbors touch it, if the discs that control it do. Where either is not so, the
piece is halved and its parts are looked at, a few times over.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.brep.bernstein import bernstein, elevation
from scaffold_cad.struts.curves.curve import ALONG, Curves

DEPTH = 4
"""How often pieces are halved before the proof is given up."""

CORNERS = 12
"""Corners of the polygon around the disc."""

LEAST = 1e-9
"""Least eigenvalue, and height above a plane in parts of the piece's length, beyond rounding."""

_ANGLES = 2 * np.pi * np.arange(CORNERS) / CORNERS
_POLYGON = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1) / np.cos(np.pi / CORNERS)
_AT = np.arange(ALONG + 1) / ALONG
_TO_BERNSTEIN = np.linalg.inv(bernstein(ALONG, _AT))
_ELEVATED = elevation(ALONG - 1, ALONG)
_HALVES = tuple(_TO_BERNSTEIN @ bernstein(ALONG, _AT / 2 + shift) for shift in (0.0, 0.5))


def proved(curves: Curves) -> Bools:
    """Return whether each piece is proved to be free of folds, shape (p,)."""
    first, last = curves.pieces, curves.pieces + 1
    chord = curves.centers[last] - curves.centers[first]
    size = length(chord)
    scale = np.stack([curves.speeds, *[(curves.radii[first] + curves.radii[last]) / 2] * 2], axis=1)
    planes = _Planes(
        np.stack([curves.centers[first], curves.centers[last]], axis=1),
        np.stack([curves.tangents[first], -curves.tangents[last]], axis=1),
    )
    frames = curves.frames
    turned = _turns(chord / size[:, None], frames[:, :, 1].sum(axis=1))
    found = _beside_straight(curves)
    owner, ends = np.arange(len(first)), np.ones((len(first), 2), dtype=np.bool_)
    for depth in range(DEPTH + 1):
        good = _definite(frames, turned[owner], scale[owner] / [2.0**depth, 1.0, 1.0])
        good &= _between(frames, planes.of(owner), ends, LEAST * size[owner])
        doubtful = ~good & found[owner]
        if depth == DEPTH:
            found[owner[doubtful]] = False
        if depth == DEPTH or not doubtful.any():
            break
        owner, ends = owner[doubtful], ends[doubtful]
        frames = np.concatenate([np.einsum("ij,pjkx->pikx", h, frames[doubtful]) for h in _HALVES])
        inner = np.zeros((len(owner), 1), dtype=np.bool_)
        ends = np.concatenate([np.hstack([ends[:, :1], inner]), np.hstack([inner, ends[:, 1:]])])
        owner = np.tile(owner, 2)
    return found


@dataclass(frozen=True, eq=False)
class _Planes(Frozen):
    """The planes of the circles at both ends of pieces."""

    origins: Points
    """Shape (p, 2, 3), mm."""
    normals: UnitVectors
    """Toward the piece, shape (p, 2, 3)."""

    def of(self, rows: Ints) -> _Planes:
        return _Planes(self.origins[rows], self.normals[rows])


def _turns(axis: UnitVectors, across: Floats) -> Floats:
    """Return frames with rows along `axis` and nearly along `across` (p, 3), (p, 3, 3)."""
    x = normalize(across - dot(across, axis)[:, None] * axis)
    return np.stack([axis, x, np.cross(axis, x)], axis=1)


def _definite(frames: Floats, turned: Floats, scale: Floats) -> Bools:
    """Return whether the derivative's symmetric part is positive definite, shape (p,).

    Parameters
    ----------
    frames : (p, 4, 3, 3) control points of A and of B's columns, mm
    turned : (p, 3, 3) frames in which the derivative is looked at
    scale : (p, 3) lengths of its columns, mm
    """
    by_v = _ELEVATED @ (ALONG * np.diff(frames, axis=1)).reshape(len(frames), ALONG, 9)
    by_v = by_v.reshape(frames.shape)  # of A and of B's columns
    ahead = by_v[:, :, None, 0] + np.einsum("ck,pjkx->pjcx", _POLYGON, by_v[:, :, 1:])
    columns = np.empty((*ahead.shape[:3], 3, 3))  # column, coordinate
    columns[..., 0, :] = ahead
    columns[..., 1:, :] = frames[:, :, None, 1:]
    local = np.einsum("pjckx,pyx->pjcky", columns, turned) / scale[:, None, None, :, None]
    least = np.linalg.eigvalsh(local + np.swapaxes(local, -1, -2))[..., 0]
    return np.asarray((least > LEAST).all(axis=(1, 2)))


def _between(frames: Floats, planes: _Planes, ends: Bools, least: Floats) -> Bools:
    """Return whether pieces lie between planes, which only their own circles touch, shape (p,).

    Parameters
    ----------
    ends : (p, 2) whether each begins and ends on the circle of a plane
    least : (p,) mm
    """
    away = frames[:, :, 0, None] - planes.origins[:, None]  # (p, 4, 2, 3)
    height = np.einsum("pjex,pex->pje", away, planes.normals)
    across = np.einsum("pjkx,pex->pjek", frames[:, :, 1:], planes.normals)
    room = height - np.hypot(across[..., 0], across[..., 1])  # (p, 4, 2)
    room[ends[:, 0], 0, 0] = np.inf
    room[ends[:, 1], -1, 1] = np.inf
    return np.asarray((room > least[:, None, None]).all(axis=(1, 2)))


def _beside_straight(curves: Curves) -> Bools:
    """Return whether straight struts stay beyond the planes of the next joints, shape (p,).

    The circle where they begin does; from there they go on with their slope.
    """
    first, last = curves.pieces, curves.pieces + 1
    ahead = dot(curves.tangents[first], curves.tangents[last])
    sine = length(np.cross(curves.tangents[first], curves.tangents[last]))
    slope = np.maximum(np.abs(curves.slopes[first]), np.abs(curves.slopes[last]))
    is_straight = (curves.nodes[first] < 0) | (curves.nodes[last] < 0)
    return np.asarray(~is_straight | (ahead > slope * sine + LEAST))
