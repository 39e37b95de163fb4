"""Sparse matrices from files in the format of Matrix Market."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from asperity.errors import ParameterError
from asperity.system.sparse.files.entries import general, symmetric, table, whole_lines

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Above every number of rows: SciPy stores one index for each.
_LARGEST = 2**31


def read_matrix_market(path: str | os.PathLike[str]) -> SparseMatrix:
    r"""Read a real sparse matrix, "coordinate" in Matrix Market's words.

    Exponents of Fortran, 1.0D+03, are read as such. A file that says "symmetric" and holds both
    triangles is refused: SciPy adds them, which doubles what is not on the diagonal.

    Args:
        path: of the file.

    Returns:
        The whole matrix in compressed columns, also of a file that holds one triangle.

    Raises:
        ParameterError: if the file is not such a one or contradicts itself.

    Reference: Matrix Market, https://math.nist.gov/MatrixMarket/formats.html.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from asperity.system import read_matrix_market
    >>> header = "%%MatrixMarket matrix coordinate real symmetric"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "K.mtx"
    ...     size = path.write_text(f"{header}\n2 2 2\n1 1 1.0D+03\n2 1 -5.0\n")
    ...     print(read_matrix_market(path).toarray().tolist())
    [[1000.0, -5.0], [-5.0, 0.0]]
    """
    name = os.path.basename(os.fspath(path))
    first, *lines = whole_lines(path).splitlines() or [""]
    words = first.lower().split()
    if len(words) != 5 or words[:2] != ["%%matrixmarket", "matrix"]:
        raise ParameterError("path", f"{name} does not begin with %%MatrixMarket matrix")
    layout, kind, symmetry = words[2:]
    if layout != "coordinate" or kind not in ("real", "double", "integer"):
        raise ParameterError(
            "path", f"{name} must be a real matrix by coordinates, is {layout} {kind}"
        )
    content = [line for line in lines if line.strip() and not line.startswith("%")]
    size = table(content[:1], name, 3)
    if not len(size):
        raise ParameterError("path", f"{name} lacks the line with its size")
    if (size != np.floor(size)).any() or (size < 0).any() or (size >= _LARGEST).any():
        raise ParameterError("path", f"{name} must have a size of whole numbers, has {content[0]}")
    rows, columns, count = (int(number) for number in size[0])
    entries = table(content[1:], name, 3)
    if len(entries) != count:
        raise ParameterError("path", f"{name} must hold {count} entries, holds {len(entries)}")
    if symmetry == "general":
        return general(entries, (rows, columns), name)
    if symmetry not in ("symmetric", "skew-symmetric") or rows != columns:
        raise ParameterError(
            "path", f"{name} must be general, symmetric or skew-symmetric, is {symmetry}"
        )
    if symmetry == "skew-symmetric" and (entries[:, 0] == entries[:, 1]).any():
        raise ParameterError("path", f"{name} is skew-symmetric and holds entries of the diagonal")
    return symmetric(entries, rows, name, sign=1.0 if symmetry == "symmetric" else -1.0)
