"""The mechanisms of Fig. 13 against closed forms of their linearisations and other integrators.

The closed forms are written out here; growth rates of motions are those of the linear map that
fits the states of `simulate` best.
"""

import pickle

import asperity as asp
import numpy as np
import pytest
from asperity import mechanisms
from asperity.runs.event_driven import integrate
from scipy.integrate import solve_ivp


def growth(mass, damping, stiffness):
    """Largest real part of the eigenvalues of M ẍ + B ẋ + K x = 0."""
    n = len(mass)
    lower = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    matrix = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower])
    return np.linalg.eigvals(matrix).real.max()


def measured_growth(motion, rest, coordinates, every):
    """Growth rate of the affine map from one sample to the one `every` samples later."""
    states = np.hstack([motion.q[:, coordinates] - rest, motion.u[:, coordinates]])
    scale = np.abs(states).max()
    before = np.hstack([states[:-every], np.full((len(states) - every, 1), scale)])
    propagator, *_ = np.linalg.lstsq(before, states[every:], rcond=None)
    factor = np.abs(np.linalg.eigvals(propagator[:-1])).max()
    return np.log(factor) / (every * (motion.t[1] - motion.t[0]))


# (a) Stribeck characteristic


def test_stribeck_block_has_the_known_limit_cycle():
    motion = asp.simulate(mechanisms.stribeck_block(), dt=1e-3, t_end=70.0).slice(30.0, 70.0)
    sticking = motion.phase[:, 0] == asp.Phase.STICK
    begins = motion.t[1:][np.diff(sticking.astype(int)) == 1]
    assert np.diff(begins) == pytest.approx(12.001031, abs=2e-3)
    cycle = motion.slice(begins[0], begins[-1])
    share = np.mean(cycle.phase[:-1, 0] == asp.Phase.STICK)
    assert share * 12.001031 == pytest.approx(7.705032, abs=4e-3)
    assert cycle.q.max() == pytest.approx(1.133944, abs=1e-3)


@pytest.mark.parametrize("speed", [0.2, 0.6])
def test_stribeck_block_grows_at_half_the_negative_slope(speed):
    block = mechanisms.stribeck_block(belt_velocity=speed)
    rest = 1.0 / (1.0 + 3.0 * speed)
    motion = asp.simulate(block, dt=1e-4, t_end=3.0, q0=[rest + 1e-7])
    expected = 1.5 / (1.0 + 3.0 * speed) ** 2
    assert measured_growth(motion, rest, [0], 1000) == pytest.approx(expected, rel=2e-3)


# (b) mode coupling


def coupled(mu, mass=1.0, belt=1e-3):
    """M and K of the closed contact."""
    inertia = np.array([[mass, -mu * belt], [0.0, mass + belt]])
    return inertia, np.array([[2.0, 1.0 - 4.0 * mu / 3.0], [1.0, 2.0]])


def flutter_limit(mass, belt):
    """μ at which both ω² of det(K − ω²M) = 0 agree: a quadratic equation in μ."""
    quadratic = [
        belt**2,
        4.0 * belt * (2.0 * mass + belt) - 16.0 / 3.0 * mass * (mass + belt),
        4.0 * (2.0 * mass + belt) ** 2 - 12.0 * mass * (mass + belt),
    ]
    return np.roots(quadratic).real.min()


@pytest.mark.parametrize(("mu", "massless"), [(0.9, 0.157147), (1.2, 0.269036)])
def test_mode_coupling_flutters_at_the_rate_of_the_closed_contact(mu, massless):
    inertia, stiffness = coupled(mu)
    expected = growth(inertia, np.zeros((2, 2)), stiffness)
    assert expected == pytest.approx(massless, abs=1e-3)
    inertia, stiffness = coupled(mu, belt=1e-12)
    assert growth(inertia, np.zeros((2, 2)), stiffness) == pytest.approx(massless, abs=1e-6)
    system = mechanisms.mode_coupling(mu)
    motion = asp.simulate(system, dt=1e-3, t_end=20.0, q0=[1e-6, 2e-6, 2e-6])
    assert measured_growth(motion, 0.0, [0, 1], 500) == pytest.approx(expected, abs=1e-6)
    assert motion.normal_force[1:].min() > 0.9


def test_mode_coupling_begins_at_its_limit():
    limit = flutter_limit(1.0, 0.05)
    for mu, grows in [(limit - 2e-3, False), (limit + 2e-3, True)]:
        system = mechanisms.mode_coupling(mu, belt_mass=0.05)
        motion = asp.simulate(system, dt=1e-2, t_end=100.0, q0=[1e-6, 0.0, 0.0])
        rate = measured_growth(motion, 0.0, [0, 1], 100)
        assert (rate > 0.01) if grows else (abs(rate) < 1e-6)


# (c) frictional impact oscillator


# (d) follower force


def followed(p):
    return np.array([[3.0, 1.0], [1.0, 1.0]]), np.array([[2.0 - p, p - 1.0], [-1.0, 1.0]])


