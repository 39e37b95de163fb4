"""Rigid bodies in the plane and in space, their contacts and springs."""

from asperity.system.rigid.bodies import Body, PlanarBody
from asperity.system.rigid.friction_maps import FrictionRaster, FrictionRegions
from asperity.system.rigid.joints import Hinge, Slider, Weld
from asperity.system.rigid.pairs import BoxPlane, PointPlane, SpherePlane, SphereSphere
from asperity.system.rigid.plane_motion import PlaneMotion
from asperity.system.rigid.rotation import axis_angle
from asperity.system.rigid.springs import Spring
from asperity.system.rigid.surfaces import BodyAxis, Line, Plane
from asperity.system.rigid.system import ContactLabel, RigidBodies

__all__ = [
    "Body",
    "BodyAxis",
    "BoxPlane",
    "ContactLabel",
    "FrictionRaster",
    "FrictionRegions",
    "Hinge",
    "Line",
    "PlanarBody",
    "Plane",
    "PlaneMotion",
    "PointPlane",
    "RigidBodies",
    "Slider",
    "SpherePlane",
    "SphereSphere",
    "Spring",
    "Weld",
    "axis_angle",
]
