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


def spring_on_two_belts():
    """One mass, two contacts that share a direction, μ = .1 and 1."""
    contacts = [
        asp.Contact(LINE[mu], direction=[[1.0]], normal_force=1.0, velocity=[-0.1])
        for mu in (0.1, 1.0)
    ]
    return asp.LinearSystem([[1.0]], stiffness=[[1.0]], contacts=contacts)


def test_redundant_contacts_stick_as_long_as_they_can_together():
    motion = asp.integrate(spring_on_two_belts(), t_end=30.0, u0=[0.1])
    assert times(motion, "slip")[0] == pytest.approx(11.0, abs=1e-9)
    early = motion.t < 11.0
    assert (motion.phase[early] == asp.Phase.STICK).all()
    assert motion.force[early].sum(1)[:, 0] == pytest.approx(motion.q[early, 0], abs=1e-9)
    assert (np.abs(motion.force[early, :, 0]) <= [0.1 + 1e-9, 1.0 + 1e-9]).all()
    stepped = asp.simulate(spring_on_two_belts(), dt=1e-3, t_end=30.0, u0=[0.1])
    assert motion.q[-1] == pytest.approx(stepped.q[-1], abs=1e-5)


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


@pytest.mark.parametrize("u0", [-2e-19, 0.0, 2e-19])
def test_a_start_at_rest_up_to_rounding_sticks(u0):
    # With μ = 100 a slip would lift the contact or need an impact, depending on its sign.
    law = asp.FrictionLaw.isotropic(100.0, dimension=1)
    contact = asp.Contact(law, direction=[[1.0], [0.0]], normal=[0.0, 1.0])
    system = asp.LinearSystem(
        np.linalg.inv([[1.0, 0.5], [0.5, 1.0]]),
        stiffness=0.0,
        damping=0.0,
        force=[0.0, -9.81],
        contacts=[contact],
    )
    motion = asp.integrate(system, t_end=1.0, u0=[u0, 0.0])
    assert motion.events == ()
    assert np.abs(motion.u[1:]).max() < 1e-15


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


@pytest.mark.parametrize(("u0", "driven_back"), [((0.3, -1.0), True), ((1.0, -0.5), False)])
def test_an_impact_in_a_corner_says_whether_it_drives_back_what_leaves(u0, driven_back):
    """In a wedge of 37°: one after the other, or both at a time, are two laws of the corner."""
    law = asp.FrictionLaw.isotropic(0.01, dimension=1)
    normals = np.array([[0.0, 1.0], [0.6, -0.8]])
    stops = [
        asp.Contact(law, direction=np.array([[n[1]], [-n[0]]]), normal=n, normal_restitution=0.8)
        for n in normals
    ]
    wedge = asp.LinearSystem(np.eye(2), stiffness=np.zeros((2, 2)), contacts=stops)
    # One hits at once, the other one is left.
    assert normals[0] @ u0 < 0.0 < normals[1] @ u0
    motion = asp.integrate(wedge, t_end=0.1, u0=u0)
    assert motion.events[0].kind is EventKind.IMPACT
    assert motion.events[0].ambiguous == driven_back
    assert (motion.events[1:2] != ()) == driven_back


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


def random_openings(count):
    """Contacts in space in that zone: numbers of all, and of those that do not open."""
    rng = np.random.default_rng(7)
    law = asp.FrictionLaw.isotropic(0.9)
    met, closed = 0, []
    for case in range(count):
        rows = rng.normal(size=(3, 3))
        slip = rng.normal(size=2)
        force = rng.normal(size=3)
        sliding = rows[0] - 0.9 * slip @ rows[1:] / np.linalg.norm(slip)
        if rows[0] @ sliding > -1e-3 or rows[0] @ force < 1e-2:
            continue
        met += 1
        contact = asp.Contact(law, direction=rows[1:].T, normal=rows[0], velocity=slip)
        system = asp.LinearSystem(np.eye(3), force=force, contacts=[contact])
        motion = asp.integrate(system, t_end=1e-3)
        if np.abs(motion.q[-1] - 0.5e-6 * force).max() > 1e-12:
            closed.append(case)
    return met, closed


def test_contacts_in_space_that_can_open_open():
    met, closed = random_openings(400)
    assert met > 10
    assert closed == []


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


