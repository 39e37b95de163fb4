"""Eigenvalues of a sparse pencil near a point, by shift and invert."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import ConvergenceError, ParameterError
from asperity.steady_sliding.linearised.pencil import SAFETY, Complex
from asperity.steady_sliding.sparse.pencil import SparsePencil
from asperity.system.sparse.factorisation import Factorisation, SingularMatrixError

# Backward error of a pair that is right to rounding.
EXACT = 1e-12
# Share of it below which a pair is not corrected, and rounds of correction.
_GOOD, _CORRECTIONS = 0.01, 2
# |Re s|/|s| below which the sign of growth is examined.
_SMALL = 1e-4
# Distance of two eigenvalues, relative to them, that are one found twice.
_SAME = 1e-8
# Rate, as a share of that of the fastest motions, below which s²M is rounding of K: it scatters the
# double eigenvalue 0 of a body that nothing holds.
_STILL = 3e-8
# Rate of slow motions, as a share of that of the fastest, where the shift names none.
_SLOW = 0.01
# Largest matrix whose eigenvalues are all computed, and share of the largest one of its inverse
# that belongs to an eigenvalue at infinity.
_FEW, _INFINITE = 60, 1e-12
# Entries whose products overflow.
_LARGEST = 1e150
# Relative error of 1/(s − σ) of modes that span a space.
_ROUGH = 1e-7
# Shares of its size by which a shift beside an eigenvalue is moved: eigenvalues far away are found
# from there, too, where those of a free body are all at one point.
_ASIDE = (1e-4, 3e-3, 3e-2, 0.3)
# Restarts of Arnoldi's method, which takes few where it converges at all.
_RESTARTS = 100
# Relative error of the distance of eigenvalues too many at one distance to be told apart, and the
# share of it within which there are none.
_VAGUE, _EMPTY = 0.05, 0.9
# Halvings, on a scale of logarithms, of the interval of an unknown real eigenvalue.
_HALVINGS = 8
# Distance of eigenvalues, relative to them, and cosine of the angle of their modes from which on
# they may be one that lacks modes, scattered by rounding.
_CLOSE, _PARALLEL = 0.01, 0.99
_ADVICE = (
    "Ask for fewer of them, with a smaller `growth` or a shift nearer to those of interest, or, of "
    "up to 2000 coordinates, for all of them: without near and band"
)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Eigenvalues and modes, P(sᵢ)xᵢ = 0."""

    values: Complex
    """In 1/s, shape ``(k,)``."""
    modes: Complex
    """Of length 1, shape ``(n, k)``."""
    backward_errors: Array
    error: Array
    """Bound of |δs| in 1/s where |Re s| or |s| is small, NaN elsewhere."""

    @property
    def sign_is_certain(self) -> NDArray[np.bool_]:
        """Whether no error of rounding changes the sign of Re s."""
        return ~(np.abs(self.values.real) <= SAFETY * np.nan_to_num(self.error))

    def taken(self, chosen: NDArray[Any]) -> Pairs:
        """Return some of them."""
        return Pairs(
            self.values[chosen],
            self.modes[:, chosen],
            self.backward_errors[chosen],
            self.error[chosen],
        )

    def joined(self, other: Pairs) -> Pairs:
        """Return both."""
        return Pairs(
            np.concatenate([self.values, other.values]),
            np.concatenate([self.modes, other.modes], axis=1),
            np.concatenate([self.backward_errors, other.backward_errors]),
            np.concatenate([self.error, other.error]),
        )


