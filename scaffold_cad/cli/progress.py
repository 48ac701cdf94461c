"""One line on a terminal that tells how far a long command is; nothing in a pipe."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import TextIO

PERIOD = 0.5
"""Time between two looks at the clock, s."""

QUIET_TIME = 1.0
"""A stage that takes no longer shows nothing, s."""

SCAFFOLD_RATE, SOLID_RATE, ROUND_RATE = 30_000.0, 2_000.0, 5_000.0
"""Struts a second, about, that scaffolds, solids and round struts are made of."""

SECTION_RATE = 50_000.0
"""Sections of struts a second, about, that layers are made of."""


class Progress:
    """The stages of a command, each with a number of things to work on.

    How long a stage will take is guessed from its usual rate, corrected by how long the stages
    before it took.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        """Show progress on `stream`, by default standard error, if that is a terminal."""
        self._stream = sys.stderr if stream is None else stream
        self._slowness = 1.0

    @contextmanager
    def stage(self, name: str, count: int, unit: str, usual_rate: float) -> Iterator[None]:
        """Show `name` while the block runs.

        Parameters
        ----------
        count : of the things worked on
        unit : what they are, such as "struts"
        usual_rate : how many are done in a second, about
        """
        usual = count / usual_rate
        start = time.monotonic()
        done = Event()
        writer = Thread(target=self._show, args=(name, count, unit, usual, done), daemon=True)
        if self._stream.isatty():
            writer.start()
        try:
            yield
        finally:
            done.set()
            if writer.is_alive():
                writer.join()
        taken = time.monotonic() - start
        if taken > QUIET_TIME:
            self._slowness = taken / usual

    @contextmanager
    def counted(self, name: str, total: int, done: Callable[[], int]) -> Iterator[None]:
        """Show how many of `total` things are done while the block runs.

        Parameters
        ----------
        done : counts them
        """
        ended = Event()
        writer = Thread(target=self._count, args=(name, total, done, ended), daemon=True)
        if self._stream.isatty():
            writer.start()
        try:
            yield
        finally:
            ended.set()
            if writer.is_alive():
                writer.join()

    def _count(self, name: str, total: int, done: Callable[[], int], ended: Event) -> None:
        """Rewrite the line until all is done, then clear it."""
        begun, start = done(), time.monotonic()
        while not ended.wait(PERIOD):
            line = counted_line(name, done(), begun, total, time.monotonic() - start)
            self._write(line)
        self._write("")

    def _show(self, name: str, count: int, unit: str, usual: float, done: Event) -> None:
        """Rewrite the line until the stage is done, then clear it."""
        expected = self._slowness * usual
        taken = 0.0
        while not done.wait(PERIOD):
            taken += PERIOD
            if taken > QUIET_TIME:
                self._write(progress_line(name, count, unit, taken, expected))
        if taken > QUIET_TIME:
            self._write("")

    def _write(self, line: str) -> None:
        self._stream.write(f"\r\x1b[K{line}")
        self._stream.flush()


def progress_line(name: str, count: int, unit: str, taken: float, expected: float) -> str:
    """Return what is shown of a stage after `taken` of `expected` seconds."""
    left = expected - taken
    rate = count / max(expected, taken)
    rest = f"about {left:.0f} s left" if left >= 1 else "longer than usual"
    return f"{name}: {count} {unit}, {rate:.0f} a second, {taken:.0f} s so far, {rest}"


def counted_line(name: str, done: int, begun: int, total: int, taken: float) -> str:
    """Return what is shown of things `taken` seconds after `begun` of them were done.

    Examples
    --------
    >>> counted_line("tiles", 30, 10, 50, 40.0)
    'tiles: 30 of 50, 40 s so far, about 40 s left'
    """
    line = f"{name}: {done} of {total}, {taken:.0f} s so far"
    if done <= begun:
        return line
    return f"{line}, about {(total - done) * taken / (done - begun):.0f} s left"
