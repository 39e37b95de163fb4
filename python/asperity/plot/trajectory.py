"""Plots of trajectories and motions."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.plot import look
from asperity.plot.sets import plot_set
from asperity.runs.run import Run
from asperity.status import Phase

_LOOK = {
    Phase.STICK: (look.STICK, "stick"),
    Phase.SLIP: (look.SLIP, "slip"),
    Phase.OPEN: (look.OPEN, "open"),
}


def plot_path(
    trajectory: Run,
    ax: Axes | None = None,
    *,
    coordinates: tuple[int, int] = (0, 1),
    **kwargs: Any,
) -> list[Artist]:
    """Draw two coordinates against each other; a dot marks the end.

    Args:
        trajectory: of `simulate` or `integrate`, with lengths as coordinates.
        ax: axes; default new ones.
        coordinates: numbers of the two.
        **kwargs: as for ``Axes.plot``.

    Returns:
        The path and the dot.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> from asperity.plot import plot_path
    >>> block = SlidingPoint(1.0, FrictionLaw.isotropic(0.5))
    >>> path = simulate(block, dt=1e-3, t_end=1.0, u0=[1.0, 1.0])
    >>> line, end = plot_path(path, label="isotropic")
    """
    x, y = _two(trajectory, coordinates)
    ax = look.axes_or_new(ax)
    (line,) = ax.plot(x, y, **kwargs)
    (end,) = ax.plot(x[-1:], y[-1:], "o", color=line.get_color(), markersize=4.5)
    _label(ax, coordinates)
    return [line, end]


def plot_phase(
    trajectory: Run,
    ax: Axes | None = None,
    *,
    coordinates: tuple[int, int] = (0, 1),
    contact: int = 0,
) -> list[Artist]:
    """Draw two coordinates against each other, coloured by the phase of a contact.

    Args:
        trajectory: of `simulate` or `integrate`, with lengths as coordinates.
        ax: axes; default new ones.
        coordinates: numbers of the two.
        contact: number of the contact.

    Returns:
        One collection of lines per phase that occurs.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import FrictionLaw, MassOnBelt, simulate
    >>> from asperity.plot import plot_phase
    >>> belt = MassOnBelt(1.0, 1.0, FrictionLaw.isotropic(0.5), 1.0, [0.1, 0.0])
    >>> [lines.get_label() for lines in plot_phase(simulate(belt, dt=1e-2, t_end=10.0))]
    ['stick', 'slip']
    """
    points = np.stack(_two(trajectory, coordinates), axis=-1)
    phases = trajectory.phase[:, _contact(trajectory, contact)]
    ax = look.axes_or_new(ax)
    artists: list[Artist] = []
    for phase, (color, label) in _LOOK.items():
        segments = _segments(points, phases == phase)
        if segments:
            lines = LineCollection(segments, colors=color, linewidths=2.0, label=label)
            artists.append(ax.add_collection(lines))
    ax.autoscale_view()
    ax.legend(frameon=False)
    _label(ax, coordinates)
    return artists


def plot_forces_in_reservoir(
    trajectory: Run,
    law: FrictionLaw,
    ax: Axes | None = None,
    *,
    contact: int = 0,
) -> list[Artist]:
    """Draw the friction forces −λ of a contact within the force reservoir λ_N C.

    The reservoir is that of the largest normal force that occurs.

    Args:
        trajectory: of `simulate` or `integrate`.
        law: law of the contact.
        ax: axes; default new ones.
        contact: number of the contact.

    Returns:
        Outline and filling of the reservoir, then one line of dots per phase that occurs.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import FrictionLaw, MassOnBelt, simulate
    >>> from asperity.plot import plot_forces_in_reservoir
    >>> law = FrictionLaw.isotropic(0.5)
    >>> belt = MassOnBelt(1.0, 1.0, law, 1.0, [0.1, 0.0])
    >>> outline, *_ = plot_forces_in_reservoir(simulate(belt, dt=1e-2, t_end=10.0), law)
    """
    contact = _contact(look.checked_trajectory(trajectory), contact)
    largest = np.nanmax(trajectory.normal_force[:, contact], initial=0.0)
    if largest <= 0.0:
        raise ParameterError("contact", f"must have carried load, contact {contact} never did")
    reservoir = look.planar_law(law).reservoir.scaled(largest)
    ax = look.axes_or_new(ax)
    artists = plot_set(reservoir, ax, color=look.INK, label=r"$\lambda_N C$")
    for phase, (color, label) in _LOOK.items():
        chosen = trajectory.phase[:, contact] == phase
        force = -trajectory.force[chosen, contact, :2]
        if chosen.any():
            artists += ax.plot(*force.T, ".", color=color, markersize=3.0, label=label)
    ax.set_xlabel(r"$-\lambda_1$ in N")
    ax.set_ylabel(r"$-\lambda_2$ in N")
    ax.legend(frameon=False)
    return artists


def _two(trajectory: Run, coordinates: tuple[int, int]) -> tuple[Array, Array]:
    shown = look.checked_trajectory(trajectory).q
    i, j = (
        arrays.count(index, "coordinates", 0) for index in arrays.pair(coordinates, "coordinates")
    )
    if max(i, j) >= shown.shape[1]:
        raise DimensionError("coordinates", f"must be below {shown.shape[1]}, got {coordinates}")
    return shown[:, i], shown[:, j]


def _contact(trajectory: Run, contact: int) -> int:
    contacts = trajectory.phase.shape[1]
    if arrays.count(contact, "contact", 0) >= contacts:
        raise ParameterError("contact", f"must be below {contacts}, got {contact}")
    return contact


def _segments(points: Array, chosen: Any) -> list[Array]:
    """Return the runs of samples in `chosen`, each with the sample before it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
    return [points[max(start - 1, 0) : end] for start, end in edges.reshape(-1, 2)]


def _label(ax: Axes, coordinates: tuple[int, int]) -> None:
    ax.set_aspect("equal")
    ax.set_xlabel(f"$q_{coordinates[0] + 1}$ in m")
    ax.set_ylabel(f"$q_{coordinates[1] + 1}$ in m")
