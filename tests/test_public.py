"""The names that the package gives its users."""

from __future__ import annotations

import dataclasses
import inspect
import pickle
import re
import subprocess
import sys
from importlib import import_module
from inspect import isclass
from pathlib import Path
from typing import Any

import pytest

import scaffold_cad
from scaffold_cad import mechanics, tiles
from scaffold_cad.errors import KeywordError

NAMES_OF_0_1 = """
BeamLattice ConvolutionField Embedding Partition Patches QuadMesh Report Scaffold Skeleton
Solidified Subdivision TriangleMesh UnitCell assert_printable build_scaffold catmull_clark cells
check_printability check_skeleton delaunay_foam fill frame_scaffold lattice_part mapped
partition_sphere partition_spheres project read_skeleton register_cell relative_density
rotation_minimizing_frames self_intersections show smooth_patches solidified solve_radius thicken
tile to_brep to_solid to_trimesh voronoi_foam write
"""
"""What `from scaffold_cad import *` took in version 0.1, but for what `round_struts` replaces."""


@pytest.mark.parametrize("name", NAMES_OF_0_1.split())
def test_names_of_the_last_version_can_be_imported(name: str) -> None:
    assert hasattr(scaffold_cad, name)


def test_every_name_of_all_is_there_once() -> None:
    assert scaffold_cad.__all__ == sorted(set(scaffold_cad.__all__))
    assert {*scaffold_cad.PART_CLASSES} <= set(scaffold_cad.__all__) <= set(dir(scaffold_cad))


def test_a_star_import_shadows_nothing_of_build123d() -> None:
    build123d = pytest.importorskip("build123d")
    theirs = {name for name in dir(build123d) if not name.startswith("_")}
    assert theirs & set(scaffold_cad.__all__) == set()


def test_part_classes_load_build123d_when_they_are_asked_for() -> None:
    pytest.importorskip("build123d")
    program = (
        "import sys, scaffold_cad\n"
        "assert 'build123d' not in sys.modules\n"
        "assert set(scaffold_cad.PART_CLASSES) <= set(dir(scaffold_cad))\n"
        "from scaffold_cad import LatticeBox, LatticeFill, RoundStrutsSolid\n"
        "from scaffold_cad import ScaffoldSolid, StrutFrame, parts\n"
        "assert StrutFrame is parts.StrutFrame and 'build123d' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(AttributeError, match="'scaffold_cad' has no attribute 'StrutFrames'"):
        scaffold_cad.StrutFrames  # noqa: B018


ABSTRACT = {"CellMap", "ScaffoldCadError", "Work"}
"""Public classes that are made to be derived from or caught, not called."""

REFERENCE = Path(__file__).parents[1] / "docs" / "api"


def documented() -> list[str]:
    """Return the dotted names of what the reference documents, without the modules."""
    text = "\n".join(page.read_text("utf-8") for page in sorted(REFERENCE.glob("*.md")))
    names = re.findall(r"^::: ([\w.]+)$", text, flags=re.MULTILINE)
    return [name for name in names if name != "scaffold_cad.errors"]


def _callables() -> dict[str, Any]:
    """Return what users call by its dotted name, but for parts, which load build123d."""
    found = {}
    for dotted in documented():
        module, _, name = dotted.rpartition(".")
        if name not in ABSTRACT | {*scaffold_cad.PART_CLASSES}:
            found[dotted] = getattr(import_module(module), name)
    return found


CALLABLES = _callables()


def _methods(kind: type) -> dict[str, Any]:
    """Return the public methods that a class defines, but for properties."""
    named = {name: getattr(kind, name) for name in vars(kind) if not name.startswith("_")}
    return {name: one for name, one in named.items() if callable(one) and not isinstance(one, type)}


def _check_misspelled(name: str, called: Any) -> None:
    function = called.__init__ if isinstance(called, type) else called
    parameters = [
        one.name
        for one in inspect.signature(function).parameters.values()
        if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY) and one.name != "self"
    ]
    wanted = rf"did you mean '{parameters[-1]}'\?" if parameters else "need no arguments"
    wrong = parameters[-1] + parameters[-1][-1] if parameters else "size"
    with pytest.raises(KeywordError, match=rf"^{name}\(\) has no parameter '{wrong}'; {wanted}$"):
        called(**{wrong: None})


@pytest.mark.parametrize("dotted", CALLABLES)
def test_a_misspelled_keyword_gets_the_right_one(dotted: str) -> None:
    _check_misspelled(dotted.rpartition(".")[2], CALLABLES[dotted])


@pytest.mark.parametrize("dotted", [name for name, one in CALLABLES.items() if isclass(one)])
def test_a_misspelled_keyword_of_a_method_gets_the_right_one(dotted: str) -> None:
    for name, method in _methods(CALLABLES[dotted]).items():
        _check_misspelled(name, method)


def test_misspelled_keywords_are_found_for_all_public_names() -> None:
    names = {dotted.rpartition(".")[2] for dotted in CALLABLES}
    assert {*scaffold_cad.__all__} - {*scaffold_cad.PART_CLASSES} <= names
    called = {*mechanics.__all__, *tiles.__all__} - ABSTRACT - {"MATERIALS"}
    assert called <= names


@pytest.mark.parametrize("name", scaffold_cad.PART_CLASSES)
def test_a_misspelled_keyword_of_a_part_gets_the_right_one(name: str) -> None:
    pytest.importorskip("build123d")
    _check_misspelled(name, getattr(scaffold_cad, name))


def test_classes_with_checked_keywords_stay_themselves() -> None:
    strut = scaffold_cad.Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    again = pickle.loads(pickle.dumps(strut))
    assert type(again) is scaffold_cad.Skeleton
    assert (again.nodes == strut.nodes).all()
    assert "radii" in inspect.signature(scaffold_cad.Skeleton).parameters
    wood = dataclasses.replace(mechanics.Material(young=1e4), name="wood")
    assert (wood.young, wood.name) == (1e4, "wood")
