"""Equilibria, their stability and limit cycles over a parameter."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Count, Progress, reporter
from asperity._base.result import Axis, Series, Table, counted
from asperity._base.storage.data import Kinds
from asperity._base.storage.result_file import SavedResult
from asperity._base.value import Given, Record, Text, Vector, a_tuple
from asperity.cycles import orbit
from asperity.cycles.continuation import Continuation, Found
from asperity.cycles.orbit import LimitCycle
from asperity.errors import ConvergenceError, ParameterError
from asperity.runs.model import Model
from asperity.steady_sliding import Stability, analysis, equilibrium, stability
from asperity.system.labels import Labels, numbered

Family = Callable[..., Model]


class BifurcationDiagram(SavedResult, Record):
    """What a family of systems does over a parameter, found by `bifurcation_diagram`.

    Attributes:
        parameter: its name.
        values: its values, ascending, shape ``(n,)``.
        stabilities: of the equilibria; None where there is no steady sliding.
        cycles: limit cycles; None where none was found.
        failures: why there is no equilibrium, or why no cycle was found beside an unstable one if
            cycles were looked for; empty where all went well.
    """

    parameter: Text
    values: Vector
    stabilities: Annotated[Given[Sequence[Stability | None], tuple[Stability | None, ...]], a_tuple]
    cycles: Annotated[Given[Sequence[LimitCycle | None], tuple[LimitCycle | None, ...]], a_tuple]
    failures: Annotated[Given[Sequence[str], tuple[str, ...]], a_tuple]

    _picture = "plot_bifurcation"

    def __len__(self) -> int:
        return len(self.values)

    @property
    def equilibria(self) -> Array:
        """Coordinates of the equilibria, shape ``(n, n_q)``; NaN where there is none."""
        return self._stacked([None if s is None else s.equilibrium.q for s in self.stabilities])

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of the equilibria as of `Stability`; ``"none"`` where there is none."""
        return tuple("none" if s is None else s.kind for s in self.stabilities)

    @property
    def growth_rates(self) -> Array:
        """Largest real parts of the eigenvalues in 1/s, shape ``(n,)``; NaN where there is none."""
        return np.array([np.nan if s is None else s.growth_rate for s in self.stabilities])

    @property
    def cycle_minima(self) -> Array:
        """Least coordinates of the cycles, shape ``(n, n_q)``; NaN where there is none."""
        return self._stacked([None if c is None else c.minimum for c in self.cycles])

    @property
    def cycle_maxima(self) -> Array:
        """Greatest coordinates of the cycles, shape ``(n, n_q)``; NaN where there is none."""
        return self._stacked([None if c is None else c.maximum for c in self.cycles])

    @property
    def cycle_stable(self) -> NDArray[np.bool_]:
        """Whether there is a cycle and it is stable, shape ``(n,)``."""
        return np.array([cycle is not None and cycle.is_stable for cycle in self.cycles])

    @property
    def branches(self) -> NDArray[np.int64]:
        """Numbers of the branches of cycles, shape ``(n,)``; −1 where there is none.

        Neighbours with one number have the same sign of det(1 − P′), P being the return map: it
        changes where a branch turns back, as where a stable and an unstable cycle meet.
        """
        signs = np.array([0 if c is None else 1 if c._is_positive else -1 for c in self.cycles])
        begins = (signs != 0) & (np.diff(signs, prepend=0) != 0)
        return np.where(signs != 0, np.cumsum(begins) - 1, -1)

    @property
    def periods(self) -> Array:
        """Periods of the cycles in s, shape ``(n,)``; NaN where there is none."""
        return np.array([np.nan if c is None else c.period for c in self.cycles])

    @property
    def coexistence(self) -> NDArray[np.bool_]:
        """Whether a cycle exists beside an equilibrium that is not unstable, shape ``(n,)``."""
        pairs = zip(self.kinds, self.cycles, strict=True)
        return np.array([kind not in ("unstable", "none") and c is not None for kind, c in pairs])

    def _stacked(self, rows: Sequence[Array | None]) -> Array:
        """Stack rows of coordinates; NaN where there is none."""
        places = [s.equilibrium.q for s in self.stabilities if s is not None]
        places += [cycle.minimum for cycle in self.cycles if cycle is not None]
        none = np.full(len(places[0]) if places else 0, np.nan)
        stacked = [none if row is None else row for row in rows]
        return np.array(stacked).reshape(len(rows), len(none))

    def __repr__(self) -> str:
        found = sum(cycle is not None for cycle in self.cycles)
        return (
            f"<BifurcationDiagram: {len(self)} values of {self.parameter} from {self.values[0]:g} "
            f"to {self.values[-1]:g}, {self.kinds.count('unstable')} unstable equilibria, "
            f"{found} limit cycles>"
        )

    def summary(self) -> str:
        """Return where equilibria lose their stability and where cycles exist, in sentences."""
        lines = [
            f"The parameter {self.parameter} goes from {self.values[0]:.6g} to "
            f"{self.values[-1]:.6g} in {counted(len(self), 'value')}."
        ]
        for kind in dict.fromkeys(self.kinds):
            where = self._spans([one == kind for one in self.kinds])
            what = "There is no equilibrium" if kind == "none" else f"The equilibrium is {kind}"
            lines.append(f"{what} at {self.parameter} = {where}.")
        for stable in (True, False):
            found = [c is not None and c.is_stable == stable for c in self.cycles]
            if any(found):
                word = "stable" if stable else "unstable"
                where = self._spans(found)
                lines.append(f"There are {word} limit cycles at {self.parameter} = {where}.")
        failed = [bool(text) for text in self.failures]
        if any(failed):
            first = failed.index(True)
            at = f" at {self.values[first]:.6g}" if sum(failed) > 1 else ""
            lines.append(
                f"The search failed at {self.parameter} = {self._spans(failed)};{at} because: "
                f"{self.failures[first].rstrip('.')}."
            )
        return "\n".join(lines)

    def _spans(self, chosen: Sequence[bool]) -> str:
        """Return the intervals of values that are chosen, in words."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(chosen, dtype=int), [0]])))
        spans = []
        for first, after in edges.reshape(-1, 2).tolist():
            low, high = self.values[first], self.values[after - 1]
            spans.append(f"{low:.6g}" if after - first == 1 else f"{low:.6g} to {high:.6g}")
        return ", ".join(spans)

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates, from the cycles or numbered."""
        return self._labels.coordinates

    @property
    def coordinate_units(self) -> tuple[str, ...]:
        """Their units."""
        return self._labels.coordinate_units

    @property
    def _labels(self) -> Labels:
        found = (cycle.motion.labels for cycle in self.cycles if cycle is not None)
        size = self.equilibria.shape[1]
        return next(found, numbered(size, size, 0))

    def _table(self) -> Table:
        labels = self._labels
        coordinates = {
            "equilibrium": (self.equilibria, "coordinates of the equilibrium"),
            "cycle_minimum": (self.cycle_minima, "least coordinates of the limit cycle"),
            "cycle_maximum": (self.cycle_maxima, "greatest coordinates of the limit cycle"),
        }
        numbers = {
            "growth_rate": (self.growth_rates, "1/s", "largest real part of an eigenvalue"),
            "kind": (np.array(self.kinds), "", "kind of the equilibrium"),
            "cycle_stable": (self.cycle_stable, "", "whether there is a stable limit cycle"),
            "period": (self.periods, "s", "period of the limit cycle"),
            "branch": (self.branches, "", "number of the branch of limit cycles"),
            "failure": (np.array(self.failures, dtype=np.str_), "", "why nothing was found"),
        }
        # A parameter may have the name of a column.
        own = self.parameter
        taken = own in {"coordinate", *coordinates, *numbers}
        rows = (f"{own}_parameter" if taken else own,)
        axes = {
            rows[0]: Axis(self.values, "", "parameter"),
            "coordinate": Axis(labels.coordinates, "", "coordinate", labels.coordinate_units),
        }
        series = {
            name: Series(values, (*rows, "coordinate"), "", words)
            for name, (values, words) in coordinates.items()
        }
        series |= {
            name: Series(values, rows, unit, words)
            for name, (values, unit, words) in numbers.items()
        }
        return Table(axes, series, {"title": repr(self)[1:-1]})

    @classmethod
    def _known(cls) -> Kinds:
        return _KNOWN


