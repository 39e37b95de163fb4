"""Complex modes of steady sliding near a frequency or within a band."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.value import View
from asperity.errors import ParameterError
from asperity.steady_sliding.linearised.field import constant
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse.certificate import Certificate, Circle, certified
from asperity.steady_sliding.sparse.nearest import (
    Pairs,
    are_new,
    crowded,
    divergence,
    nearest,
    within,
)
from asperity.steady_sliding.sparse.pencil import SmallMotions, SparsePencil
from asperity.steady_sliding.sparse.shape_files import write_vtk
from asperity.steady_sliding.sparse.steady_state import residual_of, sparse_equilibrium
from asperity.steady_sliding.steady_state import Equilibrium
from asperity.system import LinearSystem, SparseLinearSystem

Engine: TypeAlias = Callable[[SparsePencil, complex, int], tuple[Pairs, float]]
_SENTENCES = {
    "direction of friction": "the friction force turns with the sliding direction",
    "Stribeck slope": "the friction force falls with the sliding speed",
    "mode coupling": "the normal forces, and friction with them, depend on the motion",
}
# Share of the growth rate that a cause accounts for, or leaves, as of dense systems.
_NOTABLE = 1e-3
# Residual above which a state that is handed over is none of steady sliding.
_BALANCE = 1e-6
# Most shifts by which a band is covered.
_SHIFTS = 200
# Share of the radius within which eigenvalues are found that is certified, at most: those outside
# must be far enough for the phase on the circle to be smooth.
_CERTIFIED = 0.65


@dataclass(frozen=True, eq=False, repr=False)
class ComplexModes(TableResult):
    """Eigenvalues s and modes of M δq̈ + C δq̇ + K δq = E δλ_N, W_Nᵀδq = 0, by falling growth.

    Attributes:
        equilibrium: steady sliding.
        eigenvalues: s in 1/s, shape ``(k,)``.
        modes: displacements δq of length 1, one column each, shape ``(n, k)``.
        backward_errors: ‖P(s)x‖₂/((|s|²‖M‖₁ + |s|‖C‖₁ + ‖K‖₁)‖x‖₂), shape ``(k,)``; P, x are
            those of the motion within the closed contacts.
        sign_is_certain: whether no error of rounding changes the sign of the growth rate.
        circles: where all eigenvalues are searched; ``certificate`` says whether they are found.
        certificate: the count by the argument principle, if it was asked for.
        beyond: eigenvalues found that grow faster than ``growth`` within the band or, as Im s = 0
            is divergence whatever the frequency, beside it, in 1/s.

    Reference: [WL19] (85)–(88).
    """

    equilibrium: Equilibrium
    eigenvalues: Complex
    modes: Complex
    backward_errors: Array
    sign_is_certain: NDArray[np.bool_]
    circles: tuple[Circle, ...]
    certificate: Certificate | None
    beyond: Complex
    small_motions: SmallMotions = field(repr=False)
    engine: Engine = field(repr=False)

    @property
    def frequencies(self) -> Array:
        """Im s/2π in Hz."""
        return self.eigenvalues.imag / (2.0 * np.pi)

    @property
    def damping_ratios(self) -> Array:
        """−Re s/|s|, negative where the mode grows."""
        size = np.abs(self.eigenvalues)
        return -self.eigenvalues.real / np.where(size > 0.0, size, 1.0)

    @property
    def growth_rates(self) -> Array:
        """Re s in 1/s."""
        return self.eigenvalues.real

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Which modes are certain to grow."""
        return (self.eigenvalues.real > 0.0) & self.sign_is_certain

    @property
    def growth_rate(self) -> float:
        """Largest growth rate in 1/s of these modes."""
        return float(self.eigenvalues.real.max(initial=-np.inf))

    @cached_property
    def mechanisms(self) -> Mapping[str, float]:
        """The growth rate in 1/s left near the fastest growing mode without each cause.

        Keys are "direction of friction", "Stribeck slope" and "mode coupling", the forces of
        friction by which varying normal forces act; each costs a factorisation.
        """
        if not len(self.eigenvalues):
            return View({})
        fastest = complex(self.eigenvalues[int(self.eigenvalues.real.argmax())])
        count = len(self.eigenvalues)
        left = {
            name: float(
                self.engine(pencil, 1j * fastest.imag, count)[0].values.real.max(initial=-np.inf)
            )
            for name, pencil in self.small_motions.without()
        }
        return View(left)

    @cached_property
    def reason(self) -> str:
        """One sentence that says what the modes do, and why."""
        if not self.unstable.any():
            return "None of these modes is certain to grow."
        rate = self.growth_rate
        at = self.frequencies[int(self.eigenvalues.real.argmax())]
        alone = [name for name, left in self.mechanisms.items() if left <= _NOTABLE * rate]
        helping = [name for name, left in self.mechanisms.items() if left < (1 - _NOTABLE) * rate]
        named = "; ".join(_SENTENCES[name] for name in alone or helping)
        why = named or "no single force of friction accounts for it"
        return f"Small motions grow like exp({rate:.6g} t) at {at:.6g} Hz: {why}."

    def save_vtk(
        self,
        path: str | os.PathLike[str],
        *,
        coordinates: ArrayLike,
        positions: ArrayLike,
        cells: ArrayLike | Sequence[ArrayLike] | None = None,
    ) -> None:
        """Write the shapes for ParaView and meshio, real and imaginary part as two vectors each.

        Args:
            path: of the file, ``.vtk``, which is complete or not there.
            coordinates: numbers of the displacements x, y, z of each node, shape ``(m, 3)``; −1
                where it is held.
            positions: of the nodes in m, shape ``(m, 3)``.
            cells: nodes of each tetrahedron, pyramid, wedge or hexahedron in the order of VTK,
                counted from 0, shape ``(cells, nodes)``; a list of such arrays where there are
                several kinds. Default: points alone.

        Raises:
            DimensionError, ParameterError: naming the argument.
        """
        numbered = enumerate(zip(self.frequencies, self.growth_rates, strict=True))
        names = [f"mode_{k}_{hertz:.0f}_Hz_growth_{rate:.4g}" for k, (hertz, rate) in numbered]
        write_vtk(path, self.modes, names, coordinates, positions, cells)

    def __repr__(self) -> str:
        return f"<ComplexModes: {counted(len(self.eigenvalues), 'mode')}, {self._verdict()}>"

    def summary(self) -> str:
        """Return which modes grow, how exact they are, and whether any is missing."""
        if not self.circles:
            return "Nothing can move: there are no modes."
        lines = ["No mode is within the band."]
        if len(self.eigenvalues):
            lines = [
                f"{counted(len(self.eigenvalues), 'mode')} from {self.frequencies.min():.6g} to "
                f"{self.frequencies.max():.6g} Hz, {self._verdict()}; their backward errors are at "
                f"most {self.backward_errors.max():.1g}."
            ]
        for i in np.flatnonzero(self.unstable):
            lines.append(
                f"{self.frequencies[i]:.6g} Hz grows with {self.growth_rates[i]:.6g} 1/s, a "
                f"damping ratio of {self.damping_ratios[i]:.4g}."
            )
        if len(self.beyond):
            s = self.beyond[int(self.beyond.real.argmax())]
            what = f"{s.imag / (2.0 * np.pi):.6g} Hz" if s.imag else "A motion without oscillation"
            lines.append(
                f"{what} grows with {s.real:.6g} 1/s, beyond the growth or the band asked for."
            )
        if not self.sign_is_certain.all():
            number = int((~self.sign_is_certain).sum())
            lines.append(f"Of {number} the sign of the growth rate is not certain.")
        lines.append("" if self.certificate is None else self.certificate.summary())
        return "\n".join(filter(None, lines))

    def _verdict(self) -> str:
        number = int(self.unstable.sum())
        return f"{number} of them unstable" if number else "none of them unstable"

    def _table(self) -> Table:
        count = np.arange(len(self.eigenvalues))
        axis = {"mode": Axis(count, "", "by falling growth rate")}
        parts = {
            "frequency": (self.frequencies, "Hz", "imaginary part over 2π"),
            "growth rate": (self.growth_rates, "1/s", "real part"),
            "damping ratio": (self.damping_ratios, "-", "of critical damping"),
            "backward error": (self.backward_errors, "-", "relative residual"),
            "sign is certain": (self.sign_is_certain, "", "of the growth rate"),
        }
        series = {
            name: Series(values, ("mode",), unit, words)
            for name, (values, unit, words) in parts.items()
        }
        return Table(axis, series, {"growth_rate": self.growth_rate})


