"""Other engines: which pair (C, D) their friction parameters mean, and what they do otherwise.

Every function is an engine and takes its parameters in the engine's own words. What is said here
of an engine was found by running it; the numbers are those of docs/engines.md.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.toml import advice_on
from asperity.errors import DimensionError, ParameterError
from asperity.law import flow
from asperity.law.engine_report import EngineReport
from asperity.law.rate import Stribeck
from asperity.sets import (
    Disk,
    Ellipse,
    Ellipsoid,
    Interval,
    Polygon,
    Rectangle,
    StarSet,
    Superellipsoid,
)
from asperity.sets.star import checked_set

CardilloSolver = Literal["Moreau", "BackwardEuler", "DualStormerVerlet", "Rattle"]
DrakeApproximation = Literal["lagged", "similar", "tamsi", "sap"]

# Semi-implicit Euler moves a sliding body too little by v₀Δt/2, whatever its friction law.
_EULER = 7.7e-5
_HALF, _GRAVITY = 0.5, 9.81


class Translation(NamedTuple):
    """What an engine's parameters mean."""

    reservoir: StarSet
    direction: StarSet
    report: EngineReport
    rate: Stribeck | None = None


def translated(engine: str, parameters: Mapping[str, Any]) -> Translation:
    """Return the sets of an engine's law and what is known of it.

    Raises:
        ParameterError: for an engine that is not known; for parameters that it does not have, that
            are missing, or that no law expresses, in the engine's words.
    """
    if not isinstance(engine, str) or engine not in ENGINES:
        advice = advice_on(str(engine), sorted(ENGINES))
        raise ParameterError("engine", f"{engine!r} is not known{advice}")
    function = ENGINES[engine]
    known = inspect.signature(function).parameters
    for name in parameters:
        if name not in known:
            raise ParameterError(name, f"is no parameter of {engine}{advice_on(name, known)}")
    for name, one in known.items():
        if one.default is one.empty and name not in parameters:
            raise ParameterError(name, f"is missing: {engine} has {', '.join(known)}")
    return function(**parameters)


def _bullet(
    *,
    lateralFriction: float = 0.5,
    anisotropicFriction: ArrayLike = (1.0, 1.0, 1.0),
    enableConeFriction: bool = False,
    spinningFriction: float = 0.0,
    rollingFriction: float = 0.0,
) -> Translation:
    mu = arrays.positive(lateralFriction, "lateralFriction")
    scale = arrays.array(anisotropicFriction, "anisotropicFriction", (3,))
    if scale[:2].min() <= 0.0:
        raise ParameterError("anisotropicFriction", f"must be positive, got {scale.tolist()}")
    if arrays.non_negative(spinningFriction, "spinningFriction") > 0.0:
        raise ParameterError(
            "spinningFriction", "is not translated: what it does was not found by experiment"
        )
    if arrays.non_negative(rollingFriction, "rollingFriction") > 0.0:
        raise ParameterError(
            "rollingFriction",
            "is not translated: a law has up to three directions, slip and drilling",
        )
    a, b = float(mu * scale[0]), float(mu * scale[1])
    if _flag(enableConeFriction, "enableConeFriction"):
        reservoir: StarSet = _ellipse(a, b)
        direction: StarSet = Disk(1.0)
        deviation = (
            "The friction force is opposite to the slip, although the coefficients form an ellipse,"
            " because the engine scales the two friction directions and divides by the effective "
            "mass along each. Where the tangential block of the Delassus operator is no multiple of"
            " the identity, as for bodies that turn, the direction of the force depends on it."
        )
    else:
        reservoir = direction = Rectangle(a, b)
        deviation = (
            "Without enableConeFriction each friction direction has a limit of its own, whatever "
            "the other one bears: even equal coefficients give a square, with √2 times the friction"
            " along its diagonals. The directions are axes of the world, made of the contact "
            "normal; anisotropicFriction scales in axes of the body. The law holds where both are "
            "parallel."
        )
    report = EngineReport(
        "bullet",
        "pybullet 3.2.7",
        axes="the first axis of the body, parallel to the world's x on a horizontal plane",
        deviation=deviation,
        source="sliding experiment; mass on a belt; applyAnisotropicFriction in its source",
        end_error=_EULER,
    )
    return Translation(reservoir, direction, report)