def nearest(pencil: SparsePencil, shift: complex, count: int) -> tuple[Pairs, float]:
    """Return eigenvalues nearest to a shift and the radius about it in which they are all found.

    A shift beside an eigenvalue hides the others behind it: it is moved a little. There are fewer
    than `count` where many others are at one distance, as those of overdamped motions.

    Raises:
        ConvergenceError: if pairs do not reach a backward error of 1e-12.
        ParameterError: if P(s) is singular everywhere, or overflows.
    """
    count = min(count, pencil.most)
    if not count:
        return _none(pencil), np.inf
    if not max(*pencil.norms, float(pencil.size(np.array(abs(shift))))) < _LARGEST:
        raise ParameterError(
            "system",
            f"has too large numbers in s²M + sC + K at {abs(shift):.6g} 1/s: choose other units, "
            "or a nearer shift",
        )
    unit = max(abs(shift), _SLOW * pencil.fastest) or 1.0
    worst = np.inf
    for aside in (0.0, *_ASIDE):
        point = shift + aside * unit * (1.0 + 0.5j)
        try:
            factors = pencil.factorised(point)
        except SingularMatrixError:
            continue
        values, modes, reach = _shift_and_invert(pencil, factors, point, count)
        values, modes = _corrected(pencil, factors, values, modes)
        errors = pencil.backward_errors(values, modes)
        if not (errors <= EXACT).all():
            worst = min(worst, float(errors.max()))
            continue
        pairs = Pairs(values, modes, errors, np.full(len(values), np.nan))
        left = partial(_left, pencil, factors, point, len(values))
        pairs = with_errors(pencil, pairs, left)
        return pairs, max(reach - abs(point - shift), 0.0)
    if not np.isfinite(worst):
        raise ParameterError(
            "system", "has a pencil that is singular everywhere: a coordinate without stiffness"
        )
    raise ConvergenceError(
        f"eigenvalues near {shift:.6g} 1/s were found with a backward error of {worst:.2g} only",
        residual=worst,
        advice=_ADVICE,
    )


def crowded(pencil: SparsePencil, shift: complex, found: int, radius: float) -> ConvergenceError:
    """Return the error that says why no more eigenvalues were found near a shift."""
    M, C, K = pencil.norms
    why = ", as of motions that are damped beyond the critical damping" * (C * C > 4.0 * M * K)
    return ConvergenceError(
        f"{found or 'none'} of the eigenvalues near {shift:.6g} 1/s can be told apart: too many "
        f"others are about {radius / _EMPTY:.3g} 1/s away{why}",
        advice=_ADVICE,
    )


def within(
    s: Complex, low: float, high: float, growth: float, *, size: float = 0.0
) -> NDArray[np.bool_]:
    """Return which eigenvalues have low ≤ Im s ≤ high and |Re s| ≤ growth.

    Real ones, Im s = 0, have either sign by rounding, relative to |s| or a larger size.
    """
    rounding = _SAME * np.maximum(np.abs(s), size)
    height = np.where(np.abs(s.imag) <= rounding, 0.0, s.imag)
    return (low <= height) & (height <= high) & (np.abs(s.real) <= growth)


def divergence(pencil: SparsePencil, known: Complex) -> Pairs:
    """Return the real and positive eigenvalue that a list lacks, if it lacks an odd number.

    det P(s) of a real s has the sign of det P(∞) as often as an even number of them is above s.
    """
    real = known.real[within(known, 0.0, 0.0, np.inf)]

    def sign(s: float) -> float:
        turned = np.exp(1j * pencil.factorised(s).log_determinant().imag).real
        return float(np.sign(turned) * np.prod(np.sign(s - real)))

    low, high = _STILL * pencil.fastest, pencil.fastest / _SLOW
    try:
        above = sign(high)
        if sign(low) == above:
            return _none(pencil)
        for _ in range(_HALVINGS):
            middle = np.sqrt(low * high)
            low, high = (low, middle) if sign(middle) == above else (middle, high)
        found = nearest(pencil, complex(np.sqrt(low * high)), 2)[0]
    except SingularMatrixError:
        return _none(pencil)
    grows = within(found.values, 0.0, 0.0, np.inf) & (found.values.real > 0.0)
    return found.taken(grows & are_new(pencil, found.values, known))


def approximate(
    pencil: SparsePencil, shift: complex, radius: float, count: int
) -> tuple[Complex, Complex]:
    """Return the eigenvalues within a circle, and others, to six digits; count is a guess.

    Raises:
        ConvergenceError: if Arnoldi's method fails.
    """
    point = shift * (1.0 + _ASIDE[0] * (1.0 + 0.5j))
    factors = pencil.factorised(point)
    while True:
        count = min(count, pencil.most)
        values, modes, reach = _shift_and_invert(pencil, factors, point, count, tolerance=_ROUGH)
        if count == pencil.most or reach >= radius:
            return values, modes
        if len(values) < count:
            raise crowded(pencil, shift, len(values), reach)
        count += count // 2 + 1


def are_new(pencil: SparsePencil, values: Complex, known: Complex) -> NDArray[np.bool_]:
    """Return which eigenvalues are not among those known; members of close pairs are counted."""
    still = _STILL * pencil.fastest
    size = np.where(np.abs(values) <= still, 2.0 * still, _SAME * np.abs(values))[:, None]
    times_known = (np.abs(values[:, None] - known) <= size).sum(axis=1)
    twins = np.abs(values[:, None] - values) <= size
    return np.asarray(np.tril(twins).sum(axis=1) > times_known)


