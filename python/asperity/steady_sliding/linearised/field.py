"""What a system is near one state: kinematics, forces and their derivatives at rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.runs.model import Model
from asperity.runs.time_stepping import initial_state
from asperity.system import (
    LinearSystem,
    MassOnBelt,
    RigidBodies,
    SlidingPoint,
    SparseLinearSystem,
    System,
)

# Largest of the steps with which differences are taken, in m, rad, m/s or rad/s, and their number.
STEP = 1e-3
_LEVELS = 4
# Times in s at which a system is compared with itself at 0; their ratios are irrational.
_TIMES = (0.013, 0.37, math.e, 7.0 * math.sqrt(5.0), 100.0 * math.pi)
_SAID = {
    "mass": "mass",
    "forces": "forces",
    "tangent": "directions W",
    "velocity": "velocity χ",
    "normal": "direction w_N",
    "gap": "gap",
}


@dataclass(frozen=True)
class ContactState:
    """One contact at one state; `normal` and `gap` of unilateral contacts only."""

    W: Array
    chi: Array
    normal: Array | None
    gap: float


@dataclass(frozen=True)
class Slopes:
    """Derivatives at u = 0, columns for displacements δ in q ⊕ δ or for velocities."""

    displacement: Array
    velocity: Array
    displacement_error: Array
    """Errors of the entries, estimated; 0 where matrices are known."""
    velocity_error: Array


class Field:
    """A system as functions of displacements from q and of velocities.

    Displacements are velocities times 1 s: q ⊕ δ has as many of them as there are velocities,
    whatever the coordinates.
    """

    def __init__(self, system: Model, q: Array) -> None:
        self.system, self.q = system, q
        self.laws, self.normal_forces = _contacts(system)
        self.n = int(system.dof)

    def at(self, delta: Array | None = None, u: Array | None = None) -> dict[str, Any]:
        """Return mass, forces and kinematics of the contacts at q ⊕ δ."""
        q = self.q if delta is None else self.moved(delta)
        return _core.evaluate(self.system._core, 0.0, q, np.zeros(self.n) if u is None else u)

    def moved(self, delta: Array) -> Array:
        """Return q ⊕ δ."""
        return _core.advance(self.system._core, self.q, np.ascontiguousarray(delta), 1.0)

    def contacts(self) -> list[ContactState]:
        """Return the contacts at q."""
        return [
            ContactState(
                np.ascontiguousarray(found["tangent"].T),
                found["velocity"],
                found.get("normal"),
                float(found.get("gap", 0.0)),
            )
            for found in self.at()["contacts"]
        ]

    def transported(self, force: Array, delta: Array) -> Array:
        """Return a generalised force at q ⊕ δ as the one that works on changes of δ.

        A torque τ in the axes of a body that has turned by δ becomes τ + ½ δ × τ to first order.
        Without it a conservative torque would have a nonsymmetric stiffness.
        """
        if not isinstance(self.system, RigidBodies) or self.system.planar:
            return force
        moved = force.reshape(-1, 2, 3).copy()
        moved[:, 1] += 0.5 * np.cross(delta.reshape(-1, 2, 3)[:, 1], moved[:, 1])
        return moved.ravel()

    def slopes(self, load: Callable[[dict[str, Any], Array], Array], step: float) -> Slopes:
        """Differentiate what `load` makes of the state at q ⊕ δ; its first n entries are h.

        Linear systems are not differentiated: they hold their matrices.
        """
        linear = constant(self.system)
        if linear is not None:
            slope = np.zeros((len(load(self.at(), np.zeros(self.n))), self.n))
            slope[: self.n] = -linear.stiffness
            exact = np.zeros_like(slope), np.zeros_like(linear.damping)
            return Slopes(slope, -linear.damping, *exact)
        displacement, error = _difference(lambda x: load(self.at(x), x), self.n, step)
        velocity, other = _difference(lambda x: self.at(None, x)["forces"], self.n, step)
        return Slopes(displacement, velocity, error, other)


def start(system: Model, q0: ArrayLike | None) -> Array:
    """Return coordinates to start from."""
    if not isinstance(system, Model):
        raise ParameterError("system", f"must be a system such as MassOnBelt, got {system!r}")
    q = initial_state(system, q0, None)[0]
    if isinstance(system, System):
        _check_autonomous(system, q)
    if isinstance(system, RigidBodies) and system.depends_on_time:
        raise ParameterError(
            "system",
            "depends on time, by a load, the length of a spring or a surface: there is no steady "
            "sliding whose stability could be told from one time",
        )
    for held in ("joints", "constraints"):
        if getattr(system, held, ()):
            raise ParameterError("system", f"must have no {held}, which only simulate holds")
    if any(
        getattr(getattr(pair, "plane", None), "friction_factor", None) is not None
        for pair in getattr(system, "pairs", ())
    ):
        raise ParameterError(
            "system", "has friction that depends on the place, which is not linearised"
        )
    return q


def _check_autonomous(system: System, q: Array) -> None:
    """Compare forces and contacts at some times, at rest and in motion beside q."""
    aside = STEP * np.cos(np.arange(1.0, system.dof + 1.0))
    for x, u in ((q, 0.0 * aside), (_core.advance(system._core, q, aside, 1.0), aside)):
        first, *others = (_core.evaluate(system._core, t, x, u) for t in (0.0, *_TIMES))
        for t, other in zip(_TIMES, others, strict=True):
            for a, b in zip([first, *first["contacts"]], [other, *other["contacts"]], strict=True):
                for name in a.keys() - {"contacts"}:
                    if not np.allclose(a[name], b[name], rtol=1e-12, atol=0.0):
                        raise ParameterError(
                            "system",
                            f"depends on time, as its {_SAID[name]} at t = 0 and t = {t} s: there "
                            "is no steady sliding whose stability could be told from one time",
                        )


def constant(system: object) -> LinearSystem | None:
    """Return the linear system that a system is, if it is one."""
    if isinstance(system, MassOnBelt | SlidingPoint):
        return system.linear
    if isinstance(system, SparseLinearSystem):
        system = system.dense()
    return system if isinstance(system, LinearSystem) else None


def _contacts(system: Model) -> tuple[list[FrictionLaw], list[float | None]]:
    """Return the laws and the prescribed normal forces."""
    if isinstance(system, RigidBodies):
        contacts = [system.pairs[label.pair] for label in system.contacts]
    else:
        contacts = list(system.contacts)
    return [one.law for one in contacts], [one.normal_force for one in contacts]


def _difference(f: Callable[[Array], Array], n: int, step: float) -> tuple[Array, Array]:
    """Return the matrix of central differences, extrapolated, and errors of its entries.

    An estimate may vanish by chance; rounding errors are those of the function, the same in all
    columns. Hence each row has its worst.
    """
    if not n:
        return np.zeros((2, len(f(np.zeros(0))), 0))[0], np.zeros((len(f(np.zeros(0))), 0))
    matrix, errors = np.stack([_extrapolated(f, unit, step) for unit in np.eye(n)], axis=-1)
    return matrix, np.broadcast_to(errors.max(axis=1)[:, None], matrix.shape)


def _extrapolated(f: Callable[[Array], Array], unit: Array, step: float) -> tuple[Array, Array]:
    """Extrapolate to step 0 in h², each entry as far as its error estimate falls."""

    def slope(h: float) -> Array:
        return (f(h * unit) - f(-h * unit)) / (2.0 * h)

    row = [slope(step)]
    best, error = row[0], np.full(row[0].shape, np.inf)
    for level in range(1, _LEVELS):
        last, row = row, [slope(step / 4.0**level)]
        for k in range(level):
            row.append(row[k] + (row[k] - last[k]) / (16.0 ** (k + 1) - 1.0))
            estimate = np.maximum(np.abs(row[k + 1] - row[k]), np.abs(row[k + 1] - last[k]))
            closer = estimate < error
            best, error = np.where(closer, row[k + 1], best), np.where(closer, estimate, error)
    return best, error
