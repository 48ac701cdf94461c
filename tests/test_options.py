"""The page of options lists every value that an option takes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, get_args

import pytest

from scaffold_cad.base.regions import Keep
from scaffold_cad.brep import Kind
from scaffold_cad.convolution import KernelName
from scaffold_cad.partition.sphere import METHODS
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.scaffold import ScaffoldOptions
from scaffold_cad.scaffold.stars import Fit, Section
from scaffold_cad.struts import Bend, Ends, Joints, Nodes

PAGE = Path(__file__).parents[1] / "docs" / "options.md"

VALUES: dict[str, tuple[Any, ...]] = {
    "fit": get_args(Fit),
    "section": get_args(Section),
    "collars": (False, True),
    "method": tuple(METHODS),
    "kind": get_args(Kind),
    "ends": get_args(Ends),
    "joints": get_args(Joints),
    "nodes": get_args(Nodes),
    "bend": get_args(get_args(Bend)[1]),
    "overlaps": get_args(Overlaps),
    "keep": get_args(Keep),
    "kernel": get_args(KernelName),
}


def listed() -> dict[str, list[str]]:
    """Return the values of each option in the table of the page, as they are written."""
    rows = re.findall(r"^\| `(\w+)` \| ([^|]+) \|", PAGE.read_text("utf-8"), flags=re.MULTILINE)
    return {name: re.findall(r"`([^`]+)`", values) for name, values in rows}


@pytest.mark.parametrize("name", VALUES)
def test_the_page_lists_every_value_of_an_option(name: str) -> None:
    written = [f'"{value}"' if isinstance(value, str) else str(value) for value in VALUES[name]]
    assert sorted(listed()[name]) == sorted(written)


def test_the_page_lists_defaults_first() -> None:
    defaults = ScaffoldOptions()
    for name in ("fit", "section", "method"):
        assert listed()[name][0] == f'"{getattr(defaults, name)}"'


def test_every_option_of_the_scaffold_is_listed() -> None:
    assert set(ScaffoldOptions.__dataclass_fields__) <= listed().keys()
