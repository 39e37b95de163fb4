"""The way to other programs: the parameters that come nearest to a law, and what is lost."""

from __future__ import annotations

import math
import os
import textwrap
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import asperity._core as _core
from asperity._base.arrays import Array, unit_vectors
from asperity._base.storage.files import atomic
from asperity._base.value import NonNegative, Number, Record
from asperity.errors import DimensionError
from asperity.law import engines
from asperity.law.engine_report import EngineReport
from asperity.law.rate import Stribeck
from asperity.sets import Disk, Ellipse, StarSet
from asperity.solvers import Auto

if TYPE_CHECKING:
    from asperity.law.friction import FrictionLaw

_PHI = np.linspace(0.0, 2.0 * math.pi, 180, endpoint=False)
# Launch of the sliding experiment of docs/engines.md.
_LAUNCH, _GRAVITY = 1.52 * unit_vectors(np.array(math.radians(58.0))), 9.81
# Step over the time in which the mean coefficient stops the point, and how many there may be.
_STEP, _MOST_STEPS = 2e-5, 2_000_000
# Forces that differ by less than this part are those of one law.
_EXACT = 1e-9
# Number of speeds of a law with a rate factor, up to that of the launch. Sliding is fast where the
# factor has come to its limit but for this part.
_SPEEDS, _LEFT = 200, 0.05
# What is less than this, in λ_N, m or rad, is rounding.
_NOTHING = 1e-8
# Axes that are turned are spoken of if that takes away at least half of this part of the force.
_WORTH = 0.01


