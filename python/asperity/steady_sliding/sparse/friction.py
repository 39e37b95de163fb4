"""Forces of sliding contacts per unit load and their derivatives, for all contacts at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.system.sparse.contact_columns import ContactColumns
from asperity.system.sparse.matrices import Entries

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix


@dataclass(frozen=True, eq=False)
class SlidingContacts:
    """What contacts that slide with γ = χ do: λ_T = λ_N f, ∂λ_T/∂γ = λ_N J."""

    columns: ContactColumns
    sliding: NDArray[np.bool_]
    """Which contacts can be loaded: unilateral ones, and those with a prescribed λ_N > 0."""
    unit_force: SparseMatrix
    """f of each contact in its tangential directions, shape ``(t, m)``."""

    @classmethod
    def of(cls, columns: ContactColumns) -> SlidingContacts:
        """Evaluate the laws."""
        sliding = columns.unilateral | (columns.normal_force > 0.0)
        entries = Entries()
        for law, numbers in columns.groups(sliding):
            places = columns.first[numbers][:, None] + np.arange(law.dimension)
            slip = columns.slip[places]
            still = ~(np.linalg.norm(slip, axis=1) > 0.0)
            if still.any():
                raise ParameterError(
                    "system",
                    f"contact {numbers[still][0]} would stick: its velocity χ vanishes in steady "
                    "sliding",
                )
            force = law.force(slip)
            entries.add(places, numbers[:, None], force)
        m, t = len(columns.laws), len(columns.slip)
        return cls(columns, sliding, entries.matrix((t, m)))

    @property
    def thrusts(self) -> SparseMatrix:
        """E = W_N + W_T f, shape ``(n, m)``."""
        from scipy.sparse import csc_array

        return csc_array(self.columns.normals + self.columns.tangents @ self.unit_force)

    def prescribed_force(self) -> Array:
        """Return the friction of the contacts with a prescribed normal force."""
        load = np.where(self.columns.unilateral, 0.0, self.columns.normal_force)
        return np.asarray(self.columns.tangents @ (self.unit_force @ load))

    def jacobians(self, load: Array) -> tuple[SparseMatrix, SparseMatrix]:
        """Return ∂λ_T/∂γ at the loads λ_N, at constant speed and from the dependence on it."""
        of = self.columns
        turning, falling = Entries(), Entries()
        for law, numbers in of.groups(self.sliding & (load > 0.0)):
            places = of.first[numbers][:, None] + np.arange(law.dimension)
            slip = of.slip[places]
            whole = law.jacobian(slip, normal_force=load[numbers])
            rough = ~np.isfinite(whole).all(axis=(1, 2))
            if rough.any():
                raise ParameterError(
                    "system",
                    f"contact {numbers[rough][0]} slides along {slip[rough][0].tolist()}, where "
                    "its D is flat and the force is not smooth",
                )
            direction = whole
            if law.rate is not None:
                factor = law.rate(np.linalg.norm(slip, axis=1)) * load[numbers]
                plain = law.replace(rate=None).jacobian(slip)
                direction = np.asarray(factor)[:, None, None] * plain
            where = places[:, :, None], places[:, None, :]
            turning.add(*where, direction)
            falling.add(*where, whole - direction)
        t = len(of.slip)
        return turning.matrix((t, t)), falling.matrix((t, t))
