"""How patches are cut into polynomial pieces and sampled, and which of their points are which."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.struts.blending.splines import Spline, spline


@dataclass(frozen=True)
class Layout:
    """How patches are cut into polynomial pieces, and how they are sampled."""

    along_arc: int
    """Pieces in the direction of u."""
    along_strut: int
    """Pieces in the direction of v."""
    samples: int
    """Samples of each piece in either direction, at the nodes of Gauss and Legendre."""

    def at_least(self, other: Layout) -> Layout:
        """Return this one with as many pieces as another where that has more."""
        along_arc = max(self.along_arc, other.along_arc)
        return Layout(along_arc, max(self.along_strut, other.along_strut), self.samples)

    @property
    def pieces(self) -> tuple[int, int]:
        """Pieces in both directions: blends that agree in them go together."""
        return self.along_arc, self.along_strut

    @property
    def u(self) -> Spline:
        """The splines in u."""
        return spline(self.along_arc)

    @property
    def v(self) -> Spline:
        """The splines in v."""
        return spline(self.along_strut)

    @property
    def at(self) -> Floats:
        """Parameters of the samples in a piece, shape (samples,)."""
        return np.asarray((np.polynomial.legendre.leggauss(self.samples)[0] + 1) / 2)

    @property
    def at_u(self) -> Floats:
        """Parameters of all samples in u, shape (samples of all pieces,)."""
        return _spread(self.at, self.along_arc)

    @property
    def at_v(self) -> Floats:
        """Parameters of all samples in v, shape (samples of all pieces,)."""
        return _spread(self.at, self.along_strut)

    @property
    def weights(self) -> Floats:
        """Weight of each sample of a patch in the integral over it, in the order of (u, v)."""
        one = np.polynomial.legendre.leggauss(self.samples)[1] / 2
        wide = np.tile(one / self.along_arc, self.along_arc)
        high = np.tile(one / self.along_strut, self.along_strut)
        return np.asarray(np.outer(wide, high).reshape(-1))

    @property
    def sampled(self) -> Floats:
        """What takes control points of a patch to its samples, (samples, n_u n_v)."""
        return np.asarray(np.kron(self.u.values(self.at), self.v.values(self.at)))

    @property
    def thin_plate(self) -> Floats:
        """The matrix of the thin-plate energy of a patch, (n_u n_v, n_u n_v)."""
        u, v = ([each.products(order) for order in range(3)] for each in (self.u, self.v))
        return np.asarray(np.kron(u[2], v[0]) + 2 * np.kron(u[1], v[1]) + np.kron(u[0], v[2]))

    @property
    def given(self) -> Ints:
        """The points of a patch in the two rows next to the collar, in the order of (u, v)."""
        return np.flatnonzero(self._v >= self.v.count - 2)

    @property
    def rim(self) -> Ints:
        """The other points in the two rows next to the arc or a spoke: what joins depend on."""
        return np.flatnonzero((self._v < self.v.count - 2) & self._is_outer)

    @property
    def core(self) -> Ints:
        """All other points of a patch: no join depends on them."""
        return np.flatnonzero((self._v < self.v.count - 2) & ~self._is_outer)

    @property
    def _v(self) -> Ints:
        return np.tile(np.arange(self.v.count), (self.u.count, 1))

    @property
    def _is_outer(self) -> Bools:
        u = np.arange(self.u.count)[:, None]
        return np.asarray((u < 2) | (u >= self.u.count - 2) | (self._v < 2))


def _spread(at: Floats, pieces: int) -> Floats:
    return np.asarray(((at + np.arange(pieces)[:, None]) / pieces).reshape(-1))
