"""Figure 25: Steel on ground steel
===================================

Can friction be greater along the grooves than across? The data are synthetic, from a virtual
tribometer.
"""

import numpy as np
from asperity.demo import Check
from paper.frame import Redrawn, show
from paper.measurements.forces_and_sets import _alike, _forces_and_sets, _resistance, _set_checks
from paper.measurements.pairings import STEEL, processed
from paper.statements import truth


def draw() -> Redrawn:
    """Draw forces and sets of a steel pin on surface ground steel."""
    data = processed(STEEL)
    across, along = data.sets.radii_on_axes
    against = _resistance(data)[:, 0]
    highest = float(np.rad2deg(data.sets.phi[against.argmax()])) % 180.0
    return _forces_and_sets(
        25,
        STEEL,
        [
            truth("Fig. 25 more friction along the grooves", along > across),
            Check("Fig. 25 direction of most friction", 90.0, highest, 3.0, "deg"),
            truth("Fig. 25 C and D differ in shape", not _alike(data)),
            *_set_checks(25, data, STEEL),
        ],
    )


# %%
if __name__ == "__main__":
    show(draw)
