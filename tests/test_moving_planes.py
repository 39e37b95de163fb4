"""Shaken tables, accelerating belts and conveyors, against integrations without our code."""

import pickle

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
    Phase,
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
from scipy.spatial.transform import Rotation

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


@pytest.mark.parametrize("acceleration", [2.0, 5.0])
def test_a_block_on_a_belt_that_accelerates_uniformly(acceleration):
    top, t_end = 1.0, 1.0
    start = top / acceleration
    belt = Signal([0.0, start], [0.0, top], interpolation="linear")
    a = min(acceleration, 0.3 * G)
    until = top / a
    way = 0.5 * a * until**2 + top * (t_end - until)
    known = [way, 0.1, 0.0, top, 0.0, 0.0]
    motion = check(box_on(Line(velocity=belt)), known, t_end, order=2, factor=1.0)
    kinds = [event.kind for event in motion.events]
    assert kinds[0] == EventKind.KINK
    assert motion.events[0].time == start
    assert kinds.count(EventKind.STICK) == (2 if acceleration > a else 0)


def test_a_belt_that_jumps_makes_what_sticks_slip():
    belt = Signal([0.0, 0.2, 0.2, 1.0], [0.0, 0.0, 0.5, 0.5], interpolation="linear")
    until = 0.5 / (0.3 * G)
    known = [0.25 * until + 0.5 * (0.8 - until), 0.1, 0.0, 0.5, 0.0, 0.0]
    motion = check(box_on(Line(velocity=belt)), known, 1.0, factor=1.0)
    times = {event.kind: event.time for event in motion.events}
    assert times[EventKind.KINK] == times[EventKind.SLIP] == 0.2
    assert times[EventKind.STICK] == pytest.approx(0.2 + until, abs=1e-12)


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


def test_a_turntable_that_starts():
    # What sticks at a small radius turns with the table.
    spin = Signal([0.0, 0.5, 1.0], [0.0, 1.0, 1.0], interpolation="cubic")
    body = Body.cylinder(1.0, radius=0.05, height=0.02, position=(0.1, 0.0, 0.01))
    table, law = Plane(spin=spin), FrictionLaw.isotropic(1.0)
    feet = [
        PointPlane(0, point=(x, y, -0.01), plane=table, law=law)
        for x, y in [(0.04, 0.0), (-0.02, 0.03), (-0.02, -0.03)]
    ]
    angle, rate = spin.integral(0.0, 1.4), spin(1.4)
    turn = Rotation.from_euler("z", angle)
    known = np.concatenate(
        [
            turn.apply([0.1, 0.0, 0.01]),
            np.roll(turn.as_quat(), 1),
            turn.apply([0.0, 0.1 * rate, 0.0]),
            [0.0, 0.0, rate],
        ]
    )
    check(RigidBodies([body], pairs=feet), known, 1.4, order=2, factor=2.0)


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


def test_a_box_on_a_table_that_is_shaken_gently_never_leaves_it():
    table = shaker(1e-3, 12.0)
    system = box_on(Line(motion=PlaneMotion(displacement=table)))
    y, v = table(1.03)[1], table.derivative(1.03)[1]
    motion = check(
        system,
        [0.0, 0.1 + y, 0.0, 0.0, v, 0.0],
        1.03,
        order=2,
        factor=20.0,
        steps=(1e-3, 5e-4, 2.5e-4),
    )
    assert motion.events == ()
    run = simulate(system, dt=1e-3, t_end=1.0)
    carries = run.normal_force[1:].sum(axis=1)
    assert np.all(carries > 0.0)
    load = G + table.derivative(run.t[1:] - 0.5e-3, order=2)[:, 1]
    np.testing.assert_allclose(carries[5:], load[5:], atol=0.1)


