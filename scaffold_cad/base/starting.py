"""Ctrl-C while the command is still being imported: it ends as it does later, without a traceback.

Importing this module sees to it, until `started`, in processes of `scaffold-cad` and of
`python -m scaffold_cad` only.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from threading import current_thread, main_thread
from typing import NoReturn

INTERRUPTED = 130
"""Exit code of what a signal ended."""

COMMAND = "scaffold-cad"
PACKAGE = "scaffold_cad"


def end_on_interrupt() -> None:
    """Let Ctrl-C end this process at once, if it is one of the command: it has begun no file."""
    if not _of_command() or current_thread() is not main_thread():
        return
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def started() -> None:
    """Let Ctrl-C raise KeyboardInterrupt again, if `end_on_interrupt` had changed that."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _of_command() -> bool:
    """Return whether this process runs the command, or was started by it."""
    script = Path(sys.argv[0] if sys.argv else "")
    if str(script) == "-m":  # stands there while Python imports the package that it is to run
        module = " ".join(sys.orig_argv).partition(" -m")[2].split()
        return module[:1] != [] and module[0].partition(".")[0] == PACKAGE
    return script.stem == COMMAND or Path(__file__).parents[1] in script.parents


def _end(*_: object) -> NoReturn:
    # Not by an exception: modules in C that are being imported make an ImportError of that.
    if sys.argv[0] in sys.orig_argv:  # processes that the command started are quiet
        os.write(2, f"{COMMAND}: interrupted\n".encode())
    os._exit(INTERRUPTED)


end_on_interrupt()