_KNOWN: Kinds = {
    **orbit.KNOWN,
    **analysis.KNOWN,
    BifurcationDiagram.__name__: BifurcationDiagram,
}


def bifurcation_diagram(
    family: Family,
    *,
    parameter: str,
    values: ArrayLike,
    cycles: bool = True,
    q0: ArrayLike | None = None,
    t_end: float | None = None,
    tolerance: float = 1e-8,
    threads: int = 2,
    progress: Progress = None,
) -> BifurcationDiagram:
    """Find equilibria, their stability and limit cycles over one parameter.

    Equilibria are continued from value to value; where that fails they are searched for afresh. A
    cycle is searched for in the middle of every interval in which the equilibrium is unstable and
    continued from value to value to both sides, also past the ends of the interval, until it is
    lost; so a cycle that coexists with a stable equilibrium is found if it hangs together with an
    unstable interval. Of several equilibria or cycles at one value one is found; branches are not
    followed around folds, and continuation does not change from one to another.

    Args:
        family: function that makes a system; called as ``family(**{parameter: value})``.
        parameter: name of its argument.
        values: of the parameter, ascending, shape ``(n,)``; cycles are continued from one to the
            next, so that they should lie close.
        cycles: whether to look for limit cycles.
        q0: coordinates near the equilibrium of the first value, shape ``(n_q,)``. Default as for
            `equilibrium`.
        t_end: as for `limit_cycle`.
        tolerance: of the cycles, as for `limit_cycle`.
        threads: cycles of so many intervals and directions are continued at a time.
        progress: ``True`` for a bar of tqdm, or a function of (done, all) that is called after each
            equilibrium and each limit cycle that was looked for, from the threads as well.

    Returns:
        The diagram. Systems that cannot be made, equilibria and cycles that are not found are empty
        places, with the reason among its failures.

    Raises:
        ParameterError: if the values do not ascend, `family` does not take the argument or another
            argument is not allowed, as a `q0` that does not fit the systems.

    Reference: [WL19] Fig. 16.

    >>> import numpy as np
    >>> from asperity import Ellipse, FrictionLaw, MassOnBelt, bifurcation_diagram
    >>> law = FrictionLaw(Ellipse(30.0, 10.0, angle=np.pi / 6), Ellipse(3.0, 1.0))
    >>> def belt(phi):
    ...     return MassOnBelt(
    ...         1.0,
    ...         stiffness=1.0,
    ...         law=law,
    ...         normal_force=1.0,
    ...         belt_velocity=[np.cos(phi), np.sin(phi)],
    ...     )
    >>> diagram = bifurcation_diagram(
    ...     belt, parameter="phi", values=np.deg2rad([40.0, 50.0, 80.0]), cycles=False
    ... )
    >>> diagram.kinds
    ('neutral', 'unstable', 'neutral')
    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity.plot import plot_bifurcation
    >>> [line.get_label() for line in plot_bifurcation(diagram).lines]
    ['neutral equilibrium', 'unstable equilibrium']
    """
    grid = arrays.array(values, "values", (None,))
    if not grid.size or (np.diff(grid) <= 0.0).any():
        raise ParameterError("values", "must ascend and not be empty")
    # Refused at once: of what is wrong at single values the diagram only keeps the reason.
    start = None if q0 is None else arrays.array(q0, "q0", (None,))
    duration = None if t_end is None else arrays.positive(t_end, "t_end")
    sharpness, threads = arrays.positive(tolerance, "tolerance"), arrays.count(threads, "threads")
    member = _members(family, parameter)
    with reporter(progress, "value") as report:
        count = Count(len(grid) * (2 if cycles else 1), report)
        stabilities, failures = _equilibria(member, grid, start, count)
        found = Found()
        if cycles:
            unstable = [s is not None and s.kind == "unstable" for s in stabilities]
            search = Continuation(member, grid.tolist(), unstable, sharpness, duration, count)
            found = search.everywhere(threads)
        count.finish()
    for value, why in zip(grid.tolist(), failures, strict=True):
        if why:
            log.warning(
                "bifurcation_diagram: no equilibrium at %s = %.9g: %s", parameter, value, why
            )
    for number, why in sorted(found.failures.items()):
        log.info("bifurcation_diagram: no cycle at %s = %.9g: %s", parameter, grid[number], why)
    return BifurcationDiagram(
        parameter,
        grid,
        stabilities,
        [found.cycles.get(i) for i in range(len(grid))],
        [failure or found.failures.get(i, "") for i, failure in enumerate(failures)],
    )


