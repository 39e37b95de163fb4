"""Systems written in Python."""

from __future__ import annotations

import copy
import difflib
import inspect
import operator
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.system import labels
from asperity.system.contacts import ContactLaw, relawed
from asperity.system.labels import Labels
from asperity.system.reactions import constraint_forces

if TYPE_CHECKING:
    from asperity.runs.run import Run


class System:
    """Base of systems with configuration-dependent mass, forces or contacts.

    M(q) u̇ − h(t, q, u) = Σ W_N λ_N + W λ. A subclass sets ``dof`` and ``contacts`` (as class
    attributes, properties or in ``__init__``) and defines `mass` and `forces`; with contacts also
    `direction`, with unilateral ones `normal` and `gap`. All are evaluated at the midpoint of a
    time step and must depend on their arguments alone. Parameter names are checked when the class
    is defined. A class that is itself only a base says ``class Base(System, abstract=True)``.
    `integrate` asks `gap` between the stages of its steps, too, until it is resolved as a piecewise
    polynomial: it should be smooth, and exact to rounding.

    What never changes is computed once if the class says so: ``constant_mass = True`` for M,
    ``constant_contacts = True`` for W, w_N and χ of all contacts (not for gaps).

    A system of many parts sets ``blocks``, the numbers of velocities of the parts, which M does not
    couple. It defines `block_mass` in place of `mass`, and `touched`, the parts whose velocities a
    contact sees; `direction` and `normal` have the velocities of these parts only, one part after
    the other. A step then costs in proportion to the number of parts and contacts.

    Bodies that turn in space are announced by ``rotations``, the number of the first of the three
    velocities of each: those are the angular velocity Ω in the body's axes. Among the coordinates
    the unit quaternion (w, x, y, z) that turns the body's axes to the world's stands in their
    place, so that there is one coordinate more for each; it turns by R exp(Δt Ω). A body with the
    velocities (v, Ω) has ``dof = 6``, ``rotations = (3,)`` and the coordinates (x, quaternion);
    its forces hold the gyroscopic torque J Ω × Ω.

    Where velocities are not the rates of the coordinates in another way, `advance` moves the
    coordinates, and ``coordinates`` is their number if it is not ``dof``. Such systems are for
    `simulate` and `stability`; `integrate` refuses them.

    Where velocities are held, as by a rod or a rail, ``constraints`` is the number m of bilateral
    constraints g(q) = 0, with `constraint`, g, and `constraint_rows`, the rows J of its rates J u.
    They hold at every sample of `simulate`, and may repeat each other; `constraint_forces` has what
    they transmit. Other methods refuse them. A system with constraints has no ``blocks``.

    ``coordinate_names`` and ``coordinate_units``, one text per coordinate, are what tables and
    messages call them; contacts have the ``name`` of their `ContactLaw`.

    Reference: [WL19] (16), §2.2–2.3.

    >>> import numpy as np
    >>> from asperity import ContactLaw, FrictionLaw, System, simulate
    >>> class Pendulum(System):
    ...     dof = 1
    ...     contacts = (ContactLaw(FrictionLaw.isotropic(0.02, dimension=1), normal_force=1.0),)
    ...
    ...     def mass(self, q):
    ...         return np.eye(1)
    ...
    ...     def forces(self, t, q, u):
    ...         return -np.sin(q)
    ...
    ...     def direction(self, t, q, contact):
    ...         return np.eye(1)
    >>> bool(abs(simulate(Pendulum(), dt=0.01, t_end=200.0, q0=[1.0]).q[-1, 0]) <= 0.02)
    True
    """

    dof: int
    contacts: Sequence[ContactLaw] = ()
    blocks: Sequence[int] | None = None
    rotations: Sequence[int] = ()
    coordinates: int | None = None
    constraints: int = 0
    coordinate_names: Sequence[str] | None = None
    coordinate_units: Sequence[str] | None = None
    constant_mass: bool = False
    constant_contacts: bool = False

    def __init_subclass__(cls, *, abstract: bool = False, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        for name, attribute in vars(cls).items():
            if name in _INTERFACE:
                _check_signature(cls, name, attribute)
            elif inspect.isfunction(attribute) and not name.startswith("_"):
                _check_spelling(cls, name)
        if not abstract:
            if cls.block_mass is System.block_mass:
                _require(cls, "mass")
            _require(cls, "forces")

    def mass(self, q: Array) -> Array:
        """Return M(q), symmetric positive definite, shape ``(n, n)``."""
        raise NotImplementedError

    def block_mass(self, q: Array, block: int) -> Array:
        """Return the part of M(q) that belongs to a block, shape ``(n_block, n_block)``."""
        raise NotImplementedError

    def touched(self, contact: int) -> Sequence[int]:
        """Return the numbers of the blocks whose velocities a contact sees, ascending."""
        raise NotImplementedError

    def advance(self, q: Array, u: Array, dt: float) -> Array:
        """Return the coordinates after moving with the velocities u for dt, shape of ``q``."""
        return q + dt * u

    def constraint(self, q: Array) -> Array:
        """Return g(q) in m or rad, which constraints keep at 0, shape ``(m,)``."""
        raise NotImplementedError

    def constraint_rows(self, q: Array) -> Array:
        """Return J(q) with the rates J u of g, shape ``(m, n)``.

        Where a run begins it is compared with differences of g, which is evaluated beside that
        state, up to 2e-6 max(1, |q|) away.
        """
        raise NotImplementedError

    def forces(self, t: float, q: Array, u: Array) -> Array:
        """Return h(t, q, u), all forces but those of the contacts, shape ``(n,)``.

        They act explicitly in `simulate`: steps need Δt² k < 4 m and Δt d < 2 m.
        """
        raise NotImplementedError

    def direction(self, t: float, q: Array, contact: int) -> Array:
        """Return W of a contact, shape ``(n, p)``; n counts the velocities that it touches."""
        raise NotImplementedError

    def velocity(self, t: float, q: Array, contact: int) -> Array:
        """Return χ of a contact in m/s, shape ``(p,)``; 0 unless overridden."""
        return np.zeros(self.contacts[contact].law.dimension)

    def normal(self, t: float, q: Array, contact: int) -> Array:
        """Return w_N of a unilateral contact, shape ``(n,)``."""
        raise NotImplementedError

    def gap(self, t: float, q: Array, contact: int) -> float:
        """Return g_N of a unilateral contact in m."""
        raise NotImplementedError

    def with_law(
        self, law: FrictionLaw, *, contacts: int | str | Sequence[int | str] | None = None
    ) -> Self:
        """Return a copy with another friction law at contacts.

        A class that derives anything from its laws, or whose contacts are computed by a property,
        overrides this.

        Args:
            law: of the dimension of the contacts' laws.
            contacts: numbers or names of the contacts; default all.

        Raises:
            ParameterError: naming the argument; ``system`` if its contacts cannot be set.
        """
        changed = relawed(self.contacts, law, contacts, "contacts")
        other = copy.copy(self)
        try:
            object.__setattr__(other, "contacts", changed)
        except AttributeError:
            raise ParameterError(
                "system",
                f"must let its contacts be set: {type(self).__name__} computes them, and needs a "
                "with_law of its own",
            ) from None
        return other

    def constraint_forces(self, trajectory: Run) -> Array:
        """Return Λ of the constraints in N or N m: M u̇ = h + W_N λ_N + W λ + JᵀΛ.

        They are those in the middle of the step that ends at a sample, and follow from its state
        and the forces of its contacts with an error of the order of Δt²; in a step with an impact,
        whose forces are percussions over Δt, it does not vanish with Δt. Rows that repeat others
        transmit nothing here.

        Args:
            trajectory: of this system.

        Returns:
            Shape ``(n_t, m)``, NaN for the initial state.

        Raises:
            DimensionError, ParameterError: naming the argument.

        >>> import numpy as np
        >>> from asperity import System, simulate
        >>> class Hung(System):
        ...     dof, constraints = 2, 1
        ...
        ...     def mass(self, q):
        ...         return 2.0 * np.eye(2)
        ...
        ...     def forces(self, t, q, u):
        ...         return np.array([0.0, -19.62])
        ...
        ...     def constraint(self, q):
        ...         return [np.hypot(*q) - 1.0]
        ...
        ...     def constraint_rows(self, q):
        ...         return [q / np.hypot(*q)]
        >>> motion = simulate(Hung(), dt=0.01, t_end=0.1, q0=[0.0, -1.0])
        >>> Hung().constraint_forces(motion)[-1].round(9).tolist()
        [-19.62]
        """
        return constraint_forces(self, trajectory)

    @property
    def labels(self) -> Labels:
        """Names and units of coordinates and contacts."""
        contacts = labels.contact_names([contact.name for contact in self.contacts])
        n, names, units = len(self._origin()), self.coordinate_names, self.coordinate_units
        for argument, given in (("coordinate_names", names), ("coordinate_units", units)):
            if given is not None and len(given) != n:
                raise DimensionError(argument, f"must hold {n} texts, one per coordinate")
        are_rates = n == self.dof and not self._advances
        return labels.of_coordinates(n, self.dof, contacts, names, units, are_rates=are_rates)

    @property
    def _core(self) -> _core.CallbackSystem:
        cls, listed = type(self), tuple(self.contacts)
        for contact in listed:
            if not isinstance(contact, ContactLaw):
                raise ParameterError("contacts", f"must hold ContactLaw objects, got {contact!r}")
        needed = ["direction"] if listed else []
        if any(contact.unilateral for contact in listed):
            needed += ["normal", "gap"]
        for name in needed:
            _require(cls, name)
        blocks, touched = self._blocks(len(listed))
        rotations = self._rotations(sum(blocks))
        coordinates = self.coordinates
        if coordinates is not None:
            coordinates = arrays.count(coordinates, "coordinates")
            _require(cls, "advance")
        elif self._advances:
            coordinates = sum(blocks)
        constraints = self._constraints()
        constant = (bool(self.constant_mass), bool(self.constant_contacts))
        data = [contact._core_data() for contact in listed]
        return _core.CallbackSystem(
            self, blocks, touched, rotations, coordinates, constraints, constant, data
        )

    def _constraints(self) -> int:
        constraints = arrays.count(self.constraints, "constraints", 0)
        if constraints:
            _require(type(self), "constraint")
            _require(type(self), "constraint_rows")
            if self.blocks is not None:
                raise ParameterError(
                    "blocks", "must be left out where a system has constraints, which couple them"
                )
        return constraints

    @property
    def _advances(self) -> bool:
        """Whether velocities are not the rates of the coordinates."""
        return type(self).advance is not System.advance

    def _blocks(self, contacts: int) -> tuple[list[int], list[list[int]] | None]:
        """Return the sizes of the blocks, and the blocks of every contact if there are any."""
        dof = arrays.count(getattr(self, "dof", None), "dof")
        if self.blocks is None:
            _require(type(self), "mass")
            return [dof], None
        blocks = _counts(self.blocks, "blocks", 1)
        if not blocks:
            raise ParameterError(
                "blocks", "must have a block, or be None for one of all velocities"
            )
        if dof != sum(blocks):
            raise ParameterError("dof", f"must be {sum(blocks)}, the sum of blocks, got {dof}")
        _require(type(self), "block_mass")
        if contacts:
            _require(type(self), "touched")
        return blocks, [self._touched(contact, len(blocks)) for contact in range(contacts)]

    def _rotations(self, dof: int) -> list[int]:
        """Return the first velocities of the rotations."""
        rotations = _counts(self.rotations, "rotations", 0)
        ends = [first + 3 for first in rotations]
        if any(first < end for first, end in zip([*rotations[1:], dof], ends, strict=False)):
            raise ParameterError(
                "rotations",
                f"must be ascending numbers of velocities, each the first of three of the {dof}, "
                f"got {rotations}",
            )
        if rotations and (self._advances or self.coordinates is not None):
            raise ParameterError(
                "rotations", "must be left out where a system has its own advance or coordinates"
            )
        return rotations

    def _origin(self) -> Array:
        """Return the coordinates zero, and no rotation."""
        rotations = self._rotations(self.dof)
        q = np.zeros(self.coordinates or self.dof + len(rotations))
        q[[first + k for k, first in enumerate(rotations)]] = 1.0
        return q

    def _touched(self, contact: int, blocks: int) -> list[int]:
        given = self.touched(contact)
        try:
            touched = [operator.index(block) for block in given]
        except TypeError:
            raise ParameterError(
                "touched", f"must return numbers of blocks, returned {given!r:.60}"
            ) from None
        if touched and sorted(set(touched)) == touched and 0 <= touched[0] <= touched[-1] < blocks:
            return touched
        raise ParameterError(
            "touched",
            f"must return ascending numbers of blocks below {blocks}, "
            f"returned {touched} for contact {contact}",
        )


_INTERFACE: dict[str, Callable[..., Any]] = {
    name: getattr(System, name)
    for name in (
        "mass",
        "block_mass",
        "touched",
        "advance",
        "constraint",
        "constraint_rows",
        "forces",
        "direction",
        "velocity",
        "normal",
        "gap",
    )
}


def _counts(values: Any, argument: str, least: int) -> list[int]:
    try:
        listed = list(values)
    except TypeError:
        raise ParameterError(argument, f"must be a list of integers, got {values!r:.60}") from None
    return [arrays.count(value, argument, least) for value in listed]


def _expected(name: str) -> str:
    return f"{name}({', '.join(inspect.signature(_INTERFACE[name]).parameters)})"


def _check_signature(cls: type[System], name: str, attribute: object) -> None:
    function = (
        attribute.__func__ if isinstance(attribute, staticmethod | classmethod) else attribute
    )
    if not callable(function) or function is not attribute:
        raise TypeError(f"{cls.__name__}.{name} must be a method {_expected(name)}")
    given = list(inspect.signature(function).parameters)
    if given != list(inspect.signature(_INTERFACE[name]).parameters):
        raise TypeError(
            f"{cls.__name__}.{name}({', '.join(given)}) must have the signature {_expected(name)}"
        )


def _check_spelling(cls: type[System], name: str) -> None:
    """Refuse a method that looks like a misspelt one of the interface."""
    for meant in difflib.get_close_matches(name, _INTERFACE, n=1, cutoff=0.75):
        if getattr(cls, meant) is _INTERFACE[meant]:
            raise TypeError(f"{cls.__name__}.{name}: did you mean {_expected(meant)}?")


def _require(cls: type[System], name: str) -> None:
    if getattr(cls, name) is _INTERFACE[name]:
        raise TypeError(f"{cls.__name__} must define the method {_expected(name)}")