def _cardillo(
    *,
    mu: float,
    anisotropy: ArrayLike = (1.0, 1.0),
    solver: CardilloSolver = "Moreau",
) -> Translation:
    a, b = arrays.positive(mu, "mu") * _two(anisotropy, "anisotropy")
    arrays.choice(solver, "solver", tuple(_CARDILLO))
    reservoir = direction = _ellipse(a, b)
    error, deviation = _CARDILLO[solver]
    if solver != "Moreau":
        direction = Disk(1.0)
        deviation = (
            "This solver multiplies each component of the slip by a parameter r of its own, which "
            "for coefficients that differ turns the ellipse's normality into a force opposite to "
            "the slip. Where the tangential block of the Delassus operator is no multiple of the "
            f"square of anisotropy, the direction of the force depends on it. {deviation}"
        )
    report = EngineReport(
        "cardillo",
        "1.0.0 (451d581)",
        axes="the first tangent of the frame that the contact is made with",
        deviation=deviation,
        source="sliding experiment; r_F in cardillo/solver",
        creep=0.0,
        end_error=error,
    )
    return Translation(reservoir, direction, report)


# Distance of the end points, and what else is to be said.
_CARDILLO: dict[CardilloSolver, tuple[float | None, str]] = {
    "Moreau": (1e-7, "None was found: the law is set-valued and associated, sticking is exact."),
    "BackwardEuler": (3.8e-3, "Of the distance, 3.7 mm are its error of first order in time."),
    "DualStormerVerlet": (1e-7, "Sticking is exact."),
    "Rattle": (None, "Rattle was not run; it has the same product in its source."),
}


def _dart(*, mu: float = 1.0, mu2: float | None = None) -> Translation:
    a = arrays.positive(mu, "mu")
    b = a if mu2 is None else arrays.positive(mu2, "mu2")
    report = EngineReport(
        "dart",
        "6.20.0",
        axes="the first friction direction, fdir1; without one, the world's x on a horizontal "
        "plane",
        deviation="Each friction direction has a limit of its own, whatever the other one bears: "
        "even equal coefficients give a square, with √2 times the friction along its diagonals. "
        "Only equal coefficients were run.",
        source="sliding experiment",
        end_error=_EULER if a == b else None,
    )
    box = Rectangle(a, b)
    return Translation(box, box, report)


def _drake(
    *,
    dynamic_friction: float,
    static_friction: float | None = None,
    time_step: float = 1e-3,
    discrete_contact_approximation: DrakeApproximation = "lagged",
    stiction_tolerance: float = 1e-4,
) -> Translation:
    dynamic = arrays.positive(dynamic_friction, "dynamic_friction")
    static = dynamic
    if static_friction is not None:
        static = arrays.positive(static_friction, "static_friction")
    if static < dynamic:
        raise ParameterError(
            "static_friction", f"must not be below dynamic_friction {dynamic}, got {static}"
        )
    step = arrays.non_negative(time_step, "time_step")
    tolerance = arrays.positive(stiction_tolerance, "stiction_tolerance")
    kind = discrete_contact_approximation
    arrays.choice(kind, "discrete_contact_approximation", tuple(_DRAKE))
    if step == 0.0:
        return _continuous_drake(static, dynamic, tolerance)
    factor, error = _DRAKE[kind]
    scale = 1e-3 * dynamic * _GRAVITY * step if kind == "sap" else tolerance
    creep = factor * scale
    ignored = " With a time step, Drake does not use static_friction." if static > dynamic else ""
    report = EngineReport(
        "drake",
        "1.51.1",
        axes="any: the law is isotropic",
        deviation=f"A contact that sticks here creeps at {creep:.2g} m/s under half of the load "
        f"that it can hold: the engine's friction is regularised.{ignored}",
        source="sliding experiment; creep under constant loads",
        creep=creep,
        end_error=error,
    )
    disk = Disk(dynamic)
    return Translation(disk, disk, report)


# Creep under half of the largest load, over the stiction tolerance: s with s(2 − s) = ½, and with
# s/√(1 + s²) = ½; of SAP over σμgΔt, σ = 1e-3, for a point mass. Distance of the end points.
_DRAKE: dict[DrakeApproximation, tuple[float, float]] = {
    "lagged": (math.sqrt(1.0 / 3.0), 1e-6),
    "similar": (math.sqrt(1.0 / 3.0), 8.5e-5),
    "tamsi": (1.0 - math.sqrt(0.5), _EULER),
    "sap": (_HALF / math.sqrt(3.0), _EULER),
}
# The factor exp(−(v/v₀)^δ) that is nearest to Drake's drop from one to three stiction tolerances,
# v₀ over the tolerance and δ, and how near it is.
_DROP_SPEED, _DROP_EXPONENT, _DROP_ERROR = 2.14437, 5.97928, 0.023


