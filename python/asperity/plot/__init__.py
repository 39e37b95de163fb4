"""Plots of sets, laws and trajectories; needs matplotlib (``pip install "asperity[plot]"``).

Every function draws into `ax`, or into new axes, and returns the axes.
"""

from asperity.plot.look import save_figure, style
from asperity.plot.sets import plot_law, plot_set
from asperity.plot.trajectory import plot_forces_in_reservoir, plot_path, plot_phase

__all__ = [
    "plot_forces_in_reservoir",
    "plot_law",
    "plot_path",
    "plot_phase",
    "plot_set",
    "save_figure",
    "style",
]
