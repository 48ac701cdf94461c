"""How long the usual work takes, beside other packages: `python -m tests.benchmarks [NAME ...]`.

Every piece of work runs in a process of its own, so that its peak of memory is its own; times are
of the processor. Peers that are not installed, or take longer than `--patience`, are left out.
Layers, beams and tiles have no peer here: what the literature says of them is printed at the end.
With names only the rows that hold one of them are measured; `--no-peers` leaves out all peers.
"""

from __future__ import annotations

import argparse
from importlib.util import find_spec

from tests.benchmarks.works import ROWS, measure

LITERATURE = """
Of the literature, what compares with the rows of layers, beams and tiles, and what does not:
- Liu et al., Memory-efficient modeling and slicing of large-scale adaptive lattice structures,
  J. Comput. Inf. Sci. Eng. 21 (2021) 061003: layers of up to 10^8 struts with the memory of some.
  Theirs are sections of convolution surfaces, for toolpaths; here a lattice of 10^9 struts is cut,
  of which only some cells are made, and struts are cylinders.
- Foucault et al., A direct slicing method for optimized lattice structures, Mechanics & Industry 25
  (2024) 26: exact sections of cylinders and cones from a skeleton, as here. Its abstract has no
  rates.
- Messner, Fast, efficient direct slicing method for lattice structures, US 10723079 B2 (2020):
  pixels of layers by rays cast at struts; compares with images only. Its abstract has no rates.
- Zou et al., Meta-meshing and triangulating lattice structures at a large scale, arXiv:2405.15197
  (2024): triangles of 10^9 struts on a GPU; a processor without one does not compare.
- 3MF beams: we know of no published rates of writers.
Times of other machines do not compare with those above; sizes do."""


def main() -> None:
    """Measure and print a line per row."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="measure only rows whose name holds one of these")
    parser.add_argument("--no-peers", action="store_true", help="measure this package only")
    parser.add_argument("--patience", type=float, default=300.0, help="s, default: 300")
    options = parser.parse_args()
    print(f"{'':26}{'time':>9}{'aim':>9}{'peak':>10}   {'peer':12}{'time':>9}{'ratio':>9}")
    for row in ROWS:
        if options.names and not any(name in row.name for name in options.names):
            continue
        ours = measure(row, row.ours, options.patience)
        if ours is None:
            print(f"{row.name:26}   failed, or took longer than {options.patience:g} s")
            continue
        line = f"{row.name:26}{ours.seconds:>7.2f} s{row.aim:>7.2f} s{ours.megabytes:>7.0f} MB"
        if row.peer is not None and not options.no_peers and find_spec(row.package):
            theirs = measure(row, row.peer, options.patience)
            line += f"   {row.package:12}"
            line += (
                f"{'none':>9}{'':>9}"
                if theirs is None
                else f"{theirs.seconds:>7.1f} s{theirs.seconds / ours.seconds:>8.1f}×"
            )
        if row.count:
            line += f"   {row.count / ours.seconds:,.0f} {row.unit} per second"
        if ours.told:
            line += f"; {ours.told}"
        if row.times > 1:
            hours = row.times * ours.seconds / 3600
            line += f"; all of it, {row.times:g} times as much: {hours:.1f} h (not measured)"
        print(line, flush=True)
    if not options.names:
        print(LITERATURE)


if __name__ == "__main__":
    main()
