"""`python -m tests.fuzz --minutes 10`: mutated files of every format are read."""

from __future__ import annotations

import argparse
import logging
import resource
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from tests.fuzz.members import APART, sample_apart
from tests.fuzz.mutation import mutated
from tests.fuzz.reading import outcome
from tests.fuzz.samples import SAMPLES

BATCH, BATCH_APART = 200, 20
"""Files a sample and a round; of those that are read in processes of their own."""

MEMORY = 3 * 2**30
"""Address space of the process, bytes: about 2 GB of it is libraries."""


def main() -> int:
    """Read mutated files until the time is over; return 1 if any was not read or refused well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--only", default="", help="part of the samples' names; .msh, .med, .step: with it only"
    )
    parser.add_argument("--keep", type=Path, help="folder for the files that failed")
    options = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    logging.disable(logging.WARNING)
    warnings.simplefilter("error")
    stop = time.monotonic() + 60 * options.minutes
    counts: Counter[str] = Counter()
    faults: dict[str, str] = {}
    with TemporaryDirectory() as folder:
        round_number = options.seed
        while time.monotonic() < stop:
            for name, content in _chosen(options.only).items():
                if time.monotonic() < stop:
                    _read_some(Path(folder), name, content, round_number, counts, faults, options)
            round_number += 1
    print(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    for place, name in faults.items():
        print(f"{name}: {place}")
    return 1 if faults else 0


def _chosen(part: str) -> dict[str, bytes]:
    """Return the samples whose names have a part; those read in processes only if there is one."""
    apart = {name: sample_apart(name) for name in APART if part and part in name}
    return {name: content for name, content in SAMPLES.items() if part in name} | apart


def _read_some(
    folder: Path,
    name: str,
    content: bytes,
    round_number: int,
    counts: Counter[str],
    faults: dict[str, str],
    options: argparse.Namespace,
) -> None:
    """Read a batch of mutations of a sample; count what came of them, one fault a place."""

    @seed(round_number)
    @settings(
        max_examples=BATCH_APART if name in APART else BATCH,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(st.data())
    def read(data: st.DataObject) -> None:
        path = folder / name
        path.write_bytes(data.draw(mutated(content)))
        found = outcome(path)
        fault = found.fault
        counts["failed" if fault else "read" if found.edges else "refused"] += 1
        if fault and fault not in faults:
            faults[fault] = name
            if options.keep:
                options.keep.mkdir(exist_ok=True)
                (options.keep / f"{len(faults)}-{name}").write_bytes(path.read_bytes())

    read()


if __name__ == "__main__":
    sys.exit(main())
