"""Stribeck's rate factor in laws and in motion."""

import asperity as asp
import numpy as np
import pytest
from asperity import Stribeck
from samples import (
    PLANE_LAWS,
    TILTED_ELLIPSES,
    assert_breaks_monotonicity,
    identify,
    public_of,
    random_directions,
)

RATES = [
    Stribeck(0.1),
    Stribeck(0.1, ratio=0.4),
    Stribeck(0.3, ratio=0.5, exponent=2.0, viscous=0.2),
    Stribeck(0.2, ratio=0.1, shape="hyperbolic"),
    Stribeck(1.0, ratio=0.0, shape="hyperbolic", exponent=1.5, viscous=0.01),
]
all_rates = pytest.mark.parametrize("rate", RATES, ids=identify)


@pytest.fixture
def slip():
    rng = np.random.default_rng(8)
    return random_directions(rng, 60, 2) * 10.0 ** rng.uniform(-3, 1, size=(60, 1))


@all_rates
@pytest.mark.parametrize("law", PLANE_LAWS[:5], ids=identify)
def test_force_in_slip_is_the_dry_force_times_the_factor(rate, law, slip):
    rated = law.replace(rate=rate)
    factor = rate(np.linalg.norm(slip, axis=1))
    np.testing.assert_allclose(
        rated.force(slip, normal_force=3.0),
        factor[:, None] * law.force(slip, normal_force=3.0),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        rated.dissipation(slip, normal_force=3.0),
        factor * law.dissipation(slip, normal_force=3.0),
        rtol=1e-12,
    )


def test_rate_belongs_to_the_law_but_not_to_its_shape():
    law = TILTED_ELLIPSES.replace(rate=RATES[0])
    assert law != TILTED_ELLIPSES
    assert law.rotated(0.3).rate == RATES[0]
    with pytest.raises(asp.ParameterError, match="force"):
        law.slip_direction([0.1, 0.0])
    phi = np.linspace(0.0, 6.0, 20)
    np.testing.assert_array_equal(law.resistance(phi), TILTED_ELLIPSES.resistance(phi))
    np.testing.assert_array_equal(law.trace_criterion(phi), TILTED_ELLIPSES.trace_criterion(phi))
    assert eval(repr(law), public_of(asp)) == law


def test_falling_force_breaks_monotonicity():
    law = asp.FrictionLaw.isotropic(0.5).replace(rate=Stribeck(0.1, ratio=0.4))
    assert_breaks_monotonicity(law, law.is_maximal_monotone)
    assert law.is_dissipative


def block_on_belt(dt, t_end):
    """m = k = F_S = 1, belt 0.2 m/s, F = 1/(1 + 3|γ|)."""
    rate = Stribeck(1 / 3, shape="hyperbolic")
    law = asp.FrictionLaw(asp.Interval(-1.0, 1.0), asp.Interval(-1.0, 1.0), rate=rate)
    contact = asp.Contact(law, direction=[[1.0]], normal_force=1.0, velocity=[-0.2])
    block = asp.LinearSystem(1.0, stiffness=1.0, contacts=[contact])
    return asp.simulate(block, dt=dt, t_end=t_end, u0=[0.2])


def test_block_on_belt_has_the_known_stick_slip_cycle():
    dt = 2e-4
    motion = block_on_belt(dt, 40.0)
    sticking = motion.phase[:, 0] == asp.Phase.STICK
    change = np.diff(sticking.astype(int))
    # The block starts in stick, not on the cycle.
    starts, releases = np.flatnonzero(change == 1)[1:], np.flatnonzero(change == -1)[1:]
    period = motion.t[starts[1]] - motion.t[starts[0]]
    stick = motion.t[releases[0]] - motion.t[starts[0]]
    assert period == pytest.approx(12.001031, abs=5e-3)
    assert stick == pytest.approx(7.705032, abs=5e-3)
    assert period - stick == pytest.approx(4.296, abs=5e-3)
    assert motion.q[starts[0] :, 0].max() == pytest.approx(1.133944, abs=5e-4)


