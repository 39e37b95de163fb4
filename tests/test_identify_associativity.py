"""Is D = C? The force across the sliding against the derivative of the force along it."""

import math

import numpy as np
import pytest
from asperity import Ellipse, FrictionLaw, Rectangle, Superellipse
from asperity.identify import VirtualTribometer, fit_law, process
from asperity.identify.estimator.associativity import associativity_of
from profiles import counts
from table_1 import TABLE_1, sampled

SUPERELLIPSE = Superellipse(0.54, 0.46, 2.94)
ASSOCIATED, COLLINEAR = FrictionLaw.associated(SUPERELLIPSE), FrictionLaw.collinear(SUPERELLIPSE)


def of_law(law):
    """Return the exact numbers of a law."""

    def force(phi, _):
        return -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))

    return associativity_of(force, np.zeros(0), None, confidence=None)


@pytest.mark.parametrize(
    "law",
    [
        ASSOCIATED,
        FrictionLaw.associated(Ellipse(0.5, 0.2, angle=0.3)),
        FrictionLaw.associated(Superellipse(0.5, 0.3, 5.0)),
    ],
)
def test_associated_laws_have_slope_one(law):
    found = of_law(law)
    assert found.slope.value == pytest.approx(1.0, abs=2e-3)
    # The quadrature along an arc does not see how fast forces turn on the axes.
    assert found.defect < 5e-3
    assert found.shortfall.value < 1e-9


def test_collinear_laws_have_slope_zero_and_dissipate_less():
    found = of_law(COLLINEAR)
    assert abs(found.slope.value) < 1e-9
    assert found.defect > 0.1
    assert found.shortfall.value > 0.01
    assert not COLLINEAR.is_maximal_monotone


def test_the_slope_is_that_of_derivatives():
    """For ellipses, l_t and l_p are smooth: their derivatives give the same number."""
    law = FrictionLaw(Ellipse(0.5, 0.4), Ellipse(1.5, 1.0))
    phi = np.linspace(0.0, 2.0 * np.pi, 7200, endpoint=False)
    e = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    force = -law.force(e)
    along = (force * e).sum(axis=-1)
    across = force[:, 1] * e[:, 0] - force[:, 0] * e[:, 1]
    slope = (np.roll(along, -1) - np.roll(along, 1)) / (2.0 * (phi[1] - phi[0]))
    found = of_law(law)
    assert found.slope.value == pytest.approx((across @ slope) / (slope @ slope), rel=0.02)
    expected = np.sqrt(((across - slope) ** 2).mean() / (force**2).sum(axis=-1).mean())
    assert found.defect == pytest.approx(expected, rel=0.02)
    exact = max(
        float((force @ one).max() / (one @ own))
        for one, own in zip(e[::20], force[::20], strict=True)
    )
    assert found.shortfall.value == pytest.approx(exact - 1.0, rel=1e-3)


def test_forces_that_jump_have_a_slope():
    """A rectangular D lets forces be at four points only, like those of their convex hull."""
    found = of_law(FrictionLaw(Ellipse(0.5, 0.4), Rectangle(1.5, 1.0)))
    assert found.slope.value == pytest.approx(1.0, abs=0.02)
    steep = of_law(FrictionLaw(Ellipse(0.5, 0.4), Superellipse(1.0, 1.5, 8.0)))
    assert math.isfinite(steep.slope.value)
    assert steep.defect > 0.05


@counts(8, 200)
@pytest.mark.parametrize("law", [ASSOCIATED, COLLINEAR, TABLE_1])
def test_bands_of_the_slope_hold_the_truth(law, count):
    truth = of_law(law).slope.value
    held = 0
    for seed in range(count):
        found = fit_law(sampled(law, 3600, 12, noise=0.01, seed=seed)).associativity
        held += found.slope.covers(truth)
        assert found.slope.high - found.slope.low < 0.2
        assert found.may_be_associated == found.slope.covers(1.0)
    # Fewer than 5 of 8 have a probability of 4e-4 at 95 %.
    assert held >= (180 if count == 200 else 5)


def test_a_tribometer_tells_whether_a_law_is_associated():
    for law, answer in ((ASSOCIATED, True), (COLLINEAR, False), (TABLE_1, False)):
        machine = VirtualTribometer(law, normal_force=9.3, turns=6, sample_rate=250.0, seed=2)
        fit = fit_law(process(machine.record()))
        found = fit.associativity
        assert found.may_be_associated == answer
        assert (found.shortfall.low == 0.0) == answer
        assert found.defect_error > 0.0
        assert f"is {found.slope} times the associated value" in str(found)


def test_isotropic_forces_tell_no_slope():
    found = of_law(FrictionLaw.isotropic(0.3))
    assert not found.slope.identifiable
    assert found.may_be_associated
    assert "same in all directions" in str(found)
    bare = fit_law(sampled(TABLE_1, 720, 1), confidence=None).associativity
    assert bare.slope.value > 2.0
    assert math.isnan(bare.slope.low)
    assert math.isnan(bare.defect_error)
