"""Where the search for a limit cycle begins: motions that the belts drag along."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import asperity._core as _core
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.runs.model import Model
from asperity.steady_sliding import Stability
from asperity.steady_sliding.linearised.linearisation import INTERNAL

# Velocities to begin with, as multiples of those with which all contacts stick.
_SHARES = (1.0, -1.0, 3.0, -3.0)
# Displacement along the fastest growing mode, in m or rad, where nothing is dragged along.
_PUSH = 0.1


def starts(system: Model, state: Stability) -> Iterator[tuple[Array, Array]]:
    """Yield states (q, u) away from steady sliding, small deviations first."""
    q = state.equilibrium.q
    drag = dragged(system, q)
    if np.any(drag):
        yield from ((q, share * drag) for share in _SHARES)
    elif state.kind == "unstable":
        mode = state.modes[:, int(state.eigenvalues.real.argmax())].real
        yield q + _PUSH * mode / np.linalg.norm(mode), np.zeros(len(mode))
    else:
        raise ParameterError("q0", "must be given where nothing drags the system along")


def dragged(system: Model, q: Array) -> Array:
    """Return the velocities with which all contacts stick at `q`, or come nearest to it."""
    n = system.dof
    contacts = _core.evaluate(system._core, 0.0, q, np.zeros(n))["contacts"]
    rows = np.vstack([np.zeros((0, n)), *(contact["tangent"] for contact in contacts)])
    belts = np.concatenate([np.zeros(0), *(contact["velocity"] for contact in contacts)])
    return np.linalg.lstsq(rows, -belts, rcond=None)[0]


def longest_time(system: Model, state: Stability) -> float:
    """Return the longest period of the linearised system and the longest stick, together.

    Stick ends when the springs, stretched by the belts, have made up for friction.
    """
    frequencies = np.abs(state.eigenvalues.imag)
    frequencies = frequencies[frequencies > 1e-6 * frequencies.max(initial=0.0)]
    swing = 2.0 * np.pi / frequencies.min() if frequencies.size else 0.0
    contacts = state.contacts.values()
    friction = sum((np.abs(contact.state.W @ contact.force).sum() for contact in contacts), 0.0)
    springs = state.linearisation.stiffness[INTERNAL]
    pulled = float(np.abs(springs @ dragged(system, state.equilibrium.q)).sum())
    stick = 2.0 * friction / pulled if pulled > 0.0 else 0.0
    if not swing + stick > 0.0:
        raise ParameterError("t_end", "must be given: neither springs nor belts set a time scale")
    return float(swing + stick)
