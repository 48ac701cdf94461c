"""Points and normals on blends, on grids that neighbors share: what meshes are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Quads, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import OptionError
from scaffold_cad.struts.blending.blend import Blends
from scaffold_cad.struts.blending.joins import shared_numbers


@dataclass(frozen=True, eq=False)
class Samples(Frozen):
    """Points on U blends, each once: those on arcs and spokes belong to both patches."""

    points: Floats
    """Points relative to the node, mm, shape (U, p, 3)."""
    normals: UnitVectors
    """Unit normals, outwards, shape (U, p, 3)."""
    number: Ints
    """Point of each patch at each pair (u, v) of parameters, shape (U, 4 N, n_u, n_v).

    `number[:, 4 i + k, :, -1]` runs along quarter k of collar i, from its corner k.
    """

    @property
    def quads(self) -> Quads:
        """Quads between the points, counter-clockwise from outside, (U, 4 N (n-1)², 4)."""
        n = self.number
        corners = n[:, :, :-1, :-1], n[:, :, 1:, :-1], n[:, :, 1:, 1:], n[:, :, :-1, 1:]
        return np.stack(corners, axis=-1).reshape(len(n), -1, 4)


def sampled(blends: Blends, at_u: Floats, at_v: Floats) -> Samples:
    """Return the points and normals at all pairs of the parameters `at_u` and `at_v`.

    Parameters
    ----------
    blends : the blends
    at_u : (n_u,) float64, ascending from 0 to 1, symmetric: u and 1 − u are both there
    at_v : (n_v,) float64, ascending from 0 to 1

    Raises
    ------
    OptionError
        If the parameters do not run from 0 to 1, or `at_u` are not symmetric.

    Examples
    --------
    >>> import numpy as np
    >>> from scaffold_cad.partition import partition_spheres
    >>> from scaffold_cad.struts.blending.blend import Stars
    >>> from scaffold_cad.struts.blending.nodes import blends
    >>> tripod = partition_spheres(np.eye(3)[None])
    >>> (found,) = blends(Stars.of(tripod, radii=1.0, blends=0.5))
    >>> grid = np.linspace(0, 1, 5)
    >>> sampled(found, grid, grid).points.shape
    (1, 215, 3)
    """
    for name, at in (("at_u", at_u), ("at_v", at_v)):
        if len(at) < 2 or at[0] != 0 or at[-1] != 1 or (np.diff(at) <= 0).any():
            raise OptionError(f"{name} is {at.tolist()}; need ascending numbers from 0 to 1")
    if np.abs(at_u + at_u[::-1] - 1).max() > 1e-12:
        raise OptionError(f"at_u is {at_u.tolist()}; need both u and 1 - u")
    layout, control = blends.layout, blends.control
    values_u, values_v = layout.u.values_at(at_u), layout.v.values_at(at_v)
    patches = np.moveaxis(control, -1, 0)  # (3, U, 4 N, n_u, n_v)
    points = values_u @ patches @ values_v.T
    slope_u = layout.u.values_at(at_u, 1) @ patches @ values_v.T
    slope_v = values_u @ patches @ layout.v.values_at(at_v, 1).T
    normals = np.cross(slope_u, slope_v, axis=0)
    kinds, kind_of = np.unique(blends.twins, axis=0, return_inverse=True)
    numbered = [shared_numbers(twins, len(at_u), len(at_v)) for twins in kinds]
    number = np.stack([each for each, _ in numbered])[kind_of.reshape(-1)]
    count = numbered[0][1]
    return Samples(
        _shared(points, number, count), normalize(_shared(normals, number, count)), number
    )


def _shared(values: Floats, number: Ints, count: int) -> Floats:
    """Return one of the values (3, U, 4 N, n, n) of each number, shape (U, count, 3)."""
    found = np.empty((len(number), count, 3))
    row = np.arange(len(number))[:, None]
    flat = number.reshape(len(number), -1)
    found[row, flat] = np.moveaxis(values, 0, -1).reshape(len(number), -1, 3)
    return found
