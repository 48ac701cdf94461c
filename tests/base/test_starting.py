"""Ctrl-C while the package is imported: the command ends in a line, programs as they do always."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
INTERRUPTS = "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(9)\n"


def heeds_interrupts() -> None:
    """Let a process be interrupted: those started by one in the background of a shell are not."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupted(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run Python until NumPy is imported, when Ctrl-C comes."""
    (folder / "numpy.py").write_text(INTERRUPTS)
    return subprocess.run(
        [sys.executable, *words],
        env=os.environ | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"},
        capture_output=True,
        text=True,
        preexec_fn=heeds_interrupts,
    )


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("way", ["script", "scaffold_cad", "scaffold_cad.cli"])
def test_ctrl_c_during_the_imports_of_the_command_is_one_line(way: str, tmp_path: Path) -> None:
    script = tmp_path / "scaffold-cad"
    script.write_text("from scaffold_cad.cli import main\nmain()\n")
    done = interrupted([str(script)] if way == "script" else ["-m", way], tmp_path)
    assert (done.returncode, done.stderr) == (130, "scaffold-cad: interrupted\n")


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_processes_of_the_command_end_without_a_word(tmp_path: Path) -> None:
    lines = "import sys\nsys.argv = ['/bin/scaffold-cad']\nimport scaffold_cad\n"  # as spawned ones
    done = interrupted(["-c", lines], tmp_path)
    assert (done.returncode, done.stderr) == (130, "")


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_while_a_program_imports_the_package_is_the_program_s(tmp_path: Path) -> None:
    lines = "try:\n    import scaffold_cad\nexcept KeyboardInterrupt:\n    print('mine')\n"
    assert interrupted(["-c", lines], tmp_path).stdout == "mine\n"


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_while_a_module_imports_the_package_is_the_module_s(tmp_path: Path) -> None:
    (tmp_path / "tool").mkdir()
    lines = "try:\n    import scaffold_cad\nexcept KeyboardInterrupt:\n    print('mine')\n"
    (tmp_path / "tool" / "__init__.py").write_text(lines)
    (tmp_path / "tool" / "__main__.py").touch()
    assert interrupted(["-m", "tool"], tmp_path).stdout == "mine\n"
