"""Systems with frictional contacts: M(q) u̇ − h(t, q, u) = W_N λ_N + W λ ([WL19] §2.2)."""

from asperity.system.contacts import Contact, ContactLaw
from asperity.system.custom import System
from asperity.system.linear import LinearSystem
from asperity.system.models import MassOnBelt, SlidingPoint

__all__ = [
    "Contact",
    "ContactLaw",
    "LinearSystem",
    "MassOnBelt",
    "SlidingPoint",
    "System",
]
