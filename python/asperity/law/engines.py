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

_HALF, _GRAVITY = 0.5, 9.81
# Launch speed in m/s and step in s of the sliding experiment in docs/engines.md.
_LAUNCH, _STEP = 1.52, 1e-4


def _euler(step: float) -> float:
    """Return by how much semi-implicit Euler moves a sliding body too little, whatever its law.

    It is v₀Δt/2, to which the experiments add up to 1 µm.
    """
    return _HALF * _LAUNCH * step + 1e-6


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
    plain = str(engine).casefold().replace("-", "_")
    kind = _ALSO_CALLED.get(plain, plain)
    if not isinstance(engine, str) or kind not in ENGINES:
        raise ParameterError(
            "engine", f"{engine!r} is not known{advice_on(plain, sorted(ENGINES))}"
        )
    function = ENGINES[kind]
    known = inspect.signature(function).parameters
    for name in parameters:
        if name in ELSEWHERE.get(kind, {}):
            raise ParameterError(name, f"is no part of a law: {ELSEWHERE[kind][name]}")
        if name not in known:
            raise ParameterError(name, f"is no parameter of {kind} here{advice_on(name, known)}")
    for name, one in known.items():
        if one.default is one.empty and name not in parameters:
            raise ParameterError(name, f"is missing: {kind} has {', '.join(known)}")
    return function(**parameters)


