"""Growth rates over the sliding direction and the rotation of C."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.progress import Progress, each, reporter
from asperity._base.result import Axis, Series, Table
from asperity._base.storage.data import Kinds
from asperity._base.storage.result_file import SavedResult
from asperity._base.value import AnyArray, Given, Record
from asperity.errors import DimensionError, ParameterError
from asperity.steady_sliding.linearised.pencil import ROUNDING, SAFETY, Complex, Pencil
from asperity.system import MassOnBelt

# In first-order matrices without entries above this size real parts below and above these parts of
# it are zero and not zero for sure; the others are judged one by one, which takes ten times longer.
# Growth rates that are computed together: fewer take longer each.
_PART = 4096
_EVEN, _NOTHING, _CLEAR = 1e3, 1e-13, 1e-6


class GrowthChart(SavedResult, Record):
    """Growth rates over the direction of a belt and the rotation of C, found by `growth_chart`.

    NumPy takes it for the array `growth`.

    Args:
        phi: directions of the belt velocity in rad, of any shape.
        zeta: rotations of C in rad, of any shape.
        growth: largest real parts of the eigenvalues in 1/s, ``phi.shape + zeta.shape``.
    """

    phi: Annotated[Given[ArrayLike, Array], arrays.array]
    zeta: Annotated[Given[ArrayLike, Array], arrays.array]
    growth: AnyArray

    def _complete(self, given: dict[str, Any]) -> None:
        shape = (*given["phi"].shape, *given["zeta"].shape)
        given["growth"] = arrays.with_gaps(given["growth"], "growth", shape)
        if np.isinf(given["growth"]).any():
            raise ParameterError("growth", "must be finite, or NaN where it is not known")

    _picture = "plot_growth_chart"

    @classmethod
    def _known(cls) -> Kinds:
        return {cls.__name__: cls}

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> Array:
        return np.array(self.growth, dtype=dtype)

    def __repr__(self) -> str:
        largest = f" up to {self._largest():.6g} 1/s" if self._unknown() < 1.0 else ""
        return (
            f"<GrowthChart: {self.growth.size} growth rates{largest}, "
            f"unstable at {self._unstable():.1%}>"
        )

    def _largest(self) -> float:
        return float(np.nanmax(self.growth, initial=-np.inf))

    def _unstable(self) -> float:
        return float((self.growth > 0.0).mean()) if self.growth.size else 0.0

    def _unknown(self) -> float:
        return float(np.isnan(self.growth).mean()) if self.growth.size else 1.0

    def summary(self) -> str:
        """Return where sliding is unstable, in sentences."""
        unknown = self._unknown() if self.growth.size else 0.0
        rest = f"\nAt {unknown:.1%} the growth rate is not known." if unknown else ""
        return f"{self._found()}{rest}"

    def _found(self) -> str:
        over = f"{self.phi.size} directions of the belt and {self.zeta.size} rotations of C"
        if not self._unstable():
            known = " where its growth rate is known" if np.isnan(self.growth).any() else ""
            return f"Over {over} steady sliding is nowhere unstable{known}."
        at = np.unravel_index(int(np.nanargmax(self.growth)), self.growth.shape)
        phi, zeta = self.phi[at[: self.phi.ndim]], self.zeta[at[self.phi.ndim :]]
        return (
            f"Over {over} steady sliding is unstable at {self._unstable():.1%}.\n"
            f"Small motions grow fastest, like exp({self._largest():.6g} t) with t in s, where the "
            f"belt moves along {np.rad2deg(phi):.6g}° and C is turned by {np.rad2deg(zeta):.6g}°."
        )

    def _table(self) -> Table:
        axes = {
            "phi": Axis(self.phi.ravel(), "rad", "direction of the belt velocity"),
            "zeta": Axis(self.zeta.ravel(), "rad", "rotation of C"),
        }
        words = "largest real part of an eigenvalue"
        flat = self.growth.reshape(self.phi.size, self.zeta.size)
        return Table(axes, {"growth": Series(flat, ("phi", "zeta"), "1/s", words)}, {})


def growth_chart(
    system: MassOnBelt, *, phi: ArrayLike, zeta: ArrayLike = 0.0, progress: Progress = None
) -> GrowthChart:
    """Return growth rates of a mass on a belt over the belt's direction and the rotation of C.

    Args:
        system: mass on a planar belt, of which stiffness, law and speed of the belt are used.
        phi: directions φ of the belt velocity from e₁ in rad, shape ``(m,)``; the slip of the mass
            has the direction φ + π, which is what `critical_directions` returns.
        zeta: angles ζ in rad by which the reservoir C of the law is turned counter-clockwise, D
            stays; shape ``(k,)``.
        progress: ``True`` for a bar of tqdm, or a function of (done, all) parts of the chart.

    Returns:
        The chart, whose ``growth`` is the largest real part of an eigenvalue in 1/s, shape
        ``(m, k)``; 0 where `stability` finds it within errors, NaN where D is flat. The shape of a
        scalar argument is left out.

    Raises:
        DimensionError: if the law is not planar.
        ParameterError: if the belt rests.

    Reference: [WL19] (87), (88), (113).

    >>> import math
    >>> from asperity import Ellipse, FrictionLaw, MassOnBelt, growth_chart
    >>> law = FrictionLaw(Ellipse(3.0, 1.0), Ellipse(3.0, 1.0))
    >>> belt = MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0])
    >>> chart = growth_chart(belt, phi=math.radians(50.0), zeta=[0.0, math.radians(30.0)])
    >>> (chart.growth > 0.0).tolist()
    [False, True]
    """
    arrays.of_kind(system, "system", MassOnBelt, "a MassOnBelt")
    if system.dof != 2:
        raise DimensionError("system", f"must be planar, its law has dimension {system.dof}")
    speed = float(np.linalg.norm(system.belt_velocity))
    if speed == 0.0:
        raise ParameterError("system", "must have a moving belt, its belt_velocity vanishes")
    angle, turn = arrays.array(phi, "phi"), arrays.array(zeta, "zeta")
    lead = angle.shape + turn.shape
    slip = np.broadcast_to(
        -arrays.unit_vectors(angle).reshape(-1, 1, 2), (angle.size, turn.size, 2)
    ).reshape(-1, 2)
    rotation = np.broadcast_to(turn.reshape(1, -1), (angle.size, turn.size)).ravel()
    rates = np.empty(len(slip))
    parts = [slice(start, start + _PART) for start in range(0, len(slip), _PART)]
    with reporter(progress, "part") as report:
        for part in each(parts, report):
            damping, error = _damping(system, slip[part], rotation[part], speed)
            rates[part] = _growth(system.mass, damping, system.stiffness, error)
    return GrowthChart(angle, turn, rates.reshape(lead))


def _damping(system: MassOnBelt, slip: Array, rotation: Array, speed: float) -> tuple[Array, Array]:
    """Return −∂λ/∂γ for unit vectors γ and rotations of C, ``(n, 2, 2)``, and its error.

    What the derivative at constant speed is along γ, where it should vanish, tells the error.
    """
    law = system.law
    z, H = law.direction.support_point(slip), law.direction.support_hessian(slip)
    c, s = np.cos(rotation), np.sin(rotation)
    R = np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)
    # The gauge of the turned C at z is that of C at z turned back.
    back = np.einsum("nji,nj->ni", R, z)
    gauge = law.reservoir.gauge(back)[:, None]
    slope = np.einsum("nij,nj->ni", R, law.reservoir.gauge_gradient(back))
    force = z / gauge
    with np.errstate(invalid="ignore"):
        matrix = H - force[:, :, None] * np.einsum("ni,nij->nj", slope, H)[:, None, :]
    factor, drop = _rate(system, speed)
    matrix *= factor / (gauge[:, :, None] * speed)
    along = np.linalg.norm(np.einsum("nij,nj->ni", matrix, slip), axis=1)
    whole: Array = system.normal_force * (matrix + drop * force[:, :, None] * slip[:, None, :])
    return whole, system.normal_force * along


def _rate(system: MassOnBelt, speed: float) -> tuple[float, float]:
    """Return the rate factor and its derivative in s/m, as the law's Jacobian has it."""
    if system.law.rate is None:
        return 1.0, 0.0
    gamma = -system.belt_velocity
    dry = system.law.replace(rate=None).force(gamma)
    drop = system.law.jacobian(gamma) @ gamma @ dry / (speed * float(dry @ dry))
    return float(system.law.rate(speed)), float(drop)


