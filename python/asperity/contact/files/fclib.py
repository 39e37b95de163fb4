"""Contact problems in HDF5 files with the layout of FCLIB, the Friction Contact Library."""

from __future__ import annotations

import importlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.storage.files import atomic
from asperity.contact import compressed, operator
from asperity.contact.arguments import dimension
from asperity.contact.files import contents
from asperity.contact.files.contents import Percussions
from asperity.contact.problem import ContactProblem
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_LOCAL = {
    "delassus": "fclib_local/W",
    "free_velocity": "fclib_local/vectors/q",
    "mass": "fclib_global/M",
    "directions": "fclib_global/H",
    "form": "data/form",
    "bilateral": "fclib_global/G",
    "bilateral_velocity": "fclib_global/vectors/b",
}
_GLOBAL = {**_LOCAL, "delassus": "fclib_global/H", "free_velocity": "fclib_global/vectors/w"}
# The library's marks for compressed columns and rows; from 0 on it is the length of a triplet form.
_COLUMNS, _ROWS = -1, -2
# Numbers that share a checksum.
_CHUNK = 2**18
_ROLLING = ("fclib_local_rolling", "fclib_global_rolling")
_JOINTS = ("fclib_local/V", "fclib_local/R")


def _h5py() -> Any:
    try:
        return importlib.import_module("h5py")
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            'h5py is missing: pip install "asperity[data]"', name=error.name
        ) from None


class _Group:
    """An open file whose errors name the path of what is missing.

    The library raises errors of many kinds on damaged bytes; all of them are the file's.
    """

    def __init__(self, file: Any, path: Path) -> None:
        self.file, self.path = file, path

    def __contains__(self, key: str) -> bool:
        with self._reading(key):
            return key in self.file

    def __getitem__(self, key: str) -> NDArray[Any]:
        with self._reading(key):
            if key not in self.file or not hasattr(self.file[key], "shape"):
                raise ParameterError(key, f"is missing in {self.path}")
            found = self.file[key][()]
            return np.array(found.decode() if isinstance(found, bytes) else found)

    def members(self, key: str) -> list[str]:
        """Return what a group holds, nothing where there is none."""
        with self._reading(key):
            return list(self.file[key]) if key in self.file else []

    @contextmanager
    def _reading(self, key: str) -> Iterator[None]:
        try:
            yield
        except ParameterError:
            raise
        except Exception as error:
            raise ParameterError(key, f"cannot be read from {self.path}: {error}") from None


def save(problem: ContactProblem, path: Path) -> None:
    """Write a problem, with checksums of arrays and, as the library has since 1.8, of the rest."""
    memory = io.BytesIO()
    with _h5py().File(memory, "w", libver=("v108", "v108")) as file:
        mu = contents.coefficients(problem)
        vectors = {"q": problem.free_velocity}
        _write(file, "fclib_local", {"W": operator.as_sparse(problem.delassus)}, vectors)
        groups = ["fclib_local"]
        if problem.mass is not None and problem.directions is not None:
            matrices = {"M": problem.mass, "H": problem.directions}
            free = contents.free_velocity(problem)
            vectors = {"f": np.zeros(problem.mass.shape[0]), "w": free}
            if problem.bilateral is not None and problem.bilateral_velocity is not None:
                matrices["G"] = problem.bilateral
                vectors["b"] = problem.bilateral_velocity
            _write(file, "fclib_global", matrices, vectors)
            groups.append("fclib_global")
        p = dimension(problem.laws[0])
        if mu is not None and p <= 2:
            for group in groups:
                _put(file, f"{group}/vectors/mu", mu)
                _put(file, f"{group}/spacedim", np.array([p + 1], np.int32))
        else:
            for name, values in contents.details(problem).items():
                _put(file, f"data/{name}", values)
        form = contents.form(problem)
        if form != contents.SPARSE:
            _put(file, _LOCAL["form"], np.array(form))
    with atomic(path) as target:
        target.write(memory.getbuffer())


