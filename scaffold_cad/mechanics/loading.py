"""Supports and loads: what holds a skeleton, and what pulls at it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import (
    as_flag,
    as_vector,
    check_choice,
    check_kind,
    checks_keywords,
    did_you_mean,
)
from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, as_chosen, as_floats, read_only
from scaffold_cad.base.placements import PositionLike
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton

Where: TypeAlias = ArrayLike | Callable[[Points], ArrayLike]
"""Nodes by number, by mark, or a function of positions (n, 3) that marks them."""

FREEDOMS = ("x", "y", "z", "rx", "ry", "rz")
"""The six freedoms of a node: displacements along and rotations about the axes."""

_Item = TypeVar("_Item")

LARGEST_FORCE = 1e15
"""Largest force, N, or moment, N mm, that is believed."""

RANK_TOLERANCE = 1e-9
"""Least singular value of a body's supports over the largest; no unit."""


@checks_keywords()
@dataclass(frozen=True)
class Between:
    """Marks the nodes between two places along an axis: a `where` that other processes know too.

    Examples
    --------
    >>> foot = Support(Between("z", high=0.5))
    >>> deck = Load(Between("z", low=19.5), force=(0, 0, -300))
    >>> Between("x", 1.0, 2.0)(np.array([[0.5, 0, 0], [1.5, 0, 0]])).tolist()
    [False, True]
    """

    axis: str
    """x, y or z."""
    low: float = -np.inf
    """Lowest coordinate, mm."""
    high: float = np.inf
    """Highest coordinate, mm."""

    def __post_init__(self) -> None:
        check_choice(self.axis, "axis", ("x", "y", "z"))

    def __call__(self, nodes: Points) -> Bools:
        """Return which of positions (n, 3) are between, (n,)."""
        places = nodes[:, "xyz".index(self.axis)]
        return np.asarray((places >= self.low) & (places <= self.high))


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Support:
    """Nodes whose freedoms are held, or moved by a given amount.

    Examples
    --------
    >>> foot = Support(lambda nodes: nodes[:, 2] < 0.1)  # clamped
    >>> slide = Support([3, 4], "z")
    >>> press = Support([7], "z", displacement=-0.2)
    """

    where: Where
    """The nodes."""
    fixed: str = "all"
    """Which freedoms: "all" (clamped), "pinned" (x y z), or names such as "x z ry"."""
    displacement: ArrayLike = 0.0
    """Where they are moved to, mm and rad: one number, or one per freedom in `fixed`."""

    def __post_init__(self) -> None:
        _freedoms(self.fixed)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Load:
    """A force and a moment on nodes.

    Examples
    --------
    >>> tip = Load([12], force=(0, 0, -100))
    >>> deck = Load(lambda nodes: nodes[:, 2] > 49, force=(0, 0, -2000))  # shared evenly
    """

    where: Where
    """The nodes."""
    force: PositionLike = (0.0, 0.0, 0.0)
    """N, shape (3,)."""
    moment: PositionLike = (0.0, 0.0, 0.0)
    """N mm, shape (3,)."""
    each: bool = False
    """Whether every node gets it; otherwise they share it evenly."""


@dataclass(frozen=True, eq=False)
class Held:
    """Which freedoms of all nodes are held and where they are moved to."""

    fixed: Bools
    """Shape (n, 6)."""
    displacement: Floats
    """0 where nothing is held, mm and rad, shape (n, 6)."""


def held(skeleton: Skeleton, supports: Support | Iterable[Support]) -> Held:
    """Return what `supports` hold.

    Raises
    ------
    OptionError
        If one names no node or an unknown freedom.
    """
    fixed = np.zeros((len(skeleton.nodes), 6), dtype=np.bool_)
    moved = np.zeros((len(skeleton.nodes), 6))
    for number, support in enumerate(_listed(supports, Support)):
        nodes = chosen_nodes(skeleton, support.where, f"support {number}")
        columns = _freedoms(support.fixed)
        values = as_floats(support.displacement, "displacement", OptionError)
        if values.shape not in {(), (len(columns),)} or not np.isfinite(values).all():
            raise OptionError(
                f"displacement of support {number} is {values.tolist()}; need a finite number, "
                f"or {len(columns)}, one for each of {support.fixed!r}"
            )
        fixed[nodes[:, None], columns] = True
        moved[nodes[:, None], columns] = values
    return Held(read_only(fixed), read_only(moved))


