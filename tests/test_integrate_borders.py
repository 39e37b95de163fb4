"""Event-driven integration at its borders, each motion against something else.

Rest, slips that only touch zero, direction sets that are nearly flat, redundant contacts, late
times, tiny and huge lengths, events at the ends of runs.
"""

import asperity as asp
import numpy as np
import pytest
from asperity.runs.event import EventKind
from scipy.integrate import quad, solve_ivp


def line(mu):
    return asp.FrictionLaw.isotropic(mu, dimension=1)


LINE = {mu: line(mu) for mu in (0.1, 0.2, 1.0, 10.0)}


class Table(asp.System):
    """A unit mass on a table that moves as A sin ωt, under a pulse."""

    dof = 1

    def __init__(self, omega=0.0, amplitude=0.0, mu=10.0, pulse=0.0):
        self.omega, self.amplitude, self.pulse = omega, amplitude, pulse
        self.contacts = (asp.ContactLaw(LINE[mu], normal_force=1.0),)

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        return np.array([self.pulse * np.exp(-(((t - 50.0) / 0.1) ** 2))])

    def direction(self, t, q, contact):
        return np.eye(1)

    def velocity(self, t, q, contact):
        return np.array([-self.amplitude * self.omega * np.cos(self.omega * t)])


def times(motion, kind):
    return np.array([event.time for event in motion.events if event.kind == kind])


