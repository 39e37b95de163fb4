"""The matrices of small motions about steady sliding, each force by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import keep_views
from asperity.errors import ParameterError
from asperity.steady_sliding.linearised.field import STEP, Field
from asperity.steady_sliding.linearised.painleve import not_keeping_apart
from asperity.steady_sliding.linearised.pencil import ROUNDING, SAFETY, Pencil
from asperity.steady_sliding.linearised.sliding import Sliding

# Names of the contributions to B and K.
INTERNAL = "internal"
CONE, DIRECTION, SLOPE = "tangent cone", "direction of friction", "Stribeck slope"
COUPLING, FEEDBACK = "mode coupling", "velocity feedback of the normal force"
FOLLOWER = "follower force"


@dataclass(frozen=True, eq=False)
class Linearisation:
    """M δq̈ + B δq̇ + K δq = E δλ_N, W_Nᵀδq = 0, with B and K as sums of contributions.

    Displacements δq are those of q ⊕ δq. `normals` holds W_N and `thrusts` E = W_N + W f of the
    closed unilateral contacts, f = λ/λ_N.
    """

    mass: Array
    contacts: Mapping[int, Sliding]
    """The contacts that touch."""
    closed: tuple[int, ...]
    imbalance: Array
    """h + W_N λ_N + W λ, which vanishes at an equilibrium."""
    size: float
    """Sum of the sizes of the forces in it and of those of a displacement by one step."""
    stiffness: Mapping[str, Array]
    damping: Mapping[str, Array]
    errors: Pencil
    """Bounds of the errors of the entries of M, B, K."""

    def __post_init__(self) -> None:
        keep_views(self)

    @cached_property
    def normals(self) -> Array:
        """W_N, shape ``(n, closed contacts)``."""
        columns = [self.contacts[i].state.normal for i in self.closed]
        return np.array(columns).reshape(len(columns), len(self.mass)).T

    @cached_property
    def thrusts(self) -> Array:
        """E, shape ``(n, closed contacts)``."""
        across = [self.contacts[i].state.W @ self.contacts[i].unit_force for i in self.closed]
        return self.normals + np.array(across).reshape(len(across), len(self.mass)).T

    @cached_property
    def reduced(self) -> Reduced:
        """The motion within the closed contacts."""
        return Reduced.of(self)

    def without(self, name: str) -> Linearisation:
        """Leave out a contribution to B or K."""
        stiffness, damping = (
            {key: part for key, part in parts.items() if key != name}
            for parts in (self.stiffness, self.damping)
        )
        return replace(self, stiffness=stiffness, damping=damping)


@dataclass(frozen=True, eq=False)
class Reduced:
    """M ÿ + B ẏ + K y = 0 with δq = Z y; the normal forces are eliminated.

    Feedback is what the friction forces do when the normal forces vary.
    """

    Z: Array
    mass: Array
    stiffness: Mapping[str, Array]
    damping: Mapping[str, Array]
    errors: Pencil

    def __post_init__(self) -> None:
        keep_views(self)

    @property
    def pencil(self) -> Pencil:
        """M, B, K."""
        return Pencil(self.mass, total(self.damping), total(self.stiffness))

    @classmethod
    def of(cls, whole: Linearisation) -> Reduced:
        """Project on the null space of the closed contacts' normals."""
        Z = _null_space(whole.normals)
        left = np.abs(Z.T)
        stiffness, damping = (
            {name: Z.T @ part @ Z for name, part in parts.items()}
            for parts in (whole.stiffness, whole.damping)
        )
        if whole.closed:
            response, uncertain = _normal_response(whole)
            across = -Z.T @ (whole.thrusts - whole.normals)
            feedback, left = across @ response, left + np.abs(across) @ uncertain
            stiffness[COUPLING] = feedback @ total(whole.stiffness) @ Z
            damping[FEEDBACK] = feedback @ total(whole.damping) @ Z
        errors = Pencil(*(left @ part @ np.abs(Z) for part in whole.errors))
        return cls(Z, Z.T @ whole.mass @ Z, stiffness, damping, errors)


