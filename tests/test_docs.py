"""What the pages of the documentation show works as it stands, and the site builds."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

import scaffold_cad
from scaffold_cad.cli import main
from scaffold_cad.io import register
from scaffold_cad.lattice import registry

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
CONFIGURATION = DOCS / "site" / "mkdocs.yml"
PAGES = sorted(DOCS.rglob("*.md"))

SHOWN_APART = ("formats.md", "reliability.md", "hour.md")
"""Pages whose programs are not whole ones, or each one by itself."""


def name(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


def steps(page: Path) -> list[tuple[str, str]]:
    """Return the language and text of each program and command of a page, in order."""
    blocks = re.findall(
        r"^```(python|sh)\n(.*?)^```$", page.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE
    )
    return [(language, text) for language, text in blocks if text.strip()]


RUNNABLE = [page for page in PAGES if steps(page) and page.name not in SHOWN_APART]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with what pages read; what they register is forgotten."""
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(register, "_formats", list(register._formats))
    monkeypatch.setattr(registry, "_CELLS", dict(registry._CELLS))
    return tmp_path


@pytest.mark.parametrize("page", RUNNABLE, ids=name)
def test_programs_and_commands_of_a_page_work_in_turn(page: Path, folder: Path) -> None:
    names: dict[str, object] = {}
    for language, text in steps(page):
        if language == "python":
            exec(compile(text, str(page), "exec"), names)
            continue
        for line in text.strip().splitlines():
            words = shlex.split(line)
            assert words[0] == "scaffold-cad", line
            assert main(words[1:]) == 0, line
            for option in ("-o", "--html"):
                if option in words:
                    assert (folder / words[words.index(option) + 1]).stat().st_size > 0


def test_the_tasks_of_the_first_hour_are_twelve_short_programs() -> None:
    programs = [text for _, text in steps(DOCS / "hour.md")]
    assert len(programs) == 12
    assert max(len(text.strip().splitlines()) for text in programs) <= 15


def test_each_task_of_the_first_hour_is_a_whole_program(folder: Path) -> None:
    for _, text in steps(DOCS / "hour.md"):
        exec(compile(text, "hour.md", "exec"), {})
        written = re.findall(r'"([\w{}]+\.(?:stl|step|3mf|obj|png))"', text)
        for pattern in written:
            assert list(folder.glob(re.sub(r"{\w+}", "*", pattern)))
    made = list(folder.glob("*.*"))
    assert len(made) >= 10
    assert all(file.stat().st_size > 0 for file in made)


def test_most_pages_show_something_that_runs() -> None:
    shown = {name(page) for page in RUNNABLE}
    assert {"index.md", "concepts.md", "options.md", "lattices.md", "extending.md"} <= shown


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_to_pages_and_pictures(page: Path) -> None:
    targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    local = [target for target in targets if not target.startswith("https://")]
    assert [target for target in local if not (page.parent / target).exists()] == []


def test_every_page_has_its_place_in_the_site() -> None:
    configuration = CONFIGURATION.read_text(encoding="utf-8")
    assert [name(page) for page in PAGES if f" {name(page)}\n" not in configuration] == []


def test_every_public_name_is_in_the_reference() -> None:
    reference = "".join(page.read_text(encoding="utf-8") for page in (DOCS / "api").glob("*.md"))
    listed = {line.split(".")[-1] for line in reference.splitlines() if line.startswith("::: ")}
    assert [name for name in scaffold_cad.__all__ if name not in listed] == []


@pytest.mark.skipif(
    not all(map(find_spec, ("mkdocs", "material", "mkdocstrings"))),
    reason="needs the extra docs",
)
def test_the_site_builds_without_warnings(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(CONFIGURATION)]
    built = subprocess.run(
        [*command, "-d", str(tmp_path / "site")], capture_output=True, encoding="utf-8", check=False
    )
    assert built.returncode == 0, built.stderr
    assert "does not contain an anchor" not in built.stderr
    reference = (tmp_path / "site" / "api" / "core.html").read_text(encoding="utf-8")
    assert "as <code>check_skeleton</code> asks" in reference
