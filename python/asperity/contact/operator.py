"""The Delassus operator: dense, sparse, or from bodies and contact directions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact.compressed import CompressedRows, compressed, sparse
from asperity.errors import DimensionError, ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# Velocities of the largest part of M that is inverted densely, as in the core.
_LARGEST_PART = 512
# A Delassus operator given next to its bodies may differ from theirs by this, relatively.
CONSISTENT = 1e-6


def operator(value: Any, argument: str, shape: Sequence[int | None]) -> Array | CompressedRows:
    """Return a read-only dense array, or the rows of what is sparse."""
    if hasattr(value, "tocsr"):
        return compressed(value, argument, shape)
    return arrays.read_only(arrays.array(value, argument, shape))


def parameters(delassus: Any, mass: Any, directions: Any, rows: int) -> dict[str, Any]:
    """Return the checked operator and bodies, ``None`` what is not given."""
    if mass is None and directions is None:
        if delassus is None:
            raise ParameterError("delassus", "must be given unless mass and directions are")
        checked = operator(delassus, "delassus", (rows, rows))
        return {"delassus": checked, "mass": None, "directions": None}
    if mass is None or directions is None:
        missing = "mass" if mass is None else "directions"
        raise ParameterError(missing, "must be given too: bodies have a mass and directions")
    m = square(mass)
    w = compressed(directions, "directions", (m.shape[0], rows))
    if delassus is not None:
        check_mass(m)
        delassus = compressed(delassus, "delassus", (rows, rows))
        check_consistency(delassus.tocsr(), m.tocsr(), w.tocsr())
    return {"delassus": delassus, "mass": m, "directions": w}


def for_core(
    delassus: Array | CompressedRows | None,
    mass: CompressedRows | None,
    directions: CompressedRows | None,
) -> Any:
    """Return the operator as the core takes it."""
    known = delassus.triple if isinstance(delassus, CompressedRows) else delassus
    if mass is None or directions is None:
        return known
    return mass.triple, directions.transposed().triple, known


def as_sparse(matrix: Array | csr_array) -> csr_array:
    """Return a dense operator without its zeros, a sparse one as it is."""
    if isinstance(matrix, np.ndarray):
        return sparse(matrix, "delassus", (None, None))
    return matrix


def checked_mass(value: Any) -> CompressedRows:
    """Return a symmetric mass matrix with a positive diagonal."""
    mass = square(value)
    check_mass(mass)
    return mass


def square(value: Any) -> CompressedRows:
    """Return the rows of a mass matrix."""
    mass = compressed(value, "mass", (None, None))
    if mass.shape[0] != mass.shape[1]:
        raise DimensionError("mass", f"must be square, got {mass.shape}")
    return mass


def check_mass(mass: CompressedRows) -> None:
    """Refuse a matrix that is not symmetric or has a diagonal that is not positive."""
    matrix = mass.tocsr()
    diagonal = matrix.diagonal()
    if not diagonal.size or diagonal.min() <= 0.0:
        raise ParameterError("mass", "must be positive definite, its diagonal is not positive")
    skew = abs(matrix - matrix.T).max()
    if skew > 1e-9 * diagonal.max():
        raise ParameterError("mass", f"must be symmetric, it is off by {skew:.3g}")


def check_directions(directions: CompressedRows) -> None:
    """Refuse columns that move nothing."""
    idle = np.flatnonzero(abs(directions.tocsr()).sum(axis=0) == 0.0)
    if idle.size:
        raise ParameterError("directions", f"must move in every row, row {idle[0]} moves nothing")


def assembled(mass: csr_array, directions: csr_array) -> csr_array:
    """Return G = Wᵀ M⁻¹ W."""
    product = directions.T @ (inverse(mass) @ directions)
    # Rounding alone makes the product unsymmetric.
    return sparse(0.5 * (product + product.T), "directions", (None, None))


def check_consistency(delassus: Array | csr_array, mass: csr_array, directions: csr_array) -> None:
    """Refuse a Delassus operator that is not the one of the bodies."""
    probe = np.cos(np.arange(directions.shape[1], dtype=np.float64))
    expected = directions.T @ (inverse(mass) @ (directions @ probe))
    off, size = np.abs(delassus @ probe - expected).max(), np.abs(expected).max()
    if not off <= CONSISTENT * size:
        share = f"{off / size:.3g}" if size > 0.0 else "all of it"
        raise ParameterError(
            "delassus", f"must be WᵀM⁻¹W of mass and directions, it is off by {share}"
        )


def inverse(mass: csr_array) -> csr_array:
    """Return M⁻¹ of a block-diagonal matrix."""
    return _by_blocks(mass, _inverted)


def inverse_root(mass: csr_array) -> csr_array:
    """Return L⁻¹ of a block-diagonal matrix M = LLᵀ, L lower triangular within its blocks."""
    return _by_blocks(mass, lambda blocks: np.linalg.inv(_root(blocks)))


def _by_blocks(mass: csr_array, function: Callable[[Array], Any]) -> csr_array:
    """Return a function of the blocks of a block-diagonal matrix, all of one size at once."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    labels = connected_components(mass, directed=False)[1]
    order = np.argsort(labels, kind="stable")
    size = np.bincount(labels)
    if size.max() > _LARGEST_PART:
        raise ParameterError(
            "mass", f"must couple at most {_LARGEST_PART} velocities, a part has {size.max()}"
        )
    first = np.cumsum(size) - size
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order)) - first[labels[order]]
    entries = mass.tocoo()
    row, column = entries.coords
    parts = []
    for width in np.unique(size):
        blocks = np.flatnonzero(size == width)
        number = np.full(len(size), -1)
        number[blocks] = np.arange(len(blocks))
        inside = number[labels[row]] >= 0
        dense = np.zeros((len(blocks), width, width))
        where = number[labels[row[inside]]], place[row[inside]], place[column[inside]]
        dense[where] = entries.data[inside]
        rows = order[first[blocks][:, None] + np.arange(width)]
        parts.append((function(dense), rows))
    data = np.concatenate([found.ravel() for found, _ in parts])
    i = np.concatenate([np.repeat(rows, rows.shape[1], axis=1).ravel() for _, rows in parts])
    j = np.concatenate([np.tile(rows, (1, rows.shape[1])).ravel() for _, rows in parts])
    return coo_array((data, (i, j)), shape=mass.shape).tocsr()


def _inverted(blocks: Array) -> Array:
    _root(blocks)
    return np.asarray(np.linalg.inv(blocks), dtype=np.float64)


def _root(blocks: Array) -> Array:
    try:
        return np.asarray(np.linalg.cholesky(blocks), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise ParameterError("mass", "must be positive definite") from None
