"""How much single clusters of samples decide on an estimate: unbiased scatter, and its degrees.

Residuals of a cluster, such as a turn or a stroke, are smaller than its errors, because the fit
follows the cluster: the more, the more the cluster decides. With J_c the derivatives at the samples
of cluster c, M = Σ J_cᵀJ_c and P_c = M^(−1/2) J_cᵀJ_c M^(−1/2), gradients of clusters are therefore
divided by √(1 − P_c): then their scatter has the right mean for independent errors of one size (the
estimator CR2 of Bell and McCaffrey, 2002). For turns that are all alike P_c = 1/G, and this is the
familiar factor G/(G − 1).

Divided by 1 − P_c instead, they are the steps of the jackknife: how far the estimate would move
without the cluster.

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
# A combination is compared between clusters if so much of its variance is seen.
_SEEN = 0.99
# A combination is not told if a larger part of its derivative is where nothing is known.
_PART = 1e-3


@dataclass(frozen=True, eq=False)
class Leverage:
    """What clusters decide.

    Attributes:
        root: M^(−1/2) in columns, without what the data do not see, ``(k, r)``.
        values: eigenvalues of P_c, ``(G, r)``.
        vectors: its eigenvectors, ``(G, r, r)``.
        single: whether a coordinate is known from one cluster alone, so that nothing is known of
            its scatter; ``(k,)``.
        scale: lengths of the derivatives by the coordinates, which make these comparable.
        blind: unit directions of scaled coordinates that the data do not see, or not without
            some cluster, ``(k, m)``.
    """

    root: Array
    values: Array
    vectors: Array
    single: NDArray[np.bool_]
    scale: Array
    blind: Array

    @property
    def rank(self) -> int:
        """Number of combinations of coordinates that the data see."""
        return int(self.root.shape[1])

    @property
    def inverse(self) -> Array:
        """The inverse of M, where the data see: the covariance for independent unit errors."""
        return np.asarray(self.root @ self.root.T)

    def steps(self, gradients: Array, power: float = 0.5) -> Array:
        """Return the steps ``(G, k)`` that follow from gradients over (1 − P_c) to some power."""
        seen = np.einsum("gij,gi->gj", self.vectors, gradients @ self.root)
        seen = np.einsum("gij,gj->gi", self.vectors, seen / (1.0 - self.values) ** power)
        return np.asarray(seen @ self.root.T)

    def covariance(self, gradients: Array) -> Array:
        """Return the covariance of the estimate from the gradients ``(G, k)`` of the clusters."""
        steps = self.steps(gradients)
        return np.asarray(steps.T @ steps)

    def jackknife(self, gradients: Array) -> Array:
        """Return the covariance from the estimates that leave out one cluster, to first order.

        It is nearly unbiased with few clusters whose residuals are not independent.
        """
        steps = self.steps(gradients, 1.0)
        steps -= steps.mean(axis=0)
        return np.asarray((len(steps) - 1.0) / len(steps) * steps.T @ steps)

    def degrees(self, directions: Array) -> Array:
        """Return the degrees of freedom of the variances of combinations ``(n, k)``."""
        mean, square = self._moments(directions)
        most = len(self.values) - 1.0
        known = square > np.finfo(float).tiny
        found = np.divide(mean**2, square, out=np.full_like(mean, most), where=known)
        return np.maximum(found, 1.0)

    def compares(self, directions: Array) -> NDArray[np.bool_]:
        """Return whether the scatter of clusters holds the variances of combinations ``(n, k)``."""
        whole = ((directions @ self.root) ** 2).sum(axis=1)
        return np.asarray(self._moments(directions)[0] > _SEEN * whole)

    def tells(self, slope: Array) -> bool:
        """Return whether the data tell a parameter that has this derivative by coordinates."""
        scaled = slope / self.scale
        scaled /= np.abs(scaled).max(initial=0.0) or 1.0
        return bool((np.abs(scaled @ self.blind) <= _PART * np.linalg.norm(scaled)).all())

    def _moments(self, directions: Array) -> tuple[Array, Array]:
        """Return mean and half the variance of estimated variances, for errors of one size."""
        seen = np.einsum("gij,ni->gnj", self.vectors, directions @ self.root)
        # The residuals of clusters c and d that matter have the covariance δ_cd |a_c|² − b_c·b_d.
        own = np.einsum("gnj,gj->gn", seen**2, self.values / (1.0 - self.values))
        shared = seen * (self.values / np.sqrt(1.0 - self.values))[:, None]
        shared = np.einsum("gij,gnj->ngi", self.vectors, shared)
        lengths = np.einsum("ngi,ngi->gn", shared, shared)
        inner = np.einsum("ngi,ngj->nij", shared, shared)
        square = (own**2 - 2.0 * own * lengths).sum(axis=0) + np.einsum("nij,nij->n", inner, inner)
        return (own - lengths).sum(axis=0), square


def leverage_of(matrix: Array, matrices: Array, *, without_single: bool = False) -> Leverage:
    """Return what clusters with matrices ``(G, k, k)`` decide, whose sum is the matrix.

    Args:
        matrix: JᵀJ of all clusters, ``(k, k)``.
        matrices: of each cluster.
        without_single: whether what a cluster tells alone is left out of its steps.
    """
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale[scale == 0.0] = 1.0
    sizes, axes = np.linalg.eigh(matrix / np.outer(scale, scale))
    seen = sizes > _NONE
    root = axes[:, seen] / np.sqrt(sizes[seen]) / scale[:, None]
    values, vectors = np.linalg.eigh(root.T @ matrices @ root)
    alone = np.einsum("kr,gri->gki", root, vectors * (values > _ALONE)[:, None])
    whole = np.maximum((root**2).sum(axis=1), np.finfo(float).tiny)
    single = (alone**2).sum(axis=-1).max(axis=0, initial=0.0) > _MUCH * whole
    blind = scale[:, None] * np.moveaxis(alone, 1, 0).reshape(len(matrix), -1)
    lengths = np.linalg.norm(blind, axis=0)
    blind = np.hstack([axes[:, ~seen], blind[:, lengths > 0.0] / lengths[lengths > 0.0]])
    if without_single:
        vectors = vectors * (values <= _ALONE)[:, None]
    values = np.clip(values, 0.0, _ALONE if without_single else _MOST)
    return Leverage(root, values, vectors, single, scale, blind)
