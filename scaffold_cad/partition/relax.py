"""Moving the vertices of partitions to raise the smallest relative clearance.

The sine of the clearance of a direction P from the arc (a, b) is det(a, b, P) / |a × b|, whose
gradient is closed-form. Divided by the sine of the direction's reach (half the angle to its
nearest neighbor) it is the arc's *ratio* on that side, at most 1 for the closest pair. A soft
minimum of all ratios of a partition, of rising sharpness, is climbed first along its gradient
and then by Newton steps. Many partitions of one valency are treated at once, as arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.partition.arcs import arcs_of

# How clearances change with these constants: `python -m tests.benchmarks.tuning`.
SHORT_ARC = 0.4
"""An arc shorter than this part of the reach beside it counts as a shortfall."""
SHORT_ARC_RATIO = 0.8
"""What an arc of length 0 counts: keeping arcs long may cost clearance only above this."""
ARC_BYTES = 256
"""What an arc takes where it is relaxed."""
TINY = 1e-24
"""Added to squares that are divided by: vertices may coincide in a first guess."""

FLOW_SHARPNESS = (2.0, 80.0)
FLOW_STEP = (0.27, 0.046)
"""First and last length of a step along the gradient, in reaches and per √vertex."""
FLOW_INERTIA, FLOW_MEMORY = 0.7, 0.95
"""What is kept at each step of the last step's course, and of the mean square of gradients."""
NEWTON_SHARPNESS = (20.0, 3000.0)
NEWTON_STEP = 0.5
"""Longest Newton step of a vertex, in reaches."""
DAMPING, LEAST_DAMPING, MOST_DAMPING = 0.03, 1e-4, 1e4
"""Of the first Newton step, and within which it is divided by 4 where a step gained, else
multiplied by 6."""


@dataclass(frozen=True, eq=False)
class _Problem:
    """K partitions laid out for whole-array passes: arrays of coordinates come first."""

    starts: Ints  # flat vertex index (K, A)
    ends: Ints  # (K, A)
    both: Ints  # starts and ends, flat (2 K A,)
    left: Floats  # direction on the left over the sine of its reach (3, K, A)
    right: Floats  # the same on the right, negated (3, K, A)
    stretch: Floats  # what a unit of arc adds to its ratio (K, A)
    scale: Floats  # mean reach around each vertex (K V,)

    @property
    def rows(self) -> int:
        return len(self.starts)

    @property
    def vertices(self) -> int:
        return len(self.scale) // len(self.starts)


@dataclass(frozen=True, eq=False)
class _State:
    """Arcs of partitions at given vertices."""

    a: Floats  # start of each arc (3, K, A)
    b: Floats  # end of each arc (3, K, A)
    normals: Floats  # unit a × b (3, K, A)
    shrink: Floats  # 1 / |a × b| (K, A)
    spans: Floats  # unit a − b (3, K, A)
    ratios: Floats  # of the clearance on the left and right and of the length (K, 3, A)

    @property
    def lowest(self) -> Floats:
        """Smallest ratio of each partition, shape (K,)."""
        smallest: Floats = self.ratios.reshape(len(self.ratios), -1).min(axis=1)
        return smallest


def relaxed(
    directions: UnitVectors,
    reach: Floats,
    quads: Ints,
    vertices: UnitVectors,
    *,
    flow: int = 0,
    part: tuple[float, float] = (0.0, 1.0),
    newton: int = 0,
    sharpness: tuple[float, float] = NEWTON_SHARPNESS,
) -> tuple[UnitVectors, Floats]:
    """Return better vertices (K, N + 2, 3) and the smallest ratio reached, (K,).

    Parameters
    ----------
    directions : (K, N, 3) float64, unit vectors
    reach : (K, N) float64, half the angle to the nearest neighbor, rad
    quads : (K, N, 4) intp, closed
    vertices : (K, N + 2, 3) float64, where to start; they need not be certified
    flow : number of steps along the gradient
    part : where in the schedule of such steps they begin and end
    newton : number of Newton steps after these
    sharpness : of the soft minimum at the first and the last Newton step
    """
    moved, lowest = np.empty_like(vertices), np.empty(len(quads))
    for block in blocks(len(quads), 2 * quads.shape[1] * ARC_BYTES, CACHE):
        problem = _problem(directions[block], reach[block], quads[block])
        flat = np.ascontiguousarray(np.moveaxis(vertices[block], 2, 0)).reshape(3, -1)
        if flow:
            flat = _climb(problem, flat, np.linspace(*part, flow))
        flat, lowest[block] = _newton(problem, flat, newton, sharpness)
        moved[block] = np.moveaxis(flat.reshape(3, problem.rows, -1), 0, 2)
    return moved, lowest