def _none(pencil: SparsePencil) -> Pairs:
    none = np.zeros(0, dtype=np.complex128)
    return Pairs(none, np.zeros((pencil.n, 0), dtype=np.complex128), none.real, none.real)


def _doubtful(pencil: SparsePencil, values: Complex, modes: Complex) -> NDArray[np.bool_]:
    """Return whose growth rate may have either sign."""
    size = np.abs(values)
    near = np.abs(values[:, None] - values) <= _CLOSE * size
    parallel = np.abs(modes.conj().T @ modes) >= _PARALLEL
    merged = (near & near.T & parallel).sum(axis=1) > 1
    small = np.abs(values.real) <= _SMALL * size
    return np.asarray(small | (size <= 10.0 * _STILL * pencil.fastest) | merged)


def _shift_and_invert(
    pencil: SparsePencil,
    factors: Factorisation,
    shift: complex,
    count: int,
    *,
    tolerance: float = 0.0,
) -> tuple[Complex, Complex, float]:
    """Run Arnoldi's method for (x, sx/ω), in complex numbers throughout.

    Returns:
        Eigenvalues, modes, and the radius about the shift in which there are no others.

    With ω about |σ| both halves have one size. (A − σ)⁻¹ takes (a, b) to (y, (σy + a)/ω) with
    P(σ)y = −ωMb − (C + σM)a.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigs

    n, unit = pencil.n, max(abs(shift), _SLOW * pencil.fastest) or 1.0
    first = csc_array(pencil.damping + pencil.mass * np.complex128(shift))

    def inverted(x: NDArray[Any]) -> Complex:
        a, b = x[:n].ravel(), x[n:].ravel()
        y = factors.solve(-unit * (pencil.mass @ b) - first @ a)
        return np.concatenate([y, (shift * y + a) / unit])

    if 2 * n <= max(_FEW, count + 1):
        values, modes = _largest(
            np.stack([inverted(x) for x in np.eye(2 * n)], axis=1), shift, count
        )
        return values, modes, float(np.abs(values - shift).max())
    operator = LinearOperator((2 * n, 2 * n), matvec=inverted, dtype=np.complex128)
    start = np.cos(np.arange(1.0, 2 * n + 1.0)).astype(np.complex128)
    options = {"which": "LM", "v0": start, "maxiter": _RESTARTS}
    try:
        try:
            found, vectors = eigs(operator, k=count, tol=tolerance, **options)
            reach = 1.0 / np.abs(found).min()
        except ArpackNoConvergence as error:
            found, vectors = error.eigenvalues, error.eigenvectors
            others = eigs(operator, k=len(found) + 1, tol=_VAGUE, **options)[0]
            reach = _EMPTY / np.abs(others).min()
            inside = np.abs(found) * reach >= 1.0
            found, vectors = found[inside], vectors[:, inside]
    except ArpackError as error:
        raise ConvergenceError(
            f"Arnoldi's method near {shift:.6g} 1/s: {error}",
            advice=_ADVICE,
        ) from None
    return shift + 1.0 / found, vectors[:n], float(reach)


def _largest(inverse: Complex, shift: complex, count: int) -> tuple[Complex, Complex]:
    """Return the eigenvalues next to the shift from the whole matrix (A − σ)⁻¹."""
    found, vectors = np.linalg.eig(inverse)
    # Coordinates without mass have eigenvalues at infinity.
    finite = np.abs(found) > _INFINITE * np.abs(found).max()
    order = np.argsort(-np.abs(found))[: min(count, int(finite.sum()))]
    values: Complex = (shift + 1.0 / found[order]).astype(np.complex128)
    return values, vectors[: len(inverse) // 2, order].astype(np.complex128)


def _corrected(
    pencil: SparsePencil, factors: Factorisation, values: Complex, modes: Complex
) -> tuple[Complex, Complex]:
    """Take away what the factors at the shift see of the residuals: x ← x − P(σ)⁻¹P(s)x.

    What Arnoldi's method leaves is of eigenvalues far away, which this divides by their distance;
    what is of nearer ones grows, so that each pair is kept as it was where that was better.
    """
    modes = modes / np.linalg.norm(modes, axis=0)
    values = rayleigh(pencil, values, modes)
    errors = pencil.backward_errors(values, modes)
    for _ in range(_CORRECTIONS):
        rough = np.flatnonzero(errors > _GOOD * EXACT)
        if not len(rough):
            break
        s, x = values[rough], modes[:, rough]
        x = x - factors.solve(pencil.times(s, x))
        x /= np.linalg.norm(x, axis=0)
        s = rayleigh(pencil, s, x)
        left = pencil.backward_errors(s, x)
        better = left < errors[rough]
        if not better.any():
            break
        chosen = rough[better]
        values[chosen], modes[:, chosen], errors[chosen] = s[better], x[:, better], left[better]
    return values, modes


def rayleigh(pencil: SparsePencil, values: Complex, modes: Complex) -> Complex:
    """Solve xᴴP(s)x = 0 for s by Newton's method, two steps."""
    for _ in range(2):
        left = modes.conj()
        slope = np.sum(left * pencil.slopes(values, modes), axis=0)
        moved = np.sum(left * pencil.times(values, modes), axis=0)
        values = values - np.where(slope != 0.0, moved / np.where(slope != 0.0, slope, 1.0), 0.0)
    return values


