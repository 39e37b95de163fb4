"""Plots of runs: paths, phase portraits, histories, forces, bodies, animations."""