def _continuous_drake(static: float, dynamic: float, tolerance: float) -> Translation:
    rate = None
    drop = ""
    if static > dynamic:
        rate = Stribeck(_DROP_SPEED * tolerance, ratio=dynamic / static, exponent=_DROP_EXPONENT)
        drop = (
            f" Between {tolerance:.2g} and {3.0 * tolerance:.2g} m/s, where its coefficient falls "
            f"from static_friction to dynamic_friction, the two differ by up to "
            f"{_DROP_ERROR * (static - dynamic):.2g}."
        )
    creep = _HALF * tolerance
    report = EngineReport(
        "drake",
        "1.51.1",
        axes="any: the law is isotropic",
        deviation=f"A contact that sticks here creeps at {creep:.2g} m/s under half of the load "
        f"that it can hold: below the stiction tolerance, the engine's friction grows with the "
        f"speed.{drop}",
        source="sliding experiment; forces of the engine over the speed",
        creep=creep,
        end_error=1e-6,
    )
    disk = Disk(static)
    return Translation(disk, disk, report, rate)


def _exudyn(
    *,
    dryFriction: ArrayLike,
    dryFrictionAngle: float = 0.0,
    dryFrictionProportionalZone: float = 0.0,
) -> Translation:
    mu = _two(dryFriction, "dryFriction")
    angle = arrays.number(dryFrictionAngle, "dryFrictionAngle")
    zone = arrays.non_negative(dryFrictionProportionalZone, "dryFrictionProportionalZone")
    reservoir, direction = flow.ellipses(np.diag(mu))
    at_rest = (
        f"Below the proportional zone of {zone:.2g} m/s the force grows with the speed, so that a "
        f"contact that sticks here creeps at {_HALF * zone:.2g} m/s under half of the load that it "
        "can hold."
        if zone > 0.0
        else "Without a proportional zone the force changes its sign from step to step where a "
        "contact sticks here: it moved at 0.2 mm/s with steps of 0.1 ms."
    )
    report = EngineReport(
        "exudyn",
        "1.13.6",
        axes="the axis of the rolling disc (ObjectConnectorRollingDiscPenalty), turned by "
        "dryFrictionAngle about the plane's normal; the second one is forwards",
        deviation="The force is the friction matrix times the direction of slip: the coefficients "
        f"are the semi-axes of the reservoir, but the law is not associated. {at_rest}",
        source="sliding experiment; creep under a constant load",
        angle=angle,
        creep=_HALF * zone if zone > 0.0 else None,
        end_error=1.1e-5,
    )
    if angle != 0.0:
        reservoir, direction = reservoir.rotated(angle), direction.rotated(angle)
    return Translation(reservoir, direction, report)


def _mujoco(
    *,
    friction: ArrayLike | None = None,
    geom_friction: ArrayLike | None = None,
    condim: int = 3,
    cone: Literal["pyramidal", "elliptic"] = "pyramidal",
    frame: ArrayLike | None = None,
    patch_radius: float | None = None,
) -> Translation:
    mu = _mujoco_friction(friction, geom_friction)
    arrays.choice(cone, "cone", ("pyramidal", "elliptic"))
    dimensions = arrays.count(condim, "condim")
    if dimensions not in (3, 4):
        raise ParameterError("condim", _CONDIM.get(dimensions, f"must be 3 or 4, got {condim}"))
    angle = 0.0 if frame is None else _mujoco_angle(frame)
    if dimensions == 4:
        reservoir = _mujoco_with_torsion(mu, cone, frame, patch_radius)
    elif patch_radius is not None:
        raise ParameterError("patch_radius", "is for torsional friction, which condim=3 has not")
    elif cone == "elliptic":
        reservoir = _ellipse(mu[0], mu[1], angle)
    else:
        corners = np.array([[mu[0], 0.0], [0.0, mu[1]], [-mu[0], 0.0], [0.0, -mu[1]]])
        reservoir = Polygon(corners @ arrays.rotation(angle).T)
    creep = _MUJOCO_CREEP[cone] * _HALF * mu[0] * _GRAVITY
    error = (_EULER if mu[0] == mu[1] else 2.3e-3) if cone == "elliptic" else 3.5e-3
    report = EngineReport(
        "mujoco",
        "4.0.0",
        axes="the contact's first tangent, mjContact.frame[3:6]; of a sphere on a horizontal plane "
        "it is the world's y",
        deviation=_MUJOCO_DEVIATION[cone].format(creep=f"{1e3 * creep:.2g}"),
        source="sliding experiment; creep under a constant load; mj_contactForce",
        angle=angle,
        creep=creep if dimensions == 3 else None,
        end_error=error if dimensions == 3 else None,
    )
    return Translation(reservoir, reservoir, report)