@pytest.mark.parametrize("viscous", [100.0, 1e4])
@pytest.mark.parametrize("dt", [1.9e-2, 2.1e-2, 0.1])
def test_viscous_friction_is_damped_however_long_the_step(viscous, dt):
    # m = λ_N = μ = 1, f = 1 + κv and a force of 2: v = 1/κ. Taken before the step, the factor
    # would make the velocity swing with a period of two steps from κΔt = 2 on.
    law = asp.FrictionLaw.isotropic(1.0, dimension=1).replace(
        rate=Stribeck(1, ratio=1, viscous=viscous)
    )
    contact = asp.Contact(law, direction=[1.0], normal_force=1.0)
    pushed = asp.LinearSystem(1.0, force=[2.0], contacts=[contact])
    motion = asp.simulate(pushed, dt=dt, t_end=100 * dt, tolerance=1e-12)
    # Each step is v ← (v + Δt)/(1 + κΔt).
    expected = (1.0 - (1.0 + viscous * dt) ** -np.arange(101.0)) / viscous
    np.testing.assert_allclose(motion.u[:, 0], expected, rtol=1e-9)
    np.testing.assert_allclose(motion.force[-1], [[-2.0]], rtol=1e-8)
    assert motion.failed_steps == 0


# Laws that turn the slip: with the factor held they have stick and two slips in a long step, and
# the one whose speed goes with its factor may be the one in between.
TURNING_LAWS = [
    asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=np.pi / 6), asp.Ellipse(3.0, 1.0)),
    asp.FrictionLaw(asp.Ellipse(1.0, 0.2, angle=0.5), asp.Ellipse(1.0, 0.2)),
    asp.FrictionLaw(asp.Rectangle(1.0, 0.4, angle=0.5), asp.Ellipse(1.0, 0.4)),
]


def sliding_point(law, rate, *, force=(30.0, 11.0)):
    contact = asp.Contact(law.replace(rate=rate), direction=np.eye(2), normal_force=5.0)
    return asp.LinearSystem([1.0, 2.0], force=list(force), contacts=[contact])


@pytest.mark.parametrize("dt", [1e-3, 3e-3, 0.05, 1.0])
@pytest.mark.parametrize("law", [*PLANE_LAWS, *TURNING_LAWS], ids=identify)
def test_the_factor_is_that_of_the_speed_at_the_end_of_the_step(law, dt):
    point = sliding_point(law, Stribeck(0.1, ratio=0.5, viscous=300.0))
    # Formed again from the speed, the factor magnifies what the solver leaves over of it.
    motion = asp.simulate(point, dt=dt, t_end=100 * dt, u0=[3.0, -2.0], tolerance=1e-12)
    assert motion.failed_steps == 0
    before, slip = np.linalg.norm(motion.u[:-1], axis=1), motion.slip[1:, 0]
    falling = Stribeck(0.1, ratio=0.5)(before)
    factor = falling + 300.0 * np.linalg.norm(slip, axis=1)
    sliding = motion.phase[1:, 0] == asp.Phase.SLIP
    assert sliding.sum() > 50
    expected = factor[sliding, None] * law.force(slip[sliding], normal_force=5.0)
    np.testing.assert_allclose(motion.force[1:, 0][sliding], expected, rtol=1e-7, atol=1e-7)


def consistent_slips(law, rate, dt, u, force, mass=(1.0, 2.0), load=5.0):
    """All slips of one step in which speed and factor agree, by a scan over their directions.

    With e the direction, y = M u + F Δt and r(e) the percussion against sliding for unit factor,
    M s e + (f₋ + κ s) r = y: along e it gives s, across e it changes its sign at a solution.
    """
    falling = rate(np.linalg.norm(u)) - rate.viscous * np.linalg.norm(u)
    y = np.asarray(mass) * u + np.asarray(force) * dt

    def at(phi):
        e = np.stack([np.cos(phi), np.sin(phi)], axis=1)
        r = -law.force(e, normal_force=load) * dt
        inertia = e * np.asarray(mass)
        along = (e * (inertia + rate.viscous * r)).sum(axis=1)
        speed = (e @ y - falling * (e * r).sum(axis=1)) / along
        rest = y - speed[:, None] * inertia - (falling + rate.viscous * speed)[:, None] * r
        return speed, e[:, 0] * rest[:, 1] - e[:, 1] * rest[:, 0], e * speed[:, None]

    phi = np.linspace(0.0, 2.0 * np.pi, 20_001)
    speed, across, _ = at(phi)
    change = (across[1:] * across[:-1] < 0.0) & (speed[1:] > 0.0)
    low, high, sign = phi[:-1][change], phi[1:][change], np.sign(across[:-1][change])
    for _ in range(45):
        middle = 0.5 * (low + high)
        before = at(middle)[1] * sign > 0.0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return at(low)[2]


