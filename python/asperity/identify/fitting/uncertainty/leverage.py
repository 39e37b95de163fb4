"""How much single clusters of samples decide on an estimate: unbiased scatter, and its degrees.

Residuals of a cluster, such as a turn or a stroke, are smaller than its errors, because the fit
follows the cluster: the more, the more the cluster decides. With J_c the derivatives at the samples
of cluster c, M = Σ J_cᵀJ_c and P_c = M^(−1/2) J_cᵀJ_c M^(−1/2), gradients of clusters are therefore
divided by √(1 − P_c): then their scatter has the right mean for independent errors of one size (the
estimator CR2 of Bell and McCaffrey, 2002). For turns that are all alike P_c = 1/G, and this is the
familiar factor G/(G − 1).

Where few strokes decide on a parameter, its variance is estimated from as few. The degrees of
freedom of Student's t are those that Satterthwaite's approximation gives to the variance of each
combination of coordinates (loc. cit.); G − 1 for turns that are alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array

_NONE = 1e-13
# Beyond this part of a combination of coordinates, one cluster tells it alone.
_ALONE = 1.0 - 1e-6
# A coordinate is known from a cluster if this part of its variance is.
_MUCH = 0.1
# Samples on an axis of D have derivatives that are no more than cut off.
_MOST = 0.99


@dataclass(frozen=True, eq=False)
class Leverage:
    """What clusters decide.

    Attributes:
        root: M^(−1/2) in columns, without what the data do not see, ``(k, r)``.
        values: eigenvalues of P_c, ``(G, r)``.
        vectors: its eigenvectors, ``(G, r, r)``.
        single: whether a coordinate is known from one cluster alone, so that nothing is known of
            its scatter; ``(k,)``.
    """

    root: Array
    values: Array
    vectors: Array
    single: NDArray[np.bool_]

    @property
    def rank(self) -> int:
        """Number of combinations of coordinates that the data see."""
        return int(self.root.shape[1])

    def covariance(self, gradients: Array) -> Array:
        """Return the covariance of the estimate from the gradients ``(G, k)`` of the clusters."""
        seen = np.einsum("gij,gi->gj", self.vectors, gradients @ self.root)
        seen = np.einsum("gij,gj->gi", self.vectors, seen / np.sqrt(1.0 - self.values))
        steps = seen @ self.root.T
        return np.asarray(steps.T @ steps)

    def degrees(self, directions: Array) -> Array:
        """Return the degrees of freedom of the variances of combinations ``(n, k)``."""
        seen = np.einsum("gij,ni->gnj", self.vectors, directions @ self.root)
        # Of errors of one size, the residuals of clusters c and d that matter have the covariance
        # δ_cd |a_c|² − b_c·b_d.
        own = np.einsum("gnj,gj->gn", seen**2, self.values / (1.0 - self.values))
        shared = seen * (self.values / np.sqrt(1.0 - self.values))[:, None]
        shared = np.einsum("gij,gnj->ngi", self.vectors, shared)
        lengths = np.einsum("ngi,ngi->gn", shared, shared)
        inner = np.einsum("ngi,ngj->nij", shared, shared)
        mean = (own - lengths).sum(axis=0)
        square = (own**2 - 2.0 * own * lengths).sum(axis=0) + np.einsum("nij,nij->n", inner, inner)
        most = len(self.values) - 1.0
        known = square > np.finfo(float).tiny
        found = np.divide(mean**2, square, out=np.full_like(mean, most), where=known)
        return np.maximum(found, 1.0)


def leverage_of(matrix: Array, matrices: Array) -> Leverage:
    """Return what clusters with matrices ``(G, k, k)`` decide, whose sum is the matrix."""
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale[scale == 0.0] = 1.0
    sizes, axes = np.linalg.eigh(matrix / np.outer(scale, scale))
    seen = sizes > _NONE
    root = axes[:, seen] / np.sqrt(sizes[seen]) / scale[:, None]
    values, vectors = np.linalg.eigh(root.T @ matrices @ root)
    alone = np.einsum("kr,gri->gki", root, vectors * (values > _ALONE)[:, None])
    whole = np.maximum((root**2).sum(axis=1), np.finfo(float).tiny)
    single = (alone**2).sum(axis=-1).max(axis=0, initial=0.0) > _MUCH * whole
    return Leverage(root, np.clip(values, 0.0, _MOST), vectors, single)
