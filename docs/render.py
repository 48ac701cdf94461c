"""Draw the pictures of the README into docs/images: `python docs/render.py [NAME ...]`.

Needs the extra `pictures`, and no screen.
"""

from __future__ import annotations

import runpy
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
from build123d import GeomType
from PIL import Image, ImageDraw

from scaffold_cad import (
    Partition,
    QuadMesh,
    RoundStruts,
    Scaffold,
    Skeleton,
    build_scaffold,
    cells,
    partition_sphere,
    round_struts,
    slices,
    thicken,
    tile,
    to_brep,
    to_solid,
    to_trimesh,
)
from scaffold_cad.base.arrays import Bools, Floats, Points, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.brep import tessellated
from scaffold_cad.convolution import ConvolutionField
from scaffold_cad.mechanics import Sized
from scaffold_cad.webpage import write_page

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
GALLERY = ROOT / "examples" / "gallery"
sys.path[:0] = [str(ROOT / "examples"), str(GALLERY)]

# The examples' folders must be found first.
import bracket  # noqa: E402
import canopy  # noqa: E402
import convolution  # noqa: E402
import lattice  # noqa: E402
import octet_beam  # noqa: E402
import overlapping_tree  # noqa: E402
import stick_woman  # noqa: E402
import twist  # noqa: E402
from _common import skeleton  # noqa: E402

INK = "#2b2f36"
SAND = "#f8c977"
BLUE = "#7db4e0"
GRAY = "#9aa4ae"
CORAL = "#ef8a76"
PASTELS = ("#f6c177", "#8fbfe0", "#a8d5a2", "#f2a7a0", "#c9b6e4", "#f3e08e", "#9fd8d2", "#d9b99b")

LIGHTS = (
    {"position": (-2.0, 3.0, 4.0), "color": "#fff6e8", "intensity": 0.85},
    {"position": (3.0, 0.5, 2.5), "color": "#e4edff", "intensity": 0.45},
    {"position": (0.0, -3.0, 1.5), "color": "white", "intensity": 0.2},
)
"""A warm light from the upper left, a cool one from the right, and a little from below."""

STEPS = 8
"""Pieces that a side of a quad is cut into to be drawn."""

FINENESS = 3
"""Pixels drawn along each side of a pixel of the picture."""

MARGIN = 16
"""White pixels left around a picture."""

LABEL = 28
"""Height of the line under a picture of a sheet, pixels."""


def patches(mesh: QuadMesh) -> pv.PolyData:
    """Return the bilinear patches of `mesh` with their own normals: sharp edges, soft insides."""
    u, v = np.meshgrid(*2 * [np.linspace(0, 1, STEPS + 1)], indexing="ij")
    u, v = u.reshape(-1, 1), v.reshape(-1, 1)
    a, b, c, d = (mesh.vertices[mesh.quads[:, k]][:, None, :] for k in range(4))  # (f, 1, 3)
    points = (1 - u) * ((1 - v) * a + v * d) + u * ((1 - v) * b + v * c)  # (f, p, 3)
    along_u = (1 - v) * (b - a) + v * (c - d)
    along_v = (1 - u) * (d - a) + u * (c - b)
    surface = _polydata(points.reshape(-1, 3), _grid_cells(len(mesh.quads)))
    surface.point_data["Normals"] = normalize(np.cross(along_u, along_v)).reshape(-1, 3)
    surface.point_data.active_normals_name = "Normals"
    return surface


def _grid_cells(count: int) -> Floats:
    """Return the cells of `count` grids of (STEPS + 1)² points, shape (count STEPS², 4)."""
    corner = (np.arange(STEPS)[:, None] * (STEPS + 1) + np.arange(STEPS)).reshape(-1, 1)
    cell = corner + np.array([0, STEPS + 1, STEPS + 2, 1])
    return (cell + np.arange(count)[:, None, None] * (STEPS + 1) ** 2).reshape(-1, 4)


def _polydata(points: Points, cells: Any) -> pv.PolyData:
    return pv.PolyData(points, np.insert(cells, 0, cells.shape[1], axis=1).reshape(-1))


