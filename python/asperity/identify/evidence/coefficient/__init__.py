"""Friction coefficients along the sliding: over turns, runs, loads and speeds; breakaway."""
