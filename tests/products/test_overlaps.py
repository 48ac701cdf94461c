"""One rule for struts that overlap, in all that they become: unite, refuse, or allow."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from scaffold_cad import (
    RoundStrutsSolid,
    ScaffoldSolid,
    TriangleMesh,
    build_scaffold,
    check_printability,
    round_struts,
    self_intersections,
    tile,
    to_brep,
    to_solid,
    write,
)
from scaffold_cad.cli import main
from scaffold_cad.errors import BrepError, OptionError
from scaffold_cad.printability import read_triangles
from scaffold_cad.products.overlaps import described, to_unite
from scaffold_cad.skeleton import Skeleton
from tests.skeletons import STRUT, TWO_STRUTS

CLOSE = Skeleton([[0, 0, 0], [20, 0, 0], [10, -8, 0.5], [10, 8, 0.5]], [[0, 1], [2, 3]], 1.0)
"""Two struts that run through each other."""

FOUND = "2 of 2 struts overlap others or their nodes (edges 0, 1; the first near [10, 0, 0] mm)"

CAD, MESHES = (".step", ".stp", ".brep"), (".stl", ".3mf", ".obj", ".ply", ".glb")

MAKERS: dict[str, Callable[[Skeleton], Any]] = {"square": build_scaffold, "round": round_struts}
makers = pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)

EDGES = np.array([0, 1])
NONE = np.zeros(0, dtype=np.intp)


def told(caplog: pytest.LogCaptureFixture) -> list[tuple[str, str]]:
    """Return the level and the text of what was logged of overlaps."""
    found = [(record.levelname, record.getMessage()) for record in caplog.records]
    return [(level, text) for level, text in found if "overlap" in text]


# --- the rule itself ---


@pytest.mark.parametrize("overlaps", ["unite", "refuse", "allow"])
def test_where_nothing_overlaps_nothing_is_done_and_said(
    overlaps: Any, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    assert not to_unite(overlaps, NONE, CLOSE)
    assert caplog.records == []


def test_unite_is_said_once(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    assert to_unite("unite", EDGES, CLOSE)
    assert told(caplog) == [("INFO", f"{FOUND}; they are united")]


def test_allow_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    assert not to_unite("allow", EDGES, CLOSE)
    assert told(caplog) == [("WARNING", f"{FOUND}: faces cross there")]


def test_refuse_names_struts_a_place_and_ways_out() -> None:
    with pytest.raises(BrepError) as refused:
        to_unite("refuse", EDGES, CLOSE)
    assert str(refused.value).startswith(f"{FOUND}: faces would cross; need struts apart")
    assert "overlaps='unite'" in str(refused.value)
    assert "overlaps='allow'" in str(refused.value)


def test_a_strut_that_is_shorter_than_its_collars_is_named_with_both_lengths() -> None:
    fork = Skeleton(
        [[0, 0, 0], [-20, 0, 0], [10, 1, 0], [10, -1, 0]], [[0, 1], [0, 2], [0, 3]], 2.0
    )
    with pytest.raises(
        BrepError, match=r"; edge 1 is 10\.05 mm long, and its collars need "
    ) as told:
        to_brep(round_struts(fork))
    # There the least fillet, a tenth of the radius, is beside all of the circle.
    angle, radius, fillet = 2 * np.arctan(0.1), 2.0, 0.2
    needed = (radius * (1 + np.cos(angle)) + fillet) / np.sin(angle)
    found = float(str(told.value).split("collars need ")[1].split(":")[0])
    assert found == pytest.approx(needed, rel=1e-3)


def test_curves_whose_samples_are_shorter_than_collars_are_exact_when_coarser() -> None:
    angles = np.linspace(0, 2 * np.pi, 65)[:-1]
    ring = np.stack([25 * np.cos(angles), 25 * np.sin(angles), 0 * angles], axis=1)
    spokes = [[k, (k + 1) % 64] for k in range(64)] + [[0, 64], [0, 65]]
    tips = [[19.0, 3, 14], [19.0, 3, -14]]
    fine = Skeleton(np.vstack([ring, tips]), spokes, 1.9)
    with pytest.raises(BrepError, match=r"collars need .* \(joints farther apart make it longer"):
        to_brep(round_struts(fine, blend=1.0))
    coarse = fine.simplified(0.7)
    assert len(coarse.edges) < 32
    assert to_brep(round_struts(coarse, blend=1.0)).is_valid


def test_an_unknown_rule_is_refused_even_where_nothing_overlaps() -> None:
    with pytest.raises(OptionError, match=r"overlaps is 'united'; .*; did you mean 'unite'"):
        to_unite("united", NONE, STRUT)  # type: ignore[arg-type]


def test_five_struts_are_named_at_most() -> None:
    nodes = np.arange(24.0).reshape(8, 3)
    line = Skeleton(nodes, np.stack([np.arange(7), np.arange(1, 8)], axis=1), 1.0)
    assert "7 of 7 struts" in described(np.arange(7), line)
    assert "(edges 0, 1, 2, 3, 4, ...; the first near [1.5, 2.5, 3.5] mm)" in described(
        np.arange(7), line
    )


# --- files ---


@makers
@pytest.mark.parametrize("suffix", CAD)
def test_cad_files_refuse_by_default_and_leave_no_file(
    make: Callable[[Skeleton], Any], suffix: str, tmp_path: Path
) -> None:
    with pytest.raises(BrepError, match="2 of 2 struts overlap"):
        write(make(CLOSE), tmp_path / f"close{suffix}")
    assert list(tmp_path.iterdir()) == []


@makers
@pytest.mark.parametrize("suffix", MESHES)
def test_mesh_files_unite_by_default_and_say_so_once(
    make: Callable[[Skeleton], Any],
    suffix: str,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.INFO)
    write(make(CLOSE), tmp_path / f"close{suffix}")
    assert told(caplog) == [("INFO", f"{FOUND}; they are united")]


@makers
@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".obj", ".ply"])
def test_united_mesh_files_are_one_body_that_does_not_cross_itself(
    make: Callable[[Skeleton], Any], suffix: str, tmp_path: Path
) -> None:
    write(make(CLOSE), tmp_path / f"close{suffix}")
    read = trimesh.load(tmp_path / f"close{suffix}", force="mesh")
    mesh = TriangleMesh(read.vertices, read.faces)
    mesh.check_closed()
    assert len(self_intersections(mesh)) == 0
    assert len(read.split(only_watertight=True)) == 1
    assert mesh.signed_volume == pytest.approx(to_solid(make(CLOSE)).volume(), rel=1e-4)
    area = np.pi if make is round_struts else 4.0
    assert mesh.signed_volume < area * (20 + 16)  # what both share counts once


@makers
@pytest.mark.parametrize("suffix", [".stl", ".step"])
def test_any_file_refuses_if_asked(
    make: Callable[[Skeleton], Any], suffix: str, tmp_path: Path
) -> None:
    with pytest.raises(BrepError, match="2 of 2 struts overlap"):
        write(make(CLOSE), tmp_path / f"close{suffix}", overlaps="refuse")
    write(make(TWO_STRUTS), tmp_path / f"apart{suffix}", overlaps="refuse")
    assert [path.name for path in tmp_path.iterdir()] == [f"apart{suffix}"]


@makers
def test_allowed_meshes_hold_both_bodies(
    make: Callable[[Skeleton], Any], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    write(make(CLOSE), tmp_path / "close.stl", overlaps="allow")
    assert told(caplog) == [("WARNING", f"{FOUND}: faces cross there")]
    mesh = read_triangles(tmp_path / "close.stl")
    assert mesh is not None
    assert len(self_intersections(mesh)) > 0
    area = np.pi if make is round_struts else 4.0
    assert mesh.signed_volume == pytest.approx(area * (20 + 16), rel=1e-5)


@makers
def test_cad_files_hold_what_is_allowed_or_united(
    make: Callable[[Skeleton], Any], tmp_path: Path
) -> None:
    build123d = pytest.importorskip("build123d")
    area = np.pi if make is round_struts else 4.0
    for suffix, read in ((".step", build123d.import_step), (".brep", build123d.import_brep)):
        path = tmp_path / f"close{suffix}"
        write(make(CLOSE), path, overlaps="allow")
        assert read(path).volume == pytest.approx(area * (20 + 16), rel=1e-6)
        write(make(CLOSE), path, overlaps="unite")
        united = read(path)
        assert len(united.solids()) == 1
        assert united.volume == pytest.approx(to_solid(make(CLOSE)).volume(), rel=0.005)


def test_the_rule_is_for_struts_only(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"overlaps is for a Scaffold or RoundStruts; a\.stl"):
        write(build_scaffold(STRUT).mesh, tmp_path / "a.stl", overlaps="unite")


# --- B-reps and parts ---


@makers
def test_b_reps_refuse_by_default(make: Callable[[Skeleton], Any]) -> None:
    pytest.importorskip("build123d")
    with pytest.raises(BrepError, match="2 of 2 struts overlap"):
        to_brep(make(CLOSE))


def test_b_reps_of_square_struts_that_are_united_have_plane_faces() -> None:
    build123d = pytest.importorskip("build123d")
    united = to_brep(build_scaffold(CLOSE), overlaps="unite")
    assert {face.geom_type for face in united.faces()} == {build123d.GeomType.PLANE}
    assert united.volume == pytest.approx(to_solid(build_scaffold(CLOSE)).volume(), rel=1e-6)


def test_b_reps_of_round_struts_that_are_united_have_facets_where_these_overlap_only() -> None:
    build123d = pytest.importorskip("build123d")
    united = to_brep(round_struts(CLOSE), overlaps="unite")
    cylinders = united.faces().filter_by(build123d.GeomType.CYLINDER)
    assert len(cylinders) == 4  # each strut on both sides of the crossing
    assert {cylinder.radius for cylinder in cylinders} == {1.0}
    assert united.is_valid
    assert united.volume == pytest.approx(to_solid(round_struts(CLOSE)).volume(), rel=0.005)


def test_b_reps_of_what_is_allowed_are_exact_struts() -> None:
    build123d = pytest.importorskip("build123d")
    allowed = to_brep(round_struts(CLOSE), overlaps="allow")
    assert len(allowed.faces().filter_by(build123d.GeomType.CYLINDER)) == 2


@pytest.mark.parametrize("part", ["ScaffoldSolid", "RoundStrutsSolid"])
def test_parts_follow_the_rule(part: str) -> None:
    pytest.importorskip("build123d")
    make = {"ScaffoldSolid": ScaffoldSolid, "RoundStrutsSolid": RoundStrutsSolid}[part]
    with pytest.raises(BrepError, match="2 of 2 struts overlap"):
        make(CLOSE)
    assert len(make(CLOSE, overlaps="unite").solids()) == 1
    assert len(make(CLOSE, overlaps="allow").solids()) == 2


@makers
def test_what_is_checked_is_united(make: Callable[[Skeleton], Any]) -> None:
    report = check_printability(make(CLOSE))
    assert report["self_intersections"].verdict == "ok"
    assert report["components"].value["count"] == 1


# --- the command line ---


@pytest.fixture
def close(tmp_path: Path) -> str:
    write(CLOSE, tmp_path / "close.json")
    return str(tmp_path / "close.json")


@pytest.mark.parametrize("options", [[], ["--round"]], ids=MAKERS)
def test_the_command_line_follows_the_rule(
    options: list[str], close: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["build", close, *options, "-o"]
    assert main([*command, str(tmp_path / "a.stl")]) == 0
    assert capsys.readouterr().err.count(f"{FOUND}; they are united") == 1
    assert main([*command, str(tmp_path / "a.step")]) == 2
    assert f"{FOUND}: faces would cross" in capsys.readouterr().err
    assert main([*command, str(tmp_path / "b.stl"), "--overlaps", "refuse"]) == 2
    assert f"{FOUND}: faces would cross" in capsys.readouterr().err
    assert main([*command, str(tmp_path / "b.step"), "--overlaps", "allow"]) == 0
    assert capsys.readouterr().err.count(f"{FOUND}: faces cross there") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.stl", "b.step", "close.json"]


def test_one_strut_that_overlaps_is_told_as_one() -> None:
    told = described(np.array([0]), CLOSE)
    assert told.startswith(
        "1 of 2 struts overlaps others or their nodes (edge 0; near [10, 0, 0] mm)"
    )


def test_voids_that_are_filled_are_told_once(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "scaffold_cad")
    to_solid(round_struts(tile("sc", 5.0, 1, radius=2.2)))
    assert caplog.text.count("voids between overlapping struts are filled: 1 of ") == 1