def test_periodic_samples_over_many_periods():
    wave = Sine(0.5e-3, frequency=20.0, phase=0.3)
    t = np.linspace(0.0, 0.05, 17)
    once = np.stack([np.zeros(17), wave(t)], axis=-1)
    once[-1] = once[0]
    periodic = Signal(t, once, interpolation="cubic", periodic=True)
    tiles = 41
    times = np.concatenate([[0.0], *(t[1:] + 0.05 * k for k in range(tiles))])
    values = np.concatenate([once[:1], *[once[1:]] * tiles])
    whole = Signal(times, values, interpolation="cubic")
    ends = []
    for signal in (periodic, whole):
        system = box_on(Line(motion=PlaneMotion(displacement=signal)))
        system = system.replace(
            bodies=[
                system.bodies[0].replace(
                    position=(0.0, 0.1 + once[0, 1]), velocity=signal.derivative(0.0)
                )
            ]
        )
        ends.append(integrate(system, t_end=2.0))
    known = 0.1 + periodic(2.0)[1]
    assert ends[0].q[-1, 1] == pytest.approx(known, abs=1e-12)
    assert ends[0].events == ()
    np.testing.assert_allclose(
        ends[0].u[-1], periodic.derivative(2.0)[1] * np.array([0, 1, 0]), atol=1e-10
    )
    np.testing.assert_allclose(ends[0].q[-1], ends[1].q[-1], atol=1e-6)


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


@pytest.mark.parametrize("inertia", [1e-3, 0.011, 0.1, 0.3, 7.0])
def test_a_box_that_a_table_strikes_flat_stays_on_it(inertia):
    """Percussions of corners balance; what rounding leaves of them is neither slip nor bounce."""
    rises = Signal([0.1, 1.0], [[0.0, 0.0], [0.0, 0.9]], interpolation="linear")
    body = PlanarBody(1.0, inertia=inertia, position=(0.0, 0.1))
    line = Line(motion=PlaneMotion(displacement=rises))
    motion = integrate(
        RigidBodies([body], pairs=[BoxPlane(0, half_sizes=(0.1, 0.1), plane=line, law=SLIPPERY)]),
        t_end=0.5,
    )
    assert [event.kind for event in motion.events] == [EventKind.KINK]
    np.testing.assert_allclose(motion.q[-1], [0.0, 0.5, 0.0], atol=1e-12)
    np.testing.assert_allclose(motion.u[-1], [0.0, 1.0, 0.0], atol=1e-12)


def test_kinks_do_not_count_as_too_many_events():
    zigzag = Signal([0.0, 0.01, 0.02], [0.0, 1e-4, 0.0], interpolation="linear", periodic=True)
    motion = integrate(box_on(Line(velocity=zigzag)), t_end=1.0, max_events=5)
    assert sum(event.kind == EventKind.KINK for event in motion.events) == 99


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


def test_a_plate_rides_on_a_table_that_tips_about_two_axes():
    tilt = Sine(
        [0.1, 0.15, 0.0],
        frequency=1.0,
        phase=[0.0, 0.7, 0.0],
        offset=[0.0, -0.15 * np.sin(0.7), 0.0],
    )

    def at(t):
        return Rotation.from_rotvec(tilt(t))

    omega = tilt.derivative(0.0)
    place = np.array([0.05, -0.1, 0.02])
    body = Body.box(
        1.0,
        half_sizes=(0.1, 0.1, 0.02),
        position=place,
        velocity=np.cross(omega, place),
        angular_velocity=omega,
    )
    plane = Plane(motion=PlaneMotion(rotation=tilt))
    feet = [
        PointPlane(0, point=(*foot, -0.02), plane=plane, law=FrictionLaw.isotropic(2.0))
        for foot in [(0.1, 0.0), (-0.05, 0.08), (-0.05, -0.08)]
    ]
    t, h = 0.7, 1e-4
    velocity = (at(t - 2 * h).apply(place) - at(t + 2 * h).apply(place)
                + 8 * (at(t + h).apply(place) - at(t - h).apply(place))) / (12 * h)  # fmt: skip
    spin = (at(t).inv() * at(t + h)).as_rotvec() - (at(t).inv() * at(t - h)).as_rotvec()
    known = np.concatenate(
        [at(t).apply(place), np.roll(at(t).as_quat(), 1), velocity, spin / (2 * h)]
    )
    motion = integrate(RigidBodies([body], pairs=feet), t_end=t)
    np.testing.assert_allclose(np.r_[motion.q[-1], motion.u[-1, :3]], known[:10], atol=1e-8)
    np.testing.assert_allclose(motion.u[-1, 3:], known[10:], atol=1e-6)
    for dt in (4e-3, 1e-3):
        run = simulate(RigidBodies([body], pairs=feet), dt=dt, t_end=t)
        np.testing.assert_allclose(run.q[-1], known[:7], rtol=0.0, atol=0.3 * dt)


