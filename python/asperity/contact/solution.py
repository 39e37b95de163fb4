"""Outcome of a solve."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.value import Record, Value
from asperity.contact.certificate import Certificate, Infeasibility
from asperity.errors import DimensionError
from asperity.status import Phase, Status

if TYPE_CHECKING:
    from asperity.contact.problem import ContactProblem

_STATUS = {status.value: status for status in Status}


class Stage(Record):
    """One method's part of a solve, see `ContactSolution.stages`.

    Attributes:
        method: its name.
        iterations: sweeps or iterations.
        factorizations: matrices factored.
        residual: natural map of the best percussions at its end, of several islands the largest; of
            `Exact`, the prox iterations, and sweeps over all islands the measure of the solve, but
            for islands whose natural map is far from small, of which it is that.
    """

    method: str
    iterations: int
    factorizations: int
    residual: float


class Island(Record):
    """Contacts that influence each other and no others, see `ContactSolution.islands`.

    Attributes:
        contacts: their numbers, ascending.
        status: how the solve ended there.
        residual: value there of the measure that decided, of this island alone. Where the whole is
            solved by the ``"global"`` measure, an island of small percussions may be left above
            the tolerance, as ``STALLED``.
        iterations: sweeps or iterations there; 0 where nothing was done: the percussions to start
            from solved the island already, or its turn had not come, as `status` tells.
    """

    contacts: tuple[int, ...]
    status: Status
    residual: float
    iterations: int


class ContactSolution(TableResult, Value):
    """Outcome of `ContactProblem.solve`.

    Attributes:
        percussion: P_N and P of all contacts in the problem's row order, in N s.
        velocity: G P + b, the velocities after the step in m/s.
        phase: `Phase` of each contact as integers.
        status: how the solve ended; ``status.advice`` says what to try.
        residual: value of the measure that decided, `ContactProblem.residual` by default.
        iterations: sweeps or iterations used, those of all stages.
        ambiguous_contacts: whether each contact had several solutions, the others held.
        worst_contact: contact with the largest residual.
        natural_map: `ContactProblem.natural_map` of `percussion`, of the whole problem.
        stages: what each method of the solver did, in order; of islands that go through it side by
            side the most iterations count, and all factorisations.
        islands: contacts that influence each other, directly or by others, and how each of these
            groups was solved.
        certificate: what is left of the contact laws, in physical units.
        infeasibility: the proof where the status is ``NO_SOLUTION``, else ``None``.

    Neither measure nor certificate comes from the solver: each is computed from the percussions,
    the certificate when it is asked for.
    """

    _outcome: _core.Outcome

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
        natural_map: float,
        stages: Sequence[Stage],
        islands: Sequence[Island],
        certificate: Certificate,
        infeasibility: Infeasibility | None = None,
    ) -> None:
        for stage in stages:
            arrays.of_kind(stage, "stages", Stage, "a sequence of Stage")
        for island in islands:
            arrays.of_kind(island, "islands", Island, "a sequence of Island")
        arrays.of_kind(certificate, "certificate", Certificate, "a Certificate")
        arrays.of_kind(
            infeasibility, "infeasibility", Infeasibility | None, "an Infeasibility or None"
        )
        self._keep(
            percussion=np.asarray(percussion, dtype=np.float64),
            velocity=np.asarray(velocity, dtype=np.float64),
            phase=np.asarray(phase, dtype=np.int64),
            status=Status(status),
            residual=float(residual),
            iterations=int(iterations),
            ambiguous_contacts=np.asarray(ambiguous_contacts, dtype=np.bool_),
            worst_contact=int(worst_contact),
            natural_map=float(natural_map),
            stages=tuple(stages),
            islands=tuple(islands),
            certificate=certificate,
            infeasibility=infeasibility,
        )

    @classmethod
    def _of(cls, outcome: _core.Outcome) -> Self:
        """Wrap what the core found; a step of one contact takes microseconds: nothing is read."""
        made = cls.__new__(cls)
        made.__dict__["_outcome"] = outcome
        return made

    @cached_property
    def percussion(self) -> Array:
        """P_N and P of all contacts in N s."""
        return self._outcome.percussion

    @cached_property
    def velocity(self) -> Array:
        """G P + b in m/s."""
        return self._outcome.velocity

    @cached_property
    def phase(self) -> NDArray[np.int64]:
        """`Phase` of each contact as integers."""
        return self._outcome.phase

    @cached_property
    def status(self) -> Status:
        """How the solve ended."""
        return _STATUS[self._outcome.status]

    @cached_property
    def residual(self) -> float:
        """Value of the measure that decided."""
        return self._outcome.residual

    @cached_property
    def iterations(self) -> int:
        """Sweeps or iterations of all stages."""
        return self._outcome.iterations

    @cached_property
    def ambiguous_contacts(self) -> NDArray[np.bool_]:
        """Whether each contact had several solutions, the others held."""
        return self._outcome.ambiguous_contacts

    @cached_property
    def worst_contact(self) -> int:
        """Contact with the largest relative defect."""
        return self._outcome.worst_contact

    @cached_property
    def natural_map(self) -> float:
        """`ContactProblem.natural_map` of the percussions."""
        return self.certificate.natural_map

    @cached_property
    def stages(self) -> tuple[Stage, ...]:
        """What each method of the solver did, in order."""
        return tuple(Stage(*stage) for stage in self._outcome.stages)

    @cached_property
    def islands(self) -> tuple[Island, ...]:
        """How each group of contacts that influence each other was solved."""
        return tuple(
            Island(tuple(contacts), _STATUS[status], residual, iterations)
            for contacts, status, residual, iterations in self._outcome.islands
        )

    @cached_property
    def certificate(self) -> Certificate:
        """What is left of the contact laws at these percussions."""
        return Certificate(**self._outcome.certificate)

    @cached_property
    def infeasibility(self) -> Infeasibility | None:
        """The proof that there is no solution, if there is none."""
        proof = self._outcome.infeasibility
        return None if proof is None else infeasibility(proof)

    @cached_property
    def _parameters(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in inspect.signature(type(self)).parameters}

    def __repr__(self) -> str:
        return (
            f"<ContactSolution: {self.status}, {counted(len(self.phase), 'contact')}, "
            f"residual {self.residual:.3g}, {counted(self.iterations, 'iteration')}>"
        )

    def summary(self) -> str:
        """Return how the solve ended, what the contacts do and what is left of their laws."""
        took = counted(self.iterations, "iteration")
        ended = self.status.message
        lines = [
            f"{ended[0].upper()}{ended[1:]} after {took}, with a residual of {self.residual:.3g}."
        ]
        if self.status.advice:
            lines.append(f"{self.status.advice}.")
        of = self.certificate
        contacts = counted(len(self.phase), "contact")
        lines.append(f"Of {contacts} {of.stick} stick, {of.slip} slip and {of.open} are open.")
        defects = {
            "bodies approach with": (of.penetration_velocity, "m/s"),
            "contacts pull with": (of.tension, "N s"),
            "friction is beyond the reservoir by": (of.cone_violation, "N s"),
            "friction is off its direction by": (of.direction_violation, "N s"),
        }
        told = [f"{what} {value:.2g} {unit}" for what, (value, unit) in defects.items() if value]
        lines.append(f"At most {', '.join(told)}." if told else "The contact laws hold exactly.")
        if self.ambiguous:
            some = counted(int(self.ambiguous_contacts.sum()), "contact")
            lines.append(f"{some} had several solutions, the others held.")
        if self.infeasibility is not None:
            lines.append(f"That there is none is proved, at contact {self.infeasibility.contact}.")
        return "\n".join(lines)

    def _table(self) -> Table:
        axes = {
            "row": Axis(np.arange(len(self.percussion)), "", "row of the problem"),
            "contact": Axis(np.arange(len(self.phase)), "", "contact"),
        }
        series = {
            "percussion": Series(self.percussion, ("row",), "N s", "percussion"),
            "velocity": Series(self.velocity, ("row",), "m/s", "velocity after the step"),
            "phase": Series(
                self.phase,
                ("contact",),
                "-",
                "phase of the contact",
                names={int(phase): phase.name.lower() for phase in Phase},
            ),
        }
        facts: dict[str, str | int | float] = {
            "status": str(self.status),
            "residual": self.residual,
            "iterations": self.iterations,
        }
        return Table(axes, series, facts)

    @property
    def ambiguous(self) -> bool:
        """Whether some contact had several solutions."""
        return bool(self.ambiguous_contacts.any())

    @property
    def converged(self) -> bool:
        """Whether the tolerance was reached."""
        return self.status is Status.CONVERGED


def infeasibility(proof: dict[str, Any]) -> Infeasibility:
    """Return the proof that the core hands over."""
    return Infeasibility(**proof)


class LocalSolution(Record):
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
    degenerate: bool = False


def starting(
    start: ContactSolution | ArrayLike, problem: ContactProblem
) -> tuple[Array, list[int], Array]:
    """Return percussions, phases and velocities from which a solve starts."""
    if not isinstance(start, ContactSolution):
        percussion = arrays.array(start, "start", problem.free_velocity.shape)
        unknown = [int(Phase.NONE)] * len(problem.laws)
        return percussion, unknown, problem.delassus @ percussion + problem.free_velocity
    same = start.percussion.shape == problem.free_velocity.shape
    if not same or len(start.phase) != len(problem.laws):
        raise DimensionError("start", "must be a solution of a problem with the same rows")
    return start.percussion, start.phase.tolist(), start.velocity
