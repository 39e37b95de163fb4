"""The sliding path that the tests of the camera film."""

import asperity as asp
import numpy as np
from table_1 import TABLE_1

ANGLE = np.deg2rad(32.0)
RUN = asp.simulate(
    asp.SlidingPoint(0.018, law=TABLE_1),
    dt=1e-4,
    t_end=1.0,
    u0=[1.52 * np.cos(ANGLE), 1.52 * np.sin(ANGLE)],
    until_rest=True,
)
SMALL = {"size": (640, 540), "fps": 250.0}
