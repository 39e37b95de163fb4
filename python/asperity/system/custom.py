"""Systems written in Python."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from asperity import _arrays, _core
from asperity._arrays import Array
from asperity.errors import ParameterError
from asperity.system.contacts import ContactLaw


class System:
    """Base of systems with configuration-dependent mass, forces or contacts.

    M(q) u̇ − h(t, q, u) = Σ W_N λ_N + W λ. A subclass sets ``dof`` and ``contacts`` (as class
    attributes, properties or in ``__init__``) and defines `mass` and `forces`; with contacts also
    `direction`, with unilateral ones `normal` and `gap`. All are evaluated at the midpoint of a
    time step and must depend on their arguments alone. Parameter names are checked when the class
    is defined. A class that is itself only a base says ``class Base(System, abstract=True)``.

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

    def __init_subclass__(cls, *, abstract: bool = False, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        for name, attribute in vars(cls).items():
            if name in _INTERFACE:
                _check_signature(cls, name, attribute)
            elif inspect.isfunction(attribute) and not name.startswith("_"):
                _check_spelling(cls, name)
        if not abstract:
            for name in ("mass", "forces"):
                _require(cls, name)

    def mass(self, q: Array) -> Array:
        """Return M(q), symmetric positive definite, shape ``(n, n)``."""
        raise NotImplementedError

    def forces(self, t: float, q: Array, u: Array) -> Array:
        """Return h(t, q, u), all forces but those of the contacts, shape ``(n,)``."""
        raise NotImplementedError

    def direction(self, t: float, q: Array, contact: int) -> Array:
        """Return W of a contact, shape ``(n, p)``."""
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

    @property
    def _core(self) -> _core.CallbackSystem:
        dof = _arrays.count(getattr(self, "dof", None), "dof")
        listed = tuple(self.contacts)
        for contact in listed:
            if not isinstance(contact, ContactLaw):
                raise ParameterError("contacts", f"must hold ContactLaw objects, got {contact!r}")
        needed = ["direction"] if listed else []
        if any(contact.unilateral for contact in listed):
            needed += ["normal", "gap"]
        for name in needed:
            _require(type(self), name)
        return _core.CallbackSystem(self, dof, [contact._core_data() for contact in listed])


_INTERFACE: dict[str, Callable[..., Any]] = {
    name: getattr(System, name)
    for name in ("mass", "forces", "direction", "velocity", "normal", "gap")
}


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
