"""B-reps of scaffolds: coarse and smooth, valid, and with the volume of what they stand for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scaffold_cad.smooth import smooth_mesh, smooth_patches

from scaffold_cad.errors import OptionError
from scaffold_cad.io import read_skeleton
from scaffold_cad.io.write import write
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import build_scaffold
from tests.skeletons import JACK, K4, TRIPOD, TWO_STRUTS

build123d = pytest.importorskip("build123d")

SKELETONS = Path(__file__).parents[2] / "examples" / "skeletons"


def test_a_scaffold_becomes_a_solid_of_its_quads() -> None:
    scaffold = build_scaffold(TRIPOD)
    solid = to_brep(scaffold)
    assert solid.is_valid
    assert len(solid.faces()) == len(scaffold.mesh.quads)
    assert solid.volume == pytest.approx(scaffold.mesh.signed_volume, rel=1e-9)


@pytest.mark.parametrize("caps", ["round", "flat"])
def test_a_smooth_solid_is_valid_and_follows_the_limit_surface(caps: str) -> None:
    scaffold = build_scaffold(K4, collars=True)
    solid = to_brep(scaffold, smooth=True, caps=caps)  # type: ignore[arg-type]
    assert solid.is_valid
    fine = smooth_mesh(scaffold, levels=3, caps=caps).mesh  # type: ignore[arg-type]
    assert solid.volume == pytest.approx(fine.signed_volume, rel=0.02)


def test_two_components_become_two_solids() -> None:
    assert len(to_brep(build_scaffold(TWO_STRUTS), smooth=True).solids()) == 2


def test_a_smooth_step_file_reads_back_valid(tmp_path: Path) -> None:
    patches = smooth_patches(build_scaffold(TRIPOD, collars=True))
    write(patches, tmp_path / "tripod.step")
    solid = build123d.import_step(str(tmp_path / "tripod.step")).solids()[0]
    assert solid.is_valid
    assert len(solid.faces()) == len(patches.bezier.quads)


@pytest.mark.parametrize("caps", ["round", "flat"])
def test_faces_read_back_join_with_one_tangent_plane(tmp_path: Path, caps: str) -> None:
    pytest.importorskip("manifold3d")
    from tests.benchmarks.smooth import jumps_of_shape

    patches = smooth_patches(build_scaffold(JACK, collars=True), caps=caps)  # type: ignore[arg-type]
    write(patches, tmp_path / "jack.step")
    jumps = jumps_of_shape(build123d.import_step(str(tmp_path / "jack.step")))
    curved = np.count_nonzero(~patches.is_flat)
    # Each side of a curved face but those along a flat cap.
    assert len(jumps) == 4 * curved - 4 * (len(patches.is_flat) - curved)
    assert np.degrees(jumps.max()) < 1e-6


def test_a_box_cuts_the_smooth_stick_woman_in_two_valid_halves() -> None:
    scaffold = build_scaffold(read_skeleton(SKELETONS / "stick_woman.json"))
    solid = to_brep(scaffold, smooth=True)
    upper = build123d.Pos(0, 0, solid.bounding_box().center().Z + 100) * build123d.Box(
        300, 300, 200
    )
    head, legs = solid & upper, solid - upper
    assert all(part.is_valid for part in (*head.solids(), *legs.solids()))
    assert head.volume + legs.volume == pytest.approx(solid.volume, rel=1e-6)
    assert 0.3 < head.volume / solid.volume < 0.7


@pytest.mark.parametrize("change", ["fillet", "chamfer"])
def test_edges_of_flat_caps_and_of_cuts_can_be_rounded(change: str) -> None:
    round_off = getattr(build123d, change)
    scaffold = build_scaffold(TRIPOD, collars=True)
    sawn = to_brep(scaffold, smooth=True) - build123d.Pos(0, 0, 8) * build123d.Box(40, 40, 4)
    for solid in (to_brep(scaffold, smooth=True, caps="flat"), sawn):
        plane = solid.faces().filter_by(build123d.GeomType.PLANE)[0]
        rounded = round_off(plane.edges(), 0.3)
        assert rounded.is_valid
        # Less than a ring of square section around a rim of length 2π.
        assert 0 < solid.volume - rounded.volume < 2 * 3.15 * 0.3**2


def test_patches_cannot_be_made_smooth() -> None:
    patches = smooth_patches(build_scaffold(TRIPOD))
    with pytest.raises(OptionError, match="smooth is for a Scaffold or a QuadMesh"):
        to_brep(patches, smooth=True)


@pytest.mark.parametrize("option", [{"caps": "round"}, {"split": 1}])
def test_options_of_patches_are_refused_without_smooth(option: dict[str, object]) -> None:
    with pytest.raises(OptionError, match=f"{next(iter(option))} is for smooth=True"):
        to_brep(build_scaffold(TRIPOD), **option)  # type: ignore[arg-type]
