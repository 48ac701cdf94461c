"""The names that the package gives its users."""

from __future__ import annotations

import inspect
import subprocess
import sys

import pytest

import scaffold_cad
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


CHECKED = [
    "assert_printable",
    "build_scaffold",
    "check_printability",
    "delaunay_foam",
    "fill",
    "frame_scaffold",
    "lattice_part",
    "solidified",
    "thicken",
    "to_brep",
    "to_solid",
    "voronoi_foam",
]


@pytest.mark.parametrize("name", CHECKED)
def test_a_misspelled_keyword_gets_the_right_one(name: str) -> None:
    function = getattr(scaffold_cad, name)
    last = [
        one.name
        for one in inspect.signature(function).parameters.values()
        if one.kind is not inspect.Parameter.VAR_KEYWORD
    ][-1]
    with pytest.raises(KeywordError, match=rf"{name}\(\) has no .*; did you mean '{last}'\?"):
        function(**{last + last[-1]: None})
