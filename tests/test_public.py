"""The names that the package gives its users."""

from __future__ import annotations

import dataclasses
import inspect
import pickle
import subprocess
import sys
from typing import Any

import pytest

import scaffold_cad
from scaffold_cad import mechanics
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
    assert set(scaffold_cad.__all__) <= set(dir(scaffold_cad))


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


ABSTRACT = {"CellMap", "Field", "ScaffoldCadError"}
"""Public classes that are made to be derived from or caught, not called."""


MADE_BY_THE_PACKAGE = {
    "BeamModel", "BeamSolution", "CellRow", "Hexahedra", "Homogenized", "Loading", "Sized",
}  # fmt: skip
"""Results of `mechanics` that users are given, and do not make."""


def _callables() -> dict[str, Any]:
    """Return what users call by name, without build123d: all at the top level, and mechanics."""
    top = {*dir(scaffold_cad)} - {*scaffold_cad.PART_CLASSES}
    found = {name: getattr(scaffold_cad, name) for name in top if not name.startswith("_")}
    found.update((name, getattr(mechanics, name)) for name in mechanics.__all__)
    return {
        name: one
        for name, one in found.items()
        if callable(one)
        and str(one.__module__).startswith("scaffold_cad.")
        and name not in ABSTRACT | MADE_BY_THE_PACKAGE
    }


CALLABLES = _callables()


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


@pytest.mark.parametrize("name", sorted(CALLABLES))
def test_a_misspelled_keyword_gets_the_right_one(name: str) -> None:
    _check_misspelled(name, CALLABLES[name])


def test_misspelled_keywords_are_found_for_all_public_names() -> None:
    assert set(scaffold_cad.__all__) <= set(CALLABLES)


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
