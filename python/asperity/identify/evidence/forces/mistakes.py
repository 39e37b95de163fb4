"""Whether a wrong sign or swapped channels explain why forces belong to no law of a model."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.estimator.mistakes import Mistake, explaining
from asperity.identify.evidence.forces.bins import Bins, along_sliding
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.samples import channels_turn, is_angled
from asperity.identify.evidence.forces.starts import fit_bins, has_directions, start

# By what the components that were taken for those along the sliding and across it are multiplied,
# to give the ones that are meant. The mirror image of a law is a law: nothing tells a wrong
# sense of the rotation from a wrong sign of the tangential channel.
_OF_CHANNELS = (
    ("the sign of the radial channel turned", ((1.0, 0.0), (0.0, -1.0))),
    ("the sign of the tangential channel or of the rotation turned", ((-1.0, 0.0), (0.0, 1.0))),
    ("the signs of the tangential and the radial channel turned", ((-1.0, 0.0), (0.0, -1.0))),
    ("the tangential and the radial channel swapped", ((0.0, 1.0), (1.0, 0.0))),
    (
        "the tangential and the radial channel swapped and the sign of the latter turned",
        ((0.0, 1.0), (-1.0, 0.0)),
    ),
    (
        "the tangential and the radial channel swapped and the sign of the former turned",
        ((0.0, -1.0), (1.0, 0.0)),
    ),
    (
        "the tangential and the radial channel swapped and both signs turned",
        ((0.0, -1.0), (-1.0, 0.0)),
    ),
)
# Angles of the wrong sign that say how the surface lay under a stage give the mirror image of a
# law with the force across turned, so that nothing tells them from a wrong radial channel.
_RADIAL = _OF_CHANNELS[0][0]
_RADIAL_OR_ANGLES = "the sign of the radial channel or the sign of the angles turned"
# Likewise of components in the frame of the surface.
_OF_COMPONENTS = (
    ("the sign of the first component turned", ((-1.0, 0.0), (0.0, 1.0))),
    ("the sign of the second component turned", ((1.0, 0.0), (0.0, -1.0))),
    ("the first and the second component swapped", ((0.0, 1.0), (1.0, 0.0))),
)
# A mistake explains a misfit that it makes smaller than this part; and forces that do not oppose
# sliding if without it the model is no farther off than this, relative to the force.
_EXPLAINED, _CLOSE = 0.5, 0.1
# Of mistakes that explain the same, up to this factor, the first is the simplest.
_AS_GOOD = 1.5


def mistake(
    family: Family, bins: Bins, misfit: float | None, *, turning: bool, angled: bool = False
) -> Mistake | None:
    """Return what explains that mean forces are as far from the model as they are.

    Args:
        family: the models.
        bins: means over directions.
        misfit: of the models, relative to the force; None where forces do not oppose sliding.
        turning: whether the channels turn with the direction of sliding, as on a rotating disk;
            else the forces may as well be given by components.
        angled: whether angles say how the surface lay under a stage.
    """
    cases = [
        (
            _RADIAL_OR_ANGLES if angled and words == _RADIAL else words,
            _changed(bins, np.array(matrix), of_channels=True),
        )
        for words, matrix in _OF_CHANNELS
    ]
    if not turning:
        cases += [
            (words, _changed(bins, np.array(matrix), of_channels=False))
            for words, matrix in _OF_COMPONENTS
        ]
    good = explaining(
        (
            Mistake(words, off)
            for words, meant in cases
            if along_sliding(meant) is None and (off := _misfit(family, meant)) is not None
        ),
        most=_CLOSE if misfit is None else _EXPLAINED * misfit,
        as_good=_AS_GOOD,
    )
    return good[0] if good else None


def _changed(bins: Bins, matrix: Array, *, of_channels: bool) -> Bins:
    if not of_channels:
        return Bins(bins.phi, bins.squares, bins.normal, bins.product @ matrix.T)
    parts = matrix @ np.stack(arrays.along_and_across(bins.product, bins.phi))
    e = arrays.unit_vectors(bins.phi)
    turned = np.stack([-e[:, 1], e[:, 0]], axis=-1)
    product = parts[0][:, None] * e + parts[1][:, None] * turned
    return Bins(bins.phi, bins.squares, bins.normal, product)


def _misfit(family: Family, bins: Bins) -> float | None:
    """Return how far the model that fits best is from the means, relative to the force."""
    if not has_directions(family, bins):
        return None
    try:
        descent = fit_bins(family, bins, start(family, bins))
    except (FitError, np.linalg.LinAlgError):
        return None
    size = float((bins.squares[:, None] * bins.force**2).sum())
    return float(np.sqrt(max(descent.cost, 0.0) / size)) if np.isfinite(descent.cost) else None


def sense_explained(family: Family, bins: Bins, data: Any) -> str | None:
    """Return with which mistake undone forces that do not oppose sliding would."""
    found = mistake(family, bins, None, turning=channels_turn(data), angled=is_angled(data))
    return None if found is None else found.words
