"""How planes move."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.system import time_functions
from asperity.system.time_functions import Signal, TimeFunction


class PlaneMotion(Value):
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
    and is pickled only if Python can.

    Raises:
        ParameterError: naming the argument.

    >>> from asperity import Plane, PlaneMotion, Sine
    >>> table = Plane(motion=PlaneMotion(displacement=Sine([0.0, 0.0, 1e-3], frequency=50.0)))
    >>> table.motion.displacement.derivative(0.0).round(6).tolist()
    [0.0, 0.0, 0.314159]
    """

    displacement: Array | Signal | Callable[[float], tuple[ArrayLike, ArrayLike]] | None
    rotation: Array | float | Signal | Callable[[float], tuple[ArrayLike, ArrayLike]] | None

    def __init__(
        self,
        *,
        displacement: Signal | Callable[[float], tuple[ArrayLike, ArrayLike]] | None = None,
        rotation: Signal | Callable[[float], tuple[ArrayLike, ArrayLike]] | None = None,
    ) -> None:
        parts = {"displacement": displacement, "rotation": rotation}
        for argument, given in parts.items():
            if not (given is None or callable(given)):
                raise ParameterError(
                    argument, f"must be a Signal, a function or None, got {given!r}"
                )
            if isinstance(given, Signal) and given._core.jumps:
                raise ParameterError(argument, "must not jump: no velocity is that of a jump")
        self._set(**parts)


def checked(motion: PlaneMotion | None, shapes: tuple[tuple[int, ...], tuple[int, ...]]) -> Any:
    """Return a motion whose displacement and rotation have these shapes."""
    if motion is None:
        return None
    if not isinstance(motion, PlaneMotion):
        raise ParameterError("motion", f"must be a PlaneMotion or None, got {motion!r}")
    parts = (("displacement", motion.displacement), ("rotation", motion.rotation))
    for (argument, given), shape in zip(parts, shapes, strict=True):
        if given is not None:
            time_functions.checked(given, argument, shape)
    return motion


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