def test_follower_flutters_and_diverges_where_it_should():
    flutter, divergence = 3.5 - np.sqrt(2.0), 3.5 + np.sqrt(2.0)
    for p, kind in [
        (flutter - 1e-6, "stable"),
        (flutter + 1e-6, "flutter"),
        (divergence - 1e-6, "flutter"),
        (divergence + 1e-6, "divergence"),
    ]:
        inertia, stiffness = followed(p)
        squares = np.linalg.eigvals(np.linalg.solve(inertia, stiffness))
        found = "flutter" if np.abs(squares.imag).max() > 1e-5 else "divergence"
        assert kind == ("stable" if squares.real.min() > 0.0 and found != "flutter" else found)


def test_follower_agrees_with_another_integrator_at_large_angles():
    damping, p = 0.1, 2.5

    def field(t, x):
        (a, b), (u, v) = x[:2], x[2:]
        c, s = np.cos(b - a), np.sin(b - a)
        slip = u * s + np.cos(b)
        assert slip > 0.0
        loads = [
            s * v * v - (2 * a - b) - damping * (2 * u - v) - p * s,
            -s * u * u - (b - a) - damping * (v - u),
        ]
        return np.concatenate([x[2:], np.linalg.solve([[3.0, c], [c, 1.0]], loads)])

    start = np.array([0.3, 0.1])
    exact = solve_ivp(field, (0.0, 3.0), [*start, 0.0, 0.0], rtol=1e-11, atol=1e-12).y[:, -1]
    assert np.abs(exact[:2]).max() > 0.3
    errors = []
    for dt in (2e-3, 1e-3):
        pendulum = mechanisms.FollowerPendulum(p / 10.0, damping=damping)
        motion = asp.simulate(pendulum, dt=dt, t_end=3.0, q0=start)
        errors.append(np.abs(np.append(motion.q[-1], motion.u[-1]) - exact).max())
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] > 1.7


# (e) Painlevé's rod


def test_painleve_rod_stops_its_tip_by_an_impact_without_collision():
    rod = mechanisms.painleve_rod()
    motion = asp.simulate(rod, dt=1e-5, t_end=0.83)
    step = int(np.argmin(np.diff(motion.u[:, 0]))) + 1
    before, after = motion.u[step - 1], motion.u[step]
    assert motion.t[step] == pytest.approx(0.81455, abs=1e-3)
    assert np.rad2deg(-motion.q[step, 2]) == pytest.approx(45.0, abs=0.05)
    assert -before[2] == pytest.approx(3.760599, abs=0.1)
    assert before[0] == pytest.approx(11.992264, abs=0.1)
    # The tip sticks in the percussion and does not rebound: 4 P_N = 1.5 γ_T, 4 P = −2.5 γ_T.
    slip = before[0] + before[2] * np.sin(-motion.q[step, 2])
    percussions = motion.dt * np.array([motion.normal_force[step, 0], motion.force[step, 0, 0]])
    assert percussions == pytest.approx([0.375 * slip, -0.625 * slip], rel=1e-2)
    assert motion.phase[step, 0] == asp.Phase.STICK
    assert after[0] == pytest.approx(before[0] - 0.625 * slip, rel=1e-2)


# what the linearisation says of them


@pytest.mark.parametrize(
    ("make", "limit", "mechanism"),
    [
        (lambda v: mechanisms.stribeck_block(belt_velocity=v), None, "Stribeck slope"),
        (
            lambda mu: mechanisms.mode_coupling(mu, belt_mass=0.05),
            flutter_limit(1.0, 0.05),
            "mode coupling",
        ),
        (
            mechanisms.FrictionalImpactOscillator,
            np.tan(np.pi / 6) + 0.1 / np.sin(np.pi / 6) / np.cos(np.pi / 6),
            "velocity feedback of the normal force",
        ),
        (
            lambda mu: mechanisms.FrictionalImpactOscillator(mu).small_angles,
            np.tan(np.pi / 6) + 0.1 / np.sin(np.pi / 6) / np.cos(np.pi / 6),
            "velocity feedback of the normal force",
        ),
        (mechanisms.FollowerPendulum, 0.35 - np.sqrt(0.02), "follower force"),
    ],
    ids=["stribeck", "coupling", "oscillator", "small angles", "follower"],
)
def test_stability_finds_the_limit_and_names_the_mechanism(make, limit, mechanism):
    unstable = asp.stability(make(0.2 if limit is None else limit + 1e-6))
    assert unstable.kind == "unstable"
    assert unstable.mechanisms[mechanism] <= 0.0
    left = {name: rate for name, rate in unstable.mechanisms.items() if name != mechanism}
    assert all(rate > 0.0 for rate in left.values())
    if limit is not None:
        assert asp.stability(make(limit - 1e-6)).kind != "unstable"


