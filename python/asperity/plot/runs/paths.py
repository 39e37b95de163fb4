"""Paths in the plane, and phase portraits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.cycles import LimitCycle
from asperity.errors import DimensionError, ParameterError
from asperity.plot import look
from asperity.plot.runs import chosen
from asperity.plot.runs.chosen import Drawable
from asperity.runs.run import Run
from asperity.track import MeasuredPath


def plot_path(
    run: Drawable | MeasuredPath | Sequence[Any] | Mapping[str, Any],
    *,
    ax: Axes | None = None,
    coordinates: tuple[int, int] = (0, 1),
    contact: int | None = None,
    label: str | Sequence[str] | None = None,
    **kwargs: Any,
) -> Axes:
    """Draw two coordinates against each other.

    A dot marks the end, hollow of a measured path that does not end at rest; a limit cycle is
    closed and has none.

    Args:
        run: a `Trajectory`, a `Motion`, a `LimitCycle` or a `MeasuredPath`, or several of them in
            a list or, by their labels, in a dict; with lengths as coordinates.
        ax: axes; default new ones.
        coordinates: numbers of the two; of measured paths both are drawn.
        contact: number of a contact whose phases colour the paths of runs; default none.
        label: of the path, or a list of labels.
        **kwargs: of the lines, as for ``Axes.plot``; not with `contact`.

    Returns:
        The axes.

    Raises:
        ParameterError, DimensionError: naming the argument.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> from asperity.plot import plot_path
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5))
    >>> path = simulate(block, dt=1e-3, t_end=1.0, u0=[1.0, 1.0])
    >>> line, end = plot_path({"isotropic": path}).lines
    >>> line.get_label()
    'isotropic'
    """
    listed = [one for _, one in chosen.several(run)]
    found = chosen.runs_or_measured(run)
    points = [_points(one, coordinates) for _, one in found]
    names = chosen.labels(found, label)
    if contact is not None:
        if kwargs:
            raise ParameterError(
                "contact", "sets colours and lines by phase, without other options"
            )
        for _, one in found:
            if isinstance(one, MeasuredPath):
                raise ParameterError(
                    "contact", "must be None for measured paths: phases are not measured"
                )
            chosen.one_contact(one, contact)
    with look.drawing(ax) as ax:
        for given, (_, one), path, name in zip(listed, found, points, names, strict=True):
            color, face = look.INK, None
            if contact is None or isinstance(one, MeasuredPath):
                (line,) = ax.plot(*path.T, label=name, **look.line_options(kwargs))
                color = str(line.get_color())
                if isinstance(one, MeasuredPath) and not one.comes_to_rest:
                    face = "none"
            else:
                _draw_by_phase(ax, one, path, contact)
            if not isinstance(given, LimitCycle):
                last = path[np.isfinite(path).all(axis=1)][-1:]
                ax.plot(*last.T, "o", color=color, markerfacecolor=face, markersize=4.5)
        if contact is not None or any(name is not None for name in names):
            ax.legend()
        first = found[0][1]
        across, up = (
            f"$q_{{{number + 1}}}$ in m"
            if isinstance(first, MeasuredPath)
            else chosen.axis_label(first, "coordinate", number)
            for number in coordinates
        )
        ax.set(aspect="equal", xlabel=across, ylabel=up)
        return ax


def plot_phase_portrait(
    run: Drawable | Sequence[Any] | Mapping[str, Any],
    *,
    ax: Axes | None = None,
    coordinate: int = 0,
    label: str | Sequence[str] | None = None,
    **kwargs: Any,
) -> Axes:
    """Draw a coordinate q against its velocity u.

    A hollow dot marks where a run begins; a limit cycle is closed and has none. Between samples the
    curve is straight: give `integrate` a sampling interval where its steps are seen.

    Args:
        run: a `Trajectory`, a `Motion` or a `LimitCycle`, or several of them in a list or, by
            their labels, in a dict.
        ax: axes; default new ones.
        coordinate: number of the coordinate; of bodies in space one of their positions.
        label: of the curve, or a list of labels.
        **kwargs: of the curves, as for ``Axes.plot``.

    Returns:
        The axes.

    Raises:
        ParameterError: naming the argument.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import integrate, limit_cycle, mechanisms
    >>> from asperity.plot import plot_phase_portrait
    >>> block = mechanisms.stribeck_block()
    >>> start = integrate(block, t_end=20.0, q0=[1.0])
    >>> ax = plot_phase_portrait({"from rest": start, "limit cycle": limit_cycle(block)})
    >>> ax.get_ylabel()
    'u0 in SI units'
    """
    listed = [one for _, one in chosen.several(run)]
    found = chosen.runs(run)
    names = chosen.labels(found, label)
    velocities = [_velocity(one, coordinate) for _, one in found]
    with look.drawing(ax) as ax:
        for given, (_, one), name, velocity in zip(listed, found, names, velocities, strict=True):
            q, u = one.q[:, coordinate], one.u[:, velocity]
            (line,) = ax.plot(q, u, label=name, **look.line_options(kwargs))
            if not isinstance(given, LimitCycle):
                hollow: dict[str, Any] = {"markerfacecolor": "white", "markersize": 4.5}
                ax.plot(q[:1], u[:1], "o", color=line.get_color(), **hollow)
        if any(name is not None for name in names):
            ax.legend()
        first = found[0][1]
        ax.set(
            xlabel=chosen.axis_label(first, "coordinate", coordinate),
            ylabel=chosen.axis_label(first, "velocity", velocities[0]),
        )
        return ax


def _points(run: Run | MeasuredPath, coordinates: tuple[int, int]) -> Array:
    """Return the two coordinates of each sample."""
    i, j = (
        arrays.count(index, "coordinates", 0) for index in arrays.pair(coordinates, "coordinates")
    )
    shown = run.position if isinstance(run, MeasuredPath) else run.q
    if max(i, j) >= shown.shape[1]:
        raise DimensionError("coordinates", f"must be below {shown.shape[1]}, got {coordinates}")
    return shown[:, [i, j]]


def _velocity(run: Run, coordinate: int) -> int:
    """Return the number of the velocity that is the rate of a coordinate."""
    count, velocities = run.q.shape[1], run.u.shape[1]
    number = chosen.numbers(coordinate, count, "coordinate", what="coordinates")[0]
    if count == velocities:
        return number
    # Bodies in space: position and quaternion against v and Ω.
    body, part = divmod(number, 7)
    if 6 * count != 7 * velocities or part > 2:
        raise ParameterError(
            "coordinate",
            "must be one whose rate is a velocity: of bodies in space the position, such as "
            f"{7 * body} to {7 * body + 2}, got {number}",
        )
    return 6 * body + part


def _draw_by_phase(ax: Axes, run: Run, points: Array, contact: int) -> None:
    """Draw a path as one collection of lines per phase that occurs."""
    phases = run.phase[:, contact]
    known = ax.get_legend_handles_labels()[1]
    for phase, (color, name) in chosen.PHASES.items():
        segments = list(chosen.stretches(points, phases == phase))
        if segments:
            label = None if name in known else name
            ax.add_collection(LineCollection(segments, colors=color, linewidths=2.0, label=label))
    ax.autoscale_view()
