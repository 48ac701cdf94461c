"""Scaffold: the coarse quad mesh around a skeleton, and what each part of it belongs to."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import get_args

import numpy as np

from scaffold_cad.base.arguments import as_flag, check_choice, check_kind, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Quads
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.partition.sphere import METHODS
from scaffold_cad.scaffold.bevels import Sleeving, with_bevels
from scaffold_cad.scaffold.collars import Refinement, with_collars, without_collars
from scaffold_cad.scaffold.embedding import Embedding, embedding
from scaffold_cad.scaffold.sleevemesh import SleeveMesh
from scaffold_cad.scaffold.sleeves import (
    REVERSED,
    Sections,
    SphericalQuads,
    Walk,
    carry_sections,
    join_sections,
    sleeve_quads,
    walk_branches,
)
from scaffold_cad.scaffold.stars import (
    APOTHEM,
    Fit,
    Section,
    Stars,
    partition_stars,
    star_positions,
)
from scaffold_cad.skeleton import Skeleton, check_skeleton


@dataclass(frozen=True)
class ScaffoldOptions:
    """How a scaffold is built; `build_scaffold` describes each option."""

    fit: Fit = "enclose"
    section: Section = "circumscribed"
    collars: bool = False
    method: str = "dual"

    def __post_init__(self) -> None:
        check_choice(self.fit, "fit", get_args(Fit))
        check_choice(self.section, "section", get_args(Section))
        check_choice(self.method, "method", METHODS)
        object.__setattr__(self, "collars", as_flag(self.collars, "collars"))

    @property
    def corner_distance(self) -> float:
        """Distance of a section's corners from its node, in radii."""
        return APOTHEM[self.section] * math.sqrt(2.0)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Scaffold(Frozen, Shown):
    """The coarsest all-quad mesh with quadrilateral sections around a skeleton.

    Four quads per edge, one per extremity; N + 2 vertices per branch point of valency N, four per
    joint or an extremity. A sharp bend, of less than 39°, has eight quads more: a bevel.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> scaffold = build_scaffold(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0))
    >>> print(scaffold)
    Scaffold: 6 quads around 1 edge, 9 x 2 x 2 mm, radius 1 mm
    >>> scaffold.mesh.quads.shape
    (6, 4)
    """

    skeleton: Skeleton
    """The skeleton that was asked for."""
    mesh: QuadMesh
    """Vertices and quads; the quads are counter-clockwise seen from outside."""
    edge_of_quad: Ints
    """Skeleton edge that each quad belongs to, a cap to the edge that it closes, shape (f,)."""
    node_of_vertex: Ints
    """Node of `refined` that each vertex stands around, shape (v,)."""
    sleeves: Ints
    """Vertices of the sections at both ends of each edge of `refined`, row j of the one joined
    to row j of the other, counter-clockwise about the edge's direction, shape (m', 2, 4)."""
    stars: Stars
    """The partitions of the branch points; their vertices come first in the mesh."""
    refinement: Refinement
    """The skeleton with its collars and bevels as joints, and where its edges come from."""
    sections: Sections
    """The sections at joints and extremities before bevels, and the matching at the end of each
    branch."""
    thinned: Ints
    """Joints that bend too sharply for the length of their struts: the quads thin there, and
    `embedding` leaves these struts out, ascending, shape (k,)."""
    options: ScaffoldOptions
    """How the scaffold was built."""

    def __str__(self) -> str:
        counts = f"{counted(len(self.mesh.quads), 'quad')} around "
        counts += counted(len(self.skeleton.edges), "edge")
        size, radii = size_text(self.mesh.vertices), radii_text(self.skeleton.edge_radii)
        return f"Scaffold: {counts}, {size}, {radii}"

    @property
    def refined(self) -> Skeleton:
        """The skeleton with its collars and bevels as joints."""
        return self.refinement.skeleton

    @property
    def clearance(self) -> Floats:
        """Angle from each half-edge to the nearest side of its spherical quad, rad, shape (2 m,).

        It is nan where the half-edge leaves no branch point.
        """
        return self.stars.clearance

    def embedding(self) -> Embedding:
        """Return which struts stay apart from the others; computed at the first call."""
        return self._embedding

    @cached_property
    def _embedding(self) -> Embedding:
        return embedding(self)

    @property
    def twist(self) -> Floats:
        """Twist spread over each branch of `refined`, rad, shape (b,)."""
        return self.sections.twist


