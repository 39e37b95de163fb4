"""Matrices of finite elements in the formats of several programs."""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity.errors import DimensionError, ParameterError
from asperity.system.sparse import matrices
from asperity.system.sparse.files.calculix import read_deck
from asperity.system.sparse.files.entries import (
    either,
    general,
    number,
    table,
    text_of,
    whole_lines,
)
from asperity.system.sparse.files.matrix_market import read_matrix_market
from asperity.system.sparse.files.model import FiniteElementModel, beside, of_matrices

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

Source: TypeAlias = str | os.PathLike[str] | tuple[str | os.PathLike[str], str]

_NAMES = {"mass": "M", "stiffness": "K", "damping": "C"}
# A string of OP4 that is not "big" holds its length and its first row in one number.
_STRING = 65536
# Stiffness, relative to that of most coordinates, of those that are held: 1/ε.
_HELD = 2.0**52


@dataclass(frozen=True)
class _Stored:
    """A matrix, or the entries (node, direction, node, direction, value) of one."""

    matrix: SparseMatrix | None
    entries: Array | None = None
    dof: NDArray[np.intp] | None = None


def read_matrices(
    *,
    mass: Source,
    stiffness: Source,
    damping: Source | None = None,
    dof: ArrayLike | None = None,
    deck: str | os.PathLike[str] | None = None,
) -> FiniteElementModel:
    r"""Read M, K and perhaps C of a finite-element model, in the format that each file is in.

    Matrix Market (.mtx); the text of Abaqus' ``*MATRIX OUTPUT``, FORMAT=MATRIX INPUT or LABELS,
    which names nodes, or COORDINATE; OUTPUT4 of Nastran as text (.op4); MATLAB (.mat, up to version
    7); Ansys (.full, by ``pip install ansys-mapdl-reader``). One triangle of a symmetric matrix is
    mirrored where the format says so, exponents of Fortran are read. Coordinates that all matrices
    leave empty are left out as held where nodes are known, as are those that a program holds by a
    number such as 1e36 on the diagonal of K.

    Args:
        mass: file, or (file, name) for one of several matrices; by default M.
        stiffness: likewise, by default K.
        damping: likewise, by default C.
        dof: node and direction, from 1 on, of each row, shape ``(n, 2)``; of files that name none.
        deck: input of Abaqus or CalculiX with nodes and sets of nodes.

    Returns:
        The matrices, nodes and directions of the coordinates, and findings.

    Raises:
        DimensionError, ParameterError: if a file is not such a one or contradicts the others.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from asperity.system import read_matrices
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     K, M = (Path(folder) / name for name in ("job_STIF1.mtx", "job_MASS1.mtx"))
    ...     size = K.write_text("7,1, 7,1, 5.0D+03\n7,2, 7,1, -2.0D+03\n7,2, 7,2, 4.0D+03\n")
    ...     size = M.write_text("7,1, 7,1, 0.5\n7,2, 7,2, 0.5\n")
    ...     model = read_matrices(mass=M, stiffness=K)
    >>> model.stiffness.toarray().tolist(), model.nodes.tolist()
    ([[5000.0, -2000.0], [-2000.0, 4000.0]], [7, 7])
    """
    given = {"mass": mass, "stiffness": stiffness, "damping": damping}
    read = {}
    for role, source in given.items():
        if source is not None or role != "damping":
            with _named_as(role):
                read[role] = _read(source, role)
    table_of_dof, found = _joined(read)
    n = found["stiffness"].shape[0]
    for role, one in found.items():
        if one.shape != (n, n):
            raise DimensionError(role, f"must have shape {(n, n)} like the others, has {one.shape}")
    if dof is not None:
        if table_of_dof is not None:
            raise ParameterError("dof", "is for files that name no nodes, these do")
        wanted = arrays.array(dof, "dof", (n, 2))
        whole = (wanted == np.floor(wanted)).all() and (wanted[:, 1] >= 1.0).all()
        if not whole or len(np.unique(wanted, axis=0)) < n:
            raise ParameterError("dof", "must name a node and a direction of each row, once")
        table_of_dof = wanted.astype(np.intp)
    with _named_as("deck"):
        places, sets, cards = read_deck("" if deck is None else text_of(deck))
    findings = []
    if "INSTANCE" in cards:
        findings.append("The input has instances of parts, whose nodes the files number anew.")
    difference = abs(found["stiffness"] - found["stiffness"].T)
    if difference.nnz and difference.max() > 1e-9 * abs(found["stiffness"]).max():
        findings.append(f"K is not symmetric: entries differ by up to {difference.max():.3g}.")
    if table_of_dof is None:
        findings.append("The files name no nodes; give dof to ask for coordinates of nodes.")
        table_of_dof = np.zeros((n, 2), dtype=np.intp)
    else:
        size = np.zeros(n)
        for one in found.values():
            size += np.asarray((abs(one) + abs(one.T)) @ np.ones(n))
        empty, springs = size == 0.0, np.abs(found["stiffness"].diagonal())
        # Programs hold coordinates by a number beside which other stiffness is rounding.
        typical = np.median(springs[springs > 0.0]) if springs.any() else 0.0
        stiff = springs > _HELD * typical
        if stiff.any():
            findings.append(
                f"{counted(int(stiff.sum()), 'coordinate')} with a stiffness of "
                f"{springs[stiff].min():.3g} and more were left out as held, such as that of node "
                f"{table_of_dof[np.flatnonzero(stiff)[0], 0]}."
            )
        kept = np.flatnonzero(~empty & ~stiff)
        if empty.any():
            findings.append(
                f"{counted(int(empty.sum()), 'row')} without entries were left out as held, such "
                f"as that of node {table_of_dof[np.flatnonzero(empty)[0], 0]}."
            )
        if len(kept) < n:
            table_of_dof = table_of_dof[kept]
            found = {role: one[kept][:, kept].tocsc() for role, one in found.items()}
        nodes = table_of_dof[:, 0]
        findings += beside(nodes, places)
        findings += of_matrices(found["mass"], found["stiffness"], table_of_dof, places)
    return FiniteElementModel(
        found["mass"],
        found["stiffness"],
        table_of_dof[:, 0],
        table_of_dof[:, 1] - 1,
        places,
        sets,
        tuple(findings),
        found.get("damping"),
    )