def _problem(directions: UnitVectors, reach: Floats, quads: Ints) -> _Problem:
    arcs = arcs_of(quads)
    row = np.arange(len(quads))[:, None]
    first = row * (quads.shape[1] + 2)
    starts, ends = first + arcs.starts, first + arcs.ends
    both = np.concatenate([starts.reshape(-1), ends.reshape(-1)])
    weighted = np.ascontiguousarray(np.moveaxis(directions / np.sin(reach)[..., None], 2, 0))
    beside = (reach[row, arcs.left] + reach[row, arcs.right]) / 2
    around = np.bincount(both, np.tile(beside.reshape(-1), 2)) / np.bincount(both)
    return _Problem(
        starts,
        ends,
        both,
        weighted[:, row, arcs.left],
        -weighted[:, row, arcs.right],
        (1 - SHORT_ARC_RATIO) / (SHORT_ARC * beside),
        around,
    )


def _state(problem: _Problem, vertices: Floats) -> _State:
    a, b = vertices[:, problem.starts], vertices[:, problem.ends]
    normals = _cross(a, b)
    shrink = 1 / np.sqrt(_dot(normals, normals) + TINY)
    normals *= shrink
    spans = a - b
    lengths = np.sqrt(_dot(spans, spans) + TINY)
    spans /= lengths
    ratios = np.empty((problem.rows, 3, a.shape[2]))
    ratios[:, 0] = _dot(normals, problem.left)
    ratios[:, 1] = _dot(normals, problem.right)
    ratios[:, 2] = SHORT_ARC_RATIO + lengths * problem.stretch
    return _State(a, b, normals, shrink, spans, ratios)


def _soft_minimum(state: _State, sharpness: float) -> tuple[Floats, Floats]:
    """Return the soft minimum of the ratios, (K,), and its derivatives by them, (K, 3, A)."""
    lowest = state.lowest
    weights = np.exp(sharpness * (lowest[:, None, None] - state.ratios))
    total = weights.reshape(len(weights), -1).sum(axis=1)
    weights /= total[:, None, None]
    return lowest - np.log(total) / sharpness, weights


def _climb(problem: _Problem, vertices: Floats, progress: Floats) -> Floats:
    """Return the best vertices found along the gradient, shape (3, K V).

    A step for each of `progress`, which runs from 0 to 1 as steps get shorter and the minimum
    sharper.
    """
    best, highest = vertices, np.full(problem.rows, -np.inf)
    momentum = np.zeros_like(vertices)
    squares = np.zeros(problem.rows)
    sharpness = _geometric(FLOW_SHARPNESS, progress)
    longest = _geometric(FLOW_STEP, progress) * np.sqrt(problem.vertices)
    for step in range(len(progress)):
        state = _state(problem, vertices)
        best, highest = _better(problem, best, highest, vertices, state.lowest)
        _, weights = _soft_minimum(state, sharpness[step])
        gradient = _gradient(problem, state, weights) * problem.scale
        momentum = FLOW_INERTIA * momentum + (1 - FLOW_INERTIA) * gradient
        norm = _dot(gradient, gradient).reshape(problem.rows, -1).sum(axis=1)
        squares = FLOW_MEMORY * squares + (1 - FLOW_MEMORY) * norm
        mean_square = squares / (1 - FLOW_MEMORY ** (step + 1))
        rate = longest[step] / np.sqrt(mean_square + TINY)
        vertices = _unit(vertices + momentum * (problem.scale * np.repeat(rate, problem.vertices)))
    best, _ = _better(problem, best, highest, vertices, _state(problem, vertices).lowest)
    return best


def _newton(
    problem: _Problem, vertices: Floats, steps: int, ends: tuple[float, float]
) -> tuple[Floats, Floats]:
    """Return the best vertices found by damped Newton steps, (3, K V), and their lowest ratio."""
    state = _state(problem, vertices)
    best, highest = vertices, state.lowest
    damping = np.full(problem.rows, DAMPING)
    for sharpness in _geometric(ends, np.linspace(0, 1, steps)):
        value, weights = _soft_minimum(state, sharpness)
        tried = _newton_step(problem, vertices, state, weights, sharpness, damping)
        tried_state = _state(problem, tried)
        tried_value, _ = _soft_minimum(tried_state, sharpness)
        gained = tried_value > value
        damping = np.where(gained, damping / 4, damping * 6)
        damping = np.clip(damping, LEAST_DAMPING, MOST_DAMPING)
        vertices = np.where(np.repeat(gained, problem.vertices), tried, vertices)
        state = _state(problem, vertices)
        best, highest = _better(problem, best, highest, vertices, state.lowest)
    return best, highest


