"""Star-shaped and convex sets in one, two and three dimensions ([WL19] §2.1)."""

from asperity.sets.combined import Intersection as Intersection
from asperity.sets.combined import Mapped as Mapped
from asperity.sets.combined import MinkowskiSum as MinkowskiSum
from asperity.sets.combined import Union as Union
from asperity.sets.cone import Cone as Cone
from asperity.sets.shapes.boxes import Box, CappedRectangle, Interval, Rectangle
from asperity.sets.shapes.curves import PolarCurve, Polygon, SupportCurve, star_shape
from asperity.sets.shapes.reservoirs import CoulombContensou, WedgeAsperity
from asperity.sets.shapes.rounds import Ball, Disk, Ellipse, Ellipsoid, Superellipse, Superellipsoid
from asperity.sets.star import StarSet
from asperity.sets.verdict import Verdict as Verdict

__all__ = [
    "Ball",
    "Box",
    "CappedRectangle",
    "CoulombContensou",
    "Disk",
    "Ellipse",
    "Ellipsoid",
    "Interval",
    "PolarCurve",
    "Polygon",
    "Rectangle",
    "StarSet",
    "Superellipse",
    "Superellipsoid",
    "SupportCurve",
    "WedgeAsperity",
    "star_shape",
]
