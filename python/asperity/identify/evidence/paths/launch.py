"""What is known of the launch of a body whose path is measured."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import NonNegative, Number, Positive, Record, shaped
from asperity.errors import ParameterError

QUANTITIES = ("speed", "direction", "time", "x1", "x2")
"""What is estimated of every launch, unless it is known."""

UNITS = ("m/s", "rad", "s", "m", "m")
"""Their units."""

SPEED, DIRECTION, TIME, PLACE = 0, 1, 2, slice(3, 5)


class Launch(Record):
    """What is known of the launch of a body: all else is estimated from its path.

    What is given with an error enters the fit as one more measurement with this standard error;
    without one it is taken as exact. A body on its way may have been launched at any place of its
    path: either the place or the time of the launch must be known. Where no place is given, the
    launch is where the body is at the given time, by default that of the first measured point;
    its place is estimated, and points before are left out.

    Args:
        place: (x₁, x₂) in m.
        place_error: standard error of its components in m.
        speed: in m/s.
        speed_error: its standard error in m/s.
        direction: of the velocity, against the first axis, in rad.
        direction_error: its standard error in rad.
        time: in s, in the time of the path.
        time_error: its standard error in s.

    >>> from asperity.identify import Launch
    >>> Launch(place=(0.0, 0.0), direction=0.5, direction_error=0.003)
    Launch(place=[0.0, 0.0], direction=0.5, direction_error=0.003)
    """

    _: KW_ONLY
    place: Annotated[Array, shaped(2)] | None = None
    place_error: NonNegative = 0.0
    speed: Positive | None = None
    speed_error: NonNegative = 0.0
    direction: Number | None = None
    direction_error: NonNegative = 0.0
    time: Number | None = None
    time_error: NonNegative = 0.0

    def _derive(self) -> None:
        for name in ("place", "speed", "direction", "time"):
            if getattr(self, name) is None and getattr(self, f"{name}_error"):
                raise ParameterError(f"{name}_error", f"needs the {name} that it is the error of")
        if self.place is None and self.time_error:
            raise ParameterError(
                "time_error", "needs a place: without one, the launch is where the body is then"
            )


def known_of(launch: Launch, first: float) -> tuple[Array, Array]:
    """Return what is known of the `QUANTITIES`, NaN of the others, and the standard errors.

    Args:
        launch: of a path.
        first: time of the first measured point in s.
    """
    place = (np.nan, np.nan) if launch.place is None else launch.place
    time = first if launch.time is None and launch.place is None else launch.time
    values = [
        np.nan if value is None else value for value in (launch.speed, launch.direction, time)
    ]
    errors = (launch.speed_error, launch.direction_error, launch.time_error)
    return (
        np.array([*values, *place]),
        np.array([*errors, launch.place_error, launch.place_error]),
    )
