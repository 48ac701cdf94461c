"""Our own format: JSON with the fields of a Skeleton.

::

    {
      "format": "scaffold-cad skeleton",
      "version": 2,
      "units": "mm",
      "nodes": [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]],
      "edges": [[0, 1]],
      "radii": [1.0, 1.5],
      "edge_radii": [[1.0, 1.5]]
    }

Edges count nodes from 0. ``radii`` may be left out, and then whoever reads the file must give a
radius; further keys are ignored. ``edge_radii`` are those of each edge at both ends, by default
those of its nodes. A change that old readers would misread raises ``version``: version 1 has no
``edge_radii``, and is written where there are none to say.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import as_points
from scaffold_cad.errors import FormatError
from scaffold_cad.io._document import check_numbers, member, read_document
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer
from scaffold_cad.skeleton import Skeleton

FORMAT = "scaffold-cad skeleton"
VERSIONS = (1, 2)
UNITS = "mm"


def _recognizes(head: bytes) -> bool:
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") and FORMAT.encode() in head


@register_reader("scaffold-cad JSON", ".json", recognizes=_recognizes)
def read_json(path: Path) -> RawSkeleton:
    """Read a skeleton from our JSON format, which this module documents."""
    document = _document(path)
    for key in ("nodes", "edges", "radii", "edge_radii"):
        if document.get(key) is not None:
            check_numbers(path, document[key], key)
    nodes = as_points(document["nodes"], "nodes")
    of_edges = document.get("edge_radii") if document["version"] > 1 else None
    return RawSkeleton(nodes, document["edges"], document.get("radii"), of_edges, unit=UNITS)


@register_writer(".json", name="scaffold-cad JSON", solids=False, names_unit=True)
def write_json(content: Content, path: Path) -> None:
    """Write the Skeleton that `write` is given in our JSON format."""
    path.write_text(skeleton_to_json(content.skeleton("a JSON file")), encoding="utf-8")


@checks_keywords()
def skeleton_to_json(skeleton: Skeleton) -> str:
    """Return `skeleton` as text in our JSON format, one node, edge or radius per line.

    Numbers are written so that reading them gives the same float64.
    """
    own = skeleton.has_member_radii
    fields: dict[str, Any] = {"format": FORMAT, "version": VERSIONS[own], "units": UNITS}
    lines = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in fields.items()]
    rows = {"nodes": skeleton.nodes, "edges": skeleton.edges, "radii": skeleton.radii}
    if own:
        rows["edge_radii"] = skeleton.edge_radii
    lines += [f'  "{key}": [{_block(values.tolist())}]' for key, values in rows.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _block(values: list[Any]) -> str:
    """Return the items of a list on a line each."""
    if not values:
        return ""
    return "\n    " + ",\n    ".join(str(value) for value in values) + "\n  "


def _document(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file, if it is of our format and of a version we know."""
    document = read_document(path)
    if document.get("format") != FORMAT:
        raise FormatError(f'{path} is JSON of another kind; need "format": "{FORMAT}"')
    for key, known in (("version", VERSIONS), ("units", (UNITS,))):
        if document.get(key) not in known:
            need = " or ".join(map(json.dumps, known))
            found = f'"{key}": {json.dumps(document[key])}' if key in document else f'no "{key}"'
            raise FormatError(f"{path} has {found}; need {need}")
    for key in ("nodes", "edges"):
        member(path, document, key, list)
    return document
