"""Steps that are too long for explicit forces: refused where K and B are constant, or seen."""

import asperity as asp
import numpy as np
import pytest
from scipy.linalg import expm

LINE = asp.FrictionLaw.isotropic(0.5, dimension=1)


def longest(stiffness, damping):
    """Return where Δt² k + 2 Δt b = 4."""
    return 4.0 / (damping + np.sqrt(damping**2 + 4.0 * stiffness))


def pair(rng, kind):
    """Return K and B of two coordinates with M = 1, and their longest step."""
    k = 10.0 ** rng.uniform(0.0, 4.0, 2)
    b = 2.0 * np.sqrt(k) * rng.choice([0.0, 0.05, 0.5, 1.0, 5.0], 2)
    if kind == "coupled":
        root = rng.normal(size=(2, 2)) * np.sqrt(k)
        half = rng.normal(size=(2, 2)) * np.sqrt(b)
        stiffness, damping = root @ root.T, half @ half.T
        return stiffness, damping, longest(np.trace(stiffness), np.trace(damping))
    if kind == "unsymmetric":
        # With real eigenvalues or, with a term of the other sign, flutter.
        a, c = rng.uniform(0.2, 0.6, 2) * rng.choice([1.0, -1.0], 2)
        stiffness = k[0] * np.array([[1.0, a], [c, 1.0 + 0.2 * rng.uniform()]])
        return stiffness, np.eye(2) * b[0] * (a * c > 0.0), longest(k[0], b[0] * (a * c > 0.0))
    if kind == "free":
        k[0], b[0] = 0.0, rng.choice([0.0, b[0]])
    if kind == "repelled":
        k[0] = -rng.uniform() * k[1]
    steps = [longest(*one) for one in zip(k, b, strict=True) if one[0] > 0.0]
    return np.diag(k), np.diag(b), min(steps)


