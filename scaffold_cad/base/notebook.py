"""What notebooks show of the library's types."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

_drawers: list[Callable[[Any], str]] = []


def register_drawer(draw: Callable[[Any], str]) -> Callable[[Any], str]:
    """Register what makes the HTML of a `Shown` object; the wing webpage does it when imported.

    So the types that are shown need not know of pages, which know of them.
    """
    _drawers[:] = [draw]
    return draw


class Shown:
    """A type that notebooks show as a page, see `webpage.for_notebook`."""

    def _repr_html_(self) -> str | None:
        """Return it as a notebook shows it; None, for its plain text, if no drawer is there."""
        return _drawers[0](self) if _drawers else None
