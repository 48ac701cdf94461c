"""One model part of a 3MF archive: its objects with their meshes and beams, and what it builds.

Names follow the specification: 3MF Core 1.3, Beam Lattice 1.2 with balls, and Production 1.1.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import IO, TypeAlias
from xml.parsers.expat import ErrorString, ExpatError, ParserCreate

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats, Ints, Points, Triangles
from scaffold_cad.errors import FormatError
from scaffold_cad.io._text import line_error

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
BEAM_LATTICE = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
BALLS = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RELATIONSHIPS = "http://schemas.openxmlformats.org/package/2006/relationships"
START_PART = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"

UNITS = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}
"""Length of each unit, mm."""

CAPS = ("sphere", "hemisphere", "butt")
"""How a beam may end; a number stands for each."""

CLIPPING = ("none", "inside", "outside")
BALL_MODES = ("none", "mixed", "all")

Attributes: TypeAlias = dict[str, str]
"""Values by name; a name in a namespace is that, a blank, and the local name."""


@dataclass(frozen=True, eq=False)
class Body:
    """What an object holds itself, in its own coordinates, mm."""

    vertices: Points
    """Positions, shape (v, 3)."""
    triangles: Triangles
    """Vertices of each triangle, shape (t, 3)."""
    beams: Edges
    """Vertices that each beam joins, shape (m, 2)."""
    radii: Floats
    """Radius of both ends of each beam, shape (m, 2); NaN or ≤ 0 where the file says so."""
    caps: Ints
    """How each end of a beam ends, shape (m, 2), numbers of `CAPS`."""
    balls: Floats
    """Radius of the ball at each vertex, shape (v,); 0 for none."""
    clipping: str
    """One of `CLIPPING`: which part of the beams stays."""
    clipping_mesh: str | None
    """The object of the same part that the beams are clipped to."""
    representation_mesh: str | None
    """The object of the same part that stands for the beams in programs that cannot show them."""
    unit: str
    """Name of the unit that the file is in."""

    @property
    def size(self) -> int:
        """Number of beams and triangles."""
        return len(self.beams) + len(self.triangles)


@dataclass(frozen=True, eq=False)
class Placement:
    """An object put somewhere, by the build or as a component of another object."""

    object_id: str
    part: str | None
    """The model part that holds the object; None for the same part."""
    transform: Floats
    """Rows that a position (x, y, z, 1) is multiplied with, shape (4, 3), the last in mm."""


@dataclass(frozen=True, eq=False)
class Object:
    """An object: its own mesh and beams, and other objects placed in it."""

    body: Body
    components: list[Placement]


@dataclass(frozen=True, eq=False)
class Model:
    """What a model part holds."""

    objects: dict[str, Object] = field(default_factory=dict)
    items: list[Placement] = field(default_factory=list)


def read_model(name: str, stream: IO[bytes]) -> Model:
    """Return what a model part holds; `name` is for errors.

    Raises
    ------
    FormatError
        If it is not XML, or an attribute is absent or not what it must be.
    """
    reader = _ModelReader(name)
    _parse(name, stream, reader)
    return reader.model


def read_start_part(name: str, stream: IO[bytes]) -> str | None:
    """Return the name of the part that the archive's relationships tell to begin with."""
    reader = _RelationshipsReader()
    _parse(name, stream, reader)
    return reader.start_part


class _Reader:
    """What is done at elements, by their names as `Attributes` have them."""

    def __init__(self) -> None:
        self.starts: dict[str, Callable[[Attributes], None]] = {}
        self.ends: dict[str, Callable[[], None]] = {}
        self.line: Callable[[], int] = lambda: 1


def _parse(name: str, stream: IO[bytes], reader: _Reader) -> None:
    """Read XML without document types and entities.

    Expat is used as it is: most files are millions of small elements, on which a SAX handler takes
    four times as long.
    """
    parser = ParserCreate(namespace_separator=" ")
    starts, ends = reader.starts, reader.ends

    def start(element: str, attributes: Attributes) -> None:
        found = starts.get(element)
        if found is not None:
            found(attributes)

    def end(element: str) -> None:
        found = ends.get(element)
        if found is not None:
            found()

    def refuse(*_: object) -> None:
        raise FormatError(f"{name} declares a document type or entities; need none")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    reader.line = lambda: parser.CurrentLineNumber
    try:
        parser.ParseFile(stream)
    except ExpatError as error:
        raise line_error(name, error.lineno, ErrorString(error.code), "well-formed XML") from None
    except (LookupError, ValueError) as error:
        if isinstance(error, FormatError):
            raise
        raise FormatError(f"{name} cannot be read: {error}; need XML in UTF-8") from None


