"""Holes in the skin of a filled part, for powder and resin to get out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Floats, Points, UnitVectors, as_points, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import any_perpendicular, length
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.nearest import NearestPlace
from scaffold_cad.mesh.remeshing import evened, split_to
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid import manifolds

if TYPE_CHECKING:
    from manifold3d import Manifold

SIDES = 24
"""Sides of a hole, whose polygon has the area of its circle."""

RIM_SIDES = 8
"""Places of a hole's rim that are held against the surface."""

FLAT = 1 / 8
"""How far the rim of a hole that is chosen may be off the surface, in diameters."""

BEYOND = 0.35
"""How far beyond the inside of the skin a hole goes, in thicknesses of it."""

ON_WALL = 1.05
"""Distance from the outside up to which a place is on the inside of the skin, in thicknesses."""

MOST_SQUARES = 30_000
"""Most squares, with sides of the distance between places that are looked at, that cover a void."""

MOST_PLACES = 8_000
"""Most places of a void whose rims are looked at."""

BANDS = ((0.0, 0.35), (0.65, 1.0))
"""Heights of a void, from 0 to 1, in which its two holes are: what gets out below lets air in."""


def drained(
    part: Manifold,
    surface: TriangleMesh,
    skin: float,
    diameter: float,
    places: ArrayLike | None = None,
) -> Manifold:
    """Return a part with holes through its skin, so that no void is closed.

    Parameters
    ----------
    part : whose skin is closed
    surface : of the body
    skin : its thickness, mm
    diameter : of the holes, mm
    places : on the surface, or no farther from it than `diameter` and `skin`, (k, 3), mm; by
        default two for each void, low and high, where the struts leave most room

    Raises
    ------
    OptionError
        If the diameter is not > 0, places are not positions near the surface, or the surface has
        no room for a hole there; the place is named.
    MeshError
        If a void stays closed; the place is named.
    """
    wide = as_number(diameter, "drain")
    outside = NearestPlace(evened(surface))
    if places is None:
        found = [_chosen(void, outside, skin, wide) for void in _voids(part)]
        points = np.concatenate(found) if found else np.zeros((0, 3))
    else:
        points = as_points(places, "places of drain holes", OptionError)
    feet, normals = outside.with_normals(points) if len(points) else (points, points)
    _check_room(points, feet, normals, outside, skin, wide)
    for foot, normal in zip(feet, normals, strict=True):
        part = part - _hole(foot, normal, skin, wide)
    closed = _voids(part)
    if closed:
        place = place_text(closed[0].vertices.mean(axis=0))
        raise MeshError(
            f"{counted(len(closed), 'void stays', 'voids stay')} closed, one around {place}"
            "; need a hole there "
            "(more places, or a larger diameter)"
        )
    return part


def _voids(part: Manifold) -> list[TriangleMesh]:
    """Return the surfaces of closed voids, largest first."""
    shells = [shell for shell in part.decompose() if shell.volume() < 0]
    shells.sort(key=lambda shell: shell.volume())
    return [manifolds.manifold_triangles(shell) for shell in shells]


def _chosen(void: TriangleMesh, outside: NearestPlace, skin: float, diameter: float) -> Points:
    """Return places for the holes of a void, on the inside of the skin, (k, 3)."""
    # Thin holes need no more places than others, of which there would be no end.
    fine = split_to(void, max(diameter, np.sqrt(_area(void) / MOST_SQUARES)))
    points = fine.vertices[fine.triangles].mean(axis=1)
    gaps = length(outside.nearest(points) - points)
    wall = gaps < ON_WALL * skin
    if not wall.any():
        place = place_text(points.mean(axis=0))
        raise MeshError(f"the void around {place} does not reach the skin; need a place for it")
    candidates = points[wall]
    candidates = candidates[:: -(-len(candidates) // MOST_PLACES)]
    room = np.full(len(candidates), np.inf)
    if not wall.all():
        room = np.asarray(cKDTree(points[~wall]).query(candidates)[0])
    # A hole keeps a skin's thickness from edges: first those on flat places, then by their room.
    off = _off_surface(*outside.with_normals(candidates), outside, diameter / 2 + skin)
    room = np.where(off <= FLAT * diameter, room, -off)
    height = candidates[:, 2] - candidates[:, 2].min()
    share = height / max(float(height.max()), 1e-12)
    chosen = []
    for low, high in BANDS:
        off_band = np.maximum(np.maximum(low - share, share - high), 0.0)
        band = np.flatnonzero(off_band == off_band.min())  # the nearest ones where it has none
        chosen.append(int(band[np.argmax(room[band])]))
    places: Points = candidates[sorted(set(chosen))]
    return places


def _area(mesh: TriangleMesh) -> float:
    corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
    return float(length(np.cross(*np.diff(corners, axis=1).swapaxes(0, 1))).sum() / 2)


def _check_room(
    points: Points,
    feet: Points,
    normals: UnitVectors,
    outside: NearestPlace,
    skin: float,
    diameter: float,
) -> None:
    """Raise an `OptionError` for a place far from the surface, or where it has no room."""
    gaps = length(feet - points)
    reach = diameter + skin  # places that are chosen are inside the skin
    far = np.flatnonzero(gaps > reach)
    if len(far):
        place, gap = place_text(points[far[0]]), gaps[far[0]]
        raise OptionError(
            f"the place {place} of a drain hole is {gap:.3g} mm from the surface; "
            f"need {reach:g} mm or less"
        )
    off = _off_surface(feet, normals, outside, diameter / 2)
    past = np.flatnonzero(off > skin)  # through the wall beside it, from end to end
    if len(past):
        raise OptionError(
            f"a drain hole of {diameter:g} mm at {place_text(feet[past[0]])} goes "
            f"{off[past[0]]:.3g} mm past the surface; need a smaller one, or a place that is wider"
        )


def _off_surface(
    feet: Points, normals: UnitVectors, outside: NearestPlace, radius: float
) -> Floats:
    """Return how far a circle around each foot (n, 3) on a surface comes off it, shape (n,), mm."""
    x = any_perpendicular(normals)
    angles = 2 * np.pi * np.arange(RIM_SIDES) / RIM_SIDES
    across = np.cos(angles)[:, None, None] * x + np.sin(angles)[:, None, None] * np.cross(
        normals, x
    )
    rim = (feet + radius * across).reshape(-1, 3)  # (sides * n, 3)
    gaps: Floats = length(outside.nearest(rim) - rim).reshape(RIM_SIDES, -1).max(axis=0)
    return gaps


def _hole(foot: Points, normal: UnitVectors, skin: float, diameter: float) -> Manifold:
    """Return a cylinder through the skin at a place of the surface."""
    import manifold3d

    inward = (1 + BEYOND) * skin + diameter / 4
    outward = skin / 2 + diameter / 2
    turn = 2 * np.pi / SIDES
    radius = diameter / 2 * np.sqrt(turn / np.sin(turn))
    rod = manifold3d.Manifold.cylinder(inward + outward, radius, circular_segments=SIDES)
    x = any_perpendicular(normal[None])[0]
    frame = np.stack([x, np.cross(normal, x), normal, foot - inward * normal], axis=1)  # (3, 4)
    return rod.transform(frame)
