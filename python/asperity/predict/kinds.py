"""The kinds of scenarios: what their motions are asked for, and an example of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.runs import Motion, Trajectory
from asperity.runs.run import Run
from asperity.status import Phase
from asperity.system import MassOnBelt, RigidBodies, SlidingDisk, SlidingPoint
from asperity.system.rigid import rotation

REST = "time until rest"


class Quantity(NamedTuple):
    """A number that a scenario is asked for."""

    name: str
    unit: str
    value: float


class Course(NamedTuple):
    """Samples of a motion, or its start and its end alone.

    Attributes:
        t: times in s.
        q: coordinates, ``(n_t, n_q)``.
        phase: of the contacts, ``(n_t, n_contact)``.
        rest: time in s from which on nothing slides; None if something does at the end.
        slipped: number of time steps in which something slid; None if they were not counted.
    """

    t: Array
    q: Array
    phase: NDArray[np.int8]
    rest: float | None
    slipped: int | None = None

    @classmethod
    def of_run(cls, run: Run, *, by_events: bool = True) -> Course:
        """Return the course of a run; a motion rests since an event, if these may say so."""
        found = cls.of(run.t, run.q, run.phase)
        if isinstance(run, Trajectory):
            slipped = int(run.phase_counts[:, Phase.SLIP].max(initial=0))
            return found._replace(slipped=slipped)
        if not by_events or not isinstance(run, Motion) or found.rest is None:
            return found
        before = run.t[run.t < found.rest].max(initial=run.t[0])
        times = [one.time for one in run.events if before <= one.time <= found.rest]
        return found._replace(rest=max(times, default=found.rest))

    @classmethod
    def of(cls, t: Array, q: Array, phase: NDArray[np.int8]) -> Course:
        """Return the course of samples: it rests since no contact slides and one sticks."""
        resting = (phase == Phase.STICK).any(axis=1) & ~(phase == Phase.SLIP).any(axis=1)
        # The first sample of a run of time stepping has no phase.
        moving = np.flatnonzero(~resting)
        since = moving[-1] + 1 if moving.size else 0
        return cls(t, q, phase, float(t[since]) if since < len(t) else None)


@dataclass(frozen=True)
class ScenarioKind:
    """A kind of scenario.

    Attributes:
        name: for people.
        system: class of the systems.
        meaning: a sentence.
        paths: positions of what moves in m by name, ``(n_t, 2 or 3)``, given the system and q.
        quantities: what a motion is asked for; the first two are the end point if `has_end`.
        needs: ``"samples"`` of a course, ``"rest"`` and ends, or ``"end"``.
        has_end: whether the motion is asked for the point of the plane in which it comes to rest.
        example: text of a file of this kind.
    """

    name: str
    system: type
    meaning: str
    paths: Callable[[Any, Array], dict[str, Array]]
    quantities: Callable[[Any, Course], Sequence[Quantity]]
    needs: str
    has_end: bool
    example: str


def _end_point(path: Array, course: Course) -> list[Quantity]:
    """Return where a path of the plane ends, how far from its start, in which direction, when.

    The time of a path that does not come to rest is that of its end.
    """
    first, last = path[0, :2], path[-1, :2]
    way = last - first
    angle = float(np.rad2deg(np.arctan2(way[1], way[0])))
    rest = float(course.t[-1]) if course.rest is None else course.rest
    return [
        Quantity("end point e1", "m", float(last[0])),
        Quantity("end point e2", "m", float(last[1])),
        Quantity("distance of the end point from the start", "m", float(np.hypot(*way))),
        Quantity("direction of the end point", "deg", angle),
        Quantity(REST, "s", rest),
    ]


def _disk(_: SlidingDisk, course: Course) -> list[Quantity]:
    first, last = rotation.matrices(course.q[[0, -1], 3:7])
    turned = last @ first.T
    angle = float(np.rad2deg(np.arctan2(turned[1, 0], turned[0, 0])))
    words = "angle turned about the vertical, up to whole turns"
    return [*_end_point(course.q, course), Quantity(words, "deg", angle)]


def _belt(_: MassOnBelt, course: Course) -> list[Quantity]:
    late = course.t >= 0.5 * (course.t[0] + course.t[-1])
    q, stuck = course.q[late], course.phase[late, 0] == Phase.STICK
    # A sample has the phase of the time before it; events make samples of unequal distance.
    spans = np.diff(course.t[late])
    extremes = [
        Quantity(f"{word} of q{i + 1} in the second half", "m", float(extreme(q[:, i])))
        for i in range(2)
        for word, extreme in (("smallest", np.min), ("largest", np.max))
    ]
    share = float(spans @ stuck[1:] / spans.sum())
    return [*extremes, Quantity("share of stick in the second half", "", share)]


def _centres(system: RigidBodies, q: Array) -> dict[str, Array]:
    space = len(system.gravity)
    each = q.reshape(len(q), len(system.bodies), -1)[..., :space]
    return {name: each[:, i] for i, name in enumerate(system.body_names)}


def _ends(system: RigidBodies, course: Course) -> list[Quantity]:
    return [
        Quantity(f"end of {name}, {axis}", "m", float(value))
        for name, path in _centres(system, course.q).items()
        for axis, value in zip("xyz", path[-1], strict=False)
    ]


_LAW = """\
law = "law.toml"            # written by `asperity identify`, or by hand
"""
_PLANE = """\
# Lengths are in m, times in s, masses in kg, forces in N. The axes e1, e2 are those of the
# friction law, angles are counter-clockwise from e1.
"""


def _tail(duration: str, step: str, until_rest: bool, samples: int) -> str:
    ending = "until_rest = true           # end when it rests\n" if until_rest else ""
    return f"""