@pytest.mark.parametrize("depth", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("t_end", [10.0, 100.0])
def test_gaps_that_close_for_a_moment_are_seen(depth, t_end):
    """25 − c − 10 t + t² < 0 for 2 √c s."""
    contact = asp.Contact(
        LINE[0.1], direction=[[0.0], [1.0]], normal=[1.0, 0.0], normal_restitution=0.5
    )
    system = asp.LinearSystem(np.eye(2), force=[2.0, 0.0], contacts=[contact])
    motion = asp.integrate(system, t_end=t_end, q0=[25.0 - depth, 0.0], u0=[-10.0, 0.0])
    assert times(motion, "impact")[0] == pytest.approx(5.0 - np.sqrt(depth), abs=1e-10)


def test_short_pulses_need_short_steps():
    table = Table(mu=1.0, pulse=5.0)
    motion = asp.integrate(table, t_end=100.0, max_step=0.1)
    stepped = asp.simulate(table, dt=4e-3, t_end=100.0)
    assert motion.q[-1] == pytest.approx(stepped.q[-1], abs=1e-3)
    assert motion.steps >= 1000


def graze(mu, degrees, on_belt):
    """Place at t = 40 s of a mass on a belt whose γ touches 0 once a turn, and the true place."""
    e = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    belt = asp.MassOnBelt(
        1.0, stiffness=1.0, law=asp.FrictionLaw.isotropic(mu), normal_force=1.0, belt_velocity=e
    )
    motion = asp.integrate(belt, t_end=40.0, u0=e if on_belt else None)
    # From the belt: stick until the spring is as strong as friction, then q = μ + sin(t − μ).
    # From rest: q = μ (1 − cos t), which reaches the speed of the belt if μ > 1.
    if on_belt:
        return motion.q[-1], (mu + np.sin(40.0 - mu)) * e
    if mu <= 1.0:
        return motion.q[-1], mu * (1.0 - np.cos(40.0)) * e
    caught = np.arcsin(1.0 / mu)
    start = mu * (1.0 - np.cos(caught))
    leaves = caught + mu - start
    return motion.q[-1], (mu + np.sin(40.0 - leaves)) * e


@pytest.mark.parametrize("mu", [0.1, 1.0, 3.0, 10.0])
def test_slips_that_graze_zero_go_on(mu):
    for degrees in range(0, 360, 24):
        for on_belt in (True, False):
            place, expected = graze(mu, degrees + 10 * on_belt, on_belt)
            assert place == pytest.approx(expected, abs=1e-8), degrees


AXES = np.array([1.5, 1.0])
RESERVOIR = asp.Ellipse(0.5, 0.3, angle=0.4)


def stop_of_a_point(exponent, u0, gravity=9.81):
    """Where and when a point stops whose direction set is a superellipse, by quadrature.

    With a = s/(s − 1), b = 1/(s − 1) the difference of |v₁|^(1−b)/p₁^a and |v₂|^(1−b)/p₂^a is
    constant: the velocity is a function of one component, with which the other one vanishes if
    s < 2; if s > 2 the other one vanishes later, along the axis.
    """
    sign, v0 = np.sign(u0), np.abs(u0)
    a, b = exponent / (exponent - 1.0), 1.0 / (exponent - 1.0)
    weights = AXES**a

    def decelerations(v):
        z = weights * (v / v.max()) ** b
        return gravity * z / RESERVOIR.gauge(z * sign)

    if exponent == 2.0:
        first, rest, power = 1, 0.0, 1.0

        def velocity(w):
            return np.array([v0[0] * (w / v0[1]) ** (AXES[0] ** 2 / AXES[1] ** 2), w])
    else:
        shares = v0 ** (1.0 - b) / weights
        first = int(shares[0] > shares[1])
        other = 1 - first
        excess = abs(shares[0] - shares[1])
        rest = (excess * weights[other]) ** (1.0 / (1.0 - b)) if exponent > 2.0 else 0.0
        power = 1.0 / (1.0 - b) if exponent > 2.0 else 1.0

        def velocity(w):
            v = np.empty(2)
            v[first] = w
            share = max(excess + w ** (1.0 - b) / weights[first], 0.0)
            v[other] = (share * weights[other]) ** (1.0 / (1.0 - b))
            return v

    def part(x, k):
        v = velocity(v0[first] * x**power)
        slope = v0[first] * power * x ** (power - 1.0) / decelerations(v)[first]
        return slope * (v[k] if k < 2 else 1.0)

    parts = [quad(part, 0.0, 1.0, (k,), epsabs=1e-13, epsrel=1e-11, limit=400)[0] for k in range(3)]
    place, duration = np.array(parts[:2]), parts[2]
    if rest > 0.0:
        v = np.zeros(2)
        v[1 - first] = rest
        slower = decelerations(v)[1 - first]
        place[1 - first] += 0.5 * rest**2 / slower
        duration += rest / slower
    return place * sign, duration


EXPONENTS = [1.2, 1.3, 1.5, 2.0, 2.2, 2.5, 2.6, 3.0, 4.0, 5.0, 6.0]


def check_stops(exponent, angles):
    law = asp.FrictionLaw(RESERVOIR, asp.Superellipse(*AXES, exponent))
    point = asp.SlidingPoint(1.0, law=law)
    for angle in angles:
        u0 = np.array([np.cos(angle), np.sin(angle)])
        place, duration = stop_of_a_point(exponent, u0)
        motion = asp.integrate(point, t_end=2.0, u0=u0)
        assert motion.q[-1] == pytest.approx(place, abs=1e-6), angle
        assert motion.events[-1].time == pytest.approx(duration, abs=1e-6), angle


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_points_stop_where_the_invariant_says(exponent):
    check_stops(exponent, [0.6435, 2.5])


@pytest.mark.long
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_points_stop_where_the_invariant_says_in_all_directions(exponent):
    check_stops(exponent, (np.arange(15) + 0.37) * 2.0 * np.pi / 15)


@pytest.mark.parametrize("exponent", [1.3, 3.0, 6.0])
def test_slips_along_flat_directions_agree_with_scipy(exponent):
    """Before a component of the slip vanishes, which no explicit method passes."""
    law = asp.FrictionLaw(RESERVOIR, asp.Superellipse(*AXES, exponent))

    def field(_, y):
        return [*y[2:], *law.force(y[2:], normal_force=9.81)]

    u0 = [0.8, 0.6]
    expected = solve_ivp(
        field, (0.0, 0.1), [0.0, 0.0, *u0], method="DOP853", rtol=1e-11, atol=1e-13
    ).y[:, -1]
    motion = asp.integrate(asp.SlidingPoint(1.0, law=law), t_end=0.1, u0=u0)
    assert np.concatenate([motion.q[-1], motion.u[-1]]) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("excess", [0.0, 1e-16, 1e-13])
def test_a_load_at_the_limit_of_friction_is_held(excess):
    contact = asp.Contact(line(0.3), direction=[[1.0]], normal_force=1.0)
    block = asp.LinearSystem([[1.0]], force=[0.3 * (1.0 + excess)], contacts=[contact])
    motion = asp.integrate(block, t_end=1.0)
    assert abs(motion.q[-1, 0]) <= 1e-13


class Push(asp.System):
    """A block that a force pushes, λ_N = 1, μ = 0.3."""

    dof = 1
    contacts = (asp.ContactLaw(line(0.3), normal_force=1.0),)

    def __init__(self, push, direction=1.0):
        self.push, self.along = push, direction

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        return np.array([self.push(t)])

    def direction(self, t, q, contact):
        return np.array([[self.along]])


@pytest.mark.parametrize("periods", [1, 2, 10])
def test_square_waves_end_with_a_whole_period(periods):
    """Each half period begins with the slip v of the last, which stops after v/.65."""
    wave = Push(lambda t: 0.35 if t % 1.0 < 0.5 else -0.35)
    motion = asp.integrate(wave, t_end=float(periods), max_step=0.25)
    q = v = 0.0
    for half in range(2 * periods):
        sign = 1.0 - 2.0 * (half % 2)
        stops = abs(v) / 0.65
        q += 0.5 * v * stops + sign * 0.5 * 0.05 * (0.5 - stops) ** 2
        v = sign * 0.05 * (0.5 - stops)
    assert [motion.q[-1, 0], motion.u[-1, 0]] == pytest.approx([q, v], abs=1e-8)


@pytest.mark.parametrize("max_step", [1e-12, 1e-17, 1e-300])
def test_steps_that_would_never_end_are_refused(max_step):
    with pytest.raises(asp.ParameterError, match="max_step: is too small"):
        asp.integrate(Push(lambda t: 0.0), t_end=1.0, max_step=max_step)


# The paper's law: where the normals of C and D enclose more than 90°, slips repel their neighbours.
PAPER = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))


