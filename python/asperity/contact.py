"""The one-step contact problem: Delassus operator, free velocities and laws in, percussions out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity import _arrays, _core
from asperity._arrays import Array
from asperity._value import Value
from asperity.errors import ConvergenceError, DimensionError, NoSolutionError, ParameterError
from asperity.law import FrictionLaw
from asperity.solvers import Solver, chosen
from asperity.status import Phase, Status


class ContactSolution(Value):
    """Outcome of `ContactProblem.solve`.

    Attributes:
        percussion: P_N and P of all contacts in the problem's row order, in N s.
        velocity: G P + b, the velocities after the step in m/s.
        phase: `Phase` of each contact as integers.
        status: how the solve ended; ``status.advice`` says what to try.
        residual: natural-map residual of `percussion`, computed independently of the solver.
        iterations: sweeps or iterations used.
        ambiguous_contacts: whether each contact had several solutions, the others held.
        worst_contact: contact with the largest residual.
    """

    percussion: Array
    velocity: Array
    phase: NDArray[np.int64]
    status: Status
    residual: float
    iterations: int
    ambiguous_contacts: NDArray[np.bool_]
    worst_contact: int

    def __init__(
        self,
        percussion: ArrayLike,
        velocity: ArrayLike,
        phase: ArrayLike,
        status: Status,
        residual: float,
        iterations: int,
        ambiguous_contacts: ArrayLike,
        worst_contact: int,
    ) -> None:
        self._set(
            percussion=_arrays.read_only(np.asarray(percussion, dtype=np.float64)),
            velocity=_arrays.read_only(np.asarray(velocity, dtype=np.float64)),
            phase=_arrays.read_only(np.asarray(phase, dtype=np.int64)),
            status=Status(status),
            residual=float(residual),
            iterations=int(iterations),
            ambiguous_contacts=_arrays.read_only(np.asarray(ambiguous_contacts, dtype=np.bool_)),
            worst_contact=int(worst_contact),
        )

    @property
    def ambiguous(self) -> bool:
        """Whether some contact had several solutions."""
        return bool(self.ambiguous_contacts.any())

    @property
    def converged(self) -> bool:
        """Whether the tolerance was reached."""
        return self.status is Status.CONVERGED


class LocalSolution(Value):
    """One solution of a single contact, see `ContactProblem.solutions`.

    Attributes:
        phase: open, stick or slip.
        percussion: the contact's rows, in N s.
        velocity: the contact's rows, in m/s.
        degenerate: whether the solution is a double root or one of a continuum.
    """

    phase: Phase
    percussion: Array
    velocity: Array
    degenerate: bool

    def __init__(
        self, phase: Phase, percussion: ArrayLike, velocity: ArrayLike, degenerate: bool = False
    ) -> None:
        self._set(
            phase=Phase(phase),
            percussion=_arrays.read_only(np.asarray(percussion, dtype=np.float64)),
            velocity=_arrays.read_only(np.asarray(velocity, dtype=np.float64)),
            degenerate=bool(degenerate),
        )


class ContactProblem(Value):
    """Find percussions P with ξ = G P + b + e∘γ_B, ξ_N ∈ N_{R₀⁻}(−P_N), ξ_T ∈ N_D(−αP_T).

    Rows come contact by contact: the normal row first where the contact is unilateral, then the p
    tangential rows. Nothing in the problem knows the mechanical system.

    Args:
        delassus: G = [W_N W]ᵀ M⁻¹ [W_N W] in 1/kg, shape ``(rows, rows)``; need not be symmetric.
        free_velocity: b, the velocities without percussions in m/s, shape ``(rows,)``.
        laws: one law per contact, or one law for all.
        normal_force: prescribed normal percussions P_N ≥ 0 in N s: a number for all contacts, or
            one entry per contact, ``None`` meaning unilateral. Default: all unilateral.
        normal_restitution: e_N in [0, 1], a number or shape ``(contacts,)``.
        tangential_restitution: e_T in [0, 1], a number or shape ``(contacts,)``.
        initial_velocity: γ_B before the step in m/s, shape ``(rows,)``, for restitution.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [WL19] (19), (55).

    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(
    ...     [[1.0, 0.0], [0.0, 1.0]], [3.0, 4.0], FrictionLaw.isotropic(0.5), normal_force=1.0
    ... )
    >>> solution = problem.solve()
    >>> solution.status, solution.percussion.round(12).tolist()
    (Status.CONVERGED, [-0.3, -0.4])
    """

    delassus: Array
    free_velocity: Array
    laws: tuple[FrictionLaw, ...]
    normal_force: tuple[float | None, ...]
    normal_restitution: Array
    tangential_restitution: Array
    initial_velocity: Array
    _core: _core.Problem

    def __init__(
        self,
        delassus: ArrayLike,
        free_velocity: ArrayLike,
        laws: FrictionLaw | Sequence[FrictionLaw],
        *,
        normal_force: float | Sequence[float | None] | None = None,
        normal_restitution: ArrayLike = 0.0,
        tangential_restitution: ArrayLike = 0.0,
        initial_velocity: ArrayLike | None = None,
    ) -> None:
        free = _arrays.array(free_velocity, "free_velocity", (None,))
        chosen_laws = _laws(laws, free.size, normal_force)
        contacts = len(chosen_laws)
        normal = _normal_forces(normal_force, contacts)
        rows = sum(
            law.dimension + (force is None) for law, force in zip(chosen_laws, normal, strict=True)
        )
        initial = np.zeros(rows) if initial_velocity is None else initial_velocity
        self._set(
            delassus=_arrays.read_only(_arrays.array(delassus, "delassus", (rows, rows))),
            free_velocity=_arrays.read_only(_arrays.array(free, "free_velocity", (rows,))),
            laws=chosen_laws,
            normal_force=normal,
            normal_restitution=_per_contact(normal_restitution, "normal_restitution", contacts),
            tangential_restitution=_per_contact(
                tangential_restitution, "tangential_restitution", contacts
            ),
            initial_velocity=_arrays.read_only(_arrays.array(initial, "initial_velocity", (rows,))),
        )
        core = _core.Problem(
            self.delassus,
            self.free_velocity,
            [law._core for law in chosen_laws],
            list(normal),
            self.normal_restitution,
            self.tangential_restitution,
            self.initial_velocity,
        )
        self._keep(_core=core)

    @property
    def row_slices(self) -> tuple[slice, ...]:
        """The rows of each contact."""
        sizes = [
            law.dimension + (force is None)
            for law, force in zip(self.laws, self.normal_force, strict=True)
        ]
        ends = np.cumsum(sizes).tolist()
        return tuple(slice(end - size, end) for size, end in zip(sizes, ends, strict=True))

    def solve(
        self,
        solver: Solver | None = None,
        *,
        tolerance: float = 1e-10,
        time_limit: float | None = None,
        on_failure: str = "raise",
        start: ContactSolution | None = None,
    ) -> ContactSolution:
        """Solve the problem.

        Args:
            solver: default `Exact`.
            tolerance: largest admissible natural-map residual.
            time_limit: in s; default none.
            on_failure: ``"raise"`` or ``"record"``: return the best iterate with its status.
            start: previous solution, the start of the iteration and of the rule of selection.

        Returns:
            The solution; its residual is computed independently of the solver.

        Raises:
            NoSolutionError: if a contact has no solution at all (Painlevé).
            ConvergenceError: if the tolerance is not reached.
        """
        _arrays.choice(on_failure, "on_failure", ["raise", "record"])
        limit = None if time_limit is None else _arrays.positive(time_limit, "time_limit")
        found = self._core.solve(
            chosen(solver)._core,
            _arrays.positive(tolerance, "tolerance"),
            limit,
            self._start(start),
        )
        found["ambiguous_contacts"] = found.pop("ambiguous")
        solution = ContactSolution(**found)
        if on_failure == "raise" and not solution.converged:
            raise _failure(solution)
        return solution

    def residual(self, percussion: ArrayLike) -> float:
        """Return the natural-map residual of percussions, the largest over the contacts.

        The defects P_N − max(0, P_N − ρξ_N) and z − prox_{P_N D}(z + ρξ), z = −αP, of a contact,
        ρ = rows/tr G of its own block, are taken relative to its percussion and ρ times its loads:
        independent of units and of the other contacts' sizes ([WL19] (12), (69)).

        Args:
            percussion: in N s, shape ``(rows,)``.

        >>> from asperity import ContactProblem, FrictionLaw
        >>> law = FrictionLaw.isotropic(0.3, dimension=1)
        >>> problem = ContactProblem([[1.0]], [0.5], law, normal_force=1.0)
        >>> problem.residual([-0.3]) < 1e-12 < problem.residual([-0.2])
        True
        """
        return self._core.residual(self._percussion(percussion))[0]

    def solutions(self, contact: int, percussion: ArrayLike | None = None) -> list[LocalSolution]:
        """Return all solutions of one contact, the percussions of the others held.

        Args:
            contact: its number, from 0; the plane (p = 2) or the line (p = 1).
            percussion: held percussions in N s, shape ``(rows,)``; default zeros. The rows of
                `contact` itself do not matter.

        Returns:
            Open, stick, then slip solutions by increasing direction of slip.

        >>> from asperity import ContactProblem, FrictionLaw
        >>> problem = ContactProblem(
        ...     [[1.0, 0.0], [0.0, 1.0]], [0.2, 0.0], FrictionLaw.isotropic(0.3), normal_force=1.0
        ... )
        >>> [solution.phase for solution in problem.solutions(0)]
        [Phase.STICK]
        """
        number = _arrays.count(contact, "contact", 0)
        if number >= len(self.laws):
            raise ParameterError("contact", f"must be below {len(self.laws)}, got {number}")
        held = np.zeros(self.free_velocity.size) if percussion is None else percussion
        found = self._core.solutions(number, self._percussion(held))
        return [LocalSolution(**solution) for solution in found]

    def _percussion(self, percussion: ArrayLike) -> Array:
        return _arrays.array(percussion, "percussion", (self.free_velocity.size,))

    def _start(self, start: ContactSolution | None) -> tuple[Array, list[int], Array] | None:
        if start is None:
            return None
        if not isinstance(start, ContactSolution):
            raise ParameterError("start", f"must be a ContactSolution, got {start!r}")
        if start.percussion.shape != self.free_velocity.shape or len(start.phase) != len(self.laws):
            raise DimensionError("start", "must be a solution of a problem with the same rows")
        return start.percussion, start.phase.tolist(), start.velocity


def _laws(laws: Any, rows: int, normal_force: Any) -> tuple[FrictionLaw, ...]:
    if isinstance(laws, FrictionLaw):
        return (laws,) * _contact_count(laws, rows, normal_force)
    listed = tuple(laws) if isinstance(laws, Sequence) else (laws,)
    for law in listed:
        if not isinstance(law, FrictionLaw):
            raise ParameterError(
                "laws", f"must be a FrictionLaw or a sequence of them, got {law!r}"
            )
    if not listed:
        raise DimensionError("laws", "must hold at least one law")
    return listed


def _contact_count(law: FrictionLaw, rows: int, normal_force: Any) -> int:
    """Return the number of contacts that share one law."""
    if normal_force is not None and np.ndim(normal_force):
        return len(normal_force)
    rows_each = law.dimension + (normal_force is None)
    if rows == 0 or rows % rows_each:
        raise DimensionError(
            "free_velocity", f"must have a multiple of {rows_each} rows (one contact), got {rows}"
        )
    return rows // rows_each


def _normal_forces(normal_force: Any, contacts: int) -> tuple[float | None, ...]:
    if normal_force is None or np.ndim(normal_force) == 0:
        listed = [normal_force] * contacts
    else:
        listed = list(normal_force)
    if len(listed) != contacts:
        raise DimensionError(
            "normal_force", f"must have one entry per contact ({contacts}), got {len(listed)}"
        )
    return tuple(
        None if force is None else _arrays.non_negative(force, "normal_force") for force in listed
    )


def _per_contact(value: ArrayLike, argument: str, contacts: int) -> NDArray[Any]:
    converted = _arrays.array(value, argument)
    if converted.ndim == 0:
        converted = np.full(contacts, converted)
    converted = _arrays.array(converted, argument, (contacts,))
    for entry in converted:
        _arrays.fraction(entry, argument)
    return _arrays.read_only(converted)


def _failure(solution: ContactSolution) -> ConvergenceError:
    status = solution.status
    kind = NoSolutionError if status is Status.NO_SOLUTION else ConvergenceError
    return kind(
        status.message,
        contact=solution.worst_contact,
        residual=solution.residual,
        advice=status.advice,
    )
