"""Running a command: what goes wrong becomes one line and an exit code, several files go on."""

from __future__ import annotations

import argparse
import logging
import os
import signal
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import active_children, get_context
from threading import Event, current_thread, main_thread
from typing import NoReturn, TextIO

from scaffold_cad.base.arguments import as_count
from scaffold_cad.base.files import remove_unfinished
from scaffold_cad.base.starting import INTERRUPTED, started
from scaffold_cad.cli.fields import with_contents
from scaffold_cad.cli.flags import with_flags, with_measures
from scaffold_cad.cli.streams import each_file, streamed
from scaffold_cad.errors import FormatError, ScaffoldCadError

BAD_INPUT = 2

_interrupted = Event()
"""Whether a signal has come that ends the work."""

KILLED = "process was killed, as systems do where memory runs out; need a smaller skeleton"

RED, YELLOW, PLAIN = "\x1b[31m", "\x1b[33m", "\x1b[0m"


def run(options: argparse.Namespace) -> int:
    """Run a command over all of its inputs and return its exit code."""

    def work() -> int:
        if getattr(options, "jobs", None) is not None:
            as_count(options.jobs, "--jobs", 1)
        with streamed(options) as folder:
            log_to_stderr(options, folder)
            files = each_file(options)
            if len(files) == 1:
                return _run_one(files[0], folder=folder)
            return _run_all(files, getattr(options, "jobs", None), folder)

    log_to_stderr(options)
    try:
        with _interruptible():
            return _guarded(work)
    except KeyboardInterrupt:
        print(_prefix(sys.stderr, RED) + "interrupted", file=sys.stderr)
        return INTERRUPTED


@contextmanager
def _interruptible() -> Iterator[None]:
    """Let SIGTERM end work as Ctrl-C does, so that no hidden file stays."""
    if current_thread() is not main_thread():
        yield
        return
    _interrupted.clear()
    started()
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    heeded = {signal.SIGTERM, signal.SIGINT}
    if before[signal.SIGINT] is not signal.default_int_handler:
        heeded.remove(signal.SIGINT)  # as in the background of a shell
    for number in heeded:
        signal.signal(number, _interrupt)
    try:
        yield
    finally:
        for number in heeded:
            signal.signal(number, before[number] or signal.SIG_DFL)


def _interrupt(*_: object) -> NoReturn:
    _interrupted.set()
    raise KeyboardInterrupt


def _heeding(work: Callable[[], int]) -> int:
    """Return what work returns; raise KeyboardInterrupt for what a signal makes of it.

    Modules in C that are imported meanwhile, such as OCP, make an ImportError of that.
    """
    try:
        return work()
    except Exception:
        if _interrupted.is_set():
            raise KeyboardInterrupt from None
        raise


def _run_all(files: list[argparse.Namespace], jobs: int | None, folder: str) -> int:
    """Run a command for each file, in several processes, and return the greatest exit code.

    Where one of these is killed, the files that are left have a process each: the file for which
    it is killed again is named, and ends no other.
    """
    one = partial(_run_one, folder=folder, several=True)
    count = as_count(1 if jobs is None else jobs, "--jobs", 1)
    if count == 1:
        return max(map(one, files))
    codes = _in_processes(one, files, count)
    for k in [k for k, code in enumerate(codes) if code is None]:
        (codes[k],) = _in_processes(one, [files[k]], 1)
        if codes[k] is None:
            name = _without(str(files[k].input), folder)
            print(f"{_prefix(sys.stderr, RED)}{name}: {KILLED}", file=sys.stderr)
    return max(BAD_INPUT if code is None else code for code in codes)