# Conveyors.


@pytest.mark.parametrize("direction", [0.0, 0.6, 1.2])
def test_a_conveyor_of_anisotropic_surface(direction):
    """Shaken obliquely so fast that the part slides all the time, without leaving the surface."""
    semi_axes, frequency = (0.5, 0.2), 20.0
    omega = 2.0 * np.pi * frequency
    along, up = 40.0 / omega**2, 8.0 / omega**2
    way = np.array([along * np.cos(direction), along * np.sin(direction), up])
    motion = Sine(way, frequency=frequency, phase=[np.pi / 2] * 3)

    def belt(t):
        return motion.derivative(t)[:2]

    law = FrictionLaw.associated(Ellipse(*semi_axes))
    plane = Plane(motion=PlaneMotion(displacement=motion))
    start, t_end = motion(0.0), 0.33
    # Slides from the beginning on, as the surface is at its farthest point then.
    u0 = np.array([-0.05, 0.03])
    x, y, vx, vy = slides(
        t_end, belt, semi_axes, lambda t: G + motion.derivative(t, order=2)[2], u0
    )
    system = point_on(plane, law, position=[0.0, 0.0, start[2]], velocity=[*u0, 0.0])
    known = of_point([x, y, motion(t_end)[2]], [vx, vy, motion.derivative(t_end)[2]])
    check(system, known, t_end, factor=20.0, steps=(4e-4, 1e-4, 2.5e-5))


def test_a_conveyor_with_stick_and_hops_by_pieces_in_closed_form():
    """Along a line: sticks, slips and flies; DOP853 integrates every phase up to its event."""
    mu, frequency = 0.4, 15.0
    omega = 2.0 * np.pi * frequency
    table = Sine([12.0 / omega**2, 13.0 / omega**2], frequency=frequency, phase=[0.0, 0.0])
    law = FrictionLaw.isotropic(mu, dimension=1)
    pair = PointPlane(
        0, point=(0.0, 0.0), plane=Line(motion=PlaneMotion(displacement=table)), law=law
    )
    body = PlanarBody(1.0, inertia=1.0, velocity=table.derivative(0.0))
    t_end = 0.3
    state, phases = conveyed(table, mu, t_end)
    assert {"stick", "slip", "flight"} <= set(phases)
    known = [state[0], state[1], 0.0, state[2], state[3], 0.0]
    check(
        RigidBodies([body], pairs=[pair]), known, t_end, factor=20.0, steps=(4e-4, 1e-4, 2.5e-5),
        tolerance=1e-8,
    )  # fmt: skip


def conveyed(table, mu, t_end):
    """A point on a shaken line, phase by phase, from rest on it."""

    def acceleration(t):
        return table.derivative(t, order=2)

    def load(t):
        return G + acceleration(t)[1]

    t, phase, phases = 0.0, "stick", []
    state, sign = np.concatenate([table(0.0), table.derivative(0.0)]), 0.0
    while True:
        phases.append(phase)
        sigma = sign

        def rate(t, x, phase=phase, sigma=sigma):
            if phase == "flight":
                return [x[2], x[3], 0.0, -G]
            a = acceleration(t)
            if phase == "stick":
                return [x[2], x[3], a[0], a[1]]
            return [x[2], x[3], -sigma * mu * load(t), a[1]]

        def lifts(t, x):
            return load(t)

        def slips(t, x):
            return mu * load(t) - abs(acceleration(t)[0])

        def lands(t, x):
            return x[1] - table(t)[1]

        def sticks(t, x, sigma=sigma):
            return sigma * (x[2] - table.derivative(t)[0])

        events = {"flight": [lands], "stick": [lifts, slips], "slip": [lifts, sticks]}[phase]
        for event in events:
            event.terminal, event.direction = True, -1.0
        first = 1e-7
        x = state + first * np.array(rate(t, state)) + 0.0
        found = solve_ivp(
            rate, (t + first, t_end), x, method="DOP853", rtol=1e-13, atol=1e-15, max_step=1e-3,
            events=events,
        )  # fmt: skip
        t, state = found.t[-1], found.y[:, -1]
        if found.status == 0:
            return state, phases
        a, v = acceleration(t), table.derivative(t)
        if phase != "flight" and found.t_events[0].size:
            phase = "flight"
            continue
        if phase == "stick":
            phase, sign = "slip", -np.sign(a[0])
        elif phase == "slip":
            phase = "stick" if mu * load(t) > abs(a[0]) else "slip"
            sign = -np.sign(a[0])
        else:
            # Without restitution: the percussion of the normal limits that of friction.
            jump, slip = v[1] - state[3], state[2] - v[0]
            state[1], state[3] = table(t)[1], v[1]
            if load(t) <= 0.0:
                raise AssertionError("the parameters are such that parts land where they stay")
            if mu * jump >= abs(slip):
                state[2] = v[0]
                phase = "stick" if mu * load(t) > abs(a[0]) else "slip"
                sign = -np.sign(a[0])
            else:
                state[2] -= np.sign(slip) * mu * jump
                phase, sign = "slip", np.sign(slip)