class LawExport(Record):
    """A law in the words of another program, and what is lost on the way.

    Args:
        target: name of the program.
        version: of the program, in which its law was found; of a program that was not run, the page
            of its manual.
        text: what to put into its input, complete with comments.
        law: what the program makes of it, None where the manual of a program that was not run
            does not state it.
        parameters: likewise, in its own words, as `FrictionLaw.like` takes them.
        force_error: largest difference of ‖λ‖/λ_N over the direction of sliding, and over speeds
            up to 1.52 m/s where the law has a rate factor; None, as all three, where `law` is.
        angle_error: largest difference of the direction of λ in rad.
        end_distance: distance in m of the points where both laws end the sliding experiment of
            docs/engines.md. What the program was found to do beside its law is not in it:
            ``law.report.end_error`` is the distance in m that this added to the experiment.
    """

    target: str
    version: str
    _: KW_ONLY
    text: str
    law: Any
    parameters: Mapping[str, Any]
    force_error: NonNegative | None
    angle_error: Number | None
    end_distance: NonNegative | None

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the text to a file, which is complete or not there; return its path."""
        with atomic(path) as file:
            file.write(self.text.encode())
        return Path(path)

    def __repr__(self) -> str:
        if self.force_error is None or self.angle_error is None or self.end_distance is None:
            return f"<LawExport to {self.target}: errors are not known>"
        return (
            f"<LawExport to {self.target}: force ±{_shown(self.force_error)}, "
            f"{_shown(math.degrees(self.angle_error))}°, {_shown(1e3 * self.end_distance)} mm>"
        )


@dataclass(frozen=True)
class _Family:
    """Laws of a program: its parameters from semi-axes and their angle; a law of its own or none.

    `sizes` is 1 where there is one coefficient; `turns` whether the axes can be turned.
    """

    parameters: Callable[[float, float, float], dict[str, Any]]
    sizes: int = 2
    turns: bool = False
    sets: Callable[..., tuple[StarSet, StarSet]] | None = None

    def of(
        self, law: FrictionLaw, target: str, found: Array | Sequence[float]
    ) -> tuple[dict[str, Any], FrictionLaw]:
        """Return parameters and their law, which is made from another one."""
        a, b, angle = self.axes(found)
        given = self.parameters(a, b, angle)
        if self.sets is None:
            reservoir, direction, report, _ = engines.translated(target, given)
        else:
            (reservoir, direction), report = self.sets(**given), None
        return given, law.replace(reservoir=reservoir, direction=direction, report=report)

    def axes(self, found: Array | Sequence[float]) -> tuple[float, float, float]:
        a = math.exp(found[0])
        b = math.exp(found[1]) if self.sizes == 2 else a
        # The angle of a nearly round law may go astray; half a turn changes nothing.
        angle = math.remainder(found[-1], math.pi) if self.turns else 0.0
        return a, b, angle if abs(angle) > _NOTHING else 0.0

    def starts(self, law: FrictionLaw) -> Iterator[list[float]]:
        radius = law.reservoir.radius(_PHI)
        if self.sizes == 1:
            yield [math.log(radius.mean())]
            return
        along = radius[: _PHI.size // 2]
        # Of a round set the first direction, whatever the rounding.
        largest = int((along > (1.0 - 1e-9) * along.max()).argmax()) if self.turns else 0
        quarter = (largest + _PHI.size // 4) % (_PHI.size // 2)
        sizes = [math.log(along[largest]), math.log(along[quarter])]
        yield [*sizes, float(_PHI[largest])] if self.turns else sizes


def _ellipse(mu_1: float, mu_2: float) -> tuple[StarSet, StarSet]:
    return Ellipse(mu_1, mu_2), Ellipse(mu_1, mu_2)


def _disk(**coefficients: float) -> tuple[StarSet, StarSet]:
    disk = Disk(next(iter(coefficients.values())))
    return disk, disk


def _two(a: float, b: float, _: float) -> dict[str, Any]:
    return {"mu_1": a, "mu_2": b}


def _btrigidbody(a: float, b: float, _: float) -> dict[str, Any]:
    return {"friction": a, "anisotropicFriction": (1.0, b / a, 1.0)}


def _bullet(cone: bool, a: float, b: float, _: float) -> dict[str, Any]:
    factors = 1.0, b / a, 1.0
    return {"lateralFriction": a, "anisotropicFriction": factors, "enableConeFriction": cone}


def _cardillo(solver: str, a: float, b: float, _: float) -> dict[str, Any]:
    return {"mu": a, "anisotropy": (1.0, b / a), "solver": solver}


def _one(name: str, a: float, *_: float) -> dict[str, Any]:
    return {name: a}


def _drake(a: float, *_: float) -> dict[str, Any]:
    return {"dynamic_friction": a, "static_friction": a}


def _lsdyna(a: float, *_: float) -> dict[str, Any]:
    return {"FS": a, "FD": a, "DC": 0.0}


def _dart(a: float, *_: float) -> dict[str, Any]:
    return {"mu": a, "solver": "NsgsFrictionSolver"}


def _exudyn(a: float, b: float, angle: float) -> dict[str, Any]:
    zone = {"dryFrictionProportionalZone": 1e-3}
    return {"dryFriction": (a, b), "dryFrictionAngle": angle, **zone}


def _mujoco(cone: str, a: float, b: float, _: float) -> dict[str, Any]:
    return {"friction": (a, b, 0.005, 1e-4, 1e-4), "cone": cone}


def _newton(a: float, *_: float) -> dict[str, Any]:
    return {"mu": a, "solver": "SolverXPBD"}


def _ode(a: float, b: float, _: float) -> dict[str, Any]:
    return {"mu": a, "mu2": b}


def _pyelastica(a: float, b: float, _: float) -> dict[str, Any]:
    return {"kinetic_mu_array": (a, a, b)}


def _rows(name: str, a: float, b: float, angle: float) -> dict[str, Any]:
    """Return the factor of the tangential rows whose law is an associated ellipse."""
    c, s = math.cos(angle), math.sin(angle)
    return {"mu": 1.0, name: np.diag([a, b]) @ np.array([[c, s], [-s, c]])}


# Of each program the laws that it has; the one that comes nearest is taken.
_FAMILIES: dict[str, tuple[_Family, ...]] = {
    "abaqus": (_Family(_two, sets=_ellipse),),
    # Of two coefficients its manual states the axes only.
    "ansys": (_Family(partial(_one, "MU"), sizes=1, sets=_disk),),
    "btrigidbody": (_Family(_btrigidbody),),
    "bullet": tuple(_Family(partial(_bullet, cone)) for cone in (True, False)),
    "cardillo": tuple(_Family(partial(_cardillo, one)) for one in ("Moreau", "BackwardEuler")),
    "dart": (_Family(_dart, sizes=1), _Family(partial(_one, "mu"), sizes=1)),
    "drake": (_Family(_drake, sizes=1),),
    "exudyn": (_Family(_exudyn, turns=True),),
    "lsdyna": (_Family(_lsdyna, sizes=1, sets=_disk),),
    "mujoco": tuple(_Family(partial(_mujoco, cone)) for cone in ("elliptic", "pyramidal")),
    "newton": (_Family(_newton, sizes=1),),
    "ode": (_Family(_ode),),
    "opensim": (_Family(partial(_one, "dynamic_friction"), sizes=1),),
    "physx": (_Family(partial(_one, "dynamic_friction"), sizes=1),),
    "pinocchio": (_Family(partial(_rows, "S"), turns=True),),
    "pyelastica": (_Family(_pyelastica),),
    "rapier": (_Family(partial(_one, "friction"), sizes=1),),
    "siconos": (_Family(partial(_rows, "H"), turns=True),),
    "yade": (_Family(lambda a, *_: {"frictionAngle": math.atan(a)}, sizes=1),),
}

TARGETS = tuple(_FAMILIES)
"""Programs to which laws can be exported."""


@cache
def _texts(target: str) -> dict[str, Any]:
    """Return template, its default words, sign of comments, and what is to be known of a target."""
    path = Path(__file__).with_name("export.toml")
    return {"close": "", **tomllib.loads(path.read_text(encoding="utf-8"))[target]}


def exported(law: FrictionLaw, target: str, *, notes: Sequence[str] = ()) -> LawExport:
    """Return a law in the words of another program, see `FrictionLaw.export`.

    Args:
        law: planar law.
        target: name of the program.
        notes: sentences on the law, which go into the text as comments.
    """
    target = engines.named(target, "to", TARGETS)
    if law.dimension != 2:
        raise DimensionError("law", f"must be planar, its dimension is {law.dimension}")
    rate, rest = law.rate, law.replace(rate=None)
    falls = rate is not None and 0.0 < rate.ratio < 1.0
    bare = rest
    if rate is not None and falls and target != "lsdyna":
        bare = rest.replace(reservoir=rest.reservoir.scaled(rate.ratio))
    parameters, there = _nearest(bare, target)
    if rate is not None and target == "lsdyna":
        decay = {"FD": rate.ratio * parameters["FS"], "DC": 1.0 / rate.speed}
        parameters, there = (
            parameters | decay,
            there.replace(rate=Stribeck(rate.speed, ratio=rate.ratio)),
        )
    elif rate is not None and falls and target == "drake":
        parameters = parameters | {"static_friction": parameters["static_friction"] / rate.ratio}
        there = there.replace(report=engines.translated(target, parameters).report)
    prices: dict[str, float | None] = _prices(law, there)
    own: FrictionLaw | None = there
    scale = _size(rest).max()
    if target == "ansys" and np.abs(_force(there) - _force(bare)).max() > _EXACT * scale:
        along = np.linalg.norm(bare.force(np.eye(2)), axis=1)
        parameters, own = dict(zip(("MU1", "MU2"), along.tolist(), strict=True)), None
        prices = dict.fromkeys(prices)
    known = _texts(target)
    version = known.get("version") or engines.known_of(target)["version"]
    report = own.report if own is not None else None
    deviation = ""
    if isinstance(report, EngineReport):
        deviation = report.deviation
        if report.end_error is not None:
            beside = 1e3 * report.end_error
            deviation += f" A path of 0.24 m ends up to {beside:.2g} mm beside that of its law."
    if rate is not None:
        notes = (*notes, _of_rate(rate, target))
    if own is not None:
        notes = (*notes, *_of_axes(bare, target, there))
    return LawExport(
        target,
        version,
        text=_text(target, version, parameters, prices, notes, deviation),
        law=own,
        parameters=parameters,
        **prices,
    )


def _nearest(law: FrictionLaw, target: str) -> tuple[dict[str, Any], FrictionLaw]:
    """Return parameters and law of a program that come nearest to a law without a rate factor."""
    from scipy.optimize import least_squares

    force, scale = _force(law), _size(law).max()
    best: tuple[float, dict[str, Any], FrictionLaw] | None = None
    for family in _FAMILIES[target]:

        def off(found: Array, family: _Family = family) -> Array:
            return np.asarray((_force(family.of(law, target, found)[1]) - force).ravel() / scale)

        for start in family.starts(law):
            found = least_squares(off, start, x_scale="jac")
            if best is None or found.cost < best[0]:
                best = found.cost, *family.of(law, target, found.x)
    assert best is not None
    return best[1:]


def _force(law: FrictionLaw) -> Array:
    """Return λ/λ_N over the direction of sliding, without the rate factor."""
    return law.replace(rate=None).force(unit_vectors(_PHI))


def _size(law: FrictionLaw) -> Array:
    return np.asarray(np.linalg.norm(_force(law), axis=1))


def _prices(law: FrictionLaw, there: FrictionLaw) -> dict[str, float | None]:
    """Return how far a law is from that of a program."""
    force, other = _force(law), _force(there)
    speeds = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, _SPEEDS) * np.linalg.norm(_LAUNCH)])
    factors = [np.ones(1) if one.rate is None else one.rate(speeds) for one in (law, there)]
    sizes = [
        factor[:, None] * np.linalg.norm(one, axis=1)
        for factor, one in zip(factors, (force, other), strict=True)
    ]
    cross = force[:, 0] * other[:, 1] - force[:, 1] * other[:, 0]
    # A force that falls to zero never stops a point.
    stops = law.rate is None or law.rate.ratio > 0.0
    ends = [_end(one if stops else one.replace(rate=None)) for one in (law, there)]
    return {
        "force_error": float(np.abs(sizes[0] - sizes[1]).max()),
        "angle_error": float(np.abs(np.arctan2(cross, (force * other).sum(axis=1))).max()),
        "end_distance": float(np.linalg.norm(ends[0] - ends[1])),
    }


def _of_rate(rate: Stribeck, target: str) -> str:
    """Return what becomes of the dependence on the speed."""
    if target == "lsdyna":
        exact = rate.shape == "exponential" and rate.exponent == 1.0 and rate.viscous == 0.0
        kept = "is that of" if exact else "becomes that of"
        return f"The dependence on the speed, {rate!r}, {kept} FS, FD and DC, which is in s/m here."
    said = f"The dependence on the speed is left out: {rate!r}."
    if rate.ratio == 1.0:
        return said
    if rate.ratio == 0.0:
        return (
            f"{said} Coefficients, and the end of a path, are those at rest; of fast sliding they "
            "fall to zero."
        )
    # Where the drop has come to so much of the limit.
    drop = _LEFT * rate.ratio / (1.0 - rate.ratio)
    over = (
        (-math.log(drop) if rate.shape == "exponential" else 1.0 / drop - 1.0)
        if drop < 1.0
        else 0.0
    )
    above = rate.speed * over ** (1.0 / rate.exponent)
    also = " mu_static counts in the continuous model only." if target == "drake" else ""
    return (
        f"{said} Coefficients are those of sliding, {rate.ratio:g} of those at rest, which hold to "
        f"{_LEFT:.0%} above {above:.2g} m/s; slower sliding and rest have more friction.{also}"
    )


def _of_axes(law: FrictionLaw, target: str, there: FrictionLaw) -> tuple[str, ...]:
    """Return what turning the contact would do, where the program does not turn its axes."""
    families = _FAMILIES[target]
    if any(one.turns for one in families) or max(one.sizes for one in families) == 1:
        return ()
    from scipy.optimize import minimize_scalar

    along = law.reservoir.radius(_PHI)
    about = float(_PHI[along.argmax()])
    found = minimize_scalar(
        lambda phi: -float(law.reservoir.radius(phi)),
        bounds=(about - _PHI[1], about + _PHI[1]),
        method="bounded",
        options={"xatol": _NOTHING},
    )
    angle = math.remainder(float(found.x), math.pi)
    turned = law.rotated(-angle)
    parameters, better = _nearest(turned, target)
    now, then = (
        float(np.abs(_force(one) - _force(other)).max())
        for one, other in ((law, there), (turned, better))
    )
    if now - then < max(0.5 * now, _WORTH * float(along.max())):
        return ()
    prices = _prices(turned, better)
    listed = ", ".join(f"{name} {_Words(value)}" for name, value in parameters.items())
    return (
        f"The axes of the law are turned by {math.degrees(angle):.3g}° from those of the contact: "
        f"if the contact's first axis is turned by that from e₁, {listed} differ by "
        f"{_priced(prices)}.",
    )


def _text(
    target: str,
    version: str,
    parameters: Mapping[str, Any],
    prices: Mapping[str, float | None],
    notes: Sequence[str],
    deviation: str,
) -> str:
    known = _texts(target)
    said = [*notes, f"For {target}, as found in {version}. {known['note']}"]
    force, angle, end = (prices[one] for one in ("force_error", "angle_error", "end_distance"))
    if force is None or angle is None or end is None:
        said.append(known["unknown"])
    else:
        said.append(
            f"Beside the law, forces differ by up to {_shown(force)} λ_N and "
            f"{_shown(math.degrees(angle))}°, the end of a path after a launch with "
            f"{np.linalg.norm(_LAUNCH):.3g} m/s by {_shown(1e3 * end)} mm."
        )
    if deviation:
        said.append(f"The program itself: {deviation}")
    lines = [line for one in said for line in textwrap.wrap(one, 90)]
    if known["close"]:
        # Comments of XML hold no two hyphens side by side.
        lines = [line.replace("--", "- -").replace("--", "- -") for line in lines]
    head = "".join(f"{known['comment']} {line}{known['close']}\n" for line in lines)
    words = {**known.get("words", {}), **parameters}
    text = known["text"] if force is not None else known["text_of_two"]
    return head + text.format(**{name: _Words(value) for name, value in words.items()})


def _priced(prices: Mapping[str, float | None]) -> str:
    force, angle, end = (
        prices[one] or 0.0 for one in ("force_error", "angle_error", "end_distance")
    )
    return f"{_shown(force)} λ_N, {_shown(math.degrees(angle))}° and {_shown(1e3 * end)} mm"


def _shown(value: float) -> str:
    """Return a number in three digits, rounding as 0."""
    return f"{value if value > 1e3 * _NOTHING else 0.0:.3g}"


class _Words:
    """A number or numbers as a template shows them: {mu}, {friction[0]}, {H}."""

    def __init__(self, value: Any) -> None:
        self._value = value

    def __getitem__(self, place: Any) -> _Words:
        return _Words(np.asarray(self._value)[int(place)])

    def __format__(self, kind: str) -> str:
        value = self._value
        if isinstance(value, bool):
            return str(int(value))
        if isinstance(value, str):
            return value
        if np.ndim(value) == 0:
            return f"{float(value):.9g}"
        return f"[{', '.join(f'{_Words(one)}' for one in value)}]"


def _end(law: FrictionLaw) -> Array:
    """Return where a point ends that is launched as in the sliding experiment."""
    least = 1.0 if law.rate is None else law.rate.ratio
    mean = least * law.reservoir.radius(_PHI).mean()
    step = _STEP * float(np.linalg.norm(_LAUNCH)) / (_GRAVITY * mean)
    one, none, rest = np.eye(2), np.zeros((2, 2)), np.zeros(2)
    contact: dict[str, Any] = dict.fromkeys(("gap", "normal_restitution"), 0.0)
    contact |= {"law": law._core, "direction": one, "velocity": rest, "normal_force": _GRAVITY}
    contact |= {"tangential_restitution": 0.0, "normal": None, "name": None}
    point = _core.LinearSystem(one, none, none, rest, [contact])
    start = (0.0, 0, None), rest, _LAUNCH, np.zeros((0, 16)), np.zeros((0, 3))
    run, failure = _core.simulate(
        point, step, _MOST_STEPS, *start, Auto()._core, 1e-10, _MOST_STEPS, True, True, None
    )
    if failure is not None:
        raise failure
    return np.asarray(run["end"]["q"])