def load(path: Path) -> ContactProblem:
    """Read a problem; without a Delassus operator it is made of the bodies."""
    with _opened(path) as source:
        return _load(source)


def percussions(path: Path) -> Percussions:
    """Return the percussions that stand beside the problem."""
    with _opened(path) as source:
        solution = "solution/r"
        guesses = [f"guesses/{name}/r" for name in sorted(source.members("guesses"), key=_order)]
        return Percussions(
            contents.numbers(source, solution) if solution in source else None,
            tuple(contents.numbers(source, key) for key in guesses if key in source),
        )


def _order(name: str) -> tuple[int, str]:
    """Guesses are numbered from 1."""
    return int(name) if name.isdecimal() else 0, name


@contextmanager
def _opened(path: Path) -> Iterator[_Group]:
    h5py = _h5py()
    if path.is_dir():
        raise ParameterError("path", f"must be an HDF5 file: {path} is a folder")
    with path.open("rb") as opened:
        try:
            file = h5py.File(opened, "r")
        except Exception as error:
            raise ParameterError("path", f"must be an HDF5 file: {path}: {error}") from None
        with file:
            yield _Group(file, path)


def _load(source: _Group) -> ContactProblem:
    for name in _ROLLING:
        if name in source:
            raise ParameterError(
                name,
                f"must be absent, {source.path} holds a problem with rolling friction: none of "
                "the laws has moments of rolling, five rows per contact",
            )
    for name in _JOINTS:
        if name in source:
            raise ParameterError(
                name, "must be absent: joints are read with the bodies, in fclib_global/G"
            )
    bodies, delassus, free, form = None, None, None, contents.SPARSE
    group, keys = "fclib_global", _GLOBAL
    if "fclib_global" in source:
        mass, gap = _mass(source), contents.numbers(source, _GLOBAL["free_velocity"])
        bodies = contents.Bodies(mass, _read(source, "fclib_global/H", (mass.shape[0], gap.size)))
        if "fclib_global/G" in source:
            bodies = _held(source, bodies)
    if "fclib_local" in source or bodies is None:
        group, keys = "fclib_local", _LOCAL
        free = contents.numbers(source, _LOCAL["free_velocity"])
        delassus = _read(source, "fclib_local/W", (free.size, free.size))
        if _LOCAL["form"] in source:
            form = contents.text(source, _LOCAL["form"])
    if "data/laws" in source:
        options = contents.read_details(source, "data/")
    else:
        dimension = _integer(source, f"{group}/spacedim") - 1
        if dimension not in (1, 2):
            raise ParameterError(f"{group}/spacedim", f"must be 2 or 3, got {dimension + 1}")
        rows = gap.size if free is None else free.size
        options = contents.read_coefficients(source, f"{group}/vectors/mu", rows, dimension)
    if free is not None and (bodies is None or bodies.bilateral is None):
        return contents.built(delassus, bodies, free, options, keys, form)
    assert bodies is not None
    own = _free_velocity(source, bodies)
    problem = contents.built(None, bodies, own, options, _GLOBAL, form)
    if delassus is not None and free is not None:
        contents.check_eliminated(problem, delassus, free, _LOCAL)
    return problem


def _held(source: _Group, bodies: contents.Bodies) -> contents.Bodies:
    """Return bodies with 0 = Gᵀv + b, v without percussions M⁻¹f."""
    gap = contents.numbers(source, "fclib_global/vectors/b")
    rows = _read(source, "fclib_global/G", (bodies.mass.shape[0], gap.size))
    velocity = rows.T @ _unmoved(source, bodies) + gap
    return contents.Bodies(bodies.mass, bodies.directions, rows, velocity)


