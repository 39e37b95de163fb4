"""How far a law is from what the engine computes whose parameters it was made of."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY
from typing import Annotated

from asperity._base import arrays
from asperity._base.value import NonNegative, Number, Record, of_kind

Text = Annotated[str, of_kind(str, "a text")]


class EngineReport(Record):
    """What is known of a law that `FrictionLaw.like` has made of another engine's parameters.

    Args:
        engine: its name.
        version: of the engine in which the law was found by experiment.
        axes: what the first axis of friction is in the engine.
        deviation: what the engine computes otherwise, in sentences.
        source: where the engine's law was found.
        angle: of that axis from e₁ of the law in rad, counter-clockwise; `FrictionLaw.rotated`
            turns both.
        creep: speed in m/s at which a contact creeps in the engine that is loaded, along its first
            axis, by half of what it can hold, and that this law lets stick; 0 if it sticks there
            too, None if that was not measured.
        end_error: distance in m between the points where the engine and this law end the sliding
            experiment of docs/engines.md, after 0.24 m, with the engine's default contact; None if
            it was not run. With steps of 0.1 ms, unless the engine's step is one of the parameters
            or `source` names another one.

    >>> from asperity import FrictionLaw
    >>> law = FrictionLaw.like("exudyn", dryFriction=(0.5, 0.4), dryFrictionProportionalZone=1e-3)
    >>> law.report.version, round(law.report.creep, 6)
    ('1.13.6', 0.000293)
    """

    engine: Text
    version: Text
    _: KW_ONLY
    axes: Text
    deviation: Text
    source: Text
    angle: Number = 0.0
    creep: NonNegative | None = None
    end_error: NonNegative | None = None

    def rotated(self, angle: float) -> EngineReport:
        """Return the report of the law that is turned counter-clockwise by `angle` in rad.

        >>> from asperity import FrictionLaw
        >>> FrictionLaw.like("rapier", friction=0.5).rotated(0.5).report.angle
        0.5
        """
        turned = self.angle + arrays.number(angle, "angle")
        return self.replace(angle=math.remainder(turned, 2.0 * math.pi))
