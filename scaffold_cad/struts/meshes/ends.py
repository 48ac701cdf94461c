"""Ends of round struts as triangles: plane discs, hemispheres and balls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.struts.meshes.bands import polygon_slack
from scaffold_cad.struts.meshes.volumes import triangle_volumes
from scaffold_cad.struts.model import RoundStruts

ROUNDS = 12
"""Times that the volume of round ends is looked at."""


Closing = Callable[[RoundStruts, Ints, Ints, Points, int], tuple[Points, Triangles]]
"""Returns vertices and triangles that close ends, see `flat_ends`."""


def closings(struts: RoundStruts, ends: Ints) -> list[tuple[Closing, Ints]]:
    """Return what closes ends (e,), and which of them."""
    is_ball = struts.at_balls[ends]
    plain: Closing = flat_ends if struts.options.ends == "flat" else round_ends
    balls: Closing = partial(round_ends, quarters=2)
    found = [(plain, ends[~is_ball]), (balls, ends[is_ball])]
    return [(make, some) for make, some in found if len(some)]


def flat_ends(
    struts: RoundStruts, ends: Ints, rings: Ints, points: Points, count: int
) -> tuple[Points, Triangles]:
    """Return the middles of discs and the triangles around them.

    Parameters
    ----------
    ends : (e,) half-runs that leave the nodes where struts end
    rings : (e, s) vertices of the rings, counter-clockwise about the half-runs
    points : (e, s, 3) their positions, mm
    count : vertices so far
    """
    del points
    runs = struts.runs
    middle = count + np.arange(len(ends))
    triangles = np.stack(
        [np.roll(rings, -1, axis=1), rings, np.broadcast_to(middle[:, None], rings.shape)], axis=-1
    )
    return runs.nodes[runs.tails[ends]], triangles.reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class EndSpheres(Frozen):
    """Spheres that go on from the last circles of struts."""

    center: Floats
    """Distance of each center from the node, outward, shape (e,), mm."""
    size: Floats
    """Radius, shape (e,), mm."""
    start: Floats
    """Latitude of the last circle, shape (e,), rad."""
    radius: Floats
    """Radius of the last circle, shape (e,), mm."""


def end_spheres(struts: RoundStruts, ends: Ints) -> EndSpheres:
    """Return the spheres of half-runs (e,) at ends that are round or balls.

    Round ends touch their strut along its last circle; balls are around their node.
    """
    runs, is_ball, collar = struts.runs, struts.at_balls[ends], struts.collar[ends]
    slope = -runs.slopes[ends]  # growth outward
    radius = runs.radii_at(ends, collar)
    center, size = np.where(is_ball, 0.0, radius * slope), radius * np.hypot(1.0, slope)
    size[is_ball] = struts.skeleton.radii[runs.tails[ends[is_ball]]]
    return EndSpheres(center, size, np.arctan2(-(collar + center), radius), radius)


def round_ends(
    struts: RoundStruts, ends: Ints, rings: Ints, points: Points, count: int, quarters: int = 1
) -> tuple[Points, Triangles]:
    """Return the vertices and triangles of the spheres in which struts end.

    A cylinder ends in a hemisphere; a cone in the part of the sphere that touches it along its
    last circle; both in the ball of their node where this is thicker. The other parameters are
    those of `flat_ends`.

    Parameters
    ----------
    quarters : of a turn that spheres reach over from their ring to their pole, about
    """
    runs = struts.runs
    number, sides = rings.shape
    sphere = end_spheres(struts, ends)
    center, size, radius = sphere.center, sphere.size, sphere.radius
    levels = quarters * max(1, sides // 4)
    share = np.arange(1, levels) / levels
    first = _first_latitudes(struts, ends, sphere)
    latitude = first[:, None] + share * (np.pi / 2 - first[:, None])  # (e, levels - 1)
    node = runs.nodes[runs.tails[ends]]
    outward = -runs.directions[ends]
    spoke = points - points.mean(axis=1, keepdims=True)  # (e, s, 3), as long as the ring is wide
    wide = size[:, None] * np.cos(latitude) / radius[:, None]
    high = center[:, None] + size[:, None] * np.sin(latitude)
    around = wide[..., None, None] * spoke[:, None]  # (e, levels - 1, s, 3)
    around = around + (high[..., None] * outward[:, None])[:, :, None]
    tip = (center + size)[:, None] * outward
    height = struts.collar[ends] + center + size
    wanted = np.pi / 3 * height**2 * (3 * size - height)
    larger = _larger(points - node[:, None], around, tip, wanted)
    inner = node[:, None, None] + larger[:, None, None, None] * around
    pole = node + larger[:, None] * tip
    block = (levels - 1) * sides + 1
    begin = count + block * np.arange(number)
    own = begin[:, None, None] + np.arange((levels - 1) * sides).reshape(levels - 1, sides)
    stack = np.concatenate([rings[:, None], own], axis=1)  # (e, levels, s)
    low, above = stack[:, :-1].reshape(-1, sides), stack[:, 1:].reshape(-1, sides)
    a, b, d, c = low, np.roll(low, -1, 1), above, np.roll(above, -1, 1)
    bands = np.stack([np.stack([b, a, d], -1), np.stack([b, d, c], -1)], axis=2)
    last = stack[:, -1]
    tip = np.broadcast_to((begin + block - 1)[:, None], last.shape)
    fans = np.stack([np.roll(last, -1, axis=1), last, tip], axis=-1)
    vertices = np.concatenate(
        [inner.reshape(number, (levels - 1) * sides, 3), pole[:, None]], axis=1
    )
    closing = np.concatenate(
        [bands.reshape(number, 2 * (levels - 1) * sides, 3), fans], axis=1
    )  # end by end
    return vertices.reshape(-1, 3), closing.reshape(-1, 3)


def _first_latitudes(struts: RoundStruts, ends: Ints, sphere: EndSpheres) -> Floats:
    """Return the latitude of the last circle of a strut, of what is inside the one outside, (e,).

    So the rings of balls inside are at the latitudes of those outside, a wall apart.
    """
    wall = struts.within
    outside = -np.arccos(np.clip((sphere.radius + wall) / (sphere.size + wall), -1.0, 1.0))
    inside = struts.at_balls[ends] & (wall > 0)
    return np.where(inside, outside, sphere.start)


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
    middle = np.broadcast_to(base.mean(axis=1, keepdims=True), base.shape)
    fixed = np.stack([middle, base], axis=1)  # the disc that ends the strut
    beyond = np.concatenate([around, pole[:, None]], axis=1)
    found = np.ones(len(wanted))
    for _ in range(ROUNDS):
        stack = np.concatenate([fixed, found[:, None, None, None] * beyond], axis=1)
        # Rings run clockwise about the outward axis. Volumes grow with the size, or its cube.
        found = found * np.sqrt(wanted / -triangle_volumes(stack[:, None]))
    return np.minimum(found, 1.0 + polygon_slack(base.shape[1]))
