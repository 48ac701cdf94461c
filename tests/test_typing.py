"""Programs of users pass `mypy --strict` against the types of the installed package."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests import typed_client

ROOT = Path(__file__).parents[1]

CONFIGURATION = """
[mypy]
strict = True
[mypy-scipy.*,OCP.*,build123d.*,trimesh.*,manifold3d.*,lib3mf.*,networkx.*,ezdxf.*,meshio.*]
# Not read, which would take longer than all else.
follow_imports = skip
ignore_missing_imports = True
"""


def programs_of_readme() -> list[str]:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```$", text, flags=re.DOTALL | re.MULTILINE)


def test_a_typed_program_runs(tmp_path: Path) -> None:
    typed_client.main(tmp_path)
    assert len(list(tmp_path.iterdir())) == 8


@pytest.mark.skipif(not find_spec("mypy"), reason="needs mypy")
def test_programs_are_typed(tmp_path: Path, pytestconfig: pytest.Config) -> None:
    # Beside the package mypy would check the package too, with whatever types numpy has there.
    texts = {"typed_client": Path(typed_client.__file__).read_text(encoding="utf-8")}
    texts |= {f"readme_{number}": text for number, text in enumerate(programs_of_readme())}
    assert len(texts) > 1
    programs = [tmp_path / f"{name}.py" for name in texts]
    for program, text in zip(programs, texts.values(), strict=True):
        program.write_text(text, encoding="utf-8")
    configuration = tmp_path / "mypy.ini"
    configuration.write_text(CONFIGURATION, encoding="utf-8")
    # The first run takes ten times as long as those that find a cache.
    kept = getattr(pytestconfig, "cache", None)
    cache = kept.mkdir("typed_programs") if kept else tmp_path
    command = [sys.executable, "-m", "mypy", "--config-file", configuration, "--cache-dir", cache]
    checked = subprocess.run(
        [*command, *programs], cwd=tmp_path, capture_output=True, encoding="utf-8", check=False
    )
    assert checked.stdout.startswith("Success: "), checked.stdout + checked.stderr