def _mass(source: _Group) -> csr_array:
    """Return M; one triangle stands for both, as engines store symmetric matrices.

    A mass matrix is symmetric: a triangle with entries beside the diagonal cannot be all of it.
    """
    mass = _read(source, "fclib_global/M", (None, None))
    if mass.shape[0] != mass.shape[1]:
        return mass
    rows, columns = mass.tocoo().coords
    kept = mass.data != 0.0
    above, below = (kept & (rows < columns)).any(), (kept & (rows > columns)).any()
    if above == below:
        return mass
    from scipy.sparse import diags_array

    both = mass + mass.T - diags_array(mass.diagonal())
    return compressed.sparse(both, "fclib_global/M", mass.shape)


def _free_velocity(source: _Group, bodies: contents.Bodies) -> NDArray[np.float64]:
    """Return b = Wᵀ M⁻¹ f + w."""
    gap = contents.numbers(source, "fclib_global/vectors/w")
    return bodies.directions.T @ _unmoved(source, bodies) + gap


def _unmoved(source: _Group, bodies: contents.Bodies) -> NDArray[np.float64]:
    """Return M⁻¹ f."""
    force = contents.numbers(source, "fclib_global/vectors/f")
    if force.size != bodies.directions.shape[0]:
        raise ParameterError(
            "fclib_global/vectors/f",
            f"must have {bodies.directions.shape[0]} entries, has {force.size}",
        )
    try:
        mass = operator.checked_mass(bodies.mass)
    except ParameterError as error:
        raise type(error)("fclib_global/M", error.message) from None
    velocity: NDArray[np.float64] = operator.inverse(mass.tocsr()) @ force
    return velocity


def _write(
    file: Any, group: str, matrices: dict[str, csr_array], vectors: dict[str, NDArray[Any]]
) -> None:
    for name, matrix in matrices.items():
        place = f"{group}/{name}"
        parts = {"nzmax": matrix.nnz, "m": matrix.shape[0], "n": matrix.shape[1], "nz": _ROWS}
        for part, value in parts.items():
            _put(file, f"{place}/{part}", np.array([value], np.int32))
        _put(file, f"{place}/p", matrix.indptr.astype(np.int32))
        _put(file, f"{place}/i", matrix.indices.astype(np.int32))
        _put(file, f"{place}/x", matrix.data)
    for name, values in vectors.items():
        _put(file, f"{group}/vectors/{name}", values)


def _put(file: Any, key: str, values: NDArray[Any]) -> None:
    """Write an array with its checksum; a text as its bytes, since strings have none."""
    if values.dtype.kind == "U":
        values = np.frombuffer(str(values).encode(), dtype=np.uint8)
    # Nothing has no chunks.
    chunks = tuple(min(length, _CHUNK) for length in values.shape) if values.size else None
    file.create_dataset(key, data=values, chunks=chunks, fletcher32=bool(chunks))


def _read(source: _Group, name: str, expected: contents.Shape) -> csr_array:
    shape = _integer(source, f"{name}/m"), _integer(source, f"{name}/n")
    form = _integer(source, f"{name}/nz")
    first = contents.integers(source, f"{name}/p")
    second = contents.integers(source, f"{name}/i")
    values = contents.numbers(source, f"{name}/x")
    if form == _ROWS:
        return contents.matrix((values, second, first), shape, "csr", name, expected)
    if form == _COLUMNS:
        return contents.matrix((values, second, first), shape, "csc", name, expected)
    if form < _ROWS:
        raise ParameterError(f"{name}/nz", f"must be -2, -1 or a number of entries, got {form}")
    # As in CSparse, `i` holds rows and `p`, which holds starts in the compressed forms, columns.
    triplets = values[:form], second[:form], first[:form]
    return contents.matrix(triplets, shape, "coo", name, expected)


def _integer(source: _Group, key: str) -> int:
    found = source[key]
    if found.size != 1 or found.dtype.kind not in "iu":
        raise ParameterError(key, f"must be an integer, is {found.dtype} {found.shape}")
    return int(found.reshape(-1)[0])
