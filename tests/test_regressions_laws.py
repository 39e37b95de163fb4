"""Laws, rates and flow rules that once went wrong: each case is the smallest that shows it."""

import asperity as asp
import numpy as np
import pytest
from asperity import Stribeck
from samples import TILTED_ELLIPSES, assert_breaks_monotonicity

FLAT = asp.FrictionLaw(asp.Superellipse(0.54, 0.46, 2.94), asp.Superellipse(1.84, 1.19, 2.94))
DENSE = 2.0 * np.pi * np.arange(20_000) / 20_000 + 1e-5


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


# Rates


@pytest.mark.parametrize("solver", [asp.Exact(), asp.ProxJacobi(), asp.ProxGaussSeidel()])
def test_friction_that_underflows_lets_slide(solver):
    law = asp.FrictionLaw.isotropic(0.3).replace(rate=Stribeck(0.01))
    point = asp.SlidingPoint(1.0, law)
    motion = asp.simulate(point, dt=1e-2, t_end=0.2, u0=[10.0, 0.0], solver=solver)
    np.testing.assert_allclose(motion.u, [[10.0, 0.0]] * len(motion.u), rtol=1e-9, atol=1e-9)
    assert (motion.phase[1:] == asp.Phase.SLIP).all()


@pytest.mark.parametrize("speed", 10.0 ** np.arange(-8.0, 4.0))
@pytest.mark.parametrize("shape", ["exponential", "hyperbolic"])
def test_falling_rates_are_never_monotone(speed, shape):
    for ratio, exponent in ((0.0, 1.0), (0.9, 2.0), (0.5, 0.5)):
        rate = Stribeck(speed, ratio, shape=shape, exponent=exponent)
        law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2)).replace(rate=rate)
        assert_breaks_monotonicity(law, law.is_maximal_monotone)


def test_rising_rates_do_not_make_a_law_monotone():
    law = TILTED_ELLIPSES.replace(rate=Stribeck(0.1, 1.0, viscous=0.5))
    assert_breaks_monotonicity(law, law.is_maximal_monotone)


def test_jacobian_at_high_speeds_is_finite():
    law = asp.FrictionLaw.isotropic(0.3).replace(rate=Stribeck(1.0, exponent=300.0))
    jacobian = law.jacobian([[1e3, 0.0], [0.0, -1e3], [0.999, 0.0], [1e-3, 0.0]])
    assert np.isfinite(jacobian).all()
    assert np.isfinite(law.force([1e3, 0.0])).all()


# Classification


@pytest.mark.parametrize(
    "direction", [asp.Ellipse(0.6, 0.2 * (1 + 1e-6)), asp.Ellipse(0.6, 0.2, 1e-6)]
)
def test_nearly_associated_laws_are_not_associated(direction):
    law = asp.FrictionLaw(asp.Ellipse(0.6, 0.2), direction)
    assert not law.is_associated
    assert_breaks_monotonicity(law, law.is_maximal_monotone)


def test_flats_make_the_jacobian_infinite_and_spare_the_batch():
    phi = np.array([0.0, 0.3, 1.0, 2.0])
    jacobian, trace = FLAT.jacobian(unit(phi)), FLAT.trace_criterion(phi)
    assert np.isinf(jacobian[0]).any()
    assert not np.isnan(jacobian).any()
    assert trace[0] == np.inf
    assert np.isfinite(jacobian[1:]).all()
    assert np.isfinite(trace[1:]).all()


@pytest.mark.parametrize(("angle", "loss"), [(1e-5, 3.0e-5), (4e-4, 0.0446)])
def test_shortfall_of_dissipation_at_a_thin_end_is_seen(angle, loss):
    thin = asp.Ellipse(1.0, 1e-3, angle=angle)
    law, collinear = asp.FrictionLaw(thin, asp.Ellipse(1.0, 0.5)), asp.FrictionLaw.collinear(thin)
    slip = unit(np.linspace(-1e-3, 1e-3, 200_001))
    shortfall = (1.0 - law.dissipation(slip) / collinear.dissipation(slip)).max()
    assert shortfall == pytest.approx(loss, rel=1e-2)
    verdict = law.dissipates_at_least(collinear)
    assert not verdict
    assert verdict.defect == pytest.approx(shortfall, rel=1e-2)