def slow_belt(phi, speed, direction=PAPER.direction):
    velocity = speed * np.array([np.cos(np.deg2rad(phi)), np.sin(np.deg2rad(phi))])
    return asp.MassOnBelt(
        1.0,
        stiffness=1.0,
        law=asp.FrictionLaw(PAPER.reservoir, direction),
        normal_force=1.0,
        belt_velocity=velocity,
    )


@pytest.mark.parametrize(("phi", "speed"), [(50.0, 1e-2), (60.0, 1e-3), (70.0, 1e-3), (70.0, 1e-5)])
def test_deviations_from_unstable_steady_sliding_grow_at_their_rate(phi, speed):
    """By four powers of ten within a time that springs do not notice, as of 1e-5 s."""
    belt = slow_belt(phi, speed)
    steady = asp.stability(belt)
    fastest = int(steady.eigenvalues.real.argmax())
    rate, mode = steady.eigenvalues[fastest].real, steady.modes[:, fastest].real
    start = 1e-7 * speed * mode / np.abs(mode).max()
    later = np.log(1e4) / rate
    sharp = {"sample_every": later, "tolerance": 1e-13}
    motion = asp.integrate(
        belt, t_end=1e3 * later, q0=steady.equilibrium.q + start / rate, u0=start, **sharp
    )
    assert np.abs(motion.u[1]).max() == pytest.approx(1e-3 * speed, rel=0.01)


@pytest.mark.parametrize("exponent", [1.8, 2.6])
def test_slips_that_repel_are_left_whatever_the_directions(exponent):
    """The fold does not depend on the speed of the belt, times in parts of 1/v hardly."""
    times = []
    for speed in (0.03, 0.01):
        belt = slow_belt(50.0, speed, asp.Superellipse(3.0, 1.0, exponent))
        motion = asp.integrate(belt, t_end=300.0 / speed, u0=belt.belt_velocity)
        times.append([speed * event.time for event in motion.events[:2]])
    assert times[0] == pytest.approx(times[1], rel=0.01)


ENDS = [10.0**k for k in range(2, 9)]


def spring(mu=0.3):
    """A stiff spring, ω = 100/s, that friction brings to rest."""
    contact = asp.Contact(line(mu), direction=[1.0], normal_force=1.0)
    return asp.LinearSystem(1.0, stiffness=1e4, contacts=[contact])


