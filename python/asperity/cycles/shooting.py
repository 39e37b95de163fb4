"""The return map of a section, and Newton's method for its fixed points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity._base.arrays import Array
from asperity.cycles.orbit import LimitCycle
from asperity.cycles.place import Place
from asperity.errors import NoCycleError
from asperity.runs.event_driven import integrate
from asperity.runs.model import Model
from asperity.runs.motion import Motion
from asperity.runs.section import Section

# Step of difference quotients relative to the scale of the states.
_FORWARD = 1e-6
_ITERATIONS = 15
# Where a step left this share of the defect, the next one goes with the same derivative.
_CHORD = 1e-2
# A return is looked for up to so many times the expected period.
_PATIENCE = 4.0


@dataclass(frozen=True)
class Return:
    """A state on the section, the time until the motion is there again, and how it got there."""

    state: Array
    period: float
    motion: Motion


@dataclass(frozen=True)
class ReturnMap:
    """P: x ↦ the state in which the motion from x = (q, u) returns to the section.

    Only returns later than `share` of the expected period count, so that orbits with loops are
    followed once around.
    """

    system: Model
    section: Section
    scale: Array
    """Size of each state component on the orbit."""
    tolerance: float
    share: float = 0.75

    def __call__(self, state: Array, period: float, *, dt: float | None = None) -> Return:
        """Return P(x) for a motion that is expected to take about `period`.

        Raises:
            NoCycleError: if the motion does not return.
        """
        n = len(state) // 2
        motion = integrate(
            self.system,
            t_end=_PATIENCE * period,
            q0=state[:n],
            u0=state[n:],
            tolerance=self.tolerance,
            section=self.section.replace(after=self.share * period),
            sample_every=dt,
        )
        if not motion.at_section:
            raise NoCycleError(
                f"the motion does not return to the section within {motion.t[-1]:.6g} s"
            )
        end = np.concatenate([motion.q[-1], motion.u[-1]])
        return Return(end, float(motion.t[-1]), motion)

    def defect(self, state: Array, image: Array) -> float:
        """Return ‖P(x) − x‖ relative to the scale of the states."""
        return float(np.abs((image - state) / self.scale).max())

    def place(self, image: Return) -> Place:
        """Return the part of the section in which x ↦ `image` begins."""
        return Place.of(self.system, self.section, self.scale, image.motion)

    def jacobian(self, state: Array, image: Return, step: float = _FORWARD) -> Array:
        """Return ∂P/∂x in the coordinates of the place's tangents, by one-sided differences."""
        place = self.place(image)
        directions = place.tangents(state)
        columns = np.zeros(directions.shape)
        for k, direction in enumerate(directions.T):
            end = self(place.onto(state + step * direction), image.period).state
            columns[:, k] = (end - image.state) / step
        return np.asarray(np.linalg.pinv(directions) @ columns, dtype=np.float64)


def fixed_point(
    returns: ReturnMap, state: Array, period: float, tolerance: float, near: LimitCycle | None
) -> tuple[Return, int]:
    """Return the fixed point of P near `state` and the number of steps.

    Where det(1 − P′) has another sign than on the branch of the cycle `near`, Newton's method would
    go to another branch: the motion itself is followed instead, for a turn.

    Raises:
        NoCycleError: if Newton's method does not converge or the motion does not return.
    """
    here, image = state, returns(state, period)
    before, jacobian = np.inf, np.zeros((0, 0))
    for iteration in range(_ITERATIONS):
        defect = returns.defect(here, image.state)
        if defect <= tolerance:
            return Return(here, image.period, image.motion), iteration
        directions = returns.place(image).tangents(here)
        if defect > _CHORD * before or len(jacobian) != directions.shape[1]:
            jacobian = returns.jacobian(here, image)
        before = defect
        matrix = np.eye(len(jacobian)) - jacobian
        if near is not None and (np.linalg.det(matrix) > 0.0) != near._is_positive:
            here, image = image.state, returns(image.state, image.period)
            continue
        change = np.linalg.lstsq(
            matrix, np.linalg.pinv(directions) @ (image.state - here), rcond=1e-10
        )[0]
        here, image = _step(returns, here, image, directions @ change, defect)
    raise NoCycleError(
        f"Newton's method for the periodic orbit ends {defect:.3g} off after {_ITERATIONS} steps"
    )


def _step(
    returns: ReturnMap, here: Array, image: Return, change: Array, defect: float
) -> tuple[Array, Return]:
    """Take the longest of the Newton steps 1, ½, ¼, … that comes closer, else follow the motion."""
    place = returns.place(image)
    for halvings in range(5):
        there = place.onto(here + change * 0.5**halvings)
        try:
            moved = returns(there, image.period)
        except NoCycleError:
            continue
        if returns.defect(there, moved.state) < defect:
            return there, moved
    # The orbit may have lost or won a phase on the way; the motion itself tells.
    return image.state, returns(image.state, image.period)
