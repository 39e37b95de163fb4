"""The Delassus operator: dense, sparse, or from bodies and contact directions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# A Delassus operator given next to its bodies may differ from theirs by this, relatively.
# Velocities of the largest part of M that is inverted densely, as in the core.
_LARGEST_PART = 512
_CONSISTENT = 1e-6


def operator(value: Any, argument: str, shape: Sequence[int | None]) -> Array | csr_array:
    """Return a read-only dense array, or a canonical CSR array of what is sparse."""
    if hasattr(value, "tocsr"):
        return sparse(value, argument, shape)
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
    m = checked_mass(mass)
    w = sparse(directions, "directions", (m.shape[0], rows))
    if delassus is not None:
        delassus = sparse(delassus, "delassus", (rows, rows))
        check_consistency(delassus, m, w)
    return {"delassus": delassus, "mass": m, "directions": w}


def for_core(
    delassus: Array | csr_array | None, mass: csr_array | None, directions: csr_array | None
) -> Any:
    """Return the operator as the core takes it."""
    if mass is not None and directions is not None:
        known = None if delassus is None else _triple(delassus)
        transposed = sparse(directions.T, "directions", (None, None))
        return _triple(mass), _triple(transposed), known
    return delassus if isinstance(delassus, np.ndarray) else _triple(delassus)


def as_sparse(matrix: Array | csr_array) -> csr_array:
    """Return a dense operator without its zeros, a sparse one as it is."""
    if isinstance(matrix, np.ndarray):
        return sparse(matrix, "delassus", (None, None))
    return matrix


def sparse(value: Any, argument: str, shape: Sequence[int | None]) -> csr_array:
    """Return a read-only CSR array with sorted columns and none of them twice."""
    from scipy.sparse import csr_array

    if not hasattr(value, "tocsr"):
        value = arrays.array(value, argument, (None, None))
    elif value.dtype.kind not in "iufb":
        raise ParameterError(argument, f"must hold real numbers, has dtype {value.dtype}")
    else:
        arrays.check_shape(value, argument, shape)
        _check_indices(value, argument)
    matrix: csr_array = csr_array(value, dtype=np.float64, copy=True)
    arrays.check_shape(matrix, argument, shape)
    arrays.array(matrix.data, argument)
    matrix.sum_duplicates()
    # SciPy's type of index depends on the content; one type makes equal matrices equal bytes.
    matrix.indices = matrix.indices.astype(np.int64)
    matrix.indptr = matrix.indptr.astype(np.int64)
    for part in (matrix.data, matrix.indices, matrix.indptr):
        part.flags.writeable = False
    return matrix


def _check_indices(matrix: Any, argument: str) -> None:
    """SciPy builds matrices whose indices point outside, and crashes on them later."""
    rows, columns = matrix.shape
    if matrix.format == "coo":
        check_triplets(matrix.coords, matrix.data.size, matrix.shape, argument)
    elif matrix.format in ("csr", "csc", "bsr"):
        if matrix.format == "bsr":
            rows, columns = rows // matrix.blocksize[0], columns // matrix.blocksize[1]
        shape = (columns, rows) if matrix.format == "csc" else (rows, columns)
        check_compressed(matrix.indptr, matrix.indices, len(matrix.data), shape, argument)


def check_triplets(
    coordinates: Sequence[NDArray[Any]], entries: int, shape: Sequence[int], argument: str
) -> None:
    """Refuse rows and columns that are not those of entries of a matrix of a shape."""
    for indices, size in zip(coordinates, shape, strict=True):
        if indices.shape != (entries,):
            problem = f"there are {indices.size} indices of {entries} entries"
        elif indices.size and not 0 <= indices.min() <= indices.max() < size:
            problem = f"indices must lie in 0..{size - 1}"
        else:
            continue
        raise ParameterError(argument, f"must be a valid sparse matrix: {problem}")


def check_compressed(
    starts: NDArray[Any],
    indices: NDArray[Any],
    entries: int,
    shape: tuple[int, int],
    argument: str,
) -> None:
    """Refuse anything but a matrix of ``shape[0]`` compressed rows of ``shape[1]`` columns.

    SciPy's own check leaves out the order of the starts where the last one is zero, and its
    conversions and its sum of duplicates write where the starts and indices point.
    """
    count, width = shape
    problem = None
    if starts.ndim != 1 or indices.ndim != 1 or starts.size != count + 1:
        problem = f"there must be {count + 1} starts, are {starts.size}"
    elif indices.size != entries:
        problem = f"there are {indices.size} indices of {entries} entries"
    elif starts[0] != 0 or (starts[1:] < starts[:-1]).any() or starts[-1] > entries:
        problem = f"starts must not decrease from 0 to at most {entries}"
    else:
        # There may be room for more entries.
        used = indices[: starts[-1]]
        if used.size and not 0 <= used.min() <= used.max() < width:
            problem = f"indices must lie in 0..{width - 1}"
    if problem is not None:
        raise ParameterError(argument, f"must be a valid sparse matrix: {problem}")


def _triple(matrix: Any) -> tuple[Any, Any, Any]:
    """Return row starts, columns and values."""
    return matrix.indptr, matrix.indices, matrix.data


def checked_mass(value: Any) -> csr_array:
    """Return a symmetric mass matrix with a positive diagonal."""
    mass = sparse(value, "mass", (None, None))
    if mass.shape[0] != mass.shape[1]:
        raise DimensionError("mass", f"must be square, got {mass.shape}")
    diagonal = mass.diagonal()
    if not diagonal.size or diagonal.min() <= 0.0:
        raise ParameterError("mass", "must be positive definite, its diagonal is not positive")
    skew = abs(mass - mass.T)
    if skew.nnz and skew.max() > 1e-9 * diagonal.max():
        raise ParameterError("mass", f"must be symmetric, it is off by {skew.max():.3g}")
    return mass


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
    if not off <= _CONSISTENT * size:
        share = f"{off / size:.3g}" if size > 0.0 else "all of it"
        raise ParameterError(
            "delassus", f"must be WᵀM⁻¹W of mass and directions, it is off by {share}"
        )


def inverse(mass: csr_array) -> csr_array:
    """Return M⁻¹ of a block-diagonal matrix, all blocks of one size at once."""
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
        parts.append((_inverted(dense), rows))
    data = np.concatenate([inverse.ravel() for inverse, _ in parts])
    i = np.concatenate([np.repeat(rows, rows.shape[1], axis=1).ravel() for _, rows in parts])
    j = np.concatenate([np.tile(rows, (1, rows.shape[1])).ravel() for _, rows in parts])
    inverse = coo_array((data, (i, j)), shape=mass.shape)
    return inverse.tocsr()


def _inverted(blocks: Array) -> Array:
    try:
        np.linalg.cholesky(blocks)
    except np.linalg.LinAlgError:
        raise ParameterError("mass", "must be positive definite") from None
    return np.asarray(np.linalg.inv(blocks), dtype=np.float64)
