"""Bodies that fall freely beside others are clocks: no event elsewhere moves them.

And no gap closes unseen. What is expected is known in closed form: free fall, and the zeros of the
gaps of bodies that spin in flight.
"""

import asperity as asp
import asperity._core as _core
import numpy as np
import pytest
from profiles import counts
from scipy.optimize import brentq, minimize_scalar

GRAVITY = 9.81
LINE = asp.FrictionLaw.isotropic(0.3, dimension=1)
FLOOR = asp.Line()
NEGLIGIBLE = 1e-9
"""Way in m and time in s."""


# What was found first


# First impacts


class SpinningRod(asp.System):
    """The end of a rod above the floor, whose gap q₁ + ½ sin q₀ only its author knows."""

    dof = 2
    contacts = (asp.ContactLaw(LINE, normal_restitution=0.5),)

    def mass(self, q):
        return np.diag([0.08, 1.0])

    def forces(self, t, q, u):
        return np.array([0.0, -GRAVITY])

    def gap(self, t, q, contact):
        return q[1] + 0.5 * np.sin(q[0])

    def normal(self, t, q, contact):
        return np.array([0.5 * np.cos(q[0]), 1.0])

    def direction(self, t, q, contact):
        return np.array([[-0.5 * np.sin(q[0])], [0.0]])


def lowest_point(points):
    """The gap of the lowest of some points of a planar body with the coordinates (x, y, φ)."""
    x, y = np.array(points).T
    return lambda q: np.min(q[1] + np.outer(x, np.sin(q[2])) + np.outer(y, np.cos(q[2])), 0)


def eccentric_disks(q):
    ends = q[0] + 0.2 * np.cos(q[2]) - q[3] + 0.2 * np.sin(q[5])
    return np.hypot(ends, q[1] + 0.2 * np.sin(q[2]) - q[4] - 0.2 * np.cos(q[5])) - 0.35


def eccentric_pair(height, angle, speed, spin):
    """Two disks that turn about points off their centres; the upper one flies down."""
    upper = {"position": (0.0, height), "angle": angle, "velocity": (0.0, -speed)}
    disks = [
        asp.PlanarBody(1.0, inertia=0.05, angular_velocity=spin, **upper),
        asp.PlanarBody(1.0, inertia=0.05, position=(0.1, 0.0), angular_velocity=-0.7 * spin),
    ]
    centers = {"center": (0.2, 0.0), "other_center": (0.0, 0.2)}
    pair = asp.SphereSphere(0, radius=0.2, other=1, other_radius=0.15, law=LINE, **centers)
    return asp.RigidBodies(disks, pairs=[pair], gravity=(0, 0))


def spinning(rng):
    """A system in flight, its start, its accelerations and its least gap over the coordinates."""
    spin = 10 ** rng.uniform(0, 3) * rng.choice([-1, 1])
    height, speed, phi = rng.uniform(0.8, 3.0), rng.uniform(-3, 3), rng.uniform(0, 6.28)
    start = {"angle": phi, "angular_velocity": spin, "position": (0.0, height)}
    fall = np.array([0.0, -GRAVITY, 0.0])
    kind = rng.integers(5)
    if kind == 0:
        system = SpinningRod()
        q0, u0 = np.array([phi, height]), np.array([spin, speed])
        return system, q0, u0, np.array([0.0, -GRAVITY]), lambda q: q[1] + 0.5 * np.sin(q[0])
    if kind == 1:
        system = eccentric_pair(height, phi, abs(speed) + 1.0, spin)
        return system, system.q0, system.u0, np.zeros(6), eccentric_disks
    body = asp.PlanarBody(1.0, inertia=0.08, velocity=(0.0, speed), **start)
    if kind == 2:
        pairs = [asp.BoxPlane(0, half_sizes=(0.4, 0.2), plane=FLOOR, law=LINE)]
        points = [(a * 0.4, b * 0.2) for a in (-1, 1) for b in (-1, 1)]
    else:
        points = [(0.5, 0.0), (-0.5, 0.0)][: kind - 2]
        pairs = [asp.PointPlane(0, point=point, plane=FLOOR, law=LINE) for point in points]
    system = asp.RigidBodies([body], pairs=pairs, gravity=(0, -GRAVITY))
    return system, system.q0, system.u0, fall, lowest_point(points)


def first_zero(gap, flight, t_end, spin):
    """The first time at which a gap closes that swings with `spin` along a flight."""
    times = np.linspace(0.0, t_end, int(max(2000, 50 * t_end * spin)))
    values = gap(flight(times))
    closed = np.flatnonzero(values < 0)
    last = closed[0] if closed.size else times.size
    low = np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])) + 1

    def at(t):
        return float(gap(flight(np.array([t])))[0])

    for i in low[(low < last) & (values[low] < 1e-3)]:
        within = (times[i - 1], times[i + 1])
        least = minimize_scalar(at, bounds=within, method="bounded", options={"xatol": 1e-12})
        if least.fun < 0:
            return brentq(at, times[i - 1], least.x, xtol=1e-15)
    return brentq(at, times[last - 1], times[last], xtol=1e-15) if closed.size else None


