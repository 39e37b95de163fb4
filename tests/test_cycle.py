"""Limit cycles by shooting, against SciPy, time stepping and closed forms; bifurcation diagrams."""

import os

import asperity as asp
import numpy as np
import pytest
from asperity.errors import NoCycleError
from asperity.status import Phase
from children import run_interrupted
from profiles import counts
from scipy_belt import Belt

DIRECTION = np.deg2rad(50.0)
LAW = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))


def belt(phi=DIRECTION, speed=1.0, law=LAW):
    return asp.MassOnBelt(
        1.0,
        stiffness=1.0,
        law=law,
        normal_force=1.0,
        belt_velocity=speed * np.array([np.cos(phi), np.sin(phi)]),
    )


@pytest.fixture(scope="module")
def cycle():
    return asp.limit_cycle(belt())


def test_the_paper_s_cycle_against_scipy(cycle):
    peer = Belt([30.0, 10.0], np.pi / 6, [3.0, 1.0], belt().belt_velocity, 1e-9)
    slipping, sticking = peer.cycle(0.5246, np.array([-1.0, -0.3]))
    assert cycle.period == pytest.approx(slipping + sticking, abs=2e-8)
    assert cycle.share(Phase.STICK) * cycle.period == pytest.approx(sticking, abs=2e-8)
    assert cycle.is_stable
    assert cycle.residual < 1e-9


