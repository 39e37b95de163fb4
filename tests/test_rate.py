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
def test_factor_falls_from_one(rate):
    speed = np.array([0.0, rate.speed, 1e6 * rate.speed])
    drop = {"exponential": np.exp(-1.0), "hyperbolic": 0.5}[rate.shape]
    at_speed = rate.ratio + (1 - rate.ratio) * drop + rate.viscous * rate.speed
    np.testing.assert_allclose(rate(speed)[:2], [1.0, at_speed], rtol=1e-14)
    assert rate(speed)[2] == pytest.approx(rate.ratio + rate.viscous * speed[2], abs=1e-5)
    assert rate(0.1).shape == ()
    with pytest.raises(asp.ParameterError, match="speed"):
        rate(-0.1)


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


@all_rates
def test_jacobian_is_the_derivative_of_the_force(rate, slip):
    law = TILTED_ELLIPSES.replace(rate=rate)
    slip = slip[np.linalg.norm(slip, axis=1) > 0.01]
    jacobian = law.jacobian(slip)
    for j, e in enumerate(1e-7 * np.eye(2)):
        column = (law.force(slip + e) - law.force(slip - e)) / 2e-7
        np.testing.assert_allclose(jacobian[..., j], column, rtol=1e-4, atol=1e-5)


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


def test_block_on_belt_sticks_while_the_spring_is_weaker_than_static_friction():
    motion = block_on_belt(1e-3, 6.0)
    released = np.flatnonzero(motion.phase[1:, 0] != asp.Phase.STICK)[0] + 1
    assert motion.q[released, 0] == pytest.approx(1.0, abs=2e-3)
    np.testing.assert_allclose(motion.u[1 : released - 1, 0], 0.2, rtol=1e-9)


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


@pytest.mark.parametrize("law", TURNING_LAWS[:2], ids=["ellipses", "slender"])
def test_short_steps_of_laws_that_turn_the_slip_tend_to_the_motion(law):
    point = sliding_point(law, Stribeck(0.1, ratio=0.5, viscous=30.0))
    motion = asp.integrate(point, t_end=0.02, u0=[3.0, -2.0])
    steps = [4e-4, 2e-4, 1e-4]
    errors = [
        np.abs(asp.simulate(point, dt=dt, t_end=0.02, u0=[3.0, -2.0]).u[-1] - motion.u[-1]).max()
        for dt in steps
    ]
    assert errors[-1] < 1e-2
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 2.0, rtol=0.2)


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


def test_thirty_contacts_of_one_body_are_one_contact():
    law = asp.FrictionLaw.isotropic(0.4)
    rate = Stribeck(0.1, ratio=0.6, viscous=100.0)
    loads = np.linspace(0.1, 3.0, 30)
    motions = []
    for shares in (loads, [loads.sum()]):
        contacts = [
            asp.Contact(law.replace(rate=rate), direction=np.eye(2), normal_force=load)
            for load in shares
        ]
        table = asp.LinearSystem(2.0, force=[20.0, 5.0], contacts=contacts)
        motions.append(asp.simulate(table, dt=1e-2, t_end=0.5, u0=[1.0, -1.0], tolerance=1e-12))
    np.testing.assert_allclose(motions[0].u, motions[1].u, rtol=1e-8, atol=1e-10)


def test_contacts_of_one_body_share_a_stiff_factor():
    # Four contacts under one body: each reacts to the friction of all.
    law = asp.FrictionLaw.isotropic(0.4).replace(rate=Stribeck(0.1, ratio=0.6, viscous=1e4))
    contacts = [
        asp.Contact(law, direction=np.eye(2), normal_force=load) for load in (1.0, 2.0, 3.0, 4.0)
    ]
    table = asp.LinearSystem(2.0, force=[8.0, 0.0], contacts=contacts)
    motion = asp.simulate(table, dt=0.05, t_end=2.0, u0=[1.0, 1.0])
    assert motion.failed_steps == 0
    # 0.4 · 10 N · f(v) = 8 N with f = 0.6 + 0.4 exp(−v/0.1) + κv, for v ≪ 0.1.
    assert motion.u[-1, 0] == pytest.approx(1.0 / (1e4 - 4.0), rel=1e-5)
    assert abs(motion.u[-1, 1]) < 1e-12


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


def test_a_landing_in_the_plane_of_the_friction_takes_the_factor_of_its_end():
    # Three rows of a contact on two velocities: its block is singular, and its friction changes
    # the normal percussion.
    law = asp.FrictionLaw.isotropic(1.5).replace(
        rate=Stribeck(0.74, ratio=0.0, shape="hyperbolic", exponent=3.4, viscous=0.044)
    )
    slope = asp.Contact(law, direction=np.eye(2), normal=[-0.36, 1.0], gap=3.5)
    point = asp.LinearSystem([5.6, 48.8], force=[9.8, -2.3], contacts=[slope])
    motion = asp.simulate(point, dt=0.14, t_end=4.2, tolerance=1e-12)
    assert motion.failed_steps == 0
    before, now = np.linalg.norm(motion.u[:-1], axis=1), np.linalg.norm(motion.u[1:], axis=1)
    pressed = motion.normal_force[1:, 0] > 0.0
    assert pressed.sum() > 5
    assert not pressed[:5].any()
    assert (motion.phase[1:, 0][pressed] == asp.Phase.SLIP).all()
    factor = law.rate(before) - 0.044 * before + 0.044 * now
    friction = np.linalg.norm(motion.force[1:, 0], axis=1)
    expected = 1.5 * factor * motion.normal_force[1:, 0]
    np.testing.assert_allclose(friction[pressed], expected[pressed], rtol=1e-9)


