"""The elbow of `tests.fuzz.members` in every format of engineers, chemists and graph programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.io import RawSkeleton, read_raw, read_skeleton
from scaffold_cad.skeleton.repair import largest_at_nodes
from tests.fuzz.members import APART, CORNERS, MEMBERS, sample_apart
from tests.io.test_reading import written

BALLS = [0.425, 0.425, 0.38]
"""A quarter of the van der Waals radii of carbon, carbon and oxygen."""

RADII: dict[str, list[float] | None] = {
    "members.csv": [0.5, 0.75, 0.75],
    "german.csv": [0.5, 0.75, 0.75],
    "tables.csv": [1, 1, 1],
    "path.tsv": [1, 1.5, 2],
    "tree.csv": [1, 1.5, 2],
    "rods.bdf": [0.5, 0.75, 0.75],
    "rods.nas": [0.5, 0.75, 0.75],
    "free.dat": [1, 1, 0.75],
    "text.msh": None,
    "binary.msh": None,
    "elbow.med": None,
    "graph.graphml": [0.5, 0.75, 0.75],
    "graph.gml": [1, 1.5, np.nan],
    "curves.3dm": None,
    "model.tcl": [1, 1, 1],
    "vessels.tre": [1, 1.5, 1],
    "curve.mrk.json": [1, 1.5, 2],
    "neuron.nml": [0.5, 0.5, 0.75],
    "node_link.json": [0.5, 0.75, 0.75],
    "compas.json": [0, 0.5, 0.5],
    "points.json": [1, 1.5, 1.5],
    "pyskelton.graph": [1, 1.5, 2],
    "libigl.tgf": None,
    "plane.wire": None,
    "wire.step": None,
    "wire.stp": None,
    "wire.stpz": None,
    "wire.brep": None,
    "wire.igs": None,
    "wire.iges": None,
}
"""Radii of the nodes of each sample that holds the elbow, mm."""

MOLECULES = ["elbow.mol", "elbow.sdf", "extended.sd", "elbow.mol2", "elbow.pdb", "bare.ent"]

REPORTED = {
    "art.svg": (4, 4),
    "compas_network.json": (2, 1),
    "curve.mrk.json": (3, 2),
    "lines.3dm": (3, 2),
    "members.csv": (3, 2),
    "model.tcl": (2, 1),
    "mol.mol": (3, 2),
    "mol.pdb": (2, 1),
    "networkx_nodelink.json": (2, 1),
    "nodes.csv": (3, 2),
    "truss.graphml": (3, 2),
    "truss.inp": (4, 6),
    "truss.msh": (4, 6),
    "truss.nas": (4, 6),
    "vessel.tre": (3, 2),
    "wires.brep": (3, 3),
    "wires.step": (3, 3),
}
"""Nodes and edges of files that users have."""


OF_EDGES = {
    "members.csv": [0.5, 0.75],
    "tables.csv": [1, 1],
    "rods.bdf": [0.5, 0.75],
    "free.dat": [1, 0.75],
    "graph.graphml": [0.5, 0.75],
    "model.tcl": [1, 1],
    "node_link.json": [0.5, 0.75],
    "compas.json": [np.nan, 0.5],
    "points.json": [1, 1.5],
    "elbow.mol": [0.15, 0.15],
}
"""Radii of the edges of samples whose edges have radii, mm."""


def sizes(raw: RawSkeleton) -> np.ndarray:
    """Return the radius of each node, the largest of its edges where the file has none."""
    if raw.radii is not None:
        return raw.radii
    assert raw.edge_radii is not None
    return largest_at_nodes(raw.edges, raw.edge_radii, len(raw.nodes))


def sample(folder: Path, name: str) -> RawSkeleton:
    content = sample_apart(name) if name in APART else MEMBERS[name]
    return read_raw(written(folder, name, content))


@pytest.mark.parametrize("name", RADII)
def test_an_elbow_is_read_from_every_format(tmp_path: Path, name: str) -> None:
    raw = sample(tmp_path, name)
    np.testing.assert_allclose(raw.nodes, CORNERS, atol=1e-9)
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    wanted = RADII[name]
    if wanted is None:
        assert not raw.has_radii
    else:
        np.testing.assert_allclose(sizes(raw), wanted, rtol=1e-5)


@pytest.mark.parametrize(("name", "radii"), OF_EDGES.items(), ids=str)
def test_members_keep_radii_of_their_own(tmp_path: Path, name: str, radii: list[float]) -> None:
    raw = sample(tmp_path, name)
    assert raw.edge_radii is not None
    np.testing.assert_allclose(raw.edge_radii, np.stack([radii, radii], axis=1), rtol=1e-5)


@pytest.mark.parametrize("name", MOLECULES)
def test_a_molecule_is_read_as_balls_and_sticks(tmp_path: Path, name: str) -> None:
    raw = sample(tmp_path, name)
    np.testing.assert_allclose(raw.nodes, 0.14 * CORNERS, atol=1e-12)
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.radii is not None
    np.testing.assert_allclose(raw.radii, BALLS)


@pytest.mark.parametrize(("name", "counts"), REPORTED.items(), ids=str)
def test_files_of_users_have_the_counts_of_their_table(
    shared_data: Path, name: str, counts: tuple[int, int]
) -> None:
    path = shared_data / "reported" / "formats" / name
    if not path.is_file():
        pytest.skip(f"no {name} beside the repository")
    skeleton = read_skeleton(path, 0.1)
    assert (len(skeleton.nodes), len(skeleton.edges)) == counts
