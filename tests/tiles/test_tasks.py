"""Works on tiles: files whole or missing, runs resumed, and one file of all as of the whole."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from joblib import parallel_config

from scaffold_cad import (
    PeriodicLattice,
    Skeleton,
    build_scaffold,
    round_struts,
    voronoi_foam,
    write,
)
from scaffold_cad.errors import FormatError, MeshError
from scaffold_cad.io import read_triangles
from scaffold_cad.printability.gaps import free_ends
from scaffold_cad.printability.processes import PROCESSES
from scaffold_cad.printability.struts import strut_findings
from scaffold_cad.printability.thickness import thickness_asked
from scaffold_cad.tiles import Build, Check, Tile, run_tiles, tiles
from tests.tiles.test_tiling import in_order

LATTICE = PeriodicLattice("bcc", 6.0, (3, 2, 2), radius=0.4)


def facets(path: Path) -> np.ndarray:
    """Return the triangles of a binary STL file, in an order of their own."""
    return in_order(read_triangles(path).vertices.reshape(-1, 3, 3))


@pytest.mark.parametrize("collars", [False, True])
def test_triangles_of_all_tiles_are_those_of_the_whole(collars: bool, tmp_path: Path) -> None:
    foam = voronoi_foam(40, [[0, 0, 0], [30, 30, 30]], 0.3, seed=5)
    for number, whole in enumerate((LATTICE.skeleton(), foam)):
        work = Build(options={"collars": collars}, overlaps="allow")
        block = 2 if number == 0 else 14.0
        parts = tiles(LATTICE if number == 0 else foam, block=block)
        run_tiles(parts, work, tmp_path / f"{number}").joined(work, tmp_path / "tiles.stl")
        write(build_scaffold(whole, collars=collars), tmp_path / "whole.stl", overlaps="allow")
        np.testing.assert_array_equal(
            facets(tmp_path / "tiles.stl"), facets(tmp_path / "whole.stl")
        )


def test_round_triangles_of_all_tiles_are_those_of_the_whole(tmp_path: Path) -> None:
    lattice = PeriodicLattice("kelvin", 8.0, (2, 2, 1), radius=0.3, blend=0.25, ends="round")
    work = Build(round=True, sides=8)
    run_tiles(tiles(lattice, block=1), work, tmp_path).joined(work, tmp_path / "tiles.stl")
    whole = round_struts(lattice.skeleton(), **lattice.strut_options)
    write(whole, tmp_path / "whole.stl", sides=8)
    np.testing.assert_array_equal(facets(tmp_path / "tiles.stl"), facets(tmp_path / "whole.stl"))
    read_triangles(tmp_path / "tiles.stl")


def test_processes_give_the_bytes_of_one(tmp_path: Path) -> None:
    parts, work = tiles(LATTICE, block=1), Build()
    alone = run_tiles(parts, work, tmp_path / "alone")
    with parallel_config(backend="loky", n_jobs=2):
        both = run_tiles(parts, work, tmp_path / "both")
    assert alone.files == both.files
    for name in ("alone", "both"):
        run_tiles(parts, work, tmp_path / name).joined(work, tmp_path / f"{name}.stl")
    assert (tmp_path / "alone.stl").read_bytes() == (tmp_path / "both.stl").read_bytes()


def test_a_folder_is_one_of_the_caller_wherever_processes_began(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("first", "second"):  # processes are kept from one run to the next
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        with parallel_config(backend="loky", n_jobs=2):
            made = run_tiles(tiles(LATTICE, block=1), Build(), "parts")
        assert all((tmp_path / name / "parts" / file.name).is_file() for file in made.files)


@dataclass(frozen=True)
class Failing:
    """A work that ends at a tile, as a full disk or a kill would."""

    at: int
    suffix = ".txt"

    def made(self, tile: Tile) -> bytes:
        if tile.number == self.at:
            raise MemoryError
        return str(tile.own.sum()).encode()

    def join(self, files: Any, path: Path) -> None:
        path.write_bytes(b"".join(file.read_bytes() for file in files))


def times(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("tile-*")}


def test_what_is_there_is_not_made_again(tmp_path: Path) -> None:
    parts = tiles(LATTICE, block=1)
    with pytest.raises(MemoryError):
        run_tiles(parts, Failing(at=5), tmp_path)
    assert len(list(tmp_path.glob("*.done"))) == 5
    assert not (tmp_path / "manifest.json").exists()
    run_tiles(parts, Build(), tmp_path / "other")
    before = times(tmp_path / "other")
    (tmp_path / "other" / "tile-000003.stl").write_bytes(b"spoiled")
    (tmp_path / "other" / "tile-000004.done").unlink()
    manifest = run_tiles(parts, Build(), tmp_path / "other")
    after = times(tmp_path / "other")
    changed = {name for name in before if before[name] != after[name]}
    again = {f"tile-00000{k}.{suffix}" for k in (3, 4) for suffix in ("stl", "done")}
    assert changed == again
    manifest.joined(Build(), tmp_path / "all.stl")


def test_another_work_or_other_struts_are_made_anew(tmp_path: Path) -> None:
    parts = tiles(LATTICE, block=2)
    first = run_tiles(parts, Build(), tmp_path)
    len(parts)  # what is kept of an answer is not a part of the key
    assert run_tiles(tiles(LATTICE, block=2), Build(), tmp_path).key == first.key
    assert run_tiles(parts, Build(options={"collars": True}), tmp_path).key != first.key
    thicker = PeriodicLattice("bcc", 6.0, (3, 2, 2), radius=0.5)
    assert run_tiles(tiles(thicker, block=2), Build(), tmp_path).key != first.key


def test_the_manifest_names_each_file_and_its_hash(tmp_path: Path) -> None:
    manifest = run_tiles(tiles(LATTICE, block=2), Build(), tmp_path)
    found = json.loads((tmp_path / "manifest.json").read_text("utf-8"))
    assert found["key"] == manifest.key
    assert [file["name"] for file in found["tiles"]] == ["tile-000000.stl", "tile-000001.stl"]
    assert all(len(file["sha256"]) == 64 for file in found["tiles"])


def test_a_changed_file_is_not_joined(tmp_path: Path) -> None:
    manifest = run_tiles(tiles(LATTICE, block=2), Build(), tmp_path)
    (tmp_path / "tile-000001.stl").write_bytes(b"spoiled")
    with pytest.raises(FormatError, match=r"tile-000001.stl is missing or was changed"):
        manifest.joined(Build(), tmp_path / "all.stl")
    assert not (tmp_path / "all.stl").exists()


def test_struts_that_overlap_are_refused(tmp_path: Path) -> None:
    thick = PeriodicLattice("bcc", 6.0, 2, radius=2.5)
    with pytest.raises(MeshError, match=r"struts overlap .*; need struts apart where tiles"):
        run_tiles(tiles(thick, block=1), Build(), tmp_path)
    crossing = Skeleton([[-9, 0, 0], [9, 0, 0], [0, -9, 1], [0, 9, 1]], [[0, 1], [2, 3]], 0.8)
    for work in (Build(), Build(round=True)):
        with pytest.raises(MeshError, match=r"1 of 2 struts overlaps .* need struts apart"):
            run_tiles(tiles(crossing, block=0.5), work, tmp_path)


def test_findings_of_all_tiles_are_those_of_the_whole(tmp_path: Path) -> None:
    foam = voronoi_foam(60, [[0, 0, 0], [20, 20, 20]], 0.2, seed=5)
    work = Check("sls")
    run_tiles(tiles(foam, block=7.0), work, tmp_path).joined(work, tmp_path / "all.json")
    found = json.loads((tmp_path / "all.json").read_text("utf-8"))
    findings = strut_findings(foam, thickness_asked(foam), PROCESSES["sls"], free_ends(foam))
    wanted = {one.name: one.value for one in findings}
    assert found["struts"] == len(foam.edges)
    assert found["thin"] == wanted["strut_diameter"]["thin"]
    assert found["least_diameter_mm"] == wanted["strut_diameter"]["least_mm"]
    assert found["greatest_slenderness"] == wanted["slenderness"]["greatest"]
    assert found["narrow_gaps"] == wanted["strut_gap"]["narrow"]
    assert found["touching"] == wanted["strut_gap"]["overlapping"]
    assert found["least_gap_mm"] == wanted["strut_gap"]["least_mm"]
    embedded = build_scaffold(foam).embedding()
    broken = ~(embedded.within_cone.all(axis=1) & embedded.uncrossed)
    broken[embedded.conflicts] = True
    assert found["overlapping"] == broken.sum()
