"""Plots of sets, laws, motions and stability; need matplotlib (``pip install "asperity[plot]"``).

Every function draws into `ax`, or into new axes, and returns the list of artists it has drawn, as
``Axes.plot`` does; the axes are ``artists[0].axes``.
"""

from asperity.plot.cones import plot_cones, plot_projection
from asperity.plot.direction import plot_deflection, plot_friction_coefficient
from asperity.plot.gauge import plot_gauge
from asperity.plot.identification import plot_fitted_forces, plot_fitted_sets, plot_residuals
from asperity.plot.law import plot_law
from asperity.plot.look import save_figure, style
from asperity.plot.sets import plot_set
from asperity.plot.steady_sliding import plot_bifurcation, plot_growth_chart, plot_root_locus
from asperity.plot.tracking import plot_motion, plot_track
from asperity.plot.trajectory import plot_forces_in_reservoir, plot_path, plot_phase

__all__ = [
    "plot_bifurcation",
    "plot_cones",
    "plot_deflection",
    "plot_fitted_forces",
    "plot_fitted_sets",
    "plot_forces_in_reservoir",
    "plot_friction_coefficient",
    "plot_gauge",
    "plot_growth_chart",
    "plot_law",
    "plot_motion",
    "plot_path",
    "plot_phase",
    "plot_projection",
    "plot_residuals",
    "plot_root_locus",
    "plot_set",
    "plot_track",
    "save_figure",
    "style",
]
