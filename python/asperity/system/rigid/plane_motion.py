"""How planes move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.value import Check, Record
from asperity.errors import ParameterError
from asperity.system import time_functions
from asperity.system.time_functions import Signal, TimeFunction

# Where in a run rates are compared with differences of values, and over which parts of it: the
# coarsest one for functions with few digits, the finest one for those of 10⁹ periods.
_PLACES = (0.13, 0.29, 0.47, 0.61, 0.83)
_SPANS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
# Difference of what agrees, and rounding of a difference that says something, relative to the rate.
_AGREES, _SAYS = 0.1, 0.01


_Motion: TypeAlias = Signal | Callable[[float], tuple[ArrayLike, ArrayLike]] | None


def _moving(given: Any, argument: str) -> Any:
    if not (given is None or callable(given)):
        raise ParameterError(argument, f"must be a Signal, a function or None, got {given!r}")
    if isinstance(given, Signal) and given._core.jumps:
        raise ParameterError(argument, "must not jump: no velocity is that of a jump")
    return given


class PlaneMotion(Record):
    """How a plane moves: its point goes to point + d(t), and its axes turn by exp(ρ(t)) about it.

    Grooves and the normal move along. Velocities follow from the same functions, ḋ and ω = J(ρ) ρ̇
    with the left Jacobian J of the rotation vector, so that gaps and their rates agree.

    Args:
        displacement: d in m in the axes in which the plane is given, those of the world or of its
            body: a `Signal` with values of shape ``(3,)``, of a line ``(2,)``; or a function of t
            s that returns the pair (d, ḋ).
        rotation: the rotation vector ρ in rad in these axes, of the same kind; of a line a number,
            the angle counter-clockwise.

    A signal must not jump. Where its rate does, at a kink, the plane's velocity jumps, which is an
    impact for what lies on it. A function is called while the interpreter is held, must be smooth,
    and is pickled only if Python can. Runs refuse one whose rate is not that of its values at most
    of five times.

    Raises:
        ParameterError: naming the argument.

    >>> from asperity import Plane, PlaneMotion, Sine
    >>> table = Plane(motion=PlaneMotion(displacement=Sine([0.0, 0.0, 1e-3], frequency=50.0)))
    >>> table.motion.displacement.derivative(0.0).round(6).tolist()
    [0.0, 0.0, 0.314159]
    """

    _: KW_ONLY
    displacement: Annotated[_Motion, _moving] = None
    rotation: Annotated[_Motion, _moving] = None


def of_shapes(displacement: tuple[int, ...], rotation: tuple[int, ...]) -> Check:
    """Return the check of a motion whose displacement and rotation have these shapes."""

    def checked(motion: Any, argument: str) -> Any:
        arrays.of_kind(motion, argument, PlaneMotion | None, "a PlaneMotion or None")
        for name, shape in (("displacement", displacement), ("rotation", rotation)):
            part = getattr(motion, name, None)
            if part is not None:
                time_functions.checked(part, name, shape)
        return motion

    return checked


def core_data(
    motion: PlaneMotion | None, zeros: tuple[TimeFunction, TimeFunction]
) -> tuple[Any, Any] | None:
    """Return displacement and rotation for the core."""
    if motion is None:
        return None
    displacement, rotation = (
        zero if given is None else time_functions.core(given)
        for given, zero in zip((motion.displacement, motion.rotation), zeros, strict=True)
    )
    return displacement, rotation


def check_rates(system: object, start: float, end: float) -> None:
    """Refuse planes of a system whose motion has rates that contradict its values in a run."""
    for pair in getattr(system, "pairs", ()):
        motion = getattr(getattr(pair, "plane", None), "motion", None)
        if isinstance(motion, PlaneMotion):
            _check_function(motion.displacement, "displacement", start, end)
            _check_function(motion.rotation, "rotation", start, end)


def _check_function(function: Any, argument: str, start: float, end: float) -> None:
    if function is None or isinstance(function, Signal):
        return
    found = []
    for place in _PLACES:
        t = start + place * (end - start)
        try:
            contradiction = _contradiction(function, t, end - start)
        except Exception:
            # Any class: the function is the user's. The run calls it too, and raises what it raises
            # with the time at which it does.
            return
        if contradiction is not None:
            found.append((t, *contradiction))
    # A kink may be at one of these times.
    if 2 * len(found) > len(_PLACES):
        t, rate, quotient = found[0]
        raise ParameterError(
            argument,
            f"returns rates that contradict its values: {rate} at t = {t:.6g} s, where its values "
            f"change by {quotient} per second",
        )


def _contradiction(function: Any, t: float, length: float) -> tuple[Any, Any] | None:
    """Return a rate and the change of the values per second, if they differ over any span."""
    rate = np.asarray(function(t)[1], dtype=np.float64)
    found = None
    for span in _SPANS:
        h = span * length
        before, after = (np.asarray(function(at)[0], dtype=np.float64) for at in (t - h, t + h))
        quotient = (after - before) / (2.0 * h)
        size = max(np.abs(rate).max(), np.abs(quotient).max())
        if np.abs(quotient - rate).max() <= _AGREES * size:
            return None
        lost = np.finfo(float).eps * (np.abs(after).max() + abs(t) * size) / h
        if lost > _SAYS * size:
            break
        found = (rate.tolist(), quotient.round(9).tolist())
    return found
