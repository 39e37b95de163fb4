"""What a fit cannot tell or hold: directions without forces, forces of no such sets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.evidence.coefficient.dependence import load_dependence, several_loads
from asperity.identify.evidence.forces.samples import WRAPPED, is_wrapped

if TYPE_CHECKING:
    from asperity.identify.evidence.forces.result import Fit

SETS = (
    "reservoir is the force reservoir C, whose outline is the friction coefficient over the "
    "direction of the force; direction is the direction set D, whose shape says how the force is "
    "turned against the sliding."
)
"""What the names of the parameters begin with, for who sees them first."""

UNITS_AND_SCALE = (
    "Semi-axes are per unit normal force. Forces determine the shape of D, not its size: "
    "direction.scale has no value."
)
"""What stands below the parameters of every fit."""

# So many samples that are half as large again as the others move Cauchy's loss by half a standard
# error: 33 of 40 confidence intervals of 95 % held the truth with 5 %, 37 of 40 with 1 % and with
# none.
_MUCH = 0.03
# Few dry pairings have larger coefficients; kgf for N makes those above 0.2 as large.
_LARGE = 2.0
# Between forces farther apart than this, the shape of C is a guess of its model.
_WIDEST_GAP = np.deg2rad(30.0)
# Farther apart, forces turn by as much as that without a leap.
_NEIGHBOURS = np.deg2rad(15.0)


def gaps(phi: Array, force: Array) -> list[tuple[float, float]]:
    """Return the arcs of the force's direction, in rad, over which it turns between neighbours.

    Forces of neighbouring sliding directions leave such an arc out where they turn much farther
    than the sliding does. A mean over a jump of the force lies anywhere. What strokes in few
    directions leave out between them is no leap, and makes intervals wide.

    Args:
        phi: rising sliding directions over one turn in rad.
        force: mean forces there.
    """
    turn = 2.0 * np.pi
    theta = np.arctan2(force[:, 1], force[:, 0])
    theta = phi + (theta - phi + np.pi) % turn - np.pi
    # Over two steps, one of which is to a mean over the jump.
    later = (np.append(values, values[:2] + turn)[2:] for values in (theta, phi))
    ends, steps = next(later), next(later) - phi
    arcs: list[tuple[float, float]] = []
    for a, b, step in zip(theta.tolist(), ends.tolist(), steps.tolist(), strict=True):
        if step < _NEIGHBOURS and b - a - step > _WIDEST_GAP:
            first = arcs.pop()[0] if arcs and a < arcs[-1][1] else a
            arcs.append((first, b))
    return arcs


def warnings_of(fit: Fit) -> tuple[str, ...]:
    """Return sentences on what the data cannot tell or the models cannot hold."""
    sentences = _records_missing(fit)
    if fit.turns == 1:
        cure = "record at least 2 turns (10 are better)"
        sentences.append(
            "there are no confidence intervals: one complete turn has no scatter between turns; "
            + (WRAPPED if is_wrapped(fit._samples) else cure)
        )
    sentences += fit.family.structure.stuck(fit.coordinates).values()
    if fit.undetermined.any():
        open_ones = [n for n, one in zip(fit.parameters, fit.undetermined, strict=False) if one]
        sentences.append(
            f"{' and '.join(open_ones)} are not identifiable: forces in {fit.coverage} do not tell "
            "them apart: choose models with fewer parameters, or record directions between"
        )
    if fit.gaps:
        arcs = ", ".join(f"{a:.0f}°…{b:.0f}°" for a, b in np.rad2deg(fit.gaps))
        sentences.append(f"C is not identifiable: hardly any force has a direction θ within {arcs}")
    friction = float(np.median(np.linalg.norm(fit.means[1], axis=-1)))
    if friction > _LARGE and getattr(fit.data, "raw", None) is not None:
        sentences.append(
            f"friction coefficients are {friction:.2g}, above {_LARGE:g}: is the normal force in "
            "kgf, under the heading N, or a channel in another unit?"
        )
    defects = fit.defects
    if "closure" in defects and defects["closure"].matters:
        raw = getattr(fit.data, "raw", None)
        cause = ", as crosstalk of a sensor makes them: give a [calibration]"
        sentences.append(
            "the forces are inconsistent with any direction set (closure "
            f"{defects['closure'].size:.3g}, expected 1)"
            + (cause if raw is not None and raw.calibration is None else "")
        )
    if "asymmetry" in defects and defects["asymmetry"].matters:
        sentences.append(
            f"the forces are not symmetric: even harmonics are {defects['asymmetry'].size:.1%} of "
            "them, which only odd Fourier models hold"
        )
    if "lack of fit" in defects and defects["lack of fit"].matters:
        other = fit.mistake
        explained = (
            ""
            if other is None
            else f"; with {other.words}, they would deviate by {other.misfit:.1%}: check it"
        )
        sentences.append(
            f"the model does not fit: mean forces deviate by "
            f"{defects['lack of fit'].size:.1%}, more than the turn-to-turn scatter; the "
            f"confidence intervals do not include this{explained}"
        )
    return (*sentences, *_unlike_noise(fit))


def _unlike_noise(fit: Fit) -> list[str]:
    """Return what confidence intervals do not include: outliers, drift, steps."""
    sentences = []
    far, kind = fit.outliers, fit.loss.kind
    follows = {
        "linear": far.matters,
        "soft_l1": far.one_sided,
        "huber": far.one_sided,
        "cauchy": far.one_sided and far.share > _MUCH,
    }
    # Where steps are coarse, most readings are equal and the others are no outliers.
    if follows[kind] and not fit.coarse_channels:
        side = ", most of them on one side" if far.one_sided else ""
        remedy = "leave them out" if kind == "cauchy" else "choose the loss 'cauchy'"
        sentences.append(
            f"{far.share:.2g} of the samples are outliers{side}, which the loss {kind!r} follows; "
            f"the confidence intervals do not include this: {remedy}"
        )
    if fit.drift.matters:
        sentences.append(
            f"forces drift by {fit.drift.size:+.2%} from the first turn of a run to its last: a "
            "gain, a zero or the friction changes; the confidence intervals do not include this"
        )
    sentences += _runs(fit)
    for channel, step, noise in fit.coarse_channels:
        sentences.append(
            f"the {channel} channel has steps of {step:.3g}, which its noise of {noise:.2g} does "
            "not blur: errors of rounding follow the force, and the confidence intervals do not "
            "include them"
        )
    return sentences


def _runs(fit: Fit) -> list[str]:
    """Return by how much two runs differ, or how coefficients at several loads do."""
    loads, found = several_loads(fit.data), fit.mountings
    differ = f"friction coefficients differ between loads of {_enumerated(loads)} N"
    if found is not None and found.matters:
        remedy = "fit each load on its own" if loads else "record a third, or fit each on its own"
        if fit.confidence is not None:
            remedy = f"the confidence intervals take the runs for two values; {remedy}"
        return [
            f"{differ if loads else 'the two runs differ'} by more than turns scatter: from the "
            f"first run to the second, forces per unit normal force change by {found.level:+.2%} "
            f"(from turn to turn by {found.scatter:.2%}), {_changes(fit, np.abs(found.steps))}; "
            f"{remedy}"
        ]
    if len(loads) > 2:
        power = load_dependence(fit.data)
        if not power.is_independent:
            return [
                f"{differ}: they go with the load to the power {power.exponent:.2g} "
                f"({power.low:.2g} … {power.high:.2g}), and one law for all is a mean of them: fit "
                "each load on its own"
            ]
    return []


def _enumerated(loads: Sequence[float]) -> str:
    """Return each load once."""
    *others, last = dict.fromkeys(f"{one:.4g}" for one in loads) or [""]
    return f"{', '.join(others)} and {last}"


_ERRORS = {
    "calibration": "the error of the gains is not known, 1 % in one channel",
    "zeros": "the error of the zeros is not known, 1 % of the normal force in one channel",
}
_STATED = {
    "calibration": "gain_error, the standard error of the gains",
    "zeros": "zero_error, the standard error of the zeros in N",
}
# Models of many coordinates are spoken of by those that move most.
_MOST_NAMED = 6


def _records_missing(fit: Fit) -> list[str]:
    """Return what errors of which nothing is known would do to the parameters."""
    bands = "" if fit.covariance is None else "; the confidence intervals do not include this"
    return [
        f"{what}: {_ERRORS[cause]} would change {_changes(fit, moved)}{bands}: "
        f"record it, or state {_STATED[cause]}"
        for cause, (what, moved) in fit.missing.items()
    ]


def _changes(fit: Fit, moved: Array) -> str:
    """Return by how much steps of the coordinates change the parameters that are known."""
    structure = fit.family.structure
    changes = [
        (step, structure.change(name, x, step))
        for name, x, step in zip(structure.names, fit.coordinates, moved.tolist(), strict=True)
        if fit.parameters[name].identifiable
    ]
    if len(changes) > _MOST_NAMED + 1:
        changes = sorted(changes, key=lambda change: -change[0])[:_MOST_NAMED]
    return ", ".join(text for _, text in changes)
