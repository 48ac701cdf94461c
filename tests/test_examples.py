"""Every example runs, says what it writes, and what it writes is a solid."""

from __future__ import annotations

import runpy
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from scaffold_cad import (
    QuadMesh,
    TriangleMesh,
    build_scaffold,
    rotation_minimizing_frames,
    self_intersections,
    to_solid,
)
from scaffold_cad.base.arrays import Floats
from tests.io.test_stacks import area, read_binary_cli

EXAMPLES = Path(__file__).parents[1] / "examples"
SCRIPTS = sorted(path.stem for path in EXAMPLES.glob("[!_]*.py"))


@pytest.mark.parametrize("name", SCRIPTS)
def test_example_writes_solids_and_says_so(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    monkeypatch.setattr("sys.argv", [name, "--out", str(tmp_path / "out")])
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    written = sorted((tmp_path / "out").iterdir())
    assert written
    said = capsys.readouterr().out
    for path in written:
        assert str(path) in said
        CHECKS[path.suffix](path)


def check_stl(path: Path) -> None:
    """Watertight, outward, and nowhere crossing itself."""
    import trimesh

    mesh = trimesh.load_mesh(path)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    surface = TriangleMesh(mesh.vertices, mesh.faces)
    assert to_solid(surface).volume() == pytest.approx(mesh.volume)
    assert len(self_intersections(surface)) == 0


def check_step(path: Path) -> None:
    """One valid solid."""
    import build123d
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    shape = build123d.import_step(path)
    (solid,) = shape.solids()
    assert solid.is_valid
    assert all(shell.wrapped.Closed() for shell in solid.shells())
    roughly = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid.wrapped, roughly, 1e-2)  # blends take long otherwise
    assert roughly.Mass() > 0


def check_cli(path: Path) -> None:
    """Layers with polygons around something."""
    layers = read_binary_cli(path)
    assert layers
    assert all(area(polygons) > 0 for _, polygons, _ in layers)


def check_svg(path: Path) -> None:
    """A drawing with a path a layer."""
    paths = ElementTree.parse(path).getroot().findall("{*}g/{*}path")
    assert paths
    assert all(one.attrib["d"] for one in paths)


CHECKS = {".stl": check_stl, ".step": check_step, ".cli": check_cli, ".svg": check_svg}


def test_every_skeleton_is_used_by_an_example() -> None:
    code = "\n".join(path.read_text(encoding="utf-8") for path in EXAMPLES.rglob("*.py"))
    names = [path.stem for path in (EXAMPLES / "skeletons").glob("*.json")]
    assert names
    assert [name for name in names if f'"{name}' not in code] == []


def test_section_is_carried_untwisted_or_turned_evenly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    twist = runpy.run_path(str(EXAMPLES / "twist.py"))
    scaffold = build_scaffold(twist["skeleton"]("bend"))
    joints = scaffold.skeleton.joints
    nodes = scaffold.skeleton.nodes[joints]
    frames = rotation_minimizing_frames(nodes)
    first = [np.flatnonzero(scaffold.node_of_vertex == joint)[0] for joint in joints]

    def angles(mesh: QuadMesh) -> Floats:
        x, y, _ = np.einsum("nij,nj->in", frames, mesh.vertices[first] - nodes)
        return np.unwrap(np.arctan2(y, x))

    assert np.ptp(angles(twist["with_twist_in_last_row"](scaffold))) < 1e-9
    turns = np.diff(angles(scaffold.mesh))
    share = scaffold.skeleton.lengths[1:-5].sum() / scaffold.skeleton.lengths[:-4].sum()
    assert abs(turns.sum()) == pytest.approx(share * np.abs(scaffold.twist).max(), rel=0.1)
    assert (np.sign(turns) == np.sign(turns[0])).all()
