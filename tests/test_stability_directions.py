"""Critical directions and rotations, growth charts, distances of motions."""

import math

import asperity as asp
import numpy as np
import pytest
from profiles import every
from samples import BEAN, CORNERED_LAWS, PENTAGON, SMOOTH_LAWS, STAR_POLYGON

THREE = asp.Ellipse(3.0, 1.0)
EDGE = 0.5 * math.asin(9.0 / 16.0)
"""Rotation from which on two ellipses of axes 3:1 have critical directions; sin 2ζ = 9/16."""


def vectors(phi):
    return np.stack([np.cos(phi), np.sin(phi)], axis=-1)


def is_critical(law, phi):
    """γ ∈ int T_C(−λ) by the cone of the set and ∂λ/∂γ ≠ 0, one direction after the other."""
    found = []
    for slip in vectors(np.asarray(phi)):
        if not law.jacobian(slip).any():
            found.append(False)
            continue
        cone = law.reservoir.tangent_cone(-law.force(slip))
        across = 1e-7 * np.array([-slip[1], slip[0]])
        found.append(bool(cone.contains([slip - across, slip + across], tolerance=0.0).all()))
    return found


def test_directions_of_the_paper():
    law = asp.FrictionLaw(THREE.rotated(np.deg2rad(30.0)), THREE)
    found = np.rad2deg(asp.critical_directions(law))
    np.testing.assert_allclose(found[0], [44.106, 75.894], atol=1e-3)
    np.testing.assert_allclose(found[1], found[0] + 180.0, atol=1e-8)
    # The ends are zeros of the trace criterion.
    np.testing.assert_allclose(law.trace_criterion(np.deg2rad(found)), 0.0, atol=1e-8)


@pytest.mark.parametrize("zeta", [0.35, 0.7, 1.2, 2.0, 2.7])
@pytest.mark.parametrize("ratio", [0.3, 0.05, 0.01])
def test_directions_of_ellipses_in_closed_form(zeta, ratio):
    """z ∝ P γ and ∇k_C ∝ A z: the ends are the roots of γᵀA P γ = 0."""
    D = asp.Ellipse(1.0, ratio)
    law = asp.FrictionLaw(D.rotated(zeta), D)
    R = vectors(np.array([zeta, zeta + np.pi / 2])).T
    A, P = R @ np.diag([1.0, ratio**-2]) @ R.T, np.diag([1.0, ratio**2])
    (a, b), (c, d) = A @ P
    roots = np.roots([d, b + c, a])
    assert np.isrealobj(roots)
    expected = np.sort(np.mod(np.arctan(roots), np.pi))
    found = np.array(asp.critical_directions(law))
    assert found.shape == (2, 2)
    np.testing.assert_allclose(np.sort(np.mod(found[0], np.pi)), expected, atol=1e-10)


def test_rotation_of_the_paper():
    found = asp.critical_rotation(THREE, asp.Ellipse(0.3, 0.1))
    expected = [[EDGE, 0.5 * math.pi - EDGE], [0.5 * math.pi + EDGE, math.pi - EDGE]]
    np.testing.assert_allclose(found, expected, atol=1e-10)
    np.testing.assert_allclose(np.rad2deg(found[0]), [17.1144, 72.8856], atol=1e-4)


