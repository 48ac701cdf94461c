"""What the examples share: where they read skeletons, and how they write and say so."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from scaffold_cad import Skeleton, read_skeleton, write

SKELETONS = Path(__file__).parent / "skeletons"


def skeleton(name: str) -> Skeleton:
    """Return the skeleton kept in `skeletons/NAME.json`."""
    return read_skeleton(SKELETONS / f"{name}.json", strict=True)


def out_folder(about: str | None) -> Path:
    """Return the folder that --out names, by default the current one; it is made if need be."""
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path(), help="folder to write to")
    folder: Path = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def save(what: Any, path: Path) -> None:
    """Write `what` to the file at `path` and say so."""
    write(what, path)
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")