def linearisation(
    of: Field, normal_force: Array, closed: tuple[int, ...], *, step: float = STEP
) -> Linearisation:
    """Linearise about u = 0, where all closed contacts slide.

    Raises:
        ParameterError: if a closed contact would stick or its force is not smooth.
    """
    contacts = _touching(of, normal_force, closed)
    slopes = of.slopes(lambda found, delta: _loads(of, found, contacts, delta), step)
    n, rows, at = of.n, slopes.displacement, of.n
    doubt, blur = SAFETY * slopes.displacement_error, SAFETY * slopes.velocity_error
    unsure = doubt[:n].copy()
    stiffness = {INTERNAL: -rows[:n], FOLLOWER: np.zeros((n, n))}
    damping = {INTERNAL: -slopes.velocity}
    damping |= {name: np.zeros((n, n)) for name in (CONE, DIRECTION, SLOPE)}
    for contact in contacts.values():
        W = contact.state.W
        p = W.shape[1]
        mine = slice(at, at + 2 * n + p)
        turning, pressing, belt = np.split(rows[mine], [n, 2 * n])
        jacobian = contact.direction_jacobian + contact.rate_jacobian
        stiffness[INTERNAL] -= pressing
        stiffness[FOLLOWER] -= turning + W @ jacobian @ belt
        cone = CONE if contact.margin < 0.0 else DIRECTION
        damping[cone] -= W @ contact.direction_jacobian @ W.T
        damping[SLOPE] -= W @ contact.rate_jacobian @ W.T
        size, relative = np.full((p, p), np.abs(jacobian).max()), contact.error
        blunt = max(ROUNDING * n, SAFETY * relative) * np.abs(W) @ size
        turned, pressed, moved = np.split(doubt[mine], [n, 2 * n])
        unsure += turned + pressed + np.abs(W) @ size @ moved + blunt @ np.abs(belt)
        blur = blur + blunt @ np.abs(W.T)
        at += 2 * n + p
    state = of.at()
    forces = [state["forces"], *(push for one in contacts.values() for push in _pushes(one))]
    elastic = step * float(np.linalg.norm(total(stiffness)))
    return Linearisation(
        mass=state["mass"],
        contacts=contacts,
        closed=closed,
        imbalance=np.sum(forces, axis=0),
        size=elastic + float(sum(np.linalg.norm(force) for force in forces)),
        stiffness=stiffness,
        damping=damping,
        errors=Pencil(
            ROUNDING * n * np.abs(state["mass"]),
            blur + ROUNDING * n * np.sum(np.abs(list(damping.values())), axis=0),
            unsure + ROUNDING * n * np.sum(np.abs(list(stiffness.values())), axis=0),
        ),
    )


def _loads(
    of: Field, found: dict[str, Any], contacts: Mapping[int, Sliding], delta: Array
) -> Array:
    """Return h, then W λ, w_N λ_N and χ of each contact at q ⊕ δ, with λ and λ_N held."""
    parts = [of.transported(found["forces"], delta)]
    for i, contact in contacts.items():
        there = found["contacts"][i]
        normal = there.get("normal", np.zeros(of.n)) * contact.normal_force
        parts.append(of.transported(there["tangent"].T @ contact.force, delta))
        parts.append(of.transported(normal, delta))
        parts.append(there["velocity"])
    return np.concatenate(parts)


def _pushes(contact: Sliding) -> list[Array]:
    normal = contact.state.normal
    friction = contact.state.W @ contact.force
    return [friction] if normal is None else [friction, normal * contact.normal_force]


def _touching(of: Field, normal_force: Array, closed: tuple[int, ...]) -> dict[int, Sliding]:
    """Return the loaded contacts; they must move, along directions where D is not flat."""
    touching = {}
    for i, state in enumerate(of.contacts()):
        if i not in closed and not of.normal_forces[i]:
            continue
        if not np.linalg.norm(state.chi) > 0.0:
            raise ParameterError(
                "system", f"contact {i} would stick: its velocity χ vanishes in steady sliding"
            )
        touching[i] = Sliding(of.laws[i], state, float(normal_force[i]))
        if not touching[i].is_smooth:
            raise ParameterError(
                "system",
                f"contact {i} slides along {state.chi.tolist()}, where its D is flat and the "
                "force is not smooth",
            )
    return touching


def _normal_response(whole: Linearisation) -> tuple[Array, Array]:
    """Return (W_NᵀM⁻¹E)⁻¹W_NᵀM⁻¹, which takes forces to the normal forces that resist them.

    Also the product of the absolute values, which is larger where cancellation makes it uncertain.
    """
    weighted = np.linalg.solve(whole.mass, whole.normals).T
    if np.linalg.cond(weighted @ whole.normals) > 1e12:
        raise ParameterError(
            "closed", "must be contacts with independent normals: their forces are not unique"
        )
    push = weighted @ whole.thrusts
    wrong = not_keeping_apart(push)
    if wrong is not None:
        names = " and ".join(str(whole.closed[place]) for place in wrong)
        who = f"contact {names} is" if len(wrong) == 1 else f"contacts {names} together are"
        raise ParameterError(
            "system",
            f"{who} in the Painlevé zone: the normal forces do not keep what touches from closing",
        )
    inverse = np.linalg.inv(push)
    return inverse @ weighted, np.abs(inverse) @ np.abs(weighted)


def _null_space(normals: Array) -> Array:
    """Return an orthonormal basis Z with W_NᵀZ = 0; the identity without normals."""
    n, m = normals.shape
    if not m:
        return np.eye(n)
    vectors, values, _ = np.linalg.svd(normals)
    rank = int((values > values[0] * 1e-12).sum())
    return np.ascontiguousarray(vectors[:, rank:])


def total(parts: Mapping[str, Array]) -> Array:
    """Return the sum of the contributions."""
    return np.sum(list(parts.values()), axis=0)
