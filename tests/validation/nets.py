"""The periodic nets of a folder of Systre files read, built and classified.

`python -m tests.validation.nets FOLDER` prints how many are certified and names the others. The
wheel of the package pormake (MIT) holds 2 404 files, most of them of the database RCSR
(O'Keeffe, Peskov, Ramsden, Yaghi, Accounts of Chemical Research 41, 2008):
`pip download --no-deps pormake`, unpack it, and give `pormake/database/topologies`.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from scaffold_cad import build_scaffold, check_skeleton, tile
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.io import read_nets
from scaffold_cad.lattice import UnitCell

THIN = 0.02
"""Radius of struts, in lengths of the shortest one."""


def outcome(cell: UnitCell) -> str:
    """Return what becomes of a block of one cell: certified, overlaps, or the error's name."""
    size = 10.0 * cell.proportions
    radius = THIN * float(cell.strut_lengths(size).min())
    try:
        skeleton = tile(cell, size, 1, radius=radius).cleaned().skeleton
        check_skeleton(skeleton)
        embedding = build_scaffold(skeleton, collars=True).embedding()
    except ScaffoldCadError as error:
        return f"{type(error).__name__}: {error}"
    return "certified" if embedding.certified else "overlaps"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--every", type=int, default=1, help="take every so manieth file")
    options = parser.parse_args()
    found: Counter[str] = Counter()
    began = time.perf_counter()
    for path in sorted(options.folder.glob("*.cgd"))[:: options.every]:
        try:
            results = [(cell.name, outcome(cell)) for cell in read_nets(path)]
        except ScaffoldCadError as error:
            results = [(path.stem, f"not read: {error}")]
        for name, result in results:
            kind = result.split(":")[0]
            found[kind] += 1
            if kind != "certified":
                print(name, result[:160])
        sys.stdout.flush()
    total = sum(found.values())
    for kind, count in found.most_common():
        print(f"{kind}: {count} of {total}, {np.round(100 * count / total, 2)} %")
    print(f"{time.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