@pytest.mark.parametrize("turn", every(3, [0.0, 0.4, 0.9, 1.4, 2.0, 2.6]))
def test_directions_agree_with_tangent_cones(turn):
    """Of sets with and without corners and flats, on random directions."""
    rng = np.random.default_rng(4)
    cases = [law.reservoir for law in SMOOTH_LAWS + CORNERED_LAWS] + [asp.Rectangle(3.0, 1.0)]
    cornered = [asp.Rectangle(3.0, 1.0), PENTAGON + asp.Disk(0.1), THREE & asp.Ellipse(1.0, 3.0)]
    directions = [*cornered, THREE, asp.Superellipse(2.0, 1.0, 8.0)]
    for C in cases:
        law = asp.FrictionLaw(C.rotated(turn), directions[rng.integers(len(directions))])
        found = asp.critical_directions(law)
        assert found == sorted(found)
        phi = rng.uniform(0.0, 2.0 * np.pi, 60)
        inside = [
            any(low + 1e-6 < p + k < high - 1e-6 for low, high in found for k in (0, 2 * np.pi))
            for p in phi
        ]
        near = [
            any(abs(p + k - end) <= 1e-6 for pair in found for end in pair for k in (0, 2 * np.pi))
            for p in phi
        ]
        for p, has, doubtful in zip(phi, inside, near, strict=True):
            if not doubtful:
                assert has == is_critical(law, [p])[0], (law, p)


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_at_corners_of_the_direction_set_nothing_grows(share):
    """γ ∈ int T_C(−λ) from 58.501° to 90°, but the force is that of one corner: the mass swings."""
    C, D = asp.Ellipse(30.0, 10.0, angle=math.pi / 6), asp.Rectangle(3.0, 1.0)
    law = asp.FrictionLaw(C, D)
    assert asp.critical_directions(law) == []
    assert asp.critical_rotation(C, D) == []
    # With corners rounded off however little it does turn.
    low, high = np.rad2deg(asp.critical_directions(asp.FrictionLaw(C, D + asp.Disk(1e-9)))[0])
    assert (round(low, 3), round(high, 3)) == (58.501, 90.0)
    phi = np.deg2rad(low + share * (high - low))
    system = asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=-vectors(phi)
    )
    assert asp.growth_chart(system, phi=phi + np.pi).growth == 0.0
    rest = system.equilibrium
    run = asp.simulate(system, dt=2e-3, t_end=40.0, q0=[rest[0] + 1e-2, rest[1]])
    distance = np.linalg.norm(run.q - rest, axis=1)
    assert 0.999e-2 < distance[-4000:].max() <= distance.max() < 1.001e-2


@pytest.mark.parametrize(
    ("C", "D"),
    [
        (THREE, asp.Superellipse(2.0, 1.0, 3.0)),
        (asp.Rectangle(2.0, 1.0), asp.Rectangle(2.0, 1.0)),
        pytest.param(
            asp.Rectangle(2.0, 1.0),
            asp.Rectangle(2.0, 1.0) + asp.Disk(0.1),
            marks=pytest.mark.long,
        ),
        (asp.WedgeAsperity(1.2, beta=0.6), THREE),
        (BEAN, asp.Ellipse(5.0, 1.0)),
        (STAR_POLYGON, PENTAGON),
        pytest.param(STAR_POLYGON, PENTAGON + asp.Disk(0.2), marks=pytest.mark.long),
    ],
)
def test_rotations_agree_with_directions(C, D):
    rng = np.random.default_rng(3)
    found = asp.critical_rotation(C, D)
    symmetric = bool(C.is_symmetric) and bool(D.is_symmetric)
    period = math.pi if symmetric else 2.0 * math.pi
    ends = [end % period for pair in found for end in pair]
    tried = [*rng.uniform(0.0, period, 12), *(e + s for e in ends[:6] for s in (-1e-4, 1e-4))]
    for zeta in tried:
        expected = bool(asp.critical_directions(asp.FrictionLaw(C.rotated(zeta), D)))
        inside = any(low < zeta % period + k < high for low, high in found for k in (0.0, period))
        assert inside == expected, zeta


def test_chart_agrees_with_stability():
    rng = np.random.default_rng(2)
    law = asp.FrictionLaw(THREE.scaled(10.0), THREE, rate=asp.Stribeck(3.0, ratio=0.7))
    phi, zeta = np.linspace(0.0, np.pi, 181), np.linspace(0.0, np.pi / 2, 91)
    for stiffness in (1.0, [[2.0, 0.5], [0.5, 1.0]]):
        system = asp.MassOnBelt(
            2.0, stiffness=stiffness, law=law, normal_force=0.5, belt_velocity=[0.8, 0.0]
        )
        chart = asp.growth_chart(system, phi=phi, zeta=zeta).growth
        assert chart.shape == (181, 91)
        for i, j in zip(rng.integers(181, size=40), rng.integers(91, size=40), strict=True):
            turned = asp.FrictionLaw(law.reservoir.rotated(zeta[j]), THREE, rate=law.rate)
            one = system.replace(law=turned, belt_velocity=0.8 * vectors(phi[i]))
            np.testing.assert_allclose(asp.stability(one).growth_rate, chart[i, j], rtol=1e-7)


