"""What paths do not tell, and what the models do not hold of them, in sentences."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.identify.evidence.paths.launch import PLACE, SPEED
from asperity.identify.evidence.paths.solution import Solution
from asperity.identify.models.coordinates import Scale
from asperity.law import Stribeck

SCALE = "paths determine the shape of D, not its size: direction.scale has no value"
"""What no paths tell."""

# Differences at two step sizes agree to this share of a column.
_SAME_SLOPE = 1e-2
# Points that are so many times farther from the paths than their errors are not explained.
_MISFIT = 1.5
# Angles of two laws that differ by less are the same.
_SAME_ANGLE = math.radians(5.0)
# Half-widths of confidence intervals with which parameters are told hardly, and not at all:
# logarithms, and angles.
_VAGUE, _LOST = math.log(2.0), math.log(10.0)
_VAGUE_ANGLE, _LOST_ANGLE = math.pi / 8.0, math.pi / 4.0
# Coefficients of friction of no known surfaces are below.
_LEAST = 1e-4
# Friction is changed by this share to see what follows.
_PART = 0.01
_AROUND = np.arange(24) * (math.pi / 12.0)


def longer(solution: Solution) -> Array:
    """Return how residuals change, per unit, if all measured lengths are longer by a factor."""
    launches = solution.misfits.launches(solution.z)
    return solution.misfits.moved(
        [
            launch[PLACE] - path.position
            for path, launch in zip(solution.misfits.paths, launches, strict=True)
        ]
    )


def _faster(solution: Solution) -> tuple[Array, float] | None:
    """Return how residuals change, per unit, with a factor of friction that grows with the speed.

    The factor is larger by that unit at the median of the launch speeds, which is returned too.
    """
    misfits = solution.misfits
    launches = misfits.launches(solution.z)
    speed, part = float(np.median(launches[:, SPEED])), _PART
    law = solution.structure.law(solution.coordinates)
    known = solution.motions.law.rate or Stribeck(speed, ratio=1.0)
    faster = known.replace(viscous=known.viscous + part / speed)
    count = len(launches)
    found = solution.motions.paths([law] * count, launches, range(count), rate=faster)
    usual = solution.motions.paths([law] * count, launches, range(count))
    if found is None or usual is None:
        return None
    moved = [(a.position - b.position) / part for a, b in zip(found, usual, strict=True)]
    change = misfits.moved(moved)
    return change, speed


def speed_limit(solution: Solution) -> str:
    """Return a sentence on what paths cannot tell: the size of C from a dependence on the speed."""
    taken = (
        "friction is taken as independent of the speed"
        if solution.motions.law.rate is None
        else "the dependence of friction on the speed is taken from the system"
    )
    found = _faster(solution)
    if found is None:
        return f"{taken}: paths tell it hardly apart from the size of C"
    change, speed = found
    left = [change[solution.misfits.of(k)] for k in range(len(solution.misfits.paths))]
    # What no change of the launches or of the law mimics.
    scale = np.linalg.norm(solution.jacobian, axis=0)
    basis = np.linalg.qr(solution.jacobian / scale)[0]
    rest = np.concatenate(left) - basis @ (basis.T @ np.concatenate(left))
    told = 1.0 / max(float(np.linalg.norm(rest)), 1e-12)
    launched = solution.misfits.launches(solution.z)[:, SPEED]
    moved = _changes(solution, 0.01 * solution.response(change), signed=True)
    fell = "it fell by 1 %" if solution.motions.law.rate is None else "it fell by another 1 %"
    return (
        f"{taken}: if {fell} from rest to {speed:.3g} m/s, the fit would change "
        f"{moved}; fitted as well, such a fall would have a standard error of "
        f"{100.0 * told:.2g} %, with launches at {launched.min():.3g} to {launched.max():.3g} m/s"
    )


def _changes(solution: Solution, step: Array, *, signed: bool = False) -> str:
    """Return by how much steps of the free coordinates change the parameters."""
    structure, p = solution.structure, solution.coordinates
    return ", ".join(
        structure.change(structure.names[at], p[at], moved, signed=signed)
        for at, moved in zip(solution.free, step.tolist(), strict=True)
    )


def not_told(solution: Solution, widths: Array) -> NDArray[np.bool_]:
    """Return which of the free coordinates paths leave open.

    Those are the ones whose confidence intervals have no end that says anything, and those that
    another law, as near to the paths, has outside of them.

    Args:
        solution: of the fit.
        widths: half-widths of the confidence intervals of the free coordinates, NaN without.
    """
    result: NDArray[np.bool_] = widths > _ends(solution, _LOST, _LOST_ANGLE)
    rival = _rival(solution)
    if rival is not None:
        off = rival - solution.coordinates[solution.free]
        quarter = 0.5 * math.pi
        angles = np.isfinite(_ends(solution, math.inf, 0.0))
        off[angles] -= quarter * np.round(off[angles] / quarter)
        result |= np.abs(off) > widths
    return result


def _ends(solution: Solution, logarithm: float, angle: float) -> Array:
    """Return limits of the half-widths of the free coordinates."""
    scales = [solution.structure.coordinates[at][1].scale for at in solution.free]
    return np.array([angle if one is Scale.ANGLE else logarithm for one in scales])


def _hardly_told(solution: Solution, widths: Array) -> list[str]:
    """Return sentences on parameters that paths tell hardly, or not at all."""
    lost, hardly = not_told(solution, widths), widths > _ends(solution, _VAGUE, _VAGUE_ANGLE)
    names = [solution.structure.names[at] for at in solution.free]
    sentences = []
    blind = [name for name, one in zip(names, lost, strict=True) if one]
    if blind:
        verb = "is" if len(blind) == 1 else "are"
        sentences.append(f"{', '.join(blind)} {verb} not identifiable: {solution.remedy}")
    vague = []
    for at, width, one in zip(solution.free, widths, hardly & ~lost, strict=True):
        name, coordinate = solution.structure.coordinates[at]
        if not one:
            continue
        if coordinate.scale is Scale.ANGLE:
            vague.append(f"{name} to ±{math.degrees(width):.0f}°")
        elif coordinate.scale is Scale.PLAIN:
            vague.append(f"{name} to ±{width:.2g}")
        else:
            whole = " - 1" if coordinate.scale is Scale.LOG_EXCESS else ""
            vague.append(f"{name}{whole} to a factor of {math.exp(width):.2g}")
    if vague:
        sentences.append(f"these paths tell {', '.join(vague)} only: {solution.remedy}")
    return sentences


def warnings_of(
    solution: Solution,
    alone: NDArray[np.bool_],
    widths: Array,
    by_length: Array,
    length_error: float | None,
) -> tuple[str, ...]:
    """Return sentences on what the paths cannot tell or the models cannot hold."""
    sentences = []
    names = [solution.structure.names[at] for at in solution.free]
    if len(solution.misfits.paths) == 1:
        sentences.append(
            "there are no confidence intervals: one path has no scatter between paths; measure at "
            "least 3 paths (10 are better)"
        )
    if alone.any():
        listed = ", ".join(n for n, one in zip(names, alone, strict=True) if one)
        sentences.append(
            f"one path alone tells {listed}, with nothing to compare it with: {solution.remedy}"
        )
    sentences += _hardly_told(solution, np.where(alone, np.nan, widths))
    round_size = solution.structure.law(solution.coordinates).reservoir.radius(_AROUND)
    coefficient = float(np.exp(np.log(round_size).mean()))
    if coefficient < _LEAST:
        sentences.append(
            f"coefficients of friction are about {coefficient:.2g}, which no known surfaces have: "
            "check the units of times and lengths, those of the system, and what is stated of the "
            "launches"
        )
    if length_error is None:
        sentences.append(
            "the error of the length scale is not known: 1 % would change "
            f"{_changes(solution, 0.01 * by_length)}; the confidence intervals do not include "
            "this: state length_error"
        )
    if solution.misfit > _MISFIT:
        sentences.append(
            f"the model does not fit: points are {solution.misfit:.2g} times as far from the paths "
            "as their standard errors say; the law, the system, the launches or the errors are not "
            "as stated"
        )
    if solution.slope_error > _SAME_SLOPE:
        sentences.append(
            f"derivatives by differences of paths differ by {solution.slope_error:.2g} between two "
            "step sizes: paths jump with the parameters, and the confidence intervals are not exact"
        )
    stuck = solution.structure.stuck(solution.coordinates)
    sentences += [sentence for name, sentence in stuck.items() if name in names]
    sentences += _other_minima(solution)
    return tuple(sentences)


def _rival(solution: Solution) -> Array | None:
    """Return the free coordinates of another law that is as near to the paths, if there is one."""
    at = solution.structure.names.index("reservoir.angle") if solution.others else 0
    mine = solution.coordinates[at]
    for other in solution.others:
        angle = other[solution.free.tolist().index(at)]
        off = abs((angle - mine + 0.25 * math.pi) % (0.5 * math.pi) - 0.25 * math.pi)
        if off >= _SAME_ANGLE:
            return other
    return None


def _other_minima(solution: Solution) -> list[str]:
    """Return a sentence if another law is as near to the paths."""
    rival = _rival(solution)
    if rival is None:
        return []
    full = solution.held.copy()
    full[solution.free] = rival
    values = solution.structure.values(full)
    listed = ", ".join(
        f"{name} = {value:.4g}"
        for name, value in zip(solution.structure.names, values.tolist(), strict=True)
        if name.startswith("reservoir")
    )
    return [
        f"another set C is as near to the paths: {listed}; launch in directions all around, or "
        "fix the angles of the sets if they are known"
    ]
