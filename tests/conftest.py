"""Fixtures shared by all tests."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

# Tests run beside each other, on all processors: products of matrices that take several threads as
# well wait for each other, and all tests took twice the processor time. Read where numpy is loaded.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# A shared machine may stall for longer than any fixed deadline. `--hypothesis-profile=thorough`
# looks longer, and at other examples each time.
settings.register_profile("default", deadline=None, max_examples=40, derandomize=True)
settings.register_profile("thorough", deadline=None, max_examples=1000)
settings.load_profile("default")


NO_REAL_FILES = "no folder of real files beside the repository"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of real files beside the repository, or skip the test without it."""
    folder = Path(__file__).parents[1] / ".." / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(NO_REAL_FILES)
    return folder


@pytest.fixture(autouse=True)
def log_as_it_was() -> Iterator[None]:
    """Undo what the command line does to the package's log, which other tests listen to."""
    logger = logging.getLogger("scaffold_cad")
    before = list(logger.handlers), logger.level, logger.propagate
    yield
    logger.handlers[:], level, logger.propagate = before
    logger.setLevel(level)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say in one line how many tests need the real files beside the repository, where absent."""
    skipped = terminalreporter.stats.get("skipped", [])
    count = sum(NO_REAL_FILES in str(report.longrepr) for report in skipped)
    if count:
        terminalreporter.write_line(f"{count} tests need ../shared/data, which is not here")
