"""Stability of steady sliding by linearisation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, overload

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table
from asperity._base.storage.data import Kinds
from asperity._base.storage.result_file import SavedResult
from asperity._base.value import View
from asperity.errors import ParameterError
from asperity.runs import origin
from asperity.runs.model import Model
from asperity.steady_sliding.linearised import reasons
from asperity.steady_sliding.linearised.field import STEP, ContactState, Field, start
from asperity.steady_sliding.linearised.linearisation import Linearisation, linearisation, total
from asperity.steady_sliding.linearised.pencil import Complex, Pencil
from asperity.steady_sliding.linearised.sliding import Sliding
from asperity.steady_sliding.linearised.spectrum import Spectrum
from asperity.steady_sliding.steady_state import Equilibrium, closed_contacts
from asperity.steady_sliding.steady_state import equilibrium as find
from asperity.system import SparseLinearSystem

if TYPE_CHECKING:
    from asperity.steady_sliding.sparse.modes import ComplexModes

Kind = Literal["unstable", "neutral", "asymptotically stable"]

# Number of eigenvalues per shift.
_COUNT = 20
# Residual above which a state that is handed over is none of steady sliding.
_BALANCE = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Stability(SavedResult):
    """What small motions about steady sliding do: M δq̈ + B δq̇ + K δq = 0.

    Closed unilateral contacts are held closed; δq moves within them, and M, B, K of
    `first_order_matrix`, `eigenvalues` and `trace` are those of this motion, with the friction of
    the varying normal forces in B and K.

    Attributes:
        equilibrium: steady sliding.
        linearisation: M and all contributions to B and K.
        spectrum: eigenvalues, modes, and which of them errors leave open.

    Reference: [WL19] (85)–(88), (111)–(114), Prop. 7–11, Thm. 2.
    """

    equilibrium: Equilibrium
    linearisation: Linearisation
    spectrum: Spectrum

    @property
    def contacts(self) -> Mapping[int, Sliding]:
        """The contacts that touch, by number, with `projector` L, `hessian` H and `margin`."""
        return self.linearisation.contacts

    @cached_property
    def matrix(self) -> Array:
        """B = −W ∂λ/∂γ Wᵀ of all contacts in N s/m, shape ``(n, n)``; [WL19] (86)."""
        parts = [c.state.W @ c.jacobian @ c.state.W.T for c in self.contacts.values()]
        return -np.sum([np.zeros_like(self.linearisation.mass), *parts], axis=0) + 0.0

    @property
    def symmetric(self) -> Array:
        """D, the symmetric part of `matrix`; [WL19] (111)."""
        return 0.5 * (self.matrix + self.matrix.T)

    @property
    def skew(self) -> Array:
        """G, the skew part of `matrix`; [WL19] (111)."""
        return 0.5 * (self.matrix - self.matrix.T)

    @property
    def mass(self) -> Array:
        """M of the motion within the closed contacts."""
        return self.linearisation.reduced.mass

    @property
    def damping(self) -> Array:
        """B of the motion within the closed contacts, with all that depends on velocities."""
        return total(self.linearisation.reduced.damping)

    @property
    def stiffness(self) -> Array:
        """K of the motion within the closed contacts, with all that depends on displacements."""
        return total(self.linearisation.reduced.stiffness)

    @property
    def first_order_matrix(self) -> Array:
        """[[0, I], [−M⁻¹K, −M⁻¹B]], shape ``(2n, 2n)``; [WL19] (113)."""
        M, n = self.mass, len(self.mass)
        lower = [-np.linalg.solve(M, self.stiffness), -np.linalg.solve(M, self.damping)]
        return np.block([[np.zeros((n, n)), np.eye(n)], lower])

    @property
    def eigenvalues(self) -> Complex:
        """Eigenvalues in 1/s by falling real part, shape ``(2n,)``."""
        return self.spectrum.values

    @property
    def modes(self) -> Complex:
        """Their displacements as velocities times 1 s, one column each, of length 1."""
        return self.linearisation.reduced.Z @ self.spectrum.modes

    @property
    def growth_rate(self) -> float:
        """Largest real part of an eigenvalue in 1/s; 0 where rounding leaves it open."""
        return self.spectrum.growth_rate

    @property
    def trace(self) -> float:
        """tr(M⁻¹B) in 1/s; steady sliding is unstable if it is negative ([WL19] Prop. 10)."""
        return float(np.trace(np.linalg.solve(self.mass, self.damping)))

    @property
    def margins(self) -> Array:
        """Angle of each contact in rad by which γ is outside T_C(−λ), negative inside."""
        return np.array([contact.margin for contact in self.contacts.values()])

    @property
    def kind(self) -> Kind:
        """Whether small motions grow, persist or decay.

        Neutral: no eigenvalue is certain to be right of the imaginary axis, some are on it, or so
        near that errors leave their side open; `reason` says so where that matters. A
        point with M, K ∝ I has such a pair always, as Bγ = 0. Where an eigenvalue on the axis lacks
        a mode (`is_defective`), the linear motion grows like t: stability is then decided by what
        linearisation leaves out.
        """
        if self.growth_rate > 0.0:
            return "unstable"
        return "asymptotically stable" if self.growth_rate < 0.0 else "neutral"

    @property
    def is_defective(self) -> bool:
        """Whether an eigenvalue on the imaginary axis has fewer modes than its multiplicity."""
        return self.spectrum.defective

    @cached_property
    def mechanisms(self) -> Mapping[str, float]:
        """The growth rate in 1/s that is left without each mechanism that acts.

        Keys are "tangent cone", "direction of friction", "Stribeck slope", "follower force",
        "mode coupling", "velocity feedback of the normal force", "negative damping" and
        "negative stiffness"; the second is the turning friction force of contacts outside the
        tangent cone. Mode coupling is the dependence of the normal force on displacements, and a
        nonsymmetric stiffness.
        """
        return View(reasons.growth_rates(self.linearisation))

    @cached_property
    def reason(self) -> str:
        """One sentence that says what small motions do, and why."""
        if self.kind == "unstable":
            at = abs(self.eigenvalues[int(self.eigenvalues.real.argmax())].imag)
            what = f"Small motions grow like exp({self.growth_rate:.6g} t)"
            if at > 1e-9 * np.abs(self.eigenvalues).max():
                what += f" at {at:.6g} rad/s"
            why = reasons.sentence(self.linearisation, self.mechanisms, self.growth_rate)
            return f"{what}: {why}."
        if self.kind == "asymptotically stable":
            return f"Small motions decay at least like exp({self.growth_rate:.6g} t)."
        if self.is_defective:
            why = "an eigenvalue on the imaginary axis lacks a mode"
            return f"Small motions grow like t or a higher power of it: {why}."
        hidden = self.spectrum.hidden
        if hidden > 0.0:
            return (
                f"Undecided: errors of the largest forces hide growth rates up to {hidden:.1g} 1/s."
            )
        return "Small motions neither grow nor all decay: eigenvalues lie on the imaginary axis."

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Stability):
            return NotImplemented
        same = np.array_equal(self.first_order_matrix, other.first_order_matrix)
        return same and self.equilibrium == other.equilibrium

    def __hash__(self) -> int:
        return hash(self.equilibrium)

    def __repr__(self) -> str:
        return f"<Stability: {self.kind}. {self.reason}>"

    def summary(self) -> str:
        """Return what small motions do and why, and how the contacts slide."""
        lines = [f"Steady sliding is {self.kind}. {self.reason}"]
        for number, contact in self.contacts.items():
            inside = "inside" if contact.margin < 0.0 else "outside"
            lines.append(
                f"Contact {number} slips with {np.linalg.norm(contact.slip):.6g} m/s under a "
                f"normal force of {contact.normal_force:.6g} N; the slip velocity lies "
                f"{abs(np.rad2deg(contact.margin)):.4g}° {inside} the tangent cone of C."
            )
        return "\n".join(lines)

    def _table(self) -> Table:
        axis = {"eigenvalue": Axis(np.arange(len(self.eigenvalues)), "", "by falling real part")}
        parts = {
            "real": (self.eigenvalues.real, "1/s", "growth rate"),
            "imaginary": (self.eigenvalues.imag, "rad/s", "angular frequency"),
        }
        series = {
            name: Series(values, ("eigenvalue",), unit, words)
            for name, (values, unit, words) in parts.items()
        }
        return Table(axis, series, {"kind": self.kind, "growth_rate": self.growth_rate})

    @classmethod
    def _known(cls) -> Kinds:
        return KNOWN


KNOWN: Kinds = {
    **origin.KNOWN,
    **{
        one.__name__: one
        for one in (
            Stability,
            Equilibrium,
            Linearisation,
            Sliding,
            ContactState,
            Spectrum,
            Pencil,
            dict,
        )
    },
}
"""Classes that a stability is made of."""


@overload
def stability(
    system: Model, *, equilibrium: Equilibrium | None = None, step: float = STEP
) -> Stability: ...
@overload
def stability(
    system: Model,
    *,
    equilibrium: Equilibrium | None = None,
    near: complex,
    count: int = _COUNT,
    certify: bool = False,
) -> ComplexModes: ...
@overload
def stability(
    system: Model,
    *,
    equilibrium: Equilibrium | None = None,
    band: tuple[float, float],
    growth: float | None = None,
    count: int = _COUNT,
    certify: bool = False,
) -> ComplexModes: ...
def stability(
    system: Model,
    *,
    equilibrium: Equilibrium | None = None,
    step: float = STEP,
    near: complex | None = None,
    band: tuple[float, float] | None = None,
    growth: float | None = None,
    count: int = _COUNT,
    certify: bool = False,
) -> Stability | ComplexModes:
    """Linearise a system about steady sliding and judge by the eigenvalues.

    An eigenvalue counts as being on the imaginary axis unless it is certain that it is not: that no
    matrices within the errors of the entries of M, B and K, of rounding and of differences, have
    an eigenvalue half-way between it and the axis. `growth_chart` follows the same rule.

    Args:
        system: `LinearSystem`, `MassOnBelt`, `RigidBodies` or a `System`, at time 0.
        equilibrium: steady sliding. Default: what `equilibrium` finds.
        step: largest displacement for difference quotients in m or rad; linear systems need none.
        near: angular frequency in rad/s, or a point in 1/s: of a `LinearSystem`, dense or sparse,
            only the `count` eigenvalues nearest to it.
        band: lowest and highest angular frequency in rad/s, instead of `near`: all eigenvalues
            between them.
        growth: largest |Re s| in 1/s of eigenvalues within `band`; default 5 % of its upper end.
        count: number of eigenvalues per shift.
        certify: whether to count by the argument principle what `near` or `band` may have missed.

    Returns:
        Matrices, eigenvalues, the tangent-cone test, the verdict and its reason; with `near` or
        `band`, `asperity.steady_sliding.ComplexModes`.

    Raises:
        ParameterError: as `equilibrium`; if a contact is in the Painlevé zone.
        ConvergenceError: as `equilibrium`; with `near` or `band` also if eigenvalues do not reach
            a backward error of 1e-12.

    Reference: [WL19] §4, (85)–(88), (111)–(114).

    >>> import math
    >>> from asperity import Ellipse, FrictionLaw, MassOnBelt, stability
    >>> law = FrictionLaw(Ellipse(30.0, 10.0, angle=math.pi / 6), Ellipse(3.0, 1.0))
    >>> belt = MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0])
    >>> stability(belt).kind
    'neutral'
    >>> found = stability(belt.replace(belt_velocity=[math.cos(0.9), math.sin(0.9)]))
    >>> found.kind, round(found.growth_rate, 6), sorted(found.mechanisms)
    ('unstable', 0.517057, ['tangent cone'])
    """
    if near is not None or band is not None:
        # SciPy's sparse matrices are imported by the first use of them.
        from asperity.steady_sliding.sparse.modes import complex_modes

        if step != STEP:
            raise ParameterError("step", "has no effect with near or band")
        return complex_modes(
            system, equilibrium, near=near, band=band, growth=growth, count=count, certify=certify
        )
    given = {"growth": growth is not None, "count": count is not _COUNT, "certify": certify}
    for argument in (name for name, is_given in given.items() if is_given):
        raise ParameterError(argument, "has no effect without near or band")
    if isinstance(system, SparseLinearSystem):
        system = system.dense()
    step = arrays.positive(step, "step")
    steady = find(system, step=step) if equilibrium is None else equilibrium
    if not isinstance(steady, Equilibrium):
        raise ParameterError("equilibrium", f"must be an Equilibrium, got {equilibrium!r}")
    of = Field(system, start(system, steady.q))
    load = arrays.array(steady.normal_force, "equilibrium", (len(of.laws),))
    whole = linearisation(of, load, closed_contacts(of, steady.closed), step=step)
    if np.linalg.norm(whole.imbalance) > _BALANCE * whole.size:
        raise ParameterError("equilibrium", "must be one of this system: its forces do not balance")
    found = reasons.reduced_spectrum(whole)
    return Stability(steady, whole, found)
