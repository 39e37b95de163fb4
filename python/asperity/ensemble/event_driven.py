"""Many runs of event-driven integration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.progress import Progress, Report
from asperity.ensemble import reductions, running
from asperity.ensemble.ends import Ensemble
from asperity.ensemble.members import Again, Members, Part
from asperity.ensemble.reductions import Reduction
from asperity.ensemble.variants import Variants
from asperity.errors import ParameterError
from asperity.runs import event_driven
from asperity.runs.model import Model
from asperity.runs.section import Section
from asperity.system.rigid import plane_motion


def integrate_many(
    systems: Model | Sequence[Model],
    *,
    t_end: float,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    replace: Mapping[str, Any] | None = None,
    axes: str | Sequence[str] | None = None,
    keep: float | Reduction | str | Sequence[Reduction | str] = "end",
    after: float = 0.0,
    tolerance: float = 1e-10,
    max_step: float | None = None,
    section: Section | None = None,
    max_events: int = 10_000,
    on_failure: str = "record",
    threads: int | None = None,
    progress: Progress = None,
) -> Ensemble:
    """Integrate a system from many start states, or many systems, each as `integrate` does.

    Threads take the runs in chunks. Every run is to the bit what it is alone, for any number of
    threads and whatever its neighbours do; one that fails is recorded and ends alone.

    Args:
        systems: a system, or a sequence of systems with as many coordinates and contacts.
        t_end: end time in s; all runs start at the time 0.
        q0: initial coordinates, shape ``(..., n)``; default as in `integrate`.
        u0: initial velocities, shape ``(..., n)``; default likewise.
        replace: values by dotted names of what they replace in the system, see `simulate_many`.
        axes: names of the axes to which systems, values and start states are broadcast.
        keep: ``"end"``; or the time between samples in s; or quantities that are found on the way:
            ``"extent"`` of the coordinates, ``"stick_share"``, ``"rest_time"``, a `Section` whose
            crossings are counted, or several of these. The ends are always kept.
        after: time in s before which such quantities do not look, until which a motion settles.
        tolerance: error that is aimed at, see `integrate`.
        max_step: longest step in s. Default: as the error allows.
        section: where a run stops.
        max_events: number of events after which a run gives up.
        on_failure: ``"record"`` or ``"raise"`` what the first run that fails raises.
        threads: number of threads; default the number of cores, one in a worker process. Systems
            with functions of Python are run one after the other.
        progress: ``True`` for a bar of tqdm, or a function of (runs done, runs).

    Returns:
        The ensemble. Crossings of a section are found to rounding: the motion goes on from there as
        from a start. Between steps the extent is that of cubic polynomials; of the coordinates of
        bodies that turn in space only the ends of steps are looked at.

    Raises:
        ParameterError: naming the argument; of ``replace`` with the nearest names.
        EnsembleInterrupted: on Ctrl-C, with what is done as ``ensemble``.

    >>> from asperity import FrictionLaw, SlidingPoint, integrate_many
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> many = integrate_many(
    ...     block,
    ...     t_end=1.0,
    ...     u0=[2.0, 0.0],
    ...     replace={"law.reservoir.radius": [0.5, 1.0]},
    ...     keep="rest_time",
    ... )
    >>> many.rest_time.round(9).tolist()
    [0.4, 0.2]
    """
    t_end, tolerance = arrays.positive(t_end, "t_end"), arrays.positive(tolerance, "tolerance")
    max_events = arrays.count(max_events, "max_events")
    if max_step is not None:
        max_step = arrays.positive(max_step, "max_step")
    arrays.of_kind(section, "section", Section | None, "a Section or None")
    members = Members(Variants(systems, replace), q0, u0, axes)
    kept = reductions.kept(keep, after, members.sizes)
    if section is not None and kept.section is not None:
        raise ParameterError("section", "either ends the runs or is counted by keep, not both")
    number = running.threads(threads, members)

    def compute(part: Part, report: Report | None) -> tuple[dict[str, Any], BaseException | None]:
        return _core.integrate_many(
            part.runs,
            t_end,
            tolerance,
            kept.every,
            max_step,
            reductions.section_arguments(section),
            max_events,
            kept.arguments(None),
            number,
            report,
        )

    def check(system: Model) -> None:
        event_driven.check(system)
        plane_motion.check_rates(system, 0.0, t_end)

    options = {"t_end": t_end, "tolerance": tolerance, "max_step": max_step, "section": section}
    return running.all_runs(
        members,
        compute,
        check,
        event_driven.unfinished,
        Again(members, event_driven.integrate, {**options, "max_events": max_events}),
        kept.names,
        on_failure=on_failure,
        progress=progress,
    )