def test_time_stepping_converges_to_the_cycle_at_first_order(cycle):
    start = {"q0": cycle.motion.q[0], "u0": cycle.motion.u[0]}
    errors = []
    for dt in (4e-3, 2e-3, 1e-3):
        path = asp.simulate(belt(), dt=dt, t_end=0.9 * cycle.period, **start)
        exact = asp.integrate(belt(), t_end=float(path.t[-1]), **start)
        errors.append(np.abs(path.q[-1] - exact.q[-1]).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 0.02
    assert (np.abs(orders - 1.0) < 0.25).all()


def test_deviations_shrink_by_the_multiplier(cycle):
    assert cycle.multipliers[0].imag == 0.0
    # One multiplier is left where the motion sticks: the others are zero.
    assert np.abs(cycle.multipliers[1:]).max() < 1e-6
    motion = asp.integrate(belt(), t_end=330.0, u0=belt().belt_velocity)
    slips = np.array([e.time for e in motion.events if e.kind == "slip"])
    deviations = np.diff(slips) - cycle.period
    ratios = deviations[1:] / deviations[:-1]
    assert ratios[-1] == pytest.approx(cycle.multipliers[0].real, abs=2e-3)


TEXTBOOK = asp.Stribeck(0.5, ratio=0.5)


def falling_belt(speed, *, mu=0.4, rate=TEXTBOOK, mass=1.0, stiffness=100.0, normal_force=10.0):
    """A mass on a belt whose friction falls with the slip."""
    law = asp.FrictionLaw.isotropic(mu, dimension=1).replace(rate=rate)
    return asp.MassOnBelt(
        mass, stiffness=stiffness, law=law, normal_force=normal_force, belt_velocity=[speed]
    )


def damped_belt(speed):
    plain = falling_belt(speed)
    contact = asp.Contact(plain.law, direction=[1.0], normal_force=10.0, velocity=[-speed])
    return asp.LinearSystem(1.0, stiffness=100.0, damping=0.5, contacts=[contact])


def period_of_the_motion(system, speed, period):
    """Of a motion that begins with stick, after 30 turns: between successive beginnings of stick.

    A mass that overtakes the belt and does not stick reverses its slip twice in a turn.
    """
    motion = asp.integrate(system, t_end=30.0 * period, u0=[speed], tolerance=1e-12)
    sticks = [event.time for event in motion.events if event.kind == "stick"]
    slips = [event.time for event in motion.events if event.kind == "slip"]
    return sticks[-1] - sticks[-2] if len(sticks) > 3 else slips[-1] - slips[-3]


@counts(12, 120)
def test_every_unstable_belt_with_falling_friction_has_its_cycle(count):
    """Most attract within a turn: neighbours are back on the cycle to rounding."""
    random = np.random.default_rng(3)
    belts = [{"speed": speed} for speed in np.linspace(0.1, 1.5, 100)[:: 120 // count]]
    fixed = len(belts)
    while len(belts) < fixed + count:
        given = {
            "speed": 10.0 ** random.uniform(-2.0, 0.0),
            "mu": random.uniform(0.2, 0.9),
            "rate": asp.Stribeck(10.0 ** random.uniform(-2.0, 0.0), ratio=random.uniform(0.3, 0.9)),
            "mass": 10.0 ** random.uniform(-1.0, 1.0),
            "stiffness": 10.0 ** random.uniform(1.0, 4.0),
            "normal_force": 10.0 ** random.uniform(0.0, 3.0),
        }
        # Where friction has fallen long before the belt's speed, nothing of the growth is left.
        if asp.stability(falling_belt(**given)).kind == "unstable":
            belts.append(given)
    for given in belts:
        system = falling_belt(**given)
        assert asp.stability(system).kind == "unstable", given
        cycle = asp.limit_cycle(system)
        turn = period_of_the_motion(system, given["speed"], cycle.period)
        assert cycle.period == pytest.approx(turn, rel=1e-6), given


def test_multipliers_are_those_of_the_monodromy_matrix():
    """Where the two sides of a difference quotient differ: a step of 1e-4 was off by 1e-3."""
    rate = asp.Stribeck(0.459, ratio=0.37)
    contact = asp.Contact(
        asp.FrictionLaw.isotropic(0.628, dimension=1).replace(rate=rate),
        direction=[0.25, 1.102, -1.341],
        normal_force=2.529,
        velocity=[-1.391],
    )
    system = asp.LinearSystem(
        np.diag([1.826, 0.39, 2.583]),
        stiffness=[[46.914, -5.008, 2.724], [-5.008, 40.842, -4.727], [2.724, -4.727, 46.477]],
        damping=[[0.201, -0.013, 0.007], [-0.013, 0.125, -0.013], [0.007, -0.013, 0.232]],
        contacts=[contact],
    )
    cycle = asp.limit_cycle(system, t_end=100.0)
    start = np.concatenate([cycle.motion.q[0], cycle.motion.u[0]])
    columns = []
    for aside in 1e-6 * np.eye(6):
        ends = [
            asp.integrate(system, t_end=cycle.period, q0=x[:3], u0=x[3:], tolerance=1e-13)
            for x in (start + aside, start - aside)
        ]
        ahead, behind = (np.concatenate([end.q[-1], end.u[-1]]) for end in ends)
        columns.append((ahead - behind) / 2e-6)
    along, *others = sorted(np.linalg.eigvals(np.array(columns)), key=lambda x: abs(x - 1.0))
    assert along == pytest.approx(1.0, abs=1e-6)
    for own in others:
        assert np.abs(cycle.multipliers - own).min() < 2e-6


def test_a_continuum_of_periodic_orbits_is_no_limit_cycle():
    # Along γ friction is constant: the mass swings harmonically, with any amplitude below v.
    law = asp.FrictionLaw.isotropic(0.5)
    steady = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0])
    with pytest.raises(NoCycleError, match="continuum"):
        asp.limit_cycle(steady, q0=steady.equilibrium + np.array([0.3, 0.0]), u0=[0.0, 0.0])


@pytest.mark.long
def test_bifurcation_over_the_belt_direction():
    values = np.deg2rad(np.linspace(40.0, 80.0, 21))
    diagram = asp.bifurcation_diagram(belt, parameter="phi", values=values)
    unstable = (values > np.deg2rad(44.106)) & (values < np.deg2rad(75.894))
    assert [kind == "unstable" for kind in diagram.kinds] == unstable.tolist()
    found = np.isfinite(diagram.periods)
    assert found[unstable].all(), [f for f in diagram.failures if f]
    assert (diagram.cycle_minima[found] < diagram.equilibria[found]).all()


def test_a_diagram_keeps_to_the_branch_of_cycles_with_stick():
    # Beyond 0.99 m/s there are two cycles: with stick, and in it an unstable one of slip alone.
    values = np.linspace(0.05, 3.0, 30)
    diagram = asp.bifurcation_diagram(damped_belt, parameter="speed", values=values)
    found = np.isfinite(diagram.periods)
    for value, there in zip(values, found, strict=True):
        motion = asp.integrate(damped_belt(value), t_end=40.0, q0=[0.04], u0=[value])
        sticks = [event.time for event in motion.events if event.kind == "stick"]
        assert there == (max(sticks, default=0.0) > 39.0)
    assert diagram.coexistence.sum() == 5
    assert diagram.branches.tolist() == np.where(found, 0, -1).tolist()
    assert all(cycle.share(Phase.STICK) > 0.0 for cycle in diagram.cycles if cycle)
    # The cycle of slip is on a branch of its own, and continued on it.
    rest = diagram.equilibria[12]
    section = asp.Section([1.0, 0.0], float(rest[0]))
    slip = asp.limit_cycle(damped_belt(values[12]), q0=rest, u0=[0.7], section=section)
    for aside in (-0.02, 0.02):
        other = asp.limit_cycle(damped_belt(values[12] + aside), near=slip)
        assert not other.is_stable
        assert other.share(Phase.SLIP) == 1.0
    mixed = diagram.replace(cycles=[*diagram.cycles[:12], slip, *diagram.cycles[13:]])
    assert mixed.branches[10:15].tolist() == [0, 0, 1, 2, 2]


def test_every_unstable_equilibrium_without_a_cycle_has_a_reason():
    def family(p):
        if abs(p) < 0.15:
            return falling_belt(1.0)
        return asp.LinearSystem(1.0, stiffness=100.0, damping=-0.1)

    for values in (np.linspace(-0.7, 0.7, 15), np.linspace(0.2, 1.0, 9)):
        diagram = asp.bifurcation_diagram(family, parameter="p", values=values)
        assert set(diagram.kinds) == {"unstable"}
        missing = [cycle is None for cycle in diagram.cycles]
        assert missing == (np.abs(values) > 0.15).tolist()
        assert [bool(why) for why in diagram.failures] == missing
        assert "not searched for, as the search failed at" in diagram.failures[0]


def test_a_cycle_with_impacts():
    hopping = asp.mechanisms.mode_coupling(0.8, damping=0.05)
    cycle = asp.limit_cycle(hopping)
    assert cycle.is_stable
    assert {phase for phase, _ in cycle.phases()} == {Phase.SLIP, Phase.OPEN}
    motion = asp.integrate(hopping, t_end=cycle.period, q0=cycle.motion.q[0], u0=cycle.motion.u[0])
    assert motion.q[-1] == pytest.approx(cycle.motion.q[0], abs=1e-8)
    start = {"q0": cycle.motion.q[0], "u0": cycle.motion.u[0]}
    path = asp.simulate(hopping, dt=1e-4, t_end=20.0 * cycle.period, **start)
    late = path.slice(19.0 * cycle.period, 20.0 * cycle.period).q
    assert late.max(axis=0) == pytest.approx(cycle.maximum, abs=2e-3)


@pytest.mark.long
def test_every_value_of_the_critical_interval_has_a_cycle():
    values = np.deg2rad(np.linspace(44.2, 75.8, 60))
    diagram = asp.bifurcation_diagram(belt, parameter="phi", values=values)
    assert set(diagram.kinds) == {"unstable"}
    assert np.isfinite(diagram.periods).all(), [f for f in diagram.failures if f]


def test_members_that_cannot_be_made_are_named():
    family = asp.mechanisms.mode_coupling
    diagram = asp.bifurcation_diagram(family, parameter="mu", values=[0.0, 0.5], cycles=False)
    assert diagram.kinds == ("none", "neutral")
    assert "mu" in diagram.failures[0]
    with pytest.raises(asp.ParameterError, match="nosuch"):
        asp.bifurcation_diagram(family, parameter="nosuch", values=[0.0, 0.5])


def test_bad_arguments_are_named(cycle):
    with pytest.raises(asp.ParameterError, match="section"):
        asp.limit_cycle(belt(), section="x")
    with pytest.raises(asp.ParameterError, match="system"):
        asp.limit_cycle(asp.RigidBodies([asp.Body(1.0, inertia=[1.0, 1.0, 1.0])]))
    with pytest.raises(asp.ParameterError, match="near"):
        asp.limit_cycle(belt(), near=3)
    with pytest.raises(asp.ParameterError, match="near"):
        asp.limit_cycle(belt(), near=cycle, q0=[0.0, 0.0])
    with pytest.raises(asp.ParameterError, match="near"):
        asp.limit_cycle(asp.mechanisms.stribeck_block(), near=cycle)
    with pytest.raises(asp.ParameterError, match="near"):
        asp.limit_cycle(belt(), near=cycle, start=cycle.motion)
    with pytest.raises(asp.ParameterError, match="start"):
        asp.limit_cycle(belt(), start=cycle.motion, q0=[0.0, 0.0])


def test_arguments_of_a_diagram_that_fit_no_member_are_refused_at_once():
    values = np.deg2rad([40.0, 50.0])
    with pytest.raises(asp.DimensionError, match="q0"):
        asp.bifurcation_diagram(belt, parameter="phi", values=values, q0=[1.0])
    with pytest.raises(asp.ParameterError, match="t_end"):
        asp.bifurcation_diagram(belt, parameter="phi", values=values, t_end=-1.0)
    with pytest.raises(asp.ParameterError, match="threads"):
        asp.bifurcation_diagram(belt, parameter="phi", values=values, cycles=False, threads=0)


TWINS = {"heavy": (4.0, 9.0, 36.0), "loaded": (1.0, 1.0, 1e4), "tiny": (7.3e-3, 2.1e4, 3.3e-5)}


def check_twin(phi, speed, mass, stiffness, load):
    """v √(km)/λ_N: its twin has the same value; lengths scale with λ_N/k, times with √(m/k)."""
    direction = np.array([np.cos(np.deg2rad(phi)), np.sin(np.deg2rad(phi))])
    cycle = asp.limit_cycle(
        asp.MassOnBelt(
            1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=speed * direction
        )
    )
    faster = speed * load / np.sqrt(mass * stiffness)
    twin = asp.limit_cycle(
        asp.MassOnBelt(
            mass, stiffness=stiffness, law=LAW, normal_force=load, belt_velocity=faster * direction
        )
    )
    assert twin.period * np.sqrt(stiffness / mass) == pytest.approx(cycle.period, rel=1e-8)
    np.testing.assert_allclose(twin.maximum * stiffness / load, cycle.maximum, rtol=1e-7)


@pytest.mark.parametrize(
    ("phi", "speed", "twin"),
    [
        (50.0, 1e-2, "loaded"),
        (60.0, 0.1, "heavy"),
        (50.0, 1.0, "tiny"),
        (60.0, 30.0, "loaded"),
        (50.0, 100.0, "heavy"),
    ],
)
def test_the_cycle_depends_on_speed_mass_and_stiffness_by_one_parameter(phi, speed, twin):
    check_twin(phi, speed, *TWINS[twin])


@pytest.mark.long
@pytest.mark.parametrize("phi", [50.0, 60.0])
@pytest.mark.parametrize("speed", [1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0])
@pytest.mark.parametrize("twin", TWINS)
def test_every_cycle_depends_on_speed_mass_and_stiffness_by_one_parameter(phi, speed, twin):
    check_twin(phi, speed, *TWINS[twin])


INTERRUPTED = """
import asperity as asp
import numpy as np
law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
def family(phi):
    direction = [np.cos(phi), np.sin(phi)]
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=direction
    )
told = []
def report(done, whole):
    # Half of it are the equilibria.
    if done > whole / 2 and not told:
        told.append(done)
        print("ready", flush=True)
try:
    asp.bifurcation_diagram(
        family, parameter="phi", values=np.linspace(0.7, 1.2, 2000), threads=2, progress=report
    )
except KeyboardInterrupt:
    print("interrupted", flush=True)
    raise SystemExit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_ctrl_c_ends_a_bifurcation_diagram_at_once():
    found = run_interrupted(INTERRUPTED)
    assert found.lines == ["interrupted"]
    assert found.code == 42
    assert found.seconds < 1.0


def test_a_cycle_loses_its_stability_to_one_of_twice_the_period():
    """A Floquet multiplier passes −1."""
    angles = np.deg2rad([69.0, 69.5])
    once = asp.bifurcation_diagram(belt, parameter="phi", values=angles).cycles[-1]
    twice = asp.limit_cycle(belt(angles[-1]))
    assert not once.is_stable
    assert once.multipliers[0].real < -1.0
    assert twice.is_stable
    assert twice.period == pytest.approx(2.0 * once.period, rel=1e-3)
