"""The ends of many runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity._base.result import NO_UNIT, counted
from asperity.ensemble.result import AnyEnsemble, Meaning
from asperity.runs.run import Run
from asperity.status import Outcome

OUTCOMES = (
    Outcome.FINISHED,
    Outcome.AT_REST,
    Outcome.SECTION,
    Outcome.FAILED,
    Outcome.INTERRUPTED,
)
"""The outcomes by their number in the core; an interrupted run has the last one."""


class Ensemble(AnyEnsemble):
    """The ends of many runs, and what was asked for of the way; made by `simulate_many`.

    Arrays begin with the axes of the ensemble, those to which start states and replaced values were
    broadcast; what there is not is NaN, as in runs that failed before their first step, or in a
    step that could not be made.

    Attributes:
        status: how each run ended, `Outcome` as words.
        shape: of the ensemble.
        t: time at the end in s.
        q: coordinates there, shape ``(*shape, n)``.
        u: velocities there, shape ``(*shape, n)``.
        slip: relative velocities γ in m/s, shape ``(*shape, n_contact, p)``.
        force: friction forces λ on the body in N, shape ``(*shape, n_contact, p)``.
        normal_force: λ_N in N, shape ``(*shape, n_contact)``.
        phase: `Phase` as integers, shape ``(*shape, n_contact)``.
        steps: number of steps done.
        ambiguous: number of steps, or events, at which a contact had several solutions.
        extent: largest less smallest coordinates, shape ``(*shape, n)``.
        stick_share: parts of the time in which contacts stick, shape ``(*shape, n_contact)``.
        rest_time: time in s from which on all velocities vanish, NaN unless they do at the end.
        crossings: number of crossings of the section.
        crossing_time: of the last crossing in s.
        crossing_q: coordinates at the last crossing, shape ``(*shape, n)``.
        crossing_u: velocities at the last crossing, shape ``(*shape, n)``.
        period: time between the last two crossings in s.
        samples: samples on the way by name, of shape ``(*shape, n_t, …)``; empty unless asked for.
        failures: the runs that failed, in their order.
        values: the values that replaced parts of the system, by dotted name.
        axes: names of the axes.

    What was not asked for is ``None``.

    >>> import numpy as np
    >>> from asperity import FrictionLaw, SlidingPoint, simulate_many
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> many = simulate_many(block, dt=0.01, t_end=1.0, u0=[[1.0, 0.0], [2.0, 0.0]])
    >>> print(many.summary())
    2 runs: 2 finished. They took 200 steps.
    """

    _endings = tuple(str(outcome) for outcome in OUTCOMES)
    _noun, _plural = "run", "runs"
    _meanings: ClassVar[Mapping[str, Meaning]] = {
        "t": Meaning((), "s", "time at the end"),
        "q": Meaning(("coordinate",), "", "coordinates at the end"),
        "u": Meaning(("velocity",), "", "velocities at the end"),
        "slip": Meaning(("contact", "component"), "m/s", "slip velocity at the end"),
        "force": Meaning(("contact", "component"), "N", "friction force on the body at the end"),
        "normal_force": Meaning(("contact",), "N", "normal force at the end"),
        "phase": Meaning(("contact",), NO_UNIT, "phase of the contact at the end"),
        "steps": Meaning((), NO_UNIT, "number of steps"),
        "ambiguous": Meaning((), NO_UNIT, "number of steps or events with several solutions"),
        "extent": Meaning(("coordinate",), "", "largest less smallest coordinates"),
        "stick_share": Meaning(("contact",), NO_UNIT, "part of the time in which contacts stick"),
        "rest_time": Meaning((), "s", "time from which on everything rests"),
        "crossings": Meaning((), NO_UNIT, "number of crossings of the section"),
        "crossing_time": Meaning((), "s", "time of the last crossing"),
        "crossing_q": Meaning(("coordinate",), "", "coordinates at the last crossing"),
        "crossing_u": Meaning(("velocity",), "", "velocities at the last crossing"),
        "period": Meaning((), "s", "time between the last two crossings"),
    }

    t: Array
    q: Array
    u: Array
    slip: Array
    force: Array
    normal_force: Array
    phase: NDArray[np.int8]
    steps: NDArray[np.int64]
    ambiguous: NDArray[np.int64]
    extent: Array | None
    stick_share: Array | None
    rest_time: Array | None
    crossings: NDArray[np.int64] | None
    crossing_time: Array | None
    crossing_q: Array | None
    crossing_u: Array | None
    period: Array | None
    samples: Mapping[str, NDArray[Any]]

    def repeat(self, index: int | tuple[int, ...]) -> Run:
        """Make one of the runs again, alone and with all its samples.

        It ends as that run did to the bit, if that was not made in lanes, then up to rounding.

        Args:
            index: of the run, along the axes of the ensemble.

        Raises:
            ParameterError: if there is no such run.

        >>> from asperity import FrictionLaw, SlidingPoint, simulate_many
        >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
        >>> many = simulate_many(block, dt=0.01, t_end=1.0, replace={"mass": [1.0, 2.0]})
        >>> len(many.repeat(1))
        101
        """
        run: Run = self._parameters["again"].repeat(self._number(index))
        return run

    def _sentences(self) -> Iterator[str]:
        yield from super()._sentences()
        yield f"They took {counted(int(self.steps.sum()), 'step')}."

    def _more_variables(self) -> dict[str, Any]:
        found = {}
        for name, values in self.samples.items():
            axes, unit, description = self._meanings[name]
            words = {"long_name": description.replace("at the end", "on the way"), "units": unit}
            attributes = {key: word for key, word in words.items() if word}
            found[f"sampled_{name}"] = ((*self.axes, "sample", *axes), values, attributes)
        return found
