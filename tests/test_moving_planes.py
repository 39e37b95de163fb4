"""Shaken tables, accelerating belts and conveyors, against integrations without our code."""

import numpy as np
import pytest
from asperity import (
    Body,
    BoxPlane,
    DimensionError,
    Ellipse,
    EventKind,
    FrictionLaw,
    Line,
    ParameterError,
    PlanarBody,
    Plane,
    PlaneMotion,
    PointPlane,
    RigidBodies,
    Signal,
    Sine,
    SpherePlane,
    equilibrium,
    integrate,
    limit_cycle,
    simulate,
)
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

G = 9.81
SLIPPERY = FrictionLaw.isotropic(0.3, dimension=1)


def check(system, known, t_end, *, order=1, factor, steps=(4e-3, 1e-3, 2.5e-4), tolerance=1e-8):
    """Compare coordinates and velocities at `t_end`: those of both integrators with known ones."""
    motion = integrate(system, t_end=t_end)
    found = np.concatenate([motion.q[-1], motion.u[-1]])
    np.testing.assert_allclose(found, known, rtol=0.0, atol=tolerance)
    for dt in steps:
        run = simulate(system, dt=dt, t_end=t_end)
        found = np.concatenate([run.q[-1], run.u[-1]])
        np.testing.assert_allclose(found, known, rtol=0.0, atol=factor * dt**order)
    return motion


# Belts.


def box_on(line, law=SLIPPERY):
    body = PlanarBody.box(1.0, half_sizes=(0.1, 0.1), position=(0.0, 0.1))
    return RigidBodies([body], pairs=[BoxPlane(0, half_sizes=(0.1, 0.1), plane=line, law=law)])


def slides(t_end, belt, semi_axes, normal_force, u0=(0.0, 0.0)):
    """A point of 1 kg slides by an associated elliptic law: −λ = A² γ/‖A γ‖ λ_N, γ = u − v."""
    a = np.array(semi_axes)

    def rate(t, state):
        slip = state[2:] - belt(t)
        return [*state[2:], *(-(a**2) * slip / np.linalg.norm(a * slip) * normal_force(t))]

    solution = solve_ivp(
        rate, (0.0, t_end), [0.0, 0.0, *u0], method="DOP853", rtol=1e-12, atol=1e-14
    )
    return solution.y[:, -1]


def point_on(plane, law, **state):
    body = Body(1.0, inertia=[1.0, 1.0, 1.0], **state)
    return RigidBodies([body], pairs=[PointPlane(0, point=(0.0, 0.0, 0.0), plane=plane, law=law)])


def of_point(q, u):
    """Coordinates and velocities of a body that does not turn."""
    return np.concatenate([q, [1.0, 0.0, 0.0, 0.0], u, np.zeros(3)])


@pytest.mark.parametrize(
    "belt",
    [
        Signal(
            [0.0, 0.3, 0.7, 1.0],
            [[1.0, 0.5], [2.0, 0.0], [2.5, -0.7], [4.0, 0.3]],
            interpolation="cubic",
        ),
        Sine([1.0, 1.5], frequency=2.0, phase=[0.0, 1.5], offset=[4.0, 0.0]),
    ],
    ids=["spline", "sine"],
)
def test_an_anisotropic_point_on_a_belt_that_changes_its_velocity(belt):
    semi_axes = (0.5, 0.2)
    law = FrictionLaw.associated(Ellipse(*semi_axes))
    x, y, vx, vy = slides(0.8, belt, semi_axes, lambda t: G)
    known = of_point([x, y, 0.0], [vx, vy, 0.0])
    check(point_on(Plane(velocity=belt), law), known, 0.8, factor=2.0, tolerance=1e-9)


# Shaken tables.


def shaker(amplitude, frequency):
    """Up and down from rest: d = A (1 − cos ωt)."""
    return Sine(
        [0.0, amplitude], frequency=frequency, phase=[0.0, -np.pi / 2], offset=[0.0, amplitude]
    )


