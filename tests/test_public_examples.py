"""Each public name shows an example in its docstring, and all examples of docstrings run."""

from __future__ import annotations

import doctest
import inspect
from importlib import import_module
from importlib.util import find_spec

import pytest

import scaffold_cad
from scaffold_cad.lattice import registry
from tests import wings

NEEDED = {
    "scaffold_cad.products": "build123d",
    "scaffold_cad.parts": "build123d",
    "scaffold_cad.solid": "manifold3d",
    "scaffold_cad.filling": "manifold3d",
    "scaffold_cad.printability": "manifold3d",
    "scaffold_cad.smooth.patches": "build123d",
}
"""Packages without which the examples of a wing do not run."""


def modules_with_examples() -> list[str]:
    return [name for name, path in wings.modules().items() if ">>>" in path.read_text("utf-8")]


@pytest.mark.parametrize("name", scaffold_cad.__all__)
def test_every_public_name_shows_an_example(name: str) -> None:
    thing = getattr(scaffold_cad, name)
    if not (inspect.isclass(thing) or inspect.isfunction(thing)):
        return  # an alias of types, which has no docstring
    assert ">>> " in (thing.__doc__ or "")


@pytest.mark.parametrize("name", scaffold_cad.PART_CLASSES)
def test_every_part_class_shows_an_example(name: str) -> None:
    pytest.importorskip("build123d")
    assert ">>> " in (getattr(scaffold_cad, name).__doc__ or "")


@pytest.mark.parametrize("name", modules_with_examples())
def test_examples_of_docstrings_run(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "_CELLS", dict(registry._CELLS))  # examples add to them
    for wing, package in NEEDED.items():
        if name.startswith(wing) and find_spec(package) is None:
            pytest.skip(f"needs {package}")
    failed, tried = doctest.testmod(import_module(name))
    assert tried > 0
    assert failed == 0
