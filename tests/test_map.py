"""The map in CONTRIBUTING leads to modules that are there, and to what they are said to hold."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests import wings

DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef
PACKAGE = wings.ROOT / "scaffold_cad"
PAGE = (wings.ROOT / ".github" / "CONTRIBUTING.md").read_text("utf-8")

WORDS = {
    "fallback": (
        "partition/lune.py",
        "solid/solid.py",
        "solid/clusters/surface.py",
        "solid/field/solid.py",
    ),
    "radius compensation": ("struts/meshes/bands.py",),
    "compensation": ("struts/meshes/volumes.py", "struts/meshes/lifts.py", "layers/rounds.py"),
    "tolerance": ("brep/occt.py", "skeleton/thinning.py", "skeleton/joining.py"),
}
"""Words that people look for, and modules whose docstrings have them."""


def rows() -> dict[str, str]:
    """Return the right column of the table of places by the left one."""
    table = PAGE.split("| … | there |\n|---|---|\n")[1].split("\n\n")[0]
    return dict(re.findall(r"^\| (.+?) \| (.+) \|$", table, flags=re.MULTILINE))


ROWS = rows()


def places(text: str) -> list[tuple[str, list[str]]]:
    """Return the paths that a cell names, each with the names that follow it after a colon."""
    found = re.findall(r"`([\w*/]+(?:\.py|/))`(?:: ((?:`\w+`(?:, )?)+))?", text)
    return [(path, re.findall(r"\w+", names)) for path, names in found]


def defined(path: Path) -> set[str]:
    """Return the functions, classes and types that a module defines."""
    body = ast.parse(path.read_text("utf-8")).body
    named = {one.name for one in body if isinstance(one, ast.FunctionDef | ast.ClassDef)}
    return named | {ast.unparse(one.target) for one in body if isinstance(one, ast.AnnAssign)}


@pytest.mark.parametrize("what", ROWS)
def test_a_row_of_the_map_leads_to_what_it_names(what: str) -> None:
    text = ROWS[what]
    for path, names in places(text):
        assert list(PACKAGE.glob(path)), path
        if path.endswith(".py") and "*" not in path:
            named = names or path.startswith("io/")  # a format's module has one subject
            assert named, f"{path} without a name in it"
            assert set(names) <= defined(PACKAGE / path), path
    spans = re.findall(r"`([^`]+)`", text)
    known = {word for path, names in places(text) for word in [path, *names]}
    assert set(spans) - known <= {"tests/benchmarks"}


def test_every_wing_has_a_row() -> None:
    named = {
        path.split("/")[0].removesuffix(".py") for text in ROWS.values() for path, _ in places(text)
    }
    # What they hold is their one sentence: shown, drawn, made for build123d, edited, convolved.
    assert set(wings.FLOOR_OF) - named <= {"viewers", "parts", "skeleton", "convolution"}


@pytest.mark.parametrize("word", WORDS)
def test_words_that_people_look_for_stand_in_docstrings(word: str) -> None:
    for path in WORDS[word]:
        texts = ast.walk(ast.parse((PACKAGE / path).read_text("utf-8")))
        docs = [ast.get_docstring(one) or "" for one in texts if isinstance(one, DOCUMENTED)]
        assert any(word in " ".join(doc.split()).lower() for doc in docs), path


def test_every_program_of_validation_is_named() -> None:
    programs = [
        path.stem
        for path in (wings.ROOT / "tests" / "validation").glob("*.py")
        if "__main__" in path.read_text("utf-8")
    ]
    named = re.findall(r"`(?:python -m tests\.validation|\.\.\.) ?\.(\w+)`", PAGE)
    assert [name for name in programs if name not in named] == []


@pytest.mark.parametrize("script", ["tuning", "gains", "recipes", "remeshing", "quarter"])
def test_tuned_numbers_name_the_script_that_makes_them(script: str) -> None:
    name = f"tests.benchmarks.{script}"
    texts = [path.read_text("utf-8") for path in wings.modules().values()]
    assert any(name in " ".join(text.split()) for text in texts)
    assert (wings.ROOT / "tests" / "benchmarks" / f"{script}.py").exists()
    assert name in PAGE or f"`... .{script}`" in PAGE
