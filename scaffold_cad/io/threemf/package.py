"""The archive of a 3MF file that is written as text: its parts, and rows of vertices."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from scaffold_cad.base.arrays import Points
from scaffold_cad.io._rows import decimal, rows_of
from scaffold_cad.io.threemf.model import RELATIONSHIPS, START_PART

PACKING = 1
"""Level of compression: higher ones take three times as long for a tenth of the size."""

_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS = (
    f'<?xml version="1.0" encoding="UTF-8"?>\n<Relationships xmlns="{RELATIONSHIPS}">'
    f'<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="{START_PART}"/></Relationships>\n'
)


@contextmanager
def model_part(path: Path, head: str) -> Iterator[IO[bytes]]:
    """Give the model part of a new 3MF file, open behind `head`, the start of its resources."""
    with ZipFile(path, "w", ZIP_DEFLATED, compresslevel=PACKING) as archive:
        for name, text in (("[Content_Types].xml", _TYPES), ("_rels/.rels", _RELATIONS)):
            archive.writestr(_entry(name), text)
        with archive.open(_entry("3D/3dmodel.model"), "w", force_zip64=True) as file:
            file.write(head.encode())
            yield file
            file.write(b"</model>\n")


def _entry(name: str) -> ZipInfo:
    """Return an entry without the time of day: the same lattice gives the same bytes."""
    entry = ZipInfo(name)
    entry.compress_type = ZIP_DEFLATED
    entry._compresslevel = PACKING  # type: ignore[attr-defined]  # public since Python 3.13
    return entry


def vertex_rows(positions: Points, decimals: int) -> bytes:
    """Return the elements of vertices at positions (n, 3), a line each."""
    if len(positions) == 0:
        return b""
    x, y, z = (decimal(positions[:, axis], decimals) for axis in range(3))
    return rows_of(b'<vertex x="', x, b'" y="', y, b'" z="', z, b'"/>\n')
