"""The numbers of the vertices, edges and faces of round struts, and where corners are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.struts.breps.seams import Seams, seams
from scaffold_cad.struts.curves.faces import CurveParts
from scaffold_cad.struts.elbows import Tori, tori_of
from scaffold_cad.struts.meshes.ends import end_spheres
from scaffold_cad.struts.model import BlendedNodes, RoundStruts


@dataclass(frozen=True, eq=False)
class FacePlan(Frozen):
    """The numbers of vertices, edges and faces."""

    struts: RoundStruts
    seams: Seams
    ringed: Ints
    """Half-runs at blended nodes, shape (r,)."""
    rank: Ints
    """Place of each half-run in `ringed`, or -1, shape (2 k,)."""
    split: Ints
    """Half-runs of `ringed` whose ring is split, shape (s,)."""
    split_rank: Ints
    """Place of each half-run in `split`, or -1, shape (2 k,)."""
    ends: Ints
    """Half-runs at extremities, shape (e,)."""
    end_rank: Ints
    """Place of each half-run in `ends`, or -1, shape (2 k,)."""
    discs: Ints
    """Places in `ends` of the flat ends, shape (d,)."""
    balls: Ints
    """Places in `ends` of the round ends and of balls, shape (b,)."""
    run_face: Ints
    """Place of each run's face among those of all runs, cylinders first, shape (k,)."""
    curves: CurveParts
    """Parts of curves that are not tori."""
    tori: Tori
    """Elbows."""

    @staticmethod
    def of(struts: RoundStruts, open_at: Bools | None = None) -> FacePlan:
        """Return the plan of the faces of struts, each of which is straight somewhere.

        Parameters
        ----------
        open_at : (n,) nodes where struts end without a face; none by default
        """
        runs = struts.runs
        at_end = runs.valency[runs.tails] == 1
        found = seams(struts)
        ringed, ends = np.flatnonzero(~at_end), np.flatnonzero(at_end)
        split = np.flatnonzero(~at_end & found.splits)
        is_cone = runs.slopes[0::2] != 0
        run_face = np.empty(len(is_cone), dtype=np.intp)
        run_face[np.argsort(is_cone, kind="stable")] = np.arange(len(is_cone))
        count = len(runs.tails)
        ranks = [_rank(members, count) for members in (ringed, split, ends)]
        closed = np.ones(len(ends), dtype=np.bool_)
        if open_at is not None:
            closed = ~open_at[runs.tails[ends]]
        kind, is_ball = struts.options.ends, struts.at_balls[ends]
        is_torus = np.isfinite(struts.curves.tori)
        return FacePlan(
            struts,
            found,
            ringed,
            ranks[0],
            split,
            ranks[1],
            ends,
            ranks[2],
            np.flatnonzero(closed & ~is_ball & (kind == "flat")),
            np.flatnonzero(closed & (is_ball | (kind == "round"))),
            run_face,
            CurveParts.of(struts.curves.chosen(~is_torus)),
            tori_of(runs, struts.curves.half_runs[is_torus], struts.curves.tori[is_torus]),
        )

    # Edges: seams, base arcs, rests of split arcs, end rings, meridians, seams of tori, rings of
    # closed curves, arcs and spokes of nodes, spokes of curves.

    @property
    def base_arcs(self) -> int:
        """Number of the first quarter of a ring, up to the seam."""
        return len(self.struts.runs.edges)

    @property
    def rest_arcs(self) -> int:
        """Number of the first rest of a quarter that a seam splits."""
        return self.base_arcs + 4 * len(self.ringed)

    @property
    def end_rings(self) -> int:
        """Number of the first ring at an extremity."""
        return self.rest_arcs + len(self.split)

    @property
    def meridians(self) -> int:
        """Number of the first meridian of a round end."""
        return self.end_rings + len(self.ends)

    @property
    def torus_seams(self) -> int:
        """Number of the first seam of a torus."""
        return self.meridians + len(self.balls)

    @property
    def curve_rings(self) -> int:
        """Number of the first quarter of a ring in which halves of a closed curve meet."""
        return self.torus_seams + len(self.tori.radii)

    @property
    def node_edges(self) -> int:
        """Number of the first arc of a node."""
        return self.curve_rings + 4 * len(self.curves.own)

    @property
    def curve_spokes(self) -> int:
        """Number of the first spoke of a curve."""
        return self.node_edges + 6 * self.node_half_runs

    @property
    def node_half_runs(self) -> int:
        """Half-runs that leave blended nodes."""
        return sum(group.half_runs.size for group in self.struts.blended)

    # Vertices: collar corners, splits, ends of struts, poles, corners of nodes, of closed curves.

    @property
    def split_vertices(self) -> int:
        """Number of the first vertex that splits a quarter."""
        return 4 * len(self.ringed)

    @property
    def end_vertices(self) -> int:
        """Number of the first vertex at an extremity."""
        return self.split_vertices + len(self.split)

    @property
    def poles(self) -> int:
        """Number of the first pole of a round end."""
        return self.end_vertices + len(self.ends)

    @property
    def node_vertices(self) -> int:
        """Number of the first corner of a node."""
        return self.poles + len(self.balls)

    @property
    def curve_vertices(self) -> int:
        """Number of the first corner of a closed curve."""
        corners = sum(group.half_runs.size + 2 * len(group.nodes) for group in self.struts.blended)
        return self.node_vertices + corners

    # Faces: discs, struts, domes, tori, patches of nodes, those of curves.

    @property
    def strut_faces(self) -> int:
        """Number of the first face of a strut."""
        return len(self.discs)

    @property
    def domes(self) -> int:
        """Number of the first round end."""
        return self.strut_faces + len(self.run_face)

    @property
    def torus_faces(self) -> int:
        """Number of the first torus."""
        return self.domes + len(self.balls)

    @property
    def patch_faces(self) -> int:
        """Number of the first patch of a node."""
        return self.torus_faces + len(self.tori.radii)

    @property
    def curve_faces(self) -> int:
        """Number of the first patch of a curve."""
        return self.patch_faces + 4 * self.node_half_runs

    def seam_vertex(self, half_runs: Ints) -> Ints:
        """Return the vertex at which the seam meets the ring of each of some half-runs."""
        corner = 4 * self.rank[half_runs] + self.seams.quarter[half_runs]
        split = self.split_vertices + self.split_rank[half_runs]
        end = self.end_vertices + self.end_rank[half_runs]
        at_node = np.where(self.split_rank[half_runs] >= 0, split, corner)
        return np.where(self.end_rank[half_runs] >= 0, end, at_node)


