"""Plots of sets, laws, motions and stability; need matplotlib (``pip install "asperity[plot]"``).

Every function takes what it draws first and all else by name, draws into the axes ``ax=``, or into
new ones, and returns them. The asperity style is applied automatically. Runs are those of
`simulate` and `integrate`, limit cycles, or several of them in a list or, by labels, in a dict.
"""

from asperity.plot.cones import plot_cones, plot_projection
from asperity.plot.direction import plot_deflection, plot_friction_coefficient
from asperity.plot.fitted_paths import plot_fitted_paths
from asperity.plot.identification import (
    plot_fitted_forces,
    plot_fitted_sets,
    plot_law_comparison,
    plot_residuals,
)
from asperity.plot.law import plot_law
from asperity.plot.look import save_figure, style
from asperity.plot.runs.animations import save_animation
from asperity.plot.runs.bodies import plot_bodies
from asperity.plot.runs.forces import plot_forces_in_reservoir
from asperity.plot.runs.histories import plot_history
from asperity.plot.runs.paths import plot_path, plot_phase_portrait
from asperity.plot.sets import plot_gauge, plot_set
from asperity.plot.squeal import plot_damping_ratios, plot_squeal_map
from asperity.plot.steady_sliding import plot_bifurcation, plot_growth_chart, plot_root_locus
from asperity.plot.tracking import plot_track

__all__ = [
    "plot_bifurcation",
    "plot_bodies",
    "plot_cones",
    "plot_damping_ratios",
    "plot_deflection",
    "plot_fitted_forces",
    "plot_fitted_paths",
    "plot_fitted_sets",
    "plot_forces_in_reservoir",
    "plot_friction_coefficient",
    "plot_gauge",
    "plot_growth_chart",
    "plot_history",
    "plot_law",
    "plot_law_comparison",
    "plot_path",
    "plot_phase_portrait",
    "plot_projection",
    "plot_residuals",
    "plot_root_locus",
    "plot_set",
    "plot_squeal_map",
    "plot_track",
    "save_animation",
    "save_figure",
    "style",
]
