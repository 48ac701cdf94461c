"""How much memory the machine has."""

from __future__ import annotations

import os

import pytest

from scaffold_cad.base import memory


def test_the_machine_has_some_memory() -> None:
    assert 1e8 < memory.machine_memory() < 1e14


def test_a_machine_that_does_not_tell_is_taken_for_a_usual_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def unknown(name: str) -> int:
        raise ValueError(name)

    monkeypatch.setattr(os, "sysconf", unknown, raising=False)
    assert memory.machine_memory() == memory.UNKNOWN
