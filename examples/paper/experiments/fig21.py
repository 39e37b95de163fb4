"""Figure 21: Experimental setup
================================

What carries the pin and the sensor, and how fast does the pin slide?
"""

from asperity.demo import Check
from paper.frame import Redrawn, panels, show
from paper.measurements.pairings import PVC, SANDBLASTED, STEEL, processed
from paper.sketches import experiments as setup_sketches


def draw() -> Redrawn:
    """Draw the tribometer from the side."""
    figure, (ax,) = panels(
        21, "experimental setup", 1, figsize=(8.0, 6.6), parameters="not to scale"
    )
    setup_sketches.tribometer_section(ax)
    speeds = (
        Check(
            f"Fig. 21 sliding speed, {pair.name}",
            pair.speed,
            float(processed(pair).speed.mean()),
            1e-6,
            "m/s",
        )
        for pair in (SANDBLASTED, PVC, STEEL)
    )
    return Redrawn(figure, list(speeds))


# %%
if __name__ == "__main__":
    show(draw)
