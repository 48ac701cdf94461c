"""Ends of round struts as triangles: plane discs and hemispheres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.struts.bands import polygon_slack
from scaffold_cad.struts.runs import Runs
from scaffold_cad.struts.volumes import triangle_volumes

ROUNDS = 12
"""Times that the volume of round ends is looked at."""


def flat_ends(
    runs: Runs, ends: Ints, radius: Floats, rings: Ints, points: Points, count: int
) -> tuple[Points, Triangles]:
    """Return the middles of discs and the triangles around them.

    Parameters
    ----------
    ends : (e,) half-runs that leave the nodes where struts end
    radius : (e,) mm; unused, see `round_ends`
    rings : (e, s) vertices of the rings, counter-clockwise about the half-runs
    points : (e, s, 3) their positions, mm
    count : vertices so far
    """
    del radius, points
    middle = count + np.arange(len(ends))
    triangles = np.stack(
        [np.roll(rings, -1, axis=1), rings, np.broadcast_to(middle[:, None], rings.shape)], axis=-1
    )
    return runs.nodes[runs.tails[ends]], triangles.reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class EndSpheres(Frozen):
    """Spheres that touch struts along their last circles."""

    center: Floats
    """Distance of each center from the node, outward, shape (e,), mm."""
    size: Floats
    """Radius, shape (e,), mm."""
    start: Floats
    """Latitude of the last circle, shape (e,), rad."""


def end_spheres(runs: Runs, ends: Ints, radius: Floats) -> EndSpheres:
    """Return the spheres of round ends; the parameters are those of `flat_ends`."""
    slope = -runs.slopes[ends]  # growth outward
    center = radius * slope
    return EndSpheres(center, radius * np.hypot(1.0, slope), np.arctan2(-center, radius))


def round_ends(
    runs: Runs, ends: Ints, radius: Floats, rings: Ints, points: Points, count: int
) -> tuple[Points, Triangles]:
    """Return the vertices and triangles of spheres that join the struts with one tangent plane.

    A cylinder ends in a hemisphere; a cone in the part of the sphere that touches it along its
    last circle. The parameters are those of `flat_ends`.
    """
    number, sides = rings.shape
    sphere = end_spheres(runs, ends, radius)
    center, size, start = sphere.center, sphere.size, sphere.start
    levels = max(1, sides // 4)
    share = np.arange(1, levels) / levels
    latitude = start[:, None] + share * (np.pi / 2 - start[:, None])  # (e, levels - 1)
    node = runs.nodes[runs.tails[ends]]
    outward = -runs.directions[ends]
    spoke = points - points.mean(axis=1, keepdims=True)  # (e, s, 3), as long as the ring is wide
    wide = size[:, None] * np.cos(latitude) / radius[:, None]
    high = center[:, None] + size[:, None] * np.sin(latitude)
    around = wide[..., None, None] * spoke[:, None]  # (e, levels - 1, s, 3)
    around = around + (high[..., None] * outward[:, None])[:, :, None]
    tip = (center + size)[:, None] * outward
    wanted = np.pi / 3 * (center + size) ** 2 * (2 * size - center)
    larger = _larger(spoke, around, tip, wanted)
    inner = node[:, None, None] + larger[:, None, None, None] * around
    pole = node + larger[:, None] * tip
    block = (levels - 1) * sides + 1
    first = count + block * np.arange(number)
    own = first[:, None, None] + np.arange((levels - 1) * sides).reshape(levels - 1, sides)
    stack = np.concatenate([rings[:, None], own], axis=1)  # (e, levels, s)
    low, above = stack[:, :-1].reshape(-1, sides), stack[:, 1:].reshape(-1, sides)
    a, b, d, c = low, np.roll(low, -1, 1), above, np.roll(above, -1, 1)
    bands = np.stack([np.stack([b, a, d], -1), np.stack([b, d, c], -1)], axis=2)
    last = stack[:, -1]
    tip = np.broadcast_to((first + block - 1)[:, None], last.shape)
    fans = np.stack([np.roll(last, -1, axis=1), last, tip], axis=-1)
    vertices = np.concatenate(
        [inner.reshape(number, (levels - 1) * sides, 3), pole[:, None]], axis=1
    )
    closing = np.concatenate(
        [bands.reshape(number, 2 * (levels - 1) * sides, 3), fans], axis=1
    )  # end by end
    return vertices.reshape(-1, 3), closing.reshape(-1, 3)


def _larger(base: Floats, around: Floats, tip: Floats, wanted: Floats) -> Floats:
    """Return by how much ends of flat faces are larger than spheres of the same volume, (e,).

    Parameters
    ----------
    base : (e, s, 3) last ring of the strut, relative to its node, mm
    around : (e, l, s, 3) rings on the sphere
    tip : (e, 3) its pole
    wanted : (e,) mm³
    """
    pole = np.broadcast_to(tip[:, None], base.shape)
    beyond = np.concatenate([around, pole[:, None]], axis=1)
    found = np.ones(len(wanted))
    for _ in range(ROUNDS):
        stack = np.concatenate([base[:, None], found[:, None, None, None] * beyond], axis=1)
        # Rings run clockwise about the outward axis. Volumes grow with the size, or its cube.
        found = found * np.sqrt(wanted / -triangle_volumes(stack[:, None]))
    return np.minimum(found, 1.0 + polygon_slack(base.shape[1]))
