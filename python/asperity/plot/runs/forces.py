"""Friction forces in their reservoir."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.plot import look
from asperity.plot.runs import chosen
from asperity.plot.runs.chosen import Drawable
from asperity.plot.sets import draw_set
from asperity.runs.model import laws_of
from asperity.runs.run import Run

# Forces under a normal force below this share of the largest are left out: their ratio is rounding.
_UNLOADED = 1e-9
_MARKERS = (".", "x", "+", "1", "2")


def plot_forces_in_reservoir(
    run: Drawable | Sequence[Any] | Mapping[str, Any],
    *,
    law: FrictionLaw | None = None,
    ax: Axes | None = None,
    contacts: int | Sequence[int] | None = None,
    label: str | Sequence[str] | None = None,
) -> Axes:
    """Draw the friction forces per unit of normal force, −λ/λ_N, in the force reservoir C.

    A contact slips where −λ/λ_N is on the boundary of C, and sticks inside it; with a factor of the
    speed, such as `Stribeck`, in slip −λ/λ_N is on the boundary of C times that factor. Samples at
    which a contact carries no load are left out.

    Args:
        run: a `Trajectory`, a `Motion` or a `LimitCycle`, or several of them in a list or, by
            their labels, in a dict; each has markers of its own.
        law: law of the contacts that are drawn; default that of the run's own system.
        ax: axes; default new ones.
        contacts: numbers of the contacts; default all. They must share a law.
        label: of the run, or a list of labels.

    Returns:
        The axes.

    Raises:
        ParameterError: naming the argument; ``contacts`` if none of them ever carried load.
        DimensionError: if the law is not planar.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import FrictionLaw, MassOnBelt, simulate
    >>> from asperity.plot import plot_forces_in_reservoir
    >>> law = FrictionLaw.isotropic(0.5)
    >>> belt = MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[0.1, 0.0])
    >>> ax = plot_forces_in_reservoir(simulate(belt, dt=1e-2, t_end=10.0))
    >>> [line.get_label() for line in ax.lines]
    ['$C$', 'stick', 'slip']
    """
    found = chosen.runs(run)
    shared = _shared_law([one for _, one in found], contacts) if law is None else law
    reservoir = look.planar_law(shared).reservoir
    names = chosen.labels(found, label)
    drawn: list[tuple[dict[str, Any], Any]] = []
    for number, ((_, one), name) in enumerate(zip(found, names, strict=True)):
        wanted = chosen.numbers(contacts, one.phase.shape[1], "contacts")
        load, phase = one.normal_force[:, wanted], one.phase[:, wanted]
        carried = load > _UNLOADED * np.nanmax(load, initial=0.0)
        ratio = -one.force[:, wanted, :2] / np.where(carried, load, np.nan)[..., None]
        for kind, (color, text) in chosen.PHASES.items():
            points = ratio[carried & (phase == kind)]
            if len(points):
                label_of = text if name is None else f"{text}, {name}"
                marker = _MARKERS[number % len(_MARKERS)]
                look_of = {"color": color, "marker": marker, "markersize": 3.0, "label": label_of}
                drawn.append((look_of, points))
    if not drawn:
        raise ParameterError("contacts", "must have carried load, these never did")
    with look.drawing(ax) as ax:
        draw_set(ax, reservoir, color=look.INK, label="$C$")
        for options, points in drawn:
            ax.plot(*points.T, linestyle="none", **options)
        ax.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
        ax.legend(ncols=min(len(drawn) + 1, 3), **look.BELOW)
        return ax


def _shared_law(runs: Sequence[Run], contacts: int | Sequence[int] | None) -> FrictionLaw:
    """Return the law that the contacts of some runs share."""
    found: list[FrictionLaw] = []
    for run in runs:
        wanted = chosen.numbers(contacts, run.phase.shape[1], "contacts")
        if run.system is None:
            raise ParameterError("law", "must be given, the run has no system")
        laws = laws_of(run.system)
        for number in wanted:
            law = laws[number]
            if law not in found:
                found.append(law)
    if len(found) > 1:
        raise ParameterError(
            "contacts", f"must share a law, these have {len(found)} different ones"
        )
    if not found:
        raise ParameterError("contacts", "must have carried load, there are none")
    return found[0]
