"""What a page draws: layers of surfaces, lines and dots, and how they get into its text."""

from __future__ import annotations

import json
from base64 import b64encode
from dataclasses import dataclass
from importlib.resources import files
from string import Template
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Edges, Floats, Points
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh


@dataclass(frozen=True, eq=False)
class Surface:
    """The faces of a mesh."""

    mesh: QuadMesh | TriangleMesh
    color: str
    """As "#rrggbb"."""
    opacity: float = 1.0
    """In 0..1; a surface that light passes shows no back faces."""

    @property
    def points(self) -> Points:
        """Every point that is drawn, shape (p, 3), mm."""
        return self.mesh.vertices

    def for_json(self) -> dict[str, Any]:
        """Return what the script on the page draws."""
        rows = _base64(self.mesh.triangles.astype("<u4"))
        return {"kind": "surface", "rows": rows, "opacity": self.opacity}


@dataclass(frozen=True, eq=False)
class Lines:
    """Segments between points."""

    points: Points
    """Shape (p, 3), mm."""
    pairs: Edges
    """Points of each segment, shape (s, 2)."""
    color: str
    width: float = 1.0
    """Pixels."""
    through: bool = False
    """Whether they shine through surfaces."""

    def for_json(self) -> dict[str, Any]:
        """Return what the script on the page draws."""
        rows = _base64(self.pairs.astype("<u4"))
        return {"kind": "lines", "rows": rows, "width": self.width, "through": self.through}


@dataclass(frozen=True, eq=False)
class Dots:
    """Points, which shine through surfaces."""

    points: Points
    """Shape (p, 3), mm."""
    color: str
    size: float
    """Diameter, pixels."""

    def for_json(self) -> dict[str, Any]:
        """Return what the script on the page draws."""
        return {"kind": "dots", "size": self.size}


Part: TypeAlias = Surface | Lines | Dots


@dataclass(frozen=True, eq=False)
class Layer:
    """What is shown or hidden together."""

    name: str
    """One word, unlike that of any other layer."""
    parts: tuple[Part, ...]
    shown: bool = True
    """Whether it is shown at first."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that a page draws."""

    layers: tuple[Layer, ...]
    up: Floats
    """Unit vector that points upwards on the page, shape (3,)."""

    def to_json(self) -> str:
        """Return the scene as the script on the page reads it; safe inside a script element."""
        points = np.concatenate(
            [np.zeros((0, 3)), *(part.points for layer in self.layers for part in layer.parts)]
        )
        low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else np.zeros((2, 3))
        middle = (low + high) / 2
        text = json.dumps(
            {
                # The diagonal: all stays in view however it is turned.
                "size": max(float(np.linalg.norm(high - low)), 1e-9),
                "up": self.up.tolist(),
                "floor": float(((points - middle) @ self.up).min(initial=0.0)),
                "layers": [_layer_for_json(layer, middle) for layer in self.layers],
            },
            allow_nan=False,
        )
        return text.replace("<", "\\u003c")


def filled(template: str, scene: Scene, **texts: str) -> str:
    """Return a page: a template with the script that draws, its style, a scene, and texts.

    Parameters
    ----------
    template : HTML with `$style`, `$engine`, `$scene` and the names of `texts`
    texts : put in as they are; escape what comes from outside
    """
    here = files("scaffold_cad.webpage")
    return Template(template).substitute(
        texts,
        style=here.joinpath("style.css").read_text("utf-8"),
        engine=here.joinpath("engine.js").read_text("utf-8"),
        scene=scene.to_json(),
    )


def _layer_for_json(layer: Layer, middle: Floats) -> dict[str, Any]:
    """Return a layer, its points as seen from `middle`: far from the origin 32 bits are few."""
    parts = [
        {
            "points": _base64((part.points - middle).astype("<f4")),
            "color": part.color,
            **part.for_json(),
        }
        for part in layer.parts
    ]
    return {"name": layer.name, "shown": layer.shown, "parts": parts}


def _base64(array: NDArray[np.generic]) -> str:
    return b64encode(array.tobytes()).decode("ascii")