def pulled_box(rng, interpolation):
    """A box on corners that share its load, the friction coefficient, and when and how it slides.

    The force F = t f along the plane and t f_N away from it reaches μ(m g - t f_N) at t = t_0; from
    then on the acceleration is (f + μ f_N)(t - t_0)/m.
    """
    mass, g, mu = (
        10.0 ** rng.uniform(-2.0, 3.0),
        10.0 ** rng.uniform(0.0, 2.0),
        rng.uniform(0.05, 0.9),
    )
    half, height = 0.1 * 10.0 ** rng.uniform(-0.3, 1.0), rng.uniform(0.01, 0.3)
    height *= half / mu
    along, lifting = mass * g * mu * rng.uniform(0.3, 5.0), rng.uniform(-0.3, 0.3) * mass * g
    start = mu * mass * g / (along + mu * lifting)
    end = start * rng.uniform(1.05, 1.5)
    lifting = lifting if lifting * end < 0.5 * mass * g else 0.0
    start = mu * mass * g / (along + mu * lifting)
    spatial = rng.random() < 0.5
    phi = rng.uniform(0.0, 2.0 * np.pi)
    tangent = np.array(
        [np.cos(phi), np.sin(phi), 0.0] if spatial else [rng.choice([-1.0, 1.0]), 0.0]
    )
    rate = along * tangent + lifting * np.eye(len(tangent))[-1]
    if interpolation is None:

        def force(t):
            return t * rate

    else:
        times = np.linspace(0.0, 2.0 * end, 5)
        force = asp.Signal(times, times[:, None] * rate, interpolation=interpolation)
    if spatial:
        sizes = [half, half, height]
        body = asp.Body.box(mass, half_sizes=sizes, position=[0.0, 0.0, height], force=force)
        law = asp.FrictionLaw.isotropic(mu)
        pairs = [asp.BoxPlane(0, plane=asp.Plane(), law=law, half_sizes=sizes)]
        gravity = (0.0, 0.0, -g)
    else:
        sizes = [half, height]
        body = asp.PlanarBody.box(mass, half_sizes=sizes, position=[0.0, height], force=force)
        feet = np.linspace(-half, half, rng.integers(2, 5))
        pairs = [
            asp.PointPlane(0, plane=asp.Line(), point=[x, -height], law=line(mu)) for x in feet
        ]
        gravity = (0.0, -g)
    system = asp.RigidBodies([body], pairs=pairs, gravity=gravity)
    jerk = (along + mu * lifting) / mass
    return system, tangent, jerk, start, end


