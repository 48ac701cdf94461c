"""Options of a command from a TOML file, which flags on the command line override.

A table is named as a command, and its keys as the flags of this:

    [build]
    round = true
    blend = 1.5
    socket = ["1:14.3:25", "2:10:20"]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from scaffold_cad.base.arguments import did_you_mean
from scaffold_cad.base.files import reading
from scaffold_cad.errors import OptionError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def with_config(arguments: list[str], commands: dict[str, argparse.ArgumentParser]) -> list[str]:
    """Return the arguments of a command line with those of its `--config FILE` put in.

    Parameters
    ----------
    commands : parsers of the commands by name

    Raises
    ------
    OptionError
        If the file cannot be read, or has what the command has no flag for.
    """
    command = arguments[0].lower() if arguments else ""
    if command not in commands:
        return arguments
    found = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    found.add_argument("--config", type=Path, nargs="?")  # the command's own parser asks for a file
    path = found.parse_known_args(arguments[1:])[0].config
    if path is None:
        return arguments
    table = _table(path, command, commands)
    flags = [
        word for key, value in table.items() for word in _words(path, key, value, commands[command])
    ]
    return [command, *flags, *arguments[1:]]


def _table(
    path: Path, command: str, commands: dict[str, argparse.ArgumentParser]
) -> dict[str, Any]:
    """Return what a file has for a command."""
    try:
        with reading(path):
            content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise OptionError(f"{path} is not a TOML file: {error}") from error
    for name, value in content.items():
        if name not in commands or not isinstance(value, dict):
            near = did_you_mean(name, commands)
            raise OptionError(f"{path} has {name!r}; need tables named as commands{near}")
    found: dict[str, Any] = content.get(command, {})
    return found


def _words(path: Path, key: str, value: Any, parser: argparse.ArgumentParser) -> list[str]:
    """Return what stands on a command line for a key and its value."""
    flags = {flag: action for action in parser._actions for flag in action.option_strings}
    flag = f"--{key.replace('_', '-')}"
    if flag not in flags or flag in ("--config", "--help"):
        near = did_you_mean(flag, flags).replace("--", "")
        raise OptionError(f"{path} has {key!r}, which is not an option of the command{near}")
    is_switch = flags[flag].nargs == 0
    if is_switch != isinstance(value, bool):
        need = "true or false" if is_switch else "a text, a number or a list of them"
        raise OptionError(f"{path} has {key} = {value!r}; need {need}")
    if is_switch:
        return [flag] if value else []
    values = value if isinstance(value, list) else [value]
    if len(values) != 1 and not isinstance(flags[flag], argparse._AppendAction):
        raise OptionError(f"{path} has {key} = {value!r}; need one value")
    return [f"{flag}={one}" for one in values]
