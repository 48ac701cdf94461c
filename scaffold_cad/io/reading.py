"""read_skeleton(): the skeleton that a file holds, repaired so that it can be scaffolded."""

from __future__ import annotations

import logging
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import as_count, as_flag, as_path, checks_keywords
from scaffold_cad.base.arrays import Floats, place_text
from scaffold_cad.base.files import reading
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import FormatError, OptionError, SkeletonError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._units import factor_of, length_of
from scaffold_cad.io.register import HEAD_SIZE, reader_of
from scaffold_cad.skeleton import Cleaning, Skeleton, check_skeleton
from scaffold_cad.skeleton.proportions import thicker_than_long
from scaffold_cad.skeleton.repair import least_radius, repaired

BYTES_PER_EDGE = 9000
"""Memory that an edge takes at the peak of a build with collars, measured on lattices."""

_log = logging.getLogger("scaffold_cad.io")


@checks_keywords()
def read_skeleton(
    path: str | PathLike[str],
    radius: Radius | None = None,
    strict: bool = False,
    *,
    weld_distance: float | None = None,
    split_contacts: bool = False,
    max_nodes: int | None = None,
    units: str | None = None,
    scale: float | None = None,
) -> Skeleton:
    r"""Return the skeleton that a file holds, repaired so that it can be scaffolded.

    What was repaired is logged as a warning by the logger ``scaffold_cad.io``.

    Parameters
    ----------
    path : a file of a format in `known_suffixes`
    radius : mm, > 0; the radius of every node and strut, or a function of positions (n, 3) that
        returns radii (n,), such as a `Field`, instead of what the file holds; needed for formats
        without radii
    strict : whether to refuse what needs repair, and what a skeleton does not keep of the file;
        then no option of repair may be given
    weld_distance, split_contacts : options of `Skeleton.cleaned`
    max_nodes : most nodes that are taken, to protect memory; any number if None
    units : of the file's lengths, where it names none: "um", "mm", "cm", "m", "in", "ft", ...; by
        default they are taken as mm
    scale : > 0; what lengths are multiplied with besides

    Raises
    ------
    FormatError
        If the file cannot be read, or holds no edge, or no radii and none is given, or more
        nodes than `max_nodes`, or with `strict` more than a skeleton keeps.
    SkeletonError
        If it cannot be repaired, or with `strict` if it needs repair; nodes and edges are
        numbered from 0 in order of the file.
    OptionError
        If an option is out of range, or `units` are given and the file names another.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from scaffold_cad import read_skeleton
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "strut.obj")
    ...     _ = path.write_text("v 0 0 0\nv 9 0 0\nl 1 2\n")
    ...     len(read_skeleton(path, radius=1.0).edges)
    1
    """
    strict = as_flag(strict, "strict")
    if strict and (weld_distance is not None or split_contacts):
        raise OptionError("strict reading repairs nothing; need no weld_distance, split_contacts")
    raw = read_raw(path, max_nodes)
    if strict:
        return strictly(path, raw, radius, units=units, scale=scale)
    return repairing(
        path,
        raw,
        radius,
        weld_distance=weld_distance,
        split_contacts=split_contacts,
        units=units,
        scale=scale,
    )


def repairing(
    path: str | PathLike[str], raw: RawSkeleton, radius: Radius | None = None, **options: Any
) -> Skeleton:
    """Do as `read_skeleton` with the graph that was read from a file."""
    cleaning = with_repairs(path, raw, radius, **options)
    if cleaning.repairs.total:
        _log.warning("%s was repaired: %s", path, cleaning.repairs)
    return cleaning.skeleton


def strictly(
    path: str | PathLike[str],
    raw: RawSkeleton,
    radius: Radius | None = None,
    *,
    units: str | None = None,
    scale: float | None = None,
) -> Skeleton:
    """Do as `read_skeleton` with `strict` with the graph that was read from a file."""
    raw = in_millimeters(path, raw, units, scale)
    _log.info("%s: %s and %s read", path, *_counts(raw))
    if raw.beyond_skeleton:
        raise FormatError(
            f"{path} holds also {', '.join(raw.beyond_skeleton)}; need nothing that a skeleton "
            "does not keep (or read it without strict)"
        )
    radii, edge_radii = _radii(Path(path), raw, radius)
    try:
        skeleton = Skeleton(raw.nodes, raw.edges, radii, edge_radii)
        check_skeleton(skeleton)
    except SkeletonError as error:
        raise SkeletonError(f"{path}: {error}") from None
    _warn_of_radii(path, skeleton)
    return skeleton


def read_with_repairs(
    path: str | PathLike[str],
    radius: Radius | None = None,
    *,
    weld_distance: float | None = None,
    split_contacts: bool = False,
    max_nodes: int | None = None,
    units: str | None = None,
    scale: float | None = None,
) -> Cleaning:
    """Return the skeleton that a file holds as `read_skeleton` does, and what was repaired."""
    return with_repairs(
        path,
        read_raw(path, max_nodes),
        radius,
        weld_distance=weld_distance,
        split_contacts=split_contacts,
        units=units,
        scale=scale,
    )


