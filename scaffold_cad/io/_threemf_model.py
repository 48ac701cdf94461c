# The names and arguments of SAX handlers are SAX's.
# ruff: noqa: N802, ARG002
"""One model part of a 3MF archive: its objects with their beams, and what it builds.

Names follow the specification: 3MF Core 1.3, Beam Lattice 1.2 and Production 1.1.
"""

from __future__ import annotations

import logging
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import IO, TypeAlias
from xml.sax import SAXException, SAXParseException
from xml.sax.handler import ContentHandler
from xml.sax.xmlreader import AttributesNSImpl, Locator

import numpy as np
from defusedxml.common import DefusedXmlException
from defusedxml.expatreader import DefusedExpatParser

from scaffold_cad.base.arrays import Edges, Floats, Points
from scaffold_cad.errors import FormatError
from scaffold_cad.io._text import line_error

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
BEAM_LATTICE = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
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

Name: TypeAlias = tuple[str | None, str]
"""Namespace and local name."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Lattice:
    """Beams, with the radius of each node."""

    nodes: Points
    """Node positions, shape (n, 3), mm."""
    edges: Edges
    """Node pairs, shape (m, 2)."""
    radii: Floats
    """Radius of each node, shape (n,), mm; NaN or ≤ 0 where the file says so."""

    def placed(self, transform: Floats) -> Lattice:
        """Return the lattice after a transform (4, 3), radii scaled as its volume's cube root."""
        growth = np.cbrt(abs(np.linalg.det(transform[:3])))
        nodes = self.nodes @ transform[:3] + transform[3]
        return Lattice(nodes, self.edges, self.radii * growth)


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
    """An object: its own beams, and other objects placed in it."""

    lattice: Lattice
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
    handler = _ModelHandler(name)
    _parse(name, stream, handler)
    return handler.model


def read_start_part(name: str, stream: IO[bytes]) -> str | None:
    """Return the name of the part that the archive's relationships tell to begin with."""
    handler = _RelationshipsHandler()
    _parse(name, stream, handler)
    return handler.start_part


def _parse(name: str, stream: IO[bytes], handler: ContentHandler) -> None:
    parser = DefusedExpatParser(namespaceHandling=1, forbid_dtd=True)
    parser.setContentHandler(handler)
    try:
        parser.parse(stream)
    except FormatError:
        raise
    except SAXParseException as error:
        line = error.getLineNumber() or 1
        raise line_error(name, line, error.getMessage(), "well-formed XML") from None
    except DefusedXmlException:
        raise FormatError(f"{name} declares a document type or entities; need none") from None
    except (SAXException, LookupError, ValueError) as error:
        raise FormatError(f"{name} cannot be read: {error}; need XML in UTF-8") from None


class _RelationshipsHandler(ContentHandler):
    """Finds the relationship that names the start part."""

    def __init__(self) -> None:
        super().__init__()
        self.start_part: str | None = None

    def startElementNS(self, name: Name, qname: str | None, attrs: AttributesNSImpl) -> None:
        wanted = name == (RELATIONSHIPS, "Relationship")
        if wanted and attrs.get((None, "Type")) == START_PART:
            self.start_part = attrs.get((None, "Target"))