def hops(table, e, t_end):
    """Height and velocity of a point on a shaken table: rest, flight, impact in closed form."""
    p, v, a = (
        lambda t, i=i: (table(t) if i == 0 else table.derivative(t, order=i))[1] for i in range(3)
    )
    t, rests, y, w, hits = 0.0, True, 0.0, 0.0, 0
    grid = 1e-4

    def fall(s, t0, y0, w0):
        return y0 + w0 * (s - t0) - 0.5 * G * (s - t0) ** 2

    def root(f, start):
        ends = start + grid * np.arange(1.0, 20000.0)
        values = np.array([f(end) for end in ends[ends < t_end + 2 * grid]])
        k = int(np.argmax(values < 0.0))
        if not values[k] < 0.0:
            return np.inf
        return brentq(f, max(ends[k] - grid, start + 1e-9), ends[k], xtol=1e-15, rtol=1e-15)

    while True:
        if rests:
            end = root(lambda s: a(s) + G, t)
            if end >= t_end:
                return p(t_end), v(t_end), hits
            t, y, w, rests = end, p(end), v(end), False
        t0, y0, w0 = t, y, w
        end = root(lambda s, o=(t, y, w): fall(s, *o) - p(s), t)
        if end >= t_end:
            return fall(t_end, t0, y0, w0), w0 - G * (t_end - t0), hits
        t, y, w, hits = end, p(end), v(end) - e * (w0 - G * (end - t0) - v(end)), hits + 1
        rests = e == 0.0 and a(end) > -G


@pytest.mark.parametrize(
    ("amplitude", "e", "t_end"),
    [(4e-3, 0.0, 0.5), (9e-3, 0.0, 0.5), (4e-3, 0.6, 0.22), (9e-3, 0.6, 0.5)],
)
def test_parts_hop_on_a_shaken_table(e, t_end, amplitude):
    table = shaker(amplitude, 10.0)
    y, v, hits = hops(table, e, t_end)
    assert hits >= 2
    law = FrictionLaw.isotropic(0.3, dimension=1)
    line = Line(motion=PlaneMotion(displacement=table))
    ball = PlanarBody.disk(1.0, radius=0.1, position=(0.0, 0.1))
    system = RigidBodies(
        [ball], pairs=[SpherePlane(0, radius=0.1, plane=line, law=law, normal_restitution=e)]
    )
    known = [0.0, 0.1 + y, 0.0, 0.0, v, 0.0]
    # An impact that comes late by a step changes the velocity by that of the table in it.
    factor = 60.0 if e == 0.0 else 200.0
    motion = check(system, known, t_end, factor=factor, steps=(4e-4, 1e-4, 2.5e-5))
    assert sum(event.kind == EventKind.IMPACT for event in motion.events) == hits


@pytest.mark.parametrize("e", [0.0, 0.5])
def test_a_table_that_moves_with_kinks_strikes_what_lies_on_it(e):
    # Rests, rises with 0.5 m/s, and rests again.
    table = Signal([0.1, 0.3], [[0.0, 0.0], [0.0, 0.1]], interpolation="linear")
    line = Line(motion=PlaneMotion(displacement=table))
    ball = PlanarBody.disk(1.0, radius=0.1, position=(0.0, 0.1))
    pair = SpherePlane(0, radius=0.1, plane=line, law=SLIPPERY, normal_restitution=e)
    system = RigidBodies([ball], pairs=[pair])
    t_end = 0.35
    if e == 0.0:
        known, speed = 0.1 + 0.5 * 0.05 - 0.5 * G * 0.05**2, 0.5 - G * 0.05
    else:
        # Over the table with 1.5 of its velocity, back after the table has come to rest or before.
        back = 2.0 * 0.25 / G
        relative, t, first = 0.25, 0.1, True
        while t + 2.0 * relative / G < 0.3:
            t, relative, first = t + 2.0 * relative / G, 0.5 * relative, False
            if relative < 1e-13:
                break
        assert back < 0.2
        assert not first
        # The bounces end before the table stops, which then throws the ball.
        known, speed = 0.1 + 0.5 * 0.05 - 0.5 * G * 0.05**2, 0.5 - G * 0.05
    motion = integrate(system, t_end=t_end)
    assert motion.q[-1, 1] == pytest.approx(0.1 + known, abs=1e-8)
    assert motion.u[-1, 1] == pytest.approx(speed, abs=1e-8)
    kinks = [event.time for event in motion.events if event.kind == EventKind.KINK]
    assert kinks == [0.1, 0.3]
    for dt in (1e-3, 1e-4):
        run = simulate(system, dt=dt, t_end=t_end)
        assert run.q[-1, 1] == pytest.approx(0.1 + known, abs=2.0 * dt)


