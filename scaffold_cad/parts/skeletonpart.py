"""SkeletonPart: what the part objects of build123d have in common."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypedDict, cast

import numpy as np
from build123d import BasePartObject, Mode, Plane, RigidJoint, Shape

from scaffold_cad.base.arguments import as_flag, check_kind
from scaffold_cad.base.arrays import Floats
from scaffold_cad.filling.models import SectionOptions
from scaffold_cad.parts.booleans import Operation, check_boolean
from scaffold_cad.parts.placing import as_align, as_rotation
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.models import Model
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts

CHECKED_MODES: dict[Mode, Operation] = {
    Mode.ADD: "union",
    Mode.SUBTRACT: "difference",
    Mode.INTERSECT: "intersection",
}
"""Modes that are booleans of OCCT."""

VERTICAL = 1e-6
"""Sine of the angle to z below which a strut is vertical."""


class CommonOptions(TypedDict, total=False):
    """What every part object takes, as build123d's objects do, but for `align`."""

    overlaps: Overlaps
    """What becomes of struts that overlap, see `to_brep`; "refuse" by default."""
    with_joints: bool
    """Whether extremities get joints; they do by default, but for lattices."""
    label: str
    """Name of the part."""
    color: Any
    """Color of the part."""
    rotation: Any
    """Rotation about x, y and z, degrees, as of build123d's `Box`; none by default."""
    mode: Mode
    """How the part is combined with what is in the builder; `Mode.ADD` by default."""


class PartOptions(CommonOptions, total=False):
    """What the part objects around a given skeleton take beside their own parameters."""

    align: Any
    """Alignment with the box around the part, as of build123d's `Box`; by default (None) the origin
    of the skeleton stays where it is."""


class BoxOptions(CommonOptions, SectionOptions, total=False):
    """What boxes of lattice take beside their own parameters."""


class FrameOptions(PartOptions, SectionOptions, total=False):
    """What frames and filled parts take beside their own parameters."""


def part_options(options: Any) -> PartOptions:
    """Take those of every part out of `options`, and return them.

    Raises
    ------
    OptionError
        If one is of another kind than build123d takes.
    """
    taken = _taken(options, PartOptions)
    checks: dict[str, Callable[[Any], Any]] = {
        "rotation": as_rotation,
        "align": as_align,
        "mode": lambda mode: _of_kind(mode, Mode, "mode"),
        "label": lambda label: _of_kind(label, str, "label"),
        "with_joints": lambda flag: as_flag(flag, "with_joints"),
    }
    return cast("PartOptions", {name: checks.get(name, _as_is)(taken[name]) for name in taken})


def _of_kind(value: Any, kind: type, name: str) -> Any:
    check_kind(value, kind, name=name)
    return value


def _as_is(value: Any) -> Any:
    return value


def strut_options(options: Any) -> SectionOptions:
    """Take those of struts out of `options`, and return them."""
    return cast("SectionOptions", _taken(options, SectionOptions))


def _taken(options: dict[str, Any], kind: Any) -> dict[str, Any]:
    names = [name for name in options if name in kind.__annotations__]
    return {name: options.pop(name) for name in names}