MONOTONE = [
    asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2, angle=0.4)),
    asp.FrictionLaw.associated(asp.Rectangle(0.6, 0.2)),
    asp.FrictionLaw.associated(asp.Disk(0.5) & asp.Rectangle(0.4, 0.6)),
    asp.FrictionLaw.isotropic(0.3, dimension=1),
    asp.FrictionLaw.isotropic(0.3, dimension=3),
]


def largest_rise(system, rng, dt=2e-3):
    """Largest increase of V in a step, in parts of V at the beginning."""
    n = system.dof
    runs = [
        asp.simulate(system, dt=dt, t_end=6.0, q0=rng.normal(size=n), u0=rng.normal(size=n))
        for _ in "ab"
    ]
    t, V = asp.incremental_distance(*runs, system=system)
    assert len(t) == len(runs[0])
    return np.diff(V).max() / V[0]


@pytest.mark.parametrize("law", MONOTONE, ids=lambda law: repr(law)[:40])
def test_distance_never_grows_with_associated_laws(law):
    """Theorem 1; the step error is of second order in the step."""
    rng = np.random.default_rng(9)
    p = law.dimension
    for _ in range(12):
        root = rng.normal(size=(p, p))
        K = root @ root.T + 0.2 * np.eye(p)
        system = asp.MassOnBelt(
            1.0, stiffness=K, law=law, normal_force=1.0, belt_velocity=rng.normal(size=p)
        )
        assert largest_rise(system, rng) < 2e-3**2


def test_chart_goes_by_the_belt_and_directions_by_the_slip():
    """With a C that is not symmetric the two differ by half a turn."""
    theta = np.linspace(0.0, 2.0 * np.pi, 65)[:-1]
    C = asp.PolarCurve(theta, THREE.rotated(0.6).radius(theta) * (1.0 + 0.3 * np.cos(theta - 0.5)))
    law = asp.FrictionLaw(C, THREE)
    found = asp.critical_directions(law)
    phi = np.linspace(0.0, 2.0 * np.pi, 721)[:-1] + 1e-3
    slips = np.array([any(a < p < b or a < p + 2 * np.pi < b for a, b in found) for p in phi])
    chart = asp.growth_chart(
        asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0]),
        phi=phi,
    ).growth
    assert np.array_equal(np.roll(slips, 360), chart > 0.0)
    assert not np.array_equal(slips, chart > 0.0)


def test_bad_arguments_are_named():
    law = asp.FrictionLaw.isotropic(0.3, dimension=3)
    point = asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0, 0.0]
    )
    run = asp.simulate(point, dt=0.1, t_end=0.2)
    turned = asp.LinearSystem(np.eye(3), stiffness=[[1, 1, 0], [0, 1, 0], [0, 0, 1]])
    pushing = asp.LinearSystem(np.eye(3), stiffness=[[1, 2, 0], [2, 1, 0], [0, 0, 1]])
    cases = [
        ("law", lambda: asp.critical_directions(law)),
        ("law", lambda: asp.critical_directions(THREE)),
        ("reservoir", lambda: asp.critical_rotation(1.0, THREE)),
        ("direction", lambda: asp.critical_rotation(THREE, asp.Ball(1.0))),
        ("direction", lambda: asp.critical_rotation(THREE, STAR_POLYGON)),
        ("nu", lambda: asp.ellipses_can_be_unstable(1.0, 1.0, 2.0, 1.0, 1.0)),
        ("system", lambda: asp.growth_chart(point, phi=0.0)),
        ("system", lambda: asp.growth_chart(turned, phi=0.0)),
        ("run_b", lambda: asp.incremental_distance(run, None, system=point)),
        ("system", lambda: asp.incremental_distance(run, run, system=turned)),
        ("system", lambda: asp.incremental_distance(run, run, system=None)),
        ("system", lambda: asp.incremental_distance(run, run, system=pushing)),
    ]
    for name, call in cases:
        with pytest.raises(asp.ParameterError) as caught:
            call()
        assert caught.value.argument == name
