"""Schematic drawings."""
