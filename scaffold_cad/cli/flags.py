"""Messages of the library, whose parameters are flags of the command."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from scaffold_cad.errors import ScaffoldCadError

PARAMETER = re.compile(
    r"\b(overlaps|radius|blend|ends|joints|bend|nodes|wall|sides|collars|section|fit|max_nodes|units"
    r"|scale|block)=('?)([\w.]*)\2"
)
"""Parameters of the library that are flags here, as messages give them with a value."""
SUBJECT = re.compile(
    r"^(radius|blend|wall|sides|skin|drain|thickness|units|scale|bend|max_nodes|material|strength"
    r"|hollow|count|seed|regularity|stretch|density|joints|ends|section|fit|socket(?=s))s? "
    r"(?=is |of node |has )"
)
"""The same, where they are what a message is about."""
PHRASES = {
    "unit cell is ": "--cell is ",
    "Young's modulus is ": "--young is ",
    "relative density is ": "--density is ",
    "build direction is ": "--direction is ",
    "a drain hole of ": "--drain: a hole of ",
    "the radius of the socket ": "--socket: the radius of the socket ",
    "the depth of the socket ": "--socket: the depth of the socket ",
    "the socket ": "--socket: the socket ",
}
"""What messages are about in other words than the flag's."""
ADVICE = {
    "lattice_part and strut_part make it of triangles": "-o part.stl makes it of triangles",
    "(to_solid unites these struts instead)": "(files of meshes have these struts united instead)",
    "(`to_solid` does for a scaffold)": "(scaffold-cad build does for skeletons)",
    "(`to_solid`)": "(scaffold-cad build does for skeletons)",
    "skeleton.simplified(tolerance)": "--simplify TOL",
    "(skeleton.joined(tolerance))": "(scaffold-cad build --join TOL)",
    "(those of a part's faces: ": "(those of a part's faces, in Python: ",
    "use Skeleton.cleaned() to repair it": "without --strict, files are repaired",
    "(or read it without strict)": "(or read it without --strict)",
    ", or a Material": "",
}
"""What messages advise in Python, and what does the same here."""

NUMBER = re.compile(r"[-+]?(?:[\d.][-+\d.eExX,:]*|nan|inf)", re.IGNORECASE)
"""A value of a flag that is a number, or several."""

LENGTH = re.compile(r"[-+\d.e]+ mm\b")
"""A length in a message."""

GUARDS = frozenset({"--jobs", "--max-nodes", "--seed", "--face-number", "--to-face"})
"""Flags whose numbers are no measures."""


def with_flags(message: str) -> str:
    """Return a message of the library with its parameters as the command's flags.

    Examples
    --------
    >>> with_flags("need overlaps='unite', or radius= for all")
    'need --overlaps unite, or --radius for all'
    >>> with_flags("wall is 1 mm; need less")
    '--wall is 1 mm; need less'
    >>> with_flags("ends is 'open' without a wall; need wall=, mm")
    "--ends is 'open' without a wall; need --wall, mm"
    >>> with_flags("drain is 0 mm; need > 0")
    '--drain is 0 mm; need > 0'
    >>> with_flags("unit cell is 'x'; need one of sc, bcc")
    "--cell is 'x'; need one of sc, bcc"
    >>> with_flags("unions stay wrong (lattice_part and strut_part make it of triangles)")
    'unions stay wrong (-o part.stl makes it of triangles)'
    """
    message = with_ways(message)
    for phrase, flag in PHRASES.items():
        if message.startswith(phrase):
            return flag + message.removeprefix(phrase)
    named = SUBJECT.sub(lambda found: f"{_flag(found[1])} ", message)
    return PARAMETER.sub(lambda found: f"{_flag(found[1])} {found[3]}".strip(), named)


def with_ways(text: str) -> str:
    """Return a text with what the command does in place of what it advises in Python.

    Examples
    --------
    >>> with_ways("unite the parts (`to_solid`), or give them smaller radii")
    'unite the parts (scaffold-cad build does for skeletons), or give them smaller radii'
    """
    for advice, way in ADVICE.items():
        text = text.replace(advice, way)
    return text


def with_measures(message: str, words: Sequence[str]) -> str:
    """Return a message with the measures that the command line asks for, and that it does not name.

    What cannot be made is often told by what it comes to, such as the struts of all cells. A
    message that sets a flag against another length may be due to any of the others.

    Parameters
    ----------
    words : of the command line

    Examples
    --------
    >>> with_measures("8e+27 struts; need at most 1e+08", ["lattice", "--size", "1e-9"])
    '8e+27 struts; need at most 1e+08 (asked for: --size 1e-9)'
    >>> with_measures("--size is 0 mm; need > 0", ["lattice", "--size", "0"])
    '--size is 0 mm; need > 0'
    >>> with_measures("--layer is 2 mm for 1e9 mm; need more", ["slice", "--radius", "1e9"])
    '--layer is 2 mm for 1e9 mm; need more (asked for also: --radius 1e9)'
    """
    given = {}
    for word, after in zip(words, [*words[1:], ""][: len(words)], strict=True):
        flag, _, value = word.partition("=")
        measure = value or after
        if flag.startswith("--") and flag not in GUARDS and NUMBER.fullmatch(measure):
            given[flag] = measure
    is_named = message.startswith("--") or any(flag in message for flag in given)
    others = {flag: value for flag, value in given.items() if flag not in message}
    if not others or (is_named and len(LENGTH.findall(message)) < 2):
        return message
    word = "asked for also" if is_named else "asked for"
    return f"{message} ({word}: {', '.join(map(' '.join, others.items()))})"


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
