"""Paths of sliding bodies: how they are launched, read and simulated."""