def nodal_forces(skeleton: Skeleton, loads: Load | Iterable[Load]) -> Floats:
    """Return the force and moment on each node, (n, 6), N and N mm.

    Raises
    ------
    OptionError
        If one names no node or is not three finite numbers.
    """
    total = np.zeros((len(skeleton.nodes), 6))
    for number, load in enumerate(_listed(loads, Load)):
        nodes = chosen_nodes(skeleton, load.where, f"load {number}")
        total[nodes] += load_of(load, number, len(nodes))
    return total


def load_of(load: Load, number: int, count: int) -> Floats:
    """Return the force and moment (6,) on each of the `count` nodes of load `number`."""
    both = np.concatenate(
        [
            as_vector(value, f"{name} of load {number}", unit=unit, most=LARGEST_FORCE)
            for name, value, unit in (("force", load.force, " N"), ("moment", load.moment, " N mm"))
        ]
    )
    return both if as_flag(load.each, "each") else both / count


def chosen_nodes(skeleton: Skeleton, where: Where, what: str) -> Ints:
    """Return the nodes that `where` names, ascending, each once, (k,).

    Raises
    ------
    OptionError
        If no node is there; `what` is named.
    """
    given = where(skeleton.nodes) if callable(where) else where
    nodes = np.unique(as_chosen(np.atleast_1d(np.asarray(given)), what, len(skeleton.nodes)))
    if len(nodes) == 0:
        raise OptionError(f"{what} is on no node; need one or more")
    return nodes


def check_supported(skeleton: Skeleton, fixed: Bools) -> None:
    """Raise unless no part of the skeleton can move as a rigid body.

    All joints are rigid, so nothing else can be a mechanism.

    Raises
    ------
    OptionError
        If one can; the part and how it can move are named.
    """
    check_held(skeleton.nodes, skeleton.component_of_node, fixed)


def check_held(nodes: Points, label: Ints, fixed: Bools) -> None:
    """Raise unless no part can move as a rigid body, for the part of each node (n,)."""
    for part in np.unique(label).tolist():
        inside = np.flatnonzero(label == part)
        position = nodes[inside]
        modes = rigid_motions(position - position.mean(axis=0))  # (k, 6, 6)
        size = max(float(np.abs(position - position.mean(axis=0)).max()), 1e-300)
        modes[:, :3, 3:] /= size
        rows = modes[fixed[inside]]  # (held, 6)
        if len(rows) == 0:
            raise OptionError(
                f"the part of {counted(len(inside), 'node')} with node {inside[0]} has no support; "
                "need one that holds it"
            )
        _, values, axes = np.linalg.svd(rows, full_matrices=True)
        rank = int((values > RANK_TOLERANCE * values[0]).sum())
        if rank < 6:
            free = FREEDOMS[int(np.argmax(np.abs(axes[-1])))]
            raise OptionError(
                f"the part of {counted(len(inside), 'node')} with node {inside[0]} can still move "
                f"{_motion(free)}: its supports hold {rank} of 6 motions; need all 6"
            )


def rigid_motions(offsets: Points) -> Floats:
    """Return the freedoms of nodes at `offsets` in the six rigid motions, (n, 6, 6)."""
    out = np.zeros((len(offsets), 6, 6))
    diagonal = np.arange(6)
    out[:, diagonal, diagonal] = 1.0
    x, y, z = offsets.T
    out[:, 0, 4], out[:, 0, 5] = z, -y
    out[:, 1, 3], out[:, 1, 5] = -z, x
    out[:, 2, 3], out[:, 2, 4] = y, -x
    return out


def _motion(freedom: str) -> str:
    return f"about {freedom[1]}" if freedom.startswith("r") else f"along {freedom}"


def _freedoms(fixed: str) -> list[int]:
    check_kind(fixed, str, name="fixed")
    names = {"all": " ".join(FREEDOMS), "clamped": " ".join(FREEDOMS), "pinned": "x y z"}
    words = names.get(fixed.strip().lower(), fixed).replace(",", " ").split()
    unknown = [word for word in words if word not in FREEDOMS]
    if unknown or not words:
        hint = did_you_mean(fixed, names)
        raise OptionError(
            f"fixed is {fixed!r}; need all, pinned, or some of {' '.join(FREEDOMS)}{hint}"
        )
    return sorted({FREEDOMS.index(word) for word in words})


def _listed(items: object, kind: type[_Item]) -> list[_Item]:
    """Return one or several of a kind as a list."""
    found: list[Any] = list(items) if isinstance(items, Iterable) else [items]
    for item in found:
        check_kind(item, kind)
    return found
