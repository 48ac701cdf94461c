"""A parser whose commands refuse what they do not know themselves, and say what is near to it."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from typing import Any, NoReturn

from scaffold_cad.base.arguments import did_you_mean

CHOICE = re.compile(r"invalid choice: '(.*?)' \(choose from (.*)\)")
"""What argparse says of a value that is not one of its choices."""

KIND = re.compile(r"invalid (int|float) value: ('.*')")
"""What argparse says of a value that is not a number."""

DASHES = "-\N{EN DASH}\N{EM DASH}\N{MINUS SIGN}"
"""What flags begin with, and what word processors make of it."""

NEGATIVE = re.compile(r"-(?:\.?\d|inf\b)")
"""How a value begins that is a negative number, or begins with one, as -1e3 and -1,0,0 do."""

KINDS = {"int": "a whole number", "float": "a number"}
"""What is needed, by the type."""


class Parser(argparse.ArgumentParser):
    """A parser of a command line, or of one of its commands."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Make a parser that takes values of flags for what they are if they begin with a minus."""
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = NEGATIVE

    def parse_known_args(  # type: ignore[override]  # the overloads of argparse
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[Any, list[str]]:
        """Parse, and refuse what is not known with the usage of this very command."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            flags = [flag for action in self._actions for flag in action.option_strings]
            first = unknown[0].partition("=")[0]
            bare = first.lstrip(DASHES)
            is_flag = bare != first or "=" in unknown[0]
            near = did_you_mean(bare, flags) if is_flag else ""
            self.error(f"unrecognized arguments: {' '.join(unknown)}{near}")
        return found, []

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        """Return a value; one of some words in any case."""
        by_word = {str(choice).lower(): choice for choice in action.choices or ()}
        return super()._get_value(action, by_word.get(arg_string.lower(), arg_string))

    def error(self, message: str) -> NoReturn:
        """End with what must be given and a message, which has the word nearest to a wrong choice.

        The flags that may be given are not listed: they would push the message off the screen.
        """
        choice = CHOICE.search(message)
        if choice:
            message += did_you_mean(choice[1], re.findall(r"[\w.-]+", choice[2]))
        message = KIND.sub(lambda found: f"{found[2]} is not {KINDS[found[1]]}; need one", message)
        formatter = self._get_formatter()
        formatter.add_usage(None, [action for action in self._actions if action.required], [])
        usage = formatter.format_help().strip().replace(self.prog, f"{self.prog} [options]", 1)
        self.exit(2, f"{usage}\n{self.prog}: error: {message}\n")
