"""Figure 20: The tribometer
============================

How are forces over all sliding directions measured? A pin slides on a disk that turns.
"""

import math

from asperity.demo import Check
from paper.frame import Redrawn, panels, show
from paper.sketches import experiments as setup_sketches

_PIN_DIAMETER = 7.0


def draw() -> Redrawn:
    """Draw the pin-on-disk tribometer."""
    figure, (ax,) = panels(20, "tribometer", 1, figsize=(8.0, 6.0), parameters="not to scale")
    setup_sketches.tribometer_view(ax)
    area = 0.25 * math.pi * _PIN_DIAMETER**2
    return Redrawn(figure, [Check("Fig. 20 area of the pin", 38.0, area, 0.5, "mm²")])


# %%
if __name__ == "__main__":
    show(draw)
