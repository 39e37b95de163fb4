"""The state at the end of a run, from which another one goes on."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import (
    Given,
    Index,
    Number,
    Positive,
    Record,
    Vector,
    field,
    optional,
    shaped,
)
from asperity.errors import ParameterError
from asperity.status import Phase

_COLUMNS = 16


class State(Record):
    """Coordinates and velocities at a time, and what the contacts remember of the last step.

    ``trajectory.end`` is one. A run that starts from it continues the one before as if that had
    not ended: with the same options, what follows is the same to the bit, also where contacts have
    several solutions, since phases, slip directions and percussions are handed over; of sparse
    systems it is the same to rounding.
    ``State(q, u, t0=t)`` is one without memory: a fresh start at the time t. `replace` leaves the
    momenta out if it changes coordinates or velocities without them, since they follow from these.

    Args:
        q: coordinates, as those of a `Trajectory`.
        u: velocities.
        t0: time in s from which steps are counted.
        steps: number of steps since then.
        dt: their length in s, so that the state is that of t = t₀ + k Δt; ``None`` without steps.
        contacts: what the contacts remember, shape ``(n_contact, 16)``: whether closed (0 or 1),
            `Phase`, how many earlier slip velocities count (0, 1 or 2), three slip velocities with
            the latest first, four percussions. ``None`` if nothing is known of them.
        momenta: angular momenta in the world's axes of the rigid bodies of unequal moments, whose
            momenta are kept from step to step, shape ``(n, 3)``; ``None`` if they follow from the
            velocities. `simulate` refuses those of other velocities.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> first = simulate(block, dt=0.01, t_end=0.2, u0=[2.0, 0.0])
    >>> second = simulate(block, dt=0.01, t_end=0.3, start=first)
    >>> whole = simulate(block, dt=0.01, t_end=0.3, u0=[2.0, 0.0])
    >>> bool((second.q == whole.q[20:]).all())
    True
    """

    q: Vector
    u: Vector
    _: KW_ONLY
    t0: Number = 0.0
    steps: Index = 0
    dt: Positive | None = None
    contacts: Annotated[Given[ArrayLike | None, Array | None], _memory] = field(default=None)
    momenta: Annotated[Given[ArrayLike | None, Array | None], optional(shaped(None, 3))] = field(
        default=None
    )

    def _complete(self, given: dict[str, Any]) -> None:
        if given["steps"] and given["dt"] is None:
            raise ParameterError("dt", "must be given with steps")

    _is_result = True

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed, and momenta that follow from others left out.

        >>> thrown = State([0.0] * 7, [0.0] * 6, momenta=[[0.0, 0.0, 1.0]])
        >>> thrown.replace(u=[1.0] * 6).momenta is None, thrown.replace(t0=1.0).momenta is None
        (True, False)
        """
        if changes.keys() & {"q", "u"}:
            changes = {"momenta": None, **changes}
        return super().replace(**changes)

    @property
    def t(self) -> float:
        """Time in s."""
        return self.t0 if self.dt is None else self.t0 + self.steps * self.dt

    @property
    def phase(self) -> NDArray[np.int8]:
        """`Phase` of each contact as integers; without entries if nothing is known of them."""
        return np.array([] if self.contacts is None else self.contacts[:, 1], dtype=np.int8)

    def _arguments(self) -> tuple[tuple[float, int, float | None], Array, Array, Array, Array]:
        """Return the state as the core takes it."""
        clock = (self.t0, self.steps, self.dt)
        contacts = np.zeros((0, _COLUMNS)) if self.contacts is None else self.contacts
        momenta = np.zeros((0, 3)) if self.momenta is None else self.momenta
        return clock, self.q, self.u, contacts, momenta


def _memory(value: ArrayLike | None, argument: str) -> Array | None:
    """Return the table of a `State`; refuse what no contact remembers."""
    if value is None:
        return None
    contacts = arrays.array(value, argument, (None, _COLUMNS))
    for column, what, allowed in (
        (0, "whether a contact is closed, 0 or 1", (0, 1)),
        (1, "phases, -1, 0, 1 or 2", tuple(Phase)),
        (2, "numbers of earlier slips, 0, 1 or 2", (0, 1, 2)),
    ):
        wrong = ~np.isin(contacts[:, column], allowed)
        if wrong.any():
            found = float(contacts[wrong.argmax(), column])
            raise ParameterError(argument, f"must hold {what}, in column {column}, got {found:g}")
    return contacts