def with_repairs(
    path: str | PathLike[str],
    raw: RawSkeleton,
    radius: Radius | None = None,
    *,
    weld_distance: float | None = None,
    split_contacts: bool = False,
    units: str | None = None,
    scale: float | None = None,
) -> Cleaning:
    """Do as `read_with_repairs` with the graph that was read from a file."""
    raw = in_millimeters(path, raw, units, scale)
    _log.info("%s: %s and %s read", path, *_counts(raw))
    if raw.beyond_skeleton:
        _log.warning("%s: left out %s", path, ", ".join(raw.beyond_skeleton))
    radii, edge_radii = _radii(Path(path), raw, radius)
    try:
        graph = repaired(
            raw.nodes,
            raw.edges,
            radii,
            edge_radii,
            weld_distance=weld_distance,
            split_contacts=split_contacts,
        )
    except SkeletonError as error:
        raise SkeletonError(f"{path}: {error}") from None
    skeleton = Skeleton(graph.nodes, graph.edges, graph.radii, graph.edge_radii)
    _warn_of_radii(path, skeleton)
    return Cleaning(skeleton, graph.repairs)


def _counts(raw: RawSkeleton) -> tuple[str, str]:
    return counted(len(raw.nodes), "node"), counted(len(raw.edges), "edge")


def read_raw(path: str | PathLike[str], max_nodes: int | None = None) -> RawSkeleton:
    """Return the graph in a file as it is, faults included.

    Raises
    ------
    FormatError
        If the file cannot be read, or holds no edge, or more nodes than `max_nodes`.
    """
    path = as_path(path)
    try:
        with reading(path):
            raw = reader_of(path, _head(path))(path)
    except SkeletonError as error:
        raise FormatError(f"{path}: {error}") from None
    if len(raw.edges) == 0:
        but = "but" if len(raw.nodes) else "and"
        raise FormatError(
            f"{path} has {counted(len(raw.nodes), 'node')} {but} no edges; need at least one"
        )
    if max_nodes is not None and len(raw.nodes) > as_count(max_nodes, "max_nodes"):
        size = len(raw.edges) * BYTES_PER_EDGE / 1e9
        found = f"{path} has {' and '.join(_counts(raw))}"
        raise FormatError(
            f"{found}; need at most {max_nodes} nodes: to build it takes about {size:.2g} GB of "
            "memory, and max_nodes= allows it"
        )
    return raw


def in_millimeters(
    path: str | PathLike[str], raw: RawSkeleton, units: str | None, scale: float | None
) -> RawSkeleton:
    """Return a graph whose lengths are in `units`, times `scale`, in mm.

    Raises
    ------
    OptionError
        If units are given and the file names another.
    """
    factor = factor_of(units, scale)
    if units is not None and raw.unit is not None:
        if length_of(raw.unit) == factor_of(units, None):  # what the file says itself
            return in_millimeters(path, raw, None, scale)
        raise OptionError(
            f"{path} says that its unit is {raw.unit}; need no units= (scale= changes its size)"
        )
    if units is None and raw.usual_unit is not None:
        _log.info(
            "%s: lengths, mostly in %s, are taken as mm (units=%r converts them)",
            path,
            raw.usual_unit,
            raw.usual_unit,
        )
    if factor == 1.0:
        return raw
    try:
        return raw.scaled(factor)
    except SkeletonError as error:
        raise FormatError(f"{path}, in units of {factor:g} mm: {error}") from None


def _warn_of_radii(path: str | PathLike[str], skeleton: Skeleton) -> None:
    """Log a warning if most edges are on paths that are thicker than long: units may be mixed."""
    found = thicker_than_long(skeleton)
    if found:
        _log.warning("%s: %s: check the units?", path, found)


def _head(path: Path) -> bytes:
    """Return the first bytes of a file, which must not be empty."""
    with path.open("rb") as stream:
        head = stream.read(HEAD_SIZE)
    if not head:
        raise FormatError(f"{path} is empty; need nodes and edges")
    return head


def _radii(
    path: Path, raw: RawSkeleton, radius: Radius | None
) -> tuple[Floats | None, Floats | None]:
    """Return the radii of nodes and of edges: those given for all, or what the file holds."""
    if radius is not None:
        radii = np.broadcast_to(radii_at(raw.nodes, radius), len(raw.nodes))
        ends = np.unique(raw.edges)
        ends = ends[np.isfinite(raw.nodes[ends]).all(axis=1)]
        none = ends[~((radii[ends] > 0) & (radii[ends] < np.inf))]
        if len(none):
            node = none[0]
            raise OptionError(
                f"radius is {radii[node]:g} mm for node {node} at {place_text(raw.nodes[node])} of "
                f"{path}; need > 0"
            )
        least = least_radius(raw.nodes[ends])
        if (radii < least).all():
            raise OptionError(
                f"radius is {radii.max():g} mm; need {least:.3g} mm or more for the nodes of "
                f"{path}, this far from the origin, for rounding"
            )
        return radii, None
    if not raw.has_radii:
        raise FormatError(f"{path} has no radii; need radius=, the radius of every node in mm")
    return raw.radii, raw.edge_radii
