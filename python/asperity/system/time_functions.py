"""Functions of time: signals as values, and functions of the user."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Check, Given, Value
from asperity.errors import DimensionError, ParameterError

# What `breaks` lists at most: their memory is that of a small computer.
_MOST_BREAKS = 10_000_000


class Signal(Value):
    """A function of time through samples, with straight lines or cubic splines between them.

    A time that is given twice is a jump from the first of its values to the second. Outside of its
    samples a signal keeps the first and the last value; a periodic one repeats itself. `integrate`
    ends its steps at the samples, so that signals cost it no accuracy.

    Args:
        times: in s, ascending, two different ones at least; shape ``(n,)``. The first and the last
            one are not jumps.
        values: shape ``(n,)`` for a number, ``(n, d)`` for a vector.
        interpolation: ``"linear"``: straight lines; or ``"cubic"``: splines with two continuous
            derivatives between jumps. Their third derivative is continuous at the second and at the
            last but one sample; a periodic spline that begins and ends with one value is as smooth
            there as elsewhere.
        periodic: whether the last sample is the first one of the next period.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [DeBoor2001] ch. IV.

    >>> from asperity import Signal
    >>> ramp = Signal([0.0, 1.0, 3.0], [0.0, 2.0, 2.0], interpolation="linear")
    >>> ramp([-1.0, 0.25, 2.0, 9.0]).tolist()
    [0.0, 0.5, 2.0, 2.0]
    >>> ramp.derivative(0.25).item(), ramp.integral(0.0, 2.0).item()
    (2.0, 3.0)
    """

    times: Array
    values: Array
    interpolation: str
    periodic: bool
    shape: tuple[int, ...]
    """Of a value: ``()`` or ``(d,)``."""
    _core: _core.Signal

    def __init__(
        self,
        times: ArrayLike,
        values: ArrayLike,
        *,
        interpolation: Literal["linear", "cubic"],
        periodic: bool = False,
    ) -> None:
        at = arrays.array(times, "times", (None,))
        if len(at) == 0:
            raise DimensionError("times", "must not be empty")
        given = arrays.array(values, "values")
        if given.ndim not in (1, 2) or len(given) != len(at):
            raise DimensionError(
                "values", f"must have shape ({len(at)},) or ({len(at)}, d), got {given.shape}"
            )
        arrays.choice(interpolation, "interpolation", ["linear", "cubic"])
        self._set(times=at, values=given, interpolation=interpolation, periodic=bool(periodic))
        rows = given.reshape(len(at), -1)
        core = _core.Signal.linear(at, rows, self.periodic)
        if interpolation == "cubic":
            core = _splines(at, rows, self.periodic)
        self._keep(_core=core, shape=given.shape[1:])

    def __call__(self, t: ArrayLike) -> Array:
        """Return the values at times t in s, shape ``t.shape + shape``; at a jump the second one.

        Args:
            t: of any shape.
        """
        return self._at(t, 0)

    def derivative(self, t: ArrayLike, *, order: Literal[1, 2] = 1) -> Array:
        """Return a derivative at times t in s, per sⁿ; at a kink that of what comes next.

        Args:
            t: of any shape.
            order: n, 1 or 2.
        """
        if order not in (1, 2):
            raise ParameterError("order", f"must be 1 or 2, got {order!r}")
        return self._at(t, order)

    def integral(self, start: float, end: float) -> Array:
        """Return the integral from `start` to `end`, in the unit of the values times s.

        Args:
            start: in s.
            end: in s.
        """
        whole = self._core.integral(arrays.number(start, "start"), arrays.number(end, "end"))
        return whole.reshape(self.shape)[()]

    def breaks(self, start: float, end: float) -> Array:
        """Return the times after `start` and up to `end` where it or its derivatives jump.

        Jumps of a third derivative, those at the other samples of a spline, are left out.

        Args:
            start: in s.
            end: in s.

        Raises:
            ParameterError: ``end`` lies more than ten million of them away.

        >>> from asperity import Signal
        >>> saw = Signal([0.0, 1.0, 1.5], [0.0, 1.0, 0.0], interpolation="linear", periodic=True)
        >>> saw.breaks(0.0, 3.0).tolist()
        [1.0, 1.5, 2.5, 3.0]
        """
        first, last = arrays.number(start, "start"), arrays.number(end, "end")
        found = self._core.breaks(first, last, _MOST_BREAKS + 1)
        if len(found) > _MOST_BREAKS:
            message = f"must be nearer to start, within {_MOST_BREAKS} samples, got {last}"
            raise ParameterError("end", message)
        return np.array([time for time, is_kink in found if is_kink])

    @property
    def period(self) -> float | None:
        """In s; ``None`` of what is not periodic."""
        return self._core.period

    def _at(self, t: ArrayLike, order: int) -> Array:
        times = arrays.array(t, "t")
        values = self._core.values(times.reshape(-1), order)
        return values.reshape(times.shape + self.shape)[()]


def _splines(times: Array, values: Array, periodic: bool) -> _core.Signal:
    """Return cubic splines between jumps, not-a-knot or periodic."""
    from scipy.interpolate import CubicSpline

    starts = np.flatnonzero(np.diff(times, prepend=np.nan) == 0.0)
    closes = periodic and len(starts) == 0 and np.array_equal(values[0], values[-1])
    with np.errstate(all="ignore"):
        parts = [
            CubicSpline(own, rows, bc_type="periodic" if closes else "not-a-knot").c
            for own, rows in zip(np.split(times, starts), np.split(values, starts), strict=True)
        ]
    # From (power, piece, component), highest power first.
    coefficients = np.concatenate(parts, axis=1)[::-1].transpose(1, 2, 0)
    if not np.isfinite(coefficients).all():
        raise ParameterError("values", "must not change beyond the range of numbers")
    return _core.Signal.cubic(np.unique(times), coefficients.ravel(), values[-1], periodic)


class Sine(Signal):
    """The signal a₀ + a sin(2π f t + φ), exactly.

    `integrate` goes through a period in eight steps at least, so that it misses nothing of it.

    Args:
        amplitude: a, a number or shape ``(d,)`` for a vector.
        frequency: f > 0 in Hz.
        phase: φ in rad, a number or shape ``(d,)``.
        offset: a₀, a number or shape ``(d,)``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import Sine
    >>> (
    ...     float(Sine(2.0, frequency=50.0)(0.005).round(12)),
    ...     Sine([1.0, 0.5], frequency=50.0).derivative(0.0).round(3).tolist(),
    ... )
    (2.0, [314.159, 157.08])
    """

    amplitude: Array | float
    frequency: float
    phase: Array | float
    offset: Array | float

    def __init__(
        self,
        amplitude: ArrayLike,
        *,
        frequency: float,
        phase: ArrayLike = 0.0,
        offset: ArrayLike = 0.0,
    ) -> None:
        parts = {"amplitude": amplitude, "phase": phase, "offset": offset}
        given = {name: arrays.array(value, name) for name, value in parts.items()}
        shape: tuple[int, ...] = ()
        for name, array in given.items():
            if array.ndim > 1 or (() not in (shape, array.shape) and array.shape != shape):
                wanted = shape or "(d,)"
                raise DimensionError(
                    name, f"must be a number or of shape {wanted}, got {array.shape}"
                )
            shape = shape or array.shape
        kept = {name: float(array) if array.ndim == 0 else array for name, array in given.items()}
        self._set(
            amplitude=kept["amplitude"],
            frequency=arrays.positive(frequency, "frequency"),
            phase=kept["phase"],
            offset=kept["offset"],
        )
        wide = [np.array(np.broadcast_to(given[name], shape)).reshape(-1) for name in parts]
        self._keep(_core=_core.Signal.sine(self.frequency, *wide), shape=shape)


TimeFunction: TypeAlias = ArrayLike | Signal | Callable[[float], ArrayLike]
"""A value that may depend on time: numbers, a `Signal`, or a function of t in s that returns them.