@pytest.mark.parametrize("law", TURNING_LAWS, ids=["ellipses", "slender", "rectangle"])
def test_long_steps_of_laws_that_turn_the_slip_end_in_the_consistent_solution(law):
    rng = np.random.default_rng(5)
    for _ in range(40):
        dt, viscous = 10.0 ** rng.uniform(-3.0, 0.0), 10.0 ** rng.uniform(0.0, 4.0)
        rate = Stribeck(0.1, ratio=0.5, viscous=viscous)
        u = 10.0 ** rng.uniform(-1.0, 1.0) * random_directions(rng, 1, 2)[0]
        force = 30.0 * random_directions(rng, 1, 2)[0]
        point = sliding_point(law, rate, force=force)
        motion = asp.simulate(point, dt=dt, t_end=dt, u0=u, tolerance=1e-12)
        known = consistent_slips(law, rate, dt, u, force)
        if motion.phase[-1, 0] != asp.Phase.SLIP:
            # Stick: the load is within the reservoir of the falling factor.
            held = -motion.force[-1, 0] / 5.0
            factor = rate(np.linalg.norm(u)) - viscous * np.linalg.norm(u)
            assert law.reservoir.gauge(held) <= factor * (1.0 + 1e-9)
            continue
        distance = np.linalg.norm(known - motion.u[-1], axis=1)
        assert distance.min() < 1e-9 * np.linalg.norm(motion.u[0])
        # Of several the one that goes on in the direction of before.
        along = known @ u / np.linalg.norm(known, axis=1)
        assert np.argmin(distance) == np.argmax(along)


def sliders(rates, laws, loads, force):
    """Points in the plane that know nothing of each other, as one system."""
    n = 2 * len(rates)
    contacts = [
        asp.Contact(
            law.replace(rate=rate), direction=np.eye(n)[:, 2 * k : 2 * k + 2], normal_force=load
        )
        for k, (rate, law, load) in enumerate(zip(rates, laws, loads, strict=True))
    ]
    return asp.LinearSystem(np.ones(n), force=np.ravel(force), contacts=contacts)


def test_thirty_sliders_slide_as_each_alone():
    # 60 rows: corrections of the factors are found by iteration, those of one by elimination.
    rng = np.random.default_rng(4)
    count = 30
    laws = [[*PLANE_LAWS, *TURNING_LAWS][k % (len(PLANE_LAWS) + 2)] for k in range(count)]
    for identical in (True, False):
        chosen = [laws[2]] * count if identical else laws
        viscous = np.full(count, 300.0) if identical else 10.0 ** rng.uniform(0.0, 4.0, count)
        rates = [Stribeck(0.1, ratio=0.5, viscous=v) for v in viscous]
        loads = np.full(count, 5.0) if identical else rng.uniform(1.0, 10.0, count)
        one = 0 if identical else slice(None)
        force = np.broadcast_to((30.0 * random_directions(rng, count, 2))[one], (count, 2))
        u0 = np.broadcast_to((3.0 * random_directions(rng, count, 2))[one], (count, 2))
        for dt in (1e-3, 3e-2):
            options = {"dt": dt, "t_end": 10 * dt, "tolerance": 1e-12}
            together = asp.simulate(
                sliders(rates, chosen, loads, force), u0=u0.ravel(), **options
            ).u.reshape(-1, count, 2)
            for k in range(count):
                own = slice(k, k + 1)
                if k == 0 or not identical:
                    alone = asp.simulate(
                        sliders(rates[own], chosen[own], loads[own], force[own]),
                        u0=u0[k],
                        **options,
                    )
                np.testing.assert_allclose(together[:, k], alone.u, rtol=1e-7, atol=1e-9)