@counts(40, 2000)
def test_no_impact_of_a_spinning_body_is_missed(count):
    rng = np.random.default_rng(11)
    for case in range(count):
        system, q0, u0, acceleration, gap = spinning(rng)
        tolerance = 10.0 ** -rng.integers(6, 13)

        def flight(t, q0=q0, u0=u0, a=acceleration):
            return q0[:, None] + np.outer(u0, t) + 0.5 * np.outer(a, t**2)

        if gap(flight(np.zeros(1)))[0] <= 0:
            continue
        options = {"t_end": 0.8, "tolerance": tolerance, "max_events": 10**6}
        motion = asp.integrate(system, q0=q0, u0=u0, sample_every=1e-2, **options)
        expected = first_zero(gap, flight, 0.8, np.abs(u0).max() + 10)
        found = next((e.time for e in motion.events if e.kind is asp.EventKind.IMPACT), None)
        assert (found is None) == (expected is None), case
        assert found is None or abs(found - expected) < NEGLIGIBLE, case
        assert gap(motion.q.T).min() > -NEGLIGIBLE, case


@pytest.mark.parametrize(
    ("height", "angle", "speed", "spin", "tolerance"),
    [
        (0.9055810192666398, 2.2520294212480514, 3.5892321869577906, -35.23785988733988, 1e-8),
        (0.9304680314373185, 0.21667713072504183, 1.2165013152119202, -47.16513655271601, 1e-9),
        (2.1926845681536955, 0.5224447957640868, 3.608745567879271, 20.907421174076376, 1e-6),
    ],
)
def test_spinning_disks_lift_off_where_all_that_accelerates_them_cancels(
    height, angle, speed, spin, tolerance
):
    """In flight without gravity, where the normal acceleration is rounding of curvature only."""
    system = eccentric_pair(height, angle, speed, spin)
    motion = asp.integrate(system, t_end=0.8, tolerance=tolerance)
    kinds = [event.kind for event in motion.events]
    assert kinds[0] is asp.EventKind.IMPACT
    assert asp.EventKind.OPEN in kinds
    assert eccentric_disks(motion.q.T).min() > -NEGLIGIBLE


class Ball(asp.System):
    """A ball above the floor whose gap is exact to `noise` only."""

    dof = 2
    contacts = (asp.ContactLaw(LINE, normal_restitution=0.5),)

    def __init__(self, noise):
        self.noise = noise

    def mass(self, q):
        return np.eye(2)

    def forces(self, t, q, u):
        return np.array([-GRAVITY, 0.0])

    def gap(self, t, q, contact):
        return q[0] + self.noise * (np.modf(abs(np.sin(1e7 * q[0]) * 43758.5))[0] - 0.5)

    def normal(self, t, q, contact):
        return np.array([1.0, 0.0])

    def direction(self, t, q, contact):
        return np.array([[0.0], [1.0]])


def test_noise_of_a_gap_ends_neither_bounces_nor_steps():
    first = np.sqrt(2.0 / GRAVITY)
    for noise in (0.0, 1e-13, 1e-11, 1e-9, 1e-8, 1e-7):
        motion = asp.integrate(Ball(noise), t_end=1.0, q0=[1.0, 0.0])
        times = [event.time for event in motion.events]
        assert times == pytest.approx([first, 2.0 * first], abs=1e-12 + noise), noise
        assert len(motion.t) < 20, noise


# Clocks


def signal(rng, size, components=None):
    """A function of time that starts at zero: a spline, straight lines or a sine."""
    size = size * (1.0 if components is None else np.array(components))
    kind = rng.integers(3)
    if kind == 2:
        return asp.Sine(rng.uniform(0.3, 1) * size, frequency=rng.uniform(0.2, 3))
    values = np.multiply.outer(rng.uniform(-1, 1, 6), size)
    values[0] = 0.0
    return asp.Signal(
        np.linspace(0, 1.3, 6), values, interpolation="cubic" if kind == 0 else "linear"
    )


def planar_clock(rng):
    velocity = (rng.uniform(-1, 1), 0.0)
    return asp.PlanarBody.disk(1.0, radius=0.05, position=(50.0, 100.0), velocity=velocity)


def spatial_clock(rng):
    velocity = (rng.uniform(-1, 1), 0.0, 0.0)
    return asp.Body(1.0, inertia=[0.01] * 3, position=(50.0, 0.0, 100.0), velocity=velocity)


def spatial_law(rng):
    mu = rng.uniform(0.3, 1.0)
    if rng.random() < 0.5:
        return asp.FrictionLaw.isotropic(mu)
    return asp.FrictionLaw(asp.Ellipse(mu, 0.7 * mu), asp.Ellipse(1.0, 0.5))


