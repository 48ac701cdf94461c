"""`python -m tests.fuzz.guided swc json`: files that reach new branches of a reader are mutated on.

Needs atheris (`pip install '.[fuzz]'`). A file that is read or refused badly is kept in the working
directory as `crash-…`.
"""

from __future__ import annotations

import argparse
import logging
import os
import subprocess
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris

with atheris.instrument_imports(include=["scaffold_cad"]):
    from tests.fuzz.mutation import NUMBERS, TOKENS
    from tests.fuzz.reading import outcome
    from tests.fuzz.samples import MODEL_3MF, SAMPLES, packed_3mf

PACKED_MODEL = "model"
"""The format name for the model within a 3MF file, packed anew for each case."""

LONGEST_FILE = 20_000
"""Bytes; the samples have up to 6 600, but for those of DXF 2000."""


def seeds_of(name: str) -> list[bytes]:
    """Return the samples of a format, by the suffix of their names."""
    if name == PACKED_MODEL:
        return [MODEL_3MF]
    return [content for path, content in SAMPLES.items() if path.endswith(f".{name}")]


FORMATS = (*dict.fromkeys(Path(name).suffix[1:] for name in SAMPLES), PACKED_MODEL)


def main() -> int:
    """Fuzz each format in a process of its own; return 1 if any file was read or refused badly."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("formats", nargs="*", choices=[*FORMATS, []], metavar="format")
    parser.add_argument("--minutes", type=float, default=10.0, help="of each format")
    parser.add_argument("--here", action="store_true", help="one format in this process")
    options = parser.parse_args()
    if options.here:
        _fuzz(options.formats[0], options.minutes)
    failed = []
    for name in options.formats or FORMATS:
        arguments = [name, "--here", "--minutes", str(options.minutes)]
        run = subprocess.run([sys.executable, "-m", "tests.fuzz.guided", *arguments], check=False)
        if run.returncode != 0:
            failed.append(name)
    print("failed: " + ", ".join(failed) if failed else "no failure")
    return 1 if failed else 0


def _fuzz(name: str, minutes: float) -> None:
    """Fuzz one format and end the process, as libFuzzer does."""
    logging.disable(logging.WARNING)
    warnings.simplefilter("error")
    counts: Counter[str] = Counter()
    folder = TemporaryDirectory()
    suffix = "3mf" if name == PACKED_MODEL else name
    path = Path(folder.name) / f"case.{suffix}"
    stop = time.monotonic() + 60 * minutes

    def read(content: bytes) -> None:
        if time.monotonic() > stop:
            print(f"{name}: {counts['read']} read, {counts['refused']} refused", flush=True)
            folder.cleanup()
            os._exit(0)
        path.write_bytes(packed_3mf(content) if name == PACKED_MODEL else content)
        found = outcome(path)
        counts["read" if found.edges else "refused"] += 1
        if found.fault:
            raise AssertionError(found.fault)

    start = Path(folder.name) / "start"
    start.mkdir()
    for k, content in enumerate(seeds_of(name)):
        (start / f"{k}").write_bytes(content)
    words = Path(folder.name) / "words"
    words.write_text("".join(_quoted(word) for word in (*NUMBERS, *TOKENS) if 0 < len(word) < 60))
    atheris.Setup(
        [
            "guided",
            f"-max_len={LONGEST_FILE}",
            "-rss_limit_mb=1500",
            "-timeout=20",
            "-print_final_stats=0",
            "-verbosity=0",
            f"-dict={words}",
            str(start),
        ],
        read,
    )
    atheris.Fuzz()


def _quoted(word: bytes) -> str:
    """Return a line of libFuzzer's dictionary."""
    return '"' + "".join(f"\\x{byte:02x}" for byte in word) + '"\n'


if __name__ == "__main__":
    sys.exit(main())
