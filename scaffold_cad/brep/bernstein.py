"""Bernstein polynomials: values, slopes, integrals, and the same polynomial in a higher degree."""

from __future__ import annotations

from math import comb

import numpy as np

from scaffold_cad.base.arrays import Floats


def bernstein(degree: int, at: Floats, order: int = 0) -> Floats:
    """Return the derivatives of `order` of the Bernstein polynomials at `at` (g,), (g, d + 1)."""
    lower = degree - order
    basis = np.stack(
        [comb(lower, i) * at**i * (1 - at) ** (lower - i) for i in range(lower + 1)], axis=1
    )
    differences = np.eye(degree + 1)
    for k in range(order):
        differences = (degree - k) * np.diff(differences, axis=0)
    return np.asarray(basis @ differences)


def gram(degree: int, order: int) -> Floats:
    """Return the integrals over [0, 1] of products of derivatives of `order`, (d + 1, d + 1)."""
    nodes, weights = np.polynomial.legendre.leggauss(degree + 1)
    values = bernstein(degree, np.asarray((nodes + 1) / 2, dtype=np.float64), order)
    return np.asarray(values.T @ (weights[:, None] / 2 * values), dtype=np.float64)


def thin_plate(degree: int) -> Floats:
    """Return the matrix of the thin-plate energy of a patch, ((d + 1)², (d + 1)²).

    The integral over the unit square of the squared second derivatives, the mixed one twice.
    """
    value, slope, bend = (gram(degree, order) for order in range(3))
    return np.asarray(np.kron(bend, value) + 2 * np.kron(slope, slope) + np.kron(value, bend))


def square_norm(degree: int) -> Floats:
    """Return the matrix of the integral of a patch's square over the unit square."""
    return np.asarray(np.kron(gram(degree, 0), gram(degree, 0)))


def elevation(degree: int, higher: int) -> Floats:
    """Return what takes coefficients of `degree` to those of degree `higher`, (h + 1, d + 1)."""
    matrix = np.eye(degree + 1)
    for top in range(degree + 1, higher + 1):
        share = np.arange(top + 1)[:, None] / top
        raised = np.zeros((top + 1, degree + 1))
        raised[1:] += share[1:] * matrix
        raised[:-1] += (1 - share[:-1]) * matrix
        matrix = raised
    return matrix


def product(factor: Floats, degree: int) -> Floats:
    """Return what multiplies polynomials of `degree` by others, in Bernstein form.

    Parameters
    ----------
    factor : (k, j + 1) float64, coefficients of k factors of degree j

    Returns
    -------
    (k, j + d + 1, d + 1) float64
    """
    top = factor.shape[1] - 1
    matrix = np.zeros((len(factor), top + degree + 1, degree + 1))
    for i in range(top + 1):
        for j in range(degree + 1):
            share = comb(top, i) * comb(degree, j) / comb(top + degree, i + j)
            matrix[:, i + j, j] = share * factor[:, i]
    return matrix
