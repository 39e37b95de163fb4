"""Contacts among the joints, limits and dry joints of a mechanism, step after step."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact.certificate import Certificate
from asperity.contact.compressed import compressed
from asperity.contact.problem import ContactProblem
from asperity.errors import ConvergenceError, DimensionError, NoSolutionError, ParameterError
from asperity.law import FrictionLaw
from asperity.sets import Interval
from asperity.solvers import Solver, chosen
from asperity.status import Status

if TYPE_CHECKING:
    from scipy.sparse import sparray, spmatrix

_PARTS = (
    *("percussion", "velocity", "phase", "ambiguous_items"),
    *("status", "residual", "mismatch", "iterations", "worst_item"),
)
# Values of enumerators are slow to read.
_CONVERGED = Status.CONVERGED.value


class StepSolution:
    """What `ContactStepper.solve` found in a step; rows and items are those that were given.

    Attributes:
        percussion: P in N s, or N m s in rows that turn, shape ``(rows,)``.
        velocity: ξ = G P + b in m/s or rad/s, shape ``(rows,)``.
        phase: `Phase` of each item as integers: joints stick; ``NONE`` where nothing can move.
        status: how the solve ended; ``status.advice`` says what to try.
        residual: largest relative defect of a contact, as `ContactProblem.residual`.
        mismatch: largest velocity that is left in a bilateral row, or with which bodies approach
            each other that no percussion moves, in m/s or rad/s. Up to 1e-6 of the velocities of
            the rows that influence it, with percussions that bring at most a hundred times the
            largest free velocity, it counts as drift.
        iterations: sweeps or iterations of the solver.
        ambiguous_items: whether each item had several solutions, the others held.
        worst_item: the item with the largest residual, or the one without a solution.
    """

    _step: _core.Step

    def __init__(self, step: _core.Step) -> None:
        object.__setattr__(self, "_step", step)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"StepSolution is immutable: {name!r} cannot be set")

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, ({name: getattr(self._step, name) for name in _PARTS},)

    @cached_property
    def percussion(self) -> Array:
        """P of all rows in N s."""
        return self._step.percussion

    @cached_property
    def velocity(self) -> Array:
        """G P + b of all rows in m/s."""
        return self._step.velocity

    @cached_property
    def phase(self) -> NDArray[np.int64]:
        """`Phase` of each item as integers."""
        return self._step.phase

    @cached_property
    def ambiguous_items(self) -> NDArray[np.bool_]:
        """Whether each item had several solutions, the others held."""
        return self._step.ambiguous_items

    @property
    def status(self) -> Status:
        """How the solve ended."""
        return Status(self._step.status)

    @property
    def residual(self) -> float:
        """Largest relative defect of a contact."""
        return self._step.residual

    @property
    def mismatch(self) -> float:
        """Largest velocity that no percussion can take out, in m/s."""
        return self._step.mismatch

    @property
    def iterations(self) -> int:
        """Sweeps or iterations of the solver."""
        return self._step.iterations

    @property
    def worst_item(self) -> int:
        """The item with the largest residual, or the one without a solution."""
        return self._step.worst_item

    @property
    def converged(self) -> bool:
        """Whether the tolerance was reached."""
        return self._step.status == _CONVERGED

    def __repr__(self) -> str:
        items = len(self.phase)
        return f"<StepSolution: {self.status}, {items} items, residual {self.residual:.3g}>"


class ContactStepper:
    """Solve the contacts of a mechanism step after step: ξ = G P + b, item by item.

    An engine of multibody dynamics hands over the rows of a step; percussions come back. Items are

    - the number k of a law: a contact, its normal row and then the p rows of ``laws[k]``,
    - ``FRICTIONLESS``: one row, 0 ≤ P ⊥ ξ ≥ 0, a contact without friction or a limit of a joint,
    - ``BILATERAL``: one row, ξ = 0 and P of any sign, a joint,
    - ``DRY_FRICTION``: one row, |P| ≤ bound, against ξ: a joint with dry friction.

    Percussions and phases start from those that the item with the same key had in the step before.
    Items are solved in the order of their keys: the result does not depend on the order in which
    they are listed, to the bit, also where percussions are not unique: contacts of one body, or up
    to 16 of several, that slide in different directions share their load as if of equal compliance.
    Bilateral rows may repeat each other, as in loops: their percussions have the least Σ G_ii P_i²
    among all that leave the least velocities. They may not contradict each other by more than 1e-6
    of the velocities that they take out. Links 1e9 times as light as what they join look like
    repeated rows in G, and joints that need them do not hold; `ContactProblem.from_bodies` takes
    masses. Where the bodies of a contact cannot move in some of its rows, as in planar models, they
    stick up to the friction of sliding in the direction that is left; at rest what is transmitted
    across it is undetermined, and goes with the force along it as in sliding.

    A stepper changes with every step: one per simulation, and per thread. Copies, by pickle too, do
    not remember the steps before.

    Args:
        laws: friction laws of dimension p = 1, 2 or 3, without a factor of the speed.
        solver: default `Auto`.
        tolerance: largest relative defect of a contact.

    Raises:
        ParameterError: naming the argument.

    Reference: [WL19] (19), (55).

    >>> import numpy as np
    >>> from asperity import ContactStepper, FrictionLaw
    >>> stepper = ContactStepper([FrictionLaw.isotropic(0.5)])
    >>> step = stepper.solve(
    ...     np.eye(5),
    ...     free_velocity=[-1.0, 3.0, 4.0, 0.2, 0.5],
    ...     items=[0, ContactStepper.BILATERAL, ContactStepper.DRY_FRICTION],
    ...     bounds=[0.0, 0.0, 0.3],
    ... )
    >>> step.percussion.round(12).tolist(), step.velocity.round(12).tolist()
    ([1.0, -0.3, -0.4, -0.2, -0.3], [0.0, 2.7, 3.6, 0.0, 0.2])
    """

    FRICTIONLESS: ClassVar[int] = -1
    BILATERAL: ClassVar[int] = -2
    DRY_FRICTION: ClassVar[int] = -3

    def __init__(
        self,
        laws: FrictionLaw | Sequence[FrictionLaw],
        *,
        solver: Solver | None = None,
        tolerance: float = 1e-10,
    ) -> None:
        listed = (laws,) if isinstance(laws, FrictionLaw) else arrays.several(laws, "laws")
        for law in listed:
            arrays.of_kind(law, "laws", FrictionLaw, "a FrictionLaw or a sequence of them")
        self._laws: tuple[FrictionLaw, ...] = listed
        self._tolerance = arrays.positive(tolerance, "tolerance")
        self._solver = chosen(solver)
        self._stepper = _core.Stepper([law._core for law in listed], self._solver._core)

    def __reduce__(self) -> tuple[Any, ...]:
        make = partial(ContactStepper, solver=self._solver, tolerance=self._tolerance)
        return make, (self._laws,)

    @property
    def laws(self) -> tuple[FrictionLaw, ...]:
        """The friction laws, which items name by their numbers."""
        return self._laws

    @property
    def tolerance(self) -> float:
        """Largest relative defect of a contact that counts as solved."""
        return self._tolerance

    def __repr__(self) -> str:
        return f"<ContactStepper: {len(self._laws)} laws, tolerance {self._tolerance:g}>"

    def solve(
        self,
        delassus: ArrayLike | sparray | spmatrix,
        *,
        free_velocity: ArrayLike,
        items: ArrayLike,
        bounds: ArrayLike | None = None,
        keys: ArrayLike | None = None,
        time_limit: float | None = None,
        on_failure: str = "raise",
    ) -> StepSolution:
        """Solve a step.

        Args:
            delassus: G = WᵀM⁻¹W in 1/kg, symmetric, shape ``(rows, rows)``; dense, or a sparse
                array or matrix of SciPy.
            free_velocity: b in m/s, with e∘γ_B added where there is restitution and γ where a joint
                is driven at −γ; shape ``(rows,)``.
            items: what the rows are, see the class; integers, shape ``(items,)``.
            bounds: percussions in N s up to which joints hold by dry friction, shape ``(items,)``;
                the entries of other items do not count.
            keys: a different integer per item, the same in every step, shape ``(items,)``; default:
                the place of the item.
            time_limit: in s; default none.
            on_failure: ``"raise"`` or ``"record"``: return the best percussions with their status.

        Raises:
            NoSolutionError: if bodies are squeezed, or joints contradict each other or do not hold
                light links.
            ConvergenceError: if the tolerance is not reached.
            DimensionError, ParameterError: naming the argument.
        """
        arrays.choice(on_failure, "on_failure", ("raise", "record"))
        kinds = _integers(items, "items")
        free = _floats(free_velocity, "free_velocity", 1)
        step = self._stepper.step(
            _entries(delassus, len(free)),
            free,
            kinds,
            None if bounds is None else _bounds(bounds, kinds),
            None if keys is None else _integers(keys, "keys"),
            self._tolerance,
            None if time_limit is None else arrays.positive(time_limit, "time_limit"),
        )
        solution = StepSolution(step)
        if on_failure == "raise" and not solution.converged:
            raise self._failure(solution, kinds)
        return solution

    def forget(self) -> None:
        """Forget the steps before: the next one starts without percussions and phases."""
        self._stepper.forget()

    def certificate(self) -> Certificate:
        """Return what is left of the contact laws in the last step, from its percussions alone."""
        return Certificate(**self._stepper.certificate())

    def contact_problem(self) -> tuple[ContactProblem, NDArray[np.int64]]:
        """Return the contacts of the last step as a problem of their own.

        Joints are eliminated, so that files, proofs, `natural_map` and every solver take it. Its
        contacts are the items that are no joints and that anything moves; those that move in their
        normal row alone are without friction.

        Returns:
            The problem, with dense G, and the item that each of its contacts is.

        Raises:
            ParameterError: if the last step had no such items.

        >>> import numpy as np
        >>> from asperity import ContactStepper
        >>> stepper = ContactStepper([])
        >>> bar = np.array([[1.0, 0.5], [0.5, 1.0]])  # a joint beside a limit
        >>> kinds = [ContactStepper.BILATERAL, ContactStepper.FRICTIONLESS]
        >>> step = stepper.solve(bar, free_velocity=[0.0, -1.0], items=kinds)
        >>> problem, items = stepper.contact_problem()
        >>> items.tolist(), problem.laws, problem.solve().percussion.round(12).tolist()
        ([1], (None,), [1.333333333333])
        """
        found = self._stepper.contact_problem()
        if not found["laws"]:
            raise ParameterError("items", "must have had a contact that moves in the last step")
        known: dict[int | None, FrictionLaw | None] = {None: None, **dict(enumerate(self._laws))}
        laws = [
            FrictionLaw.associated(Interval(*ends)) if ends else known[number]
            for number, ends in zip(found["laws"], found["ends"], strict=True)
        ]
        problem = ContactProblem(
            found["delassus"],
            free_velocity=found["free_velocity"],
            laws=laws,
            normal_force=found["normal_force"],
        )
        return problem, found["items"]

    def _failure(
        self, step: StepSolution, kinds: NDArray[np.int64]
    ) -> ConvergenceError | ParameterError:
        status = step.status
        if status is Status.NOT_APPLICABLE:
            return ParameterError("solver", f"{status.message}. {status.advice}")
        if status is Status.NO_SOLUTION:
            message = f"{status.message} at item {step.worst_item}"
            moved = self._stepper.contact_problem()["items"]
            if step.worst_item not in moved:
                left = f", where {step.mismatch:.3g} m/s are left"
                message += left
                if kinds[step.worst_item] == self.BILATERAL:
                    message = (
                        f"joints do not hold at item {step.worst_item}{left}: they contradict each "
                        "other, or a link is so light that G does not tell it from none, as from "
                        "ratios of masses of 1e9 on; ContactProblem.from_bodies takes its mass"
                    )
                return NoSolutionError(message, residual=step.residual)
            problem, _ = self.contact_problem()
            proof = problem.solve(on_failure="record").infeasibility
            return NoSolutionError(
                message, residual=step.residual, problem=problem, infeasibility=proof
            )
        return ConvergenceError(
            f"{status.message} at item {step.worst_item}",
            residual=step.residual,
            advice=status.advice,
        )


def _restored(parts: dict[str, Any]) -> StepSolution:
    for part in parts.values():
        if isinstance(part, np.ndarray):
            part.flags.writeable = False
    return StepSolution(cast(_core.Step, SimpleNamespace(**parts)))


def _floats(values: ArrayLike, argument: str, dimensions: int) -> Array:
    """Return contiguous numbers; those of an engine are taken as they are."""
    if (
        type(values) is np.ndarray
        and values.dtype == np.float64
        and values.ndim == dimensions
        and values.flags.c_contiguous
    ):
        return values
    return np.ascontiguousarray(arrays.array(values, argument, (None,) * dimensions))


def _entries(delassus: Any, rows: int) -> Any:
    """Return all numbers, or row starts, columns and values of a sparse matrix."""
    if not hasattr(delassus, "tocsr"):
        entries = _floats(delassus, "delassus", 2)
        _check_square(entries, rows)
        return entries
    matrix = compressed(delassus, "delassus", (None, None))
    _check_square(matrix, rows)
    return matrix.triple


def _check_square(matrix: Any, rows: int) -> None:
    if matrix.shape != (rows, rows):
        raise DimensionError(
            "delassus",
            f"must have as many rows and columns as free_velocity has entries, {rows}, got shape "
            f"{matrix.shape}",
        )


def _integers(values: ArrayLike, argument: str) -> NDArray[np.int64]:
    if type(values) is np.ndarray and values.dtype == np.int64 and values.ndim == 1:
        return values
    converted = arrays.array(values, argument, (None,))
    given = np.asarray(values)
    if given.dtype.kind not in "iub":
        # Floats name integers without a doubt up to there.
        given, fits = converted, (converted == np.rint(converted)) & (np.abs(converted) < 2.0**53)
    else:
        fits = given <= np.iinfo(np.int64).max
    if not np.all(fits):
        raise ParameterError(argument, "must be integers, less than 2**63")
    return given.astype(np.int64)


def _bounds(values: ArrayLike, items: NDArray[np.int64]) -> Array:
    """Return the bounds of dry joints, in place of the others 0."""
    bounds = arrays.with_gaps(values, "bounds", (None,))
    if len(bounds) != len(items):
        raise DimensionError("bounds", f"must have one entry per item, {len(items)}")
    is_dry = items == ContactStepper.DRY_FRICTION
    wrong = np.flatnonzero(is_dry & ~((bounds >= 0.0) & (bounds < np.inf)))
    if wrong.size:
        found = f"that of item {wrong[0]} is {bounds[wrong[0]]:g}"
        raise ParameterError("bounds", f"must be finite and not negative, {found}")
    return np.where(is_dry, bounds, 0.0)