def box_on_a_moving_line(rng):
    half, kind = rng.uniform(0.05, 0.2, 2), rng.integers(3)
    moves = {
        "rotation": None if kind == 0 else signal(rng, 0.15),
        "displacement": None if kind == 1 else signal(rng, 0.02, (1, rng.choice([0, 1]))),
    }
    table = asp.Line(motion=asp.PlaneMotion(**moves))
    law = asp.FrictionLaw.isotropic(rng.uniform(0.2, 1.0), dimension=1)
    box = asp.PlanarBody.box(1.0, half_sizes=half, position=(rng.uniform(-0.3, 0.3), half[1]))
    restitution = float(rng.choice([0.0, 0.0, 0.3]))
    pair = asp.BoxPlane(0, half_sizes=half, plane=table, law=law, normal_restitution=restitution)
    return asp.RigidBodies([box, planar_clock(rng)], pairs=[pair], gravity=(0, -GRAVITY))


def boxes_in_flight(rng):
    bodies, pairs = [], []
    for i in range(rng.integers(1, 4)):
        spin = 10 ** rng.uniform(0, 3) * rng.choice([-1, 1])
        half = rng.uniform(0.1, 0.4, 2)
        start = {"position": (3.0 * i, rng.uniform(0.7, 2.5)), "angle": rng.uniform(0, 6)}
        bodies.append(
            asp.PlanarBody.box(
                1.0,
                half_sizes=half,
                velocity=tuple(rng.uniform(-2, 2, 2)),
                angular_velocity=spin,
                **start,
            )
        )
        restitution = float(rng.choice([0.0, 0.3, 0.7]))
        pairs.append(
            asp.BoxPlane(i, half_sizes=half, plane=FLOOR, law=LINE, normal_restitution=restitution)
        )
    return asp.RigidBodies([*bodies, planar_clock(rng)], pairs=pairs, gravity=(0, -GRAVITY))


def pile(rng):
    radius, count, restitution = 0.1, int(rng.integers(2, 5)), float(rng.choice([0.0, 0.5]))
    places = [(0.03 * rng.uniform(-1, 1), radius + 0.001 + 0.25 * i) for i in range(count)]
    bodies = [asp.PlanarBody.disk(1.0, radius=radius, position=place) for place in places]
    common = {"radius": radius, "law": LINE, "normal_restitution": restitution}
    pairs = [asp.SpherePlane(i, plane=FLOOR, **common) for i in range(count)] + [
        asp.SphereSphere(i, other=j, other_radius=radius, **common)
        for i in range(count)
        for j in range(i)
    ]
    return asp.RigidBodies([*bodies, planar_clock(rng)], pairs=pairs, gravity=(0, -GRAVITY))


def box_on_a_moving_plane(rng):
    half = rng.uniform(0.05, 0.2, 3)
    match rng.integers(3):
        case 0:
            plane = asp.Plane(spin=signal(rng, 1.5))
        case 1:
            plane = asp.Plane(motion=asp.PlaneMotion(rotation=signal(rng, 0.1, (1, 0.5, 0))))
        case _:
            shift = signal(rng, 0.02, (1, 0.5, rng.choice([0, 1])))
            plane = asp.Plane(motion=asp.PlaneMotion(displacement=shift))
    box = asp.Body.box(1.0, half_sizes=half, position=(rng.uniform(-0.1, 0.1), 0.0, half[2]))
    pair = asp.BoxPlane(0, half_sizes=half, plane=plane, law=spatial_law(rng))
    return asp.RigidBodies([box, spatial_clock(rng)], pairs=[pair], gravity=(0, 0, -GRAVITY))


def box_in_flight(rng):
    half, axis = rng.uniform(0.1, 0.3, 3), rng.normal(size=3)
    spin = 10 ** rng.uniform(0, 3) * axis / np.linalg.norm(axis)
    box = asp.Body.box(
        1.0,
        half_sizes=half,
        position=(0.0, 0.0, rng.uniform(0.7, 1.5)),
        velocity=tuple(rng.uniform(-1, 1, 3)),
        angular_velocity=tuple(spin),
    )
    restitution = float(rng.choice([0.3, 0.6]))
    pair = asp.BoxPlane(
        0, half_sizes=half, plane=asp.Plane(), law=spatial_law(rng), normal_restitution=restitution
    )
    return asp.RigidBodies([box, spatial_clock(rng)], pairs=[pair], gravity=(0, 0, -GRAVITY))


@counts(25, 3000)
def test_clocks_are_right_and_nothing_sinks_in(count):
    scenes = (box_on_a_moving_line, box_on_a_moving_plane, boxes_in_flight, pile, box_in_flight)
    rng = np.random.default_rng(7)
    for case in range(count):
        scene = scenes[rng.integers(len(scenes))]
        system, tolerance = scene(rng), 10.0 ** -rng.integers(6, 13)
        options = {"t_end": 0.6, "sample_every": 0.005, "max_events": 20_000}
        motion = asp.integrate(system, tolerance=tolerance, **options)
        height = len(system.q0) - (2 if system.planar else 5)
        fallen = motion.q[:, height] - (100.0 - 0.5 * GRAVITY * motion.t**2)
        assert np.abs(fallen).max() < NEGLIGIBLE, (case, scene.__name__, tolerance)
        for t, q in zip(motion.t, motion.q, strict=True):
            overlap = _core.deepest_overlap(system._core, t, q)
            assert overlap is None or overlap[1] > -NEGLIGIBLE, (case, scene.__name__, tolerance)
