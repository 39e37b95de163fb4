"""Whether a wrong sign, unit, frame or point of reference explains why wrenches fit no law."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.estimator.loss import LossName
from asperity.identify.estimator.mistakes import Mistake, explaining
from asperity.identify.evidence.wrenches.pairs import MOST_AGAINST, Pairs
from asperity.identify.evidence.wrenches.solving import fitted, starts_of
from asperity.identify.models.patches import OffsetPatch, PatchModel

# A mistake explains a misfit that it makes smaller than this part; of those that explain the same,
# up to this factor, none can be told from the others. Where one leaves less than this, nothing is
# left for another point to explain better.
_EXPLAINED, _AS_GOOD, _CLOSE = 0.5, 1.1, 0.1
# By what the components of wrench and twist are multiplied to give the ones that are meant. Where a
# model finds lengths by itself, some of them are the same.
_DEGREE = math.pi / 180.0
_FACTORS = (
    ("the sign of the torque or of the rotation turned", (1.0, 1.0, -1.0), (1.0, 1.0, 1.0)),
    ("torques divided by 1000, as of N mm for N m", (1.0, 1.0, 1e-3), (1.0, 1.0, 1.0)),
    ("velocities divided by 1000, as of mm/s for m/s", (1.0, 1.0, 1.0), (1e-3, 1e-3, 1.0)),
    ("rotations in rad for those in degrees", (1.0, 1.0, 1.0), (1.0, 1.0, _DEGREE)),
    ("points divided by 1000, as of mm for m", (1.0, 1.0, 1e3), (1.0, 1.0, 1e-3)),
    ("the sign of the first force turned", (-1.0, 1.0, 1.0), (1.0, 1.0, 1.0)),
    ("the sign of the second force turned", (1.0, -1.0, 1.0), (1.0, 1.0, 1.0)),
)


def mistake(
    model: PatchModel,
    p: Array,
    pairs: Pairs,
    loss: LossName,
    *,
    length: float,
    in_ground: bool,
) -> Mistake | None:
    """Return what explains that wrenches are as far from a model as they are.

    Args:
        model: the law's family.
        p: where its coordinates ended.
        pairs: of wrench and twist.
        loss: of the components of the wrench.
        length: ℓ, in whose unit places are said.
        in_ground: whether wrenches and twists were given in the axes of the ground.
    """
    misfit = _relative(model, p, pairs)
    found = [
        Mistake(words, off)
        for words, meant in _meant(pairs, in_ground=in_ground)
        if (off := _misfit(model, meant, loss)) is not None
    ]
    least = min((one.misfit for one in found), default=math.inf)
    moved = _about_another_point(model, pairs, loss, length)
    if moved is not None and (moved.misfit <= _AS_GOOD * least or least > _CLOSE):
        # It has two unknowns more, and must do better than what has none.
        found = [one for one in found if moved.misfit > _EXPLAINED * one.misfit]
        found.append(moved)
    good = explaining(found, most=_EXPLAINED * misfit, as_good=_AS_GOOD)
    if not good:
        return None
    return Mistake(" or ".join(one.words for one in good), min(one.misfit for one in good))


def _meant(pairs: Pairs, *, in_ground: bool) -> Iterator[tuple[str, Pairs]]:
    """Yield pairs as they would be without a mistake, with the words that follow "with"."""
    for words, of_wrench, of_twist in _FACTORS:
        yield words, pairs.replace(wrench=pairs.wrench * of_wrench, twist=pairs.twist * of_twist)
    yield "the two forces swapped", pairs.replace(wrench=pairs.wrench[:, [1, 0, 2]])
    if pairs.angle is None:
        return
    if in_ground:
        yield (
            "wrenches and twists in the axes of the body",
            pairs.replace(wrench=pairs.to_ground(pairs.wrench), twist=pairs.to_ground(pairs.twist)),
        )
        ground = pairs.to_ground(pairs.wrench), pairs.to_ground(pairs.twist)
        turned = pairs.replace(angle=_DEGREE * pairs.angle)
        yield (
            "angles in rad for those in degrees",
            turned.replace(wrench=turned.to_body(ground[0]), twist=turned.to_body(ground[1])),
        )
        return
    body = pairs.to_body(pairs.wrench), pairs.to_body(pairs.twist)
    yield "wrenches in the axes of the ground", pairs.replace(wrench=body[0])
    yield "twists in the axes of the ground", pairs.replace(twist=body[1])
    yield (
        "wrenches and twists in the axes of the ground",
        pairs.replace(wrench=body[0], twist=body[1]),
    )
    yield "angles in rad for those in degrees", pairs.replace(angle=_DEGREE * pairs.angle)


def _misfit(model: PatchModel, pairs: Pairs, loss: LossName) -> float | None:
    """Return how far the law that fits about best is from wrenches, relative to these."""
    if pairs.against > MOST_AGAINST:
        return None
    try:
        found = fitted(model, pairs, starts_of(model, pairs, loss), loss, roughly=True)
    except (FitError, np.linalg.LinAlgError):
        return None
    return _relative(model, found.p, pairs)


def _about_another_point(
    model: PatchModel, pairs: Pairs, loss: LossName, length: float
) -> Mistake | None:
    """Return how well torques about another point of the body would fit."""
    offset = OffsetPatch(model)
    try:
        starts = [np.append(one, [0.0, 0.0]) for one in starts_of(model, pairs, loss)]
        found = fitted(offset, pairs, starts, loss)
    except (FitError, np.linalg.LinAlgError):
        return None
    x, y = length * found.p[-2:]
    return Mistake(
        f"torques taken as those about ({x:.3g}, {y:.3g}) instead of (0, 0)",
        _relative(offset, found.p, pairs),
    )


def _relative(model: PatchModel, p: Array, pairs: Pairs) -> float:
    """Return the misfit of forces and torques relative to each, whatever the unit of torques."""
    off, squares = model.both(p, pairs)[0] - pairs.wrench, (pairs.wrench**2).sum(axis=0)
    sizes = [float(squares[:2].sum()), float(squares[2])]
    # Where one of the two vanishes, only the other one tells how large wrenches are.
    sizes = [one or sum(sizes) for one in sizes]
    errors = (off**2).sum(axis=0)
    return math.sqrt(0.5 * (float(errors[:2].sum()) / sizes[0] + float(errors[2]) / sizes[1]))
