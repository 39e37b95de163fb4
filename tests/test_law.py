"""The extended law against its definition, closed forms and finite differences."""

import asperity as asp
import numpy as np
import pytest
from samples import PLANE_LAWS, TILTED_ELLIPSES, identify, random_directions

plane_laws = pytest.mark.parametrize("law", PLANE_LAWS, ids=identify)


@pytest.fixture
def slip():
    return random_directions(np.random.default_rng(55), 40, 2)


@plane_laws
def test_force_satisfies_the_inclusion(law, slip):
    x = -law.force(slip)
    np.testing.assert_allclose(law.reservoir.gauge(x), 1.0, rtol=1e-12)
    on_direction = x / law.direction.gauge(x)[:, None]
    normals = law.direction.gauge_gradient(on_direction)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    np.testing.assert_allclose(normals, slip, atol=1e-7)


@plane_laws
def test_slip_direction_inverts_force(law, slip):
    np.testing.assert_allclose(law.slip_direction(law.force(slip)), slip, atol=1e-7)
    assert not law.slip_direction(0.9 * law.force(slip)).any()
    with pytest.raises(asp.ParameterError, match="force"):
        law.slip_direction(1.1 * law.force(slip))


@plane_laws
def test_force_is_dry_and_scales_with_the_normal_force(law, slip):
    np.testing.assert_allclose(law.force(1e-6 * slip), law.force(slip), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(law.force(slip, 7.0), 7.0 * law.force(slip), rtol=1e-14)
    normal = np.arange(1.0, 4.0)[:, None]
    assert law.force(slip, normal).shape == (3, 40, 2)
    np.testing.assert_array_equal(law.force(slip, normal)[2], law.force(slip, 3.0))


@plane_laws
def test_dissipation_is_strictly_positive(law, slip):
    dissipation = law.dissipation(slip, 2.0)
    np.testing.assert_allclose(dissipation, -(law.force(slip, 2.0) * slip).sum(1), rtol=1e-12)
    assert dissipation.min() > 0.0
    x = -law.force(slip)
    alpha = 1 / (law.direction.gauge(x) - law.reservoir.gauge(x) + 1)
    np.testing.assert_allclose(dissipation, 2.0 * law.direction.support(slip) / alpha, rtol=1e-10)


@plane_laws
def test_jacobian_is_the_derivative_of_the_force(law, slip):
    jacobian = law.jacobian(slip, 3.0)
    for j in range(2):
        step = 1e-6 * np.eye(2)[j]
        column = (law.force(slip + step, 3.0) - law.force(slip - step, 3.0)) / 2e-6
        np.testing.assert_allclose(jacobian[:, :, j], column, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", jacobian, slip), 0.0, atol=1e-9)


def test_ellipses_have_the_closed_form(slip):
    law = TILTED_ELLIPSES
    z = slip @ np.diag([9.0, 1.0])
    expected = -z / law.reservoir.gauge(z)[:, None]
    np.testing.assert_allclose(law.force(slip), expected, rtol=1e-12)


@plane_laws
def test_direction_is_the_largest_scale_inside_the_reservoir(law):
    theta = np.linspace(0.0, 2 * np.pi, 20_001)
    ratio = law.direction.radius(theta) / law.reservoir.radius(theta)
    assert ratio.max() == pytest.approx(1.0, abs=1e-6)
    assert ratio.max() <= 1.0 + 1e-12
    assert law.alpha_min == pytest.approx(ratio.min(), rel=1e-4)


def test_scale_of_the_direction_set_does_not_matter():
    reservoir = asp.Ellipse(0.6, 0.2, angle=0.5)
    laws = [asp.FrictionLaw(reservoir, asp.Ellipse(3.0, 1.0).scaled(s)) for s in (1e-6, 1.0, 1e6)]
    slip = [[0.3, 1.0], [-2.0, 0.1]]
    for law in laws:
        np.testing.assert_allclose(law.force(slip), laws[0].force(slip), rtol=1e-12)
        assert asp.FrictionLaw(law.reservoir, law.direction) == law


def test_collinear_law_opposes_sliding_and_associated_law_dissipates_most(slip):
    reservoir = asp.Ellipse(0.6, 0.2)
    force = asp.FrictionLaw.collinear(reservoir).force(slip)
    np.testing.assert_allclose(force[:, 0] * slip[:, 1], force[:, 1] * slip[:, 0], atol=1e-12)
    admissible = reservoir.boundary(5000)
    best = (admissible @ slip.T).max(axis=0)
    np.testing.assert_allclose(
        asp.FrictionLaw.associated(reservoir).dissipation(slip), best, rtol=1e-4
    )


@plane_laws
def test_rotation_commutes_with_the_law(law, slip):
    angle = 0.6
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    np.testing.assert_allclose(
        law.rotated(angle).force(slip @ turn.T), law.force(slip) @ turn.T, rtol=1e-8, atol=1e-9
    )


def test_one_and_three_dimensions():
    one_way = asp.FrictionLaw.associated(asp.Interval(-0.2, 0.3))
    np.testing.assert_allclose(one_way.force([[2.0], [-1.0]], 10.0), [[-3.0], [2.0]])
    drilling = asp.FrictionLaw.isotropic(0.5, dimension=3)
    np.testing.assert_allclose(drilling.force([0.0, 3.0, 4.0]), [0.0, -0.3, -0.4])
    with pytest.raises(asp.DimensionError):
        one_way.rotated(0.1)


def test_reservoir_per_unit_normal_force_at_zero_load(slip):
    assert not TILTED_ELLIPSES.force(slip, 0.0).any()
