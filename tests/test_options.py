"""The page of options lists every value that an option takes, in Python and on the command line."""

from __future__ import annotations

import argparse
import inspect
import re
import sys
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import pytest

from scaffold_cad import mechanics, printability
from scaffold_cad.cli import parsers
from scaffold_cad.io._units import MILLIMETERS
from scaffold_cad.mechanics.polar import PLANES
from scaffold_cad.partition.sphere import METHODS
from scaffold_cad.scaffold import ScaffoldOptions
from scaffold_cad.skeleton.beams import CAPS
from tests.test_public import CALLABLES

PAGE = Path(__file__).parents[1] / "docs" / "options.md"

RESULTS = ("Finding", "Content")
"""Documented classes whose fields are no options: users read them."""

NAMED = {
    "method": tuple(METHODS),
    "caps": CAPS,
    "plane": tuple(PLANES),
    "units": tuple(MILLIMETERS),
    "process": tuple(printability.PROCESSES),
    "material": (*printability.MATERIALS, *mechanics.MATERIALS),
}
"""Values of options that are looked up in a table."""


def literals(hint: Any) -> set[str]:
    """Return the texts that a type allows by themselves."""
    parts = get_args(hint)
    if get_origin(hint) is Literal:
        return {part for part in parts if isinstance(part, str)}
    return set().union(*map(literals, parts)) if parts else set()


def of_annotation(annotation: str, module: Any) -> set[str]:
    """Return the texts that an annotation of a module allows, through the aliases it names."""
    words = re.findall(r"\w+", annotation)
    found = [literals(getattr(module, word, None)) for word in words]
    given = re.findall(r"Literal\[[^]]*\]", annotation)
    return set().union(*found, *(literals(eval(one, {"Literal": Literal})) for one in given))


def of_library() -> dict[str, set[str]]:
    """Return the values of each option that documented functions and classes take."""
    found: dict[str, set[str]] = {name: set(values) for name, values in NAMED.items()}
    for dotted, one in CALLABLES.items():
        if dotted.endswith(RESULTS):
            continue
        function = one.__init__ if isinstance(one, type) else one
        for parameter in inspect.signature(function).parameters.values():
            values = of_annotation(str(parameter.annotation), sys.modules[one.__module__])
            if values:
                found.setdefault(parameter.name, set()).update(values)
    return found


def of_command_line() -> dict[str, set[str]]:
    """Return the choices of each flag, of all commands."""
    found: dict[str, set[str]] = {}
    for command in parsers()[1].values():
        for action in command._actions:
            if action.choices and not isinstance(action, argparse._SubParsersAction):
                found.setdefault(action.option_strings[-1], set()).update(action.choices)
    return found


LIBRARY, FLAGS = of_library(), of_command_line()


def listed() -> dict[str, list[str]]:
    """Return the values of each option in the table of the page, as they are written."""
    rows = re.findall(r"^\| `([\w-]+)`[^|]* \| ([^|]+) \|", PAGE.read_text("utf-8"), re.MULTILINE)
    found: dict[str, list[str]] = {}
    for name, values in rows:
        found.setdefault(name, []).extend(re.findall(r"`([^`]+)`", values))
    return found


@pytest.mark.parametrize("name", LIBRARY)
def test_the_page_lists_every_value_of_an_option(name: str) -> None:
    texts = [value for value in listed()[name] if value.startswith('"')]
    assert sorted({text.strip('"') for text in texts}) == sorted(LIBRARY[name])


@pytest.mark.parametrize("flag", FLAGS)
def test_the_page_lists_every_choice_of_a_flag(flag: str) -> None:
    rows = listed()
    name = flag if flag in rows else flag.removeprefix("--")
    assert FLAGS[flag] <= {value.strip('"') for value in rows[name]}


def test_the_page_lists_defaults_first() -> None:
    defaults = ScaffoldOptions()
    for name in ("fit", "section", "method"):
        assert listed()[name][0] == f'"{getattr(defaults, name)}"'


def test_every_option_of_the_scaffold_is_listed() -> None:
    assert set(ScaffoldOptions.__dataclass_fields__) <= listed().keys()