def wires(points: Points, pairs: Any, radius: float) -> pv.PolyData:
    """Return segments between `points` as thin tubes with round ends."""
    lines = pv.PolyData(np.array(points), lines=np.insert(pairs, 0, 2, axis=1).reshape(-1))
    ball = pv.Sphere(radius=radius, theta_resolution=12, phi_resolution=12)
    dots = pv.PolyData(np.array(points)).glyph(geom=ball, scale=False, orient=False)
    return lines.tube(radius=radius, n_sides=12).merge(dots)


class Stage:
    """One picture: things are added, then it is saved, cropped to what it shows."""

    def __init__(self, view: tuple[float, float, float], width: int, height: int) -> None:
        self.shape = np.array([width, height])
        self.points: list[Points] = []
        self.plotter = pv.Plotter(
            off_screen=True, window_size=FINENESS * self.shape, lighting="none"
        )
        self.plotter.set_background("white")
        self.plotter.enable_parallel_projection()
        self.plotter.enable_depth_peeling(8)
        self.backward = normalize(np.array(view))
        self.right = normalize(np.cross([0.0, 0.0, 1.0], self.backward))
        self.up = np.cross(self.backward, self.right)
        for light in LIGHTS:
            self.plotter.add_light(pv.Light(**light, light_type="camera light"))

    def add(self, surface: pv.PolyData, color: str, **more: Any) -> None:
        """Add a surface with soft shading."""
        look = {"ambient": 0.34, "diffuse": 0.72, "specular": 0.15, "specular_power": 15} | more
        self.plotter.add_mesh(surface, color=color, smooth_shading=True, **look)
        self.points.append(surface.points)

    def add_mesh(self, mesh: QuadMesh, color: str, line: float, **more: Any) -> None:
        """Add the faces of a quad mesh, and its edges as dark lines of radius `line` mm."""
        self.add(patches(mesh), color, **more)
        self.add(wires(mesh.vertices, mesh.edges, line), INK, specular=0.0)

    def save(self, name: str) -> None:
        """Draw what was added and save it as `docs/images/NAME.png`."""
        _save(self.picture(), name)

    def picture(self) -> Image.Image:
        """Draw what was added."""
        points = np.vstack(self.points)
        screen = points @ np.stack([self.right, self.up], axis=1)  # (p, 2)
        low, high = screen.min(axis=0), screen.max(axis=0)
        depth = points @ self.backward
        middle = (low + high) / 2 @ np.stack([self.right, self.up]) + depth.mean() * self.backward
        camera = self.plotter.camera
        camera.focal_point = middle
        camera.position = middle + 2 * np.ptp(depth) * self.backward
        camera.up = self.up
        camera.parallel_scale = 0.54 * ((high - low) / self.shape).max() * self.shape[1]
        self.plotter.reset_camera_clipping_range()
        size = self.plotter.length
        self.plotter.enable_ssao(radius=0.05 * size, bias=0.006 * size, kernel_size=128)
        picture = _cropped(Image.fromarray(self.plotter.screenshot(return_img=True)))
        self.plotter.close()
        return picture.resize([extent // FINENESS for extent in picture.size], Image.Resampling.BOX)


def _save(picture: Image.Image, name: str) -> None:
    picture.quantize(128).save(IMAGES / f"{name}.png", optimize=True)


def _cropped(picture: Image.Image) -> Image.Image:
    """Return the picture without the white around it, but for a margin."""
    ink = np.asarray(picture.convert("L")) < 250
    height, width = (extent - FINENESS for extent in ink.shape)
    ink = ink[:height, :width]  # ambient occlusion darkens the last rows and columns
    margin = FINENESS * MARGIN
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    left, top = max(columns[0] - margin, 0), max(rows[0] - margin, 0)
    right, bottom = min(columns[-1] + margin, width), min(rows[-1] + margin, height)
    return picture.crop((left, top, right, bottom))


def draw_stick_woman() -> None:
    """Draw the scaffold of the stick woman, and its edges as a frame."""
    scaffold = build_scaffold(skeleton("stick_woman"))
    frame = pv.wrap(to_trimesh(thicken(scaffold, stick_woman.WIRE)))
    stage = Stage((-0.32, -1.0, 0.16), 1100, 1100)
    stage.add_mesh(scaffold.mesh, SAND, 0.3)
    beside = frame.translate((105.0, 35.0, 0.0))
    stage.add(beside.compute_normals(feature_angle=15.0, split_vertices=True), BLUE)
    stage.save("stick_woman")


def draw_partitions() -> None:
    """Draw the partitions of spheres around 3, 4 and 8 branches."""
    stage = Stage((-0.15, -1.0, 0.35), 1200, 500)
    for column, name in enumerate(("star_3", "star_4", "star_8")):
        directions = skeleton(name).directions[::2]
        _add_partition(stage, partition_sphere(directions), np.array([3.2 * column, 0, 0]))
    stage.save("partitions")


def _add_partition(stage: Stage, partition: Partition, center: Points) -> None:
    """Add the unit sphere with its quads in pastels, their arcs, and the branches as struts."""
    arcs = []
    for quad, direction, color in zip(partition.quads, partition.directions, PASTELS, strict=False):
        rim = np.concatenate(
            [
                _arc(partition.vertices[a], partition.vertices[b])
                for a, b in zip(quad, np.roll(quad, -1), strict=True)
            ]
        )
        arcs.append(rim)
        stage.add(_fan(direction, rim, center), color)
        strut = pv.Cylinder(
            center=center + 1.15 * direction, direction=direction, radius=0.09, height=0.42
        )
        stage.add(strut, GRAY)
        stage.add(pv.Sphere(radius=0.09, center=center + 1.36 * direction), GRAY)
    for rim in arcs:
        pairs = np.stack([np.arange(len(rim)), np.roll(np.arange(len(rim)), -1)], axis=1)
        stage.add(wires(center + rim, pairs, 0.016), INK, specular=0.0)


def _arc(a: UnitVectors, b: UnitVectors) -> UnitVectors:
    """Return points of the arc from `a` to just before `b`, shape (k, 3)."""
    share = np.linspace(0.0, 1.0, 48, endpoint=False)[:, None]
    return normalize((1 - share) * a + share * b)


def _fan(apex: UnitVectors, rim: UnitVectors, center: Points) -> pv.PolyData:
    """Return the part of the unit sphere inside `rim`, which is star-shaped around `apex`."""
    share = np.linspace(0.0, 1.0, 49)[:, None, None]
    points = normalize((1 - share) * apex + share * np.append(rim, rim[:1], axis=0))
    rings, around = points.shape[:2]
    corner = (np.arange(rings - 1)[:, None] * around + np.arange(around - 1)).reshape(-1, 1)
    surface = _polydata(
        center + points.reshape(-1, 3), corner + np.array([0, around, around + 1, 1])
    )
    surface.point_data["Normals"] = points.reshape(-1, 3)
    surface.point_data.active_normals_name = "Normals"
    return surface


def draw_overlapping_tree() -> None:
    """Draw the scaffold of a tree whose spheres intersect, and the spheres inside it."""
    tree = skeleton("tree").with_radii(overlapping_tree.RADIUS)
    scaffold = build_scaffold(tree, fit="paper")
    stage = Stage((-0.5, -1.0, 0.2), 800, 900)
    for node, radius in zip(tree.nodes, tree.radii, strict=True):
        ball = pv.Sphere(radius=radius, center=node, theta_resolution=64, phi_resolution=64)
        stage.add(ball, BLUE)
    stage.add(patches(scaffold.mesh), SAND, opacity=0.45)
    stage.add(wires(scaffold.mesh.vertices, scaffold.mesh.edges, 0.1), INK, specular=0.0)
    stage.save("overlapping_tree")


def draw_twist() -> None:
    """Draw the branch with its twist spread, and below it with its twist in the last row."""
    scaffold = build_scaffold(skeleton("bend"))
    strip = 4 * np.arange(len(scaffold.skeleton.joints) + 1) + 1  # one side of the branch
    colors = np.where(np.isin(np.arange(len(scaffold.mesh.quads)), strip), CORAL, SAND)
    stage = Stage((-0.2, -1.0, 0.6), 1000, 800)
    for mesh, drop in ((scaffold.mesh, 0.0), (twist.with_twist_in_last_row(scaffold), 24.0)):
        moved = mesh.moved(mesh.vertices - np.array([0.0, 0.0, drop]))
        for color in (CORAL, SAND):
            stage.add(patches(QuadMesh(moved.vertices, moved.quads[colors == color])), color)
        stage.add(wires(moved.vertices, moved.edges, 0.13), INK, specular=0.0)
    stage.save("twist")


def draw_lattice() -> None:
    """Draw the ring of round struts."""
    stage = Stage((-0.5, -1.0, 0.6), 800, 580)
    stage.add(_faceted(to_solid(round_struts(lattice.ring(), blend=0.1), sides=16)), SAND)
    stage.save("lattice")


VIEWS: dict[str, tuple[tuple[float, float, float], str]] = {
    "stick_woman": ((-0.32, -1.0, 0.16), SAND),
    "lamp_shade": ((-0.5, -1.0, 0.25), SAND),
    "lattice_bracket": ((0.7, -1.0, 0.55), BLUE),
    "filled_bracket": ((0.7, -1.0, 0.55), SAND),
    "foam_knob": ((0.5, -1.0, 0.45), SAND),
    "bike_node": ((0.6, -1.0, 0.5), BLUE),
    "chair": ((-0.75, -1.0, 0.45), SAND),
    "tree_support": ((-0.45, -1.0, 0.25), BLUE),
    "neuron": ((-0.2, -0.5, 1.4), CORAL),
    "sandwich_panel": ((-0.8, -1.0, 0.5), BLUE),
    "geodesic_dome": ((-0.5, -1.0, 0.5), SAND),
    "space_frame": ((-0.5, -1.0, 0.5), BLUE),
    "helix_lamp": ((-0.5, -1.0, 0.35), SAND),
    "brake_lever": ((0.25, -0.5, 1.0), BLUE),
    "spiral": ((-0.35, -1.0, 0.75), SAND),
    "shoe_sole": ((-0.55, -1.0, 0.7), BLUE),
    "helmet": ((-0.5, -1.0, 0.45), SAND),
    "pipe_sleeve": ((1.0, -0.45, 0.35), BLUE),
    "animation": ((-0.1, -1.0, 0.15), SAND),
}
"""Where each picture of the gallery is seen from, and its color."""


def draw_gallery(name: str) -> None:
    """Draw what a program of the gallery makes."""
    view, color = VIEWS[name]
    made = runpy.run_path(str(GALLERY / f"{name}.py"))["make"]()
    stage = Stage(view, 480, 600)
    if isinstance(made, list):  # the frames of a film, side by side
        for number, frame in enumerate(made):
            aside = np.array([34.0 * number, 0.0, 0.0])
            stage.add_mesh(frame.mesh.moved(frame.mesh.vertices + aside), color, 0.12)
    elif isinstance(made, Scaffold):
        line = 0.003 * float(np.linalg.norm(np.ptp(made.mesh.vertices, axis=0)))
        stage.add_mesh(made.mesh, color, line)
    else:
        if name in ("filled_bracket", "brake_lever"):
            made = to_solid(tessellated(made))
        if name in ("lattice_bracket", "filled_bracket", "foam_knob"):  # cut, to see the inside
            made = made.trim_by_plane((0.0, 1.0, 0.0), 0.0)
        if isinstance(made, RoundStruts):
            made = to_solid(made, sides=48)
        stage.add(_faceted(made), color)
    stage.save(f"gallery/{name}")


def draw_cells() -> None:
    """Draw every unit cell with its name."""
    pictures = {}
    for name, cell in cells().items():
        stage = Stage((-0.45, -1.0, 0.45), 200, 220)
        frame = Skeleton(cell.nodes * cell.proportions, cell.edges, np.array(0.035))
        stage.add(_faceted(thicken(frame, 0.035, sides=16)), BLUE)
        corners = tile("sc", cell.proportions, 1, radius=0.01)
        stage.add(wires(corners.nodes, corners.edges, 0.006), GRAY, specular=0.0)
        pictures[name] = stage.picture()
    _save(_sheet(pictures, columns=5), "cells")


def draw_options() -> None:
    """Draw a node built with different options, its skeleton inside."""
    tips = [[9.0, 0.0, 2.0], [-7.0, 5.0, 0.0], [-3.0, -8.0, -2.0], [0.0, 0.0, 9.0]]
    node = Skeleton([[0.0, 0.0, 0.0], *tips], [[0, 1], [0, 2], [0, 3], [0, 4]], 1.3)
    pictures = {}
    for label, options in OPTIONS.items():
        scaffold = build_scaffold(node, **options)
        stage = Stage((-0.6, -1.0, 0.55), 260, 260)
        if label == ROUND:
            stage.add(_faceted(to_solid(round_struts(node), sides=48)), SAND)
        else:
            stage.add(patches(scaffold.mesh), SAND, opacity=0.55)
            stage.add(wires(scaffold.mesh.vertices, scaffold.mesh.edges, 0.07), INK, specular=0.0)
            stage.add(pv.Sphere(radius=1.3), BLUE)
            for tip in node.nodes[1:]:
                height = float(np.linalg.norm(tip))
                strut = pv.Cylinder(center=tip / 2, direction=tip, radius=1.3, height=height)
                stage.add(strut, BLUE)
        pictures[label] = stage.picture()
    _save(_sheet(pictures, columns=3), "options")


ROUND = "round_struts"
"""What is written under the picture of round struts."""

OPTIONS: dict[str, dict[str, Any]] = {
    'fit="enclose" (default)': {},
    'fit="paper"': {"fit": "paper"},
    "collars=True": {"collars": True},
    'section="inscribed"': {"section": "inscribed"},
    'section="area"': {"section": "area"},
    ROUND: {},
}
"""Options of `build_scaffold` by what is written under their picture."""


def _faceted(solid: Any) -> pv.PolyData:
    """Return the surface of a solid, its sharp edges sharp."""
    surface = pv.wrap(to_trimesh(solid))
    return surface.compute_normals(feature_angle=35.0, split_vertices=True)


def _sheet(pictures: dict[str, Image.Image], columns: int) -> Image.Image:
    """Return the pictures in rows, each above its label."""
    width = max(picture.width for picture in pictures.values())
    height = max(picture.height for picture in pictures.values()) + LABEL
    rows = -(-len(pictures) // columns)
    sheet = Image.new("RGB", (columns * width, rows * height), "white")
    pen = ImageDraw.Draw(sheet)
    for place, (label, picture) in enumerate(pictures.items()):
        left, top = place % columns * width, place // columns * height
        sheet.paste(picture, (left + (width - picture.width) // 2, top))
        middle = (left + width / 2, top + height - LABEL / 2)
        pen.text(middle, label, fill=INK, anchor="mm", font_size=15)
    return sheet


def draw_layers() -> None:
    """Draw layers of a hollow node, from its arms up to where they meet."""
    tips = [[9, 0, 2], [-7, 5, 0], [-3, -8, -2], [0, 0, 9], [7, 6, 6]]
    edges = [[0, k] for k in range(1, 6)]
    node = Skeleton([[0, 0, 0], *tips], edges, 1.6)
    struts = round_struts(node, blend=1.2, wall=0.5, ends="open")
    heights = [-1.6, -0.4, 0.9, 2.2, 3.4, 6.0]
    low, pixels = np.array([-9.0, -10.0]), (260, 250)
    pictures = {}
    for layer in slices(struts, heights, sides=64):
        scale = FINENESS * pixels[0] / 20.0
        picture = Image.new("RGB", (FINENESS * pixels[0], FINENESS * pixels[1]), "white")
        pen = ImageDraw.Draw(picture)
        for loop, area in zip(layer.loops, layer.areas, strict=True):
            x, y = ((loop - low) * scale).T
            corners = list(zip(x.tolist(), (FINENESS * pixels[1] - y).tolist(), strict=True))
            pen.polygon(corners, fill=SAND if area > 0 else "white", outline=INK, width=FINENESS)
        label = f"{layer.height:g} mm"
        pictures[label] = picture.resize(pixels, Image.Resampling.LANCZOS)
    _save(_sheet(pictures, columns=3), "layers")


def draw_sharp_nodes() -> None:
    """Draw pipes whose nodes are sharp: braces on a chord, a cross of one radius and a miter."""
    nodes = [[0, 0, 0], [-9, 0, 0], [12, 0, 0], [-7, 0, 9], [7, 0, 9], [12, 0, 12], [12, 8, 0]]
    nodes += [[21, 0, 0], [21, 0, 10]]
    edges = [[0, 1], [0, 2], [0, 3], [0, 4], [2, 5], [2, 6], [2, 7], [7, 8]]
    radii = np.array([2, 2, 1.2, 1.2, 2, 2, 2, 2])
    pipes = Skeleton(nodes, edges, 1.0, edge_radii=np.stack([radii, radii], axis=1))
    stage = Stage((0.35, -1.0, 0.4), 900, 640)
    solid = to_solid(round_struts(pipes, nodes="sharp"), sides=64)
    stage.add(_faceted(solid), GRAY)
    stage.save("sharp_nodes")


def draw_united() -> None:
    """Draw a B-rep of a node, which is exact, and of struts that cross, which has facets there."""
    nodes = [[0, 0, 0], [31, 0, -3], [-8, 0, 6], [-8, 0, -6], [20, 0, 6], [25, -5, -9], [25, 5, 4]]
    edges = [[0, 1], [0, 2], [0, 3], [0, 4], [5, 6]]
    part = to_brep(round_struts(Skeleton(nodes, edges, 1.0)), overlaps="unite")
    stage = Stage((0.25, -1.0, 0.45), 900, 560)
    facets = []
    for face in part.faces():
        made = tessellated(face)
        if len(face.edges()) == 3 and face.geom_type == GeomType.PLANE:
            facets.append(made.vertices[made.triangles[0]])
        else:
            surface = _polydata(made.vertices, made.triangles)
            stage.add(surface.compute_normals(feature_angle=35.0, split_vertices=True), BLUE)
    corners = np.concatenate(facets)
    rows = np.arange(len(corners)).reshape(-1, 3)
    stage.add(_polydata(corners, rows), SAND)
    sides = np.concatenate([rows[:, :2], rows[:, 1:], rows[:, ::2]])
    stage.add(wires(corners, sides, 0.02), INK, specular=0.0)
    stage.save("united")


def draw_convolution() -> None:
    """Draw the dog's scaffold, and beside it its convolution surface with its quads."""
    scaffold = build_scaffold(skeleton("dog"), collars=True)
    mesh = convolution.surface(scaffold, ConvolutionField(scaffold.skeleton))
    stage = Stage((0.35, -1.0, 0.35), 720, 360)
    stage.add_mesh(scaffold.mesh, SAND, 0.06)
    beside = mesh.moved(mesh.vertices + 30 * stage.right)
    stage.add(_polydata(beside.vertices, beside.quads), BLUE)
    stage.add(wires(beside.vertices, beside.edges, 0.025), INK, specular=0.0)
    stage.save("convolution")


def draw_canopy() -> None:
    """Draw the tree that carries 64 points: one radius for all struts, and sized ones."""
    stage = Stage((-0.45, -1.0, 0.3), 1000, 460)
    for result, color, place in zip(
        canopy.results(canopy.loaded_tree()), (GRAY, BLUE), (0.0, 290.0), strict=True
    ):
        _add_sized(stage, result, place * stage.right, color)
    stage.save("canopy")


def draw_bracket() -> None:
    """Draw the bracket on its wall with one radius for all struts, and with sized ones."""
    stage = Stage((0.55, -1.0, 0.35), 900, 320)
    for result, color, place in zip(
        bracket.results(bracket.bracket()), (GRAY, BLUE), (0.0, 190.0), strict=True
    ):
        _add_sized(stage, result, place * stage.right, color)
        highest = result.skeleton.nodes[:, 2] > bracket.TIP - 0.1
        _add_forces(stage, result, highest, place * stage.right, 32.0)
        low, high = result.skeleton.nodes.min(axis=0), result.skeleton.nodes.max(axis=0)
        wall = pv.Box((-7, -4, low[1] - 10, high[1] + 10, low[2] - 10, high[2] + 10))
        stage.add(wall.translate(place * stage.right), INK)
    stage.save("bracket")


def draw_octet_beam() -> None:
    """Draw the beam in three-point bending with one radius for all struts, and with sized ones."""
    stage = Stage((-0.3, -1.0, 0.3), 800, 620)
    for result, color, place in zip(
        octet_beam.results(octet_beam.bent_beam()), (GRAY, BLUE), (0.0, -58.0), strict=True
    ):
        _add_sized(stage, result, place * stage.up, color)
        held = result.solution.model.fixed.any(axis=1)
        _add_forces(stage, result, ~held, place * stage.up, 20.0)
        for foot, radius in zip(result.skeleton.nodes[held], _radii(result)[held], strict=True):
            middle = foot + place * stage.up - [0.0, 0.0, radius + 3.5]
            cone = pv.Cone(
                center=middle, direction=(0, 0, 1), height=7.0, radius=3.5, resolution=48
            )
            stage.add(cone.compute_normals(feature_angle=35.0, split_vertices=True), INK)
    stage.save("octet_beam")


def _add_sized(stage: Stage, result: Sized, aside: Points, color: str) -> None:
    """Add sized struts, moved by `aside`."""
    struts = round_struts(result.skeleton.moved(result.skeleton.nodes + aside))
    stage.add(_faceted(to_solid(struts, sides=32)), color)


def _add_forces(stage: Stage, result: Sized, some: Bools, aside: Points, size: float) -> None:
    """Add an arrow of `size` mm to each loaded one of `some` nodes."""
    forces, radii = result.solution.model.forces[:, :3], _radii(result)
    for node in np.flatnonzero(forces.any(axis=1) & some):
        way = normalize(forces[node])
        tail = result.skeleton.nodes[node] + aside - (size + radii[node]) * way
        arrow = pv.Arrow(
            start=tail,
            direction=way,
            scale=size,
            tip_length=0.35,
            tip_radius=0.13,
            shaft_radius=0.05,
        ).compute_normals(feature_angle=35.0, split_vertices=True)
        stage.add(arrow, CORAL)


def _radii(result: Sized) -> Floats:
    """Return the largest radius at each node, (n,), mm."""
    found = np.zeros(len(result.skeleton.nodes))
    np.maximum.at(found, result.skeleton.edges, result.radii[:, None])
    return found


def draw_page() -> None:
    """Draw a page as a browser shows it; needs Chromium."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        page, picture = Path(folder, "stick_woman.html"), Path(folder, "page.png")
        write_page(build_scaffold(skeleton("stick_woman")), page)
        subprocess.run(
            [
                "chromium",
                "--headless",
                "--no-sandbox",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--window-size=860,560",
                f"--user-data-dir={folder}/profile",
                f"--screenshot={picture}",
                f"{page.as_uri()}#skeleton,scaffold,worst",
            ],
            check=True,
            capture_output=True,
        )
        _save(Image.open(picture).convert("RGB"), "page")


PICTURES: dict[str, Callable[[], None]] = {
    "stick_woman": draw_stick_woman,
    "partitions": draw_partitions,
    "overlapping_tree": draw_overlapping_tree,
    "twist": draw_twist,
    "lattice": draw_lattice,
    "sharp_nodes": draw_sharp_nodes,
    "united": draw_united,
    "cells": draw_cells,
    "options": draw_options,
    "layers": draw_layers,
    "page": draw_page,
    "convolution": draw_convolution,
    "canopy": draw_canopy,
    "bracket": draw_bracket,
    "octet_beam": draw_octet_beam,
    **{f"gallery/{name}": partial(draw_gallery, name) for name in VIEWS},
}


if __name__ == "__main__":
    (IMAGES / "gallery").mkdir(parents=True, exist_ok=True)
    for name in sys.argv[1:] or PICTURES:
        PICTURES[name]()
        print(f"{IMAGES / name}.png: {(IMAGES / f'{name}.png').stat().st_size / 1000:.0f} kB")
