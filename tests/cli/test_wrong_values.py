"""Each flag that takes a number or a word refuses what is none, in a line that names the flag."""

from __future__ import annotations

import argparse
import re
import shlex
from pathlib import Path
from shutil import copytree

import pytest
from build123d import Box, export_step

from scaffold_cad import write
from scaffold_cad.cli import main
from tests.cli.test_flags import BARE, LINES, TRIPOD, commands

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


def given() -> dict[tuple[str, str], tuple[argparse.Action, list[str], int]]:
    """Return for each command and flag with a value: its action, a line, where the value is."""
    found = {}
    for command, lines in LINES.items():
        actions = {
            flag: action
            for action in commands()[command]._actions
            for flag in action.option_strings
        }
        for line in lines:
            words = shlex.split(line)
            for at, word in enumerate(words):
                if word in actions and actions[word].nargs != 0:
                    found.setdefault((command, word), (actions[word], [command, *words], at + 2))
    return found


NUMBERS = [
    pytest.param(words, at, id=" ".join(key))
    for key, (action, words, at) in given().items()
    if not action.choices and NUMBER.fullmatch(words[at])
]
"""Lines with each flag whose value there is a number, and where it is."""

CHOICES = [
    pytest.param(words, at, action.dest, id=" ".join(key))
    for key, (action, words, at) in given().items()
    if action.choices
]


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the files that lines name."""
    inputs = tmp_path_factory.mktemp("inputs")
    write(TRIPOD, inputs / "tripod.json")
    (inputs / "bare.obj").write_text(BARE)
    export_step(Box(16, 16, 16), inputs / "box.step")
    return inputs


@pytest.fixture
def folder(inputs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    copytree(inputs, tmp_path, dirs_exist_ok=True)
    return tmp_path


def refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return the last line on standard error of a command that ends with exit code 2."""
    try:
        code: object = main(words)
    except SystemExit as exit_:
        code = exit_.code
    told = capsys.readouterr().err.strip().splitlines()
    assert code == 2, told
    return told[-1]


@pytest.mark.parametrize("value", ["abc", "nan", "-7"])
@pytest.mark.parametrize(("words", "at"), NUMBERS)
def test_numbers_that_are_none_are_told_by_their_flag(
    words: list[str], at: int, value: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = set(folder.rglob("*"))
    flag = words[at - 1]
    if value == "-7" and flag in {"--thickness", "--seed", "--min-opening"}:
        pytest.skip("a sign, or any number, has a meaning here")
    line = refused([*words[: at - 1], f"{flag}={value}", *words[at + 1 :]], capsys)
    assert flag in line
    assert value in line
    assert "need" in line
    assert {path for path in set(folder.rglob("*")) - before if path.is_file()} == set()


@pytest.mark.parametrize(("words", "at", "name"), CHOICES)
def test_words_that_are_no_choice_are_told_by_their_flag(
    words: list[str], at: int, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    flag = words[at - 1]
    line = refused([*words[:at], "blen", *words[at + 1 :]], capsys)
    assert f"argument {flag}: invalid choice: 'blen' (choose from " in line
    parsed = commands()[words[0]].parse_args([*words[1:at], words[at].upper(), *words[at + 1 :]])
    assert getattr(parsed, name) == words[at]
