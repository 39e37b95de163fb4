"""The linear system with constant matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity._base.value import Value
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.system import labels
from asperity.system.contacts import Contact, relawed
from asperity.system.labels import Labels
from asperity.system.reactions import constraint_forces

if TYPE_CHECKING:
    from scipy.sparse import sparray, spmatrix

    from asperity.runs.run import Run
    from asperity.system.sparse.mesh_contacts import MeshContacts

    AnySparse: TypeAlias = sparray | spmatrix


class LinearSystem(Value):
    """M q̈ + B q̇ + K q = f + W_N λ_N + W λ with constant matrices and contact directions.

    A matrix may be given as a scalar (times the identity), as its diagonal, in full, or as a sparse
    array of SciPy: then the system is a `SparseLinearSystem`, with contacts of a mesh if there are.

    In time stepping K q + B q̇ acts explicitly, so that `simulate` needs Δt² k + 2 Δt b ≤ 4 for the
    largest such sum of a direction with unit mass that contacts do not hold: Δt ≤ 2/ω undamped.

    Args:
        mass: M, symmetric positive definite, shape ``(n, n)``.
        stiffness: K, shape ``(n, n)``; need not be symmetric. Default 0.
        damping: B, shape ``(n, n)``. Default 0.
        force: constant f, shape ``(n,)``. Default 0.
        contacts: the contacts.
        constraint_rows: J, shape ``(m, n)``, of bilateral constraints J q + c = 0, which may repeat
            each other and hold at every sample of `simulate`; `constraint_forces` has what they
            transmit. Other methods refuse them, and so do sparse matrices. Default none.
        constraint: c, what is to be 0 as it is at q = 0, in m or rad, shape ``(m,)``. Default 0.
        coordinate_names: one per coordinate; default ``"q0"``, ``"q1"``, ….
        coordinate_units: such as ``["m", "rad"]``; default ``"SI"``, which may be a length or an
            angle.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [WL19] §4.1.

    >>> from asperity import Contact, FrictionLaw, LinearSystem, simulate
    >>> friction = Contact(
    ...     FrictionLaw.isotropic(0.5, dimension=1), direction=[1.0], normal_force=2.0
    ... )
    >>> oscillator = LinearSystem(1.0, stiffness=4.0, contacts=[friction])
    >>> float(simulate(oscillator, dt=0.01, t_end=20.0, q0=[2.0]).u[-1, 0])
    0.0
    """

    mass: Array
    stiffness: Array
    damping: Array
    force: Array
    contacts: tuple[Contact, ...]
    constraint_rows: Array | None
    constraint: Array | None
    coordinate_names: tuple[str, ...] | None
    coordinate_units: tuple[str, ...] | None
    labels: Labels
    """Names and units of coordinates and contacts."""
    _core: _core.LinearSystem

    def __new__(
        cls,
        mass: ArrayLike | AnySparse,
        *,
        stiffness: ArrayLike | AnySparse | None = None,
        damping: ArrayLike | AnySparse | None = None,
        force: ArrayLike | None = None,
        contacts: Sequence[Contact | MeshContacts] | Contact | MeshContacts = (),
        constraint_rows: ArrayLike | None = None,
        constraint: ArrayLike | None = None,
        coordinate_names: Sequence[str] | None = None,
        coordinate_units: Sequence[str] | None = None,
    ) -> LinearSystem:
        """Make the class that holds dense or sparse matrices."""
        is_sparse = any(hasattr(one, "tocsc") for one in (mass, stiffness, damping))
        if cls is LinearSystem and is_sparse:
            from asperity.system.sparse.linear import SparseLinearSystem

            return super().__new__(SparseLinearSystem)
        return super().__new__(cls)

    def __init__(
        self,
        mass: ArrayLike | AnySparse,
        *,
        stiffness: ArrayLike | AnySparse | None = None,
        damping: ArrayLike | AnySparse | None = None,
        force: ArrayLike | None = None,
        contacts: Sequence[Contact | MeshContacts] | Contact | MeshContacts = (),
        constraint_rows: ArrayLike | None = None,
        constraint: ArrayLike | None = None,
        coordinate_names: Sequence[str] | None = None,
        coordinate_units: Sequence[str] | None = None,
    ) -> None:
        listed = _contacts(contacts)
        n = _dof(mass, listed)
        rows = _constraint_rows(constraint_rows, constraint, n)
        if arrays.array(cast(ArrayLike, mass), "mass").ndim == 0 and not listed:
            _refuse_more_than_one(stiffness=stiffness, damping=damping, force=force)
        self._set(
            mass=_matrix(mass, "mass", n),
            stiffness=_matrix(stiffness, "stiffness", n),
            damping=_matrix(damping, "damping", n),
            force=arrays.constant(np.zeros(n) if force is None else force, "force", (n,)),
            contacts=listed,
            constraint_rows=rows,
            constraint=None if rows is None else _constraint(constraint, len(rows)),
            coordinate_names=texts_of_coordinates(coordinate_names, "coordinate_names", n),
            coordinate_units=texts_of_coordinates(coordinate_units, "coordinate_units", n),
        )
        for contact in listed:
            arrays.array(contact.direction, "direction", (n, contact.law.dimension))
        core = _core.LinearSystem(
            self.mass,
            self.stiffness,
            self.damping,
            self.force,
            [contact._core_data() for contact in listed],
            self._constraints,
        )
        names = labels.contact_names([contact.name for contact in listed])
        self._keep(
            _core=core,
            labels=labels.of_coordinates(
                n, n, names, self.coordinate_names, self.coordinate_units, are_rates=True
            ),
        )

    def with_law(
        self, law: FrictionLaw, *, contacts: int | str | Sequence[int | str] | None = None
    ) -> LinearSystem:
        """Return the same system with another friction law at contacts.

        Args:
            law: of the dimension of the contacts' laws.
            contacts: numbers or names of the contacts; default all.

        >>> from asperity import FrictionLaw, mechanisms
        >>> weak = FrictionLaw.isotropic(0.1, dimension=1)
        >>> mechanisms.mode_coupling(0.5).with_law(weak).contacts[0].law == weak
        True
        """
        return self.replace(contacts=relawed(self.contacts, law, contacts, "contacts"))

    def varied(self, *, friction: float = 1.0, phi: float = 0.0, speed: float = 1.0) -> Self:
        """Return the same system with more friction, or a surface that moves otherwise.

        These are the parameters of `reduce` and `squeal_map`, relative to the system as it is.

        Args:
            friction: factor above 0 of all reservoirs C, and so of all forces of friction; of an
                isotropic law with μ = 1 it is the coefficient of friction.
            phi: angle in rad by which the velocities of the surfaces are turned, from e₁ to e₂ and
                counter-clockwise seen against n; the laws stay where they are.
            speed: factor of these velocities.

        >>> from asperity import mechanisms
        >>> mechanisms.mode_coupling(0.5).varied(friction=0.2).contacts[0].law.reservoir
        Interval(-0.1, 0.1)
        """
        given = (
            arrays.positive(friction, "friction"),
            arrays.number(phi, "phi"),
            arrays.positive(speed, "speed"),
        )
        return self.replace(contacts=[one._turned(*given) for one in self.contacts])

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed.

        Without new `constraint_rows`, ``None``, there is no `constraint` either.
        """
        if "constraint_rows" in changes and "constraint" not in changes:
            rows = changes["constraint_rows"]
            if rows is not None:
                rows = arrays.array(rows, "constraint_rows", (None, self.dof))
            if rows is None or self.constraint is None or not self.constraint.any():
                changes["constraint"] = None
            elif len(rows) != len(self.constraint):
                raise DimensionError(
                    "constraint_rows",
                    f"must have {counted(len(self.constraint), 'row')}, as constraint has entries, "
                    "unless that is given, too",
                )
        return super().replace(**changes)

    def constraint_forces(self, trajectory: Run) -> Array:
        """Return Λ of the constraints in N or N m, M q̈ + B q̇ + K q = f + W λ + JᵀΛ.

        In the middle of the step that ends at a sample, as `System.constraint_forces`. In runs with
        ``implicit`` they are the percussions of that step over Δt, of second order for ½.

        Args:
            trajectory: of this system.

        Returns:
            Shape ``(n_t, m)``, NaN for the initial state.

        Raises:
            DimensionError, ParameterError: naming the argument; also where ``implicit`` below 1
                maps several beginnings of a step to one end.

        >>> from asperity import LinearSystem, simulate
        >>> held = LinearSystem([2.0, 1.0], force=[3.0, 0.0], constraint_rows=[[1.0, 0.0]])
        >>> held.constraint_forces(simulate(held, dt=0.1, t_end=1.0))[-1].round(9).tolist()
        [-3.0]
        """
        return constraint_forces(self, trajectory)

    @property
    def dof(self) -> int:
        """Number n of coordinates."""
        return len(self.force)

    @property
    def constraints(self) -> int:
        """Number m of bilateral constraints."""
        rows = self._parameters.get("constraint_rows")
        return 0 if rows is None else len(rows)

    @property
    def _constraints(self) -> tuple[Array, Array] | None:
        if self.constraint_rows is None or self.constraint is None:
            return None
        return self.constraint_rows, self.constraint


