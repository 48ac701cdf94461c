"""Supports and loads as files have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, read_skeleton
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.mechanics import (
    BeamModel,
    Load,
    Loading,
    Support,
    beam_model,
    read_loading,
    write_beams,
)

TRIPOD = Skeleton(
    [[0, 0, 50], [40, 0, 0], [-20, 30, 0], [-20, -30, 0]], [[0, 1], [0, 2], [0, 3]], 2.0
)

SUPPORTS = [Support([1]), Support([2], "pinned"), Support([3], "x z", displacement=[0.0, 0.25])]
LOADS = [Load([0], (10, -20, -300), (0, 400, 0)), Load([3], (0, 50, 0))]


def model_of(path: Path, **options: str | float) -> BeamModel:
    units, scale = options.get("units"), options.get("scale")
    skeleton = read_skeleton(path, 2.0, units=units, scale=scale)
    loading = read_loading(path, skeleton, units=units, scale=scale)
    return beam_model(skeleton, "steel", loading.supports, loading.loads)


def at(model: BeamModel, place: list[float]) -> int:
    return int(np.argmin(np.linalg.norm(model.skeleton.nodes - place, axis=1)))


def written(tmp_path: Path, name: str, text: str) -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


@pytest.mark.parametrize("ending", [".inp", ".bdf", ".tcl"])
def test_what_was_written_comes_back(ending: str, tmp_path: Path) -> None:
    model = beam_model(TRIPOD, "steel", SUPPORTS, LOADS)
    path = tmp_path / f"tripod{ending}"
    write_beams(model, path)
    again = model_of(path)
    rows = [at(again, place) for place in TRIPOD.nodes.tolist()]
    np.testing.assert_array_equal(again.fixed[rows], model.fixed)
    np.testing.assert_allclose(again.displacement[rows], model.displacement, atol=1e-9)
    np.testing.assert_allclose(again.forces[rows], model.forces, rtol=1e-6)
    assert again.fixed.sum() == model.fixed.sum()
    assert read_skeleton(path).edge_radii == pytest.approx(2.0, rel=1e-6)
    # A node in the middle of CalculiX's beams makes two struts of each.
    assert again.solved().displacements[rows[0]] == pytest.approx(
        model.solved().displacements[0], rel=1e-6
    )


ABAQUS = """*HEADING
*PART, NAME=Arm
*NODE, NSET=Every
1, 0, 0, 0
2, 50, 0, 0
3, 100, 0, 0
*NSET, NSET=Root
1
*ELEMENT, TYPE=B31, ELSET=Bars
1, 1, 2
2, 2, 3
*BEAM SECTION, ELSET=Bars, MATERIAL=M, SECTION=CIRC
4.0
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=One, PART=Arm
0, 10, 0
*END INSTANCE
*NSET, NSET=Tip, INSTANCE=One
3
*END ASSEMBLY
*BOUNDARY
One.Root, ENCASTRE
*STEP
*STATIC
*BOUNDARY
One.2, 2, 3
*CLOAD
Tip, 2, -100.
Tip, 6, 250.
*END STEP
*STEP
*CLOAD
Tip, 1, 1.0
*END STEP
"""


def test_abaqus_names_nodes_by_sets_and_instances(tmp_path: Path) -> None:
    model = model_of(written(tmp_path, "arm.inp", ABAQUS))
    root, middle, tip = (at(model, [x, 10, 0]) for x in (0, 50, 100))
    assert model.fixed[root].all()
    assert np.flatnonzero(model.fixed[middle]).tolist() == [1, 2]
    assert not model.fixed[tip].any()
    assert model.forces[tip].tolist() == [0, -100, 0, 0, 0, 250]  # of the first step only
    assert np.flatnonzero(model.forces.any(axis=1)).tolist() == [tip]


NASTRAN = """SOL 101
CEND
SPC = 7
LOAD = 9
BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,50.,0.,0.,,3
GRID,3,,100.,0.,0.
CBAR,1,1,1,2,0.,0.,1.
CBAR,2,1,2,3,0.,0.,1.
PBARL,1,1,,ROD
,4.
SPC1,1,123456,1,THRU,3
SPC,2,3,2,0.5
SPCADD,7,2,3
SPC1,3,123456,1
LOAD,9,2.0,3.0,4,1.0,5
FORCE,4,3,0,10.,0.,0.,-1.
MOMENT,5,2,,7.,1.,0.,0.
FORCE,6,3,0,99.,1.,0.,0.
ENDDATA
"""


def test_nastran_counts_what_the_case_control_selects(tmp_path: Path) -> None:
    model = model_of(written(tmp_path, "arm.bdf", NASTRAN))
    assert [np.flatnonzero(row).tolist() for row in model.fixed] == [list(range(6)), [2], [1]]
    assert model.displacement[2, 1] == 0.5
    assert model.forces[2].tolist() == [0, 0, -60, 0, 0, 0]
    assert model.forces[1].tolist() == [0, 0, 0, 14, 0, 0]


PLANE = """model BasicBuilder -ndm 2 -ndf 3
node 1 0 0
node 2 30 40
element elasticBeamColumn 1 1 2 12.566 210e3 12.566 1
fix 1 1 1 1
pattern Plain 1 Linear { load 2 5 -6 7 }
"""


def test_a_model_in_a_plane_stays_in_it(tmp_path: Path) -> None:
    model = model_of(written(tmp_path, "plane.tcl", PLANE))
    assert [np.flatnonzero(row).tolist() for row in model.fixed] == [list(range(6)), [2, 3, 4]]
    assert model.forces[1].tolist() == [5, -6, 0, 0, 0, 7]


def test_lengths_of_loads_follow_the_units(tmp_path: Path) -> None:
    text = ABAQUS.replace("One.2, 2, 3", "One.2, 2, 2, 0.5\nOne.2, 6, 6, 0.01")
    model = model_of(written(tmp_path, "arm.inp", text), units="cm", scale=2.0)
    tip, middle = at(model, [2000, 200, 0]), at(model, [1000, 200, 0])
    assert model.forces[tip].tolist() == [0, -100, 0, 0, 0, 5000]
    assert model.displacement[middle].tolist() == [0, 10, 0, 0, 0, 0.01]


def test_welded_nodes_share_their_loads(tmp_path: Path) -> None:
    text = PLANE.replace(
        "pattern", "node 3 30 40\nelement truss 2 1 3 1.0 1\nload 3 1 0 0\npattern"
    )
    path = written(tmp_path, "plane.tcl", text.replace("node 1 0 0", "node 1 0 0\nnode 4 9 0"))
    skeleton = read_skeleton(path, 1.0)
    loading = read_loading(path, skeleton)
    model = beam_model(skeleton, "steel", loading.supports, loading.loads)
    assert model.forces[at(model, [30, 40, 0])].tolist() == [6, -6, 0, 0, 0, 7]


def test_a_file_without_supports_has_none(tmp_path: Path) -> None:
    path = written(tmp_path, "strut.obj", "v 0 0 0\nv 9 0 0\nl 1 2\n")
    assert read_loading(path, read_skeleton(path, 1.0)).supports == ()
    assert isinstance(read_loading(path, read_skeleton(path, 1.0)), Loading)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.inp", ABAQUS.replace("One.Root", "Two.Root"), r"nodes 'Two.Root'; need a"),
        ("a.inp", ABAQUS.replace("One.2, 2, 3", "One.8, 2"), r"a support is on node .*8"),
        ("a.inp", ABAQUS.replace("Tip, 2, -100.", "Tip, 2"), r"a node or a set, then"),
        ("a.inp", ABAQUS.replace("INSTANCE=One\n3", "INSTANCE=Two\n3"), r"a set of nodes of an"),
        ("a.bdf", NASTRAN.replace("SPC,2,3,2,0.5", "SPC,2,3,8,0.5"), r"freedoms such as 123"),
        ("a.bdf", NASTRAN.replace("FORCE,4,3,0", "FORCE,4,3,5"), r"a FORCE in the system 5"),
        ("a.bdf", NASTRAN.replace("MOMENT,5,2", "MOMENT,5,77"), r"a load is on node 77"),
        ("a.bdf", NASTRAN.replace("SPC1,1,123456,1,THRU,3", "SPC1,2,1,1,THRU,3000000"), r"at most"),
        ("a.tcl", PLANE.replace("5 -6 7", "5 -6 7 8"), r"a number for each freedom"),
        ("a.tcl", PLANE + "sp 2 4 0.1\n", r"need sp, a node, a freedom, a number"),
        ("a.tcl", PLANE.replace("5 -6 7", "5 -6 1e13"), r"has the load"),
    ],
)  # fmt: skip
def test_faulty_supports_and_loads_are_refused(
    name: str, text: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(FormatError, match=message):
        read_skeleton(written(tmp_path, name, text), 1.0)


def test_another_skeleton_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "plane.tcl", PLANE)
    with pytest.raises(FormatError, match=r"at \[0.0, 0.0, 0.0\] mm, where the skeleton has no n"):
        read_loading(path, TRIPOD)
    with pytest.raises(OptionError, match=r"skeleton is 'plane.tcl'; need a Skeleton"):
        read_loading(path, "plane.tcl")  # type: ignore[arg-type]