def growing(maps, steps):
    """Return how many motions grow by a hundredth per step, and whether some grow, but by less.

    Directions are carried along by the maps themselves, and made orthogonal after every step.
    """
    frame = np.linalg.qr(np.random.default_rng(1).normal(size=maps.shape))[0]
    growth = np.zeros(maps.shape[:2])
    for step in range(steps):
        frame, sizes = np.linalg.qr(maps @ frame)
        if step >= steps // 2:
            growth += np.log(np.abs(np.diagonal(sizes, axis1=1, axis2=2)) + 1e-300)
    rate = growth / (steps - steps // 2)
    return (rate > 1e-2).sum(axis=1), ((rate > 2.0 / steps) & (rate < 2e-2)).any(axis=1)


def random_system(rng):
    """Return matrices of pairs of coordinates, mixed, and the parts that contacts do not hold."""
    kinds = ["plain", "coupled", "unsymmetric", "free", "repelled"]
    pairs = [pair(rng, kind) for kind in rng.choice(kinds, rng.integers(1, 4))]
    n = 2 * len(pairs) + 1
    stiffness, damping = np.zeros((2, n, n))
    for i, (own, lost, _) in enumerate(pairs):
        at = slice(2 * i, 2 * i + 2)
        stiffness[at, at], damping[at, at] = own, lost
    # The last one is the stiffest by far, and stick holds it.
    stiffness[-1, -1] = 1e8
    mix = np.linalg.inv(np.eye(n) + 0.3 * rng.normal(size=(n, n)) / np.sqrt(n))
    contact = asp.Contact(LINE, direction=mix[-1], normal_force=1.0)
    matrices = {"mass": mix.T @ mix, "stiffness": mix.T @ stiffness @ mix}
    matrices["damping"] = mix.T @ damping @ mix
    system = asp.LinearSystem(**matrices, contacts=[contact])
    return system, pairs, min(step for *_, step in pairs)


def check_random_systems(count, steps):
    rng = np.random.default_rng(5)
    systems = [random_system(rng) for _ in range(count)]
    dts = [longest * 10.0 ** rng.uniform(-1.0, 1.0) for *_, longest in systems]
    schemes, flows, owner = [], [], []
    for i, ((_, pairs, _), h) in enumerate(zip(systems, dts, strict=True)):
        for k, b, _ in pairs:
            one, zero = np.eye(2), np.zeros((2, 2))
            # q_M = q + ½h u; u′ = u − h (B u + K q_M); q′ = q_M + ½h u′, in q and u.
            middle = np.hstack([one, 0.5 * h * one])
            after = np.hstack([zero, one - h * b]) - h * k @ middle
            schemes.append(np.vstack([middle + 0.5 * h * after, after]))
            flows.append(expm(h * np.block([[zero, one], [-k, -b]])))
            owner.append(i)
    owner = np.array(owner)
    # Units in which numbers are alike.
    h = np.array(dts)[owner]
    unit = np.stack([np.ones_like(h), np.ones_like(h), h, h], axis=-1)
    schemes, flows = (np.array(m) * unit[:, :, None] / unit[:, None] for m in (schemes, flows))
    (by_steps, slowly), (by_itself, border) = growing(schemes, steps), growing(flows, steps)
    refused, judged = 0, 0
    for i, ((system, *_), dt) in enumerate(zip(systems, dts, strict=True)):
        own = owner == i
        if slowly[own].any() or border[own].any():
            continue
        expected = bool((by_steps > by_itself)[own].any())
        try:
            asp.simulate(system, dt=dt, t_end=dt)
            found = False
        except asp.ParameterError as error:
            found = error.argument == "dt"
        assert found == expected, (i, dt)
        refused, judged = refused + found, judged + 1
    assert judged > 0.7 * count
    assert 0.2 * judged < refused < 0.8 * judged


def test_steps_are_refused_where_the_scheme_amplifies_what_the_motion_does_not():
    check_random_systems(60, 600)


@pytest.mark.long
def test_steps_of_a_thousand_systems_are_refused_where_the_scheme_alone_amplifies():
    # Of these 1049 are not at a border.
    check_random_systems(1300, 8000)


def test_the_longest_step_runs():
    damped = np.array([[2.0, 1.0], [1.0, 1.5]]), np.array([[30.0, 0.0], [0.0, 1.0]])
    turning = np.diag([1.0, 2.0]), np.array([[0.1, 3.0], [-3.0, 0.1]])
    for stiffness, damping in [damped, turning, (1e6 * np.eye(2), np.zeros((2, 2)))]:
        system = asp.LinearSystem(np.eye(2), stiffness=stiffness, damping=damping)
        with pytest.raises(
            asp.ParameterError, match=r"dt: must be at most .* explicitly"
        ) as caught:
            asp.simulate(system, dt=10.0, t_end=10.0)
        dt = float(str(caught.value).split()[5])
        run = asp.simulate(system, dt=dt, t_end=2000 * dt, q0=[1.0, 1.0])
        assert np.abs(run.q).max() < 1e3
        with pytest.raises(asp.ParameterError, match="dt"):
            asp.simulate(system, dt=1.001 * dt, t_end=1.0)
        many = asp.simulate_many(system, dt=1.001 * dt, t_end=1.0, q0=np.eye(2))
        assert many.status.tolist() == ["failed", "failed"]
        assert many.failures[0].error.argument == "dt"


class Stiff(asp.System):
    dof = 1

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        return -1e6 * q - q**3


class Viscous(Stiff):
    def forces(self, t, q, u):
        return -1e3 * u


BALL = asp.RigidBodies(
    [asp.Body.ball(1.0, radius=0.1)],
    springs=[asp.Spring(0, point=(0.0, 0.0, 0.0), stiffness=1e6)],
    gravity=(0.0, 0.0, -9.81),
)
BELT = asp.MassOnBelt(
    1.0,
    stiffness=1e6,
    law=asp.FrictionLaw.isotropic(0.5),
    normal_force=10.0,
    belt_velocity=[1.0, 0.0],
)


def test_motions_that_the_step_makes_grow_diverge_by_name():
    for system in (Stiff(), Viscous(), BALL, BELT):
        u0 = np.zeros(system.dof)
        u0[0] = 1.0
        with pytest.raises(asp.DivergenceError, match=r"reverse .* explicitly") as caught:
            asp.simulate(system, dt=2.1e-3, t_end=2.1, u0=u0)
        part = caught.value.trajectory
        assert np.abs(part.u).max() < 1e9
        assert part.end is None
        safe = asp.simulate(system, dt=1.9e-3, t_end=1.9, u0=u0)
        assert np.abs(safe.u).max() < 10.0
    for lanes in (False, True):
        many = asp.simulate_many(BELT, dt=2.1e-3, t_end=2.1, u0=[[1.0, 0.0]] * 3, lanes=lanes)
        assert [type(failure.error) for failure in many.failures] == [asp.DivergenceError] * 3