@checks_keywords()
def build_scaffold(
    skeleton: Skeleton,
    *,
    fit: Fit = "enclose",
    section: Section = "circumscribed",
    collars: bool = False,
    method: str = "dual",
    like: Scaffold | None = None,
) -> Scaffold:
    """Return the scaffold of `skeleton`.

    Parameters
    ----------
    skeleton : as `check_skeleton` asks
    fit : "enclose" puts the corners at a branch point far enough out for no strut to be cut thin
        there, and a bevel at bends of less than 39°; "paper" puts the corners on the sphere of the
        node's radius
    section : which square stands for a circle of the node's radius: "circumscribed" around it,
        "area" of equal area, "inscribed" in it, "round" the one whose smooth limit it is
    collars : whether a joint is added where each strut leaves the blend of its branch point, or the
        step at a joint or an extremity whose radius is not its own
    method : of the partition, see `partition_sphere`
    like : a scaffold of a skeleton with the same edges; its quads and its options are kept and
        only the vertices move, so that no other options can be asked for

    Raises
    ------
    SkeletonError
        If the skeleton cannot be scaffolded, or `like` belongs to other edges.
    PartitionError
        If a partition of `like` fits the moved skeleton nowhere.
    OptionError
        If `skeleton` or `like` is of another type, an option has an unknown value, or one given
        beside `like` differs from that of `like`.

    References
    ----------
    Panotopoulou et al., Scaffolding a Skeleton, 2018, sections 4 to 7.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> tips = [[9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> tripod = Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> len(build_scaffold(tripod).mesh.quads)  # 4 per edge, 1 per extremity
    15
    """
    check_skeleton(skeleton)
    options = ScaffoldOptions(fit, section, collars, method)
    if like is None:
        stars = partition_stars(skeleton, options.method)
    else:
        check_kind(like, Scaffold, name="like")
        _check_same_edges(skeleton, like.skeleton)
        _check_same_options(options, like.options)
        options = like.options
        stars = partition_stars(skeleton, options.method, like.stars)
    positions = star_positions(skeleton, stars, options.fit, options.section)
    kept = None if like is None else like.refinement
    if options.collars:
        slots = None if kept is None else kept.collared & ~kept.beveled
        refinement = with_collars(skeleton, stars, positions, options.corner_distance, slots)
    else:
        refinement = without_collars(skeleton)

    refined = refinement.skeleton
    walk = walk_branches(refined)
    quads = SphericalQuads(stars.vertices, _refined_corners(stars, refinement))
    shift = None if like is None else like.sections.shift
    sections = carry_sections(refined, walk, quads, options.corner_distance, shift)
    node_of_vertex, first_vertex = _number_vertices(refined, stars)
    vertices = _place_vertices(refined, walk, sections, positions, node_of_vertex, first_vertex)
    sleeves = join_sections(walk, sections, quads, first_vertex)
    made = Sleeving(refinement, vertices, sleeves)
    if options.fit == "enclose":
        made = with_bevels(skeleton, made, None if kept is None else kept.beveled)
    return _scaffold(skeleton, made, stars, sections, options, like)


def _scaffold(
    skeleton: Skeleton,
    made: Sleeving,
    stars: Stars,
    sections: Sections,
    options: ScaffoldOptions,
    like: Scaffold | None,
) -> Scaffold:
    """Return the scaffold that has these sections, with the quads of `like`."""
    refined = made.refinement.skeleton
    if like is None:
        quads, axes = _quads(refined, made.sleeves), refined.nodes[refined.edges]
        mesh: QuadMesh = SleeveMesh(made.vertices, quads, made.sleeves, axes)
    else:
        mesh = like.mesh.moved(made.vertices)
    return Scaffold(
        skeleton=skeleton,
        mesh=mesh,
        edge_of_quad=_edge_of_quad(refined, made.refinement),
        node_of_vertex=_number_vertices(refined, stars)[0],
        sleeves=made.sleeves,
        stars=stars,
        refinement=made.refinement,
        sections=sections,
        thinned=made.thinned,
        options=options,
    )


