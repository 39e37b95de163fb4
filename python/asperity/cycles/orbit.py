"""A limit cycle and what is known of it."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table
from asperity._base.storage.data import Kinds
from asperity._base.storage.result_file import SavedResult
from asperity._base.value import Given, Record
from asperity.errors import ParameterError
from asperity.runs import origin
from asperity.runs.event import Event
from asperity.runs.motion import Motion
from asperity.runs.section import Section
from asperity.status import Phase
from asperity.system.labels import Labels

_VERBS = {Phase.STICK: "sticks", Phase.SLIP: "slips", Phase.OPEN: "is open"}
# Coordinates and contacts of which a summary tells.
_TOLD = 8


def _complex(value: ArrayLike, argument: str) -> NDArray[np.complex128]:
    values = np.array(value, dtype=complex)
    arrays.check_shape(values, argument, (None,))
    return values


class LimitCycle(SavedResult, Record):
    """An isolated periodic motion x(t + T) = x(t), found by `limit_cycle`.

    Attributes:
        period: T in s.
        motion: one period, which begins and ends on the section; shows with the functions of
            `asperity.plot`.
        section: the section.
        multipliers: Floquet multipliers, the 2n − 1 eigenvalues of the return map's derivative, by
            falling modulus; a motion with stick has zeros among them.
        residual: ‖P(x) − x‖ relative to the orbit's extent.
        iterations: of Newton's method.
    """

    period: float
    motion: Motion
    section: Section
    multipliers: Annotated[Given[ArrayLike, NDArray[np.complex128]], _complex]
    _: KW_ONLY
    residual: float
    iterations: int

    _picture = "plot_history"

    @property
    def is_stable(self) -> bool:
        """Whether all Floquet multipliers lie within the unit circle."""
        return bool(np.abs(self.multipliers).max(initial=0.0) < 1.0)

    @property
    def _is_positive(self) -> bool:
        """Whether det(1 − P′) = ∏(1 − λ) > 0: a branch of cycles keeps it until it turns back."""
        return bool(np.prod(1.0 - self.multipliers).real > 0.0)

    @property
    def minimum(self) -> Array:
        """Least value of each coordinate, shape ``(n,)``."""
        return _extremes(self.motion)[0]

    @property
    def maximum(self) -> Array:
        """Greatest value of each coordinate, shape ``(n,)``."""
        return _extremes(self.motion)[1]

    def phases(self, contact: int = 0) -> tuple[tuple[Phase, float], ...]:
        """Return the phases of a contact in their order from the section on, with durations in s.

        The first and the last are parts of one phase if they are alike.
        """
        number = arrays.count(contact, "contact", least=0)
        if number >= (contacts := self.motion.phase.shape[1]):
            raise ParameterError("contact", f"must be below {contacts}, got {number}")
        changes = [e for e in self.motion.events if e.contact == number and e.phase is not None]
        times = [0.0, *(event.time for event in changes), self.period]
        kinds = [Phase(int(self.motion.phase[0, number])), *(event.phase for event in changes)]
        lengths = np.diff(times)
        joined: list[tuple[Phase, float]] = []
        for kind, length in zip(kinds, lengths, strict=True):
            assert kind is not None
            if joined and joined[-1][0] == kind:
                joined[-1] = (kind, joined[-1][1] + float(length))
            else:
                joined.append((kind, float(length)))
        return tuple(joined)

    def share(self, phase: Phase, *, contact: int = 0) -> float:
        """Return the share of the period that a contact spends in a phase.

        Reference: [WL19] §4.3, Fig. 17.
        """
        return sum(length for kind, length in self.phases(contact) if kind == phase) / self.period

    def summary(self) -> str:
        """Return period, stability, extent and phases in sentences."""
        kind = "stable" if self.is_stable else "unstable"
        largest = np.abs(self.multipliers).max(initial=0.0)
        lines = [
            f"The limit cycle is {kind}: it repeats after {self.period:.9g} s, and a small "
            f"disturbance is multiplied by at most {largest:.3g} in each period."
        ]
        names, units = self.motion.coordinate_names, self.motion.coordinate_units
        ranges = zip(names, units, self.minimum.tolist(), self.maximum.tolist(), strict=False)
        for name, unit, low, high in list(ranges)[:_TOLD]:
            lines.append(f"{name} moves between {low:.6g} and {high:.6g} {unit}.")
        for number, name in list(enumerate(self.motion.contact_names))[:_TOLD]:
            shares = {verb: self.share(phase, contact=number) for phase, verb in _VERBS.items()}
            told = ", ".join(f"{verb} {share:.1%}" for verb, share in shares.items() if share > 0.0)
            lines.append(f"{name}: {told} of the period.")
        return "\n".join(lines)

    def _table(self) -> Table:
        """Return the table of the motion, with the multipliers beside it."""
        table = self.motion._table()
        axis = Axis(np.arange(len(self.multipliers)), "", "number of the multiplier")
        parts = {"real": self.multipliers.real, "imaginary": self.multipliers.imag}
        series = {
            f"multiplier_{name}": Series(part, ("multiplier",), "-", f"{name} part of a multiplier")
            for name, part in parts.items()
        }
        facts = {"period": self.period, "stable": int(self.is_stable)}
        return Table(
            {**table.axes, "multiplier": axis}, {**table.series, **series}, {**table.facts, **facts}
        )

    @classmethod
    def _known(cls) -> Kinds:
        return KNOWN

    def __repr__(self) -> str:
        kind = "stable" if self.is_stable else "unstable"
        return (
            f"<LimitCycle: {kind}, period {self.period:.9g} s, "
            f"largest multiplier {np.abs(self.multipliers).max(initial=0.0):.3g}>"
        )


KNOWN: Kinds = {
    **origin.KNOWN,
    **{one.__name__: one for one in (LimitCycle, Motion, Event, Section, Labels)},
}
"""Classes that a limit cycle is made of."""


def _extremes(motion: Motion) -> tuple[Array, Array]:
    """Return the extremes of the cubics through samples and velocities, exact to O(Δt⁴)."""
    q, u, steps = motion.q, motion.u, np.diff(motion.t)[:, None]
    lower, upper = q.min(axis=0), q.max(axis=0)
    rising, falling = u[:-1] * steps, u[1:] * steps
    # q(s) = q₀ + s u₀ + s² (3Δ − 2u₀ − u₁) + s³ (u₀ + u₁ − 2Δ), 0 ≤ s ≤ 1.
    delta = np.diff(q, axis=0)
    square, cube = 3.0 * delta - 2.0 * rising - falling, rising + falling - 2.0 * delta
    turning = rising * falling < 0.0
    for step, j in np.argwhere(turning):
        roots = np.roots([3.0 * cube[step, j], 2.0 * square[step, j], rising[step, j]])
        s = roots[np.isreal(roots)].real
        s = s[(s > 0.0) & (s < 1.0)]
        values = q[step, j] + s * (rising[step, j] + s * (square[step, j] + s * cube[step, j]))
        lower[j] = min(lower[j], values.min(initial=np.inf))
        upper[j] = max(upper[j], values.max(initial=-np.inf))
    return arrays.read_only(lower), arrays.read_only(upper)
