"""What a plot of runs is given: one run or several, and which of their parts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import NO_UNIT
from asperity.cycles import LimitCycle
from asperity.errors import DimensionError, ParameterError
from asperity.plot import look
from asperity.runs.run import Run
from asperity.status import Phase
from asperity.system.labels import UNKNOWN_UNIT
from asperity.track import MeasuredPath

Drawable: TypeAlias = Run | LimitCycle
"""A `Trajectory`, a `Motion`, or a `LimitCycle`, of which one period is drawn."""

PHASES = {
    Phase.STICK: (look.STICK, "stick"),
    Phase.SLIP: (look.SLIP, "slip"),
    Phase.OPEN: (look.OPEN, "open"),
}
"""Colour and name of each phase."""


def several(given: Any) -> list[tuple[str | None, Any]]:
    """Return one object, a sequence or a mapping as a list of labels and objects."""
    listed: list[tuple[str | None, Any]]
    if isinstance(given, Mapping):
        listed = [(str(label), one) for label, one in given.items()]
    elif isinstance(given, Sequence) and not isinstance(given, str):
        listed = [(None, one) for one in given]
    else:
        listed = [(None, given)]
    if not listed:
        raise ParameterError("run", "must hold a run, it is empty")
    return listed


def runs(given: Any) -> list[tuple[str | None, Run]]:
    """Return runs with their labels, those of cycles in place of the cycles."""
    return [(label, one_run(run)) for label, run in several(given)]


def one_run(given: Any) -> Run:
    """Return a run, of a cycle its motion."""
    run = given.motion if isinstance(given, LimitCycle) else given
    if not isinstance(run, Run):
        raise ParameterError(
            "run",
            "must be what simulate or integrate returns, a LimitCycle, or several of them in a "
            f"list or a dict, got {given!r}",
        )
    if len(run) == 0:
        raise ParameterError("run", "must hold a sample, it has none")
    return run


def runs_or_measured(given: Any) -> list[tuple[str | None, Run | MeasuredPath]]:
    """Return runs and measured paths with their labels."""
    return [
        (label, one if isinstance(one, MeasuredPath) else one_run(one))
        for label, one in several(given)
    ]


def axis_label(run: Run, kind: Literal["coordinate", "velocity"], number: int) -> str:
    """Return the name and the unit of a coordinate or of a velocity of a run."""
    names, units = getattr(run, f"{kind}_names"), getattr(run, f"{kind}_units")
    return titled(names[number], units[number])


def titled(words: str, unit: str) -> str:
    """Return what stands beside an axis."""
    if unit == NO_UNIT:
        return words
    return f"{words} in {'SI units' if unit == UNKNOWN_UNIT else unit}"


def labels(
    found: Sequence[tuple[str | None, Any]], label: str | Sequence[str] | None
) -> list[str | None]:
    """Return the labels of several runs; `label` wins over those of a mapping."""
    if label is None:
        return [name for name, _ in found]
    names = [label] if isinstance(label, str) else list(label)
    if len(names) != len(found):
        raise DimensionError(
            "label", f"must name each of the {len(found)} runs, got {len(names)} labels"
        )
    return [str(name) for name in names]


def numbers(chosen: Any, count: int, argument: str, *, what: str | None = None) -> list[int]:
    """Return the numbers of the parts to draw, of one or several; all where none is named."""
    if chosen is None:
        return list(range(count))
    arrays.refuse_masked(chosen, argument)
    given = [chosen] if np.ndim(chosen) == 0 else list(chosen)
    wanted = [arrays.count(one, argument, 0) for one in given]
    if not wanted:
        raise ParameterError(argument, "must name one at least")
    if max(wanted) >= count:
        raise ParameterError(
            argument, f"must be below {count}, the number of {what or argument}, got {max(wanted)}"
        )
    return wanted


def one_contact(run: Run, contact: int) -> int:
    """Return the number of a contact that the run has."""
    return numbers(contact, run.phase.shape[1], "contact", what="contacts")[0]


def phase_intervals(run: Run, contact: int) -> dict[Phase, list[tuple[float, float]]]:
    """Return begin and duration in s of the phases of a contact.

    Between two samples the contact is in the phase of the later one: for a trajectory that of the
    step which ends there, for a motion that of the time up to an event.
    """
    later = run.phase[1:, contact]
    changes = np.flatnonzero(np.diff(later)) + 1
    borders = [0, *changes.tolist(), len(later)]
    found: dict[Phase, list[tuple[float, float]]] = {phase: [] for phase in PHASES}
    for first, last in itertools.pairwise(borders):
        if last == first or later[first] == Phase.NONE:
            continue
        begin, end = float(run.t[first]), float(run.t[last])
        if end > begin:
            found[Phase(int(later[first]))].append((begin, end - begin))
    return {phase: spans for phase, spans in found.items() if spans}


def stretches(points: Array, chosen: Any) -> Iterator[Array]:
    """Yield the runs of samples in `chosen`, each with the sample before it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
    for start, end in edges.reshape(-1, 2):
        yield points[max(start - 1, 0) : end]