def test_stability_finds_the_equilibria_that_the_docstrings_name():
    rod = mechanisms.FrictionalImpactOscillator(0.9, angle=0.7, normal_force=2.0)
    steady = asp.equilibrium(rod, q0=np.add(rod.equilibrium, [0.01, 0.02]))
    np.testing.assert_allclose(steady.q, rod.equilibrium, atol=1e-9)
    assert steady.normal_force == pytest.approx([2.0])
    for mu in (0.3, 0.9):
        steady = asp.equilibrium(mechanisms.mode_coupling(mu, normal_force=3.0))
        np.testing.assert_allclose(steady.q, 0.0, atol=1e-12)
        assert steady.normal_force == pytest.approx([3.0])


# event-driven integration


ROD = mechanisms.FrictionalImpactOscillator(1.0)


@pytest.mark.parametrize(
    ("system", "q0", "t_end", "events"),
    [
        (mechanisms.stribeck_block(), [0.0], 15.0, {"slip", "stick"}),
        (mechanisms.mode_coupling(1.5), [0.1, 0.0, 0.0], 16.0, {"open", "impact"}),
        (ROD, np.add(ROD.equilibrium, [0.2, 0.0]), 9.0, {"open", "impact"}),
        (ROD.small_angles, [0.2, 0.0], 9.0, {"impact"}),
        (mechanisms.FollowerPendulum(0.25, damping=0.1), [0.3, 0.1], 12.0, {"stick", "slip"}),
    ],
    ids=["stribeck", "coupling", "oscillator", "small angles", "follower"],
)
def test_time_steps_converge_to_the_motion_with_located_events(system, q0, t_end, events):
    exact = integrate(system, t_end=t_end, q0=q0)
    assert events <= {str(event.kind) for event in exact.events}
    errors = []
    for dt in (2e-3, 2.5e-4):
        stepped = asp.simulate(system, dt=dt, t_end=t_end, q0=q0)
        errors.append(np.abs(stepped.q[-1] - exact.q[-1]).max())
    assert errors[1] < 2e-3
    assert errors[0] > 3.0 * errors[1]


def test_located_events_give_the_known_numbers():
    motion = integrate(mechanisms.stribeck_block(), t_end=45.0)
    sticks = [event.time for event in motion.events if event.kind == "stick"]
    assert np.diff(sticks)[1:] == pytest.approx(12.001031, abs=1e-6)
    (impact,) = integrate(mechanisms.painleve_rod(), t_end=0.82).events
    assert impact.kind == "impact_without_collision"
    assert impact.time == pytest.approx(0.8145497, abs=1e-7)


# all of them


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: mechanisms.stribeck_block(mu=-1.0), "mu"),
        (lambda: mechanisms.stribeck_block(normal_force=-1.0), "normal_force"),
        (lambda: mechanisms.mode_coupling(0.5, belt_mass=0.0), "belt_mass"),
        (lambda: mechanisms.mode_coupling(0.5, angles=(0.1, 0.2, 0.3)), "angles"),
        (lambda: mechanisms.mode_coupling(0.5, normal_force=0.0), "normal_force"),
        (lambda: mechanisms.mode_coupling(0.9, belt_velocity=-1.0), "belt_velocity"),
        (lambda: mechanisms.mode_coupling(0.9, belt_velocity=0.0), "belt_velocity"),
        (lambda: mechanisms.stribeck_block(belt_velocity=0.0), "belt_velocity"),
        (lambda: mechanisms.FollowerPendulum(0.2, length=0.0), "length"),
        (lambda: mechanisms.FollowerPendulum(0.2, belt_velocity=-1.0), "belt_velocity"),
        (lambda: mechanisms.FrictionalImpactOscillator(0.5, angle=1.6), "angle"),
        (lambda: mechanisms.FrictionalImpactOscillator(0.5, masses=(1.0, 0.0)), "masses"),
        (lambda: mechanisms.FrictionalImpactOscillator(0.5, damping=(1.0,)), "damping"),
        (lambda: mechanisms.painleve_rod(half_length=0.0), "half_length"),
        (lambda: mechanisms.painleve_rod(mu=-0.1), "mu"),
    ],
)
def test_bad_parameters_are_named(make, argument):
    with pytest.raises(asp.ParameterError) as raised:
        make()
    assert raised.value.argument == argument


# laws


@pytest.mark.parametrize(
    "make", [mechanisms.FollowerPendulum, mechanisms.FrictionalImpactOscillator]
)
def test_mechanisms_take_another_law(make):
    law = asp.FrictionLaw.isotropic(0.6, dimension=1)
    system = make(0.3)
    other = system.with_law(law)
    assert other == make(0.3, law=law) == system.with_law(law, contacts=0) != system
    assert other.mu == 0.3
    assert other.contacts[0].law == law
    assert other.replace(law=None) == system
    assert pickle.loads(pickle.dumps(other)) == other
    with pytest.raises(asp.ParameterError, match="contacts: must be below 1"):
        system.with_law(law, contacts=1)
    for wrong in (system.with_law, lambda law: make(0.3, law=law)):
        with pytest.raises(asp.DimensionError, match="law: must have"):
            wrong(asp.FrictionLaw.isotropic(0.6))