def test_a_box_on_a_stiff_viscous_floor_slides_as_a_point_does():
    law = asp.FrictionLaw.isotropic(0.3).replace(rate=Stribeck(0.1, ratio=1.0, viscous=50.0))
    height = 0.01
    box = asp.Body(2.0, inertia=(0.2, 0.2, 0.4), position=(0.0, 0.0, height))
    floor = asp.BoxPlane(0, half_sizes=(0.5, 0.5, height), plane=asp.Plane(), law=law)
    options = {"dt": 1e-2, "t_end": 0.5}
    slid = asp.simulate(
        asp.RigidBodies([box], pairs=[floor]), u0=[1.0, 0.5, 0.0, 0.0, 0.0, 0.0], **options
    )
    point = asp.simulate(asp.SlidingPoint(2.0, law=law), u0=[1.0, 0.5], **options)
    assert slid.failed_steps == 0
    np.testing.assert_allclose(slid.u[:, :2], point.u, atol=1e-8)


def test_steps_end_with_the_factors_of_their_speeds_or_count_as_not_converged():
    """Long steps, in which the slip of contacts that disturb each other ceases to be a solution.

    Newton's method ends there, where the speed depends on the factor without bound, with factors of
    other speeds: forces were off by 45 % in steps that counted as converged.
    """
    fall = {"exponent": 4.16, "viscous": 0.07, "shape": "hyperbolic"}
    wide = asp.CappedRectangle(99.99, 17.78, cap=0.01, angle=-2.39)
    edgy = asp.CappedRectangle(2.02, 98.48, cap=10.0)
    blunt = asp.CappedRectangle(4.15, 4.16, cap=4.16)
    pads = [
        asp.Contact(
            asp.FrictionLaw(wide, asp.Disk(17.78), rate=Stribeck(0.65, ratio=0.65, **fall)),
            direction=[[-1.0, 0.15], [-1.0, 0.15]],
            velocity=[-2.02, -2.02],
            normal_force=2.02,
        ),
        asp.Contact(
            asp.FrictionLaw(asp.Disk(17.78), asp.Disk(1.0), rate=Stribeck(0.65, ratio=0.0, **fall)),
            direction=[[-0.63, -0.45], [-0.54, 0.15]],
            velocity=[-2.02, -2.02],
            normal_force=2.02,
        ),
    ]
    wall = asp.Contact(
        asp.FrictionLaw(edgy, blunt),
        direction=np.eye(2),
        velocity=[-4.16, -4.16],
        normal=[0.31, 1.0],
        normal_restitution=0.65,
    )
    system = asp.LinearSystem(
        mass=[[2.62, -0.61], [-0.61, 1.24]],
        stiffness=np.full((2, 2), 0.8),
        force=[-4.16, -4.16],
        contacts=[*pads, wall],
    )
    for dt, tolerance, most in (
        (0.02, 1e-10, 6),
        (0.02, 1e-5, 6),
        (0.02, 1e-3, 6),
        (0.002, 1e-10, 0),
    ):
        run = asp.simulate(system, dt=dt, t_end=0.3, tolerance=tolerance, on_failure="record")
        assert run.failed_steps <= most
        speed = np.linalg.norm(run.slip, axis=2)
        checked = 0
        for k in np.flatnonzero(run.residual[2:] <= tolerance) + 2:
            for i, pad in enumerate(pads):
                rate = pad.law.rate
                factor = rate.replace(viscous=0.0)(speed[k - 1, i]) + rate.viscous * speed[k, i]
                carried = pad.law.reservoir.gauge(-run.force[k, i]) / pad.normal_force
                assert carried == pytest.approx(factor, rel=max(1e-7, 100.0 * tolerance))
                checked += 1
        assert checked >= 12
