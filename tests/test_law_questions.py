"""Classification of laws, with witnesses; resistance, deflection, trace criterion."""

import asperity as asp
import numpy as np
import pytest
from samples import (
    CORNERED_LAWS,
    LAWS,
    SMOOTH_LAWS,
    TILTED_ELLIPSES,
    assert_breaks_monotonicity,
    identify,
    random_directions,
)

all_laws = pytest.mark.parametrize("law", LAWS, ids=identify)
plane_laws = pytest.mark.parametrize("law", SMOOTH_LAWS, ids=identify)
PHI = np.linspace(0.01, 6.2, 300)


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def is_associated(law):
    """Whether C and D are of one shape, from their radii."""
    x = random_directions(np.random.default_rng(1), 400, law.dimension)
    ratio = law.reservoir.gauge(x) / law.direction.gauge(x)
    return bool(np.ptp(ratio) < 1e-7)


@all_laws
def test_association_is_that_of_the_shapes(law):
    verdict = law.is_associated
    assert bool(verdict) == is_associated(law)
    if not verdict:
        (slip,) = verdict.witness
        support = (law.reservoir.boundary(5000) @ slip).max()
        assert law.dissipation(slip) < support * (1 - 1e-6) or law.dissipation(slip) > support


@all_laws
def test_only_associated_laws_are_maximal_monotone(law):
    """Prop. 3 and 4; the witness breaks (γ − γ*)ᵀ(λ − λ*) ≤ 0."""
    verdict = law.is_maximal_monotone
    assert bool(verdict) == bool(law.is_associated)
    if not verdict:
        assert_breaks_monotonicity(law, verdict)


@all_laws
def test_every_law_dissipates(law):
    verdict = law.is_dissipative
    assert verdict
    assert verdict.witness is None


@plane_laws
def test_collinearity_is_that_of_the_deflection(law):
    deflection = np.abs(law.deflection(PHI)).max()
    verdict = law.is_collinear
    assert bool(verdict) == (deflection < 1e-6)
    if not verdict:
        (slip,) = verdict.witness
        force = law.force(slip)
        assert abs(slip[0] * force[1] - slip[1] * force[0]) > 1e-6 * np.linalg.norm(force)


@pytest.mark.parametrize(
    "law",
    [law for law in SMOOTH_LAWS + CORNERED_LAWS if law.reservoir.is_convex],
    ids=identify,
)
def test_associated_law_dissipates_most(law):
    """Prop. 2; without a convex reservoir there is no associated law."""
    most = asp.FrictionLaw.associated(law.reservoir)
    assert most.dissipates_at_least(law)
    slip = unit(PHI)
    assert (most.dissipation(slip) >= law.dissipation(slip) * (1 - 1e-10)).all()
    back = law.dissipates_at_least(most)
    assert bool(back) == is_associated(law)
    if not back:
        (direction,) = back.witness
        shortfall = 1 - law.dissipation(direction) / most.dissipation(direction)
        assert back.defect == pytest.approx(shortfall)
        assert back.defect > back.tolerance


@plane_laws
def test_resistance_is_the_force_along_and_across(law):
    along, across = law.resistance(PHI)
    force = along[:, None] * unit(PHI) + across[:, None] * unit(PHI + np.pi / 2)
    np.testing.assert_allclose(-law.force(unit(PHI)), force, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(along, law.dissipation(unit(PHI)), rtol=1e-10)
    theta = np.arctan2(*-law.force(unit(PHI)).T[::-1])
    turned = np.mod(theta - PHI + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(law.deflection(PHI), turned, atol=1e-12)
    assert law.deflection(0.3).shape == ()
    assert law.resistance(PHI.reshape(3, 100))[1].shape == (3, 100)


@plane_laws
def test_trace_criterion_is_the_derivative_of_the_resistance(law):
    """l_t + dl_p/dφ."""
    step = 1e-6
    slope = (law.resistance(PHI + step)[1] - law.resistance(PHI - step)[1]) / (2 * step)
    along, _ = law.resistance(PHI)
    np.testing.assert_allclose(law.trace_criterion(PHI), along + slope, rtol=1e-4, atol=2e-5)


@plane_laws
def test_support_function_of_the_direction_set_follows_from_the_resistance(law):
    """h_D′/h_D = l_p/l_t."""
    along, across = law.resistance(PHI)
    h = law.direction.support
    slope = (h(unit(PHI + 1e-6)) - h(unit(PHI - 1e-6))) / 2e-6
    np.testing.assert_allclose(slope / h(unit(PHI)), across / along, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("degrees", [17.0, 17.2, 72.8, 73.0])
def test_ellipses_become_unstable_at_the_known_angle(degrees):
    """Semi-axes 3:1 both, C turned by ζ: unstable for 17.1144° < ζ < 72.8856°."""
    law = asp.FrictionLaw(asp.Ellipse(3.0, 1.0, angle=np.deg2rad(degrees)), asp.Ellipse(3.0, 1.0))
    lowest = law.trace_criterion(np.linspace(0.0, np.pi, 20_001)).min()
    assert (lowest < 0.0) == (17.1144 < degrees < 72.8856)


def test_range_of_unstable_directions():
    law = asp.FrictionLaw(asp.Ellipse(3.0, 1.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    edges = np.deg2rad([44.106, 75.894])
    beside = np.concatenate([edges - 2e-5, edges + 2e-5])
    assert (law.trace_criterion(beside) < 0.0).tolist() == [False, True, True, False]


def test_unstable_directions_point_into_the_tangent_cone():
    """Prop. 9: the nonzero eigenvalue is negative iff γ ∈ int T_C(−λ)."""
    law = TILTED_ELLIPSES
    for phi in np.linspace(0.0, np.pi, 60):
        x = -law.force(unit(phi))
        cone = law.reservoir.tangent_cone(x)
        unstable = bool(law.trace_criterion(phi) < 0.0)
        assert bool(cone.contains(unit(phi), tolerance=1e-12)) == unstable