def _joined(
    read: dict[str, _Stored],
) -> tuple[NDArray[np.intp] | None, dict[str, SparseMatrix]]:
    """Return the coordinates of all matrices, if files name them, and the matrices."""
    named = {role: one.entries for role, one in read.items() if one.entries is not None}
    if not named:
        dof = next((one.dof for one in read.values() if one.dof is not None), None)
        return dof, {role: one.matrix for role, one in read.items() if one.matrix is not None}
    for role in read:
        if role not in named:
            raise ParameterError(role, "must name nodes, as the other files do")
    for role, one in named.items():
        if (one[:, :4] != np.floor(one[:, :4])).any() or (one[:, [1, 3]] < 1).any():
            raise ParameterError(role, "must name nodes and directions by whole numbers from 1")
    places = np.concatenate([one[:, k : k + 2] for one in named.values() for k in (0, 2)])
    dof, index = np.unique(places.astype(np.intp), axis=0, return_inverse=True)
    found, start = {}, 0
    for role, one in named.items():
        m = len(one)
        rows, columns = index[start : start + m], index[start + m : start + 2 * m]
        entries = np.stack([rows + 1.0, columns + 1.0, one[:, 4]], axis=1)
        with _named_as(role):
            found[role] = either(entries, len(dof), "it")
        start += 2 * m
    return dof, found


@contextmanager
def _named_as(argument: str) -> Iterator[None]:
    """Say of a wrong file which argument names it."""
    try:
        yield
    except ParameterError as error:
        raise type(error)(
            argument if error.argument == "path" else error.argument, error.message
        ) from None


def _read(source: Source | None, role: str) -> _Stored:
    path, name = source if isinstance(source, tuple) and len(source) == 2 else (source, None)
    if not isinstance(path, str | os.PathLike):
        raise ParameterError(role, f"must be a file or (file, name), got {source!r}")
    ending = Path(os.fspath(path)).suffix.lower()
    if ending == ".mat":
        return _Stored(_matlab(path, name, role))
    if ending == ".op4":
        return _Stored(_op4(path, name, role))
    if ending == ".full":
        return _full(path, _NAMES[role] if name is None else name, role)
    if name is not None:
        raise ParameterError(role, f"must be a file of one matrix: {ending or 'text'} has no names")
    text = text_of(path)
    if text[:2] == "%%":
        return _Stored(read_matrix_market(path))
    trimmed = (line.strip() for line in text.replace(",", " ").splitlines())
    lines = [line for line in trimmed if line[:1] not in "*%#"]
    file = os.path.basename(os.fspath(path))
    width = len(lines[0].split()) if lines else 0
    if width not in (3, 5):
        raise ParameterError(
            role, f"must hold lines of 3 or 5 numbers, as of Abaqus, {file} begins with {width}"
        )
    whole_lines(path)
    entries = table(lines, file, width)
    if width == 5:
        return _Stored(None, entries)
    n = entries[:, :2].max()
    return _Stored(either(entries, int(n) if n < 2**31 else 0, file))