def _newton_step(
    problem: _Problem,
    vertices: Floats,
    state: _State,
    weights: Floats,
    sharpness: float,
    damping: Floats,
) -> Floats:
    """Return the vertices after one damped Newton step up the soft minimum, shape (3, K V).

    Its curvature is taken as that of the weights alone, −sharpness times the covariance of the
    ratios' gradients: the ratios themselves are nearly linear beside it.
    """
    rows, count = problem.rows, problem.vertices
    first = any_perpendicular(np.ascontiguousarray(vertices.T)).T
    tangents = np.stack([first, _cross(vertices, first)]) * problem.scale  # (2, 3, K V)
    slopes = _slopes(problem, state, tangents)  # (3 ratios, 4 unknowns of an arc, K, A)
    weighted = np.moveaxis(weights, 1, 0)[:, None] * slopes
    steepness = np.empty((rows, count, 2))
    hessian = np.zeros((rows, count, 2, count, 2))
    row, vertex = np.arange(rows)[:, None], np.arange(count)
    starts, ends = problem.starts - row * count, problem.ends - row * count
    gradient = weighted.sum(axis=0)
    products = np.einsum("rpka,rqka->pqka", weighted, slopes)
    for p in range(2):
        steepness[:, :, p] = _gathered(problem, gradient[p], gradient[p + 2])
        for q in range(2):
            own = _gathered(problem, products[p, q], products[p + 2, q + 2])
            hessian[:, vertex, p, vertex, q] = own
            hessian[row, starts, p, ends, q] = products[p, q + 2]
            hessian[row, ends, p, starts, q] = products[p + 2, q]

    slope = steepness.reshape(rows, 2 * count)
    matrix = hessian.reshape(rows, 2 * count, 2 * count)
    matrix -= slope[:, :, None] * slope[:, None]
    matrix *= sharpness
    unknown = np.arange(2 * count)
    # Where vertices nearly coincide the slopes are huge; the second term keeps it regular.
    steepest = matrix[:, unknown, unknown].max(axis=1)
    matrix[:, unknown, unknown] += (damping + 1e-10 * steepest)[:, None]
    step = np.linalg.solve(matrix, slope[:, :, None])[..., 0]
    along = step.reshape(-1, 2).T
    longest = np.sqrt((along**2).sum(axis=0)).reshape(rows, count).max(axis=1)
    along *= np.repeat(NEWTON_STEP / np.maximum(longest, NEWTON_STEP), count)
    return _unit(vertices + along[0] * tangents[0] + along[1] * tangents[1])


def _slopes(problem: _Problem, state: _State, tangents: Floats) -> Floats:
    """Return the derivative of each ratio by the moves of its arc's ends, (3, 4, K, A).

    The four moves are those of the start along each tangent, then those of the end.
    """
    at_starts, at_ends = tangents[:, :, problem.starts], tangents[:, :, problem.ends]
    slopes = np.empty((3, 4, *problem.starts.shape))
    for side, directions in enumerate((problem.left, problem.right)):
        pull = (directions - state.ratios[:, side] * state.normals) * state.shrink
        slopes[side, :2] = (_cross(state.b, pull) * at_starts).sum(axis=1)
        slopes[side, 2:] = (_cross(pull, state.a) * at_ends).sum(axis=1)
    apart = state.spans * problem.stretch
    slopes[2, :2] = (apart * at_starts).sum(axis=1)
    slopes[2, 2:] = -(apart * at_ends).sum(axis=1)
    return slopes


def _gradient(problem: _Problem, state: _State, weights: Floats) -> Floats:
    """Return the derivative by the vertices of the weighted sum of the ratios, (3, K V)."""
    left, right, length = np.moveaxis(weights, 1, 0)
    along = left * state.ratios[:, 0] + right * state.ratios[:, 1]
    pull = (left * problem.left + right * problem.right - along * state.normals) * state.shrink
    apart = state.spans * (length * problem.stretch)
    at_starts, at_ends = _cross(state.b, pull) + apart, _cross(pull, state.a) - apart
    return np.stack(
        [_gathered(problem, at_starts[axis], at_ends[axis]).reshape(-1) for axis in range(3)]
    )


def _gathered(problem: _Problem, at_starts: Floats, at_ends: Floats) -> Floats:
    """Return the sums at each vertex of values at both ends of the arcs, shape (K, V)."""
    values = np.concatenate([at_starts.reshape(-1), at_ends.reshape(-1)])
    sums = np.bincount(problem.both, values, minlength=len(problem.scale))
    gathered: Floats = sums.reshape(problem.rows, problem.vertices).astype(np.float64, copy=False)
    return gathered


def _better(
    problem: _Problem, best: Floats, highest: Floats, vertices: Floats, lowest: Floats
) -> tuple[Floats, Floats]:
    """Return `best` and `highest` with what `vertices` improve on them."""
    improved = np.repeat(lowest > highest, problem.vertices)
    return np.where(improved, vertices, best), np.maximum(lowest, highest)


def _geometric(ends: tuple[float, float], progress: Floats) -> Floats:
    """Return the values that lead evenly in ratio from one end to the other."""
    between: Floats = ends[0] * (ends[1] / ends[0]) ** progress
    return between


def _unit(vectors: Floats) -> Floats:
    """Return `vectors` (3, ...) scaled to length 1."""
    scaled: Floats = vectors / np.sqrt(_dot(vectors, vectors) + TINY)
    return scaled


def _dot(a: Floats, b: Floats) -> Floats:
    """Return the dot products of vectors whose coordinates come first."""
    products: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return products


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of vectors whose coordinates come first, shape (3, ...)."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        np.multiply(a[first], b[second], out=product[axis])
        product[axis] -= a[second] * b[first]
    return product
