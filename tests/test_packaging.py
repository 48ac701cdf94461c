"""What an index shows of the package: the long description with absolute pictures and links."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[1]
ADDRESS = "https://example.org/scaffold-cad/"

LINK = re.compile(r'(?:src="|\]\()([^")\s]+)')
"""Where a picture or a link of a page in Markdown leads."""


@pytest.fixture
def project() -> dict:
    path = ROOT / "pyproject.toml"
    if not path.is_file():
        pytest.skip("no pyproject.toml beside the tests")
    return tomllib.loads(path.read_text("utf-8"))


def test_one_address_makes_pictures_and_links_absolute(project: dict) -> None:
    hook = project["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"]
    (one,) = hook["substitutions"]
    page = (ROOT / hook["fragments"][0]["path"]).read_text("utf-8")
    shown = re.sub(one["pattern"], one["replacement"] + ADDRESS, page)
    links = LINK.findall(shown)
    assert len(links) > 20
    assert [link for link in links if not link.startswith(("https://", "#"))] == []
    own = [link.removeprefix(ADDRESS) for link in links if link.startswith(ADDRESS)]
    assert [path for path in own if not (ROOT / path).exists()] == []
    assert re.sub(one["pattern"], r"\1", page) == page


def test_the_citation_has_the_version_of_the_package() -> None:
    from scaffold_cad import __version__

    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.search(r"^version: (.*)$", citation, re.MULTILINE)[1] == __version__
