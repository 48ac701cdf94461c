from __future__ import annotations

import inspect
import pickle
from collections.abc import Callable
from copy import copy, deepcopy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pytest

import scaffold_cad as sc
from scaffold_cad.base.arrays import (
    Bools,
    Floats,
    Frozen,
    as_edges,
    as_floats,
    as_points,
    as_quads,
    as_radii,
    as_triangles,
)
from scaffold_cad.errors import MeshError, OptionError, SkeletonError
from scaffold_cad.lattice import unit_cell
from scaffold_cad.struts.breps.faces import brep_of_struts
from tests.skeletons import STICK_FIGURE


@pytest.mark.parametrize(
    ("make", "values"),
    [
        (lambda v: as_points(v, "nodes"), np.ones((4, 3))),
        (lambda v: as_edges(v, "edges", 4), np.array([[0, 3], [1, 2]])),
        (lambda v: as_quads(v, "quads", 4), np.array([[0, 1, 2, 3]])),
        (lambda v: as_radii(v, "radii", 4), np.ones(4)),
    ],
)
def test_arrays_are_read_only_contiguous_copies(
    make: Callable[[Any], np.ndarray], values: np.ndarray
) -> None:
    array = make(np.asfortranarray(values))
    assert not array.flags.writeable
    assert array.flags.c_contiguous
    before = array.copy()
    values[:] = 3
    np.testing.assert_array_equal(array, before)


def test_what_nobody_may_write_to_is_kept_as_it_is() -> None:
    points, edges = as_points(np.ones((4, 3)), "nodes"), as_edges([[0, 3], [1, 2]], "edges", 4)
    assert as_points(points, "vertices") is points
    assert as_edges(edges, "edges", 4) is edges
    with pytest.raises(SkeletonError, match=r"edges\[0\] joins nodes \[0, 3\]; need 0 to 2"):
        as_edges(edges, "edges", 3)


def test_views_of_what_may_be_written_to_are_copied() -> None:
    values = np.ones((4, 3))
    view = values[:]
    view.setflags(write=False)
    kept = as_points(view, "nodes")
    values[:] = 3
    np.testing.assert_array_equal(kept, np.ones((4, 3)))


def test_lists_and_whole_numbers_become_float64() -> None:
    points = as_points([[0, 1, 2], [3, 4, 5]], "nodes")
    assert points.dtype == np.float64
    assert points.tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert as_floats(3, "x").dtype == np.float64


def test_the_error_of_what_is_no_number_may_be_another() -> None:
    with pytest.raises(OptionError, match="size is not an array of numbers: it holds text, abc"):
        as_floats("abc", "size", OptionError)


def test_indices_become_intp() -> None:
    assert as_edges(np.array([[0, 1]], dtype=np.uint8), "edges", 2).dtype == np.intp


def test_an_index_that_no_array_has_is_shown_as_it_was_given() -> None:
    with pytest.raises(SkeletonError, match="edges holds 9223372036854775808; need whole numbers"):
        as_edges(np.array([[0, 2**63]], dtype=np.uint64), "edges", 2)


def test_nothing_has_the_right_shape() -> None:
    assert as_points([], "nodes").shape == (0, 3)
    assert as_edges([], "edges", 0).shape == (0, 2)
    assert as_quads([], "quads", 0).shape == (0, 4)
    assert as_radii([], "radii", 0).shape == (0,)