# Tables that turn.


@pytest.mark.parametrize(
    "angle",
    [
        Sine(0.2, frequency=1.5),
        Signal([0.0, 0.3, 0.8, 1.0], [0.0, 0.2, -0.1, 0.0], interpolation="cubic"),
    ],
    ids=["sine", "spline"],
)
def test_a_block_rides_on_a_rocking_table(angle):
    rate = angle.derivative(0.0)
    line = Line(point=(0.3, -0.2), motion=PlaneMotion(rotation=angle))
    place = np.array([0.15, 0.05])
    body = PlanarBody.box(
        1.0, half_sizes=(0.2, 0.05), position=place + line.point,
        velocity=rate * np.array([-place[1], place[0]]), angular_velocity=rate,
    )  # fmt: skip
    system = RigidBodies(
        [body],
        pairs=[
            BoxPlane(
                0, half_sizes=(0.2, 0.05), plane=line, law=FrictionLaw.isotropic(2.0, dimension=1)
            )
        ],
    )
    t = 0.9
    c, s, w = np.cos(angle(t)), np.sin(angle(t)), angle.derivative(t)
    arm = np.array([[c, -s], [s, c]]) @ place
    known = [*(arm + line.point), angle(t), -w * arm[1], w * arm[0], w]
    motion = check(system, known, t, factor=0.2)
    assert not any(event.kind == EventKind.OPEN for event in motion.events)
    ends = system.contact_points(simulate(system, dt=1e-3, t_end=t))[-1]
    heights = (ends - line.point) @ [-s, c]
    np.testing.assert_allclose(heights[:2], 0.0, atol=1e-6)


@pytest.mark.parametrize(
    "angle",
    [
        Sine(0.2, frequency=1.5),
        Signal([0.0, 0.3, 0.8, 1.0], [0.0, 0.2, -0.1, 0.0], interpolation="cubic"),
    ],
    ids=["sine", "spline"],
)
def test_a_block_that_sticks_drifts_to_second_order(angle):
    """Two corners have the same rows: if one counted as sliding, drift would be of first order."""
    rate = angle.derivative(0.0)
    line = Line(motion=PlaneMotion(rotation=angle))
    place = np.array([0.15, 0.05])
    body = PlanarBody.box(
        1.0, half_sizes=(0.2, 0.05), position=place,
        velocity=rate * np.array([-place[1], place[0]]), angular_velocity=rate,
    )  # fmt: skip
    system = RigidBodies(
        [body],
        pairs=[
            BoxPlane(
                0,
                half_sizes=(0.2, 0.05),
                plane=line,
                law=FrictionLaw.isotropic(2.0, dimension=1),
            )
        ],
    )
    along = np.array([np.cos(angle(0.9)), np.sin(angle(0.9))])

    def drift(dt):
        return simulate(system, dt=dt, t_end=0.9).q[-1, :2] @ along - place[0]

    drifts = [drift(dt) for dt in (2e-3, 1e-3, 5e-4)]
    np.testing.assert_allclose(drifts[0] / drifts[1], 4.0, rtol=0.05)
    np.testing.assert_allclose(drifts[1] / drifts[2], 4.0, rtol=0.05)


# Conveyors.


# The same physics written down differently.


def test_a_plane_of_a_body_moves_in_the_axes_of_the_body():
    # A tray on a heavy carriage that runs and turns: as if the world's plane did both.
    lift = Sine([0.0, 2e-3], frequency=5.0)
    carriage = PlanarBody(1e9, inertia=1e9, velocity=(0.7, 0.0), position=(0.0, 0.0))
    rider = PlanarBody.box(
        1.0, half_sizes=(0.1, 0.1), position=(0.0, 0.1), velocity=(0.7, lift.derivative(0.0)[1])
    )
    pairs = [
        BoxPlane(
            1,
            half_sizes=(0.1, 0.1),
            plane=Line(body=0, motion=PlaneMotion(displacement=lift)),
            law=SLIPPERY,
        )
    ]
    system = RigidBodies([carriage, rider], pairs=pairs, gravity=(0.0, 0.0))
    pressed = system.replace(bodies=[carriage, rider.replace(force=(0.0, -G))])
    motion = integrate(pressed, t_end=0.43)
    np.testing.assert_allclose(motion.q[-1, 3:], [0.7 * 0.43, 0.1 + lift(0.43)[1], 0.0], atol=1e-7)
    run = simulate(pressed, dt=1e-3, t_end=0.43)
    np.testing.assert_allclose(run.q[-1, 3:], motion.q[-1, 3:], atol=1e-5)


