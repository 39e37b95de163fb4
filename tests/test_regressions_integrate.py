"""Motions on which the event-driven integration once failed, each against a closed form or `simulate`."""

import asperity as asp
import numpy as np
import pytest
from asperity import mechanisms

LINE = {mu: asp.FrictionLaw.isotropic(mu, dimension=1) for mu in (0.1, 0.2, 1.0, 10.0)}


class Ring(asp.System):
    """A unit mass inside a ring."""

    dof = 2

    def __init__(self, radius=1.0, mu=0.2, restitution=0.0):
        self.radius = radius
        self.contacts = (asp.ContactLaw(LINE[mu], normal_restitution=restitution),)

    def mass(self, q):
        return np.eye(2)

    def forces(self, t, q, u):
        return np.zeros(2)

    def direction(self, t, q, contact):
        return np.array([[-q[1]], [q[0]]]) / np.hypot(*q)

    def velocity(self, t, q, contact):
        return np.zeros(1)

    def normal(self, t, q, contact):
        return -q / np.hypot(*q)

    def gap(self, t, q, contact):
        return float(self.radius - np.hypot(*q))


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


class Rod(asp.System):
    """A rod of length 2 over the ground, m = 1, J = 1/3, g = 10."""

    dof = 3

    def __init__(self, mu, restitution):
        law = asp.ContactLaw(
            asp.FrictionLaw.isotropic(mu, dimension=1), normal_restitution=restitution
        )
        self.contacts = (law, law)

    def mass(self, q):
        return np.diag([1.0, 1.0, 1.0 / 3.0])

    def forces(self, t, q, u):
        return np.array([0.0, -10.0, 0.0])

    def direction(self, t, q, contact):
        return np.array([[1.0], [0.0], [(1 - 2 * contact) * np.sin(q[2])]])

    def velocity(self, t, q, contact):
        return np.zeros(1)

    def normal(self, t, q, contact):
        return np.array([0.0, 1.0, -(1 - 2 * contact) * np.cos(q[2])])

    def gap(self, t, q, contact):
        return float(q[1] - (1 - 2 * contact) * np.sin(q[2]))


def stribeck_block():
    law = LINE[1.0].replace(rate=asp.Stribeck(1.0 / 3.0, shape="hyperbolic"))
    return asp.MassOnBelt(1.0, 1.0, law, 1.0, [0.2])


def times(motion, kind):
    return np.array([event.time for event in motion.events if event.kind == kind])


def test_openings_know_how_the_normal_turns():
    rod = mechanisms.FrictionalImpactOscillator(1.0)
    assert asp.limit_cycle(rod).period == pytest.approx(3.156546, abs=1e-6)


def test_slips_end_however_late_it_is():
    """Times have a spacing of 2e-12 s there, in which the slip passes through zero."""
    sticks = times(asp.integrate(stribeck_block(), t_end=1.2e4), "stick")
    assert len(sticks) == 1001
    assert np.diff(sticks[2:]) == pytest.approx(12.001031, abs=1e-6)
    assert np.ptp(np.diff(sticks[2:])) < 2e-10


@pytest.mark.parametrize(
    ("radius", "speed"), [(1.0, 1.0), (1e-6, 1.0), (1e-3, 1e2), (1e3, 1.0), (1e6, 1e6)]
)
def test_differences_follow_the_motion(radius, speed):
    """v = v₀/(1 + μ v₀ t/R) along a ring."""
    t_end = 5.0 * radius / speed
    motion = asp.integrate(Ring(radius), t_end=t_end, q0=[radius, 0.0], u0=[0.0, speed])
    assert np.hypot(*motion.u[-1]) / speed == pytest.approx(0.5, abs=1e-11)
    assert np.hypot(*motion.q[-1]) / radius == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize("omega", [1.0, 1e4, 1e6])
def test_differences_follow_the_table(omega):
    amplitude = 1.0 / omega**2
    table = Table(omega, amplitude)
    motion = asp.integrate(table, t_end=10.0 / omega, u0=[amplitude * omega])
    assert motion.q[-1, 0] / amplitude == pytest.approx(np.sin(10.0), abs=1e-11)


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.8])
@pytest.mark.parametrize("angle", [0.05, 0.2])
def test_one_end_of_a_rod_bounces_to_rest_while_the_other_rests(restitution, angle):
    rod = Rod(1.0, restitution)
    motion = asp.integrate(rod, t_end=3.0, q0=[0.0, np.sin(angle), -angle])
    assert motion.events[-1].time < 2.5
    assert np.abs(motion.u[-1]).max() < 1e-12
    assert motion.q[-1, 1:] == pytest.approx(0.0, abs=1e-12)


def test_bounces_in_a_ring_end():
    motion = asp.integrate(Ring(restitution=0.5), t_end=5.0, q0=[0.9, 0.0], u0=[0.3, 1.0])
    assert 15 < len(times(motion, "impact")) < 30
    assert motion.phase[-1, 0] == asp.Phase.SLIP