# Speed of creep over the tangential acceleration of the load, in s, with the default solref,
# solimp and impratio, measured.
_MUJOCO_CREEP = {"elliptic": 9.0e-4, "pyramidal": 1.3127e-3}
_MUJOCO_DEVIATION = {
    "elliptic": "A contact that sticks here creeps at {creep} mm/s under half of the load that it "
    "can hold, with the default solref, solimp and impratio; a larger impratio divides this by as "
    "much. Slip lifts the contact, which then hops: at 1.5 m/s it was closed in 7 to 42 % of "
    "the steps, and on a belt, with coefficients as 3 to 1, the direction of the mean force was 8° "
    "off the law's.",
    "pyramidal": "The friction force lies in a diamond with its corners on the contact's axes, "
    'which is the law of the default cone="pyramidal": even equal coefficients slide as a law '
    "of anisotropic friction does. A contact that sticks here creeps at {creep} mm/s under half of "
    "the load that it can hold, with the default solref, solimp and impratio. Slip lifts the "
    "contact, which then hops.",
}
_CONDIM = {
    1: "1 means contact without friction, which is no law",
    6: "6 has rolling friction, in five directions; a law has one to three",
}


def _mujoco_friction(friction: ArrayLike | None, geom_friction: ArrayLike | None) -> Array:
    """Return the coefficients along both tangents and about the normal."""
    if friction is not None and geom_friction is None:
        values = arrays.array(friction, "friction")
        if values.shape not in ((2,), (5,)):
            raise DimensionError(
                "friction",
                "must have the five numbers of mjContact.friction or the first two, got shape "
                f"{values.shape}; three numbers of a geom are geom_friction",
            )
    elif geom_friction is not None and friction is None:
        slide, spin, roll = arrays.array(geom_friction, "geom_friction", (3,))
        values = np.array([slide, slide, spin, roll, roll])
    else:
        raise ParameterError(
            "friction", "of a contact or geom_friction of the two geoms must be given, one of them"
        )
    name = "friction" if geom_friction is None else "geom_friction"
    if values.min() < 0.0 or values[:2].min() <= 0.0:
        raise ParameterError(name, f"must be positive, got {values.tolist()}")
    return values[:3]


def _mujoco_angle(frame: ArrayLike) -> float:
    """Return the angle of the first tangent of a contact on a horizontal plane from x."""
    rows = arrays.array(frame, "frame")
    if rows.size != 9:
        raise DimensionError(
            "frame", f"must have the nine numbers of mjContact.frame, got {rows.size}"
        )
    rows = rows.reshape(3, 3)
    if np.abs(rows @ rows.T - np.eye(3)).max() > 1e-6:
        raise ParameterError("frame", "must have orthonormal rows: normal and two tangents")
    if abs(rows[0, 2]) < 1.0 - 1e-9:
        raise ParameterError(
            "frame",
            f"must have a vertical normal, got {rows[0].tolist()}: leave it out to get the law on "
            "the contact's own axes",
        )
    return math.atan2(rows[1, 1], rows[1, 0])


def _mujoco_with_torsion(
    mu: Array, cone: str, frame: ArrayLike | None, patch_radius: float | None
) -> StarSet:
    if frame is not None:
        raise ParameterError(
            "frame", "is for condim=3; a law with drilling is on the contact's axes"
        )
    if patch_radius is None:
        raise ParameterError(
            "patch_radius", "is missing: with condim=4 the third slip is the drilling times it"
        )
    if len(mu) < 3 or mu[2] <= 0.0:
        raise ParameterError("friction", "must have a positive third number with condim=4")
    sizes = [*map(float, mu[:2]), float(mu[2]) / arrays.size(patch_radius, "patch_radius")]
    return Ellipsoid(sizes) if cone == "elliptic" else Superellipsoid(sizes, exponent=1.0)


def _pinocchio(*, mu: float, S: ArrayLike | None = None) -> Translation:
    report = EngineReport(
        "pinocchio",
        "4.1.0",
        axes="the first tangent of the contact",
        deviation="None was found for one contact: PGS and ADMM solve the set-valued law.",
        source="sliding experiment; PGSConstraintSolver and ADMMConstraintSolver",
        creep=0.0,
        end_error=1e-5,
    )
    reservoir = _scaled_disk(mu, S, "S")
    return Translation(reservoir, reservoir, report)


