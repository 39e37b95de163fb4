"""What can be simulated, and what its coordinates are called."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import asperity._core as _core
from asperity.law import FrictionLaw
from asperity.system import RigidBodies
from asperity.system.labels import Labels, contact_names, numbered


@runtime_checkable
class Model(Protocol):
    """What `simulate` needs of a system."""

    @property
    def dof(self) -> int:
        """Number n of velocities."""

    @property
    def contacts(self) -> Sequence[Any]:
        """The contacts."""

    @property
    def _core(self) -> _core.LinearSystem | _core.CallbackSystem | _core.RigidBodies: ...


def labels_of(system: Model) -> Labels:
    """Return the names and units of a system, also of one that has none."""
    own = getattr(system, "labels", None)
    if isinstance(own, Labels):
        return own
    coordinates = getattr(system, "coordinates", None) or system.dof
    names = contact_names([getattr(one, "name", None) for one in system.contacts])
    return numbered(coordinates, system.dof, len(names)).replace(contacts=names)


def laws_of(system: Model) -> list[FrictionLaw]:
    """Return the friction law of every contact."""
    if isinstance(system, RigidBodies):
        return [system.pairs[contact.pair].law for contact in system.contacts]
    return [contact.law for contact in system.contacts]