# What is said.


@pytest.mark.parametrize(
    ("make", "error", "argument"),
    [
        (lambda: PlaneMotion(displacement=(0.0, 0.0)), ParameterError, "displacement"),
        (
            lambda: PlaneMotion(
                displacement=Signal([0, 1, 1, 2], [0.0, 0.0, 1.0, 1.0], interpolation="linear")
            ),
            ParameterError,
            "displacement",
        ),
        (
            lambda: PlaneMotion(
                rotation=Signal([0.0, 1.0], [0.0, 1.0], interpolation="linear", periodic=True)
            ),
            ParameterError,
            "rotation",
        ),
        (lambda: Plane(motion=Sine(1.0, frequency=1.0)), ParameterError, "motion"),
        (
            lambda: Plane(motion=PlaneMotion(displacement=Sine([0.0, 1.0], frequency=1.0))),
            DimensionError,
            "displacement",
        ),
        (
            lambda: Line(motion=PlaneMotion(rotation=Sine([0.0, 1.0, 0.0], frequency=1.0))),
            DimensionError,
            "rotation",
        ),
        (lambda: Line(velocity=Sine([1.0], frequency=1.0)), DimensionError, "velocity"),
        (lambda: Plane(spin=Sine([1.0], frequency=1.0)), DimensionError, "spin"),
    ],
)
def test_arguments_are_checked(make, error, argument):
    with pytest.raises(error) as raised:
        make()
    assert raised.value.argument == argument


@pytest.mark.parametrize(
    ("function", "error"),
    [
        (lambda t: np.zeros(2), DimensionError),
        (lambda t: 1.0, ParameterError),
        (lambda t: (np.zeros(2), np.zeros(3)), DimensionError),
        (lambda t: (np.zeros(2), [np.nan, 0.0]), ParameterError),
        (lambda t: [][0], IndexError),
    ],
)
def test_what_is_wrong_with_a_function_is_said(function, error):
    system = box_on(Line(motion=PlaneMotion(displacement=function)))
    for run in (lambda: simulate(system, dt=0.01, t_end=1.0), lambda: integrate(system, t_end=1.0)):
        with pytest.raises(error) as raised:
            run()
        if error is not IndexError:
            assert raised.value.argument == "displacement"


def test_analyses_of_one_instant_refuse_what_depends_on_time():
    system = box_on(Line(velocity=Sine(1.0, frequency=1.0, offset=2.0)))
    with pytest.raises(ParameterError, match="depends on time"):
        equilibrium(system)
    with pytest.raises(ParameterError, match="depend on time"):
        limit_cycle(system)


def carried(**motion):
    """A body on a line that a function of the user moves."""
    line = Line(motion=PlaneMotion(**motion))
    pair = PointPlane(0, point=(0.0, 0.0), plane=line, law=FrictionLaw.isotropic(0.3, dimension=1))
    return RigidBodies([PlanarBody(1.0, inertia=1.0)], pairs=[pair], gravity=(0.0, -9.81))


def run_either(name, system, t_end):
    return (
        simulate(system, dt=1e-3 * t_end, t_end=t_end)
        if name == "simulate"
        else integrate(system, t_end=t_end)
    )


@pytest.mark.parametrize("run", ["simulate", "integrate"])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("factor", [0.0, -1.0, 2.0])
def test_rates_that_contradict_their_values_are_refused(run, scale, factor):
    def shaken(t):
        return [0.3 * np.sin(t / scale), 0.0], [factor * 0.3 / scale * np.cos(t / scale), 0.0]

    def tipping(t):
        return 1e-3 * np.sin(t / scale), factor * 1e-3 / scale * np.cos(t / scale)

    for argument, function in (("displacement", shaken), ("rotation", tipping)):
        with pytest.raises(ParameterError, match="contradict") as raised:
            run_either(run, carried(**{argument: function}), 0.1 * scale)
        assert raised.value.argument == argument
