"""Steady sliding: equilibria, matrices, eigenvalues, verdicts."""

import math

import asperity as asp
import numpy as np
import pytest
from profiles import counts

PAPER = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))


def along(phi, speed=1.0):
    return speed * np.stack([np.cos(phi), np.sin(phi)], axis=-1)


def belt(law, phi, speed=1.0, stiffness=1.0, mass=1.0):
    return asp.MassOnBelt(
        mass, stiffness=stiffness, law=law, normal_force=1.0, belt_velocity=along(phi, speed)
    )


def random_smooth_law(rng):
    """C, convex or not, and D, eccentric, turned against each other."""
    a, b = (np.append(1.0, rng.uniform(0.1, 1.0)) * rng.uniform(0.5, 2.0) for _ in "CD")
    turns = rng.uniform(0.0, np.pi, 2)
    if rng.random() < 0.5:
        return asp.FrictionLaw(asp.Ellipse(*a, angle=turns[0]), asp.Ellipse(*b, angle=turns[1]))
    return asp.FrictionLaw(
        asp.Superellipse(*a, rng.uniform(0.7, 3.0), angle=turns[0]),
        asp.Superellipse(*b, rng.uniform(1.4, 3.0), angle=turns[1]),
    )


def test_equilibrium_of_the_paper():
    system = belt(PAPER, np.deg2rad(50.0))
    steady = asp.equilibrium(system)
    np.testing.assert_allclose(steady.q, [20.201550, 2.675030], atol=1e-6)
    np.testing.assert_allclose(steady.q, system.equilibrium, rtol=1e-14)
    np.testing.assert_allclose(steady.force[0], steady.q, rtol=1e-14)
    assert steady == asp.equilibrium(system)


def test_trace_tangent_cone_and_eigenvalues_agree():
    """Props. 7–11, Thm. 2 on 10,000 cases; margins below 1e-6 rad are left out."""
    rng = np.random.default_rng(5)
    unstable = 0
    for _ in range(250):
        law = random_smooth_law(rng)
        slip = along(rng.uniform(0.0, 2.0 * np.pi, 40)) * rng.uniform(0.1, 3.0, (40, 1))
        load = rng.uniform(0.1, 5.0)
        B = -law.jacobian(slip, normal_force=load)
        force = law.force(slip, normal_force=load)
        normal = law.reservoir.gauge_gradient(-force)
        sine = (normal * slip).sum(1) / np.linalg.norm(normal, axis=1)
        sine /= np.linalg.norm(slip, axis=1)
        decided = np.abs(sine) > 1e-6
        trace = np.trace(B, axis1=1, axis2=2)
        assert np.array_equal(trace[decided] < 0.0, sine[decided] < 0.0)
        # Bγ = 0, and the other eigenvalue has the sign of the margin.
        size = np.linalg.norm(B, axis=(1, 2))
        residual = np.einsum("nij,nj->ni", B, slip) / (size * np.linalg.norm(slip, axis=1))[:, None]
        assert np.abs(residual).max() < 1e-9
        values = np.linalg.eigvals(B).real
        other = np.take_along_axis(values, np.abs(values).argmax(axis=1)[:, None], axis=1)[:, 0]
        assert np.array_equal(other[decided] < 0.0, sine[decided] < 0.0)
        angle = np.arctan2(*slip.T[::-1])
        across = law.trace_criterion(angle) * load / np.linalg.norm(slip, axis=1)
        np.testing.assert_allclose(trace, across, rtol=1e-8, atol=1e-8 * size.max())
        unstable += int((sine < 0.0).sum())
    assert 200 < unstable < 9000


def test_matrices_of_a_contact():
    """L projects on the force, H and B vanish along γ; (87), (88), (111)."""
    rng = np.random.default_rng(7)
    for _ in range(100):
        load = rng.uniform(0.5, 3.0)
        system = asp.MassOnBelt(
            2.0,
            stiffness=3.0,
            law=random_smooth_law(rng),
            normal_force=load,
            belt_velocity=along(rng.uniform(0, 6.2)),
        )
        found = asp.stability(system)
        contact = found.contacts[0]
        L, H = contact.projector, contact.hessian
        np.testing.assert_allclose(sorted(np.linalg.eigvals(L).real), [0.0, 1.0], atol=1e-9)
        np.testing.assert_allclose(L @ contact.force, contact.force, rtol=1e-9)
        size = np.linalg.norm(H)
        np.testing.assert_allclose(H @ contact.slip, 0.0, atol=1e-9 * size)
        assert max(np.linalg.eigvalsh(H)) > 0.0
        z = system.law.direction.support_point(contact.slip)
        B = load / system.law.reservoir.gauge(z) * (np.eye(2) - L) @ H
        np.testing.assert_allclose(found.matrix, B, atol=1e-9 * np.linalg.norm(B))
        np.testing.assert_allclose(found.symmetric + found.skew, found.matrix, atol=1e-12)
        np.testing.assert_array_equal(found.skew, -found.skew.T)
        np.testing.assert_allclose(found.trace, np.trace(B) / 2.0, rtol=1e-9, atol=1e-12)


def test_verdict_does_not_depend_on_units():
    for scale in (1e-9, 1e9):
        for phi, kind in ((0.3, "neutral"), (0.9, "unstable")):
            sets = PAPER.reservoir.scaled(scale), PAPER.direction
            scaled = asp.MassOnBelt(
                scale,
                stiffness=scale,
                law=asp.FrictionLaw(*sets),
                normal_force=1.0,
                belt_velocity=along(phi),
            )
            assert asp.stability(scaled).kind == kind
            quick = asp.MassOnBelt(
                1.0, stiffness=scale**2, law=PAPER, normal_force=scale, belt_velocity=along(phi)
            )
            assert asp.stability(quick).kind == kind


