"""Figure 26: Laws of PVC on ground steel
=========================================

Which sets of Table 1 describe what was measured? Ellipse and superellipses are fitted to the
synthetic data of Fig. 24.
"""

import numpy as np
from asperity.demo import Check, table1
from asperity.identify import ProcessedData
from matplotlib.axes import Axes
from paper.drawing import GREY
from paper.frame import Redrawn, cross, draw_law, panels, shared_legend, show
from paper.measurements.identified import Identified, identified
from paper.measurements.pairings import SYNTHETIC


def _draw_points(data: ProcessedData, ax: Axes) -> None:
    points = data.sets.reservoir_points
    ax.plot(*points.T, ".", color=GREY, markersize=3.0, zorder=1.5, label="measured $C$")


def table_checks(found: Identified) -> list[Check]:
    """Compare with Table 1: semi-axes in N at 9.3 N, exponents; D to its scale.

    The ellipse of Table 1 lies through the friction coefficients 0.54 and 0.48 on the axes; the
    superellipses are least-squares fits.
    """
    estimates = found.fit.parameters
    force = table1.NORMAL_FORCE
    across, along = force * np.array([found.ellipse.a, found.ellipse.b])
    semi_axes = [force * estimates[f"reservoir.{name}"].value for name in "ab"]
    ratio = table1.SUPERELLIPSE_D.a / table1.SUPERELLIPSE_D.b
    return [
        Check("Fig. 26 Table 1 ellipse C, across", 5.00, float(across), 0.05, "N"),
        Check("Fig. 26 Table 1 ellipse C, along", 4.49, float(along), 0.05, "N"),
        Check("Fig. 26 Table 1 superellipse C, across", 4.99, semi_axes[0], 0.05, "N"),
        Check("Fig. 26 Table 1 superellipse C, along", 4.25, semi_axes[1], 0.05, "N"),
        Check(
            "Fig. 26 Table 1 superellipse C, exponent",
            2.94,
            estimates["reservoir.exponent"].value,
            0.1,
        ),
        Check(
            "Fig. 26 Table 1 superellipse D, ratio",
            ratio,
            estimates["direction.ratio"].value,
            0.015,
        ),
        Check(
            "Fig. 26 Table 1 superellipse D, exponent",
            2.51,
            estimates["direction.exponent"].value,
            0.1,
        ),
    ]


def draw() -> Redrawn:
    """Draw the sets of Table 1 over the measured points: (a) ellipse, (b), (c) superellipses."""
    figure, axes = panels(
        26, "laws of PVC on ground steel", 3, figsize=(13.0, 4.9), parameters=SYNTHETIC
    )
    found = identified()
    laws = list(found.laws.values())
    titles = (
        "(a) associated ($D = C$), ellipse",
        "(b) associated ($D = C$), superellipse",
        "(c) extended",
    )
    for ax, law, title in zip(axes, (laws[0], laws[1], laws[3]), titles, strict=True):
        _draw_points(found.data, ax)
        draw_law(law, ax, angles=24)
        cross(ax)
        for line in ax.get_lines():
            if law.is_associated and line.get_label() == "reservoir $C$ = direction set $D$":
                line.set_label("reservoir $C$")
        ax.set(title=title, xlim=(-0.8, 0.8), ylim=(-0.75, 0.75))
    shared_legend(figure, axes, columns=6)
    return Redrawn(figure, table_checks(found))


# %%
if __name__ == "__main__":
    show(draw)
