"""Steady sliding of systems with sparse matrices: equilibria, eigenvalues near a frequency."""