def complex_modes(
    system: object,
    steady: Equilibrium | None,
    *,
    near: complex | None = None,
    band: tuple[float, float] | None,
    growth: float | None,
    count: int = 20,
    certify: bool = False,
    engine: Engine = nearest,
) -> ComplexModes:
    """Return the modes that `stability` asks for near a point or within a band, by an engine."""
    whole = _sparse(system)
    if (near is None) == (band is None):
        raise ParameterError("near", "give either near or band")
    if growth is not None and band is None:
        raise ParameterError("growth", "bounds the eigenvalues within a band: give band")
    count = arrays.count(count, "count")
    if steady is None:
        steady = sparse_equilibrium(whole, None, 1e-10)
    elif not isinstance(steady, Equilibrium):
        raise ParameterError("equilibrium", f"must be an Equilibrium, got {steady!r}")
    elif not residual_of(whole, steady) <= _BALANCE:
        raise ParameterError("equilibrium", "must be one of this system: its forces do not balance")
    if band is not None:
        return modes_within(whole, steady, band, growth, count, certify=certify, engine=engine)
    shift = complex(near) if isinstance(near, complex) else 1j * arrays.number(near, "near")
    if not np.isfinite(shift):
        raise ParameterError("near", "must be finite")
    return modes_near(whole, steady, shift, count, certify=certify)


