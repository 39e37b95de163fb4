"""Directions, laws and velocities of all contacts of a sparse system, one column each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import DimensionError
from asperity.law import FrictionLaw
from asperity.system.contacts import Contact
from asperity.system.sparse.matrices import Entries
from asperity.system.sparse.mesh_contacts import MeshContacts

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix


@dataclass(frozen=True, eq=False)
class ContactColumns:
    """W_N and W_T of m contacts; those with a prescribed normal force have a zero column in W_N."""

    normals: SparseMatrix
    """W_N, shape ``(n, m)``."""
    tangents: SparseMatrix
    """W_T, shape ``(n, t)``, where t is the number of tangential directions of all contacts."""
    first: NDArray[np.intp]
    """Number of the first tangential direction of each contact, and t, shape ``(m + 1,)``."""
    laws: tuple[FrictionLaw, ...]
    slip: Array
    """χ in m/s, shape ``(t,)``."""
    gap: Array
    """g₀ in m, shape ``(m,)``."""
    normal_force: Array
    """λ_N in N where it is prescribed, NaN elsewhere, shape ``(m,)``."""

    @property
    def unilateral(self) -> NDArray[np.bool_]:
        """Which contacts can open."""
        return np.isnan(self.normal_force)

    def stacked(self) -> tuple[SparseMatrix, list[slice]]:
        """Return w_N, if there is one, and W contact by contact, and the columns of each."""
        from scipy.sparse import csc_array, hstack

        free, m, sizes = np.flatnonzero(self.unilateral), len(self.laws), np.diff(self.first)
        columns = np.append(free, m + np.arange(self.first[-1]))
        of = np.append(free, np.repeat(np.arange(m), sizes))
        whole = csc_array(hstack([self.normals, self.tangents], format="csc"))
        ends = np.cumsum(sizes + self.unilateral)
        starts = ends - sizes - self.unilateral
        slices = [slice(a, b) for a, b in zip(starts.tolist(), ends.tolist(), strict=True)]
        return whole[:, columns[np.argsort(of, kind="stable")]], slices

    def groups(self, chosen: NDArray[np.bool_]) -> Iterator[tuple[FrictionLaw, NDArray[np.intp]]]:
        """Yield each law with the numbers of those of the chosen contacts that obey it."""
        numbers = np.flatnonzero(chosen)
        kinds = np.array([id(self.laws[i]) for i in numbers])
        for kind in np.unique(kinds):
            obeying = numbers[kinds == kind]
            yield self.laws[obeying[0]], obeying

    @classmethod
    def of(cls, contacts: Sequence[Contact | MeshContacts], n: int) -> ContactColumns:
        """Collect the columns of contacts of a system of n coordinates."""
        normals, tangents = Entries(), Entries()
        laws: list[FrictionLaw] = []
        first = [0]
        slip, gap, load = ([np.zeros(0)] for _ in range(3))
        for contact in contacts:
            rows, normal, across = _directions(contact, n)
            p, m = contact.law.dimension, len(rows)
            places = len(laws) + np.arange(m)
            starts = first[-1] + p * np.arange(m)
            normals.add(rows, places[:, None], normal)
            columns = starts[:, None] + np.arange(p)
            tangents.add(rows[:, :, None], columns[:, None, :], across)
            laws += [contact.law] * m
            first += (starts + p).tolist()
            if isinstance(contact, MeshContacts):
                slip.append(contact.slip.ravel())
                gap.append(contact.gap)
                load.append(np.full(m, np.nan))
            else:
                slip.append(contact.velocity)
                gap.append(np.array([contact.gap]))
                load.append(np.array([np.nan if contact.unilateral else contact.normal_force]))
        return cls(
            normals.matrix((n, len(laws))),
            tangents.matrix((n, first[-1])),
            np.array(first, dtype=np.intp),
            tuple(laws),
            np.concatenate(slip),
            np.concatenate(gap),
            np.concatenate(load).astype(np.float64),
        )


def _directions(contact: Contact | MeshContacts, n: int) -> tuple[NDArray[np.intp], Array, Array]:
    """Return numbers of coordinates ``(m, k)``, entries of w_N ``(m, k)`` and W ``(m, k, p)``."""
    if isinstance(contact, MeshContacts):
        if contact.coordinates.max(initial=0) >= n:
            raise DimensionError(
                "contacts",
                f"must name coordinates below {n}, got {contact.coordinates.max()}",
            )
        axes = contact.axes
        return contact.coordinates, axes[:, 2], np.swapaxes(axes[:, :2], 1, 2)
    if len(contact.direction) != n:
        shape = contact.direction.shape
        raise DimensionError("direction", f"must have shape ({n}, p), got {shape}")
    normal = np.zeros(n) if contact.normal is None else contact.normal
    return np.arange(n)[None], normal[None], contact.direction[None]
