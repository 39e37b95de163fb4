"""Star-shaped and convex sets in one, two and three dimensions ([WL19] §2.1)."""

from asperity.sets.boxes import Box, CappedRectangle, Interval, Rectangle
from asperity.sets.combined import Intersection, MinkowskiSum, Union
from asperity.sets.cone import Cone
from asperity.sets.curves import PolarCurve, Polygon, SupportCurve, star_shape
from asperity.sets.drilling import CoulombContensou
from asperity.sets.mapped import Mapped
from asperity.sets.rounds import Ball, Disk, Ellipse, Ellipsoid, Superellipse
from asperity.sets.star import StarSet
from asperity.sets.verdict import Verdict
from asperity.sets.wedge import WedgeAsperity

__all__ = [
    "Ball",
    "Box",
    "CappedRectangle",
    "Cone",
    "CoulombContensou",
    "Disk",
    "Ellipse",
    "Ellipsoid",
    "Intersection",
    "Interval",
    "Mapped",
    "MinkowskiSum",
    "PolarCurve",
    "Polygon",
    "Rectangle",
    "StarSet",
    "Superellipse",
    "SupportCurve",
    "Union",
    "Verdict",
    "WedgeAsperity",
    "star_shape",
]
