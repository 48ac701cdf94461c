"""JSON of other programs: a document is read whole, and its members must be what a reader needs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

from scaffold_cad.errors import FormatError
from scaffold_cad.io._text import read_text

_KINDS: dict[type, str] = {dict: "object", list: "list"}


def read_document(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises
    ------
    FormatError
        If it is not JSON, not an object, holds NaN or infinity, or is nested too deeply.
    """
    return parsed_document(path, read_text(path))


def parsed_document(path: Path, text: str) -> dict[str, Any]:
    """Return the JSON object in `text`, which is from the file at `path`."""
    try:
        document = json.loads(text, parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        raise FormatError(f"{path}, line {error.lineno}: {error.msg}; need JSON") from None
    except ValueError as error:
        raise FormatError(f"{path}: {error}; need finite numbers") from None
    except RecursionError:
        raise FormatError(f"{path} is nested too deeply; need lists of numbers") from None
    if not isinstance(document, dict):
        raise FormatError(f"{path} is JSON of another kind; need an object")
    return document


def member(path: Path, owner: Any, key: str, kind: type, where: str = "") -> Any:
    """Return ``owner[key]``, which must be of `kind`, dict or list; `where` names the owner."""
    value = owner.get(key) if isinstance(owner, dict) else None
    if not isinstance(value, kind):
        of = f" in {where}" if where else ""
        raise FormatError(f'{path} has no {_KINDS[kind]} "{key}"{of}; need one')
    return value


def number(path: Path, value: Any, where: str) -> float:
    """Return `value` if it is a number that a float holds; `where` names it."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        shown = json.dumps(value)[:80]
        raise FormatError(f"{path} has {shown} as {where}; need a number")
    return float(value)


def check_numbers(path: Path, value: Any, name: str) -> None:
    """Refuse what is no number in a number, a list of numbers or one of rows; `name` names it."""
    if not isinstance(value, list):
        number(path, value, name)
        return
    for k, row in enumerate(value):
        for item in row if isinstance(row, list) else (row,):
            if type(item) not in (int, float):
                number(path, item, f"a number of {name}[{k}]")


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")
