"""Families of sets C and D, with the coordinates in which they are fitted."""
