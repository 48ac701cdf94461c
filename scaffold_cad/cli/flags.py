"""Messages of the library, whose parameters are flags of the command."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from scaffold_cad.errors import ScaffoldCadError

PARAMETER = re.compile(
    r"\b(overlaps|radius|blend|ends|joints|bend|nodes|wall|sides|collars|section|fit|max_nodes|units"
    r"|scale|block)=('?)([\w.]*)\2"
)
"""Parameters of the library that are flags here, as messages give them with a value."""
SUBJECT = re.compile(
    r"^(radius|blend|wall|sides|skin|drain|thickness|units|scale|bend|max_nodes|material|strength"
    r"|hollow|count|seed|regularity|socket(?=s))s? (?=is |of node |has )"
)
"""The same, where they are what a message is about."""
PHRASES = {
    "unit cell is ": "--cell is ",
    "Young's modulus is ": "--young is ",
    "relative density is ": "--density is ",
}
"""What messages are about in other words than the flag's."""


def with_flags(message: str) -> str:
    """Return a message of the library with its parameters as the command's flags.

    Examples
    --------
    >>> with_flags("need overlaps='unite', or radius= for all")
    'need --overlaps unite, or --radius for all'
    >>> with_flags("wall is 1 mm; need less")
    '--wall is 1 mm; need less'
    >>> with_flags("drain is 0 mm; need > 0")
    '--drain is 0 mm; need > 0'
    >>> with_flags("unit cell is 'x'; need one of sc, bcc")
    "--cell is 'x'; need one of sc, bcc"
    """
    for phrase, flag in PHRASES.items():
        if message.startswith(phrase):
            return flag + message.removeprefix(phrase)
    named = SUBJECT.sub(lambda found: f"{_flag(found[1])} ", message)
    return PARAMETER.sub(lambda found: f"{_flag(found[1])} {found[3]}".strip(), named)


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


@contextmanager
def told_as(**flags: str) -> Iterator[None]:
    """Let errors of the block name parameters as flags, where these have other names.

    Examples
    --------
    >>> from scaffold_cad.errors import OptionError
    >>> with told_as(thickness="--layer"):
    ...     raise OptionError("thickness is 0 mm; need > 0")
    Traceback (most recent call last):
    scaffold_cad.errors.OptionError: --layer is 0 mm; need > 0
    """
    try:
        yield
    except ScaffoldCadError as error:
        message = str(error)
        for name, flag in flags.items():
            message = re.sub(rf"(?<![\w-]){name}\b(?==| is | = | has )=?", flag, message)
        raise type(error)(message) from None