# The same physics written down differently.


def test_a_plane_that_moves_uniformly_is_a_belt():
    velocity = np.array([0.4, -0.3])
    slope = Rotation.from_euler("x", 0.4)
    law = FrictionLaw.associated(Ellipse(0.5, 0.2))
    along = slope.apply([*velocity, 0.0])
    moves = Signal([0.0, 2.0], [np.zeros(3), 2.0 * along], interpolation="linear")
    runs = []
    for options in ({"velocity": velocity}, {"motion": PlaneMotion(displacement=moves)}):
        plane = Plane.oriented(slope, **options)
        body = Body.box(
            1.0,
            half_sizes=(0.1, 0.1, 0.05),
            position=slope.apply([0.0, 0.0, 0.05]),
            orientation=slope,
        )
        system = RigidBodies(
            [body], pairs=[BoxPlane(0, half_sizes=(0.1, 0.1, 0.05), plane=plane, law=law)]
        )
        runs.append([simulate(system, dt=1e-3, t_end=0.5), integrate(system, t_end=0.5)])
    for a, b in zip(*runs, strict=True):
        np.testing.assert_allclose(a.q[-1], b.q[-1], atol=1e-9)
        np.testing.assert_allclose(a.u[-1], b.u[-1], atol=1e-9)


def test_galilei_holds_along_the_normal():
    rises = Signal([0.0, 2.0], [[0.0, 0.0], [0.6, 1.4]], interpolation="linear")
    v = np.array([0.3, 0.7])

    def run(motion, velocity):
        body = PlanarBody.box(
            1.0,
            half_sizes=(0.1, 0.2),
            position=(0.0, 0.4),
            angle=0.3,
            velocity=np.add((1.0, 0.0), velocity),
        )
        pair = BoxPlane(0, half_sizes=(0.1, 0.2), plane=Line(motion=motion), law=SLIPPERY)
        return simulate(RigidBodies([body], pairs=[pair]), dt=1e-3, t_end=1.0)

    moved = run(PlaneMotion(displacement=rises), v)
    still = run(None, 0.0 * v)
    carried = np.append(v, 0.0)
    np.testing.assert_allclose(moved.u[-1] - carried, still.u[-1], atol=1e-9)
    np.testing.assert_allclose(moved.q[-1] - carried, still.q[-1], atol=1e-9)


