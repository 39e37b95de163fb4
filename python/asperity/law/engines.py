"""Other engines: which pair (C, D) their friction parameters mean, and what they do otherwise.

Every function is an engine and takes its parameters in the engine's own words. What is said of an
engine, in ``engines.toml``, was found by running it; the numbers are those of docs/engines.md.
"""

from __future__ import annotations

import functools
import inspect
import math
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

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


@functools.cache
def known_of(engine: str) -> dict[str, Any]:
    """Return version, axes, sources and sentences of an engine."""
    text = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
    return {"elsewhere": {}, **tomllib.loads(text)[engine]}


def _report(engine: str, *deviations: str, source: str = "", **numbers: Any) -> EngineReport:
    """Return the report of an engine, which joins some of its sentences."""
    known = known_of(engine)
    whole = "".join(known["deviation"][one] for one in deviations)
    return EngineReport(
        engine,
        known["version"],
        axes=known["axes"],
        deviation=whole.format(**numbers.pop("words", {})),
        source=known["deviation"][source] if source else known["source"],
        **numbers,
    )


def translated(engine: str, parameters: Mapping[str, Any]) -> Translation:
    """Return the sets of an engine's law and what is known of it.

    Raises:
        ParameterError: for an engine that is not known; for parameters that it does not have, that
            are missing, or that no law expresses, in the engine's words.
    """
    kind = named(engine, "engine", sorted(ENGINES))
    known = parameters_of(kind)
    for name in parameters:
        place = known_of(kind)["elsewhere"].get(name)
        if place is not None:
            raise ParameterError(name, f"is not part of a law: {place}")
        if name not in known:
            raise ParameterError(name, f"is not a parameter of {kind} here{advice_on(name, known)}")
    for name, needed in known.items():
        if needed and name not in parameters:
            raise ParameterError(name, f"is missing: {kind} has {', '.join(known)}")
    return ENGINES[kind](**parameters)


def named(given: str, argument: str, known: Sequence[str]) -> str:
    """Return the known name of a program that is meant, in any case or as its package is called."""
    plain = str(given).casefold().replace("-", "_")
    kind = _ALSO_CALLED.get(plain, plain)
    if isinstance(given, str) and kind in _REFUSED and kind not in known:
        raise ParameterError(argument, f"{given!r} is not translated: {_REFUSED[kind]}")
    if not isinstance(given, str) or kind not in known:
        raise ParameterError(argument, f"{given!r} is not known{advice_on(plain, known)}")
    return kind


def parameters_of(engine: str) -> dict[str, bool]:
    """Return the names of an engine's parameters and whether they must be given."""
    if engine in _TABLED:
        known = known_of(engine)
        names = {known["coefficient"]: "default" not in known}
        return names | ({known["option"]: False} if "option" in known else {})
    signature = inspect.signature(ENGINES[engine])
    return {name: one.default is one.empty for name, one in signature.parameters.items()}


def _bullet(
    *,
    lateralFriction: float,
    anisotropicFriction: ArrayLike = (1.0, 1.0, 1.0),
    enableConeFriction: bool = True,
    spinningFriction: float = 0.0,
    rollingFriction: float = 0.0,
) -> Translation:
    mu = arrays.positive(lateralFriction, "lateralFriction")
    scale = arrays.array(anisotropicFriction, "anisotropicFriction", (3,))
    if scale[:2].min() <= 0.0:
        raise ParameterError("anisotropicFriction", f"must be positive, got {scale.tolist()}")
    if arrays.non_negative(spinningFriction, "spinningFriction") > 0.0:
        raise ParameterError(
            "spinningFriction",
            "is not translated: it limits the spinning torque with enableConeFriction and does "
            "nothing without; how that torque depends on slip was not found by experiment",
        )
    if arrays.non_negative(rollingFriction, "rollingFriction") > 0.0:
        raise ParameterError(
            "rollingFriction",
            "is not translated: a law has up to three directions, slip and drilling",
        )
    a, b = float(mu * scale[0]), float(mu * scale[1])
    ellipse = "" if a == b else known_of("bullet")["deviation"]["ellipse"]
    cone = _flag(enableConeFriction, "enableConeFriction")
    reservoir = _ellipse(a, b) if cone else Rectangle(a, b)
    report = _report(
        "bullet",
        "multibody",
        "cone" if cone else "box",
        words={"ellipse": ellipse},
        end_error=_euler(_STEP),
    )
    return Translation(reservoir, Disk(1.0) if cone else reservoir, report)


