"""The real CQ-editor, on a screen of its own, shows the example and the README's first program.

It needs CQ-editor in the environment that runs the tests, and xvfb; docs/viewers.md has versions
that go together. `--basetemp=DIR` keeps the pictures of its window.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
DRIVER = Path(__file__).with_name("cq_editor_driver.py")
SHOW = "\nfrom scaffold_cad.viewers import show\nshow(skeleton)\nshow(scaffold)\nshow(frame)\n"


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What CQ-editor has shown of each script."""
    if find_spec("cq_editor") is None:
        pytest.skip("CQ-editor is not installed")
    if shutil.which("xvfb-run") is None:
        pytest.skip("xvfb-run is not installed")
    folder = tmp_path_factory.mktemp("cq_editor")
    (folder / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    program = re.findall(r"^```python\n(.*?)^```$", readme, flags=re.DOTALL | re.MULTILINE)[0]
    first = folder / "readme.py"
    first.write_text(program + SHOW, encoding="utf-8")
    screen = ["xvfb-run", "-a", "-s", "-screen 0 1400x900x24"]
    scripts = [str(ROOT / "examples" / "cq_editor.py"), str(first)]
    done = subprocess.run(
        [*screen, sys.executable, str(DRIVER), str(folder), *scripts],
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return result


def test_example_is_shown(shown: dict[str, Any]) -> None:
    example = shown["cq_editor"]
    assert example["names"][:-1] == ["foot", "shade", "skeleton", "scaffold", "frame"]
    assert example["types"][:-1] == ["Compound", "Compound", "Compound", "Shell", "Face"]


def test_first_program_of_the_readme_is_shown(shown: dict[str, Any]) -> None:
    assert shown["readme"]["names"][:-1] == ["skeleton", "scaffold", "frame"]
    assert shown["readme"]["types"][:-1] == ["Compound", "Shell", "Face"]


@pytest.mark.parametrize("script", ["cq_editor", "readme"])
def test_more_is_shown_from_the_console(shown: dict[str, Any], script: str) -> None:
    assert shown[script]["names"][-1] == "from the console"
    assert shown[script]["types"][-1] == "Compound"


@pytest.mark.parametrize("script", ["cq_editor", "readme"])
def test_nothing_goes_wrong(shown: dict[str, Any], script: str) -> None:
    assert shown[script]["errors"] == []
    assert not re.search(r"ERROR|CRITICAL|Traceback", shown[script]["log"])


@pytest.mark.parametrize("script", ["cq_editor", "readme"])
def test_something_is_seen(shown: dict[str, Any], script: str) -> None:
    assert shown[script]["gold"] > 0.004  # none in a window without shapes