def _members(family: Family, parameter: str) -> Callable[[float], Model]:
    """Return the system as a function of the parameter."""
    try:
        inspect.signature(family).bind_partial(**{parameter: 0.0})
    except TypeError:
        raise ParameterError(
            "parameter", f"must be an argument of {family!r}, got {parameter!r}"
        ) from None

    def member(value: float) -> Model:
        system = family(**{parameter: value})
        if not isinstance(system, Model):
            raise ParameterError("family", f"must return a system, returned {system!r}")
        return system

    return member


def _equilibria(
    member: Callable[[float], Model], grid: Array, q0: ArrayLike | None, count: Count
) -> tuple[list[Stability | None], list[str]]:
    stabilities: list[Stability | None] = []
    failures: list[str] = []
    last = q0
    for number, value in enumerate(grid.tolist()):
        count.add(number)
        try:
            system = member(value)
        except ParameterError as error:
            stabilities.append(None)
            failures.append(str(error))
            continue
        if q0 is not None:
            # What no member can start from is no failure of a value.
            arrays.array(q0, "q0", (system.dof,))
        try:
            found = _nearest(system, last)
            stabilities.append(found)
            failures.append("")
            last = found.equilibrium.q
        except (ParameterError, ConvergenceError) as error:
            stabilities.append(None)
            failures.append(str(error))
    return stabilities, failures


def _nearest(system: Model, q0: ArrayLike | None) -> Stability:
    """Return the steady sliding near `q0`, else whichever is found."""
    try:
        return stability(system, equilibrium=equilibrium(system, q0=q0))
    except (ParameterError, ConvergenceError):
        if q0 is None:
            raise
    return stability(system)