def with_errors(
    pencil: SparsePencil, pairs: Pairs, left: Callable[[], tuple[Complex, Complex]]
) -> Pairs:
    """Bound the errors of doubtful eigenvalues by their left eigenvectors, found by `left`.

    The bound is of first order: where the discs of several eigenvalues overlap they may be one that
    rounding has scattered, and each is as uncertain as they are far from each other.
    """
    from scipy.sparse.csgraph import connected_components

    doubtful = _doubtful(pencil, pairs.values, pairs.modes)
    if not doubtful.any():
        return pairs
    values, vectors = left()
    if len(values) < len(pairs.values):
        # Where many are at one distance, some may lack a left one, and nothing is known of any.
        return replace(pairs, error=np.where(doubtful, np.inf, np.nan))
    error = pencil.errors_of(pairs.values, pairs.modes, _matched(pencil, pairs, values, vectors))
    # Nothing is known of the error of a multiple one, which must not reach all others.
    radius = np.minimum(SAFETY * error, _CLOSE * np.abs(pairs.values))
    distance = np.abs(pairs.values[:, None] - pairs.values)
    touching = doubtful & doubtful[:, None] & (distance <= radius + radius[:, None])
    number, label = connected_components(touching, directed=False)
    for group in (np.flatnonzero(label == one) for one in range(number)):
        if len(group) > 1:
            error[group] = distance[np.ix_(group, group)].max() + error[group].max()
    return replace(pairs, error=np.where(doubtful, error, np.nan))


def _left(
    pencil: SparsePencil, factors: Factorisation, shift: complex, count: int
) -> tuple[Complex, Complex]:
    """Return eigenvalues with y, yᵀP(s) = 0, by the same factors."""
    across, turned = _Transposed(factors), pencil.transposed
    values, modes, _ = _shift_and_invert(turned, across, shift, count)
    return _corrected(turned, across, values, modes)


def _matched(pencil: SparsePencil, pairs: Pairs, values: Complex, left: Complex) -> Complex:
    """Return the left eigenvector of each pair."""
    from scipy.optimize import linear_sum_assignment

    # Of equal eigenvalues each takes another vector.
    _, order = linear_sum_assignment(np.abs(pairs.values[:, None] - values))
    return _biorthogonal(pencil, pairs, left[:, order])


def _biorthogonal(pencil: SparsePencil, pairs: Pairs, left: Complex) -> Complex:
    """Combine the vectors of equal eigenvalues: yᵢᵀP′(sⱼ)xⱼ = 0 for i ≠ j."""
    slopes, made = left.T @ pencil.slopes(pairs.values, pairs.modes), left.copy()
    open_ones = np.ones(len(pairs.values), dtype=np.bool_)
    for s in pairs.values:
        same = np.flatnonzero(open_ones & (np.abs(pairs.values - s) <= _SAME * np.abs(s)))
        if len(same) > 1:
            block = slopes[np.ix_(same, same)]
            # Of a defective eigenvalue it is singular, and the error is as large as that makes it.
            made[:, same] = left[:, same] @ np.linalg.pinv(block).T
        open_ones[same] = False
    return made


class _Transposed(Factorisation):
    """Factors of Aᵀ by those of A."""

    def __init__(self, factors: Factorisation) -> None:
        self.lu, self.is_complex, self.order = factors.lu, factors.is_complex, factors.order

    def solve(self, right: NDArray[Any], *, transposed: bool = False) -> NDArray[Any]:
        return super().solve(right, transposed=not transposed)
