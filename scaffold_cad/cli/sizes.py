"""Values on the command line: sizes, boxes, directions, sockets and names of files."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
"""Directions by name."""


def size(text: str) -> Floats:
    """Return one number, or three: 8, 8x8x12 or 8,8,12."""
    numbers = _lengths(text)
    if numbers.shape not in {(1,), (3,)}:
        raise argparse.ArgumentTypeError(f"{text!r} is not a size; need 8 or 8x8x12")
    return numbers if len(numbers) == 3 else numbers[0]


def three_sizes(text: str) -> tuple[float, float, float]:
    """Return the sides of a box: 40x40x20 or 40,40,20, or 40 for a cube."""
    numbers = _lengths(text)
    if numbers.shape not in {(1,), (3,)}:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a box; need 40x40x20, or 40 for a cube, all > 0"
        )
    x, y, z = np.broadcast_to(numbers, 3).tolist()
    return x, y, z


def lengths_of(names: str) -> Callable[[str], tuple[float, ...]]:
    """Return what takes a length for each letter of names such as RxT: 30x5 or 30,5."""
    count = len(names.split("x"))

    def taken(text: str) -> tuple[float, ...]:
        numbers = _lengths(text)
        if len(numbers) != count:
            raise argparse.ArgumentTypeError(f"{text!r}; need {names}: {count} lengths, all > 0")
        return tuple(numbers.tolist())

    return taken


def box(text: str) -> Floats:
    """Return the two corners of a box of that size from 0, shape (2, 3)."""
    return np.array([[0.0, 0.0, 0.0], three_sizes(text)])


def direction(text: str) -> tuple[float, float, float]:
    """Return three numbers: 0,0,1."""
    numbers = _numbers(text)
    if numbers.shape != (3,):
        raise argparse.ArgumentTypeError(f"{text!r}; need three numbers, as in 0,0,1")
    x, y, z = numbers.tolist()
    return x, y, z


def bend(text: str) -> float | str:
    """Return how bends are made: blend, torus, or a radius."""
    if text in ("blend", "torus"):
        return text
    radius = _lengths(text)
    if radius.shape != (1,):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a bend; need blend, torus or a radius > 0, mm"
        )
    return float(radius[0])


def socket(text: str) -> tuple[int, float, float]:
    """Return the node, the radius and the depth of a socket: 3:14.375:25."""
    try:
        node, radius, depth = text.split(":")
        return int(node), float(radius), float(depth)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a socket; need NODE:RADIUS:DEPTH, mm, as in 3:14.375:25"
        ) from None


def turn(text: str) -> tuple[str, float]:
    """Return the axis and the angle (rad) of a turn: z:90."""
    axis, _, degrees = text.lower().partition(":")
    try:
        angle = float(np.radians(float(degrees)))
    except ValueError:
        angle = np.inf
    if axis not in AXES or not np.isfinite(angle):
        raise argparse.ArgumentTypeError(f"{text!r} is not a turn; need AXIS:DEGREES, as in z:90")
    return axis, angle


def _lengths(text: str) -> Floats:
    """Return the numbers > 0 of a text, shape (n,); none if a word is not such a number."""
    numbers = _numbers(text)
    return numbers if (np.isfinite(numbers) & (numbers > 0)).all() else np.zeros(0)


def _numbers(text: str) -> Floats:
    """Return the numbers of a text, shape (n,); none if a word is not a number."""
    try:
        return np.array([float(word) for word in re.split("[xX,]", text)])
    except ValueError:
        return np.zeros(0)


def name(text: str) -> str:
    """Return the name of a file or a folder, which must have one character at least."""
    if not text:
        raise argparse.ArgumentTypeError("'' is not a name; need that of a file or a folder")
    return text


def path(text: str) -> Path:
    """Return the path of a file or a folder, see `name`."""
    return Path(name(text))
