"""Contact problems in ``.npz`` files of NumPy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.storage.archive import Archive
from asperity._base.storage.files import atomic
from asperity.contact import operator
from asperity.contact.arguments import dimension
from asperity.contact.files import contents
from asperity.contact.files.contents import Percussions
from asperity.contact.problem import ContactProblem
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_KEYS = {
    "delassus": "W",
    "free_velocity": "q",
    "mass": "M",
    "directions": "H",
    "form": "W_form",
    "bilateral": "E",
    "bilateral_velocity": "s",
}


def save(problem: ContactProblem, path: Path) -> None:
    """Write a problem."""
    arrays: dict[str, Any] = {
        **_written(operator.as_sparse(problem.delassus), "W"),
        "q": problem.free_velocity,
    }
    form = contents.form(problem)
    if form != contents.SPARSE:
        arrays["W_form"] = np.array(form)
    mu = contents.coefficients(problem)
    if mu is not None and dimension(problem.laws[0]) == 2:
        arrays["mu"] = mu
    else:
        arrays.update(contents.details(problem))
    if problem.mass is not None and problem.directions is not None:
        arrays.update(_written(problem.mass, "M"))
        arrays.update(_written(problem.directions, "H"))
        arrays["f"], arrays["b"] = np.zeros(problem.mass.shape[0]), contents.free_velocity(problem)
    if problem.bilateral is not None:
        arrays.update({**_written(problem.bilateral, "E"), "s": problem.bilateral_velocity})
    with atomic(path) as file:
        np.savez_compressed(file, **arrays)


def load(path: Path) -> ContactProblem:
    """Read a problem."""
    with Archive(path) as source:
        free = contents.numbers(source, "q")
        delassus = _read(source, "W", (free.size, free.size))
        if "mu" in source or "laws" not in source:
            options = contents.read_coefficients(source, "mu", free.size, 2)
        else:
            options = contents.read_details(source)
        bodies = None
        if "E_data" in source and "M_data" not in source:
            raise ParameterError("E", "must come with the bodies that it holds, M, H and b")
        if "M_data" in source:
            mass = _read(source, "M", (None, None))
            bodies = contents.Bodies(mass, _read(source, "H", (mass.shape[0], free.size)))
        if bodies is not None and "E_data" in source:
            held = contents.numbers(source, "s")
            rows = _read(source, "E", (bodies.mass.shape[0], held.size))
            bodies = contents.Bodies(bodies.mass, bodies.directions, rows, held)
            own = contents.numbers(source, "b")
            problem = contents.built(None, bodies, own, options, {**_KEYS, "free_velocity": "b"})
            contents.check_eliminated(problem, delassus, free, _KEYS)
            return problem
        form = contents.text(source, "W_form") if "W_form" in source else contents.SPARSE
        return contents.built(delassus, bodies, free, options, _KEYS, form)


def percussions(path: Path) -> Percussions:
    """Return none: this format holds the problem alone."""
    with Archive(path):
        return Percussions()


def _written(matrix: csr_array, name: str) -> dict[str, NDArray[Any]]:
    large = max(*matrix.shape, matrix.nnz) > np.iinfo(np.int32).max
    index = np.int64 if large else np.int32
    return {
        f"{name}_data": matrix.data,
        f"{name}_indices": matrix.indices.astype(index),
        f"{name}_indptr": matrix.indptr.astype(index),
        f"{name}_shape": np.array(matrix.shape, dtype=np.int64),
    }


def _read(source: Archive, name: str, expected: contents.Shape) -> csr_array:
    shape = contents.integers(source, f"{name}_shape")
    if shape.size != 2:
        raise ParameterError(f"{name}_shape", f"must hold two numbers, has {shape.size}")
    parts = (
        contents.numbers(source, f"{name}_data"),
        contents.integers(source, f"{name}_indices"),
        contents.integers(source, f"{name}_indptr"),
    )
    return contents.matrix(parts, (int(shape[0]), int(shape[1])), "csr", name, expected)
