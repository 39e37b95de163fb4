"""Many searches for limit cycles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.pool import one_of_many
from asperity._base.progress import Progress, reporter
from asperity._base.result import NO_UNIT
from asperity._base.threads import GivenUp, Stop, Work
from asperity.cycles import LimitCycle, limit_cycle
from asperity.ensemble import running
from asperity.ensemble.members import Again, Members
from asperity.ensemble.result import AnyEnsemble, Meaning, MemberFailure
from asperity.ensemble.variants import Variants
from asperity.errors import EnsembleInterrupted, NoCycleError
from asperity.runs.model import labels_of
from asperity.runs.section import Section
from asperity.status import Phase

_FOUND, _NONE, _FAILED, _INTERRUPTED = range(4)


class CycleEnsemble(AnyEnsemble):
    """Limit cycles of many systems, found by `limit_cycle_many`.

    Arrays begin with the axes of the ensemble, those to which start states and replaced values were
    broadcast; they are NaN where no cycle was found.

    Attributes:
        status: ``"found"``; ``"none"`` where `limit_cycle` raises `NoCycleError`; ``"failed"``
            where it raises something else; ``"interrupted"``.
        shape: of the ensemble.
        period: in s.
        minimum: least value of each coordinate, shape ``(*shape, n)``.
        maximum: greatest value of each coordinate, shape ``(*shape, n)``.
        stick_share: parts of the period in which contacts stick, shape ``(*shape, n_contact)``.
        multiplier: largest modulus of the Floquet multipliers; below 1 the cycle is stable.
        residual: to which the cycle closes.
        failures: what the searches without a cycle have raised, in their order.
        values: the values that replaced parts of the system, by dotted name.
        axes: names of the axes.
    """

    _endings = ("found", "none", "failed", "interrupted")
    _noun, _plural = "search", "searches"
    _meanings: ClassVar[Mapping[str, Meaning]] = {
        "period": Meaning((), "s", "period of the cycle"),
        "minimum": Meaning(("coordinate",), "", "least coordinates"),
        "maximum": Meaning(("coordinate",), "", "greatest coordinates"),
        "stick_share": Meaning(("contact",), NO_UNIT, "part of the period in which contacts stick"),
        "multiplier": Meaning((), NO_UNIT, "largest modulus of the Floquet multipliers"),
        "residual": Meaning((), NO_UNIT, "what the cycle lacks to be closed"),
    }

    period: Array
    minimum: Array
    maximum: Array
    stick_share: Array
    multiplier: Array
    residual: Array

    def cycle(self, index: int | tuple[int, ...]) -> LimitCycle:
        """Search for one of the cycles again and return it whole.

        Args:
            index: along the axes of the ensemble.

        Raises:
            NoCycleError: if there is none.
        """
        found: LimitCycle = self._parameters["again"].repeat(self._number(index))
        return found


def limit_cycle_many(
    systems: Any,
    *,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    replace: Mapping[str, Any] | None = None,
    axes: str | Sequence[str] | None = None,
    section: Section | None = None,
    t_end: float | None = None,
    tolerance: float = 1e-9,
    on_failure: str = "record",
    threads: int | None = None,
    progress: Progress = None,
) -> CycleEnsemble:
    """Find limit cycles of many systems, or from many start states, each as `limit_cycle` does.

    Args:
        systems: a system, or a sequence of systems with as many coordinates and contacts.
        q0: coordinates to start from, shape ``(..., n)``; default as in `limit_cycle`.
        u0: velocities to start from, shape ``(..., n)``; default likewise.
        replace: values by dotted names of what they replace in the system, see `simulate_many`.
        axes: names of the axes to which systems, values and start states are broadcast.
        section: hyperplane that the cycles pass once per turn; default as in `limit_cycle`.
        t_end: longest time in s until the motion recurs; default as in `limit_cycle`.
        tolerance: largest ‖P(x) − x‖ relative to the orbit's extent.
        on_failure: ``"record"``, or ``"raise"`` what the first search without a cycle raises.
        threads: number of threads; default the number of cores, one in a worker process.
        progress: ``True`` for a bar of tqdm, or a function of (searches done, searches).

    Returns:
        What is known of the cycles; `CycleEnsemble.cycle` returns one of them whole.

    Raises:
        ParameterError: naming the argument; of ``replace`` with the nearest names.
        EnsembleInterrupted: on Ctrl-C, with what is done as ``ensemble``.

    >>> from asperity import FrictionLaw, MassOnBelt, Stribeck, limit_cycle_many
    >>> law = FrictionLaw.isotropic(1.0, dimension=1)
    >>> belt = MassOnBelt(
    ...     1.0,
    ...     stiffness=1.0,
    ...     law=law.replace(rate=Stribeck(1.0 / 3.0, shape="hyperbolic")),
    ...     normal_force=1.0,
    ...     belt_velocity=[0.2],
    ... )
    >>> many = limit_cycle_many(belt, replace={"belt_velocity": [[0.2], [0.3]]})
    >>> many.period.round(6).tolist()
    [12.001031, 9.953457]
    """
    arrays.choice(on_failure, "on_failure", ["record", "raise"])
    tolerance = arrays.positive(tolerance, "tolerance")
    t_end = None if t_end is None else arrays.positive(t_end, "t_end")
    arrays.of_kind(section, "section", Section | None, "a Section or None")
    members = Members(Variants(systems, replace), q0, u0, axes)
    options = {"section": section, "t_end": t_end, "tolerance": tolerance}
    again = Again(members, limit_cycle, options)
    number = running.threads(threads, members)
    stop = Stop()

    def search(member: int) -> LimitCycle:
        with one_of_many():
            stop.ask()
            return again.repeat(member, progress=stop.ask)

    found: dict[int, LimitCycle | Exception] = {}
    with reporter(progress, "search") as report:
        searches = Work(search, len(members), stop)
        try:
            searches.begin(number)
            while len(found) < len(members):
                found.update(searches.answers())
                if report is not None:
                    report(len(found), len(members))
                # The first one is that of the smallest number, whichever is found out first.
                bad = min(
                    (k for k, one in found.items() if isinstance(one, Exception)), default=None
                )
                if on_failure == "raise" and bad is not None and found.keys() >= set(range(bad)):
                    break
        except KeyboardInterrupt:
            searches.end()
            raise EnsembleInterrupted(_ensemble(members, found, again)) from None
        finally:
            searches.end()
    ensemble = _ensemble(members, found, again)
    running.tell(ensemble, "limit_cycle_many", on_failure)
    return ensemble


def _ensemble(
    members: Members, found: Mapping[int, LimitCycle | Exception], again: Again
) -> CycleEnsemble:
    """Return what is known of the cycles that were found, and why others were not."""
    count, sizes = len(members), members.sizes
    endings = np.full(count, _INTERRUPTED, dtype=np.int8)
    series: dict[str, NDArray[Any]] = {
        name: np.full((count, *(sizes[axis] for axis in meaning.axes)), np.nan)
        for name, meaning in CycleEnsemble._meanings.items()
    }
    failures = []
    for member, cycle in sorted(found.items(), key=lambda pair: pair[0]):
        if isinstance(cycle, GivenUp):
            continue
        if isinstance(cycle, Exception):
            endings[member] = _NONE if isinstance(cycle, NoCycleError) else _FAILED
            failures.append(MemberFailure(members.index(member), None, cycle))
            continue
        endings[member] = _FOUND
        sticking = [cycle.share(Phase.STICK, contact=k) for k in range(sizes["contact"])]
        known = {
            "period": cycle.period,
            "minimum": cycle.minimum,
            "maximum": cycle.maximum,
            "stick_share": sticking,
            "multiplier": np.abs(cycle.multipliers).max(initial=0.0),
            "residual": cycle.residual,
        }
        for name, value in known.items():
            series[name][member] = value
    shape = members.shape
    return CycleEnsemble(
        {name: values.reshape((*shape, *values.shape[1:])) for name, values in series.items()},
        endings.reshape(shape),
        others={},
        failures=failures,
        values=members.variants.values,
        inner={name: members.variants.inner_axes(name) for name in members.variants.values},
        axes=members.axes,
        labels=labels_of(members.variants.first),
        again=again,
    )
