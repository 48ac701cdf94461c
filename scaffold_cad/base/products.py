"""Products of matrices whose rows are the same to the last bit, however many rows there are."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats

ROWS = 24
"""Rows multiplied at once: a library for products treats numbers of rows in different ways."""


def row_products(rows: Floats, matrix: Floats) -> Floats:
    """Return `rows` (k, m) @ `matrix` (m, n), each row as it would be among any others.

    Examples
    --------
    >>> row_products(np.array([[1.0, 2.0]]), np.array([[3.0], [4.0]])).tolist()
    [[11.0]]
    """
    count = len(rows)
    stacks = -(-count // ROWS)
    padded = np.zeros((stacks * ROWS, rows.shape[1]))
    padded[:count] = rows
    product: Floats = padded.reshape(stacks, ROWS, len(matrix)) @ matrix
    return product.reshape(stacks * ROWS, matrix.shape[1])[:count]