def _btrigidbody(
    *, friction: float, anisotropicFriction: ArrayLike = (1.0, 1.0, 1.0)
) -> Translation:
    scale = arrays.array(anisotropicFriction, "anisotropicFriction", (3,))
    mu = arrays.positive(friction, "friction") * _two(scale[:2], "anisotropicFriction")
    return Translation(
        *_of_tensor(mu), _report("btrigidbody", "equal" if mu[0] == mu[1] else "different")
    )


def _cardillo(
    *,
    mu: float,
    anisotropy: ArrayLike = (1.0, 1.0),
    solver: CardilloSolver = "Moreau",
) -> Translation:
    a, b = arrays.positive(mu, "mu") * _two(anisotropy, "anisotropy")
    name = _word(solver, "solver", get_args(CardilloSolver))
    reservoir = _ellipse(a, b)
    if name == "Moreau":
        return Translation(reservoir, reservoir, _report("cardillo", "Moreau"))
    return Translation(reservoir, Disk(1.0), _report("cardillo", "other"))


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
    report = _report(
        "drake",
        "steps",
        *(("ignored",) if static > dynamic else ()),
        *(("lift",) if kind in ("sap", "similar") else ()),
        words={"creep": creep},
        creep=creep,
        end_error=_euler(step) + extra,
    )
    disk = Disk(dynamic)
    return Translation(disk, disk, report)


# Creep under half of the largest load, over the stiction tolerance: s with s(2 − s) = ½, and with
# s/√(1 + s²) = ½; of SAP over σμgΔt, σ = 1e-3, for a point mass. Distance of the end points
# beyond that of semi-implicit Euler.
_DRAKE: dict[DrakeApproximation, tuple[float, float]] = {
    "lagged": (math.sqrt(1.0 / 3.0), 0.0),
    "similar": (math.sqrt(1.0 / 3.0), 9e-6),
    "tamsi": (1.0 - math.sqrt(0.5), 0.0),
    "sap": (_HALF / math.sqrt(3.0), 1e-6),
}
# The factor exp(−(v/v₀)^δ) that is nearest to Drake's drop from one to three stiction tolerances,
# v₀ over the tolerance and δ, and how near it is.
_DROP_SPEED, _DROP_EXPONENT, _DROP_ERROR = 2.14437, 5.97928, 0.023


def _continuous_drake(static: float, dynamic: float, tolerance: float) -> Translation:
    rate = None
    words = {
        "creep": _HALF * tolerance,
        "low": tolerance,
        "high": 3.0 * tolerance,
        "off": _DROP_ERROR * (static - dynamic),
    }
    if static > dynamic:
        rate = Stribeck(_DROP_SPEED * tolerance, ratio=dynamic / static, exponent=_DROP_EXPONENT)
    report = _report(
        "drake",
        *(("continuous",) if rate is None else ("continuous", "drop")),
        source="continuous_source",
        words=words,
        creep=words["creep"],
        end_error=1e-6,
    )
    disk = Disk(static)
    return Translation(disk, disk, report, rate)


def _exudyn(
    *,
    dryFriction: ArrayLike,
    dryFrictionAngle: float = 0.0,
    dryFrictionProportionalZone: float = 0.0,
    useLinearProportionalZone: bool = False,
) -> Translation:
    mu = _two(dryFriction, "dryFriction")
    angle = arrays.number(dryFrictionAngle, "dryFrictionAngle")
    zone = arrays.non_negative(dryFrictionProportionalZone, "dryFrictionProportionalZone")
    # Speed under half of the largest force over the zone: s = ½, or s with s(2 − s) = ½.
    linear = _flag(useLinearProportionalZone, "useLinearProportionalZone")
    creep = zone * (_HALF if linear else 1.0 - math.sqrt(_HALF))
    reservoir, direction = _of_tensor(mu)
    report = _report(
        "exudyn",
        "equal" if mu[0] == mu[1] else "different",
        "zone" if zone > 0.0 else "without",
        words={"zone": zone, "creep": creep},
        angle=angle,
        creep=creep if zone > 0.0 else None,
        end_error=1.1e-5,
    )
    if angle != 0.0:
        reservoir, direction = reservoir.rotated(angle), direction.rotated(angle)
    return Translation(reservoir, direction, report)


