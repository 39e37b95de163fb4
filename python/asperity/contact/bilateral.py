"""Bilateral rows, which hold the bodies of a contact problem, eliminated from ξ = G P + b."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact import operator
from asperity.contact.compressed import CompressedRows, compressed, sparse
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# Part of a row's size that rounding may have made.
_ROUNDED = 1e-13
# Mobility lent to a tangential row that nothing moves, relative to that without bilateral rows.
_LENT = 1e-11
# As in the core: part of the velocities which joints take out that may be left, as drift.
_DRIFT = 1e-6


class Joints(NamedTuple):
    """What is left of a problem when its bilateral rows have been eliminated.

    With M = LLᵀ and S = diag(G_EE)^(−1/2) is L⁻¹W_E S = U Σ Vᵀ, Σ without zeros. B = Σ⁻¹VᵀS and
    P_E = −Bᵀ(B b_E + UᵀL⁻¹W P), which has the least Σ G_ii P_i² among all that hold. Singular
    values are those of the rows, not of their square: light bodies between heavy ones are held.

    Attributes:
        delassus: CᵀC with C = (1 − UUᵀ) L⁻¹W; on the diagonal of rows that nothing moves `_LENT`.
        free_velocity: b − (UᵀL⁻¹W)ᵀ B b_E.
        basis: B.
        coupling: UᵀL⁻¹W.
        load: B b_E.
    """

    delassus: csr_array
    free_velocity: Array
    basis: csr_array
    coupling: csr_array
    load: Array

    def percussion(self, contacts: Array) -> Array:
        """Return P_E for percussions of the contacts."""
        return -np.asarray(self.basis.T @ (self.load + self.coupling @ contacts))


def parameters(bilateral: Any, velocity: Any, given: dict[str, Any]) -> dict[str, Any]:
    """Return the checked rows, ``None`` where there are none."""
    if bilateral is None:
        if velocity is not None:
            raise ParameterError("bilateral_velocity", "must be given with bilateral")
        return {"bilateral": None, "bilateral_velocity": None}
    if given["mass"] is None:
        raise ParameterError("bilateral", "must be left out unless mass and directions are given")
    if given["delassus"] is not None:
        raise ParameterError("delassus", "must be left out with bilateral, which changes it")
    rows = compressed(bilateral, "bilateral", (given["mass"].shape[0], None))
    count = rows.shape[1]
    known = np.zeros(count) if velocity is None else velocity
    checked = arrays.constant(known, "bilateral_velocity", (count,))
    return {"bilateral": rows, "bilateral_velocity": checked}


def eliminated(
    mass: CompressedRows,
    directions: CompressedRows,
    free_velocity: Array,
    bilateral: CompressedRows,
    velocity: Array,
    *,
    contacts: Iterable[tuple[slice, float | None]],
) -> Joints:
    """Eliminate the rows; refuse what they contradict, and contacts that nothing moves.

    Along a tangential row that nothing moves friction is what sliding along the others brings, and
    undetermined at rest. As in the core, a mobility is lent to it, which turns slip by `_LENT`.

    Rows that influence each other are eliminated by themselves: islands remain islands.
    """
    from scipy.sparse import diags_array
    from scipy.sparse.csgraph import connected_components

    operator.check_mass(mass)
    root = operator.inverse_root(mass.tocsr())
    held, moving = (root @ bilateral.tocsr()).tocsc(), (root @ directions.tocsr()).tocsr()
    own = (held.T @ held).tocsr()
    loads, entries, spans = [np.zeros(0)], _Entries(), _Entries()
    for rows in _groups(connected_components(own, directed=False)[1]):
        block = held[:, rows].tocsr()
        bodies = np.flatnonzero(np.diff(block.indptr))
        size = np.sqrt(own[rows][:, rows].diagonal())
        scale = np.where(size > 0.0, 1.0 / np.where(size > 0.0, size, 1.0), 0.0)
        left, values, right = np.linalg.svd(block[bodies].toarray() * scale, full_matrices=False)
        kept = values > _ROUNDED * max(len(bodies), len(rows))
        left, values, right = left[:, kept], values[kept], right[kept]
        speeds = right @ (scale * velocity[rows])
        meet = abs(own[rows][:, rows].toarray()) > 0.0
        reach = np.where(meet | np.eye(len(rows), dtype=bool), np.abs(velocity[rows]), 0.0).max(1)
        # Of rows that almost repeat each other, what drift makes them differ by is not taken out.
        brings = np.abs(speeds[:, None] * right) * size
        is_drift = (values < 0.1 * _DRIFT) & (brings <= _DRIFT * reach).all(axis=1)
        speeds = np.where(is_drift, 0.0, speeds)
        remains = np.abs(velocity[rows] - size * (right.T @ speeds))
        worst = int(np.argmax(remains - _DRIFT * reach))
        if remains[worst] > _DRIFT * reach[worst] + _ROUNDED * np.abs(velocity).max():
            raise ParameterError(
                "bilateral_velocity",
                f"must not contradict itself: {remains[worst]:.3g} (m/s or rad/s) of row "
                f"{rows[worst]} are left, whatever the percussions",
            )
        loads.append(speeds / values)
        entries.add(right * scale / values[:, None], rows)
        spans.add(left.T, bodies)
    basis, span = (part.matrix(n) for part, n in ((entries, held.shape[1]), (spans, held.shape[0])))
    coupling, load = (span @ moving).tocsr(), np.concatenate(loads)
    whole = (moving.T @ moving).diagonal()
    # What rounding leaves of a projection is projected once more.
    free = moving - span.T @ coupling
    free = free - span.T @ (span @ free)
    product = free.T @ free
    delassus = sparse(0.5 * (product + product.T), "directions", (None, None))
    taken = coupling.T @ load
    # What is left where both are the same is rounding of either.
    rounding = _ROUNDED * max(abs(free_velocity).max(), abs(taken).max())
    free_velocity = free_velocity - taken
    dead = delassus.diagonal() <= _ROUNDED * whole
    if dead.any():
        lent = np.zeros(len(dead))
        for number, (rows, force) in enumerate(contacts):
            if dead[rows].all() or (force is None and dead[rows.start]):
                raise ParameterError(
                    "directions", f"must move contact {number}, nothing does: leave it out"
                )
            before = np.where(whole[rows] > 0.0, whole[rows], whole[rows].max())
            lent[rows] = np.where(dead[rows], _LENT * before, 0.0)
        delassus = sparse(delassus + diags_array(lent), "directions", (None, None))
        free_velocity = np.where(dead & (abs(free_velocity) <= rounding), 0.0, free_velocity)
    return Joints(delassus, free_velocity, basis, coupling, load)


class _Entries:
    """Rows of a sparse matrix, some at a time."""

    def __init__(self) -> None:
        self._parts: list[tuple[Array, Any, Any]] = []
        self._count = 0

    def add(self, values: Array, columns: Any) -> None:
        """Add rows with entries in these columns."""
        numbers = self._count + np.arange(len(values))
        i, j = np.meshgrid(numbers, columns, indexing="ij")
        self._parts.append((values.ravel(), i.ravel(), j.ravel()))
        self._count += len(values)

    def matrix(self, width: int) -> csr_array:
        from scipy.sparse import csr_array

        if not self._parts:
            return csr_array((0, width))
        entries, i, j = (np.concatenate(one) for one in zip(*self._parts, strict=True))
        return csr_array((entries, (i, j)), shape=(self._count, width))


def _groups(labels: Any) -> list[Any]:
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(labels[order])) + 1) if labels.size else []