def test_one_radius_stands_for_all() -> None:
    assert as_radii(2, "radii", 3).tolist() == [2.0, 2.0, 2.0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([1.0, 2.0, 3.0], r"nodes has shape \(3,\); need \(n, 3\)"),
        ([[1.0, 2.0]], r"nodes has shape \(1, 2\); need \(n, 3\)"),
        ([[[1.0, 2.0, 3.0]]], r"nodes has shape \(1, 1, 3\); need \(n, 3\)"),
        ([[0, 0, 0], [0, np.nan, 0]], r"nodes\[1\] is \[0.0, nan, 0.0\]; need finite numbers"),
        ([[0, 0, np.inf]], r"nodes\[0\] is \[0.0, 0.0, inf\]; need finite numbers"),
        ([[0, 0, "far"]], "nodes is not an array of numbers: it holds text"),
        ([["1", "2", "3"]], "nodes is not an array of numbers: it holds text, 1"),
        (None, "nodes is not an array of numbers: it is None"),
        ([[0, 0, 0], [0, 0]], "nodes is not an array of numbers"),
        ([[0, 0, 10**400]], "nodes is not an array of numbers"),
        ([[0, 0, {}]], "nodes is not an array of numbers"),
        ([[0, 0, 1j]], "nodes is not an array of numbers: it holds complex numbers"),
    ],
)
def test_points_that_are_none_are_refused(values: Any, message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        as_points(values, "nodes")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([1.0], r"radii has shape \(1,\); need \(2,\), one per node"),
        ([[1.0, 2.0]], r"radii has shape \(1, 2\); need \(2,\), one per node"),
        ([1.0, 0.0], "node 1 has radius 0 mm; need > 0"),
        ([-0.5, 1.0], r"node 0 has radius -0\.5 mm; need > 0"),
        ([1.0, np.nan], "node 1 has radius nan mm; need > 0"),
        ([1.0, np.inf], "node 1 has radius inf mm; need > 0"),
        (0.0, "node 0 has radius 0 mm; need > 0"),
        ("thick", "radii is not an array of numbers"),
    ],
)
def test_radii_that_are_none_are_refused(values: Any, message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        as_radii(values, "radii", count=2)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([[0, 1], [1, 3]], r"edges\[1\] joins nodes \[1, 3\]; need 0 to 2"),
        ([[-1, 1]], r"edges\[0\] joins nodes \[-1, 1\]; need 0 to 2"),
        ([[0.5, 1.0]], "edges holds 0.5; need whole numbers"),
        ([[True, False]], "edges holds True; need whole numbers"),
        ([[0, 2**70]], f"edges holds {2**70}; need whole numbers below 9e"),
        ([[0, 1, 2]], r"edges has shape \(1, 3\); need \(n, 2\)"),
        ([0, 1], r"edges has shape \(2,\); need \(n, 2\)"),
        ([[0, 1], [2]], "edges is not an array of indices"),
    ],
)
def test_edges_that_are_none_are_refused(values: Any, message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        as_edges(values, "edges", count=3)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([[0, 1, 2, 4]], r"quads\[0\] has vertices \[0, 1, 2, 4\]; need 0 to 3"),
        ([[0, 1, 2]], r"quads has shape \(1, 3\); need \(n, 4\)"),
        ([[0, 1, 2, 3.5]], "quads holds 3.5; need whole numbers"),
        ([[0, 1, 2, 3], [0]], "quads is not an array of indices"),
    ],
)
def test_quads_that_are_none_are_refused(values: Any, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        as_quads(values, "quads", count=4)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([[0, 1, 4]], r"triangles\[0\] has vertices \[0, 1, 4\]; need 0 to 3"),
        ([[0, 1, 2, 3]], r"triangles has shape \(1, 4\); need \(n, 3\)"),
        ([[0, 1, 2], [0]], "triangles is not an array of indices"),
        ([["a", "b", "c"]], "triangles holds 'a'; need whole numbers"),
    ],
)
def test_triangles_that_are_none_are_refused(values: Any, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        as_triangles(values, "triangles", count=4)


# What keeps arrays


@dataclass(frozen=True, eq=False)
class Marks(Frozen):
    """Something that keeps arrays."""

    kept: Bools
    pair: tuple[Floats, str]
    part: Marks | None = None

    @cached_property
    def opposite(self) -> Bools:
        return ~self.kept


def test_arrays_that_are_kept_cannot_be_written_to() -> None:
    marks = Marks(np.array([True]), (np.ones(2), "x"))
    assert marks.opposite is marks.opposite
    for array in (marks.kept, marks.pair[0], marks.opposite):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0


@pytest.mark.parametrize(
    "copied", [copy, deepcopy, lambda marks: pickle.loads(pickle.dumps(marks))]
)
def test_neither_can_those_of_copies(copied: Callable[[Marks], Marks]) -> None:
    original = Marks(np.array([True]), (np.ones(2), "x"), Marks(np.ones(3) > 0, (np.ones(1), "")))
    assert original.opposite.tolist() == [False]
    marks = copied(original)
    assert marks.part is not None
    assert marks.pair[1] == "x"
    assert vars(marks)["opposite"].tolist() == [False]
    for array in (marks.kept, marks.pair[0], marks.opposite, marks.part.kept, marks.part.pair[0]):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0


def writable_arrays(thing: object, path: str = "", seen: set[int] | None = None) -> list[str]:
    """Return where arrays that may be written to are kept by `thing`, all it can tell computed."""
    seen = set() if seen is None else seen
    if id(thing) in seen:
        return []
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        return [path] if thing.flags.writeable else []
    if isinstance(thing, tuple | list):
        return [found for item in thing for found in writable_arrays(item, f"{path}[]", seen)]
    if not type(thing).__module__.startswith("scaffold_cad"):
        return []
    for name, attribute in inspect.getmembers(type(thing)):
        if isinstance(attribute, property | cached_property):
            getattr(thing, name)
    kept = dict(vars(thing)).items()
    return [found for name, part in kept for found in writable_arrays(part, f"{path}.{name}", seen)]


def test_nothing_that_a_result_keeps_can_be_written_to() -> None:
    scaffold = sc.build_scaffold(STICK_FIGURE, collars=True)
    struts = sc.round_struts(STICK_FIGURE)
    results = [
        scaffold,
        scaffold.embedding(),
        struts,
        brep_of_struts(struts),
        sc.smooth_patches(scaffold.mesh),
        sc.catmull_clark(scaffold.mesh, 1),
        sc.TriangleMesh(scaffold.mesh.vertices, scaffold.mesh.triangles),
        sc.ConvolutionField(STICK_FIGURE),
        sc.ConvolutionField(STICK_FIGURE).samples([[0, 0, 0]]),
        sc.BeamLattice(STICK_FIGURE),
        sc.partition_sphere(np.eye(3)),
        sc.partition_spheres([np.eye(3), -np.eye(3)]),
        unit_cell("octet"),
        STICK_FIGURE.cleaned(),
        sc.check_printability(scaffold),
    ]
    assert writable_arrays([*results, sc.solidified(scaffold)]) == []
    assert writable_arrays(pickle.loads(pickle.dumps(results))) == []
    assert writable_arrays(deepcopy(results)) == []


MASKED = np.ma.masked_array([[0.0, 0, 0], [9, 0, 0]], mask=[[0, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize(
    ("make", "item"),
    [
        (lambda: as_points(MASKED, "nodes"), "nodes[1, 1]"),
        (lambda: as_points(list(MASKED), "nodes"), "nodes[1, 1]"),
        (lambda: as_radii(np.ma.masked_array([1.0, 2.0], mask=[0, 1]), "radii", 2), "radii[1]"),
        (lambda: as_radii([1.0, np.ma.masked], "radii", 2), "radii[1]"),
        (lambda: as_edges(np.ma.masked_array([[0, 1]], mask=[[1, 0]]), "edges", 2), "edges[0, 0]"),
    ],
)
def test_masked_items_are_named(make: Callable[[], Any], item: str) -> None:
    with pytest.raises(SkeletonError) as caught:
        make()
    assert str(caught.value) == f"{item} is masked; need a number, or an array without that item"


def test_masked_arrays_that_hide_nothing_are_arrays() -> None:
    whole = np.ma.masked_array([[0.0, 0, 0], [9, 0, 0]])
    assert as_points(whole, "nodes").tolist() == whole.tolist()
