"""Exceptions of asperity.

Every exception keeps its whole state in ``args``, so that it survives pickling and process pools.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

# What Ctrl-C raises stays here: it is caught, by few, and nobody makes it.
__all__ = [
    "AsperityError",
    "ConfigurationError",
    "ConvergenceError",
    "DimensionError",
    "DivergenceError",
    "FitError",
    "NoCycleError",
    "NoSolutionError",
    "ParameterError",
    "RecordError",
    "SweepError",
]

_LONGEST = 250


class AsperityError(Exception):
    """Base of all errors raised by asperity."""


class ParameterError(AsperityError, ValueError):
    """An argument lies outside the values that are allowed.

    Attributes:
        argument: name of the argument.
        message: what is allowed and what was given.
    """

    def __init__(self, argument: str, message: str) -> None:
        # A quoted set may list thousands of points.
        if len(message) > _LONGEST:
            message = f"{message[: _LONGEST - 3]}..."
        super().__init__(argument, message)
        self.argument = argument
        self.message = message

    def __str__(self) -> str:
        return f"{self.argument}: {self.message}"


class DimensionError(ParameterError):
    """An argument has the wrong shape or dimension."""


class FitError(AsperityError, ValueError):
    """Measured forces cannot be fitted; the message says why and what to do."""


class RecordError(AsperityError, ValueError):
    """A measured record cannot be used as it is.

    Attributes:
        source: the file or record.
        message: rows and column, what is wrong with them.
        options: of the reader that may help; where a configuration set them, their places in it.
    """

    def __init__(self, source: str, message: str, options: tuple[str, ...] = ()) -> None:
        super().__init__(source, message, options)
        self.source = source
        self.message = message
        self.options = options

    def __str__(self) -> str:
        text = f"{self.source}: {self.message}" if self.source else self.message
        return f"{text}; see {', '.join(self.options)}" if self.options else text


class ConfigurationError(AsperityError, ValueError):
    """A file of configuration cannot be used as it is.

    Attributes:
        file: its path.
        message: what is wrong, what is allowed.
        key: what is meant, as ``"[section] key"``, or empty.
        line: where it stands, from 1; ``None`` if that is not known.
    """

    def __init__(self, file: str, message: str, key: str = "", line: int | None = None) -> None:
        super().__init__(file, message, key, line)
        self.file = file
        self.message = message
        self.key = key
        self.line = line

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}, line {self.line}"
        return ": ".join(part for part in (place, self.key, self.message) if part)


class ConvergenceError(AsperityError, RuntimeError):
    """A contact problem was not solved to the tolerance.

    Attributes:
        message: what happened.
        step: number of the time step, from 1; ``None`` outside a simulation.
        time: time at the end of that step in s; ``None`` outside a simulation.
        contact: number of the contact with the largest residual.
        residual: natural-map residual that was reached.
        advice: what to try.
        trajectory: the part computed before the failure, if there is one.
    """

    def __init__(
        self,
        message: str,
        step: int | None = None,
        time: float | None = None,
        contact: int | None = None,
        residual: float | None = None,
        advice: str = "",
        trajectory: Any = None,
    ) -> None:
        super().__init__(message, step, time, contact, residual, advice, trajectory)
        self.message = message
        self.step = step
        self.time = time
        self.contact = contact
        self.residual = residual
        self.advice = advice
        self.trajectory = trajectory

    def __str__(self) -> str:
        where = {
            "step": self.step,
            "time": None if self.time is None else f"{self.time:.9g} s",
            "contact": self._contact(),
            "residual": None if self.residual is None else f"{self.residual:.3g}",
        }
        known = ", ".join(f"{name} {value}" for name, value in where.items() if value is not None)
        text = f"{self.message} ({known})" if known else self.message
        return f"{text}. {self.advice}" if self.advice else text

    def _contact(self) -> str | None:
        """Return the number of the contact, and its name if it has one of its own."""
        if self.contact is None or self.trajectory is None:
            return None if self.contact is None else str(self.contact)
        names = self.trajectory.contact_names
        name = names[self.contact] if self.contact < len(names) else ""
        plain = name in ("", f"contact {self.contact}")
        return str(self.contact) if plain else f"{self.contact}, {name!r}"


class NoSolutionError(ConvergenceError):
    """There is no solution: Painlevé paradox, or bodies squeezed by prescribed motions.

    Attributes:
        infeasibility: the proof, an `Infeasibility`, if there is one.
        problem: the `ContactProblem` without a solution, of `simulate` in percussions, of
            `integrate` in forces and accelerations or, at an impact, in percussions. ``None`` for
            `RigidBodies`.
    """

    def __init__(
        self,
        message: str,
        step: int | None = None,
        time: float | None = None,
        contact: int | None = None,
        residual: float | None = None,
        advice: str = "",
        trajectory: Any = None,
        infeasibility: Any = None,
        problem: Any = None,
    ) -> None:
        super().__init__(message, step, time, contact, residual, advice, trajectory)
        self.args = (*self.args, infeasibility, problem)
        self.infeasibility = infeasibility
        self.problem = problem


class NoCycleError(AsperityError, RuntimeError):
    """No limit cycle: the motion settles or does not recur, or periodic orbits are not isolated."""


class DivergenceError(AsperityError, ArithmeticError):
    """The state of a simulation is no longer finite, or on the way there.

    Attributes:
        message: where and when.
        trajectory: the part before, if there is one.
    """

    def __init__(self, message: str, trajectory: Any = None) -> None:
        super().__init__(message, trajectory)
        self.message = message
        self.trajectory = trajectory

    def __str__(self) -> str:
        return f"{self.message}. Try a smaller dt, or look for forces that grow without bound"


class SimulationInterrupted(KeyboardInterrupt):
    """A simulation was stopped by Ctrl-C.

    Attributes:
        trajectory: the part computed so far.
    """

    def __init__(self, trajectory: Any) -> None:
        super().__init__(trajectory)
        self.trajectory = trajectory

    def __str__(self) -> str:
        times = self.trajectory.t
        if len(times) == 0:
            return "interrupted before the first sample"
        return f"interrupted at t = {times[-1]:.9g} s; .trajectory holds the part before"


class EnsembleInterrupted(KeyboardInterrupt):
    """Many runs were stopped by Ctrl-C.

    Attributes:
        ensemble: the runs that are done; the others have the status `Outcome.INTERRUPTED`.
    """

    def __init__(self, ensemble: Any) -> None:
        super().__init__(ensemble)
        self.ensemble = ensemble

    def __str__(self) -> str:
        return f"interrupted; .ensemble holds what is done: {self.ensemble!r}"


class SweepError(AsperityError, RuntimeError):
    """A sweep cannot go on: a point failed where it must not, or the workers have died.

    What was done before is in the store, if there is one, and the next call goes on from there.

    Attributes:
        message: what happened.
        point: values of the point that failed, by name; None if it is not about one.
        traceback: of the error at that point, as text.
    """

    def __init__(
        self, message: str, point: Mapping[str, float | str] | None = None, traceback: str = ""
    ) -> None:
        super().__init__(message, point, traceback)
        self.message = message
        self.point = point
        self.traceback = traceback

    def __str__(self) -> str:
        if self.point is None:
            return self.message
        return f"at {', '.join(f'{name} = {x}' for name, x in self.point.items())}: {self.message}"


class SweepInterrupted(KeyboardInterrupt):
    """A sweep was stopped by Ctrl-C.

    Attributes:
        dataset: what was done before; the next call with the same store goes on from there.
        done: points that were computed.
        points: all points.
    """

    def __init__(self, dataset: xarray.Dataset, done: int, points: int) -> None:
        super().__init__(dataset, done, points)
        self.dataset = dataset
        self.done = done
        self.points = points

    def __str__(self) -> str:
        return f"interrupted at {self.done} of {self.points} points; .dataset holds what is done"
