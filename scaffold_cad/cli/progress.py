"""One line on a terminal that tells how far a long command is; nothing in a pipe."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import TextIO

from scaffold_cad.base.counts import running

PERIOD = 0.5
"""Time between two looks at the clock, s."""

QUIET_TIME = 2.0
"""What takes no longer shows nothing, s."""


class Progress:
    """The stages of a command. What is shown of them is counted, not guessed."""

    def __init__(self, stream: TextIO | None = None) -> None:
        """Show progress on `stream`, by default standard error, if that is a terminal."""
        self._stream = sys.stderr if stream is None else stream

    @contextmanager
    def stage(self, name: str, count: int, unit: str) -> Iterator[None]:
        """Show `name` while the block runs, and how many things of its present work are done.

        Parameters
        ----------
        count : of the things worked on
        unit : what they are, such as "struts"
        """

        def line(taken: float) -> str:
            told = f"{name}: {count} {unit}, {taken:.0f} s so far"
            now = running()
            if now is None:
                return told
            passed = time.monotonic() - now.begun
            return f"{told}; {counted_line(now.name, now.done, 0, now.total, passed)}"

        with self._showing(line):
            yield

    @contextmanager
    def counted(self, name: str, total: int, done: Callable[[], int]) -> Iterator[None]:
        """Show how many of `total` things are done while the block runs.

        Parameters
        ----------
        done : counts them
        """
        begun = done()
        with self._showing(lambda taken: counted_line(name, done(), begun, total, taken)):
            yield

    @contextmanager
    def _showing(self, line: Callable[[float], str]) -> Iterator[None]:
        """Rewrite the line, of the time taken so far, while the block runs, then clear it."""
        ended = Event()
        writer = Thread(target=self._show, args=(line, ended), daemon=True)
        if self._stream.isatty():
            writer.start()
        try:
            yield
        finally:
            ended.set()
            if writer.is_alive():
                writer.join()

    def _show(self, line: Callable[[float], str], ended: Event) -> None:
        start, shown = time.monotonic(), False
        while not ended.wait(PERIOD):
            taken = time.monotonic() - start
            if taken > QUIET_TIME:
                self._write(line(taken))
                shown = True
        if shown:
            self._write("")

    def _write(self, line: str) -> None:
        self._stream.write(f"\r\x1b[K{line}")
        self._stream.flush()


def counted_line(name: str, done: int, begun: int, total: int, taken: float) -> str:
    """Return what is shown of things `taken` seconds after `begun` of them were done.

    Examples
    --------
    >>> counted_line("tiles", 30, 10, 50, 40.0)
    'tiles: 30 of 50, 0.5 per second, about 40 s left'
    """
    line = f"{name}: {done} of {total}"
    if done <= begun or taken <= 0:
        return line
    rate = (done - begun) / taken
    return f"{line}, {rate:.3g} per second, about {(total - done) / rate:.0f} s left"
