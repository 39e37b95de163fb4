"""Whether a list of eigenvalues within a circle is complete, by the argument principle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity.errors import ConvergenceError
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse.nearest import are_new, nearest
from asperity.steady_sliding.sparse.pencil import SparsePencil
from asperity.system.sparse.factorisation import SingularMatrixError

# Points on the circle at first and at most.
_POINTS, _MOST = 12, 96
# Phase in rad that eigenvalues outside the circle may leave unexplained. A missing one inside
# leaves 0.72 at one of 12 points at least, several 0.25 in the worst places that were found.
_EXPLAINED = 0.2
# Searches for missing eigenvalues between two refinements, and eigenvalues asked for by each; the
# second number where the first holds none that is new.
_SEARCHES, _NEIGHBOURS = 6, (4, 16)
# Radius, relative to the centre, of a circle about a shift on a multiple eigenvalue: rounding.
_POINT = 1e-10
# Places in the circle where a missing eigenvalue is assumed, along and across.
_PLACES = 48


@dataclass(frozen=True)
class Circle:
    """A circle in the plane of eigenvalues, in 1/s."""

    centre: complex
    radius: float

    def holds(self, values: Complex) -> NDArray[np.bool_]:
        """Return which eigenvalues are inside."""
        return np.abs(values - self.centre) <= self.radius


@dataclass(frozen=True, eq=False)
class Certificate:
    """What the argument principle says of a list of eigenvalues within circles.

    Attributes:
        circles: where eigenvalues were counted.
        missing: eigenvalues inside that the list lacked, in 1/s.
        is_conclusive: whether list and missing ones together explain the phase of det P.
        factorisations: how many this took.
    """

    circles: tuple[Circle, ...]
    missing: Complex
    is_conclusive: bool
    factorisations: int

    @property
    def is_complete(self) -> bool:
        """Whether no eigenvalue is missing."""
        return self.is_conclusive and not len(self.missing)

    def summary(self) -> str:
        """Return whether an eigenvalue is missing."""
        where = f"within {counted(len(self.circles), 'circle')}"
        cost = f"by {counted(self.factorisations, 'factorisation')}"
        if self.is_complete:
            return f"The argument principle finds no eigenvalue missing {where}, {cost}."
        if self.is_conclusive:
            number = counted(len(self.missing), "eigenvalue")
            return f"The list lacked {number} {where}: {self.missing.tolist()}, found {cost}."
        return f"The count {where} is not conclusive, {cost}: an eigenvalue may be missing."

    def joined(self, other: Certificate, pencil: SparsePencil) -> Certificate:
        """Return the certificate of both."""
        new = are_new(pencil, other.missing, self.missing)
        return Certificate(
            self.circles + other.circles,
            np.concatenate([self.missing, other.missing[new]]),
            self.is_conclusive and other.is_conclusive,
            self.factorisations + other.factorisations,
        )


def certified(pencil: SparsePencil, known: Complex, circle: Circle) -> Certificate:
    """Count the eigenvalues within a circle that a list lacks.

    f(s) = det P(s)/Π(s − sᵢ) has no zeros but missing eigenvalues. If none is inside, log f is
    analytic there, and log|f| on the circle determines the phase of f, whatever its rate; each
    zero inside adds a turn, that of a Blaschke factor, which is seen modulo 2π at the points. Where
    phases do not agree, eigenvalues are looked for at the place that explains them best: a missing
    one is named, never inferred from a number.
    """
    if circle.radius <= _POINT * (abs(circle.centre) + circle.radius):
        return Certificate((circle,), known[:0], False, 0)
    listed, known = known, _with_conjugates(pencil, known)
    measured = _Measured(pencil, circle, _POINTS)
    missing: list[complex] = known[len(listed) :].tolist()
    while True:
        for _ in range(_SEARCHES):
            angles, logs = measured.without(known)
            place = _unexplained(circle, angles, logs)
            if place is None:
                inside = np.array(missing, dtype=np.complex128)
                inside = inside[circle.holds(inside)]
                return Certificate((circle,), inside, True, measured.factorisations)
            found = known[:0]
            for count in _NEIGHBOURS:
                if not len(found):
                    found = _found_at(pencil, place, known, count)
                    measured.factorisations += 1
            if not len(found):
                break
            missing += found.tolist()
            known = _with_conjugates(pencil, np.concatenate([known, found]))
        if 2 * measured.count > _MOST:
            inside = np.array(missing, dtype=np.complex128)
            inside = inside[circle.holds(inside)]
            return Certificate((circle,), inside, False, measured.factorisations)
        measured.refine()


class _Measured:
    """log det P at equidistant points of a circle."""

    def __init__(self, pencil: SparsePencil, circle: Circle, count: int) -> None:
        self.pencil, self.circle, self.count = pencil, circle, count
        self.factorisations = 0
        self.logs = np.array([self._log(k / count) for k in range(count)])

    @property
    def points(self) -> Complex:
        return self._point(np.arange(self.count) / self.count)

    def without(self, known: Complex) -> tuple[Array, Complex]:
        """Return the angles of the points and log f."""
        logs = self.logs - np.log(self.points[:, None] - known).sum(axis=1)
        return 2.0 * np.pi * np.arange(self.count) / self.count, logs

    def refine(self) -> None:
        """Put a point between every two."""
        between = [self._log((k + 0.5) / self.count) for k in range(self.count)]
        self.logs = np.stack([self.logs, between], axis=1).ravel()
        self.count *= 2

    def _point(self, turn: Array) -> Complex:
        return self.circle.centre + self.circle.radius * np.exp(2j * np.pi * turn)

    def _log(self, turn: float) -> complex:
        self.factorisations += 1
        point = complex(self._point(np.array(turn)))
        try:
            return self.pencil.factorised(point).log_determinant()
        except SingularMatrixError:
            # An eigenvalue to rounding: the smallest of numbers in place of zero.
            return complex(np.log(np.finfo(float).tiny))


def _unexplained(circle: Circle, angles: Array, logs: Complex) -> complex | None:
    """Return where a missing eigenvalue is most likely, None if none is missing."""
    turns = unexplained_phases(angles, logs)
    if np.abs(turns).max() <= _EXPLAINED:
        return None
    across = np.linspace(-1.05, 1.05, _PLACES)
    places = (across[:, None] + 1j * across).ravel()
    places = places[np.abs(places) <= 1.05]
    points = np.exp(1j * angles)
    cleared = logs - np.log(points - places[:, None])
    left = (unexplained_phases(angles, cleared) ** 2).sum(axis=-1)
    best = complex(places[int(left.argmin())])
    return circle.centre + circle.radius * best


def unexplained_phases(angles: Array, logs: Complex) -> Array:
    """Return the phases at the points that log|f| does not explain, between −π and π."""
    count = logs.shape[-1]
    waves = np.fft.fft(logs.real, axis=-1)
    # Of an analytic function the real part determines the imaginary one up to a constant.
    waves[..., 0] = 0.0
    waves[..., count // 2 :] = 0.0
    phase = 2.0 * np.fft.ifft(waves, axis=-1).imag
    turned = np.exp(1j * (logs.imag - phase))
    mean = turned.mean(axis=-1, keepdims=True)
    return np.angle(turned * mean.conj() + (mean == 0.0))


def _found_at(pencil: SparsePencil, place: complex, known: Complex, count: int) -> Complex:
    """Return eigenvalues near a place that are not known."""
    try:
        values = nearest(pencil, place, count)[0].values
    except ConvergenceError:
        return np.zeros(0, dtype=np.complex128)
    return values[are_new(pencil, values, known)]


def _with_conjugates(pencil: SparsePencil, values: Complex) -> Complex:
    """Add the conjugates that real matrices have with each eigenvalue."""
    others = values.conj()
    return np.concatenate([values, others[are_new(pencil, others, values)]])