def _in_processes(
    one: Callable[[argparse.Namespace], int], files: list[argparse.Namespace], count: int
) -> list[int | None]:
    """Return the exit code for each file, None of those whose process was killed.

    What killed processes had begun to write is removed.
    """
    made: list[Future[int]] = []
    codes: list[int | None] = [None] * len(files)
    with ProcessPoolExecutor(count, get_context("spawn"), _end_quietly) as pool:
        with suppress(BrokenProcessPool):  # which takes no more
            made.extend(pool.submit(one, file) for file in files)
        processes = [process.pid for process in active_children()]
        for k, future in enumerate(made):
            with suppress(BrokenProcessPool, SystemExit):  # SystemExit: see _end_quietly
                codes[k] = future.result()
    for file, code in zip(files, codes, strict=True):
        if code is None and hasattr(file, "output"):
            remove_unfinished(file.output.parent, processes)
    return codes


def _end_quietly() -> None:
    """Let signals end this process without a word: the one that began it says what there is."""

    def end(*_: object) -> NoReturn:
        raise SystemExit(INTERRUPTED)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)


def _run_one(options: argparse.Namespace, folder: str, several: bool = False) -> int:
    """Run a command for one file and return its exit code."""
    log_to_stderr(options, folder)
    if several and not hasattr(options, "output") and not getattr(options, "json", False):
        print(f"{options.input}:")

    def work() -> int:
        return options.run(with_contents(options)) or 0  # most commands give none: they are done

    named = str(options.input) if several else ""
    return _guarded(work, folder, named, options)


def _guarded(
    work: Callable[[], int],
    folder: str = "",
    named: str = "",
    options: argparse.Namespace | None = None,
) -> int:
    """Return the exit code of some work, with one line on standard error where it fails."""
    words = getattr(options, "words", [])
    sides = getattr(options, "sides", None)

    def tell(message: str) -> None:
        text = message if message.startswith(named) else f"{named}: {message}"
        print(_prefix(sys.stderr, RED) + _without(text, folder), file=sys.stderr)

    fewer = "" if sides is None else f", or fewer --sides than {sides}"
    try:
        code = _heeding(work)
        sys.stdout.flush()
    except ScaffoldCadError as error:
        message = with_flags(str(error))
        tell(message if isinstance(error, FormatError) else with_measures(message, words))
        return BAD_INPUT
    except MemoryError:
        tell(f"out of memory; need a smaller skeleton{fewer}")
        return BAD_INPUT
    except BrokenProcessPool:  # joblib's error, for tiles, is one too
        tell(f"a {KILLED} or --jobs")
        return BAD_INPUT
    except OSError as error:  # of standard output: files raise a FormatError
        return unprinted(error)
    return code


def unprinted(error: OSError) -> int:
    """Return the exit code where standard output takes no more; tell why if not all was wanted."""
    # What is left in its buffer has nowhere to go.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(error, BrokenPipeError):  # the reader, such as head, has what it wants
        return 0
    print(f"{_prefix(sys.stderr, RED)}cannot print: {error.strerror or error}", file=sys.stderr)
    return BAD_INPUT


def log_to_stderr(options: argparse.Namespace, folder: str = "") -> None:
    """Send the package's log to standard error, and nowhere else: warnings in color there.

    Parameters
    ----------
    folder : of files that stand for standard streams, which is not told
    """
    level = logging.ERROR if options.quiet else logging.INFO
    logger = logging.getLogger("scaffold_cad")
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_Lines(folder))
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG if options.verbose else level)
    logger.propagate = False


class _Lines(logging.Formatter):
    """A line a record."""

    def __init__(self, folder: str) -> None:
        super().__init__()
        self._folder = folder

    def format(self, record: logging.LogRecord) -> str:
        """Return the line of a record."""
        color = YELLOW if record.levelno >= logging.WARNING else ""
        return _prefix(sys.stderr, color) + _without(with_flags(record.getMessage()), self._folder)


def _without(text: str, folder: str) -> str:
    """Return a text without the folder of files that stand for standard streams."""
    return text.replace(f"{folder}{os.sep}", "") if folder else text


def _prefix(stream: TextIO, color: str) -> str:
    """Return what a line begins with: in color on a terminal, but where NO_COLOR is set."""
    if color and stream.isatty() and not os.environ.get("NO_COLOR"):
        return f"{color}scaffold-cad:{PLAIN} "
    return "scaffold-cad: "
