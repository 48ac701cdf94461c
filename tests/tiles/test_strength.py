"""What struts of tiles carry is what they carry in the whole."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from joblib import parallel_config

from scaffold_cad import PeriodicLattice, Skeleton, voronoi_foam
from scaffold_cad.base.arrays import Bools, Points
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics import Between, Load, Support, beam_model
from scaffold_cad.tiles import (
    LatticeTiles,
    LoadCase,
    SkeletonTiles,
    Stiffness,
    Strength,
    run_tiles,
    tiles,
)
from scaffold_cad.tiles.strength import COLUMNS

LATTICE = PeriodicLattice("bcc", 6.0, (4, 3, 2), radius=0.4)


def low(nodes: Points) -> Bools:
    return np.asarray(nodes[:, 2] < 0.5)


def high(nodes: Points) -> Bools:
    return np.asarray(nodes[:, 2] > 11.5)


def nowhere(nodes: Points) -> Bools:
    return np.asarray(nodes[:, 2] > 1e6)


CASE = LoadCase(
    "pa12",
    (Support(low), Support(high, "x", displacement=0.02)),
    (Load(high, force=(0, 0, -300)), Load(high, moment=(0, 0, 5), each=True)),
    gravity=(0.0, 0.0, -9.81),
)


def rows_of(
    parts: SkeletonTiles | LatticeTiles, case: LoadCase, folder: Path
) -> tuple[np.ndarray, Path]:
    """Return what is known of all struts, in an order of their own, and where the summary is."""
    stiffness = Stiffness(case)
    run_tiles(parts, stiffness, folder / "stiffness").joined(stiffness, folder / "moved.bin")
    strength = Strength(case, str(folder / "moved.bin"))
    manifest = run_tiles(parts, strength, folder / "strength")
    manifest.joined(strength, folder / "all.npy")
    manifest.joined(strength, folder / "all.json")
    found = np.load(folder / "all.npy")
    return found[np.lexsort(found[:, :6].T)], folder / "all.json"


def wanted_rows(skeleton: Skeleton, case: LoadCase) -> np.ndarray:
    solution = beam_model(
        skeleton, case.material, case.supports, case.loads, gravity=case.gravity, hollow=case.hollow
    ).solved()
    edges = skeleton.edges
    ways = np.linalg.norm(solution.displacements, axis=1)[edges]
    carried = [solution.stresses, solution.buckling_utilization, solution.utilization]
    ends = skeleton.nodes[edges].reshape(-1, 6)
    parts = [ends, skeleton.edge_radii, ways, solution.axial, np.stack(carried, axis=1)]
    found = np.concatenate(parts, axis=1)
    return found[np.lexsort(found[:, :6].T)]


def check_same(found: np.ndarray, wanted: np.ndarray, share: float) -> None:
    assert found.shape == wanted.shape == (len(wanted), len(COLUMNS))
    np.testing.assert_array_equal(found[:, :8], wanted[:, :8])
    largest = np.abs(wanted).max(axis=0)
    assert (np.abs(found - wanted)[:, 8:] <= share * largest[8:]).all()


@pytest.mark.parametrize("hollow", [0.0, 0.6])
def test_struts_of_a_lattice_carry_what_they_carry_in_the_whole(
    hollow: float, tmp_path: Path
) -> None:
    case = replace(CASE, hollow=hollow)
    found, summary = rows_of(tiles(LATTICE, block=(2, 2, 1)), case, tmp_path)
    wanted = wanted_rows(LATTICE.skeleton(), case)
    check_same(found, wanted, 1e-9)
    told = json.loads(summary.read_text("utf-8"))
    assert told["struts"] == len(wanted)
    assert told["largest_stress_MPa"] == pytest.approx(wanted[:, -3].max(), rel=1e-9)
    assert told["utilization"] == told["most_used"][0]["utilization"]
    assert told["overloaded_struts"] == (wanted[:, -1] > 1).sum()


def test_struts_of_a_foam_carry_what_they_carry_in_the_whole(tmp_path: Path) -> None:
    foam = voronoi_foam(80, [[0, 0, 0], [12, 12, 12]], 0.2, seed=5)
    found, _ = rows_of(tiles(foam, block=5.0), CASE, tmp_path)
    check_same(found, wanted_rows(foam, CASE), 1e-9)


def test_equations_too_many_to_be_factored_agree_to_the_residual(tmp_path: Path) -> None:
    lattice = PeriodicLattice("bcc", 2.0, (12, 12, 6), radius=0.2)
    case = LoadCase("steel", (Support(low),), (Load(high, force=(0, 50, -300)),))
    found, _ = rows_of(tiles(lattice, block=6), case, tmp_path)
    check_same(found, wanted_rows(lattice.skeleton(), case), 1e-7)


def test_another_solution_is_another_work(tmp_path: Path) -> None:
    parts = tiles(LATTICE, block=2)
    first, _ = rows_of(parts, CASE, tmp_path)
    with parallel_config(backend="loky", n_jobs=2):
        again, _ = rows_of(parts, CASE, tmp_path)
    np.testing.assert_array_equal(again, first)
    (harder,) = (replace(CASE, loads=(Load(high, force=(0, 0, -600)),)),)
    other, _ = rows_of(parts, harder, tmp_path)
    assert other[:, -1].max() > 1.2 * first[:, -1].max()
    between = replace(CASE, supports=(Support(Between("z", high=0.5)), CASE.supports[1]))
    same, _ = rows_of(parts, between, tmp_path)
    np.testing.assert_array_equal(same, first)


def test_what_tiles_cannot_know_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="names nodes by number, which tiles do not know"):
        LoadCase("steel", (Support([0, 1]),))
    parts = tiles(LATTICE, block=2)
    idle = LoadCase("steel", (Support(low),), (Load(nowhere, force=(1, 0, 0)),))
    manifest = run_tiles(parts, Stiffness(idle), tmp_path / "idle")
    with pytest.raises(OptionError, match="load 0 is on no node"):
        manifest.joined(Stiffness(idle), tmp_path / "moved.bin")
    loose = LoadCase("steel", (Support(low, "z"),), (Load(high, force=(1, 0, 0)),))
    manifest = run_tiles(parts, Stiffness(loose), tmp_path / "loose")
    with pytest.raises(OptionError, match=r"can still move .*need all 6"):
        manifest.joined(Stiffness(loose), tmp_path / "moved.bin")
