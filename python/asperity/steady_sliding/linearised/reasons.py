"""Why steady sliding is unstable: its growth rate without one mechanism after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress

import numpy as np

from asperity._base.arrays import Array
from asperity.steady_sliding.linearised.linearisation import (
    CONE,
    COUPLING,
    DIRECTION,
    FEEDBACK,
    FOLLOWER,
    INTERNAL,
    SLOPE,
    Linearisation,
    total,
)
from asperity.steady_sliding.linearised.pencil import Pencil
from asperity.steady_sliding.linearised.spectrum import Spectrum, growth_rate, spectrum

DAMPING, STIFFNESS = "negative damping", "negative stiffness"
# What the direction of friction does where its part of B is symmetric.
_UNEVEN = "uneven damping"

# A mechanism counts if without it the growth rate falls by more than this share, and accounts for
# all if no more than this share is left.
_NOTABLE = 1e-3

_SENTENCES = {
    CONE: "the sliding direction lies in the interior of the tangent cone of C at −λ",
    DIRECTION: "the friction force turns with the sliding direction, which makes B nonsymmetric",
    _UNEVEN: "friction damps across the sliding direction and not along it (destabilisation by "
    "damping)",
    SLOPE: "the friction force falls with the sliding speed (Stribeck slope)",
    COUPLING: "the stiffness is nonsymmetric, as where the normal force depends on displacements "
    "(mode coupling)",
    FEEDBACK: "the normal force depends on the velocities (velocity feedback)",
    FOLLOWER: "the friction force follows the motion (follower force)",
    DAMPING: "the damping without friction is negative",
    STIFFNESS: "the stiffness without friction is negative",
}


def reduced_spectrum(whole: Linearisation) -> Spectrum:
    """Return the spectrum of the motion within the closed contacts."""
    return spectrum(whole.reduced.pencil, whole.reduced.errors)


def growth_rates(whole: Linearisation) -> dict[str, float]:
    """Return the growth rate that is left without each mechanism that acts."""
    part = whole.reduced
    M, B, K = part.pencil
    return {
        name: growth_rate(Pencil(M, damping, stiffness), part.errors)
        for name, damping, stiffness in _ablated(whole, B, K)
        if not (_same(damping, B) and _same(stiffness, K))
    }


def sentence(whole: Linearisation, left: Mapping[str, float], growth_rate: float) -> str:
    """Name the mechanisms without which it would not be unstable."""
    alone = [name for name, rate in left.items() if rate <= _NOTABLE * growth_rate]
    helping = [n for n, rate in left.items() if rate < (1.0 - _NOTABLE) * growth_rate]
    named = alone or sorted(helping, key=left.__getitem__)
    if not named:
        return "no single force accounts for it"
    turning = whole.damping[DIRECTION]
    even = _same(turning, turning.T)
    joined = "; ".join(_SENTENCES[_UNEVEN if even and n == DIRECTION else n] for n in named)
    if len(named) == 1:
        return joined if alone else f"{joined}, which is not the only reason"
    return f"without any one of these it would not be: {joined}" if alone else f"together: {joined}"


def _ablated(whole: Linearisation, B: Array, K: Array) -> Iterator[tuple[str, Array, Array]]:
    """Yield name, damping and stiffness without one mechanism."""
    part = whole.reduced
    for name in (CONE, DIRECTION, SLOPE, FOLLOWER):
        if not any(np.any(parts.get(name, 0.0)) for parts in (whole.stiffness, whole.damping)):
            continue
        rest = whole.without(name).reduced
        yield name, total(rest.damping), total(rest.stiffness)
    zero = np.zeros_like(K)
    skew = 0.5 * (part.stiffness[INTERNAL] - part.stiffness[INTERNAL].T)
    yield COUPLING, B, K - part.stiffness.get(COUPLING, zero) - skew
    yield FEEDBACK, B - part.damping.get(FEEDBACK, zero), K
    yield DAMPING, B + _deficit(part.damping[INTERNAL], part.mass), K
    yield STIFFNESS, B, K + _deficit(part.stiffness[INTERNAL], part.mass)


def _deficit(matrix: Array, mass: Array) -> Array:
    """Return what the symmetric part lacks to be positive semidefinite, relative to the mass."""
    if not len(matrix):
        return matrix
    symmetric = 0.5 * (matrix + matrix.T)
    with suppress(np.linalg.LinAlgError):
        np.linalg.cholesky(symmetric)
        return np.zeros_like(matrix)
    root = np.linalg.cholesky(mass)
    values, vectors = np.linalg.eigh(np.linalg.solve(root, np.linalg.solve(root, symmetric).T))
    lacking = np.where(values < -1e-9 * np.abs(values).max(initial=0.0), -values, 0.0)
    half = root @ vectors
    return (half * lacking) @ half.T


def _same(a: Array, b: Array) -> bool:
    """Whether they differ by rounding only."""
    size = max(np.abs(a).max(initial=0.0), np.abs(b).max(initial=0.0))
    return bool(np.abs(a - b).max(initial=0.0) <= 1e-9 * size)