@counts(60, 250)
@pytest.mark.parametrize("kind", ["associated", "collinear", "tensor", "asperity"])
def test_nothing_is_unstable_with_laws_of_these_kinds(kind, count):
    rng = np.random.default_rng(8)
    for _ in range(count):
        law = {
            "associated": lambda: asp.FrictionLaw.associated(random_smooth_law(rng).direction),
            "collinear": lambda: asp.FrictionLaw.collinear(random_smooth_law(rng).reservoir),
            "tensor": lambda: asp.FrictionLaw.tensor(_dissipative_tensor(rng)),
            "asperity": lambda: asp.FrictionLaw.asperity(
                rng.uniform(0.05, 1.0), beta=rng.uniform(0.05, 0.7)
            ),
        }[kind]()
        assert asp.critical_directions(law) == []
        found = asp.stability(belt(law, rng.uniform(0.0, 2.0 * np.pi)))
        assert found.kind == "neutral"
        assert found.margins[0] > 0.0


def _dissipative_tensor(rng):
    """Symmetric positive definite: a law has a closed D only then."""
    root = rng.normal(size=(2, 2))
    return 0.05 * np.eye(2) + 0.2 * root @ root.T


def test_growth_rate_against_simulation():
    """A small displacement along the growing mode grows as its eigenvalue says."""
    system = belt(PAPER, np.deg2rad(50.0))
    found = asp.stability(system)
    mode = found.modes[:, 0]
    q, u = np.real(mode), np.real(found.eigenvalues[0] * mode)
    size = 1e-6 * found.contacts[0].slip @ found.contacts[0].slip
    path = asp.simulate(
        system, dt=1e-4, t_end=10.0, q0=found.equilibrium.q + size * q, u0=size * u, tolerance=1e-14
    )
    expected = np.real(np.exp(found.eigenvalues[0] * path.t)[:, None] * mode) * size
    error = np.abs(path.q - found.equilibrium.q - expected).max(axis=1)
    assert (error < 2e-2 * np.abs(expected).max()).all()


@pytest.mark.parametrize("phi", [0.3, 0.9, 2.0, 4.0])
def test_eigenvalues_against_differences_of_an_independent_field(phi):
    """M q̈ = −K q + λ(q̇ − v) written out, differentiated as a whole."""
    K = np.array([[2.0, 0.3], [0.3, 1.0]])
    system = asp.MassOnBelt(
        1.7,
        stiffness=K,
        law=PAPER.replace(rate=asp.Stribeck(2.0, ratio=0.6)),
        normal_force=0.4,
        belt_velocity=along(phi),
    )
    found = asp.stability(system)

    def field(x):
        gamma = x[2:] - system.belt_velocity
        z = PAPER.direction.support_point(gamma)
        slow = 0.6 + 0.4 * math.exp(-np.linalg.norm(gamma) / 2.0)
        friction = -0.4 * slow * z / PAPER.reservoir.gauge(z)
        return np.append(x[2:], (friction - K @ x[:2]) / 1.7)

    rest = np.append(found.equilibrium.q, [0.0, 0.0])
    np.testing.assert_allclose(field(rest), 0.0, atol=1e-13)
    h = 1e-5
    A = np.stack([(field(rest + h * e) - field(rest - h * e)) / (2 * h) for e in np.eye(4)], -1)
    np.testing.assert_allclose(found.first_order_matrix, A, atol=1e-7)
    for value in np.linalg.eigvals(A):
        assert np.abs(found.eigenvalues - value).min() < 1e-7


def random_definite(rng, n):
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.1 * np.eye(n)


@counts(100, 300)
@pytest.mark.parametrize("associated", [True, False])
def test_any_mass_matrix_and_stiffness(associated, count):
    """Negative trace means unstable (Prop. 10), associated laws never are (Thm. 1)."""
    rng = np.random.default_rng(12)
    signs = set()
    for _ in range(count):
        law = random_smooth_law(rng)
        if associated:
            law = asp.FrictionLaw.associated(law.direction)
        n = int(rng.integers(2, 5))
        contact = asp.Contact(
            law,
            direction=rng.normal(size=(n, 2)),
            normal_force=1.0,
            velocity=along(rng.uniform(0.0, 6.2)),
        )
        K = random_definite(rng, n)
        found = asp.stability(
            asp.LinearSystem(random_definite(rng, n), stiffness=K, contacts=[contact])
        )
        if associated:
            assert found.kind != "unstable"
            assert np.linalg.eigvalsh(found.symmetric).min() > -1e-9 * np.linalg.norm(found.matrix)
        elif found.trace < -1e-6:
            assert found.kind == "unstable"
            assert found.mechanisms
        assert found.trace == pytest.approx(-found.eigenvalues.sum().real, rel=1e-6, abs=1e-9)
        signs.add(found.trace < 0.0)
    assert signs == ({False} if associated else {True, False})


def test_conservative_and_gyroscopic_systems_are_neutral():
    """Rounding must not decide: stiffnesses differ by 10⁴, masses are full."""
    rng = np.random.default_rng(13)
    for n in (1, 2, 5, 12):
        for gyroscopic in (0.0, 10.0):
            skew = rng.normal(size=(n, n))
            Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
            K = (Q * 10.0 ** rng.uniform(-2.0, 2.0, n)) @ Q.T
            K, G = 0.5 * (K + K.T), gyroscopic * (skew - skew.T)
            M = random_definite(rng, n)
            assert asp.stability(asp.LinearSystem(M, stiffness=K, damping=G)).kind == "neutral"
        damped = asp.LinearSystem(M, stiffness=K, damping=1e-6 * M)
        assert asp.stability(damped).kind == "asymptotically stable"