class SkeletonPart(BasePartObject):  # type: ignore[misc]  # build123d is not checked
    """What the parts have in common: a skeleton, and a joint at each of its extremities.

    Booleans with them raise a BrepError where OCCT's result cannot be right, see `check_boolean`.
    """

    skeleton: Skeleton
    """The skeleton in its own coordinates, without the part's rotation, alignment and place."""

    def __init__(
        self,
        body: Shape | Model,
        model: Model,
        *,
        overlaps: Overlaps = "refuse",
        with_joints: bool = True,
        label: str = "",
        color: Any = None,
        rotation: Any = (0, 0, 0),
        align: Any = None,
        mode: Mode = Mode.ADD,
    ) -> None:
        if not isinstance(body, Shape):
            body = to_brep(body, overlaps=overlaps)
        if with_joints:
            add_joints(body, model)
        super().__init__(part=body, rotation=rotation, align=align, mode=mode)
        self.skeleton = model.skeleton
        self.label = label
        self.color = color

    def __add__(self, other: Any) -> Any:
        other = _kept(other)
        return _checked("union", [self, *_as_list(other)], super().__add__(other))

    def __sub__(self, other: Any) -> Any:
        other = _kept(other)
        return _checked("difference", [self, *_as_list(other)], super().__sub__(other))

    def __and__(self, other: Any) -> Any:
        other = _kept(other)
        return _checked("intersection", [self, *_as_list(other)], super().__and__(other))

    # Python asks these first where the left side is a Part or a Compound, as of a boolean.

    def __radd__(self, other: Any) -> Any:
        if not isinstance(other, Shape):
            return NotImplemented
        return _checked("union", [other, self], other.__add__(self))

    def __rsub__(self, other: Any) -> Any:
        if not isinstance(other, Shape):
            return NotImplemented
        return _checked("difference", [other, self], other.__sub__(self))

    def __rand__(self, other: Any) -> Any:
        if not isinstance(other, Shape):
            return NotImplemented
        return _checked("intersection", [other, self], other.__and__(self))

    def _publish_to_context(self, object_scope: Any) -> None:
        """Give the part to the builder that is open, as build123d does, and check what it makes.

        build123d has no public place for that.
        """
        builder = object_scope.publication_target
        before = None if builder is None else builder.part
        super()._publish_to_context(object_scope)
        if builder is None or self.mode not in CHECKED_MODES:
            return
        operands = [self] if before is None else [before, self]
        _checked(CHECKED_MODES[self.mode], operands, builder.part)


def _kept(other: Any) -> Any:
    """Return what stands on the right of an operator so that it can be looked at twice."""
    return list(other) if isinstance(other, Iterator) else other


def _as_list(other: Any) -> list[Any]:
    """Return what stands on the right of an operator as a list, without what is None."""
    return [
        one for one in (other if isinstance(other, list | tuple) else [other]) if one is not None
    ]


def _checked(operation: Operation, operands: Sequence[Any], result: Any) -> Any:
    """Return the result of a boolean if nothing speaks against it."""
    is_boolean = len(operands) > 1 or len(operands[0].solids()) > 1
    if is_boolean and all(isinstance(one, Shape) for one in operands):
        check_boolean(operation, operands, result)
    return result


def add_joints(body: Shape, model: Model) -> None:
    """Give `body` a rigid joint at each extremity: z outwards.

    x points to the middle of a side of a square section; of a round one it is level, with y
    upwards, and that of the skeleton where the strut is vertical.
    """
    for node, outward, x in _ends(model):
        place = model.skeleton.nodes[node]
        plane = Plane(tuple(place), x_dir=tuple(x), z_dir=tuple(outward))
        RigidJoint(f"extremity {node}", body, plane.location)


def _ends(model: Model) -> Iterator[tuple[int, Floats, Floats]]:
    """Yield each extremity, the direction out of its strut, and x across it."""
    if isinstance(model, RoundStruts):
        runs = model.runs
        for half_run in np.flatnonzero(runs.valency[runs.tails] == 1).tolist():
            outward = -runs.directions[half_run]
            level = np.array([-outward[1], outward[0], 0.0])
            x = level if np.hypot(*level[:2]) > VERTICAL else np.array([1.0, 0.0, 0.0])
            yield int(runs.tails[half_run]), outward, x
        return
    skeleton = model.refined  # its extremities are those of the skeleton
    ends = zip(skeleton.extremities.tolist(), skeleton.leaving_extremities.tolist(), strict=True)
    for node, half_edge in ends:
        section = model.mesh.vertices[model.sleeves[half_edge >> 1, half_edge & 1]]
        yield node, -skeleton.directions[half_edge], section[:2].mean(axis=0) - skeleton.nodes[node]