def _rank(members: Ints, count: int) -> Ints:
    rank = np.full(count, -1, dtype=np.intp)
    rank[members] = np.arange(len(members))
    return rank


def groups_of(plan: FacePlan) -> list[tuple[BlendedNodes, int, int, int]]:
    """Return each group with the numbers of its first vertex, edge and face."""
    vertex, edge, face = plan.node_vertices, plan.node_edges, plan.patch_faces
    found = []
    for group in plan.struts.blended:
        nodes, valency = group.half_runs.shape
        found.append((group, vertex, edge, face))
        vertex += nodes * (valency + 2)
        edge += nodes * 6 * valency
        face += nodes * 4 * valency
    return found


def ring_points(plan: FacePlan, half_runs: Ints, angles: Floats) -> Points:
    """Return the points of rings at angles from their x, shape (h, 3), mm."""
    struts, runs = plan.struts, plan.struts.runs
    x, axis = struts.x[half_runs], runs.directions[half_runs]
    distance = struts.collar[half_runs]
    radius = runs.radii_at(half_runs, distance)
    center = runs.nodes[runs.tails[half_runs]] + distance[:, None] * axis
    spoke = np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * np.cross(axis, x)
    points: Points = center + radius[:, None] * spoke
    return points


def placed(plan: FacePlan, group: BlendedNodes) -> tuple[Points, Floats]:
    """Return the corners (M, N + 2, 3) and the control points (M, 4 N, n_u, n_v, 3), mm."""
    made, nodes = group.shapes, plan.struts.runs.nodes[group.nodes]
    quads = group.quads  # (U, N, 4)
    count, valency = quads.shape[:2]
    corners = np.empty((count, valency + 2, 3))
    corners[np.arange(count)[:, None], quads.reshape(count, -1)] = made.control[:, :, 0, 0]
    which = group.shape_of
    placed = made.control[which] + nodes[:, None, None, None]
    return corners[which] + nodes[:, None], placed


def owners(quads: Ints) -> tuple[Ints, Bools]:
    """Return the arc of each side (M, 4 N), and whether it runs along it."""
    twins = side_twins(quads)
    sides = np.arange(twins.shape[1])
    owns = sides < twins
    number = np.cumsum(owns, axis=1) - 1
    return np.where(owns, number, np.take_along_axis(number, twins, axis=1)), owns


def domes(plan: FacePlan) -> tuple[Points, Floats, Floats]:
    """Return center and radius of the spheres at round ends, and the latitude of their rings."""
    runs, ends = plan.struts.runs, plan.ends[plan.balls]
    sphere = end_spheres(plan.struts, ends)
    center = runs.nodes[runs.tails[ends]] - sphere.center[:, None] * runs.directions[ends]
    return center, sphere.size, sphere.start


def curve_corners(plan: FacePlan) -> Ints:
    """Return the vertices at which the spokes of curves begin and end, shape (q, 4, 2)."""
    parts, quarter = plan.curves, np.arange(4)
    # Half-runs at the start run against the curve: their corners come the other way round.
    corners = np.stack([-quarter % 4, quarter], axis=1)  # (4, 2)
    found = plan.curve_vertices + 4 * parts.rings[:, None] + quarter[:, None]
    at_struts = np.flatnonzero(parts.half_runs[:, 0] >= 0)
    found[at_struts] = 4 * plan.rank[parts.half_runs[at_struts]][:, None] + corners
    return found