@pytest.mark.parametrize("interpolation", ["linear", "cubic", None])
@pytest.mark.parametrize("seed", range(8))
def test_a_growing_force_pulls_a_box_out_of_rest(seed, interpolation):
    """Corners share a load of which only the sum is known until all of them slip at once."""
    system, tangent, jerk, start, end = pulled_box(np.random.default_rng(seed), interpolation)
    motion = asp.integrate(system, t_end=end)
    slips = [event.time for event in motion.events if event.kind is EventKind.SLIP]
    assert slips
    assert {event.kind for event in motion.events} <= {EventKind.SLIP, EventKind.KINK}
    assert slips == pytest.approx([start] * len(slips), rel=1e-7)
    speed = motion.u[-1][: len(tangent)] @ tangent
    assert speed == pytest.approx(0.5 * jerk * (end - start) ** 2, rel=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_feet_that_share_a_load_carry_it_as_equally_compliant_ones_do(seed):
    """A body on four to six feet that slides and turns, against its equations of motion.

    Normal forces are an affine function of the place under the body, as those of springs of one
    stiffness are; the bodies are low, so that no foot would have to pull. Compared from where all
    feet slip.
    """
    rng = np.random.default_rng(seed)
    mass, height, gravity = 10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(0.005, 0.02), 9.81
    count = int(rng.integers(4, 7))
    angles = (np.arange(count) + rng.uniform(-0.2, 0.2, count)) * 2.0 * np.pi / count
    places = 0.1 * np.column_stack([np.cos(angles), np.sin(angles)])
    a, b = rng.uniform(0.2, 0.6, 2)
    turn = rng.uniform(0.0, 3.0)
    associated = bool(rng.integers(2))
    reservoir = asp.Ellipse(a, b, angle=turn)
    law = asp.FrictionLaw(reservoir, direction=reservoir if associated else asp.Disk(1.0))
    pull, phi = mass * gravity * rng.uniform(0.6, 1.5), rng.uniform(0.0, 2.0 * np.pi)
    force = pull * np.array([np.cos(phi), np.sin(phi)])
    torque = 0.05 * pull * rng.normal()
    ramp = {"interpolation": "linear"}
    body = asp.Body.box(
        mass,
        half_sizes=[0.1, 0.1, height],
        position=[0.0, 0.0, height],
        force=asp.Signal([0.0, 2.0], [[0.0, 0.0, 0.0], [*2.0 * force, 0.0]], **ramp),
        torque=asp.Signal([0.0, 2.0], [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0 * torque]], **ramp),
    )
    feet = [
        asp.PointPlane(0, plane=asp.Plane(), point=[*place, -height], law=law) for place in places
    ]
    system = asp.RigidBodies([body], pairs=feet, gravity=(0.0, 0.0, -gravity))
    run = asp.integrate(system, t_end=1.0, sample_every=0.01)

    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    shape = axes.T @ np.diag([a**2, b**2]) @ axes
    inertia = mass * 0.02 / 3.0

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        angle, vx, vy, omega = state[2:]
        cosine, sine = np.cos(angle), np.sin(angle)
        arms = places @ np.array([[cosine, sine], [-sine, cosine]])
        slip = np.column_stack([vx - omega * arms[:, 1], vy + omega * arms[:, 0]])
        if associated:
            size = np.sqrt(np.einsum("ij,jk,ik->i", slip, shape, slip))
            unit = -(slip @ shape) / size[:, None]
        else:
            size = np.sqrt(np.einsum("ij,jk,ik->i", slip, np.linalg.inv(shape), slip))
            unit = -slip / size[:, None]
        affine = np.column_stack([np.ones(count), arms])
        # Weight, and moments of normal and friction forces about the centre of mass.
        balance = np.vstack([np.ones(count), (arms + height * unit).T])
        share = affine @ np.linalg.solve(balance @ affine, [mass * gravity, 0.0, 0.0])
        assert share.min() > 0.0
        friction = share[:, None] * unit
        moment = (arms[:, 0] * friction[:, 1] - arms[:, 1] * friction[:, 0]).sum()
        linear = (t * force + friction.sum(axis=0)) / mass
        return np.array([vx, vy, omega, *linear, (t * torque + moment) / inertia])

    moves = np.abs(run.u).max(axis=1)
    assert moves[-1] > 1e-3
    slips = max(event.time for event in run.events if event.kind is EventKind.SLIP)
    first = int(np.flatnonzero((moves > 1e-3) & (run.t > slips))[0])
    angle = np.unwrap(2.0 * np.arctan2(run.q[:, 6], run.q[:, 3]), period=4.0 * np.pi)
    states = np.column_stack([run.q[:, :2], angle, run.u[:, :2], run.u[:, 5]])
    expected = solve_ivp(
        rates, (run.t[first], 1.0), states[first], method="DOP853", rtol=1e-11, atol=1e-14
    )
    assert np.abs(states[-1] - expected.y[:, -1]).max() <= 1e-8 * (1.0 + moves[-1])


def assert_slips_at_once(belt, motion, rest):
    # The force stays where it is and the mass swings along a line, q − q_eq = v sin(ωt)/ω.
    omega = np.sqrt(belt.stiffness[0, 0] / belt.mass)
    swing = np.outer(np.sin(omega * motion.t), belt.belt_velocity) / omega
    np.testing.assert_allclose(motion.q - rest, swing, atol=1e-7 * np.abs(swing).max())
    assert motion.events[0].kind == "slip"
    assert motion.events[0].time < 1e-6


def test_random_belts_slip_from_steady_sliding_at_once():
    rng = np.random.default_rng(1)
    checked = 0
    for _ in range(60):
        sizes, angles = rng.uniform(0.2, 1.0, 4), rng.uniform(0.0, np.pi, 2)
        law = asp.FrictionLaw(
            asp.Ellipse(*sizes[:2], angle=angles[0]), asp.Ellipse(*sizes[2:], angle=angles[1])
        )
        belt = asp.MassOnBelt(
            rng.uniform(0.5, 2.0),
            stiffness=rng.uniform(0.5, 2.0),
            law=law,
            normal_force=rng.uniform(0.5, 2.0),
            belt_velocity=rng.uniform(-1.0, 1.0, 2),
        )
        state = asp.stability(belt)
        if state.kind == "unstable":
            # The spring draws the load into the reservoir, and the mass sticks for a while.
            continue
        checked += 1
        rest = state.equilibrium.q
        t_end = 1.8 * np.pi * np.sqrt(belt.mass / belt.stiffness[0, 0])
        motion = asp.integrate(belt, t_end=t_end, q0=rest, u0=belt.belt_velocity)
        assert_slips_at_once(belt, motion, rest)
    assert checked > 40


