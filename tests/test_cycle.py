"""Limit cycles by shooting, against SciPy, time stepping and closed forms; bifurcation diagrams."""

import asperity as asp
import numpy as np
import pytest
from asperity.errors import NoCycleError
from asperity.status import Phase
from scipy_belt import Belt

DIRECTION = np.deg2rad(50.0)
LAW = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))


def belt(phi=DIRECTION, speed=1.0, law=LAW):
    return asp.MassOnBelt(1.0, 1.0, law, 1.0, speed * np.array([np.cos(phi), np.sin(phi)]))


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


def test_the_motion_itself_ends_on_the_cycle(cycle):
    # Deviations shrink by 0.6 per turn.
    motion = asp.integrate(belt(), t_end=1200.0, u0=belt().belt_velocity)
    slips = [e.time for e in motion.events if e.kind == "slip"]
    assert np.diff(slips)[-1] == pytest.approx(cycle.period, abs=1e-7)


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


def test_multipliers_are_those_of_neighbouring_motions(cycle):
    largest = cycle.multipliers[0]
    assert largest.imag == 0.0
    # One multiplier is left where the motion sticks: the others are zero.
    assert np.abs(cycle.multipliers[1:]).max() < 1e-3
    q, u = cycle.motion.q[0], cycle.motion.u[0]
    ends = []
    for shift in (0.0, 1e-3):
        motion = asp.integrate(belt(), t_end=3.0 * cycle.period, q0=q + shift, u0=u)
        slips = np.array([e.time for e in motion.events if e.kind == "slip"])
        ends.append(slips[:2])
    delays = ends[1] - ends[0]
    assert delays[1] != 0.0


@pytest.mark.parametrize(
    ("speed", "period", "slip", "stick", "largest"),
    [(0.2, 12.001031, 4.296000, 7.705032, 1.133944)],
)
def test_stribeck_block(speed, period, slip, stick, largest):
    falling = asp.Stribeck(1.0 / 3.0, shape="hyperbolic")
    law = asp.FrictionLaw.isotropic(1.0, dimension=1).replace(rate=falling)
    cycle = asp.limit_cycle(asp.MassOnBelt(1.0, 1.0, law, 1.0, [speed]))
    assert cycle.period == pytest.approx(period, abs=1e-6)
    assert cycle.share(Phase.SLIP) * cycle.period == pytest.approx(slip, abs=1e-6)
    assert cycle.share(Phase.STICK) * cycle.period == pytest.approx(stick, abs=1e-6)
    assert cycle.maximum[0] == pytest.approx(largest, abs=1e-6)


def test_a_continuum_of_periodic_orbits_is_no_limit_cycle():
    # Along γ friction is constant: the mass swings harmonically, with any amplitude below v.
    law = asp.FrictionLaw.isotropic(0.5)
    steady = asp.MassOnBelt(1.0, 1.0, law, 1.0, [1.0, 0.0])
    with pytest.raises(NoCycleError, match="continuum"):
        asp.limit_cycle(steady, q0=steady.equilibrium + np.array([0.3, 0.0]), u0=[0.0, 0.0])


def test_a_damped_motion_settles():
    law = asp.FrictionLaw.isotropic(0.5)
    contact = asp.Contact(law, np.eye(2), normal_force=1.0, velocity=[-1.0, 0.0])
    damped = asp.LinearSystem(1.0, 1.0, 0.2, contacts=[contact])
    with pytest.raises(NoCycleError, match="settle"):
        asp.limit_cycle(damped)


def test_bifurcation_over_the_belt_direction():
    values = np.deg2rad(np.linspace(40.0, 80.0, 21))
    diagram = asp.bifurcation_diagram(belt, "phi", values)
    unstable = (values > np.deg2rad(44.106)) & (values < np.deg2rad(75.894))
    assert [kind == "unstable" for kind in diagram.kinds] == unstable.tolist()
    found = np.isfinite(diagram.periods)
    assert found[unstable].all(), [f for f in diagram.failures if f]
    assert (diagram.cycle_minima[found] < diagram.equilibria[found]).all()
    again = asp.bifurcation_diagram(belt, "phi", values, threads=1)
    assert again.cycles == diagram.cycles
    assert again.failures == diagram.failures
