"""Histories: what a run does over time, with the phases of its contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.plot import look
from asperity.plot.runs import chosen
from asperity.plot.runs.chosen import Drawable
from asperity.runs.run import Run
from asperity.track import MeasuredPath

_OF_COORDINATES = {
    "q": ("coordinates $q$", ""),
    "u": ("velocities $u$", ""),
    "speed": ("speed", "speed in m/s"),
}
_OF_CONTACTS = {
    "slip": (r"$\gamma$", r"slip $\gamma$ in m/s"),
    "slip_speed": (r"$\|\gamma\|$", r"slip speed $\|\gamma\|$ in m/s"),
    "force": (r"$\lambda$", r"friction force $\lambda$ in N"),
    "friction": (r"$\|\lambda\|$", r"friction $\|\lambda\|$ in N"),
    "normal_force": (r"$\lambda_N$", r"normal force $\lambda_N$ in N"),
    "coefficient": (r"$\|\lambda\|/\lambda_N$", r"$\|\lambda\|/\lambda_N$"),
}
_MEASURED = {
    "q": ("position", "position_error", "$q$", "position in m"),
    "u": ("velocity", "velocity_error", r"$\dot q$", "velocity in m/s"),
    "speed": ("", "", "speed", "speed in m/s"),
    "acceleration": ("acceleration", "acceleration_error", r"$\ddot q$", "acceleration in m/s²"),
}
QUANTITIES = (*_OF_COORDINATES, "acceleration", *_OF_CONTACTS)
"""What may be drawn over time."""

# Legends with more entries are put beside the axes.
_BESIDE = 4
# Of more curves of a run, colours follow the order and so many are named, evenly spread.
_NAMED = 8
# Height of the bar of a contact, most of all bars and the space above them, relative to the height
# of the axes.
_BAR, _BARS, _SPACE = 0.055, 0.22, 0.03
_DASHES = ("-", (0, (5.0, 1.5)), (0, (1.2, 1.2)))


def plot_history(
    run: Drawable | MeasuredPath | Sequence[Any] | Mapping[str, Any],
    *,
    quantity: str = "u",
    ax: Axes | None = None,
    coordinates: int | Sequence[int] | None = None,
    contacts: int | Sequence[int] | None = None,
    phases: bool = True,
    label: str | Sequence[str] | None = None,
    **kwargs: Any,
) -> Axes:
    """Draw a quantity over time, and below it a bar per contact that is coloured by its phases.

    Args:
        run: a `Trajectory`, a `Motion`, a `LimitCycle` or a `MeasuredPath`, or several of them in
            a list or, by their labels, in a dict.
        quantity: of coordinates ``"q"``, ``"u"`` or ``"speed"``, the norm of the velocities; of
            contacts ``"slip"``, ``"slip_speed"``, ``"force"``, ``"friction"`` (‖λ‖),
            ``"normal_force"`` or ``"coefficient"`` (‖λ‖/λ_N). Of measured paths ``"q"``, ``"u"``,
            ``"speed"`` or ``"acceleration"``, with bands of two standard errors.
        ax: axes; default new ones.
        coordinates: numbers of the coordinates, of ``"u"`` and ``"speed"`` those of the
            velocities. Default all; of ``"speed"`` the first two.
        contacts: numbers of the contacts, also of those with bars; default all.
        phases: whether to draw the bars.
        label: of the run, or a list of labels.
        **kwargs: of the lines, as for ``Axes.plot``.

    Returns:
        The axes of the lines; those of the bars are its only ``child_axes``.

    Raises:
        ParameterError: naming the argument.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import FrictionLaw, MassOnBelt, simulate
    >>> from asperity.plot import plot_history
    >>> belt = MassOnBelt(
    ...     1.0,
    ...     stiffness=1.0,
    ...     law=FrictionLaw.isotropic(0.5),
    ...     normal_force=1.0,
    ...     belt_velocity=[0.1, 0.0],
    ... )
    >>> ax = plot_history(simulate(belt, dt=1e-2, t_end=10.0), quantity="slip_speed")
    >>> len(ax.lines), len(ax.child_axes)
    (1, 1)
    """
    arrays.choice(quantity, "quantity", QUANTITIES)
    found = chosen.runs_or_measured(run)
    names = chosen.labels(found, label)
    curves = [_curves(one, quantity, coordinates, contacts) for _, one in found]
    bars = [
        (name, one, number)
        for name, (_, one) in zip(names, found, strict=True)
        if phases and isinstance(one, Run)
        for number in chosen.numbers(contacts, one.phase.shape[1], "contacts")
        if one.phase.shape[1]
    ]
    with look.drawing(ax) as ax:
        options = look.line_options(kwargs)
        for number, ((_, one), name, own) in enumerate(zip(found, names, curves, strict=True)):
            time = one.time if isinstance(one, MeasuredPath) else one.t
            many = len(own) > _NAMED
            named = _spread(len(own), _NAMED)
            for part, (text, values, error) in enumerate(own):
                together = ", ".join(t for t in (text if len(own) > 1 else "", name) if t)
                # Parts of one run differ in colour, runs with several parts in dashes.
                dashes = _DASHES[number % len(_DASHES)] if len(own) > 1 else "-"
                color: Any = look.color(part if len(own) > 1 else number)
                if many:
                    color = colormaps["viridis"](part / (len(own) - 1))
                label_here = together if part in named else ""
                line_look = {"color": color, "linestyle": dashes, "label": label_here or None}
                (line,) = ax.plot(time, values, **{**line_look, **options})
                if error is not None:
                    band = values - 2.0 * error, values + 2.0 * error
                    ax.fill_between(time, *band, color=line.get_color(), alpha=0.25, linewidth=0.0)
        ax.set_xlabel("time in s")
        ax.set_ylabel(_axis_label(found, quantity, coordinates))
        ax.margins(x=0.0)
        seen = _draw_bars(ax, bars) if bars else []
        handles, texts = ax.get_legend_handles_labels()
        handles += [Patch(color=chosen.PHASES[phase][0]) for phase in seen]
        texts += [chosen.PHASES[phase][1] for phase in seen]
        if texts:
            if len(texts) > _BESIDE:
                # Long lists would cover what is drawn.
                ax.legend(
                    handles, texts, loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small"
                )
            else:
                ax.legend(handles, texts)
        return ax


def _spread(count: int, most: int) -> list[int]:
    """Return numbers of things that are named of so many: all, or the first, the last and some."""
    return list(np.linspace(0, count - 1, min(count, most)).round().astype(int).tolist())


_Curve = tuple[str, Array, Array | None]


def _curves(
    run: Run | MeasuredPath,
    quantity: str,
    coordinates: int | Sequence[int] | None,
    contacts: int | Sequence[int] | None,
) -> list[_Curve]:
    """Return name, values and standard errors of the curves of a quantity."""
    if isinstance(run, MeasuredPath):
        return _measured(run, quantity, coordinates)
    if quantity == "acceleration":
        raise ParameterError("quantity", "'acceleration' is known of measured paths only")
    if quantity in _OF_COORDINATES:
        return _of_coordinates(run, quantity, coordinates)
    wanted = chosen.numbers(contacts, run.phase.shape[1], "contacts")
    name = _OF_CONTACTS[quantity][0]
    values: Array = getattr(run, quantity) if quantity in ("slip", "force") else np.empty(0)
    curves: list[_Curve] = []
    for number in wanted:
        contact = run.contact_names[number]
        of = "" if len(wanted) == 1 else f" of {contact}"
        if quantity in ("slip", "force"):
            for part in range(values.shape[2]):
                one = values[:, number, part]
                if np.isfinite(one).any():
                    curves.append((f"{name[:-1]}_{{{part + 1}}}$" + of, one, None))
        else:
            # The axis says what is drawn of each contact.
            curves.append((contact if of else name, _scalar(run, quantity, number), None))
    return curves


def _scalar(run: Run, quantity: str, contact: int) -> Array:
    """Return one number per sample of a contact; components that it does not have count as 0."""
    load = run.normal_force[:, contact]
    if quantity == "normal_force":
        return load
    vectors = (run.slip if quantity == "slip_speed" else run.force)[:, contact]
    known = np.isfinite(vectors)
    norms: Array = np.linalg.norm(np.where(known, vectors, 0.0), axis=1)
    norms[~known.any(axis=1)] = np.nan
    if quantity == "coefficient":
        norms = norms / np.where(load > 0.0, load, np.nan)
    return norms


def _of_coordinates(
    run: Run, quantity: str, coordinates: int | Sequence[int] | None
) -> list[_Curve]:
    values = run.q if quantity == "q" else run.u
    count = values.shape[1]
    if quantity == "speed":
        two = range(min(2, count)) if coordinates is None else coordinates
        parts = chosen.numbers(list(two) if isinstance(two, range) else two, count, "coordinates")
        return [("speed", np.linalg.norm(values[:, parts], axis=1), None)]
    parts = chosen.numbers(coordinates, count, "coordinates")
    names = run.coordinate_names if quantity == "q" else run.velocity_names
    return [(names[part], values[:, part], None) for part in parts]


def _measured(
    path: MeasuredPath, quantity: str, coordinates: int | Sequence[int] | None
) -> list[_Curve]:
    if quantity not in _MEASURED:
        raise ParameterError(
            "quantity", f"{quantity!r} is not known of measured paths, which have no contacts"
        )
    values, error, symbol, _ = _MEASURED[quantity]
    if quantity == "speed":
        speed = np.hypot(*path.velocity.T)
        along = path.velocity / np.maximum(speed, np.finfo(float).tiny)[:, None]
        return [("speed", speed, np.sqrt(((along * path.velocity_error) ** 2).sum(axis=1)))]
    parts = chosen.numbers(coordinates, 2, "coordinates")
    return [
        (
            f"{symbol[:-1]}_{{{part + 1}}}$",
            getattr(path, values)[:, part],
            np.broadcast_to(getattr(path, error), path.position.shape)[:, part],
        )
        for part in parts
    ]


def _axis_label(
    found: Sequence[tuple[str | None, Any]],
    quantity: str,
    coordinates: int | Sequence[int] | None,
) -> str:
    if any(isinstance(one, MeasuredPath) for _, one in found):
        return _MEASURED[quantity][3]
    if quantity in ("q", "u"):
        units = [
            (one.coordinate_units if quantity == "q" else one.velocity_units)[part]
            for _, one in found
            for part in chosen.numbers(coordinates, getattr(one, quantity).shape[1], "coordinates")
        ]
        return chosen.titled(_OF_COORDINATES[quantity][0], " or ".join(dict.fromkeys(units)))
    return {**_OF_COORDINATES, **_OF_CONTACTS}[quantity][1]


def _draw_bars(ax: Axes, bars: Sequence[tuple[str | None, Run, int]]) -> list[Any]:
    """Draw a bar per contact below the axes and return the phases that occur."""
    height = min(_BAR * len(bars), _BARS)
    strip = ax.inset_axes((0.0, -height - _SPACE, 1.0, height), sharex=ax)
    seen = []
    for row, (_, run, contact) in enumerate(bars):
        for phase, spans in chosen.phase_intervals(run, contact).items():
            strip.broken_barh(spans, (row - 0.4, 0.8), color=chosen.PHASES[phase][0], linewidth=0.0)
            seen.append(phase)
    strip.set_ylim(len(bars) - 0.5, -0.5)
    names = [
        ", ".join(text for text in (name, run.contact_names[contact]) if text)
        for name, run, contact in bars
    ]
    rows = _spread(len(bars), round(height / _BAR))
    shown = [names[row] for row in rows] if len(bars) > 1 else ["phase"]
    strip.set_yticks(rows, shown, fontsize="small")
    strip.tick_params(axis="y", length=0.0)
    strip.grid(False)
    for spine in strip.spines.values():
        spine.set_visible(False)
    ax.tick_params(axis="x", labelbottom=False, length=0.0)
    strip.set_xlabel(ax.get_xlabel())
    ax.set_xlabel("")
    return [phase for phase in chosen.PHASES if phase in seen]
