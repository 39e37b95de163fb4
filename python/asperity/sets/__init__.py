"""Star-shaped and convex sets in one, two and three dimensions ([WL19] §2.1)."""

from asperity.sets.combined import Intersection, Mapped, MinkowskiSum, Union
from asperity.sets.cone import Cone
from asperity.sets.shapes.boxes import Box, CappedRectangle, Interval, Rectangle
from asperity.sets.shapes.curves import PolarCurve, Polygon, SupportCurve, star_shape
from asperity.sets.shapes.reservoirs import CoulombContensou, WedgeAsperity
from asperity.sets.shapes.rounds import Ball, Disk, Ellipse, Ellipsoid, Superellipse, Superellipsoid
from asperity.sets.star import StarSet
from asperity.sets.verdict import Verdict

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
    "Superellipsoid",
    "SupportCurve",
    "Union",
    "Verdict",
    "WedgeAsperity",
    "star_shape",
]
