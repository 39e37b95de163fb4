"""Simulated paths of many launches at once."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.ensemble import Ensemble, integrate_many, simulate_many
from asperity.errors import ParameterError
from asperity.identify.evidence.paths.launch import DIRECTION, PLACE, SPEED, TIME
from asperity.law import FrictionLaw, Stribeck
from asperity.runs.comparison import hermite
from asperity.runs.model import Model, laws_of
from asperity.runs.time_stepping import beginning

# So many samples of a path lie between its launch and its last measured point; cubics between them
# are wrong by a millionth of its length.
_SAMPLES = 100


class Simulated(NamedTuple):
    """A simulated path at the measured times.

    Attributes:
        position: in m, ``(n, 2)``.
        velocity: in m/s, ``(n, 2)``; zero before the launch.
    """

    position: Array
    velocity: Array


class Motions:
    """Paths of a body that is launched on a system, whatever the law of its contacts.

    The first two coordinates and velocities are those of the measured point; all others start as
    the system says.

    Args:
        system: the body on its support; the law of its contacts is replaced.
        times: measured times of the paths in s.
        tolerance: of the integration.
        dt: step of time stepping in s instead of it.
    """

    def __init__(
        self, system: Model, times: Sequence[Array], tolerance: float, dt: float | None
    ) -> None:
        self.system = system
        self.times = times
        self._tolerance, self._dt = tolerance, dt
        self._law_name = law_name(system)
        start = beginning(system, None, None, None)
        self._q, self._u = start.q, start.u
        self.law = laws_of(system)[0]

    def paths(
        self,
        laws: Sequence[FrictionLaw],
        launches: Array,
        which: Sequence[int],
        rate: Stribeck | None = None,
    ) -> list[Simulated] | None:
        """Return paths at the measured times; None if a motion could not be found.

        Args:
            laws: one for every motion.
            launches: speed, direction, time and place of each, ``(m, 5)``.
            which: of the measured paths each stands beside.
            rate: factor of the speed; default that of the system.
        """
        rate = self.law.rate if rate is None else rate
        if not (np.isfinite(launches).all() and (launches[:, SPEED] > 0.0).all()):
            return None
        last = max(
            float(self.times[k][-1]) - one[TIME] for k, one in zip(which, launches, strict=True)
        )
        if last <= 0.0:
            return None
        result = [Simulated(np.empty(0), np.empty(0))] * len(launches)
        for own, members in _alike(laws):
            rated = [law if rate is None else law.replace(rate=rate) for law in own]
            many = self._many(rated, launches[members], last)
            if many.failures:
                return None
            series = [many.samples[name] for name in ("t", "q", "u")]
            for index, m in np.ndenumerate(members):
                known = np.isfinite(series[0][index])
                t, q, u = (one[index][known] for one in series)
                at = self.times[which[int(m)]] - launches[m, TIME]
                velocity = [np.interp(at, t, u[:, i], left=0.0) for i in (0, 1)]
                result[m] = Simulated(
                    hermite(t, q[:, :2], u[:, :2], at), np.stack(velocity, axis=-1)
                )
        return result

    def _many(self, laws: Sequence[FrictionLaw], launches: Array, last: float) -> Ensemble:
        """Return motions up to a time, ``(..., laws)``."""
        speed, angle = launches[..., SPEED], launches[..., DIRECTION]
        q0 = np.broadcast_to(self._q, (*speed.shape, len(self._q))).copy()
        u0 = np.broadcast_to(self._u, (*speed.shape, len(self._u))).copy()
        q0[..., :2] = launches[..., PLACE]
        u0[..., :2] = speed[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        given: dict[str, Any] = {"q0": q0, "u0": u0, "replace": {self._law_name: list(laws)}}
        if self._dt is None:
            every = last / _SAMPLES
            return integrate_many(
                self.system, t_end=last, keep=every, tolerance=self._tolerance, **given
            )
        steps = max(math.ceil(last / self._dt), 1)
        return simulate_many(
            self.system,
            dt=self._dt,
            t_end=steps * self._dt,
            keep=max(steps // _SAMPLES, 1),
            until_rest=True,
            **given,
        )


def _alike(
    laws: Sequence[FrictionLaw],
) -> Iterator[tuple[list[FrictionLaw], NDArray[np.intp]]]:
    """Yield laws of equally many motions, with these, ``(motions, laws)``: each is made once."""
    members: dict[int, list[int]] = {}
    for m, law in enumerate(laws):
        members.setdefault(id(law), []).append(m)
    for count in sorted({len(own) for own in members.values()}):
        own = [one for one in members.values() if len(one) == count]
        yield [laws[one[0]] for one in own], np.array(own).T


def law_name(system: Any) -> str:
    """Return the name under which an ensemble replaces the law of all contacts."""
    if not isinstance(system, Model):
        raise ParameterError("system", f"must be a system, got {system!r}")
    laws = laws_of(system)
    if not laws or any(law.dimension != 2 for law in laws) or system.dof < 2:
        raise ParameterError(
            "system", f"must slide in the plane with planar laws of friction, got {system!r}"
        )
    if isinstance(getattr(system, "law", None), FrictionLaw):
        return "law"
    return "pairs[*].law" if hasattr(system, "pairs") else "contacts[*].law"
