"""B-reps of scaffolds, round struts and quad meshes: valid, and of the volume they stand for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad.brep.g1 import smooth_patches
from scaffold_cad.errors import OptionError
from scaffold_cad.io.write import write
from scaffold_cad.mesh.subdivision import catmull_clark
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.struts import round_struts
from tests.skeletons import K4, STICK_FIGURE, STRUT, TRIPOD, TWO_STRUTS

build123d = pytest.importorskip("build123d")


def test_a_scaffold_becomes_a_solid_of_its_quads() -> None:
    scaffold = build_scaffold(TRIPOD)
    solid = to_brep(scaffold)
    assert solid.is_valid
    assert len(solid.faces()) == len(scaffold.mesh.quads)
    assert solid.volume == pytest.approx(scaffold.mesh.signed_volume, rel=1e-9)


def test_round_struts_become_cylinders_discs_and_four_patches_a_strut_and_node() -> None:
    solid = to_brep(round_struts(TRIPOD))
    assert solid.is_valid
    kinds = build123d.GeomType
    counts = {kind: len(solid.faces().filter_by(kind)) for kind in (kinds.CYLINDER, kinds.PLANE)}
    assert counts == {kinds.CYLINDER: 3, kinds.PLANE: 3}
    assert len(solid.faces()) == 3 + 3 + 3 * 4
    radii = [face.radius for face in solid.faces().filter_by(kinds.CYLINDER)]
    np.testing.assert_allclose(radii, TRIPOD.radii[0], rtol=1e-12)


def test_a_solid_of_smooth_patches_follows_the_limit_surface() -> None:
    mesh = build_scaffold(K4, collars=True).mesh
    solid = to_brep(mesh, smooth=True)
    assert solid.is_valid
    assert solid.volume == pytest.approx(catmull_clark(mesh, 3).mesh.signed_volume, rel=0.02)


@pytest.mark.parametrize("make", [round_struts, build_scaffold])
def test_two_components_become_two_solids(make: Any) -> None:
    assert len(to_brep(make(TWO_STRUTS)).solids()) == 2


def test_a_step_file_of_smooth_patches_reads_back_valid(tmp_path: Path) -> None:
    patches = smooth_patches(build_scaffold(TRIPOD, collars=True).mesh)
    write(patches, tmp_path / "tripod.step")
    solid = build123d.import_step(str(tmp_path / "tripod.step")).solids()[0]
    assert solid.is_valid
    assert len(solid.faces()) == len(patches.bezier.quads)


@pytest.mark.parametrize("make", [round_struts, build_scaffold])
def test_a_box_cuts_a_figure_in_two_valid_halves(make: Any) -> None:
    solid = to_brep(make(STICK_FIGURE))
    upper = build123d.Pos(0, 0, solid.bounding_box().center().Z + 100) * build123d.Box(
        300, 300, 200
    )
    head, legs = solid & upper, solid - upper
    assert all(part.is_valid for part in (*head.solids(), *legs.solids()))
    assert head.volume + legs.volume == pytest.approx(solid.volume, rel=1e-6)
    assert 0.3 < head.volume / solid.volume < 0.7


@pytest.mark.parametrize("change", ["fillet", "chamfer"])
def test_edges_of_flat_ends_and_of_cuts_can_be_rounded(change: str) -> None:
    round_off = getattr(build123d, change)
    whole = to_brep(round_struts(TRIPOD))
    sawn = whole - build123d.Pos(0, 0, 8) * build123d.Box(40, 40, 4)
    for solid in (whole, sawn):
        plane = solid.faces().filter_by(build123d.GeomType.PLANE)[0]
        rounded = round_off(plane.edges(), 0.3)
        assert rounded.is_valid
        # Less than a ring of square section around a rim of length 2π.
        assert 0 < solid.volume - rounded.volume < 2 * 3.15 * 0.3**2


@pytest.mark.parametrize(
    "what",
    [smooth_patches(build_scaffold(STRUT).mesh), build_scaffold(STRUT), round_struts(STRUT)],
    ids=["patches", "scaffold", "round struts"],
)
def test_only_quad_meshes_are_made_smooth(what: Any) -> None:
    with pytest.raises(OptionError, match=r"smooth=True is for a QuadMesh; need round_struts\("):
        to_brep(what, smooth=True)


def test_split_is_refused_without_smooth() -> None:
    with pytest.raises(OptionError, match="split is for smooth=True"):
        to_brep(build_scaffold(TRIPOD), split=1)
