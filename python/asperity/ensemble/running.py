"""What all kinds of ensembles have in common: their parts one after the other, and how they end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import asperity._core as _core
from asperity._base import arrays
from asperity._base.log import log
from asperity._base.pool import threads_to_use
from asperity._base.progress import Progress, Report, part_of, reporter
from asperity.ensemble.ends import Ensemble
from asperity.ensemble.members import Again, Collection, Members, Part
from asperity.ensemble.result import AnyEnsemble
from asperity.errors import EnsembleInterrupted
from asperity.runs.model import Model

Compute = Callable[[Part, Report | None], tuple[dict[str, Any], BaseException | None]]
"""Makes the runs of a part; what it has found, and the exception that ended it, if one did."""


def threads(given: int | None, members: Members) -> int:
    """Return how many threads serve, one where runs call functions of Python."""
    count = threads_to_use() if given is None else arrays.count(given, "threads")
    if _core.calls_python(members.variants.first._core):
        if len(members) > 1 and count > 1:
            log.info("the system calls functions of Python: its runs are made one after the other")
        return 1
    return count


def all_runs(
    members: Members,
    compute: Compute,
    check: Callable[[Model], None],
    errors: Callable[[dict[str, Any], Model], BaseException],
    again: Again,
    names: frozenset[str],
    *,
    on_failure: str,
    progress: Progress,
) -> Ensemble:
    """Return the results of all runs.

    Args:
        members: the runs.
        compute: makes the runs of a part.
        check: raises what is wrong with a system.
        errors: returns what a failure would have raised.
        again: makes a run again.
        names: of the quantities that were asked for.
        on_failure: ``"record"`` or ``"raise"``.
        progress: as users give it.
    """
    arrays.choice(on_failure, "on_failure", ["record", "raise"])
    collection, done, stopped = Collection(len(members)), 0, None
    try:
        with reporter(progress, "run") as report:
            for part in members.parts(check):
                if not isinstance(part, Part):
                    collection.refuse(*part)
                    done += len(part[0])
                else:
                    found, stopped = compute(part, part_of(report, done, len(members)))
                    collection.add(part, found)
                    done += part.runs[-1]
                if stopped is not None or (on_failure == "raise" and collection.failures):
                    break
    except KeyboardInterrupt as error:
        # Between the parts, while Python makes systems.
        stopped = error
    ensemble = collection.ensemble(members, errors, again, names)
    if stopped is not None:
        if isinstance(stopped, KeyboardInterrupt):
            raise EnsembleInterrupted(ensemble) from stopped
        vars(stopped)["ensemble"] = ensemble
        raise stopped
    tell(ensemble, f"{again.engine.__name__}_many", on_failure)
    return ensemble


def tell(ensemble: AnyEnsemble, function: str, on_failure: str) -> None:
    """Raise the first failure of an ensemble, or log how many there are."""
    if not ensemble.failures:
        return
    first, noun = ensemble.failures[0], ensemble._noun
    if on_failure == "raise":
        first.error.add_note(f"asperity: of {noun} {first.index} of {function}")
        raise first.error
    log.warning(
        "%s: %d of %d %s failed and were recorded, the first one is %s %s",
        function,
        len(ensemble.failures),
        len(ensemble),
        ensemble._plural,
        noun,
        first,
    )
