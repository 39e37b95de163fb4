"""Painlevé's paradox of several contacts: whether normal forces exist that keep bodies apart."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from asperity._base.arrays import Array

# Largest number of contacts of which all sets are tried: 4095 determinants.
_ALL = 12
# Principal minors below this share of Hadamard's bound are rounding.
_TINY = 1e-14


def not_keeping_apart(push: Array) -> tuple[int, ...] | None:
    """Return a set of contacts whose normal forces do not keep them from closing, if there is one.

    Normal accelerations P λ_N + c have exactly one complementary λ_N ≥ 0 for any c if P is a
    P-matrix: the principal minors of all sets are positive. A smallest set with one that is not
    is returned. For more than 12 contacts minors of single contacts and pairs are tried, then a
    sufficient condition: P + Pᵀ, with rows scaled to P_ii = 1, is positive definite, or P is
    diagonally dominant after scaling. All contacts are returned if both fail.

    Args:
        push: P = W_NᵀM⁻¹(W_N + W f), shape ``(m, m)``.
    """
    diagonal = np.diag(push)
    if (diagonal <= 0.0).any():
        return (int(diagonal.argmin()),)
    P, m = push / diagonal[:, None], len(push)
    for size in range(2, (m if m <= _ALL else 2) + 1):
        sets = np.array(list(combinations(range(m), size)))
        parts = P[sets[:, :, None], sets[:, None, :]]
        minors = np.linalg.det(parts) / np.linalg.norm(parts, axis=2).prod(axis=1)
        if minors.min() <= _TINY:
            return tuple(sets[minors.argmin()].tolist())
    if m <= _ALL or np.linalg.eigvalsh(P + P.T).min() > _TINY or _dominant(P):
        return None
    return tuple(range(m))


def _dominant(P: Array) -> bool:
    """Whether the off-diagonal part of P, with P_ii = 1, has a spectral radius below one."""
    across = np.abs(P - np.eye(len(P)))
    return bool(np.abs(np.linalg.eigvals(across)).max() < 1.0)