def _rapier(*, friction: float = 0.5) -> Translation:
    disk = Disk(arrays.positive(friction, "friction"))
    report = EngineReport(
        "rapier",
        "0.21.0",
        axes="any: the law is isotropic",
        deviation="It computes in single precision; nothing else was found for one contact.",
        source="sliding experiment",
        end_error=3e-6,
    )
    return Translation(disk, disk, report)


def _siconos(
    *,
    mu: float,
    size: Literal[2, 3] = 3,
    H: ArrayLike | None = None,
) -> Translation:
    rows = arrays.count(size, "size")
    if rows == 5:
        raise ParameterError(
            "size", "5 has rolling friction, in four directions; a law has at most 3"
        )
    if rows not in (2, 3):
        raise ParameterError("size", f"must be 2 or 3, got {size}")
    report = EngineReport(
        "siconos",
        "4.4.0",
        axes="the first tangential row of the relation",
        deviation="None was found: the law is set-valued and associated, sticking is exact.",
        source="sliding experiment and mass on a belt; NewtonImpactFrictionNSL",
        creep=0.0,
        end_error=1e-7 if rows == 3 else None,
    )
    if rows == 2:
        if H is not None:
            raise ParameterError("H", "is for size=3; in a plane it scales mu")
        bound = arrays.positive(mu, "mu")
        return Translation(Interval(-bound, bound), Interval(-bound, bound), report)
    reservoir = _scaled_disk(mu, H, "H")
    return Translation(reservoir, reservoir, report)


def _solve_nivp(*, mu: float | None = None, projection: StarSet | None = None) -> Translation:
    if (mu is None) == (projection is None):
        raise ParameterError(
            "mu", "of CoulombProjection or the set of a projection of one's own must be given"
        )
    if projection is None:
        bound = arrays.positive(mu, "mu")
        reservoir: StarSet = Interval(-bound, bound)
    else:
        reservoir = checked_set(projection, "projection")
        if not reservoir.is_convex:
            raise ParameterError("projection", f"must be a convex set, got {reservoir!r}")
    report = EngineReport(
        "solve_nivp",
        "0.1.2",
        axes="the first component that is projected",
        deviation="None was found: projections solve the set-valued, associated law.",
        source="sliding experiment with a projection onto an ellipse",
        creep=0.0,
        end_error=1e-6 if reservoir.dimension == 2 else None,
    )
    return Translation(reservoir, reservoir, report)


ENGINES: dict[str, Callable[..., Translation]] = {
    "bullet": _bullet,
    "cardillo": _cardillo,
    "dart": _dart,
    "drake": _drake,
    "exudyn": _exudyn,
    "mujoco": _mujoco,
    "pinocchio": _pinocchio,
    "rapier": _rapier,
    "siconos": _siconos,
    "solve_nivp": _solve_nivp,
}


def _flag(value: Any, argument: str) -> bool:
    if not isinstance(value, bool | int) or value not in (0, 1):
        raise ParameterError(argument, f"must be True or False, got {value!r}")
    return bool(value)


def _two(value: ArrayLike, argument: str) -> Array:
    """Return two positive numbers."""
    pair = arrays.array(value, argument, (2,))
    if pair.min() <= 0.0:
        raise ParameterError(argument, f"must be positive, got {pair.tolist()}")
    return pair


def _ellipse(a: float, b: float, angle: float = 0.0) -> StarSet:
    return Disk(float(a)) if a == b else Ellipse(float(a), float(b), angle=angle)


def _scaled_disk(mu: float, rows: ArrayLike | None, argument: str) -> StarSet:
    """Return the reservoir of an isotropic law whose tangential rows of γ are multiplied by `rows`.

    The engine's slip is Hγ and its force bounded by μ; the force on the body is Hᵀ times it.
    """
    radius = arrays.positive(mu, "mu")
    if rows is None:
        return Disk(radius)
    matrix = arrays.array(rows, argument, (2, 2))
    if matrix[0, 1] == matrix[1, 0] == 0.0:
        axes, sizes = np.eye(2), np.abs(np.diag(matrix))
    else:
        axes, sizes, _ = np.linalg.svd(matrix.T)
    if sizes.min() <= 1e-12 * sizes.max():
        raise ParameterError(argument, "must be regular, its determinant vanishes")
    angle = math.atan(axes[1, 0] / axes[0, 0]) if axes[0, 0] else 0.5 * math.pi
    return _ellipse(radius * sizes[0], radius * sizes[1], angle)