def _named(found: dict[str, Any], name: str | None, role: str, path: Any) -> Any:
    wanted = next(iter(found)) if name is None and len(found) == 1 else name or _NAMES[role]
    if wanted not in found:
        file, names = os.path.basename(os.fspath(path)), ", ".join(found) or "nothing"
        raise ParameterError(role, f"must be one of {file} ({names}): give (file, name)")
    return found[wanted]


def _matlab(path: Any, name: str | None, role: str) -> SparseMatrix:
    import scipy.io
    from scipy.io.matlab import MatReadError

    try:
        held = scipy.io.loadmat(os.fspath(path))
    except (
        *(OSError, ValueError, TypeError, LookupError, RuntimeError),
        *(MemoryError, OverflowError, MatReadError, zlib.error),
    ) as error:
        raise ParameterError(
            role, f"cannot be read: {error}; files of MATLAB 7.3 must be saved with -v7"
        ) from None
    found = {key: value for key, value in held.items() if not key.startswith("__")}
    value = _named(found, name, role, path)
    if not (matrices.is_sparse(value) or (isinstance(value, np.ndarray) and value.ndim == 2)):
        raise ParameterError(role, f"must be a matrix, {name} is {type(value).__name__}")
    if not matrices.is_sparse(value):
        value = arrays.array(value, role)
    else:
        # SciPy reads indices without a look at them, and crashes on wrong ones.
        try:
            value.check_format(full_check=True)
        except ValueError as error:
            raise ParameterError(role, f"is damaged: {error}") from None
    return matrices.compressed(value, role, matrices.order(value, role))


def _op4(path: Any, name: str | None, role: str) -> SparseMatrix:
    """Read OUTPUT4 as text: columns of strings, or of one string each where they are dense."""
    file, lines = os.path.basename(os.fspath(path)), iter(text_of(path).splitlines())
    found: dict[str, Any] = {}
    try:
        for head in lines:
            if not head.strip():
                continue
            columns, rows, form, kind = (int(head[k : k + 8]) for k in (0, 8, 16, 24))
            width = int(re.split("[ED.]", head[40:].upper())[1])
            # Single precision has one number of four bytes for each value, double precision two.
            listed = _columns(lines, columns, width, 1 + (kind + 1) % 2, rows < 0)
            found[head[32:40].strip()] = listed, (abs(rows), columns), form, kind
    except (ValueError, IndexError, StopIteration, RuntimeError):
        raise ParameterError(
            role, f"{file} is not text of OUTPUT4, or cut off; binary files are not read"
        ) from None
    listed, shape, form, kind = _named(found, name, role, path)
    if kind not in (1, 2) or shape[0] != shape[1]:
        what = "complex" if kind > 2 else f"of shape {shape}"
        raise ParameterError(role, f"must be real and square, the one of {file} is {what}")
    entries = np.array(listed, dtype=np.float64).reshape(-1, 3)
    # Dense columns hold the zeros in between.
    entries = entries[entries[:, 2] != 0.0]
    return either(entries, shape[0], file) if form == 6 else general(entries, shape, file)


def _columns(
    lines: Iterator[str], count: int, width: int, words_each: int, big: bool
) -> list[tuple[int, int, float]]:
    entries: list[tuple[int, int, float]] = []
    column = row = left = 0
    for line in lines:
        if "." in line:
            values = [number(line[k : k + width]) for k in range(0, len(line.rstrip()), width)]
            if column > count:
                return entries
            entries += [(row + i, column, value) for i, value in enumerate(values)]
            row, left = row + len(values), left - len(values)
            continue
        words = [int(word) for word in line.split()]
        if left > 0:
            break
        if len(words) == 3:
            column, row, left = words[0], words[1], 0
        else:
            length, row = words if big else divmod(words[0], _STRING)
            left = (length - 1) // words_each
    raise ValueError("without its last column")


def _full(path: Any, name: str, role: str) -> _Stored:
    try:
        from ansys.mapdl.reader import read_binary
    except ImportError as error:
        raise ModuleNotFoundError(
            ".full files need it: pip install ansys-mapdl-reader", name=error.name
        ) from None
    try:
        dof, K, M = read_binary(os.fspath(path)).load_km(sort=False)
    except (OSError, ValueError, LookupError, RuntimeError, AttributeError) as error:
        raise ParameterError(role, f"cannot be read by ansys-mapdl-reader: {error}") from None
    from scipy.sparse import triu

    upper = _named({"K": K, "M": M}, name, role, path)
    whole = matrices.compressed(upper + triu(upper, 1).T, role, upper.shape[0])
    return _Stored(whole, dof=np.asarray(dof).astype(np.intp) + np.array([0, 1]))