def test_a_shaken_table_is_a_load_in_its_axes():
    table = Sine([1.5e-3, 0.0, 0.6e-3], frequency=15.0, phase=[0.0, 0.0, 1.0])
    omega = 2.0 * np.pi * 15.0
    law = FrictionLaw.associated(Ellipse(0.4, 0.25))
    pushes = Sine(2.0 * omega**2 * table.amplitude, frequency=15.0, phase=table.phase)
    half = (0.1, 0.1, 0.02)

    def run(plane, position, velocity, force):
        body = Body.box(
            2.0, half_sizes=half, position=position + np.array([0.0, 0.0, 0.02]),
            velocity=velocity + np.array([0.2, 0.1, 0.0]), force=force,
        )  # fmt: skip
        feet = [
            PointPlane(0, point=(*foot, -0.02), plane=plane, law=law)
            for foot in [(0.1, 0.0), (-0.05, 0.08), (-0.05, -0.08)]
        ]
        return integrate(RigidBodies([body], pairs=feet), t_end=0.2)

    shaken = run(
        Plane(motion=PlaneMotion(displacement=table)),
        table(0.0),
        table.derivative(0.0),
        np.zeros(3),
    )
    loaded = run(Plane(), np.zeros(3), np.zeros(3), pushes)
    np.testing.assert_allclose(shaken.q[-1, :3] - table(0.2), loaded.q[-1, :3], atol=1e-9)
    np.testing.assert_allclose(shaken.q[-1, 3:], loaded.q[-1, 3:], atol=1e-9)
    np.testing.assert_allclose(
        shaken.u[-1, :3] - table.derivative(0.2), loaded.u[-1, :3], atol=1e-8
    )


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


