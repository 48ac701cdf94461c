"""ConvolutionField: a smooth function around a skeleton that is 1 on its convolution surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_real, check_choice, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors, as_points
from scaffold_cad.base.summaries import counted, range_text
from scaffold_cad.base.vectors import dot
from scaffold_cad.convolution.kernels import Cauchy, CompactCubic, Kernel, Pairs, tip_reach
from scaffold_cad.convolution.nearby import all_pairs, nearby_pairs
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton, check_skeleton

KernelName: TypeAlias = Literal["compact-cubic", "cauchy"]
"""What is integrated along the edges, see `ConvolutionField`."""

WIDTHS: dict[str, float] = {"compact-cubic": 2.0, "cauchy": 0.5}
"""Width of each kernel unless another is asked for, in radii."""

WIDTH_RANGES: dict[str, tuple[float, float]] = {
    "compact-cubic": (1.0, 100.0),
    "cauchy": (0.0, 50.0),
}
"""What the width of each kernel is more than, and the widest: there the edges of extremities go on
for a hundred radii and more."""


@dataclass(frozen=True, eq=False)
class FieldSamples(Frozen):
    """The field at some points."""

    values: Floats
    """Value at each point, shape (n,), without unit."""
    gradients: Floats
    """Gradient at each point, shape (n, 3), 1/mm."""

    def __str__(self) -> str:
        values = range_text(self.values, "") if len(self.values) else "none"
        return f"FieldSamples: at {counted(len(self.values), 'point')}, values {values}".rstrip()


@dataclass(frozen=True, eq=False)
class Axes(Frozen):
    """The straight lines with radii that a kernel is integrated along."""

    starts: Points
    """Start of each, shape (m, 3), mm."""
    directions: UnitVectors
    """Direction of each, shape (m, 3)."""
    lengths: Floats
    """Length of each, shape (m,), mm."""
    radii: Floats
    """Radius at both ends of each, linear between them, shape (m, 2), mm."""

    @property
    def ends(self) -> Points:
        """End of each, shape (m, 3), mm."""
        return self.starts + self.lengths[:, None] * self.directions


@checks_keywords()
@dataclass(frozen=True, eq=False)
class ConvolutionField:
    """The convolution field of a skeleton: the sum over its edges of a kernel's integrals.

    It is 1 on the convolution surface, more inside and less outside. Around a straight edge of
    constant radius, far from its ends, that surface is exactly the edge's cylinder. Scaled, moved
    or turned skeletons have surfaces scaled, moved or turned, and an edge may be cut in two.

    Radii are the struts' `edge_radii`; a node that is a ball has no part in it. At extremities the
    edge goes on, with its radius there, so far that the surface of a long strut ends one radius
    beyond the node.

    Where the radius changes by 0.1 mm per mm the surface is 1 % outside the radii, by 0.2 it is
    4 %, and where an edge grows so fast that its thick end's kernel reaches its thin end, it is the
    surface of the thick end. At branch points the fields of the edges add up to a blend; that of
    the compact kernel never reaches farther than `width` radii.

    Raises
    ------
    SkeletonError
        If `check_skeleton` refuses the skeleton.
    OptionError
        If `kernel` has an unknown value or `width` is out of its range.

    References
    ----------
    Hubert, Cani, Convolution surfaces based on polygonal curve skeletons, JSC 47(6), 2012.
    Zanni, Bernhardt, Quiblier, Cani, SCALe-invariant integral surfaces, Computer Graphics Forum
    32(8), 2013.

    Examples
    --------
    >>> from scaffold_cad import ConvolutionField, Skeleton
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> field = ConvolutionField(strut)
    >>> field.value([[4.5, 1, 0]]).round(6)  # on the cylinder around the middle of the strut
    array([1.])
    """

    skeleton: Skeleton
    """The skeleton, as `check_skeleton` asks."""
    kernel: KernelName = "compact-cubic"
    """"compact-cubic" is 0 from `width` radii on: what is farther away has no influence, and many
    points are fast. "cauchy" falls to a quarter at `width` radii and never to 0: every edge has
    an influence everywhere, and time grows with edges times points."""
    width: float | None = None
    """Width of the kernel, in radii; by default 2 for "compact-cubic" and 0.5 for "cauchy". Wider
    ones blend more. For "compact-cubic" > 1 and at most 100, for "cauchy" > 0 and at most 50."""

    def __str__(self) -> str:
        return f"ConvolutionField: {self.kernel}, of {self.skeleton}"

    def __post_init__(self) -> None:
        check_skeleton(self.skeleton)
        check_choice(self.kernel, "kernel", get_args(KernelName))
        least, most = WIDTH_RANGES[self.kernel]
        width = WIDTHS[self.kernel]
        if self.width is not None:
            width = as_real(self.width, f"width of the {self.kernel} kernel")
        if not least < width <= most:
            raise OptionError(
                f"width of the {self.kernel} kernel is {width:g}; "
                f"need > {least:g} and at most {most:g} radii"
            )
        object.__setattr__(self, "width", width)

    @cached_property
    def integrand(self) -> Kernel:
        """The kernel with its width."""
        assert self.width is not None  # __post_init__ put the default
        return CompactCubic(self.width) if self.kernel == "compact-cubic" else Cauchy(self.width)

    @cached_property
    def axes(self) -> Axes:
        """The edges of the skeleton, and then what goes on from each extremity."""
        skeleton = self.skeleton
        ends, leaving = skeleton.extremities, skeleton.leaving_extremities
        at_ends = skeleton.edge_radii.reshape(-1)[leaving]
        tips = at_ends * (1 - tip_reach(self.integrand))
        return Axes(
            starts=skeleton.nodes[np.concatenate([skeleton.edges[:, 0], ends])],
            directions=np.concatenate([skeleton.directions[::2], -skeleton.directions[leaving]]),
            lengths=np.concatenate([skeleton.lengths, tips]),
            radii=np.concatenate([skeleton.edge_radii, np.stack([at_ends, at_ends], axis=1)]),
        )

    def value(self, points: ArrayLike) -> Floats:
        """Return the field at `points` (n, 3), shape (n,)."""
        places = as_points(points, "points", OptionError)
        total = np.zeros(len(places))
        for rows, edges in self._pairs(places):
            pairs, _ = self._seen(places, rows, edges)
            _add(total, rows, self.integrand.over(pairs).values())
        return total

    def gradient(self, points: ArrayLike) -> Floats:
        """Return the gradient of the field at `points` (n, 3), shape (n, 3), 1/mm."""
        return self.samples(points).gradients

    def samples(self, points: ArrayLike) -> FieldSamples:
        """Return the field and its gradient at `points` (n, 3)."""
        places = as_points(points, "points", OptionError)
        values, gradients = np.zeros(len(places)), np.zeros((3, len(places)))
        for rows, edges in self._pairs(places):
            pairs, offsets = self._seen(places, rows, edges)
            integrals = self.integrand.over(pairs)
            slopes = integrals.slopes()
            _add(values, rows, integrals.values())
            for axis in range(3):
                direction = self.axes.directions[edges, axis]
                slope = slopes.along * direction + slopes.off * offsets[..., axis]
                _add(gradients[axis], rows, slope)
        return FieldSamples(values, np.ascontiguousarray(gradients.T))

    def _pairs(self, points: Points) -> Iterator[tuple[Ints, Ints]]:
        """Yield pairs of a point and an edge that may have an influence there, to broadcast."""
        axes, support = self.axes, self.integrand.support
        if len(points) == 0:
            return iter(())
        if np.isinf(support):
            return all_pairs(len(points), len(axes.lengths))
        return nearby_pairs(points, axes.starts, axes.ends, support * axes.radii.max(axis=1))

    def _seen(self, points: Points, rows: Ints, edges: Ints) -> tuple[Pairs, Floats]:
        """Return how each point lies to each edge, and its offset from the edge's line."""
        axes = self.axes
        directions = axes.directions[edges]
        offsets = points[rows] - axes.starts[edges]
        along = dot(offsets, directions)
        offsets -= along[..., None] * directions
        radii = axes.radii[edges]
        pairs = Pairs(
            along, dot(offsets, offsets), axes.lengths[edges], radii[..., 0], radii[..., 1]
        )
        return pairs, offsets


def _add(total: Floats, rows: Ints, parts: Floats) -> None:
    """Add `parts` to the entries `rows` of `total` (n,)."""
    np.add.at(total, np.broadcast_to(rows, parts.shape).reshape(-1), parts.reshape(-1))
