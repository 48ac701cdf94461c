"""Works done tile by tile: a file per tile, a manifest of them, and one file of all.

Tasks run through joblib: one after the other, in processes of this machine
(``joblib.parallel_config(n_jobs=2)``), or on a cluster (``joblib.parallel_config("dask")``). A task
writes its file whole or not at all, and one whose file is there already is left out. So whatever
ends a run, the same call goes on where it was.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from scaffold_cad.base.arguments import as_path, checks_keywords
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import make_folder, replacing
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import FormatError
from scaffold_cad.tiles.tiling import LatticeTiles, SkeletonTiles, Source
from scaffold_cad.tiles.works import Work

VERSION = 1
"""Version of manifests and of what tasks write; it grows when either changes."""

MANIFEST = "manifest.json"


@checks_keywords()
@dataclass(frozen=True)
class TileFile:
    """A file that a task wrote."""

    name: str
    """In its folder."""
    bytes: int
    sha256: str
    """Of its content."""


@checks_keywords()
@dataclass(frozen=True)
class Manifest:
    """The files of all tiles, in their order, and what they were made of."""

    folder: Path
    """Where the files are."""
    key: str
    """Hash of the tiles and of the work."""
    files: tuple[TileFile, ...]

    def __str__(self) -> str:
        size = sum(file.bytes for file in self.files) / 1e6
        return f"Manifest: {counted(len(self.files), 'file')} in {self.folder}, {size:.3g} MB"

    def joined(self, work: Work, path: str | PathLike[str]) -> None:
        """Put the files of all tiles together in one, written whole or not at all.

        Raises
        ------
        FormatError
            If a tile's file is missing or is not the one that its task wrote; it is named.
        """
        paths = [self.folder / file.name for file in self.files]
        for file, place in zip(self.files, paths, strict=True):
            if not place.is_file() or _sha256(place) != file.sha256:
                raise FormatError(f"{place} is missing or was changed; need it as made (run again)")
        with replacing(as_path(path)) as fresh:
            work.join(paths, fresh)


@checks_keywords()
def run_tiles(
    parts: SkeletonTiles | LatticeTiles, work: Work, folder: str | PathLike[str]
) -> Manifest:
    """Do a work for each tile, and return where the results are.

    Tasks run as joblib is configured, see `joblib.parallel_config`; on a cluster all machines must
    see the folder. Each task has one thread, so that results do not depend on where it runs.

    Parameters
    ----------
    parts : see `tiles`
    work : such as `Build` or `Check`
    folder : of the tiles' files, which is made if it is not there; tiles whose file is there
        already, made of the same by the same work, are not made again

    Raises
    ------
    MeshError, SkeletonError, ...
        What the work raises of a tile.
    FormatError
        If a file cannot be written.
    MissingBackendError
        If joblib is not installed.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from scaffold_cad import PeriodicLattice
    >>> from scaffold_cad.tiles import Build, run_tiles, tiles
    >>> parts = tiles(PeriodicLattice("bcc", 5.0, 4, radius=0.4), block=2)
    >>> with TemporaryDirectory() as folder:
    ...     manifest = run_tiles(parts, Build(), folder)
    ...     manifest.joined(Build(), f"{folder}/all.stl")
    >>> len(manifest.files), manifest.files[0].name
    (8, 'tile-000000.stl')
    """
    need("joblib", "work on tiles")
    import joblib

    target = as_path(folder, "folder").absolute()  # processes may be elsewhere
    make_folder(target)
    key = str(joblib.hash((VERSION, type(work).__name__, vars(work), parts.content)))
    files = joblib.Parallel()(
        joblib.delayed(_task)(parts.source(number), number, work, target, key)
        for number in range(len(parts))
    )
    manifest = Manifest(target, key, tuple(files))
    _write(target / MANIFEST, _as_json(manifest, work))
    return manifest


def _task(source: Source, number: int, work: Work, folder: Path, key: str) -> TileFile:
    """Write a tile's file unless it is there, and return what is known of it."""
    path = folder / f"tile-{number:06d}{work.suffix}"
    note = folder / f"tile-{number:06d}.done"
    found = _done(path, note, key)
    if found is None:
        with threadpool_limits(1):
            content = work.made(source.made())
        _write(path, content)
        found = TileFile(path.name, len(content), sha256(content).hexdigest())
        _write(note, json.dumps({"key": key, **asdict(found)}).encode())
    return found


def _done(path: Path, note: Path, key: str) -> TileFile | None:
    """Return what is known of a tile's file if it is there, whole and made of the same."""
    try:
        known = json.loads(note.read_text("utf-8"))
        if known.pop("key") != key or _sha256(path) != known["sha256"]:
            return None
        return TileFile(**known)
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _write(path: Path, content: bytes) -> None:
    with replacing(path) as fresh:
        fresh.write_bytes(content)


def _sha256(path: Path) -> str:
    digest = sha256()
    with path.open("rb") as file:
        while piece := file.read(1 << 20):
            digest.update(piece)
    return digest.hexdigest()


def _as_json(manifest: Manifest, work: Any) -> bytes:
    content = {
        "version": VERSION,
        "work": repr(work),
        "key": manifest.key,
        "tiles": [asdict(file) for file in manifest.files],
    }
    return (json.dumps(content, indent=1) + os.linesep).encode()