A function is called while the interpreter is held, in any order of times, by `simulate` also
shortly beyond the end. It must be smooth from 0 on, else give a `Signal`. What holds it equals what
holds the same function, and is pickled only if the function can be."""


def checked(value: Any, argument: str, shape: tuple[int, ...]) -> Any:
    """Return numbers of a shape, a signal of that shape, or a function."""
    if isinstance(value, Signal):
        if value.shape != shape:
            raise DimensionError(
                argument, f"must have values of shape {shape}, the signal's have {value.shape}"
            )
        return value
    if callable(value):
        return value
    return arrays.array(value, argument, shape) if shape else arrays.number(value, argument)


def core(value: Any) -> Any:
    """Return what the core takes for a function of time."""
    return value._core if isinstance(value, Signal) else value


def of_time(*shape: int) -> Check:
    """Return the check of numbers of a shape that may change with time."""
    return lambda value, name: checked(value, name, shape)


_Changing: TypeAlias = Array | Signal | Callable[[float], ArrayLike]
Changing1: TypeAlias = Annotated[
    Given[TimeFunction, float | Signal | Callable[[float], ArrayLike]], of_time()
]
Changing2: TypeAlias = Annotated[Given[TimeFunction, _Changing], of_time(2)]
Changing3: TypeAlias = Annotated[Given[TimeFunction, _Changing], of_time(3)]
"""Fields that hold numbers, signals or functions."""
