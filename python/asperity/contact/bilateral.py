"""Bilateral rows, which hold the bodies of a contact problem, eliminated from ξ = G P + b."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact import operator
from asperity.contact.compressed import CompressedRows, compressed, sparse
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# As in the core: part of a row's mobility that rounding may have made, and part of the velocities
# which joints take out that may be left.
_ROUNDED, _DRIFT = 1e-12, 1e-6


class Joints(NamedTuple):
    """What is left of a problem when its bilateral rows have been eliminated.

    With S = diag(G_EE)^(−1/2) and S G_EE S = V Λ Vᵀ is B = Λ^(−1/2) Vᵀ S over the eigenvalues that
    are not zero: P_E = −Bᵀ(B b_E + B G_EC P) has the least Σ G_ii P_i² among all that hold.

    Attributes:
        delassus: G_CC − (B G_EC)ᵀ(B G_EC).
        free_velocity: b − (B G_EC)ᵀ B b_E.
        basis: B.
        coupling: B G_EC.
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
) -> Joints:
    """Eliminate the rows; refuse what they contradict or leave nothing to move.

    Rows that influence each other are eliminated by themselves: islands remain islands.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    operator.check_mass(mass)
    held, contacts = bilateral.tocsr(), directions.tocsr()
    moved = operator.inverse(mass.tocsr()) @ held
    own = (held.T @ moved).tocsr()
    basis, first = csr_array((0, held.shape[1])), 0
    parts: list[tuple[Any, Any, Any]] = []
    for rows in _groups(connected_components(own, directed=False)[1]):
        block = own[rows][:, rows].toarray()
        values = _basis(block)
        left = np.abs(velocity[rows] - block @ (values.T @ (values @ velocity[rows])))
        meet = np.abs(block) > _ROUNDED * np.sqrt(np.outer(block.diagonal(), block.diagonal()))
        reach = np.where(meet | np.eye(len(rows), dtype=bool), np.abs(velocity[rows]), 0.0).max(1)
        worst = int(np.argmax(left - _DRIFT * reach))
        if left[worst] > _DRIFT * reach[worst] + _ROUNDED * np.abs(velocity).max():
            raise ParameterError(
                "bilateral_velocity",
                f"must not contradict itself: {left[worst]:.3g} (m/s or rad/s) of row "
                f"{rows[worst]} are left, whatever the percussions",
            )
        places = np.meshgrid(first + np.arange(len(values)), rows, indexing="ij")
        parts.append((values.ravel(), places[0].ravel(), places[1].ravel()))
        first += len(values)
    if parts:
        entries, i, j = (np.concatenate(one) for one in zip(*parts, strict=True))
        basis = csr_array((entries, (i, j)), shape=(first, held.shape[1]))
    coupling = (basis @ (moved.T @ contacts)).tocsr()
    load = np.asarray(basis @ velocity)
    whole = operator.assembled(mass.tocsr(), contacts)
    taken = coupling.T @ coupling
    delassus = sparse(whole - 0.5 * (taken + taken.T), "directions", (None, None))
    idle = np.flatnonzero(whole.diagonal() <= 0.0)
    if idle.size:
        raise ParameterError("directions", f"must move in every row, row {idle[0]} moves nothing")
    dead = np.flatnonzero(delassus.diagonal() <= _ROUNDED * whole.diagonal())
    if dead.size:
        raise ParameterError(
            "directions",
            f"must move in every row, bilateral rows hold row {dead[0]}: leave it out",
        )
    return Joints(delassus, free_velocity - coupling.T @ load, basis, coupling, load)


def _groups(labels: Any) -> list[Any]:
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(labels[order])) + 1) if labels.size else []


def _basis(block: Array) -> Array:
    """Return B of rows that influence each other."""
    diagonal = block.diagonal()
    moves = diagonal > 0.0
    scale = np.where(moves, 1.0 / np.sqrt(np.where(moves, diagonal, 1.0)), 0.0)
    values, vectors = np.linalg.eigh(scale[:, None] * block * scale)
    # What rows that almost repeat each other leave of velocities is their root.
    kept = values > (0.1 * _DRIFT) ** 2 * len(block)
    return np.asarray((vectors[:, kept] * scale[:, None] / np.sqrt(values[kept])).T)
