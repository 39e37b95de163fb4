"""What files of both formats hold, apart from how they hold it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact import compressed, operator
from asperity.contact.files import laws as law_files
from asperity.contact.problem import ContactProblem
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.sets import Ball, Disk, Interval

if TYPE_CHECKING:
    from scipy.sparse import csr_array

SPARSE, DENSE, ASSEMBLED = "sparse", "dense", "assembled"
"""How a problem keeps G: as a sparse or a dense matrix, or made of the bodies where it is needed.

Files hold it sparse always; a problem that is read keeps it as the one that was written did."""
Shape = tuple[int | None, int | None]
"""Rows and columns that a matrix must have, ``None`` where any number is allowed."""
FRICTIONLESS = 1e-12
"""Radius of the reservoir that stands for μ = 0: sets have the origin inside."""

NO_LAW = -1
"""Number of the law of a contact without friction."""


class Source(Protocol):
    """An open file."""

    def __contains__(self, key: str) -> bool:
        """Whether there is something under the key."""

    def __getitem__(self, key: str) -> NDArray[Any]:
        """Return what is under the key; its absence is an error that names it."""


@dataclass(frozen=True)
class Bodies:
    """Mass and directions, and rows that hold the bodies with their velocities."""

    mass: csr_array
    directions: csr_array
    bilateral: csr_array | None = None
    bilateral_velocity: Array | None = None


@dataclass(frozen=True)
class Percussions:
    """Percussions that a file holds beside its problem, in N s; nobody has checked them.

    Attributes:
        solution: those that the writer took for a solution, or ``None``.
        guesses: those to start from.
    """

    solution: Array | None = None
    guesses: tuple[Array, ...] = ()


def coefficients(problem: ContactProblem) -> Array | None:
    """Return μ of each contact of a plain problem with one p, ``None`` of any other problem."""
    restitution = problem.normal_restitution, problem.tangential_restitution
    if any(values.any() for values in (*restitution, problem.initial_velocity)):
        return None
    if any(force is not None for force in problem.normal_force):
        return None
    laws = [law for law in problem.laws if law is not None]
    if len(laws) < len(problem.laws) or len({law.dimension for law in laws}) > 1:
        return None
    # Thousands of contacts share few laws.
    different = {id(law): law for law in laws}
    known = {number: coefficient(law) for number, law in different.items()}
    mu = [known[id(law)] for law in laws]
    return None if None in mu else np.array(mu, dtype=np.float64)


def coefficient(law: FrictionLaw) -> float | None:
    """Return μ of an isotropic law, ``None`` of any other."""
    reservoir = law.reservoir
    if isinstance(reservoir, Interval):
        mu = reservoir.upper if reservoir.lower == -reservoir.upper else None
    else:
        mu = reservoir._parameters["radius"] if isinstance(reservoir, Ball | Disk) else None
    # Only now: other reservoirs may not be convex, so that no law is associated with them.
    if mu is None or law != FrictionLaw.associated(reservoir):
        return None
    return 0.0 if mu == FRICTIONLESS else mu


def isotropic(mu: Array, dimension: int) -> list[FrictionLaw]:
    """Return a law per contact, one object for each coefficient."""
    made = {
        value: FrictionLaw.isotropic(value if value > 0.0 else FRICTIONLESS, dimension=dimension)
        for value in set(mu.tolist())
    }
    return [made[value] for value in mu.tolist()]


def form(problem: ContactProblem) -> str:
    """Return how the problem keeps its Delassus operator."""
    kept = problem._parameters["delassus"]
    if kept is None:
        return ASSEMBLED
    return DENSE if isinstance(kept, np.ndarray) else SPARSE


def details(problem: ContactProblem) -> dict[str, NDArray[Any]]:
    """Return what a problem that is not plain needs besides W and q."""
    # Hashing a law takes long: contacts that share the object share the number.
    objects = {id(law): law for law in problem.laws if law is not None}
    different = list(dict.fromkeys(objects.values()))
    number = {law: i for i, law in enumerate(different)}
    place = {id(None): NO_LAW, **{key: number[law] for key, law in objects.items()}}
    force = [np.nan if force is None else force for force in problem.normal_force]
    return {
        "laws": np.array(law_files.written(different)),
        "law": np.array([place[id(law)] for law in problem.laws], dtype=np.int64),
        "normal_force": np.array(force, dtype=np.float64),
        "normal_restitution": problem.normal_restitution,
        "tangential_restitution": problem.tangential_restitution,
        "initial_velocity": problem.initial_velocity,
    }


def read_details(source: Source, prefix: str = "") -> dict[str, Any]:
    """Return the arguments that `details` has written."""
    listed = law_files.read(text(source, f"{prefix}laws"), f"{prefix}laws")
    number = integers(source, f"{prefix}law")
    if number.size and not NO_LAW <= number.min() <= number.max() < len(listed):
        raise ParameterError(f"{prefix}law", f"must lie in {NO_LAW}..{len(listed) - 1}")
    key = f"{prefix}normal_force"
    force = source[key]
    if force.dtype.kind != "f" or force.shape != number.shape:
        raise DimensionError(key, f"must hold {number.size} numbers, one per contact")
    return {
        "laws": [None if i == NO_LAW else listed[i] for i in number.tolist()],
        "normal_force": [None if np.isnan(one) else one for one in force.tolist()],
        **{
            name: numbers(source, f"{prefix}{name}")
            for name in ("normal_restitution", "tangential_restitution", "initial_velocity")
        },
    }


def read_coefficients(source: Source, key: str, rows: int, dimension: int) -> dict[str, Any]:
    """Return the laws of a plain problem."""
    each = dimension + 1
    mu = numbers(source, key)
    if mu.size * each != rows:
        raise DimensionError(
            key, f"must have {rows / each:g} entries, {each} rows each, has {mu.size}"
        )
    if mu.min(initial=0.0) < 0.0:
        raise ParameterError(key, f"must not be negative, got {mu.min()}")
    return {"laws": isotropic(mu, dimension)}


def numbers(source: Source, key: str) -> Array:
    """Return a vector of finite numbers."""
    return arrays.array(source[key], key, (None,))


def text(source: Source, key: str) -> str:
    """Return a text, which stands there as such or as its bytes."""
    found = source[key]
    if found.dtype == np.uint8 and found.ndim == 1:
        try:
            return found.tobytes().decode()
        except UnicodeDecodeError as error:
            raise ParameterError(key, f"must be a text: {error}") from None
    if found.dtype.kind != "U" or found.ndim:
        raise ParameterError(key, f"must be a text, is {found.dtype} {found.shape}")
    return str(found)


def integers(source: Source, key: str) -> NDArray[np.int64]:
    """Return a vector of integers."""
    found = source[key]
    if found.dtype.kind not in "iu" or found.ndim != 1:
        raise ParameterError(key, f"must be a vector of integers, is {found.dtype} {found.shape}")
    return found.astype(np.int64)


def matrix(
    parts: tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]],
    shape: tuple[int, int],
    form: str,
    name: str,
    expected: Shape,
) -> csr_array:
    """Return the sparse matrix of entries, indices and starts, or of entries, rows and columns.

    The shape is compared with what is expected, or with the entries, and the parts with the shape
    before anything is made of them: SciPy allocates what a shape asks for and writes where indices
    point.
    """
    from scipy import sparse

    entries, second, first = parts
    if any(wanted not in (None, size) for wanted, size in zip(expected, shape, strict=True)):
        rows, columns = ("n" if size is None else size for size in expected)
        raise DimensionError(name, f"must have shape ({rows}, {columns}), got {shape}")
    # The only such matrix is M, of which no row is empty: its diagonal is positive.
    largest = [entries.size if size is None else size for size in expected]
    if not all(0 <= size <= most for size, most in zip(shape, largest, strict=True)):
        raise DimensionError(
            name, f"must have at most {entries.size} rows, as many as entries, got {shape}"
        )
    given: Any
    if form == "coo":
        compressed.check_triplets((second, first), entries.size, shape, name)
        given = entries, (second, first)
    else:
        lengths = shape if form == "csr" else shape[::-1]
        compressed.check_compressed(first, second, entries.size, lengths, name)
        given = parts
    return compressed.sparse(getattr(sparse, f"{form}_array")(given, shape=shape), name, shape)


def built(
    delassus: csr_array | None,
    bodies: Bodies | None,
    free_velocity: Array,
    options: Mapping[str, Any],
    keys: Mapping[str, str],
    form: str = SPARSE,
) -> ContactProblem:
    """Make the problem; complaints about its arguments name the keys they came from."""
    if form not in (SPARSE, DENSE, ASSEMBLED):
        raise ParameterError(keys["form"], f"must be one of the forms of G, got {form!r}")
    known: dict[str, Any] = {} if bodies is None else vars(bodies)
    given = delassus.toarray() if form == DENSE and delassus is not None else delassus
    try:
        if bodies is not None and bodies.bilateral is not None:
            return ContactProblem(None, free_velocity=free_velocity, **options, **known)
        problem = ContactProblem(given, free_velocity=free_velocity, **options, **known)
        # The operator of the file has been compared with the bodies' own, which takes its place.
        return problem.replace(**known) if form == ASSEMBLED else problem
    except ParameterError as error:
        raise type(error)(keys.get(error.argument, error.argument), error.message) from None


def free_velocity(problem: ContactProblem) -> Array:
    """Return b of the bodies before what holds them."""
    given: Array = problem._parameters["free_velocity"]
    return given


def check_eliminated(
    problem: ContactProblem, delassus: csr_array, free: Array, keys: Mapping[str, str]
) -> None:
    """Refuse G and b of a file that are not those which its bilateral rows leave."""
    pairs: list[tuple[str, Any, Any]] = [
        ("delassus", delassus, problem.delassus),
        ("free_velocity", free, problem.free_velocity),
    ]
    for name, stated, own in pairs:
        if not abs(stated - own).max() <= operator.CONSISTENT * abs(own).max():
            raise ParameterError(keys[name], "must be what bilateral rows leave of the bodies'")