# Flow rules


def test_flow_rule_of_a_thin_tensor_is_resolved():
    def rule(phi):
        return unit(phi) * [1.0, 1e-3]

    law, f = asp.FrictionLaw.from_flow_rule(rule), rule(DENSE)
    error = np.linalg.norm(-law.force(unit(DENSE)) - f, axis=1)
    assert (error < 1e-3 * np.linalg.norm(f, axis=1)).all()


def test_flow_rules_that_cannot_be_resolved_or_called_are_refused_by_name():
    for f in (lambda phi: unit(phi) * [1.0, 1e-4], 3):
        with pytest.raises(asp.ParameterError) as caught:
            asp.FrictionLaw.from_flow_rule(f)
        assert caught.value.argument == "f"


NEGATIVE = -0.3 * np.eye(2)
TURNING = [[0.0, -0.3], [0.3, 0.0]]


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("second_order", lambda: asp.FrictionLaw.tensor(NEGATIVE)),
        ("second_order", lambda: asp.FrictionLaw.tensor(TURNING)),
        ("second_order", lambda: asp.FrictionLaw.tensor([[0.3, -0.05], [0.05, 0.1]])),
        ("tensor", lambda: asp.FrictionLaw.tensor_function([(NEGATIVE, np.zeros((2, 2)))])),
        ("tensor", lambda: asp.FrictionLaw.tensor_function(lambda phi: np.ones((3, 3)))),
        ("tensor", lambda: asp.FrictionLaw.tensor_function(3)),
        ("weights", lambda: asp.FrictionLaw.asperity(0.3, (0.3, 0.6), (0.0, 1.0))),
        ("beta", lambda: asp.FrictionLaw.asperity(1.2, (0.2, 0.8))),
        ("f", lambda: asp.FrictionLaw.from_flow_rule(lambda phi: -unit(phi))),
        ("f", lambda: asp.FrictionLaw.from_flow_rule(lambda phi: unit(phi)[:5])),
    ],
)
def test_constructors_name_their_own_argument(argument, make):
    with pytest.raises((asp.ParameterError, asp.DimensionError)) as caught:
        make()
    assert caught.value.argument == argument


# Samples


def test_repeated_directions_are_averaged():
    phi = 2.0 * np.pi * np.arange(72) / 72
    exact = -TILTED_ELLIPSES.force(unit(phi))
    shift = 0.01 * np.random.default_rng(5).normal(size=(72, 2))
    once = asp.FrictionLaw.from_samples(phi, exact)
    twice = asp.FrictionLaw.from_samples(
        np.concatenate([phi, phi + 2.0 * np.pi]), np.concatenate([exact + shift, exact - shift])
    )
    slip = unit(DENSE[::50])
    np.testing.assert_allclose(twice.force(slip), once.force(slip), atol=1e-12)


def test_exact_samples_of_a_rectangle_return_it():
    rectangle = asp.Rectangle(0.6, 0.2, angle=0.3)
    phi = 2.0 * np.pi * np.arange(360) / 360
    force = -asp.FrictionLaw.associated(rectangle).force(unit(phi))
    law = asp.FrictionLaw.from_samples(phi, force)
    theta = DENSE[::20]
    np.testing.assert_allclose(law.reservoir.radius(theta), rectangle.radius(theta), rtol=1e-9)


def test_report_is_dropped_with_other_sets_and_kept_by_turning():
    law = asp.FrictionLaw.from_flow_rule(lambda phi: unit(phi) * [0.3, 0.1])
    assert law.report is not None
    assert law.replace(direction=asp.Disk(1.0)).report is None
    assert law.replace(reservoir=asp.Disk(1.0)).report is None
    assert law.rotated(0.3).report == law.report
    assert law.replace(rate=Stribeck(0.1)).report == law.report