def _growth(mass: float, damping: Array, stiffness: Array, error: Array) -> Array:
    """Return the largest certain real part of the eigenvalues of m q̈ + B q̇ + K q = 0."""
    finite = np.asarray(np.isfinite(damping).all(axis=(1, 2)))
    B, K = damping[finite], np.broadcast_to(stiffness, damping[finite].shape)
    A = np.zeros((len(B), 4, 4))
    rate = np.sqrt(np.linalg.norm(stiffness, 2) / mass) or 1.0
    A[:, :2, 2:] = np.eye(2)
    A[:, 2:, :2], A[:, 2:, 2:] = -K / (mass * rate**2), -B / (mass * rate)
    values = np.linalg.eigvals(A).astype(np.complex128)
    largest, size = values.real.max(axis=1), np.abs(A).max(axis=(1, 2))
    plain = (size < _EVEN) & (error[finite] <= ROUNDING * np.abs(B).max(axis=(1, 2)))
    zero, clear = np.abs(largest) <= _NOTHING * size, np.abs(largest) > _CLEAR * size
    found = np.where(zero, 0.0, rate * largest)
    open_ = ~(plain & (zero | clear))
    blur = np.maximum(2.0 * ROUNDING * np.abs(B).max(axis=(1, 2)), SAFETY * error[finite])[open_]
    found[open_] = _certain(
        Pencil(mass * np.eye(2), B[open_], K[open_]), rate * values[open_], blur
    )
    growth = np.full(len(damping), np.nan)
    growth[finite] = found
    return growth


def _certain(pencil: Pencil, values: Complex, blur: Array) -> Array:
    """Return the largest real part, 0 where the eigenvalue may be on the axis."""
    values = pencil.polished(values)
    errors = Pencil(*(2.0 * ROUNDING * np.abs(part) for part in pencil))
    on_axis = pencil.on_axis(errors._replace(damping=errors.damping + blur[:, None, None]), values)
    return np.where(on_axis, np.where(on_axis, 0.0, -np.inf), values.real).max(axis=1)