def _sparse(system: object) -> SparseLinearSystem:
    """Return a linear system with sparse matrices."""
    from scipy.sparse import csc_array

    if isinstance(system, SparseLinearSystem):
        return system
    linear = constant(system)
    if linear is None:
        raise ParameterError(
            "system", f"must be a LinearSystem for near or band, got {type(system).__name__}"
        )
    if linear.constraints:
        raise ParameterError("system", "must have no constraints, which only simulate holds")
    # Of a reduced system without its basis; it has no constraints.
    names = inspect.signature(LinearSystem).parameters
    given: dict[str, Any] = {name: linear._parameters.get(name) for name in names}
    made = LinearSystem(**{**given, "mass": csc_array(linear.mass)})
    assert isinstance(made, SparseLinearSystem)
    return made


def modes_near(
    system: SparseLinearSystem, steady: Equilibrium, shift: complex, count: int, *, certify: bool
) -> ComplexModes:
    """Return the modes whose eigenvalues are nearest to a point."""
    small = _small_motions(system, steady)
    found, radius = nearest(small.pencil, shift, 2 * count + 10 if certify else count)
    if len(found.values) < min(count, small.pencil.most):
        raise crowded(small.pencil, shift, len(found.values), radius)
    distance = np.abs(found.values - shift)
    order = np.argsort(distance)
    if certify and len(order) > count:
        between = 0.5 * (distance[order[count - 1]] + distance[order[count]])
        radius = min(float(between), _CERTIFIED * radius)
    circles = (Circle(shift, radius),) if len(order) else ()
    beyond = found.values[:0]
    chosen = found.taken(order[:count])
    return _modes(small, steady, chosen, found, circles, beyond, certify=certify)


