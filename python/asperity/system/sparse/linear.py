"""The linear system with constant sparse matrices."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.result import counted
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.system import labels
from asperity.system.contacts import Contact, relawed
from asperity.system.labels import Labels
from asperity.system.linear import LinearSystem, texts_of_coordinates
from asperity.system.sparse import matrices
from asperity.system.sparse.contact_columns import ContactColumns
from asperity.system.sparse.mesh_contacts import MeshContacts

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Largest number of coordinates that `dense` makes dense: three matrices of 32 MB.
LARGEST_DENSE = 2000
# Largest number of entries that its text holds.
_PRINTED = 100


class SparseLinearSystem(LinearSystem):
    """M q̈ + B q̇ + K q = f + W_N λ_N + W λ with sparse matrices, as `LinearSystem` makes it of them.

    M may be singular, as that of finite elements with reduced integration. `equilibrium`,
    `stability` with `near` or `band` and `simulate` with `implicit` take it; what needs dense
    matrices takes `dense()`.

    Attributes:
        mass, stiffness, damping: in compressed columns, as they were given.
        contacts: `Contact` and `MeshContacts`.
        columns: directions, laws and velocities of the single contacts.
    """

    mass: SparseMatrix  # type: ignore[assignment]  # dense code asks for `dense()` before
    stiffness: SparseMatrix  # type: ignore[assignment]
    damping: SparseMatrix  # type: ignore[assignment]
    contacts: tuple[Contact | MeshContacts, ...]  # type: ignore[assignment]
    columns: ContactColumns

    def __init__(
        self,
        mass: Any,
        *,
        stiffness: Any = None,
        damping: Any = None,
        force: ArrayLike | None = None,
        contacts: Sequence[Contact | MeshContacts] | Contact | MeshContacts = (),
        constraint_rows: None = None,
        constraint: None = None,
        coordinate_names: Sequence[str] | None = None,
        coordinate_units: Sequence[str] | None = None,
    ) -> None:
        if constraint_rows is not None or constraint is not None:
            raise ParameterError("constraint_rows", "must be left out with sparse matrices")
        given = {"mass": mass, "stiffness": stiffness, "damping": damping}
        name = next(name for name, one in given.items() if matrices.is_sparse(one))
        n = matrices.order(given[name], name)
        made = {name: matrices.compressed(one, name, n) for name, one in given.items()}
        listed = tuple(contacts) if isinstance(contacts, Sequence) else (contacts,)
        for contact in listed:
            kinds = Contact | MeshContacts
            arrays.of_kind(contact, "contacts", kinds, "Contact or MeshContacts, or several")
        self._set(
            mass=matrices.semidefinite(matrices.symmetric(made["mass"], "mass"), "mass"),
            stiffness=matrices.of_both_triangles(made["stiffness"], "stiffness"),
            damping=matrices.of_both_triangles(made["damping"], "damping"),
            force=arrays.constant(np.zeros(n) if force is None else force, "force", (n,)),
            contacts=listed,
            constraint_rows=None,
            constraint=None,
            coordinate_names=texts_of_coordinates(coordinate_names, "coordinate_names", n),
            coordinate_units=texts_of_coordinates(coordinate_units, "coordinate_units", n),
        )
        self._keep(columns=ContactColumns.of(listed, n))

    @property
    def _core(self) -> NoReturn:  # type: ignore[override]
        raise ParameterError(
            "system",
            f"has sparse matrices, of {counted(self.dof, 'coordinate')}: simulate takes them with "
            "implicit=, such as 0.5; what needs dense ones takes system.dense(), up to "
            f"{LARGEST_DENSE} coordinates",
        )

    @cached_property
    def labels(self) -> Labels:  # type: ignore[override]
        """Names and units of coordinates and contacts."""
        n, names = self.dof, [one.name if isinstance(one, Contact) else None for one in self._each]
        return labels.of_coordinates(
            n,
            n,
            labels.contact_names(names),
            self.coordinate_names,
            self.coordinate_units,
            are_rates=True,
        )

    @property
    def _each(self) -> list[Contact | MeshContacts]:
        """What each single contact is of."""
        return [
            one
            for one in self.contacts
            for _ in range(one.count if isinstance(one, MeshContacts) else 1)
        ]

    def dense(self) -> LinearSystem:
        """Return the same system with dense matrices.

        Raises:
            ParameterError: of more than 2000 coordinates, or with a singular mass matrix.
        """
        if self.dof > LARGEST_DENSE:
            raise ParameterError(
                "system",
                f"has {self.dof} coordinates; at most {LARGEST_DENSE} are made dense",
            )
        mass = self.mass.toarray()
        spectrum = np.linalg.eigvalsh(mass)
        if not spectrum[0] > 1e-12 * spectrum[-1]:
            raise ParameterError(
                "mass",
                "is singular or not positive definite, as that of finite elements with reduced "
                "integration; dense systems need its inverse",
            )
        return LinearSystem(
            mass,
            stiffness=self.stiffness.toarray(),
            damping=self.damping.toarray(),
            force=self.force,
            contacts=[self._single(i) for i in range(len(self.columns.laws))],
            coordinate_names=self.coordinate_names,
            coordinate_units=self.coordinate_units,
        )

    def _single(self, i: int) -> Contact:
        """Return one contact with dense directions."""
        each, of = self._each[i], self.columns
        if isinstance(each, Contact):
            return each
        mine = slice(of.first[i], of.first[i + 1])
        return Contact(
            of.laws[i],
            direction=of.tangents[:, mine].toarray(),
            normal=of.normals[:, [i]].toarray().ravel(),
            gap=float(of.gap[i]),
            velocity=of.slip[mine],
        )

    def with_law(
        self, law: FrictionLaw, *, contacts: int | str | Sequence[int | str] | None = None
    ) -> SparseLinearSystem:
        """Return the same system, of which contacts obey another friction law.

        Args:
            law: of the dimension of the contacts' laws.
            contacts: places in `contacts`, where those of a mesh are one; default all.
        """
        changed = relawed(self.contacts, law, contacts, "contacts")
        return self.replace(contacts=changed)

    def __repr__(self) -> str:
        if self.mass.nnz + self.stiffness.nnz + self.damping.nnz <= _PRINTED:
            return super().__repr__()
        m = len(self.columns.laws)
        return f"<SparseLinearSystem: {counted(self.dof, 'coordinate')}, {counted(m, 'contact')}>"