def random_belt(seed, thinnest):
    """A belt whose law has two ellipses, with half axes from `thinnest` to 1."""
    rng = np.random.default_rng([seed, ord("e")])
    ellipses = []
    for _ in range(2):
        axes = 10.0 ** rng.uniform(np.log10(thinnest), 0.0, 2)
        ellipses.append(asp.Ellipse(*axes, angle=rng.choice([0.0, rng.uniform(0.0, np.pi)])))
    direction, speed = rng.uniform(0.0, 2.0 * np.pi), 10.0 ** rng.uniform(-1.0, 0.5)
    return asp.MassOnBelt(
        10.0 ** rng.uniform(-1.0, 1.0),
        stiffness=10.0 ** rng.uniform(-1.0, 1.0),
        law=asp.FrictionLaw(*ellipses),
        normal_force=10.0 ** rng.uniform(-0.5, 1.0),
        belt_velocity=speed * np.array([np.cos(direction), np.sin(direction)]),
    )


def swings(belt, share):
    """Three periods from steady sliding with a share of the belt's velocity, and what they are."""
    rest = asp.equilibrium(belt).q
    omega = np.sqrt(belt.stiffness[0, 0] / belt.mass)
    start = share * np.array(belt.belt_velocity)
    motion = asp.integrate(belt, t_end=6.0 * np.pi / omega, q0=rest, u0=start)
    # While the slip keeps its direction, so does the force.
    return motion, rest + np.outer(np.sin(omega * motion.t), start) / omega, start, omega


@pytest.mark.parametrize("seed", [144, 215, 217, 406])
def test_swings_of_belts_with_thin_ellipses_are_those_of_simulate(seed):
    belt = random_belt(seed, thinnest=0.1)
    motion, _, start, omega = swings(belt, 3.0)
    errors = []
    for steps in (12000, 48000):
        t_end = motion.t[-1]
        path = asp.simulate(belt, t_end=t_end, dt=t_end / steps, q0=motion.q[0], u0=start)
        errors.append(np.abs(path.q[-1] - motion.q[-1]).max() / np.linalg.norm(start) * omega)
    assert errors[1] < 1e-3
    assert errors[1] < 0.5 * errors[0] or errors[1] < 1e-6


COLUMNS = [(2, 1.0), (2, 1e4), (3, 1e4), (5, 1e4), (5, 1e7)]
# With 10⁸ rounding of the percussions leaves 7e-6 m/s of the slip.
STOPPING = [(2, 1e8, 0.37), (3, 1e8, 0.37)]


@pytest.mark.parametrize(
    ("count", "ratio", "slip"),
    [(*column, slip) for column in COLUMNS for slip in (0.37, 0.9)] + STOPPING,
)
def test_columns_of_light_bodies_under_a_heavy_one_land(count, ratio, slip):
    """They fall together and land without a rebound: the column stops, or slides on as one body.

    Percussions are larger than the loads by the ratio of the masses, and so is rounding.
    """
    mass = np.full(count, 1.0)
    mass[-1] = ratio
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    contacts = []
    for k in range(count):
        along, across = np.zeros((2 * count, 1)), np.zeros(2 * count)
        along[2 * k], across[2 * k + 1] = 1.0, 1.0
        if k:
            along[2 * k - 2], across[2 * k - 1] = -1.0, -1.0
        gap = 0.0 if k else 0.1
        contacts.append(asp.Contact(law, direction=along, normal=across, gap=gap))
    weight = 9.81 * np.repeat(mass, 2) * np.tile([0.0, -1.0], count)
    system = asp.LinearSystem(np.diag(np.repeat(mass, 2)), force=weight, contacts=contacts)
    u0 = np.tile([slip, -1.0], count)
    motion = asp.integrate(system, t_end=0.12, q0=np.zeros(2 * count), u0=u0)
    landing = np.sqrt(1.0 + 2.0 * 9.81 * 0.1)
    slides = 0.12 - (landing - 1.0) / 9.81
    left = max(0.0, slip - 0.3 * (landing + 9.81 * slides))
    np.testing.assert_allclose(motion.u[-1][0::2], left, atol=1e-7)
    np.testing.assert_allclose(motion.u[-1][1::2], 0.0, atol=1e-7)