class _RelationshipsReader(_Reader):
    """Finds the relationship that names the start part."""

    def __init__(self) -> None:
        super().__init__()
        self.start_part: str | None = None
        self.starts[f"{RELATIONSHIPS} Relationship"] = self._start_relationship

    def _start_relationship(self, attributes: Attributes) -> None:
        if attributes.get("Type") == START_PART:
            self.start_part = attributes.get("Target")


class _ModelReader(_Reader):
    """Collects the objects and items of a model part."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.model = Model()
        self._name = name
        self._unit_name = "millimeter"
        self._unit = 1.0  # mm
        self._object_id = ""
        self._begin_object()
        self.starts |= {
            f"{CORE} model": self._start_model,
            f"{CORE} object": self._start_object,
            f"{CORE} vertex": self._start_vertex,
            f"{CORE} triangle": self._start_triangle,
            f"{CORE} component": self._start_component,
            f"{CORE} item": self._start_item,
            f"{BEAM_LATTICE} beamlattice": self._start_beamlattice,
            f"{BEAM_LATTICE} beam": self._start_beam,
            f"{BALLS} ball": self._start_ball,
            f"{BEAM_LATTICE} ball": self._start_ball,
        }
        self.ends[f"{CORE} object"] = self._end_object

    def _begin_object(self) -> None:
        self._vertices = array("d")
        self._triangles = array("q")
        self._beams = array("q")
        self._radii = array("d")
        self._caps = array("b")
        self._balls: dict[int, float] = {}
        self._ball_mode, self._ball_radius = "none", float("nan")
        self._radius = float("nan")  # of beams that have none of their own
        self._cap = 0
        self._clipping, self._clipping_mesh = "none", ""
        self._representation = ""
        self._components: list[Placement] = []

    def _end_object(self) -> None:
        self.model.objects[self._object_id] = Object(self._body(), self._components)
        self._begin_object()

    def _body(self) -> Body:
        beams = np.asarray(self._beams, dtype=np.intp).reshape(-1, 2)
        count = len(self._vertices) // 3
        balls = np.zeros(count)
        if self._ball_mode == "all" and len(beams):
            balls[np.unique(beams)] = self._ball_radius
        if self._ball_mode != "none" and self._balls:
            balls[np.array([*self._balls])] = [*self._balls.values()]
        return Body(
            np.asarray(self._vertices).reshape(-1, 3) * self._unit,
            np.asarray(self._triangles, dtype=np.intp).reshape(-1, 3),
            beams,
            np.asarray(self._radii).reshape(-1, 2) * self._unit,
            np.asarray(self._caps, dtype=np.intp).reshape(-1, 2),
            balls * self._unit,
            self._clipping,
            self._clipping_mesh or None,
            self._representation or None,
            self._unit_name,
        )

    def _start_model(self, attributes: Attributes) -> None:
        unit = attributes.get("unit", "millimeter").strip()
        if unit not in UNITS:
            raise self._error(f"unit is {unit!r}", f"one of {', '.join(UNITS)}")
        self._unit_name, self._unit = unit, UNITS[unit]

    def _start_object(self, attributes: Attributes) -> None:
        self._object_id = self._text(attributes, "id")

    def _start_vertex(self, attributes: Attributes) -> None:
        row: tuple[float, ...]
        try:
            row = float(attributes["x"]), float(attributes["y"]), float(attributes["z"])
        except (KeyError, ValueError):
            row = tuple(self._number(attributes, axis) for axis in "xyz")
        self._vertices.extend(row)

    def _start_triangle(self, attributes: Attributes) -> None:
        self._triangles.extend([self._vertex(attributes, name) for name in ("v1", "v2", "v3")])

    def _start_beamlattice(self, attributes: Attributes) -> None:
        self._radius = self._number(attributes, "radius", float("nan"))
        self._cap = self._choice(attributes, "cap", CAPS)
        # Files until 2018 have the older name.
        name = "clippingmode" if "clippingmode" in attributes else "clipping"
        self._clipping = CLIPPING[self._choice(attributes, name, CLIPPING)]
        self._clipping_mesh = attributes.get("clippingmesh", "").strip()
        self._representation = attributes.get("representationmesh", "").strip()
        mode = "ballmode" if "ballmode" in attributes else f"{BALLS} ballmode"
        self._ball_mode = BALL_MODES[self._choice(attributes, mode, BALL_MODES)]
        size = "ballradius" if "ballradius" in attributes else f"{BALLS} ballradius"
        self._ball_radius = self._number(attributes, size, float("nan"))
        if self._clipping != "none" and not self._clipping_mesh:
            raise self._error(f"{name} is {self._clipping!r}", "the attribute clippingmesh too")

    def _start_beam(self, attributes: Attributes) -> None:
        self._beams.append(self._vertex(attributes, "v1"))
        self._beams.append(self._vertex(attributes, "v2"))
        radius = self._number(attributes, "r1", self._radius)
        self._radii.append(radius)
        self._radii.append(self._number(attributes, "r2", radius))
        self._caps.append(self._choice(attributes, "cap1", CAPS, self._cap))
        self._caps.append(self._choice(attributes, "cap2", CAPS, self._cap))

    def _start_ball(self, attributes: Attributes) -> None:
        vertex = self._vertex(attributes, "vindex")
        self._balls[vertex] = self._number(attributes, "r", self._ball_radius)

    def _start_component(self, attributes: Attributes) -> None:
        self._components.append(self._placement(attributes))

    def _start_item(self, attributes: Attributes) -> None:
        self.model.items.append(self._placement(attributes))

    def _placement(self, attributes: Attributes) -> Placement:
        transform = np.eye(4, 3)
        if "transform" in attributes:
            transform = self._transform(self._text(attributes, "transform"))
            transform[3] *= self._unit
        part = attributes.get(f"{PRODUCTION} path")
        return Placement(self._text(attributes, "objectid"), part, transform)

    def _transform(self, text: str) -> Floats:
        try:
            values = [float(word) for word in text.split()]
        except ValueError:
            values = []
        matrix = np.asarray(values)
        if len(values) != 12 or not np.isfinite(matrix).all():
            raise self._error(f"transform is {text!r}", "12 finite numbers")
        matrix = matrix.reshape(4, 3)
        if np.linalg.matrix_rank(matrix[:3]) < 3:
            raise self._error(f"transform is {text!r}", "one that does not flatten")
        return matrix

    def _vertex(self, attributes: Attributes, name: str) -> int:
        text = attributes.get(name)
        if text is None:
            raise self._error(f"there is no {name!r}", "that attribute")
        count = len(self._vertices) // 3
        try:
            index = int(text)
        except ValueError:
            index = -1
        if not 0 <= index < count:
            raise self._error(f"{name} is {text.strip()!r}", f"a vertex, 0 to {count - 1}")
        return index

    def _choice(
        self, attributes: Attributes, name: str, known: tuple[str, ...], default: int = 0
    ) -> int:
        """Return which of the `known` values an attribute has."""
        text = attributes.get(name)
        if text is None:
            return default
        if text.strip().lower() not in known:
            raise self._error(
                f"{name.split()[-1]} is {text.strip()!r}", f"one of {', '.join(known)}"
            )
        return known.index(text.strip().lower())

    def _number(self, attributes: Attributes, name: str, default: float | None = None) -> float:
        if default is not None and name not in attributes:
            return default
        text = self._text(attributes, name)
        try:
            return float(text)
        except ValueError:
            raise self._error(f"{name} is {text!r}", "a number") from None

    def _text(self, attributes: Attributes, name: str) -> str:
        text = attributes.get(name)
        if text is None:
            raise self._error(f"there is no {name!r}", "that attribute")
        return text.strip()

    def _error(self, found: str, needed: str) -> FormatError:
        return line_error(self._name, self.line() or 1, found, needed)