def _ipctk(*, mu: float, mu_aniso: ArrayLike | None = None) -> Translation:
    plain = _of_table("ipctk", mu=mu)
    if mu_aniso is None:
        return plain
    scale = _two(mu_aniso, "mu_aniso")
    direction = plain.reservoir if scale[0] == scale[1] else Ellipse(*np.sqrt(scale).tolist())
    # Below eps_v of 1 mm/s half of the largest force is that of s with s(2 − s) = ½.
    creep = 1e-3 * (1.0 - math.sqrt(_HALF)) / float(scale[0])
    report = _report("ipctk", "isotropic", "scaled", words={"creep": creep}, creep=creep)
    return Translation(plain.reservoir, direction, report.replace(end_error=plain.report.end_error))


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
        reservoir = _diamond(mu[0], mu[1], angle)
    creep = _MUJOCO_CREEP[shape] * _HALF * mu[0] * _GRAVITY / ratio
    error: float | None = 6.3e-3
    if shape == "elliptic":
        unequal = float(mu[:2].max() / mu[:2].min())
        error = np.interp(unequal, *_MUJOCO_END_ERROR, right=np.nan)
        error = None if math.isnan(error) else float(error)
    at_rest = known_of("mujoco")["deviation"]["creep" if dimensions == 3 else "torsion"]
    report = _report(
        "mujoco",
        shape,
        words={"at_rest": at_rest.format(speed=1e3 * creep, ratio=ratio)},
        angle=angle,
        creep=creep if dimensions == 3 else None,
        end_error=error if dimensions == 3 and ratio == 1.0 else None,
    )
    return Translation(reservoir, reservoir, report)


