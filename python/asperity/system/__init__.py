"""Systems with frictional contacts: M(q) u̇ − h(t, q, u) = W_N λ_N + W λ ([WL19] §2.2)."""

from asperity.system.contacts import Contact, ContactLaw
from asperity.system.custom import System
from asperity.system.labels import Labels as Labels
from asperity.system.linear import LinearSystem
from asperity.system.models import MassOnBelt, SlidingPoint
from asperity.system.rigid import (
    Body,
    BodyAxis,
    BoxPlane,
    FrictionRaster,
    FrictionRegions,
    Hinge,
    Line,
    PlanarBody,
    Plane,
    PlaneMotion,
    PointPlane,
    RigidBodies,
    Slider,
    SpherePlane,
    SphereSphere,
    Spring,
    Weld,
    axis_angle,
)
from asperity.system.sliding_disk import SlidingDisk
from asperity.system.sparse.files.calculix import read_calculix
from asperity.system.sparse.files.formats import read_matrices
from asperity.system.sparse.files.matrix_market import read_matrix_market
from asperity.system.sparse.files.model import FiniteElementModel as FiniteElementModel
from asperity.system.sparse.linear import SparseLinearSystem as SparseLinearSystem
from asperity.system.sparse.mesh_contacts import MeshContacts
from asperity.system.time_functions import Signal, Sine

__all__ = [
    "Body",
    "BodyAxis",
    "BoxPlane",
    "Contact",
    "ContactLaw",
    "FrictionRaster",
    "FrictionRegions",
    "Hinge",
    "Line",
    "LinearSystem",
    "MassOnBelt",
    "MeshContacts",
    "PlanarBody",
    "Plane",
    "PlaneMotion",
    "PointPlane",
    "RigidBodies",
    "Signal",
    "Sine",
    "Slider",
    "SlidingDisk",
    "SlidingPoint",
    "SpherePlane",
    "SphereSphere",
    "Spring",
    "System",
    "Weld",
    "axis_angle",
    "read_calculix",
    "read_matrices",
    "read_matrix_market",
]