@pytest.mark.parametrize("t_end", ENDS)
def test_a_start_from_rest_does_not_depend_on_the_end(t_end):
    # x = 3e-5 + (0.01 − 3e-5) cos ωt vanishes a little after a quarter of a turn.
    section = asp.Section([-1.0, 0.0], 0.0)
    motion = asp.integrate(spring(), t_end=t_end, q0=[0.01], section=section)
    assert motion.t[-1] == pytest.approx(np.arccos(-3e-5 / (0.01 - 3e-5)) / 100.0, rel=1e-10)
    # Without a section: half a turn from one change of the slip to the next.
    motion = asp.integrate(spring(30.0), t_end=t_end, q0=[0.01])
    times = [event.time for event in motion.events]
    assert times == pytest.approx(np.pi / 100.0 * np.arange(1, 1 + len(times)), rel=1e-9)
    assert motion.events[-1].kind is EventKind.STICK
    assert motion.status is asp.Outcome.FINISHED


@pytest.mark.parametrize("approach", [0.0, 1e-12, 1e-6])
def test_a_contact_that_can_open_opens_though_slip_could_keep_it_closed(approach):
    """The indeterminate zone of Painlevé: w_NᵀM⁻¹(w_N + Wf) < 0 and γ̈_N > 0 without the contact."""
    contact = asp.Contact(line(1.0), direction=[2.0, 1.0], normal=[1.0, 0.0], velocity=[1.0])
    system = asp.LinearSystem(np.eye(2), force=[0.1, 0.0], contacts=[contact])
    motion = asp.integrate(system, t_end=0.1, u0=[approach, 0.0])
    assert EventKind.IMPACT_WITHOUT_COLLISION not in [event.kind for event in motion.events]
    assert motion.q[-1] == pytest.approx([0.0005 + 0.1 * approach, 0.0], abs=1e-12)
    steps = asp.simulate(system, dt=1e-3, t_end=0.1)
    assert motion.q[-1] == pytest.approx(steps.q[-1], abs=1e-5)
    if approach == 0.0:
        (opens,) = motion.events
        assert (opens.kind, opens.ambiguous) == (EventKind.OPEN, True)


# Motions that begin from rest through a smooth zero of what drives them.


def carried(plane, at=(0.0, 0.0)):
    body = asp.PlanarBody(1.0, inertia=1.0, position=at)
    return asp.RigidBodies(
        [body], pairs=[asp.PointPlane(0, point=(0.0, 0.0), plane=plane, law=LINE[1.0])]
    )


@pytest.mark.parametrize("scale", [1e-9, 1.0])
def test_belts_that_start_softly_take_what_lies_on_them_along(scale):
    belt = asp.Sine(scale, frequency=0.5 / np.pi, phase=-np.pi / 2, offset=scale)
    block = asp.integrate(carried(asp.Line(velocity=belt)), t_end=1.0)
    assert block.q[-1, 0] / scale == pytest.approx(1.0 - np.sin(1.0), abs=1e-12)
    wide = asp.Sine([scale, 0.0], frequency=0.5 / np.pi, phase=-np.pi / 2, offset=[scale, 0.0])
    plane = asp.Plane(velocity=wide)
    ball = asp.SpherePlane(0, radius=0.1, plane=plane, law=asp.FrictionLaw.isotropic(0.5))
    system = asp.RigidBodies(
        [asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1))], pairs=[ball]
    )
    rolls = asp.integrate(system, t_end=1.0)
    assert rolls.q[-1, 0] / scale == pytest.approx(2.0 / 7.0 * (1.0 - np.sin(1.0)), abs=1e-12)


@pytest.mark.parametrize("scale", [10.0**k for k in (-30, -17, -16, -8, 0, 8, 30)])
def test_motions_of_all_sizes_are_the_same(scale):
    block = asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(0.5), gravity=10.0 * scale)
    slides = asp.integrate(block, t_end=1.0, u0=[2.0 * scale, 0.0])
    assert [event.kind for event in slides.events] == [EventKind.STICK]
    assert slides.events[0].time == pytest.approx(0.4, rel=1e-12)
    contact = asp.Contact(line(0.3), direction=[1.0, 0.0], normal=[0.0, 1.0])
    falling = asp.LinearSystem(np.eye(2), force=[0.0, -10.0 * scale], contacts=[contact])
    falls = asp.integrate(falling, t_end=1.0, q0=[0.0, scale])
    assert [event.kind for event in falls.events] == [EventKind.IMPACT]
    assert falls.events[0].time == pytest.approx(np.sqrt(0.2), rel=1e-12)


# Rocking without restitution.


# Bodies that have nothing to do with each other.


# Boxes at rest that a growing force pulls until they slide.