def modes_within(
    system: SparseLinearSystem,
    steady: Equilibrium,
    band: tuple[float, float],
    growth: float | None,
    count: int,
    *,
    certify: bool,
    engine: Engine = nearest,
) -> ComplexModes:
    """Return the modes with lo ≤ Im s ≤ hi and |Re s| ≤ growth, from as many shifts as it takes."""
    low, high = (arrays.number(end, "band") for end in arrays.pair(band, "band"))
    if not 0.0 <= low < high:
        raise ParameterError("band", f"must be 0 ≤ lo < hi in rad/s, got {(low, high)}")
    half = 0.05 * high if growth is None else arrays.positive(growth, "growth")
    small = _small_motions(system, steady)
    share = _CERTIFIED if certify else 0.999
    found, circles = _walked(small, low, high, half, count, share, engine)
    # Of systems for another engine the factors may be too large here.
    if circles and engine is nearest:
        found = found.joined(divergence(small.pencil, found.values))
    s, sure = found.values, found.sign_is_certain
    wanted = within(s, low, high, half)
    real = within(s, 0.0, 0.0, np.inf)
    grows = (s.real > 0.0) & sure & ~wanted & (real | within(s, low, high, np.inf))
    beyond = np.where(real, s.real, s)[grows]
    chosen = found.taken(wanted)
    return _modes(small, steady, chosen, found, circles, beyond, certify=certify, engine=engine)


def _walked(
    small: SmallMotions,
    low: float,
    high: float,
    half: float,
    count: int,
    share: float,
    engine: Engine,
) -> tuple[Pairs, tuple[Circle, ...]]:
    """Cover |Re s| ≤ half, low ≤ Im s ≤ high by circles about points of the imaginary axis."""
    if not small.pencil.most:
        return engine(small.pencil, 0j, count)[0], ()
    found: Pairs | None = None
    circles: list[Circle] = []
    covered, step = low, max(2.0 * half, 0.1 * (high - low))
    for _ in range(_SHIFTS):
        shift = min(covered + 0.5 * step, high)
        pairs, radius = engine(small.pencil, 1j * shift, count)
        if len(pairs.values) < min(count, small.pencil.most) and radius <= half:
            raise crowded(small.pencil, 1j * shift, len(pairs.values), radius)
        radius *= share
        if count >= small.pencil.most:
            # These are all there are.
            radius = abs(complex(half, high))
        if found is not None:
            new = are_new(small.pencil, pairs.values, found.values)
            pairs = found.joined(pairs.taken(new))
        found = pairs
        reach = np.sqrt(max(radius**2 - half**2, 0.0))
        if shift - reach > covered:
            # The circle does not reach back: the next one is nearer, or holds more.
            step, count = 0.5 * step, count if reach else 2 * count
            continue
        circles.append(Circle(1j * shift, radius))
        covered, step = shift + reach, 2.0 * reach
        if covered >= high:
            return found, tuple(circles)
    raise ParameterError(
        "band", f"is not covered by {_SHIFTS} shifts: they reach {covered:.6g} rad/s"
    )


def _small_motions(system: SparseLinearSystem, steady: Equilibrium) -> SmallMotions:
    return SmallMotions.of(system, steady.normal_force, np.array(steady.closed, dtype=np.intp))


def _modes(
    small: SmallMotions,
    steady: Equilibrium,
    pairs: Pairs,
    known: Pairs,
    circles: tuple[Circle, ...],
    beyond: Complex,
    *,
    certify: bool,
    engine: Engine = nearest,
) -> ComplexModes:
    # Where nothing can move no eigenvalue is missing.
    nothing = Certificate((), pairs.values[:0], True, 0)
    certificate = nothing if certify and not circles else None
    for circle in circles if certify else ():
        one = certified(small.pencil, known.values, circle)
        certificate = one if certificate is None else certificate.joined(one, small.pencil)
    pairs = pairs.taken(np.lexsort((pairs.values.imag, -pairs.values.real)))
    shapes = np.asarray(small.constraint.Z @ pairs.modes)
    return ComplexModes(
        steady,
        pairs.values,
        shapes / np.linalg.norm(shapes, axis=0),
        pairs.backward_errors,
        pairs.sign_is_certain,
        circles,
        certificate,
        beyond,
        small,
        engine,
    )