def _bullet(
    *,
    lateralFriction: float,
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
    deviation = (
        "This is the law of Bullet's multibodies, which pybullet uses for every body. Its rigid "
        "bodies (btRigidBody) have by default one friction direction, along the slip, and so no "
        "box; they were not run. "
    )
    if _flag(enableConeFriction, "enableConeFriction"):
        reservoir: StarSet = _ellipse(a, b)
        direction: StarSet = Disk(1.0)
        ellipse = "" if a == b else ", although the coefficients form an ellipse,"
        deviation += (
            f"The friction force is opposite to the slip{ellipse} because the engine scales the "
            "two friction directions and divides by the effective mass along each. Where the "
            "tangential block of the Delassus operator is no multiple of the identity, as for "
            "bodies that turn, the direction of the force depends on it."
        )
    else:
        reservoir = direction = Rectangle(a, b)
        deviation += (
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
        end_error=_euler(_STEP),
    )
    return Translation(reservoir, direction, report)


def _cardillo(
    *,
    mu: float,
    anisotropy: ArrayLike = (1.0, 1.0),
    solver: CardilloSolver = "Moreau",
) -> Translation:
    a, b = arrays.positive(mu, "mu") * _two(anisotropy, "anisotropy")
    name = _word(solver, "solver", tuple(_CARDILLO))
    reservoir = direction = _ellipse(a, b)
    error, deviation = _CARDILLO[name]
    if name != "Moreau":
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
        end_error=_euler(_STEP) if a == b else None,
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
    kind = _word(
        discrete_contact_approximation, "discrete_contact_approximation", tuple(_DRAKE), prefix="k"
    )
    if step == 0.0:
        return _continuous_drake(static, dynamic, tolerance)
    factor, extra = _DRAKE[kind]
    scale = 1e-3 * dynamic * _GRAVITY * step if kind == "sap" else tolerance
    creep = factor * scale
    ignored = " With a time step, Drake does not use static_friction." if static > dynamic else ""
    report = EngineReport(
        "drake",
        "1.51.1",
        axes="any: the law is isotropic",
        deviation=f"A contact that sticks here creeps at {creep:.2g} m/s under half of the load "
        f"that it can hold: the engine's friction is regularised.{ignored}",
        source="sliding experiment with steps of 0.1 and 1 ms; creep under constant loads",
        creep=creep,
        end_error=1.2e-6 if extra is None else _euler(step) + extra,
    )
    disk = Disk(dynamic)
    return Translation(disk, disk, report)


# Creep under half of the largest load, over the stiction tolerance: s with s(2 − s) = ½, and with
# s/√(1 + s²) = ½; of SAP over σμgΔt, σ = 1e-3, for a point mass. Distance of the end points
# beyond that of semi-implicit Euler, None for the one whose steps are of second order.
_DRAKE: dict[DrakeApproximation, tuple[float, float | None]] = {
    "lagged": (math.sqrt(1.0 / 3.0), None),
    "similar": (math.sqrt(1.0 / 3.0), 8e-6),
    "tamsi": (1.0 - math.sqrt(0.5), 0.0),
    "sap": (_HALF / math.sqrt(3.0), 0.0),
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
    sets = (
        "with equal coefficients the law is isotropic."
        if mu[0] == mu[1]
        else "the coefficients are the semi-axes of the reservoir, but the law is not associated."
    )
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
        deviation=f"The force is the friction matrix times the direction of slip: {sets} {at_rest}",
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
    cone: Literal["pyramidal", "elliptic", 0, 1] = "pyramidal",
    frame: ArrayLike | None = None,
    patch_radius: float | None = None,
    impratio: float = 1.0,
) -> Translation:
    mu = _mujoco_friction(friction, geom_friction)
    # As MjModel.opt.cone has it, mjtCone.
    named = ("pyramidal", "elliptic")[cone] if type(cone) is int and cone in (0, 1) else cone
    shape = _word(named, "cone", ("pyramidal", "elliptic"), prefix="mjCONE_")
    ratio = arrays.positive(impratio, "impratio")
    dimensions = arrays.count(condim, "condim")
    if dimensions not in (3, 4):
        raise ParameterError("condim", _CONDIM.get(dimensions, f"must be 3 or 4, got {condim}"))
    angle = 0.0 if frame is None else _mujoco_angle(frame)
    if dimensions == 4:
        reservoir = _mujoco_with_torsion(mu, shape, frame, patch_radius)
    elif patch_radius is not None:
        raise ParameterError("patch_radius", "is for torsional friction, which condim=3 has not")
    elif shape == "elliptic":
        reservoir = _ellipse(mu[0], mu[1], angle)
    else:
        corners = np.array([[mu[0], 0.0], [0.0, mu[1]], [-mu[0], 0.0], [0.0, -mu[1]]])
        reservoir = Polygon(corners @ arrays.rotation(angle).T)
    creep = _MUJOCO_CREEP[shape] * _HALF * mu[0] * _GRAVITY / ratio
    error = (1.5e-3 if mu[0] == mu[1] else 2.9e-3) if shape == "elliptic" else 6.3e-3
    at_rest = (
        f"at {1e3 * creep:.2g} mm/s under half of the load that it can hold, with the default "
        f"solref and solimp and impratio={ratio:g}, by which this speed is divided"
        if dimensions == 3
        else "under every load; with condim=4 the speed was not measured"
    )
    report = EngineReport(
        "mujoco",
        "4.0.0",
        axes="the contact's first tangent, mjContact.frame[3:6]; of a sphere on a horizontal plane "
        "it is the world's y",
        deviation=_MUJOCO_DEVIATION[shape].format(at_rest=at_rest),
        source="sliding experiment with the default solref, solimp and impratio, in steps of 0.1 "
        "and of 2 ms; creep under a constant load; mj_contactForce",
        angle=angle,
        creep=creep if dimensions == 3 else None,
        end_error=error if dimensions == 3 and ratio == 1.0 else None,
    )
    return Translation(reservoir, reservoir, report)


# Speed of creep over the tangential acceleration of the load, in s, with the default solref,
# solimp and impratio, measured. Under the pyramid it falls with 1/impratio to 2 %.
_MUJOCO_CREEP = {"elliptic": 9.0e-4, "pyramidal": 1.3127e-3}
_MUJOCO_DEVIATION = {
    "elliptic": "A contact that sticks here creeps {at_rest}. "
    "Slip lifts the contact, which then hops: at 1.5 m/s it was closed in 7 to 42 % of "
    "the steps, and on a belt, with coefficients as 3 to 1, the direction of the mean force was 8° "
    "off the law's.",
    "pyramidal": "The friction force lies in a diamond with its corners on the contact's axes, "
    'which is the law of the default cone="pyramidal": even equal coefficients slide as a law '
    "of anisotropic friction does. A contact that sticks here creeps {at_rest}. Slip lifts the "
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
        slide, spin, roll = _geoms_of_mujoco(geom_friction)
        values = np.array([slide, slide, spin, roll, roll])
    else:
        raise ParameterError(
            "friction", "of a contact or geom_friction of the two geoms must be given, one of them"
        )
    if values.min() < 0.0 or values[:2].min() <= 0.0:
        raise ParameterError("friction", f"must be positive, got {values.tolist()}")
    return values[:3]


def _geoms_of_mujoco(friction: ArrayLike) -> Array:
    """Return the three numbers of a contact between geoms of equal priority.

    Numbers that a geom leaves out are MuJoCo's defaults; of two geoms the larger one counts.
    """
    values = arrays.array(friction, "geom_friction")
    if values.ndim > 2 or values.shape[-1:] not in ((), (1,), (3,)) or values.shape[:-1] == (0,):
        raise DimensionError(
            "geom_friction",
            "must have the three numbers of a geom or the first one, or be a list of two geoms "
            f"like that, got shape {values.shape}",
        )
    rows = values.reshape(-1, values.shape[-1] if values.ndim else 1)
    if len(rows) > 2:
        raise DimensionError("geom_friction", f"is of one geom or of two, got {len(rows)}")
    if rows.shape[1] == 1:
        rows = np.hstack([rows, np.tile(_GEOM_DEFAULTS, (len(rows), 1))])
    if rows.min() < 0.0 or rows[:, 0].min() <= 0.0:
        raise ParameterError("geom_friction", f"must be positive, got {values.tolist()}")
    return rows.max(axis=0)


# Torsional and rolling friction of a geom.
_GEOM_DEFAULTS = (0.005, 0.0001)


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


_ALSO_CALLED = {"pybullet": "bullet"}

_RIGID = "contacts are rigid here, and law.report.deviation says what that changes"
_IMPACT = "it belongs to the contact, as normal_restitution of a pair or a Contact"
_SIDEWAYS = "it belongs to the contact, as tangential_restitution of a pair or a Contact"
_STEPS = "it is the dt of simulate"
_ROLLING = "rolling friction is not translated; a law has slip and drilling only"
ELSEWHERE: dict[str, dict[str, str]] = {
    "bullet": {
        "restitution": _IMPACT,
        "contactStiffness": _RIGID,
        "contactDamping": _RIGID,
        "timeStep": _STEPS,
    },
    "cardillo": {"e_N": _IMPACT, "e_F": _SIDEWAYS, "dt": _STEPS},
    "dart": {
        "restitution": _IMPACT,
        "fdir1": "it turns the law, as FrictionLaw.rotated does",
        "slip1": "slip grows with the force there; what sticks here does not move",
        "slip2": "slip grows with the force there; what sticks here does not move",
    },
    "drake": {
        "point_stiffness": _RIGID,
        "dissipation": _RIGID,
        "hunt_crossley_dissipation": _RIGID,
        "relaxation_time": _RIGID,
        "hydroelastic_modulus": _RIGID,
    },
    "exudyn": {
        "viscousFriction": "it grows with the speed and belongs to the system, as damping or as "
        "forces",
        "contactStiffness": _RIGID,
        "contactDamping": _RIGID,
        "rollingFrictionViscous": _ROLLING,
    },
    "mujoco": {
        "solref": _RIGID,
        "solimp": _RIGID,
        "solreffriction": _RIGID,
        "margin": _RIGID,
        "gap": _RIGID,
        "priority": "of two geoms, give the friction of the one with the higher priority",
        "timestep": _STEPS,
    },
    "pinocchio": {"compliance": _RIGID},
    "rapier": {
        "restitution": _IMPACT,
        "friction_combine_rule": "give the coefficient of the contact, combined before",
    },
    "siconos": {"e_n": _IMPACT, "e_t": _SIDEWAYS, "mu_r": _ROLLING},
}
"""Parameters that engines have and laws have not: where they belong."""


def _word(value: Any, argument: str, allowed: tuple[str, ...], *, prefix: str = "") -> Any:
    """Return the allowed word that is meant, in lower or upper case or as an engine's constant."""
    constant = getattr(value, "name", value)
    if isinstance(constant, str):
        plain = constant.casefold()
        for word in allowed:
            if plain in (word.casefold(), (prefix + word).casefold()):
                return word
    return arrays.choice(value, argument, allowed)


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