class _ModelHandler(ContentHandler):
    """Collects the objects and items of a model part."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.model = Model()
        self._name = name
        self._place: Locator = Locator()
        self._unit = 1.0  # mm
        self._object_id = ""
        self._radius = float("nan")  # of beams that have none of their own
        self._begin_object()
        self._starts: dict[Name, Callable[[AttributesNSImpl], None]] = {
            (CORE, "model"): self._start_model,
            (CORE, "object"): self._start_object,
            (CORE, "vertex"): self._start_vertex,
            (CORE, "component"): self._start_component,
            (CORE, "item"): self._start_item,
            (BEAM_LATTICE, "beamlattice"): self._start_beamlattice,
            (BEAM_LATTICE, "beam"): self._start_beam,
        }

    def setDocumentLocator(self, locator: Locator) -> None:
        self._place = locator

    def startElementNS(self, name: Name, qname: str | None, attrs: AttributesNSImpl) -> None:
        start = self._starts.get(name)
        if start is not None:
            start(attrs)

    def endElementNS(self, name: Name, qname: str | None) -> None:
        if name == (CORE, "object"):
            lattice = _lattice(self._vertices, self._beams, self._radii, self._unit)
            self.model.objects[self._object_id] = Object(lattice, self._components)
            self._begin_object()

    def _begin_object(self) -> None:
        self._vertices = array("d")
        self._beams = array("q")
        self._radii = array("d")
        self._components: list[Placement] = []

    def _start_model(self, attrs: AttributesNSImpl) -> None:
        unit = attrs.get((None, "unit"), "millimeter").strip()
        if unit not in UNITS:
            raise self._error(f"unit is {unit!r}", f"one of {', '.join(UNITS)}")
        self._unit = UNITS[unit]

    def _start_object(self, attrs: AttributesNSImpl) -> None:
        self._object_id = self._text(attrs, "id")

    def _start_vertex(self, attrs: AttributesNSImpl) -> None:
        self._vertices.extend([self._number(attrs, axis) for axis in "xyz"])

    def _start_beamlattice(self, attrs: AttributesNSImpl) -> None:
        self._radius = self._number(attrs, "radius", float("nan"))
        clipping = attrs.get((None, "clippingmode"), "none")
        if clipping != "none":
            _log.warning(
                "%s: the lattice of object %s is to be clipped (%s); it is read whole",
                self._name,
                self._object_id,
                clipping,
            )

    def _start_beam(self, attrs: AttributesNSImpl) -> None:
        self._beams.append(self._vertex(attrs, "v1"))
        self._beams.append(self._vertex(attrs, "v2"))
        radius = self._number(attrs, "r1", self._radius)
        self._radii.append(radius)
        self._radii.append(self._number(attrs, "r2", radius))

    def _start_component(self, attrs: AttributesNSImpl) -> None:
        self._components.append(self._placement(attrs))

    def _start_item(self, attrs: AttributesNSImpl) -> None:
        self.model.items.append(self._placement(attrs))

    def _placement(self, attrs: AttributesNSImpl) -> Placement:
        transform = np.eye(4, 3)
        if (None, "transform") in attrs:
            transform = self._transform(self._text(attrs, "transform"))
            transform[3] *= self._unit
        part = attrs.get((PRODUCTION, "path"))
        return Placement(self._text(attrs, "objectid"), part, transform)

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

    def _vertex(self, attrs: AttributesNSImpl, name: str) -> int:
        text = self._text(attrs, name)
        count = len(self._vertices) // 3
        try:
            index = int(text)
        except ValueError:
            index = -1
        if not 0 <= index < count:
            raise self._error(f"{name} is {text!r}", f"a vertex, 0 to {count - 1}")
        return index

    def _number(self, attrs: AttributesNSImpl, name: str, default: float | None = None) -> float:
        if default is not None and (None, name) not in attrs:
            return default
        text = self._text(attrs, name)
        try:
            return float(text)
        except ValueError:
            raise self._error(f"{name} is {text!r}", "a number") from None

    def _text(self, attrs: AttributesNSImpl, name: str) -> str:
        text = attrs.get((None, name))
        if text is None:
            raise self._error(f"there is no {name!r}", "that attribute")
        return str(text).strip()

    def _error(self, found: str, needed: str) -> FormatError:
        return line_error(self._name, self._place.getLineNumber() or 1, found, needed)


def _lattice(
    vertices: array[float], beams: array[int], radii: array[float], unit: float
) -> Lattice:
    """Return the beams of an object in mm, without the vertices that none of them uses."""
    points = np.asarray(vertices).reshape(-1, 3) * unit
    ends = np.asarray(beams, dtype=np.intp)
    used, node = np.unique(ends, return_inverse=True)
    largest = np.full(len(used), np.nan)
    np.fmax.at(largest, node, np.asarray(radii) * unit)
    return Lattice(points[used], node.reshape(-1, 2), largest)
