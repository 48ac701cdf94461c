"""`python -m tests.fuzz.guided swc 3dm`: files that reach new branches of a reader are mutated on.

Needs atheris (`pip install '.[fuzz]'`). Readers whose library may end its process are run in the
process of the fuzzer here; a file that ends it is then read as a program reads it. What is read or
refused badly by that is kept in the working directory as `fault-…`.
"""

from __future__ import annotations

import argparse
import logging
import os
import resource
import subprocess
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris

if "--here" in sys.argv:  # it takes seconds, and only the process that fuzzes needs it
    with atheris.instrument_imports(include=["scaffold_cad.io", "scaffold_cad.skeleton", "meshio"]):
        from tests.fuzz.reading import outcome
else:
    from tests.fuzz.reading import outcome

from tests.fuzz.members import APART, sample_apart
from tests.fuzz.mutation import NUMBERS, TOKENS
from tests.fuzz.samples import MODEL_3MF, SAMPLES, packed_3mf

PACKED_MODEL = "model"
"""The format name for the model within a 3MF file, packed anew for each case."""

LONGEST_FILE = 20_000
"""Bytes; the samples have up to 6 600, but for those of DXF 2000, of Rhino and of MED."""

LONGEST_READ = 10
"""Seconds after which a reader hangs."""

MEMORY = 2 * 2**30
"""Most memory that a reader may take beside its libraries, bytes."""

NAMES = (*SAMPLES, *APART)
FORMATS = (*dict.fromkeys(Path(name).suffix[1:] for name in NAMES), PACKED_MODEL)


def seeds_of(name: str) -> list[bytes]:
    """Return the samples of a format, by the suffix of their names."""
    if name == PACKED_MODEL:
        return [MODEL_3MF]
    suffix = f".{name}"
    there = [content for path, content in SAMPLES.items() if path.endswith(suffix)]
    return there + [sample_apart(path) for path in APART if path.endswith(suffix)]


def main() -> int:
    """Fuzz each format in processes of its own; return 1 if any file was read or refused badly."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("formats", nargs="*", choices=[*FORMATS, []], metavar="format")
    parser.add_argument(
        "--minutes", type=float, default=10.0, help="of the processor, for each format"
    )
    parser.add_argument("--here", type=Path, help="one format in this process: folder of its files")
    parser.add_argument("--read", type=Path, help="read this file, and tell what is wrong with it")
    parser.add_argument("--seed", type=int, default=1, help="another one tries other files")
    options = parser.parse_args()
    if options.read:
        return _tell(options.read)
    if options.here:
        _fuzz(options.formats[0], options.minutes, options.here, options.seed)
    names = options.formats or FORMATS
    failed = [name for name in names if _failed(name, options.minutes, options.seed)]
    print("failed: " + ", ".join(failed) if failed else "no failure")
    return 1 if failed else 0


def _failed(name: str, minutes: float, seed: int) -> bool:
    """Fuzz one format for some minutes, again where a library ends; return whether it failed."""
    start = _spent()
    faults, ends, counts = 0, 0, Counter[str]()
    with TemporaryDirectory() as there:
        folder = Path(there)
        for part in ("files", "ended"):
            (folder / part).mkdir()
        for k, content in enumerate(seeds_of(name)):
            (folder / "files" / f"{k}").write_bytes(content)
        while (left := minutes - _spent() + start) > 0.05 and faults < 5:
            words = [name, "--here", there, "--minutes", f"{left}", "--seed", f"{seed + ends}"]
            _run(words)
            for line in (folder / "counts").read_text().split():
                counts[line] += 1
            for path in sorted((folder / "ended").iterdir()):
                ends += 1
                faults += _kept(path, name)
                path.unlink()
    print(
        f"{name}: {minutes:g} min, {counts['read']} read, {counts['refused']} refused, "
        f"{ends} ended their library, {faults} faults",
        flush=True,
    )
    return faults > 0


def _spent() -> float:
    """Return the time of the processor that processes of this one have taken, minutes."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (used.ru_utime + used.ru_stime) / 60


def _run(words: list[str]) -> subprocess.CompletedProcess[str]:
    """Run this module in a process, of which only what is printed counts: libFuzzer tells much."""
    command = [sys.executable, "-m", "tests.fuzz.guided", *words]
    return subprocess.run(command, check=False, text=True, capture_output=True)


def _kept(path: Path, name: str) -> bool:
    """Read a file as programs do; return whether that goes wrong, and keep the file if so."""
    suffix = "3mf" if name == PACKED_MODEL else name
    content = path.read_bytes()
    case = path.parent.parent / f"case.{suffix}"
    case.write_bytes(packed_3mf(content) if name == PACKED_MODEL else content)
    start = _spent()
    run = _run(["--read", str(case)])
    seconds = 60 * (_spent() - start)
    fault = run.stdout.strip() or ("the process ended" if run.returncode else "")
    if not fault and seconds > LONGEST_READ:
        fault = f"took {seconds:.0f} s"
    if fault:
        kept = Path(f"fault-{path.name[-12:]}.{suffix}")
        kept.write_bytes(case.read_bytes())
        print(f"{name}: {kept}: {fault}", flush=True)
    return bool(fault)


def _tell(path: Path) -> int:
    """Read a file as programs do; print what is wrong with how it is read, and return 1 if so."""
    logging.disable(logging.WARNING)
    warnings.simplefilter("error")
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY + 2**30, MEMORY + 2**30))
    fault = outcome(path).fault
    print(fault)
    return 1 if fault else 0


def _fuzz(name: str, minutes: float, folder: Path, seed: int) -> None:
    """Fuzz one format and end the process, as libFuzzer does."""
    logging.disable(logging.WARNING)
    warnings.simplefilter("error")
    sys.executable = "host"  # so that readers run their libraries in this process
    path = folder / f"case.{'3mf' if name == PACKED_MODEL else name}"
    stop = 60 * minutes  # of the processor, with what the imports have taken
    counts = (folder / "counts").open("w", buffering=1)

    def read(content: bytes) -> None:
        if time.process_time() > stop:
            counts.flush()
            os._exit(0)
        path.write_bytes(packed_3mf(content) if name == PACKED_MODEL else content)
        found = outcome(path)
        counts.write("read\n" if found.edges else "refused\n")
        if found.fault:
            counts.flush()
            raise AssertionError(found.fault)

    words = folder / "words"
    words.write_text("".join(_quoted(word) for word in (*NUMBERS, *TOKENS) if 0 < len(word) < 60))
    atheris.Setup(
        [
            "guided",
            f"-max_len={max(LONGEST_FILE, *(2 * len(content) for content in seeds_of(name)))}",
            f"-rss_limit_mb={MEMORY // 2**20}",
            f"-timeout={LONGEST_READ}",
            "-print_final_stats=0",
            "-verbosity=0",
            f"-seed={seed}",
            f"-artifact_prefix={folder}/ended/",
            f"-dict={words}",
            str(folder / "files"),
        ],
        read,
    )
    atheris.Fuzz()


def _quoted(word: bytes) -> str:
    """Return a line of libFuzzer's dictionary."""
    return '"' + "".join(f"\\x{byte:02x}" for byte in word) + '"\n'


if __name__ == "__main__":
    sys.exit(main())
