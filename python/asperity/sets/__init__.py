"""Star-shaped and convex sets in one, two and three dimensions ([WL19] §2.1)."""

from asperity.sets.boxes import Box, Interval, Rectangle
from asperity.sets.rounds import Ball, Disk, Ellipse, Superellipse
from asperity.sets.star import Mapped, StarSet

__all__ = [
    "Ball",
    "Box",
    "Disk",
    "Ellipse",
    "Interval",
    "Mapped",
    "Rectangle",
    "StarSet",
    "Superellipse",
]
