"""What the README shows works as it stands: programs, commands, links, and the JSON format."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from build123d import GeomType, import_step

from scaffold_cad import cells, read_skeleton
from scaffold_cad.cli import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", ROOT / "examples" / "README.md"]


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.DOTALL | re.MULTILINE)


def commands() -> list[str]:
    steps = [
        step for block in blocks("sh") for line in block.splitlines() for step in line.split("&&")
    ]
    return [step.strip() for step in steps if step.strip().startswith("scaffold-cad ")]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that has the examples of the repository but may be written to."""
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("program", blocks("python"), ids=["first", "api", "build123d"])
def test_program_runs_and_writes_what_it_names(program: str, checkout: Path) -> None:
    exec(compile(program, "README.md", "exec"), {})
    named = re.findall(r'write\(.*"([\w.]+)"\)', program)
    assert named
    for name in named:
        assert (checkout / name).stat().st_size > 0


def test_first_program_makes_true_cylinders(checkout: Path) -> None:
    program = blocks("python")[0]
    assert len(program.strip().splitlines()) <= 10
    exec(compile(program, "README.md", "exec"), {})
    solid = import_step(checkout / "node.step")
    assert solid.is_valid
    radii = sorted(face.radius for face in solid.faces().filter_by(GeomType.CYLINDER))
    np.testing.assert_allclose(np.unique(np.round(radii, 6)), [9, 14, 16, 17.5], rtol=1e-6)


@pytest.mark.parametrize("command", commands())
def test_command_succeeds_and_writes_its_file(
    command: str, checkout: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = shlex.split(command)
    assert main(words[1:]) == 0
    if "-o" in words:
        assert (checkout / words[words.index("-o") + 1]).stat().st_size > 0
    else:
        assert capsys.readouterr().out


def test_json_shown_is_read(tmp_path: Path) -> None:
    (shown,) = blocks("json")
    path = tmp_path / "shown.json"
    path.write_text(shown, encoding="utf-8")
    skeleton = read_skeleton(path, strict=True)
    assert skeleton.radii.tolist() == [1.0, 1.5]
    assert skeleton.edge_radii.tolist() == [[0.8, 1.2]]
    path.write_text(shown.replace('"version": 2', '"version": 1'), encoding="utf-8")
    assert read_skeleton(path, strict=True).edge_radii.tolist() == [[1.0, 1.5]]


def test_as_many_cells_and_formats_as_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    named = int(re.search(r"\| (\d+) named cells", README)[1])  # type: ignore[index]
    assert len(cells()) == named
    main(["formats"])
    lines = capsys.readouterr().out.splitlines()
    read = {name for line in lines if " read " in line for name in line[23:].split(", ")}
    assert len(read) > int(re.search(r"more than (\d+) formats read", README)[1])  # type: ignore[index]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name)
def test_links_lead_to_files(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)]+)\)", text) + re.findall(r'src="([^"]+)"', text)
    local = [target for target in targets if not target.startswith("https://")]
    assert local
    assert [target for target in local if not (page.parent / target).exists()] == []