def _contacts(contacts: Any) -> tuple[Contact, ...]:
    listed = tuple(contacts) if isinstance(contacts, Sequence) else (contacts,)
    for contact in listed:
        arrays.of_kind(contact, "contacts", Contact, "a sequence of Contact")
    return listed


def _constraint_rows(given: Any, constraint: Any, n: int) -> Array | None:
    if given is not None:
        return arrays.constant(given, "constraint_rows", (None, n))
    if constraint is not None:
        raise ParameterError("constraint_rows", "must be given with constraint")
    return None


def _constraint(given: Any, count: int) -> Array:
    return arrays.constant(np.zeros(count) if given is None else given, "constraint", (count,))


def texts_of_coordinates(
    given: Sequence[str] | None, argument: str, n: int
) -> tuple[str, ...] | None:
    """Return names or units, one per coordinate."""
    if given is None:
        return None
    listed = labels.texts(given, argument)
    if len(listed) != n:
        raise DimensionError(argument, f"must hold {n} texts, one per coordinate, got {listed!r}")
    if argument == "coordinate_names":
        labels.unique(listed, argument)
    return listed


def _dof(mass: Any, contacts: Sequence[Contact]) -> int:
    converted = arrays.array(mass, "mass")
    if converted.ndim:
        if converted.size == 0:
            raise DimensionError("mass", "must not be empty")
        return len(converted)
    return len(contacts[0].direction) if contacts else 1


def _refuse_more_than_one(**given: Any) -> None:
    """Refuse what is of several coordinates where a scalar mass is that of one."""
    for name, value in given.items():
        try:
            shape = np.shape(value)
        except ValueError:
            # Objects that are not arrays are refused as such.
            continue
        if shape and max(shape) > 1:
            raise DimensionError(
                name,
                f"has shape {shape}, but a scalar mass is that of one coordinate: give one for "
                f"each, such as mass={[1.0] * shape[0]}",
            )


def _matrix(value: Any, argument: str, n: int) -> Array:
    return arrays.square(0.0 if value is None else value, argument, n)