# Speed of creep over the tangential acceleration of the load, in s, with the default solref,
# solimp and impratio, measured. Under the pyramid it falls with 1/impratio to 2 %.
_MUJOCO_CREEP = {"elliptic": 9.0e-4, "pyramidal": 1.3127e-3}
# What MuJoCo takes for zero, its constant mjMINMU.
_MUJOCO_LEAST = 1e-5
# Distance of the end points in m over the ratio of the coefficients, the largest over launches.
_MUJOCO_END_ERROR = [1.0, 1.114, 1.5, 3.0], [1.5e-3, 2.9e-3, 10e-3, 22e-3]
_CONDIM = {
    1: "1 means contact without friction, which is not a friction law",
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
    if values.min() < 0.0 or values[:2].max() == 0.0:
        raise ParameterError("friction", f"must be positive, got {values.tolist()}")
    return np.maximum(values[:3], _MUJOCO_LEAST)


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


def _ode(*, mu: float, mu2: float | None = None) -> Translation:
    a = arrays.positive(mu, "mu")
    box = Rectangle(a, a if mu2 is None else arrays.positive(mu2, "mu2"))
    return Translation(box, box, _report("ode", "all"))


def _pinocchio(*, mu: float, S: ArrayLike | None = None) -> Translation:
    report = _report("pinocchio", "all", creep=0.0, end_error=1e-5)
    reservoir = _scaled_disk(mu, S, "S")
    return Translation(reservoir, reservoir, report)


def _pyelastica(*, kinetic_mu_array: ArrayLike) -> Translation:
    forward, backward, sideways = arrays.array(kinetic_mu_array, "kinetic_mu_array", (3,))
    if forward != backward:
        raise ParameterError(
            "kinetic_mu_array",
            f"must have equal coefficients forwards and backwards, got {forward:g}, {backward:g}",
        )
    mu = _two([forward, sideways], "kinetic_mu_array")
    return Translation(
        *_of_tensor(mu), _report("pyelastica", "equal" if mu[0] == mu[1] else "different")
    )


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
    report = _report("siconos", "all", creep=0.0, end_error=1e-7 if rows == 3 else None)
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
    error = 1e-6 if reservoir.dimension == 2 else None
    report = _report("solve_nivp", "all", creep=0.0, end_error=error)
    return Translation(reservoir, reservoir, report)


# Engines with one coefficient, of which the table says everything.
_TABLED = (
    "box2d",
    "chipmunk",
    "dart",
    "jaxsim",
    "motrix",
    "newton",
    "omi",
    "opensim",
    "physx",
    "rapier",
    "yade",
)
_SHAPES: dict[str, Callable[[float], StarSet]] = {
    "isotropic": Disk,
    "square": lambda mu: Rectangle(mu, mu),
    "interval": lambda mu: Interval(-mu, mu),
    "associated diamond": lambda mu: _diamond(mu, mu),
}


def _of_table(engine: str, **given: Any) -> Translation:
    """Return the law of an engine with one coefficient, as its modes in the table have it."""
    known = known_of(engine)
    word, option = known["coefficient"], known.get("option", "")
    mu = arrays.positive(given.get(word, known.get("default")), word)
    if known.get("is_angle"):
        if mu >= 0.5 * math.pi:
            raise ParameterError(word, f"must be below π/2, got {mu}")
        mu = math.tan(mu)
    modes = {one["name"]: one for one in known["modes"]}
    mode = modes[_word(given.get(option, next(iter(modes))), option, tuple(modes))]
    if "refused" in mode:
        raise ParameterError(option, f"{mode['name']} has no pair of sets: {mode['refused']}")
    # Creep was measured with 0.5; what sticks does so with every coefficient.
    creep = mode["creep"] if mu == _HALF or mode["creep"] == 0.0 else None
    report = _report(
        engine,
        *mode.get("sentences", (mode["law"],)),
        words={"creep": mode["creep"]},
        creep=creep,
        end_error=mode.get("end_error"),
    )
    if option not in given and mode["name"] != "default" and len(modes) > 1:
        deviation = f"{option} is {mode['name']}, as none was given. {report.deviation}"
        report = report.replace(deviation=deviation)
    shape = _SHAPES[mode["law"]](mu)
    return Translation(shape, shape, report)


ENGINES: dict[str, Callable[..., Translation]] = {
    "btrigidbody": _btrigidbody,
    "bullet": _bullet,
    "cardillo": _cardillo,
    "drake": _drake,
    "exudyn": _exudyn,
    "ipctk": _ipctk,
    "mujoco": _mujoco,
    "ode": _ode,
    "pinocchio": _pinocchio,
    "pyelastica": _pyelastica,
    "siconos": _siconos,
    "solve_nivp": _solve_nivp,
    **{one: functools.partial(_of_table, one) for one in _TABLED},
}


_ALSO_CALLED = {
    "motrixsim": "motrix",
    "pybullet": "bullet",
    "pymunk": "chipmunk",
    "rapier3d": "rapier",
    "sapien": "physx",
    "dartpy": "dart",
    "elastica": "pyelastica",
    "pyb2d3": "box2d",
    "pydrake": "drake",
}
_REFUSED = {
    "abaqus": "it was not run: law.export('abaqus') has the law of its manual",
    "ansys": "it was not run: law.export('ansys') has what its manual states",
    "lavendersim": "no pair of sets has its law: the direction of the force depends on the shape "
    "of the body, and damping of 0.09/s slows down whatever moves",
    "liggghts": "it was run for restitution only, not for friction",
    "lsdyna": "it was not run: law.export('lsdyna') has the law of its manual",
    "pybox3d": "bodies tumble on its one contact point, so that its law was found for bodies that "
    "do not turn only: isotropic, with the geometric mean of two coefficients",
    "simbody": "it is not OpenSim: isotropic, of two bodies 2ab/(a + b), and over the speed the "
    "drop of Drake's continuous model, like('drake', time_step=0)",
}
"""Programs whose law is not translated, with the reason."""


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


def _of_tensor(mu: Array) -> tuple[StarSet, StarSet]:
    """Return C and D where the force is diag(μ) times the direction of slip."""
    if mu[0] == mu[1]:
        return Disk(float(mu[0])), Disk(float(mu[0]))
    return flow.ellipses(np.diag(mu))


def _ellipse(a: float, b: float, angle: float = 0.0) -> StarSet:
    return Disk(float(a)) if a == b else Ellipse(float(a), float(b), angle=angle)


def _diamond(a: float, b: float, angle: float = 0.0) -> StarSet:
    corners = np.array([[a, 0.0], [0.0, b], [-a, 0.0], [0.0, -b]])
    return Polygon(corners @ arrays.rotation(angle).T)


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