def spring_on_two_belts():
    """One mass, two contacts that share a direction, μ = .1 and 1."""
    contacts = [
        asp.Contact(LINE[mu], [[1.0]], normal_force=1.0, velocity=[-0.1]) for mu in (0.1, 1.0)
    ]
    return asp.LinearSystem([[1.0]], [[1.0]], contacts=contacts)


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
    contact = asp.Contact(LINE[0.1], [[0.0], [1.0]], normal=[1.0, 0.0], normal_restitution=0.5)
    system = asp.LinearSystem(np.eye(2), force=[2.0, 0.0], contacts=[contact])
    motion = asp.integrate(system, t_end=t_end, q0=[25.0 - depth, 0.0], u0=[-10.0, 0.0])
    assert times(motion, "impact")[0] == pytest.approx(5.0 - np.sqrt(depth), abs=1e-10)


def test_sections_that_are_crossed_for_a_moment_are_seen():
    ball = asp.LinearSystem([[1.0]], force=[-10.0])
    motion = asp.integrate(ball, t_end=1e3, u0=[1.0], section=asp.Section([1.0, 0.0], 0.04))
    assert motion.t[-1] == pytest.approx((1.0 - np.sqrt(0.2)) / 10.0, abs=1e-12)


@pytest.mark.parametrize("offset", [0.0, 1e-15, -1e-15, 1e-13, -1e-13])
@pytest.mark.parametrize("which", [4, 5])
def test_sections_at_events_are_crossed(which, offset):
    event = asp.integrate(stribeck_block(), t_end=60.0).events[which]
    at = asp.integrate(stribeck_block(), t_end=event.time)
    q, sign = at.q[-1, 0], np.sign(at.u[-1, 0])
    section = asp.Section([sign, 0.0], sign * (q + offset * sign), after=event.time - 1.0)
    motion = asp.integrate(stribeck_block(), t_end=60.0, section=section)
    assert motion.t[-1] == pytest.approx(event.time, abs=1e-11)


def test_lengths_are_those_of_the_contact():
    ball = asp.LinearSystem(
        np.eye(2),
        force=[-10.0, 0.0],
        contacts=[asp.Contact(LINE[0.1], [[0.0], [1.0]], normal=[1.0, 0.0])],
    )
    motion = asp.integrate(ball, t_end=0.1, q0=[9e-5, 1e5])
    assert times(motion, "impact") == pytest.approx(np.sqrt(1.8e-5), rel=1e-9)
    with pytest.raises(asp.ParameterError, match="overlap"):
        asp.integrate(ball, t_end=1.0, q0=[-9e-5, 1e5])


@pytest.mark.parametrize(
    ("mu", "restitution", "q0", "u0"),
    [
        (
            2.4456470462005426,
            0.0,
            [0.0, 0.5614133666795249, 0.5960927351863914],
            [-2.2720427883792933, -1.7458362258848092, -2.10968132515567],
        ),
        (
            1.9426217196830613,
            0.6,
            [0.0, 0.7418770499519974, 0.8358653682570956],
            [-0.7298174838947452, 0.32505091675265785, 0.48476285734430086],
        ),
    ],
)
def test_what_an_attempt_meets_is_no_paradox(mu, restitution, q0, u0):
    rod = Rod(mu, restitution)
    motion = asp.integrate(rod, t_end=0.6, q0=q0, u0=u0)
    stepped = asp.simulate(rod, dt=1e-4, t_end=0.6, q0=q0, u0=u0)
    assert motion.q[-1] == pytest.approx(stepped.q[-1], abs=5e-3)


def test_short_pulses_need_short_steps():
    table = Table(mu=1.0, pulse=5.0)
    motion = asp.integrate(table, t_end=100.0, max_step=0.1)
    stepped = asp.simulate(table, dt=1e-3, t_end=100.0)
    assert motion.q[-1] == pytest.approx(stepped.q[-1], abs=1e-3)
    assert motion.steps >= 1000


@pytest.mark.parametrize(
    ("argument", "value"), [("t_end", 1e300), ("dt", 1e-12), ("max_step", 0.0)]
)
def test_bad_arguments_are_named(argument, value):
    with pytest.raises(asp.ParameterError, match=argument):
        asp.integrate(stribeck_block(), **({"t_end": 1.0} | {argument: value}))


def test_samples_are_as_exact_as_steps():
    motion = asp.integrate(stribeck_block(), t_end=30.0, q0=[1.0], u0=[0.2], dt=0.01)
    for k in (100, 411, 999, 2222):
        end = asp.integrate(stribeck_block(), t_end=float(motion.t[k]), q0=[1.0], u0=[0.2])
        assert motion.q[k] == pytest.approx(end.q[-1], abs=1e-10)
        assert motion.u[k] == pytest.approx(end.u[-1], abs=1e-10)
        assert motion.force[k, 0] == pytest.approx(end.force[-1, 0], abs=1e-9)
