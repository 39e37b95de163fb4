"""Contact phases, and how solvers and simulations end."""

from __future__ import annotations

from enum import IntEnum, StrEnum

__all__ = [
    "Outcome",
    "Phase",
    "Status",
]


class Phase(IntEnum):
    """What a contact does; the integers are those of the ``phase`` arrays."""

    NONE = -1
    """Not known, as in the initial state."""
    OPEN = 0
    """No contact force: apart, or touching without load."""
    STICK = 1
    """Closed and at rest: slip velocity zero."""
    SLIP = 2
    """Closed and sliding."""

    def __repr__(self) -> str:
        return f"Phase.{self.name}"


class Outcome(StrEnum):
    """How a simulation ended."""

    FINISHED = "finished"
    """All steps were made."""
    AT_REST = "at_rest"
    """Everything came to rest before, as asked for."""
    SECTION = "section"
    """The motion came to the section, where it was to stop."""
    INTERRUPTED = "interrupted"
    """Ctrl-C."""
    FAILED = "failed"
    """A contact problem was not solved, or the system failed."""

    def __repr__(self) -> str:
        return f"Outcome.{self.name}"


class Status(StrEnum):
    """How the solution of a contact problem ended."""

    CONVERGED = "converged"
    """The measure is within the tolerance."""
    MAX_ITERATIONS = "max_iterations"
    """The iteration limit was reached before."""
    TIME_LIMIT = "time_limit"
    """The time limit was reached before."""
    INEXACT = "inexact"
    """The solver is done, but rounding keeps the measure above the tolerance."""
    STALLED = "stalled"
    """The solver makes no further progress above the tolerance."""
    UNBOUNDED = "unbounded"
    """Percussions grow without bound while a contact goes on moving: there is probably no
    solution, but that is not proven."""
    NO_SOLUTION = "no_solution"
    """There is no solution; ``ContactSolution.infeasibility`` is the proof."""
    NOT_APPLICABLE = "not_applicable"
    """The solver does not take these laws or contacts."""

    def __repr__(self) -> str:
        return f"Status.{self.name}"

    @property
    def message(self) -> str:
        """What happened, in one clause."""
        return _MESSAGES[self]

    @property
    def advice(self) -> str:
        """What to try next; empty if converged."""
        return _ADVICE[self]


_MESSAGES = {
    Status.CONVERGED: "converged",
    Status.MAX_ITERATIONS: "the solver reached its iteration limit before the tolerance",
    Status.TIME_LIMIT: "the solver reached its time limit before the tolerance",
    Status.INEXACT: "the solver is done, but rounding keeps the residual above the tolerance",
    Status.STALLED: "the solver makes no further progress above the tolerance",
    Status.UNBOUNDED: "percussions grow without bound while a contact goes on moving",
    Status.NO_SOLUTION: "no percussion satisfies the laws",
    Status.NOT_APPLICABLE: "the solver cannot take these laws or contacts",
}

_ADVICE = {
    Status.CONVERGED: "",
    Status.MAX_ITERATIONS: (
        "Try solver=Auto(), a smaller dt, a higher iteration limit or a looser tolerance"
    ),
    Status.TIME_LIMIT: "Try a longer time_limit or a looser tolerance",
    Status.INEXACT: "Try a looser tolerance, or sets and masses of less extreme proportions",
    Status.STALLED: "Try solver=Auto(), a smaller dt or a looser tolerance",
    Status.UNBOUNDED: (
        "There is probably no solution, which is not proven: look for bodies that are squeezed by "
        "prescribed motions, and for friction that pulls contacts to the surface"
    ),
    Status.NO_SOLUTION: (
        "Either friction and normal force enforce each other (Painlevé paradox): try smaller "
        "friction coefficients, another geometry or a compliant contact. Or contacts approach "
        "whatever the percussions: bodies are squeezed by prescribed motions"
    ),
    Status.NOT_APPLICABLE: (
        "InteriorPoint and ADMM need laws whose C and D are disks, balls or ellipses, on a line "
        "symmetric intervals. Try solver=Auto()"
    ),
}
