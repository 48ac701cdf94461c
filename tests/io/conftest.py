"""Fixtures of tests of files."""

from __future__ import annotations

import sys

import pytest


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let libraries that may end their process read sound files in that of the tests.

    A program that holds a Python, as CAD systems do, starts no other one for them.
    """
    monkeypatch.setattr(sys, "executable", "a CAD system")
