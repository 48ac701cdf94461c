"""FieldStruts: round struts and balls whose filleted union a field solid is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Points, as_floats, as_points
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError

DEFAULT_BLEND = 0.3
"""Fillet radius where none is given, as a part of the smaller radius of the strut."""

LEAST_BLEND = 1e-3
"""Least fillet radius, as a part of the strut's smaller radius: 0 is sharp but for this."""

RIM = 0.5
"""Size of cells at the rim of a flat end, as a part of that elsewhere."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class FieldStruts(Frozen):
    """Struts (cones and cylinders) and balls, as arrays; made by `field_struts`."""

    ends: Floats
    """Both ends of each strut's axis, shape (m, 2, 3), mm; a ball has both at its center."""
    radii: Floats
    """Radius at both ends, shape (m, 2), mm; in between it is linear along the axis."""
    flat: Bools
    """Whether the strut ends in a flat disc there, shape (m, 2); otherwise it is round."""
    blend: Floats
    """Fillet radius of each strut, shape (m,), mm, > 0."""

    def __str__(self) -> str:
        size = size_text(self.ends.reshape(-1, 3))
        struts = counted(len(self.ends), "strut")
        return f"FieldStruts: {struts}, {size}, {radii_text(self.radii)}"

    @property
    def lengths(self) -> Floats:
        """Length of each axis, shape (m,), mm."""
        return length(self.ends[:, 1] - self.ends[:, 0])

    @property
    def middles(self) -> Points:
        """Middle of each axis, shape (m, 3), mm."""
        middles: Points = self.ends.mean(axis=1)
        return middles

    @property
    def fineness(self) -> Floats:
        """Size of cells at each end, as a part of that elsewhere, shape (m, 2)."""
        return np.where(self.flat, RIM, 1.0)

    def chosen(self, keep: Bools) -> FieldStruts:
        """Return some of them."""
        return FieldStruts(self.ends[keep], self.radii[keep], self.flat[keep], self.blend[keep])

    def scaled(self, factor: float) -> FieldStruts:
        """Return the struts with all lengths multiplied."""
        return FieldStruts(factor * self.ends, factor * self.radii, self.flat, factor * self.blend)

    def box(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner of all struts with their fillets, two (3,), mm."""
        reach = self.radii[:, :, None] + self.blend[:, None, None]
        low, high = self.ends - reach, self.ends + reach
        return low.min(axis=(0, 1)), high.max(axis=(0, 1))


@checks_keywords()
def field_struts(
    ends: ArrayLike,
    radii: ArrayLike,
    *,
    flat: ArrayLike = False,
    balls: ArrayLike | None = None,
    ball_radii: ArrayLike = 0.0,
    blend: ArrayLike | None = None,
    ball_blend: ArrayLike | None = None,
) -> FieldStruts:
    """Return struts and balls as one set, checked.

    Parameters
    ----------
    ends : (m, 2, 3), mm
        Both ends of each strut's axis.
    radii : (m, 2), (m,) or a number, mm
        Radius of each strut at both ends.
    flat : (m, 2) bool or a truth value
        Whether a strut ends there in a flat disc across its axis; otherwise in a ball tangent to
        its side.
    balls : (n, 3), mm
        Centers of balls.
    ball_radii : (n,) or a number, mm
    blend, ball_blend : (m,), (n,) or a number, mm
        Fillet radius; by default `DEFAULT_BLEND` of the smaller radius. 0 is sharp.

    Raises
    ------
    OptionError
        If there is nothing, or a shape is wrong, or a number is not finite, or a radius is not
        > 0; the strut is named.

    Examples
    --------
    >>> field_struts([[[0, 0, 0], [10, 0, 0]]], 1.0).blend.tolist()
    [0.3]
    """
    axes = as_floats(ends, "ends", OptionError)
    axes = axes.reshape(0, 2, 3) if axes.size == 0 else axes
    if axes.ndim != 3 or axes.shape[1:] != (2, 3) or not np.isfinite(axes).all():
        raise OptionError(f"ends has shape {axes.shape}; need (m, 2, 3), all finite")
    count = len(axes)
    both = as_floats(radii, "radii", OptionError)
    both = _spread(both[:, None] if both.ndim == 1 else both, (count, 2), "radii")
    discs = _spread(np.asarray(flat, dtype=np.bool_), (count, 2), "flat")
    centers = as_points([] if balls is None else balls, "balls", OptionError)
    sizes = _spread(as_floats(ball_radii, "ball_radii", OptionError), (len(centers),), "ball_radii")
    if count + len(centers) == 0:
        raise OptionError("there are no struts and no balls; need at least one")
    everything = np.concatenate([both, np.stack([sizes, sizes], axis=1)])
    _check_positive(everything, "radius", "> 0")
    fillets = np.concatenate(
        [_blends(blend, both, "blend"), _blends(ball_blend, everything[count:], "ball_blend")]
    )
    return FieldStruts(
        ends=np.concatenate([axes, np.stack([centers, centers], axis=1)]),
        radii=everything,
        flat=np.concatenate([discs, np.zeros((len(centers), 2), dtype=np.bool_)]),
        blend=fillets,
    )


def _blends(blend: ArrayLike | None, radii: Floats, name: str) -> Floats:
    """Return the fillet radius of each strut, shape (m,), mm."""
    least = radii.min(axis=1, initial=np.inf)
    if blend is None:
        return np.asarray(DEFAULT_BLEND * least)
    given = _spread(as_floats(blend, name, OptionError), least.shape, name)
    bad = np.flatnonzero(~(np.isfinite(given) & (given >= 0)))
    if len(bad):
        raise OptionError(f"{name} of strut {bad[0]} is {given[bad[0]]:g} mm; need >= 0")
    return np.asarray(np.maximum(given, LEAST_BLEND * least))


def _spread(values: np.ndarray, shape: tuple[int, ...], name: str) -> np.ndarray:
    try:
        return np.array(np.broadcast_to(values, shape))
    except ValueError:
        raise OptionError(f"{name} has shape {values.shape}; need {shape}") from None


def _check_positive(values: Floats, what: str, need: str) -> None:
    bad = np.argwhere(~(np.isfinite(values) & (values > 0)))
    if len(bad):
        strut = bad[0, 0]
        raise OptionError(f"strut {strut} has {what} {values[tuple(bad[0])]:g} mm; need {need}")