[run]
duration = {duration:<16} # s{", at most" if until_rest else ""}
step = {step:<20} # s
{ending}
[bands]                     # for --bands: what the uncertainty of the law means for the motion
samples = {samples:<17} # laws that are drawn
confidence = 0.95
seed = 1
"""


KINDS = {
    kind.name: kind
    for kind in (
        ScenarioKind(
            "sliding point",
            SlidingPoint,
            "a point mass that slides on a horizontal plane until it rests",
            lambda _, q: {"point": q},
            lambda _, course: _end_point(course.q, course),
            "rest",
            True,
            f"""\
# A part of 18 g that is pushed along a surface and slides until it rests.
{_PLANE}{_LAW}
[system]
type = "SlidingPoint"
mass = 0.018                # kg
gravity = 9.81              # m/s2, presses the part on the plane

[start]
position = [0.0, 0.0]       # m
speed = 1.52                # m/s
direction_deg = 32.0        # or, instead of both, velocity = [1.29, 0.81]
{_tail("1.0", "1e-4", True, 400)}""",
        ),
        ScenarioKind(
            "sliding disk",
            SlidingDisk,
            "a disk on three pads that slides on a horizontal plane and may spin",
            lambda _, q: {"disk": q[:, :2]},
            _disk,
            "samples",
            True,
            f"""\
# A disk on three pads that is launched along a surface and slides until it rests.
{_PLANE}{_LAW}
[system]
type = "SlidingDisk"
mass = 0.018                # kg
diameter = 0.028            # m
height = 0.013              # m
pad_circle = 0.021          # m, diameter of the circle on which the three pads are
pad_height = 0.001          # m
spin = 0.0                  # rad/s about the vertical
angle = 0.0                 # rad, of the first pad

[start]
position = [0.0, 0.0]       # m
speed = 1.52                # m/s
direction_deg = 32.0        # or, instead of both, velocity = [1.29, 0.81]
{_tail("1.0", "1e-4", True, 200)}""",
        ),
        ScenarioKind(
            "mass on belt",
            MassOnBelt,
            "a mass that springs hold on a moving belt: does it slide steadily, or stick and slip?",
            lambda _, q: {"mass": q},
            _belt,
            "samples",
            False,
            f"""\
# A mass that springs hold on a moving belt.
{_PLANE}{_LAW}
[system]
type = "MassOnBelt"
mass = 1.0                  # kg
stiffness = 100.0           # N/m, or [[100.0, 0.0], [0.0, 200.0]] along e1 and e2
normal_force = 10.0         # N
belt_velocity = [0.064, 0.077] # m/s

[start]
position = [0.0, 0.0]       # m, 0 where the springs are relaxed
velocity = [0.0, 0.0]       # m/s
{_tail("20.0", "1e-3", False, 100)}""",
        ),
        ScenarioKind(
            "rigid bodies",
            RigidBodies,
            "boxes, balls and cylinders that slide, roll, tip and hop on planes",
            _centres,
            _ends,
            "end",
            False,
            f"""\
# A box and a ball that slide and roll on a plane.
# Lengths are in m, times in s, masses in kg; x and y are horizontal, z points up.
{_LAW}
[system]
type = "RigidBodies"
gravity = [0.0, 0.0, -9.81] # m/s2

[[system.bodies]]
type = "Body.box"
name = "box"
mass = 1.0                  # kg
half_sizes = [0.05, 0.05, 0.02] # m
position = [0.0, 0.0, 0.02] # m, of the centre of mass
orientation = [0.984807753, 0.0, 0.0, 0.173648178] # quaternion: 20 degrees about z
velocity = [1.0, 0.5, 0.0]  # m/s

[[system.bodies]]
type = "Body.ball"
name = "ball"
mass = 0.5                  # kg
radius = 0.03               # m
position = [0.0, 0.3, 0.03]
velocity = [1.0, 0.0, 0.0]

[[system.pairs]]
type = "BoxPlane"
body = 0                    # the box, bodies count from 0
half_sizes = [0.05, 0.05, 0.02]
plane = {{type = "Plane", axis = [1.0, 0.0, 0.0]}} # through the origin; axis is e1 of the law

[[system.pairs]]
type = "SpherePlane"
body = 1
radius = 0.03
plane = {{type = "Plane"}}
{_tail("1.0", "1e-3", False, 50)}""",
        ),
    )
}
"""By their names."""
