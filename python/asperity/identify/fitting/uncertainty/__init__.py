"""Covariance of what was fitted, the causes of its errors, confidence bands."""
