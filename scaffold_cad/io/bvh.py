"""BVH, motion capture: the skeleton in its rest pose."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import Row, first_words, float_columns, line_error, read_rows
from scaffold_cad.io.register import register_reader

_OFFSET = "an offset: OFFSET x y z"


def _recognizes(head: bytes) -> bool:
    return [word.upper() for word in first_words(head)] == ["HIERARCHY"]


@register_reader("BVH", ".bvh", recognizes=_recognizes)
def read_bvh(path: Path) -> RawSkeleton:
    """Read the hierarchy of a BVH file, which has no radii; its motion is left out.

    The rest pose puts each joint at its parent's place plus its offset, all rotations being 0.
    Units are whatever the file measures in, taken as mm. There may be several roots; joints with
    an offset of 0 0 0, as many files have at hips and chest, are welded by cleaning.
    """
    rows = read_rows(path)
    parents, offsets = _hierarchy(path, rows)
    nodes = np.asarray(offsets)
    with np.errstate(over="ignore", invalid="ignore"):  # such places are refused below
        for node, parent in enumerate(parents):  # parents come before their children
            if parent >= 0:
                nodes[node] += nodes[parent]
    child = np.flatnonzero(np.asarray(parents) >= 0)
    return RawSkeleton(nodes, np.stack([np.asarray(parents)[child], child], axis=1))


def _hierarchy(path: Path, rows: list[Row]) -> tuple[list[int], list[Floats]]:
    """Return the parent of each joint, -1 for a root, and its offset from it."""
    parents: list[int] = []
    offsets: list[Floats] = []
    open_joints: list[int] = []
    for row in _hierarchy_rows(rows):
        line, words = row
        keyword = words[0].upper()
        if keyword in ("ROOT", "JOINT", "END"):
            _refuse_missing_offset(path, line, parents, offsets)
            if (keyword == "ROOT") == bool(open_joints):
                raise line_error(path, line, f"{' '.join(words)!r}", "ROOT outside, JOINT inside")
            parents.append(open_joints[-1] if open_joints else -1)
        elif keyword == "{":
            open_joints.append(len(parents) - 1)
        elif keyword == "}":
            if not open_joints:
                raise line_error(path, line, "'}' closes nothing", "as many '{' as '}'")
            open_joints.pop()
        elif keyword == "OFFSET":
            if len(offsets) != len(parents) - 1:
                raise line_error(path, line, "an offset of no joint", "one OFFSET a joint")
            offsets.append(float_columns(path, [row], 1, 3, _OFFSET)[0])
        elif keyword not in ("CHANNELS", "HIERARCHY"):
            raise line_error(path, line, f"{words[0]!r}", "ROOT, JOINT, End Site, OFFSET, CHANNELS")
    _refuse_missing_offset(path, rows[-1][0] if rows else 1, parents, offsets)
    if open_joints or not parents:
        raise FormatError(f"{path} ends within its hierarchy; need as many '}}' as '{{'")
    return parents, offsets


def _hierarchy_rows(rows: list[Row]) -> list[Row]:
    """Return the rows before MOTION, braces on rows of their own."""
    found: list[Row] = []
    for line, words in rows:
        if words[0].upper() == "MOTION":
            break
        if words[-1] == "{" and len(words) > 1:
            found += [(line, words[:-1]), (line, ["{"])]
        else:
            found.append((line, words))
    return found


def _refuse_missing_offset(
    path: Path, line: int, parents: list[int], offsets: list[Floats]
) -> None:
    if len(offsets) != len(parents):
        raise line_error(path, line, "the joint before it has no offset", _OFFSET)