def test_a_falling_factor_still_costs_one_solve():
    falling = asp.FrictionLaw.isotropic(0.5).replace(rate=Stribeck(0.1, ratio=0.4))
    motion = asp.simulate(asp.SlidingPoint(1.0, law=falling), dt=1e-3, t_end=0.1, u0=[1.0, 0.0])
    assert motion.iterations.max() == 1


def test_a_step_whose_factors_are_not_found_gives_up_before_long():
    """Eight directions of friction on three velocities, two contacts with flat sides.

    In the sixth step every factor that is tried leaves a problem of thousands of iterations.
    """
    rate = Stribeck(
        0.8042755126953125,
        ratio=0.7794647216796875,
        shape="hyperbolic",
        exponent=7.326021081465797,
        viscous=0.05417327880859375,
    )
    laws = [
        asp.FrictionLaw(
            asp.Superellipsoid([56.23413251903491, 0.04762735300523933, 0.01], exponent=1.0),
            asp.Ball(0.009786606894657367),
        ),
        asp.FrictionLaw(
            asp.Box(
                lower=[-13.228816615648402, -12.97837189926098], upper=[13.228816615648402] * 2
            ),
            asp.Box(lower=[-1.7640910479125431] * 2, upper=[13.2288166156484, 0.07150050052954164]),
            rate=rate,
        ),
        asp.FrictionLaw(
            asp.Box(
                lower=[-13.228816615648402, -13.228816615648402, -0.059947488920294126],
                upper=[13.213951694331437, 99.20212976395713, 99.98594712341624],
            ),
            asp.Box(
                lower=[-0.03372516643136681, -0.059896960595114464, -0.059947488920294126],
                upper=[0.05996434116581489, 6.216101058455589e-6, 5.997276906503546e-6],
            ),
        ),
    ]
    near_one = 0.999969482421875
    directions = [
        [
            [-1.0, -0.55242919921875, -0.09075927734375],
            [0.5, 0.875, -0.748931884765625],
            [0.722686767578125, -0.610321044921875, -0.13934326171875],
        ],
        [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]],
        [[-0.875, near_one, near_one], [near_one] * 3, [near_one] * 3],
    ]
    belts = [
        [-0.0826719912883803, 0.31622776601683794, 0.0],
        [-13.228816615648402] * 2,
        [-99.98594712341624, 0.0, -99.98594712341624],
    ]
    loads = [0.5623413251903491, 13.228816615648402, 13.228816615648402]
    contacts = [
        asp.Contact(law, direction=direction, velocity=belt, normal_force=load)
        for law, direction, belt, load in zip(laws, directions, belts, loads, strict=True)
    ]
    system = asp.LinearSystem(
        [0.01, 0.01, 0.01778279410038923],
        force=[1.7782794100389228, 56.23413251903491, 0.6583873005701364],
        contacts=contacts,
    )
    dt = 0.12945582061432676
    motion = asp.simulate(
        system, dt=dt, t_end=6 * dt, q0=[0.0] * 3, u0=[0.0] * 3, on_failure="record"
    )
    assert motion.steps == 6
    assert 0 < motion.iterations.max() < 20_000


@pytest.mark.parametrize("solver", [asp.Exact(), asp.ProxJacobi(), asp.ProxGaussSeidel()])
def test_friction_that_underflows_lets_slide(solver):
    law = asp.FrictionLaw.isotropic(0.3).replace(rate=Stribeck(0.01))
    point = asp.SlidingPoint(1.0, law=law)
    motion = asp.simulate(point, dt=1e-2, t_end=0.2, u0=[10.0, 0.0], solver=solver)
    np.testing.assert_allclose(motion.u, [[10.0, 0.0]] * len(motion.u), rtol=1e-9, atol=1e-9)
    assert (motion.phase[1:] == asp.Phase.SLIP).all()


@pytest.mark.parametrize("speed", 10.0 ** np.arange(-8.0, 4.0))
@pytest.mark.parametrize("shape", ["exponential", "hyperbolic"])
def test_falling_rates_are_never_monotone(speed, shape):
    for ratio, exponent in ((0.0, 1.0), (0.9, 2.0), (0.5, 0.5)):
        rate = Stribeck(speed, ratio=ratio, shape=shape, exponent=exponent)
        law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2)).replace(rate=rate)
        assert_breaks_monotonicity(law, law.is_maximal_monotone)


def test_rising_rates_do_not_make_a_law_monotone():
    law = TILTED_ELLIPSES.replace(rate=Stribeck(0.1, ratio=1.0, viscous=0.5))
    assert_breaks_monotonicity(law, law.is_maximal_monotone)


def test_jacobian_at_high_speeds_is_finite():
    law = asp.FrictionLaw.isotropic(0.3).replace(rate=Stribeck(1.0, exponent=300.0))
    jacobian = law.jacobian([[1e3, 0.0], [0.0, -1e3], [0.999, 0.0], [1e-3, 0.0]])
    assert np.isfinite(jacobian).all()
    assert np.isfinite(law.force([1e3, 0.0])).all()


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
