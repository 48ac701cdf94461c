"""Docstrings as the site shows them.

The project's docstrings say what a parameter is on the line of its name, `name : what it is`. That
place is for the type in numpydoc; types stand in the signatures here. So what stands there is moved
to the description.
"""

from __future__ import annotations

import re
from typing import Any

import griffe

SECTION = re.compile(r"(?ms)^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)")
ENTRY = re.compile(r"(?m)^(\w[\w, ]*?) : (.*)$")


class Descriptions(griffe.Extension):
    """Moves what a parameter is from the place of its type to its description."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Change the docstring of an object that was read."""
        if obj.docstring is not None:
            obj.docstring.value = SECTION.sub(
                lambda section: ENTRY.sub(r"\1\n    \2", section[0]), obj.docstring.value
            )