def _check_same_edges(skeleton: Skeleton, other: Skeleton) -> None:
    """Raise unless both skeletons have the same nodes and edges, in the same order."""
    if len(skeleton.nodes) != len(other.nodes) or not np.array_equal(skeleton.edges, other.edges):
        raise SkeletonError(
            f"`like` has {len(other.nodes)} nodes and {len(other.edges)} edges of its own; "
            f"need the same {len(skeleton.nodes)} nodes and {len(skeleton.edges)} edges"
        )


def _check_same_options(given: ScaffoldOptions, kept: ScaffoldOptions) -> None:
    """Raise if an option is given that is not among those `kept`."""
    for field in fields(ScaffoldOptions):
        value, own = getattr(given, field.name), getattr(kept, field.name)
        if value not in (own, field.default):
            raise OptionError(
                f"{field.name} is {value!r}; need {own!r} or nothing, as `like` keeps its options"
            )


def _refined_corners(stars: Stars, refinement: Refinement) -> Ints:
    """Return `stars.corners` by half-edge of the refined skeleton, (2 m', 4)."""
    corners = np.full((2 * len(refinement.edge_of_edge), 4), -1, dtype=np.intp)
    corners[refinement.leaving] = stars.corners
    return corners


def _number_vertices(refined: Skeleton, stars: Stars) -> tuple[Ints, Ints]:
    """Return the node of each vertex (v,), and the first vertex of each joint and extremity (n',).

    The partition vertices of all branch points come first, then four per joint or extremity.
    """
    others = np.flatnonzero(refined.valency < 3)
    first_vertex = np.full(len(refined.nodes), -1, dtype=np.intp)
    first_vertex[others] = len(stars.vertices) + 4 * np.arange(len(others))
    owners = np.repeat(np.arange(len(stars.offsets) - 1), np.diff(stars.offsets))
    return np.concatenate([owners, np.repeat(others, 4)]), first_vertex


def _place_vertices(
    refined: Skeleton,
    walk: Walk,
    sections: Sections,
    positions: Points,
    node_of_vertex: Ints,
    first_vertex: Ints,
) -> Points:
    """Return the position of every vertex, (v, 3), mm."""
    vertices = np.empty((len(node_of_vertex), 3))
    vertices[: len(positions)] = refined.nodes[node_of_vertex[: len(positions)]] + positions
    corner = np.arange(4)
    vertices[first_vertex[walk.head[sections.steps]][:, None] + corner] = sections.corners
    # Last, for a ring's last step ends at its start.
    start = first_vertex[walk.tail[walk.first]]
    own = start >= 0
    vertices[start[own][:, None] + corner] = sections.start_corners[own]
    return vertices


def _quads(refined: Skeleton, sleeves: Ints) -> Quads:
    """Return four quads per edge, then one per extremity, (4 m' + k, 4)."""
    sides = sleeve_quads(sleeves[:, 0], sleeves[:, 1])  # (m', 4, 4)
    closing = refined.leaving_extremities
    # Seen from outside: against the edge's direction at its start, along it at its end.
    caps = sleeves[closing >> 1, closing & 1]
    caps = np.where((closing & 1 == 0)[:, None], caps[:, REVERSED], caps)
    return np.concatenate([sides.reshape(-1, 4), caps])


def _edge_of_quad(refined: Skeleton, refinement: Refinement) -> Ints:
    """Return the edge of the given skeleton that each quad belongs to, (f,)."""
    closed = refined.leaving_extremities >> 1
    owner = np.concatenate([np.repeat(np.arange(len(refined.edges)), 4), closed])
    edge: Ints = refinement.edge_of_edge[owner]
    return edge
