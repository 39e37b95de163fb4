"""Figure 24: PVC on ground steel
=================================

What does a strongly anisotropic pair measure like? The data are synthetic, from a virtual
tribometer.
"""

from asperity.demo import Check
from paper.frame import Redrawn, show
from paper.measurements.forces_and_sets import _forces_and_sets, _set_checks
from paper.measurements.pairings import PVC, processed


def draw() -> Redrawn:
    """Draw forces and sets of a PVC pin on surface ground steel."""
    data = processed(PVC)
    across, along = data.sets.radii_on_axes
    return _forces_and_sets(
        24,
        PVC,
        [
            Check("Fig. 24 friction coefficient across", 0.54, across, 5e-3),
            Check("Fig. 24 friction coefficient along", 0.48, along, 5e-3),
            *_set_checks(24, data, PVC),
        ],
    )


# %%
if __name__ == "__main__":
    show(draw)