@pytest.mark.parametrize("signal", [Sine([1e-3, 1.5e-3], frequency=12.0)])
def test_functions_move_planes_as_their_signals_do(signal):
    ends = []
    for displacement in (signal, lambda t: (signal(t), signal.derivative(t))):
        system = box_on(Line(motion=PlaneMotion(displacement=displacement)))
        ends.append(
            [
                simulate(system, dt=1e-3, t_end=0.3).q[-1],
                integrate(system, t_end=0.3, max_step=5e-3).q[-1],
            ]
        )
    np.testing.assert_allclose(ends[0][0], ends[1][0], rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(ends[0][1], ends[1][1], rtol=0.0, atol=1e-9)


# What is said.


def moved(displacement):
    return Line(motion=PlaneMotion(displacement=displacement))


def asked(function):
    """A function, and the times at which it is asked."""
    times = []

    def noted(t):
        times.append(t)
        return function(t)

    return noted, times


def test_functions_are_not_asked_before_the_start_nor_after_the_end():
    rise, times = asked(lambda t: ([0.0, 0.1 * t], [0.0, 0.1]))
    belt, more = asked(lambda t: 0.5 * t)
    line = Line(velocity=belt, motion=PlaneMotion(displacement=rise))
    integrate(
        RigidBodies(
            [PlanarBody(1.0, inertia=1.0)],
            pairs=[PointPlane(0, point=(0.0, 0.0), plane=line, law=SLIPPERY)],
        ),
        t_end=1.0,
    )
    assert (min(times), min(more)) == (0.0, 0.0)
    assert max(*times, *more) <= 1.0


@pytest.mark.parametrize(
    ("line", "end", "events"),
    [
        (
            moved(lambda t: ([0.0, 0.1 * max(t, 0.0)], [0.0, 0.1 * (t >= 0.0)])),
            [0.0, 0.1],
            [(EventKind.IMPACT, 0.0)],
        ),
        (
            moved(lambda t: ([0.1 * max(t, 0.0), 0.0], [0.1 * (t >= 0.0), 0.0])),
            [0.1 - 0.005 / (0.3 * G), 0.0],
            [(EventKind.STICK, 0.1 / (0.3 * G))],
        ),
        (
            Line(velocity=lambda t: 0.5 if t >= 0.0 else 0.0),
            [0.5 - 0.125 / (0.3 * G), 0.0],
            [(EventKind.STICK, 0.5 / (0.3 * G))],
        ),
        (Line(velocity=lambda t: max(t, 0.0)), [0.5, 0.0], []),
    ],
    ids=["rises", "slides", "belt that jumps", "belt"],
)  # fmt: skip
def test_functions_may_begin_with_a_kink_or_a_jump(line, end, events):
    system = RigidBodies(
        [PlanarBody(1.0, inertia=1.0)],
        pairs=[PointPlane(0, point=(0.0, 0.0), plane=line, law=SLIPPERY)],
    )
    motion = integrate(system, t_end=1.0)
    np.testing.assert_allclose(motion.q[-1, :2], end, atol=1e-12)
    assert [event.kind for event in motion.events] == [kind for kind, _ in events]
    np.testing.assert_allclose(
        [event.time for event in motion.events], [time for _, time in events], atol=1e-12
    )


@pytest.mark.parametrize("start", [0.0, 0.2])
def test_a_surface_that_jumps_to_another_velocity_does_so_by_a_kink_at_any_time(start):
    """The plane begins to rise with 1 m/s: the percussion takes μ m/s from the slip."""
    times = [start, start + 0.3, start + 1.0]
    rise = Signal(times, [[0.0, 0.0], [0.0, 0.3], [0.0, 1.0]], interpolation="linear")
    line = Line(motion=PlaneMotion(displacement=rise))
    body = PlanarBody(1.0, inertia=1.0, velocity=(1.0 + 0.3 * G * start, 0.0))
    system = RigidBodies([body], pairs=[PointPlane(0, point=(0.0, 0.0), plane=line, law=SLIPPERY)])
    motion = integrate(system, t_end=start + 0.5)
    first = motion.events[0]
    assert (first.kind, first.contact, first.time) == (EventKind.KINK, None, start)
    before, after = np.flatnonzero(motion.t == start)
    np.testing.assert_allclose(motion.u[before], [1.0, 0.0, 0.0], atol=1e-13)
    np.testing.assert_allclose(motion.u[after], [0.7, 1.0, 0.0], atol=1e-13)


@pytest.mark.parametrize("sample_every", [None, 0.1])
def test_the_first_sample_is_the_state_before_an_impact_at_the_start(sample_every):
    body = PlanarBody(1.0, inertia=1.0, velocity=(1.0, -1.0))
    system = RigidBodies(
        [body], pairs=[PointPlane(0, point=(0.0, 0.0), plane=Line(), law=SLIPPERY)]
    )
    motion = integrate(system, t_end=0.5, sample_every=sample_every)
    assert motion.u[0].tolist() == [1.0, -1.0, 0.0]
    assert (motion.events[0].kind, motion.events[0].time) == (EventKind.IMPACT, 0.0)
    if sample_every is None:
        assert motion.t[1] == 0.0
        assert motion.t[2] > 0.0
        np.testing.assert_allclose(motion.u[1], [0.7, 0.0, 0.0], atol=1e-14)


def test_moving_planes_are_values():
    motion = PlaneMotion(displacement=Sine([0.0, 1e-3], frequency=12.0))
    line = Line(motion=motion)
    assert pickle.loads(pickle.dumps(line)) == line
    assert line == Line(motion=PlaneMotion(displacement=Sine([0.0, 1e-3], frequency=12.0)))
    system = box_on(line)
    assert pickle.loads(pickle.dumps(system)) == system
    assert system.depends_on_time
    assert not box_on(Line()).depends_on_time
    with pytest.raises((pickle.PicklingError, AttributeError)):
        pickle.dumps(PlaneMotion(rotation=lambda t: (0.0, 0.0)))


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


def test_contact_points_and_forces_are_those_of_the_time():
    table = shaker(4e-3, 10.0)
    system = box_on(Line(motion=PlaneMotion(displacement=table)))
    run = simulate(system, dt=1e-3, t_end=0.03)
    points = system.contact_points(run)[:, 0]
    np.testing.assert_allclose(points[:, 1], run.q[:, 1] - 0.1, atol=1e-12)
    assert run.phase[-1, 0] == Phase.STICK


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


def test_rates_that_are_right_are_taken():
    def far(t):
        return [1e6 + 1e-9 * t, 0.0], [1e-9, 0.0]

    def fast(t):
        return [1e-9 * np.sin(1e7 * t), 0.0], [1e-2 * np.cos(1e7 * t), 0.0]

    def resting(t):
        return [1.0, 0.0], [0.0, 0.0]

    def sampled(t):
        """Between samples a straight line, with the rate that a gradient finds at them."""
        times = np.linspace(-0.1, 1.1, 121)
        values = 0.01 * np.sin(4.0 * times)
        return (
            [np.interp(t, times, values), 0.0],
            [np.interp(t, times, np.gradient(values, times)), 0.0],
        )

    for function in (far, fast, resting, sampled):
        assert run_either("simulate", carried(displacement=function), 1.0).status == "finished"
