"""Packages that only some products need."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from typing import Any

from scaffold_cad.errors import MissingBackendError


def need(package: str, purpose: str) -> None:
    """Raise unless `package` is installed; it is not imported.

    Parameters
    ----------
    package : such as "build123d"
    purpose : what needs it, such as "a STEP file"

    Raises
    ------
    MissingBackendError
        If it is not.
    """
    if find_spec(package) is None:
        raise MissingBackendError(f"{purpose} needs {package}; run: pip install {package}")


def is_instance(what: Any, package: str, name: str) -> bool:
    """Return whether `what` is of a class of an optional package, without importing that."""
    loaded = sys.modules.get(package)
    return loaded is not None and isinstance(what, getattr(loaded, name))
