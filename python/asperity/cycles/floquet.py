"""Floquet multipliers, and whether a periodic orbit is isolated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.cycles.shooting import Return, ReturnMap
from asperity.errors import NoCycleError
from asperity.runs.motion import Motion

Complex = NDArray[np.complex128]

# The multipliers are found by central differences of motions that are integrated as sharply as
# this, with steps relative to the scale of the states.
_SHARP, _ASIDE = 1e-13, 1e-5
# Their error is about the square of what the two sides differ by, which falls with the step:
# shorter ones keep it below 1e-6, down to where rounding takes over.
_SIDES, _SHORTEST = 1e-3, 1e-6
# A multiplier that is one to this accuracy belongs to a continuum of periodic orbits.
_ISOLATED = 1e-4
# Orbits that are by this share smaller or larger are tried; one that returns to within this part of
# its distance from the first is periodic, too.
_NEXT, _TURNS, _RETURNED = 0.05, 4, 1e-3


def multipliers(returns: ReturnMap, fixed: Return, tolerance: float) -> Complex:
    """Return the multipliers by falling modulus.

    Raises:
        NoCycleError: if there are periodic orbits next to this one.
    """
    sharp = replace(returns, tolerance=_SHARP)
    derivative, apart = _central(sharp, fixed, _ASIDE)
    if apart > _SIDES:
        step = max(_ASIDE * _SIDES / apart, _SHORTEST)
        derivative, apart = _central(sharp, fixed, step)
    known = np.linalg.eigvals(derivative)
    isolated = np.abs(known - 1.0).min(initial=np.inf) >= _ISOLATED
    # Where the return map has a derivative, its eigenvalues show a continuum.
    if not isolated or (apart > _SIDES and _has_neighbours(returns, fixed, tolerance)):
        raise NoCycleError(f"periodic orbits form a continuum, of period {fixed.period:.6g} s")
    # Deviations from contacts that stay closed or stick are gone at the next turn.
    whole = np.zeros(len(fixed.state) - 1, dtype=complex)
    whole[: len(known)] = known[np.argsort(-np.abs(known), kind="stable")]
    return whole


def _central(returns: ReturnMap, fixed: Return, step: float) -> tuple[Array, float]:
    """Return the derivative of the return map, and by how much those to both sides differ."""
    ahead, behind = (returns.jacobian(fixed.state, fixed, aside) for aside in (step, -step))
    return 0.5 * (ahead + behind), float(np.abs(ahead - behind).max(initial=0.0))


def _has_neighbours(returns: ReturnMap, fixed: Return, tolerance: float) -> bool:
    """Whether a slightly smaller or larger orbit is periodic, too.

    One that is back within the tolerance has been attracted, however little it moves from there.
    The largest of the harmonic motions along γ is the rim of a continuum, where derivatives to
    both sides differ: multipliers do not show that.
    """
    middle, place = _mean(fixed.motion), returns.place(fixed)
    for share in (1.0 - _NEXT, 1.0 + _NEXT):
        last = state = place.onto(middle + share * (fixed.state - middle))
        for _ in range(_TURNS):  # what decays quickly has to be gone
            last, state = state, returns(state, fixed.period).state
        apart = returns.defect(state, fixed.state)
        if apart > tolerance and returns.defect(last, state) < _RETURNED * apart:
            return True
    return False


def _mean(motion: Motion) -> Array:
    """Return the mean state of a motion that is sampled densely."""
    states = np.concatenate([motion.q, motion.u], axis=1)
    # NumPy has called this `trapezoid` since 2.0, and no longer by its older name.
    means = (states[1:] + states[:-1]) / 2.0
    return (np.diff(motion.t)[:, None] * means).sum(axis=0) / motion.t[-1]
