"""Samples of the force as fits take them, their means over directions, drift and defects."""
