"""C and D from forces over the sliding direction, against the sets of the law."""

import asperity as asp
import numpy as np
import pytest
from asperity.errors import ParameterError
from asperity.identify import MeasuredSets, VirtualTribometer, process

PHI = 2.0 * np.pi * (np.arange(1440) + 0.5) / 1440
LAWS = {
    "ellipses": asp.FrictionLaw(asp.Ellipse(0.5, 0.4, angle=0.3), asp.Ellipse(3.0, 2.0)),
    "superellipses": asp.FrictionLaw(
        asp.Superellipse(0.5366, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
    ),
    "isotropic": asp.FrictionLaw.isotropic(0.14),
    "collinear": asp.FrictionLaw.collinear(asp.Superellipse(0.5, 0.3, 0.8)),
    "wedges": asp.FrictionLaw.asperity(1.2, beta=np.deg2rad(36.0)),
}


def unit(phi):
    return np.stack([np.cos(phi), np.sin(phi)], axis=-1)


def measured(law, phi=PHI):
    return MeasuredSets(phi, -law.force(unit(phi)))


def shape_error(law, points):
    """Half the relative range of the gauge of D: 0 for points of any scale of bdry D."""
    gauge = law.direction.gauge(points)
    return 0.5 * (gauge.max() - gauge.min()) / gauge.mean()


@pytest.mark.parametrize("name", LAWS)
def test_the_sets_are_those_of_the_law(name):
    law, sets = LAWS[name], measured(LAWS[name])
    np.testing.assert_allclose(law.reservoir.gauge(sets.reservoir_points), 1.0, atol=1e-9)
    assert shape_error(law, sets.direction_by_integration) < 1e-4
    assert shape_error(law, sets.direction_by_support) < 1e-4
    assert shape_error(law, sets.direction.polygon.vertices) < 1e-4
    assert sets.difference < 1e-4
    assert sets.closure == pytest.approx(1.0, abs=1e-5)
    assert sets.convexity_defect < 1e-12
    assert sets.asymmetry < 1e-4
    assert sets.direction.angle_change < 1e-5
    assert sets.direction.support_change < 1e-5
    assert sets.direction.polygon.is_convex


@pytest.mark.parametrize("name", LAWS)
def test_both_ways_converge_to_d_at_second_order(name):
    coarse, fine = (
        measured(LAWS[name], 2.0 * np.pi * (np.arange(n) + 0.37) / n) for n in (180, 720)
    )
    for points in ("direction_by_integration", "direction_by_support"):
        errors = [shape_error(LAWS[name], getattr(sets, points)) for sets in (coarse, fine)]
        # Superellipses have infinite slopes on their axes, which costs part of the order.
        assert errors[1] < max(errors[0] / 6.0, 1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_d_lies_in_c_and_touches_it(name):
    sets = measured(LAWS[name])
    for points in (sets.direction_by_integration, sets.direction_by_support):
        ratio = np.hypot(*points.T) / sets.radius
        assert ratio.max() == pytest.approx(1.0, abs=1e-12)
    gauge = sets.direction.polygon.gauge(sets.reservoir_points)
    assert gauge.min() == pytest.approx(1.0, abs=1e-12)


def test_closure_and_convexity_defects_of_laws_that_have_none_of_these_sets():
    # A skew part of a friction tensor: r_D(2π)/r_D(0) = 6.13 by theory.
    tensor = np.array([[0.3, 0.05], [-0.05, 0.1]])
    skew = MeasuredSets(PHI, unit(PHI) @ tensor.T)
    assert abs(np.log(skew.closure)) == pytest.approx(np.log(6.13), rel=1e-3)
    # θ = φ + 0.3 sin 8φ falls by what a root of 1 + 2.4 cos 8φ says.
    theta = PHI + 0.3 * np.sin(8.0 * PHI)
    wavy = MeasuredSets(PHI, 0.3 * unit(theta))
    at = np.arccos(-1.0 / 2.4)
    fall = 0.6 * np.sin(at) - 2.0 * (np.pi - at) / 8.0
    assert wavy.convexity_defect == pytest.approx(fall, rel=1e-4)
    assert wavy.direction.angle_change > 0.4 * fall
    assert wavy.direction.polygon.is_convex
    assert 0.0 < wavy.direction.support_change < 0.05


def test_a_law_that_tells_forwards_from_backwards():
    law = asp.FrictionLaw.asperity(0.8, beta=[0.1, 0.7])
    sets = measured(law)
    forces = [-law.force(unit(np.array(angle))) for angle in (0.0, np.pi)]
    expected = np.hypot(*(forces[0] + forces[1])) / sets.radius.max()
    assert sets.asymmetry >= 0.99 * expected > 0.01


@pytest.mark.parametrize("bandwidth", [None, 5.0])
def test_noise_is_levelled_by_a_convex_d(bandwidth):
    law = LAWS["superellipses"]
    for seed in range(3):
        options = {
            "normal_force": 9.3,
            "turn_rate": 1.0,
            "noise": 0.05,
            "noise_bandwidth": bandwidth,
            "seed": seed,
        }
        sets = process(VirtualTribometer(law, **options).record()).sets
        direction = sets.direction
        assert direction.polygon.is_convex
        assert sets.convexity_defect > 0.0
        assert 0.0 < direction.angle_change < 0.1
        assert direction.support_change < 0.01
        assert shape_error(law, direction.polygon.vertices) < 0.03


def test_the_law_of_the_points_has_their_forces():
    sets = measured(LAWS["ellipses"])
    law = sets.law()
    np.testing.assert_allclose(-law.force(unit(PHI)), sets.force, atol=1e-4)


@pytest.mark.parametrize(
    ("phi", "message"),
    [(PHI[:5], "8 directions"), (PHI[::-1], "must rise"), (PHI[:900], "gap"), (2.0 * PHI, "rise")],
)
def test_directions_that_are_no_turn_are_refused(phi, message):
    with pytest.raises(ParameterError, match=f"phi: .*{message}"):
        MeasuredSets(phi, unit(phi))


def test_forces_that_do_not_oppose_sliding_are_refused():
    force = unit(PHI)
    force[7] = -force[7]
    with pytest.raises(ParameterError, match="force: must oppose sliding"):
        MeasuredSets(PHI, force)
