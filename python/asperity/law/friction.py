"""The friction law and its constructors."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.drawing import svg
from asperity.errors import ParameterError
from asperity.law import engines, flow, samples
from asperity.law.engine_report import EngineReport
from asperity.law.questions import Questions
from asperity.law.rate import Stribeck
from asperity.sets import Ball, Disk, Ellipse, Interval, StarSet, WedgeAsperity
from asperity.sets.star import checked_set, same_dimension

if TYPE_CHECKING:
    from asperity.law.export import LawExport

# Tolerances of a flow rule's closure and convexity, and of the law that is made of it.
_EXACT, _RESOLVED = 1e-6, 1e-2
_DIRECTIONS = 1440
# In rad: directions nearer to each other than this count as one.
_BESIDE = 1e-5


class FrictionLaw(Questions):
    """The extended normal cone inclusion γ ∈ N_D(−αλ), α(x) = 1/(k_D(x) − k_C(x) + 1), x = −λ.

    The contact sticks where k_C(−λ) < 1 and slips where k_C(−λ) = 1, with γ normal to D at −αλ.
    Both sets hold −λ per unit normal force and are scaled by it; where a contact has the constant
    normal force 1, they may hold −λ in newtons instead. Only the shape of D matters: the attribute
    ``direction`` is D at the largest scale inside C, and laws are equal whose D differ in scale.
    `replace`, files and the law as text have D as it was given.

    Args:
        reservoir: force reservoir C, star-shaped.
        direction: direction set D, convex, of any scale.
        rate: factor of the force in slip that depends on the speed; none by default.
        report: how the sets were found, of laws from a flow rule or like another engine's.

    Raises:
        ParameterError: if D is not convex or C is degenerate.
        DimensionError: if the two sets differ in dimension.

    Reference: [WL19] Def. 16, (55)(56)(62).

    >>> from asperity import Ellipse, FrictionLaw
    >>> law = FrictionLaw(Ellipse(0.6, 0.2), Ellipse(3.0, 2.0))
    >>> law, round(law.direction.b, 9)
    (FrictionLaw(Ellipse(0.6, 0.2), Ellipse(3.0, 2.0)), 0.2)
    >>> law.force([4.0, 9.0], normal_force=10.0).round(3).tolist()
    [-1.897, -1.897]
    """

    report: flow.FlowReport | EngineReport | None

    _scaled = frozenset({"direction"})

    def __init__(
        self,
        reservoir: StarSet,
        direction: StarSet,
        *,
        rate: Stribeck | None = None,
        report: flow.FlowReport | EngineReport | None = None,
    ) -> None:
        checked_set(reservoir, "reservoir")
        same_dimension((direction,), "direction", reservoir.dimension)
        arrays.of_kind(rate, "rate", Stribeck | None, "a Stribeck factor or None")
        kinds = flow.FlowReport | EngineReport | None
        arrays.of_kind(report, "report", kinds, "a FlowReport, an EngineReport or None")
        factor = None if rate is None else rate._core
        core = _core.Law(reservoir._core, direction._convex("normality", "direction"), factor)
        self._set(reservoir=reservoir, direction=direction, rate=rate, report=report)
        if core.is_associated:
            direction = reservoir
        elif core.direction_scale != 1.0:
            direction = direction.scaled(core.direction_scale)
            core = core.with_direction(direction._core)
        self._keep(_core=core, direction=direction)

    def _repr_svg_(self) -> str | None:
        """Return the picture of a planar law for a notebook; None of others."""
        return svg("plot_law", self) if self.dimension == 2 else None

    @classmethod
    def isotropic(cls, mu: float, *, dimension: int = 2) -> FrictionLaw:
        """Make Coulomb's isotropic law: C = D = ball of radius μ.

        Args:
            mu: friction coefficient μ > 0.
            dimension: p = 1, 2 or 3.

        Reference: [WL19] Def. 14, (33).

        >>> from asperity import FrictionLaw
        >>> FrictionLaw.isotropic(0.3)
        FrictionLaw(Disk(0.3), Disk(0.3))
        """
        return cls.associated(_round(arrays.positive(mu, "mu"), dimension))

    @classmethod
    def associated(cls, reservoir: StarSet) -> FrictionLaw:
        """Make the associated law D = C, of maximal dissipation: γ ∈ N_C(−λ).

        Args:
            reservoir: convex C.

        Reference: [WL19] Def. 12.

        >>> from asperity import FrictionLaw, Rectangle
        >>> FrictionLaw.associated(Rectangle(0.4, 0.2)).force([1.0, -2.0]).tolist()
        [-0.4, 0.2]
        """
        return cls(reservoir, reservoir)

    @classmethod
    def collinear(cls, reservoir: StarSet) -> FrictionLaw:
        """Make the collinear law: D a disk, so that friction is opposite to sliding.

        Args:
            reservoir: any star-shaped C.

        Reference: [WL19] Def. 15, (38)–(44).

        >>> from asperity import FrictionLaw, Superellipse
        >>> law = FrictionLaw.collinear(Superellipse(0.4, 0.2, 0.5))
        >>> law.slip_direction(law.force([3.0, 4.0])).round(12).tolist()
        [0.6, 0.8]
        """
        checked_set(reservoir, "reservoir")
        return cls(reservoir, _round(1.0, reservoir.dimension))

    @classmethod
    def asperity(
        cls,
        mu: float,
        *,
        beta: float | Sequence[float],
        weights: ArrayLike | None = None,
    ) -> FrictionLaw:
        """Make the law of parallel wedges in contact with springs, e₁ across the wedges.

        Equal flanks give C = `WedgeAsperity`, D an ellipse with p₂/p₁ = cos β. Unequal ones give
        the mean of the flanks' forces.

        Args:
            mu: friction coefficient μ > 0 of a spring on a flank.
            beta: inclination β of both flanks in rad, or (β₁, β₂) of the flanks that rise and fall
                along e₁; μ tan β < 1.
            weights: shares of the normal force on the two flanks, by default proportional to
                cot βⱼ, their shares of the profile's length.

        Raises:
            ParameterError: where the springs lock, or the mean has no direction set.

        Reference: [WL19] §3.3, (45)–(52).

        >>> import math
        >>> from asperity import FrictionLaw
        >>> law = FrictionLaw.asperity(1.2, beta=math.radians(36.0))
        >>> law.force([[1.0, 0.0], [0.0, 1.0]]).round(6).tolist()
        [[-7.643276, -0.0], [-0.0, -1.483282]]
        """
        slopes = arrays.array(beta, "beta")
        if slopes.ndim == 0 and weights is None:
            reservoir = WedgeAsperity(mu, beta=float(slopes))
            return cls(reservoir, Ellipse(1.0, math.cos(reservoir.beta)))
        pair = np.full(2, slopes) if slopes.ndim == 0 else slopes
        rule = flow.wedges(arrays.positive(mu, "mu"), pair, weights)
        return cls._from_rule(rule, _DIRECTIONS, "weights" if weights is not None else "beta")

    @classmethod
    def tensor(
        cls, second_order: ArrayLike, *, fourth_order: ArrayLike | None = None
    ) -> FrictionLaw:
        """Make the law −λ/λ_N = F n + K[n, n, n], n = γ/‖γ‖, of constant friction tensors.

        A symmetric F without K has ellipses for C and D, with semi-axes μᵢ and √μᵢ.

        Args:
            second_order: F, shape ``(2, 2)``.
            fourth_order: K, shape ``(2, 2, 2, 2)``; K[n, n, n]ᵢ = Σ Kᵢⱼₖₗ nⱼ nₖ nₗ.

        Raises:
            ParameterError: if no convex D exists, with the closure number or the direction; if the
                law does not dissipate.

        Reference: [WL19] §3.4, Fig. 12.

        >>> from asperity import FrictionLaw
        >>> law = FrictionLaw.tensor([[0.3, 0.0], [0.0, 0.1]])
        >>> law.reservoir, round(law.direction.a / law.direction.b, 7)
        (Ellipse(0.3, 0.1), 1.7320508)
        """
        linear = arrays.array(second_order, "second_order", (2, 2))
        if fourth_order is None and linear[0, 1] == linear[1, 0]:
            return cls(*flow.ellipses(linear))
        cubic = None
        if fourth_order is not None:
            cubic = arrays.array(fourth_order, "fourth_order", (2, 2, 2, 2))
        argument = "second_order" if cubic is None else "fourth_order"
        return cls._from_rule(flow.tensor(linear, cubic), _DIRECTIONS, argument)

    @classmethod
    def tensor_function(
        cls, tensor: Callable[[Array], ArrayLike] | Sequence[tuple[ArrayLike, ArrayLike]]
    ) -> FrictionLaw:
        """Make the law −λ/λ_N = F(φ) n of a friction tensor that depends on the sliding direction.

        Args:
            tensor: function from angles φ in rad, shape ``(n,)``, to F, ``(n, 2, 2)``; or the pairs
                (A_k, B_k), k = 0, 1, …, of F(φ) = Σ A_k cos kφ + B_k sin kφ, shape
                ``(m, 2, 2, 2)``.

        Raises:
            ParameterError: as for `tensor`.

        Reference: [WL19] §3.4, Fig. 12.

        >>> import numpy as np
        >>> from asperity import FrictionLaw
        >>> one, none = np.eye(2), np.zeros((2, 2))
        >>> law = FrictionLaw.tensor_function([(0.2 * one, none), (none, none), (0.03 * one, none)])
        >>> bool(law.is_collinear)
        True
        """
        return cls._from_rule(flow.tensor_function(tensor), _DIRECTIONS, "tensor")

    @classmethod
    def from_flow_rule(cls, f: flow.FlowRule, *, n: int = _DIRECTIONS) -> FrictionLaw:
        """Make the law whose force −λ/λ_N = f(φ) is a function of the sliding direction.

        C is the curve f. D has the support function h_D(φ) = h_D(0) exp∫(l_p/l_t)dφ, with l_t and
        l_p the force against sliding and across it; it exists if the integral over a turn
        vanishes, and is convex if the force's angle θ never falls while φ grows. Where f jumps, D
        and C are straight; the place is found to 1e-6 rad.

        Args:
            f: function from angles φ in rad, shape ``(n,)``, to −λ/λ_N, shape ``(n, 2)``.
            n: number of equidistant directions.

        Raises:
            ParameterError: if no convex D exists, with the closure number r_D(2π)/r_D(0) or the
                direction; if the law does not dissipate or C is not star-shaped.

        Reference: [WL19] (71), (125).

        >>> import numpy as np
        >>> from asperity import FrictionLaw
        >>> rule = lambda phi: np.stack([0.3 * np.cos(phi), 0.1 * np.sin(phi)], axis=-1)
        >>> law = FrictionLaw.from_flow_rule(rule)
        >>> law.reservoir.radius([0.0, np.pi / 2]).round(6).tolist()
        [0.3, 0.1]
        """
        return cls._from_rule(f, arrays.count(n, "n", least=8), "f")

    @classmethod
    def _from_rule(cls, f: flow.FlowRule, n: int, argument: str) -> FrictionLaw:
        phi, force, least = flow.resolved(f, n, argument)
        *sets, numbers = flow.sets_of(phi, force, _EXACT, _EXACT, argument, least)
        misfit = float(cls(*sets)._misses(*flow.between(f, phi, argument)).max())
        if misfit > _RESOLVED:
            raise ParameterError(
                argument, f"must be resolved by {len(phi)} directions, the law is {misfit:.2g} off"
            )
        report = flow.FlowReport(*numbers, misfit=misfit, samples=len(phi))
        return cls(*sets, report=report)

    @classmethod
    def from_samples(
        cls,
        phi: ArrayLike,
        force: ArrayLike,
        *,
        smoothing: str | int | None = "auto",
        closure_tolerance: float = 0.2,
        convexity_tolerance: float = 0.2,
        misfit_tolerance: float = 0.2,
    ) -> FrictionLaw:
        """Make the law of forces measured over the sliding direction.

        Samples without noise are interpolated. Noisy ones are fitted by a trigonometric series,
        whose order has the least generalised cross-validation error. Small defects are repaired:
        those of closure spread over the turn, those of convexity levelled. ``law.report`` gives
        them in numbers.

        Where the force jumps from one sample to the next, D gets a straight side, whose normal
        lies between both where D closes. C is straight there: forces in between do not occur in
        sliding.

        Args:
            phi: angles φ of the sliding directions from e₁ in rad, in any order, also repeated;
                shape ``(n,)``.
            force: −λ/λ_N, shape ``(n, 2)``.
            smoothing: ``"auto"``, the order of the series, or None to interpolate.
            closure_tolerance: largest |ln r_D(2π)/r_D(0)| that is repaired.
            convexity_tolerance: largest decrease of the force's angle θ(φ) that is repaired, in
                rad.
            misfit_tolerance: largest distance of the law's force from a sample, or from the series
                that smooths them, relative to the largest force.

        Raises:
            ParameterError: if a defect is larger, with its number; if the law does not dissipate.

        Reference: [WL19] §5.2, (119)–(125).

        >>> import numpy as np
        >>> from asperity import Ellipse, FrictionLaw
        >>> phi = 2.0 * np.pi * np.arange(72) / 72
        >>> slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
        >>> original = FrictionLaw.collinear(Ellipse(0.5, 0.4))
        >>> law = FrictionLaw.from_samples(phi, -original.force(slip))
        >>> abs(law.report.closure - 1.0) < 1e-9, law.report.order
        (True, None)
        """
        angles = arrays.array(phi, "phi", (None,))
        forces = arrays.array(force, "force", (angles.size, 2))
        data = samples.prepared(angles, forces, smoothing)
        allowed = arrays.non_negative(misfit_tolerance, "misfit_tolerance")
        *sets, numbers = flow.sets_of(
            data.phi,
            data.force,
            arrays.non_negative(closure_tolerance, "closure_tolerance"),
            arrays.non_negative(convexity_tolerance, "convexity_tolerance"),
        )
        made = cls(*sets)
        misses = made._misses(data.phi, data.force)
        if misses.max() > allowed:
            raise ParameterError(
                "force",
                f"must be met by a law: the one found is off by {misses.max():.0%} of the largest "
                f"force in the direction {data.phi[misses.argmax()]:.4g} rad; give more samples "
                "near it, or allow it by misfit_tolerance",
            )
        report = flow.FlowReport(
            *numbers,
            misfit=float(made._misses(angles, forces).max()),
            samples=angles.size,
            order=data.order,
            noise=data.noise,
        )
        return cls(*sets, report=report)

    def export(self, to: str) -> LawExport:
        """Return the law in the words of another program, and what is lost on the way.

        The parameters are those whose law comes nearest in the forces over the direction of
        sliding, of all laws that the program was found to have, or that its manual states.

        Args:
            to: ``"abaqus"``, ``"ansys"``, ``"btrigidbody"``, ``"bullet"``, ``"cardillo"``,
                ``"dart"``, ``"drake"``, ``"exudyn"``, ``"lsdyna"``, ``"mujoco"``, ``"newton"``,
                ``"ode"``, ``"opensim"``, ``"physx"``, ``"pinocchio"``, ``"pyelastica"``,
                ``"rapier"``, ``"siconos"`` or ``"yade"``, or the name of its package, as `like`
                takes it.
                Abaqus, Ansys (Mechanical APDL, TB,FRIC) and LS-DYNA were not run: their laws are
                those of their manuals. Two coefficients of Ansys have no errors: what the force is
                between the axes, and where it points, was not found stated. LS-DYNA gets one.

        Raises:
            ParameterError: for a program that is not known.
            DimensionError: if the law is not planar.

        >>> from asperity import Ellipse, FrictionLaw
        >>> export = FrictionLaw.associated(Ellipse(0.5, 0.4)).export("mujoco")
        >>> export.parameters["cone"], round(export.force_error, 9)
        ('elliptic', 0.0)
        >>> '<option cone="elliptic"/>' in export.text
        True
        """
        from asperity.law.export import exported

        return exported(self, to)

    @classmethod
    def like(cls, engine: str, **parameters: Any) -> FrictionLaw:
        """Make the law that another engine means by its friction parameters.

        It is the law that the engine was found to compute, not the one that its words suggest.
        ``law.report``, an `EngineReport`, says what the engine does otherwise, with numbers, and
        where its first axis is. Coefficients of two bodies are combined before, as the engine
        does; docs/engines.md has its rules.

        ==============  ============================================================================
        engine          parameters, in its own words
        ==============  ============================================================================
        ``box2d``       friction
        ``btrigidbody`` friction, anisotropicFriction (three factors)
        ``bullet``      lateralFriction, anisotropicFriction (three factors), enableConeFriction of
                        its multibodies, which pybullet uses for every body
        ``cardillo``    mu, anisotropy (two factors), solver (``"Moreau"``, ``"BackwardEuler"``, …)
        ``chipmunk``    friction
        ``dart``        mu, solver (``"default"``, ``"NsgsFrictionSolver"``, …)
        ``drake``       dynamic_friction, static_friction, time_step, stiction_tolerance,
                        discrete_contact_approximation
        ``exudyn``      dryFriction (two), dryFrictionAngle, dryFrictionProportionalZone,
                        useLinearProportionalZone
        ``ipctk``       mu, mu_aniso (two factors of the slip)
        ``jaxsim``      mu, contact_model (``"SoftContacts"``)
        ``motrix``      friction
        ``mujoco``      friction (of a contact: five numbers or the first two) or geom_friction
                        (three, or of two geoms), condim, cone (``"pyramidal"`` or
                        ``"elliptic"``), impratio, frame (of mjContact: turns the law into the axes
                        of the world), patch_radius (only with condim=4, in m, the third slip is
                        the drilling times it)
        ``newton``      mu, solver (``"SolverXPBD"``, ``"SolverVBD"``, …)
        ``ode``         mu, mu2 of contacts with ContactApprox1
        ``omi``         dynamicFriction
        ``opensim``     dynamic_friction, force (``"HuntCrossleyForce"``, …)
        ``physx``       dynamic_friction, solver (``"TGS"``, ``"PGS"``)
        ``pinocchio``   mu, S (factor of the tangential rows, 2 × 2, if the user scales them)
        ``pyelastica``  kinetic_mu_array (forwards, backwards, sideways)
        ``rapier``      friction, friction_model
        ``siconos``     mu, size (2 or 3), H (factor of the tangential rows, 2 × 2)
        ``solve_nivp``  mu, or projection (the convex set that is projected onto)
        ``yade``        frictionAngle in rad
        ==============  ============================================================================

        Args:
            engine: its name.
            parameters: by name; what is left out has the engine's default.

        Raises:
            ParameterError: for an unknown engine or parameter; for parameters that mean nothing
                that is a law, such as rolling friction, or that belong elsewhere here, such as
                restitution, with the place.

        >>> from asperity import FrictionLaw
        >>> law = FrictionLaw.like("cardillo", mu=0.5, anisotropy=(1.2, 0.8), solver="Rattle")
        >>> bool(law.is_collinear), law.report.version
        (True, '1.0.0 (451d581)')
        >>> law = FrictionLaw.like("mujoco", friction=(0.5, 0.5))
        >>> law.reservoir.radius([0.0, 0.785398]).round(3).tolist()
        [0.5, 0.354]
        """
        found = engines.translated(engine, parameters)
        return cls(found.reservoir, found.direction, rate=found.rate, report=found.report)

    def save(self, path: str | os.PathLike[str], *, note: str = "") -> None:
        """Write the law to a readable TOML file, from which `load` makes it again to the bit.

        The file holds the sets with all their numbers, samples of curves included, the rate factor
        and the report, not how they were made: a function does not come back. `LawFile` keeps
        more of the provenance, and `identify.Fit.save_law` the parameters of a measured law with
        their covariance. The Rust crate reads the same files.

        Args:
            path: of the file; it is complete or not there.
            note: free text to keep with it.

        Raises:
            ParameterError: if the law, or a set in it, is of a class that is not asperity's.

        >>> import os, tempfile
        >>> from asperity import Ellipse, FrictionLaw
        >>> law = FrictionLaw(Ellipse(0.6, 0.2), Ellipse(3.0, 2.0))
        >>> path = os.path.join(tempfile.mkdtemp(), "pvc.toml")
        >>> law.save(path, note="PVC on PVC, dry")
        >>> FrictionLaw.load(path) == law
        True
        """
        from asperity._base.storage.provenance import Provenance
        from asperity.law.file import LawFile

        LawFile(self, provenance=Provenance(note=note)).save(path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> FrictionLaw:
        """Read the law in a TOML file that `save` has written, or anybody else.

        Nothing in the file is executed.

        .. code:: toml

            format = "asperity law"
            version = 1

            [law.reservoir]
            type = "Superellipse"
            a = 0.54
            b = 0.46
            exponent = 2.9

            [law.direction]
            type = "Ellipse"
            a = 1.84
            b = 1.19
            angle = 0.1

            [law.rate]
            speed = 0.05
            ratio = 0.8

        A set is a table with its ``type``, the name of its class, and the arguments of that; so are
        sets in sets. The rate factor may be left out.

        Args:
            path: of the file.

        Raises:
            ConfigurationError: with file, line and key of what is wrong.
        """
        from asperity.law.file import read

        with read(path) as (law, _, _):
            return law

    def _misses(self, phi: Array, force: Array) -> Array:
        """Return by how much of the largest force the law misses each of them."""
        # Where it jumps the force is any in between.
        before, at, after = (
            -self.force(arrays.unit_vectors(phi + off)) for off in (-_BESIDE, 0.0, _BESIDE)
        )
        off = np.minimum(_distance(force, before, at), _distance(force, at, after))
        found: Array = off / np.linalg.norm(force, axis=-1).max()
        return found

    def replace(self, **changes: Any) -> FrictionLaw:
        """Return a copy with some parameters changed; other sets come without the report."""
        if {"reservoir", "direction"} & set(changes):
            changes = {"report": None, **changes}
        return super().replace(**changes)

    def rotated(self, angle: float) -> FrictionLaw:
        """Return the law of the surface turned counter-clockwise by `angle` in rad (p = 2).

        >>> from asperity import Ellipse, FrictionLaw
        >>> FrictionLaw.associated(Ellipse(0.6, 0.2)).rotated(0.5).reservoir
        Ellipse(0.6, 0.2, angle=0.5)
        """
        sets = (self.reservoir.rotated(angle), self._parameters["direction"].rotated(angle))
        report = self.report
        if isinstance(report, EngineReport):
            report = report.rotated(angle)
        return FrictionLaw(*sets, rate=self.rate, report=report)


def _distance(points: Array, first: Array, last: Array) -> Array:
    """Return distances of points from segments."""
    along, to = last - first, points - first
    length = np.maximum((along**2).sum(axis=-1), np.finfo(float).tiny)
    share = np.clip((to * along).sum(axis=-1) / length, 0.0, 1.0)
    distances: Array = np.linalg.norm(to - share[:, None] * along, axis=-1)
    return distances


def _round(radius: float, dimension: int) -> StarSet:
    match dimension:
        case 1:
            return Interval(-radius, radius)
        case 2:
            return Disk(radius)
        case _:
            return Ball(radius, dimension=dimension)
