"""Figure 23: Steel on sandblasted steel
========================================

What does an isotropic pair measure like? The data are synthetic, from a virtual tribometer.
"""

import numpy as np
from asperity.demo import Check
from paper.frame import Redrawn, show
from paper.measurements.forces_and_sets import (
    _direction_variation,
    _forces_and_sets,
    _resistance,
    _variation,
)
from paper.measurements.pairings import SANDBLASTED, processed


def draw() -> Redrawn:
    """Draw forces and sets of a steel pin on sandblasted steel."""
    data = processed(SANDBLASTED)
    radius = data.sets.radius
    against, across = _resistance(data).T
    return _forces_and_sets(
        23,
        SANDBLASTED,
        [
            Check("Fig. 23 friction coefficient", 0.14, float(radius.mean()), 2e-3),
            Check("Fig. 23 radial force", 0.0, float(np.abs(across).max()), 0.06, "N"),
            Check("Fig. 23 tangential force varies", 0.0, _variation(against), 0.03),
            Check("Fig. 23 C is no circle by", 0.0, _variation(radius), 0.03),
            Check("Fig. 23 D is no circle by", 0.0, _direction_variation(data), 0.03),
        ],
    )


# %%
if __name__ == "__main__":
    show(draw)
