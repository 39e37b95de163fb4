"""Covariance of the coordinates of a law from what differs between paths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.paths.misfits import Misfits

# What is told by one path alone but for this share has no scatter between paths.
_ALONE = 1e-6
# A combination is known if so much of its variance is seen between paths.
_SEEN = 0.99


@dataclass(frozen=True, eq=False)
class Spread:
    """How far the coordinates of a law scatter, by path.

    The launches are projected out, path by path; what is left of a path are the gradient of its
    squares by the coordinates, and the information N_g = X_gᵀX_g that it holds. With N = Σ N_g the
    covariance is N⁻¹ (Σ w_g w_gᵀ) N⁻¹ where w_g is the gradient of a path, corrected for what the
    fit has taken of it: w_g = (1 − N_g N⁻¹)^(−1/2) X_gᵀ r_g. It is unbiased if the errors of the
    positions are as stated, and holds whatever else is common to the points of one path. Degrees of
    freedom of a combination are those of Satterthwaite's approximation.

    Attributes:
        root: L with L Lᵀ = N.
        gradients: L⁻¹w_g, ``(G, k)``.
        shares: L⁻¹N_gL⁻ᵀ, which add up to 1, ``(G, k, k)``.
        inverse_roots: (1 − shares)^(−1/2), ``(G, k, k)``.

    Reference: R. M. Bell, D. F. McCaffrey: Bias reduction in standard errors for linear regression
    with multi-stage samples, Survey Methodology 28 (2002).
    """

    root: Array
    gradients: Array
    shares: Array
    inverse_roots: Array

    @property
    def covariance(self) -> Array:
        """Covariance of the coordinates, ``(k, k)``."""
        steps = np.linalg.solve(self.root.T, self.gradients.T)
        return np.asarray(steps @ steps.T)

    @property
    def stated(self) -> Array:
        """Covariance that follows from the stated errors alone, ``(k, k)``."""
        inverse = np.linalg.inv(self.root)
        return np.asarray(inverse.T @ inverse)

    def degrees(self, direction: Array) -> float:
        """Return the degrees of freedom of a combination of coordinates; 0 if none are there."""
        v = np.linalg.solve(self.root, direction)
        own = self.inverse_roots @ v
        seen = np.einsum("gi,gij->gj", own, self.shares)
        between = -seen @ seen.T
        between[np.diag_indices_from(between)] += np.einsum("gi,gi->g", seen, own)
        trace = float(np.trace(between))
        if not trace > _SEEN * float(v @ v):
            return 0.0
        return trace**2 / float(np.sum(between**2))


def spread(misfits: Misfits, residuals: Array, jacobian: Array) -> Spread | None:
    """Return the scatter between paths; None if the paths do not tell all coordinates."""
    size, count = misfits.size, len(misfits.paths)
    matrices, gradients = np.empty((count, size, size)), np.empty((count, size))
    for k, rest in enumerate(shared_parts(misfits, jacobian)):
        matrices[k] = rest.T @ rest
        gradients[k] = rest.T @ residuals[misfits.of(k)]
    try:
        root = np.linalg.cholesky(matrices.sum(axis=0))
    except np.linalg.LinAlgError:
        return None
    inverse = np.linalg.inv(root)
    shares = inverse @ matrices @ inverse.T
    sizes, vectors = np.linalg.eigh(np.eye(size) - 0.5 * (shares + shares.swapaxes(1, 2)))
    powers = np.where(sizes > _ALONE, np.maximum(sizes, _ALONE) ** -0.5, 0.0)
    inverse_roots = (vectors * powers[:, None, :]) @ vectors.swapaxes(1, 2)
    gradients = np.einsum("gij,gj->gi", inverse_roots, gradients @ inverse.T)
    return Spread(root, gradients, shares, inverse_roots)


def shared_parts(misfits: Misfits, jacobian: Array) -> list[Array]:
    """Return the derivatives by the law that changes of the launch do not mimic, path by path."""
    parts = []
    for k in range(len(misfits.paths)):
        rows = jacobian[misfits.of(k)]
        shared, own = rows[:, : misfits.size], rows[:, misfits.unknowns_of(k)]
        scale = np.linalg.norm(own, axis=0)
        basis = np.linalg.qr(own / np.where(scale > 0.0, scale, 1.0))[0]
        parts.append(shared - basis @ (basis.T @ shared))
    return parts
