"""Support functions, projections and linear images of convex sets; more in asperity-set/tests."""

import asperity as asp
import numpy as np
import pytest
from samples import CONVEX, EGG, LINE, identify, random_directions, random_matrix
from scipy.optimize import minimize

CASES = 1000


convex_sets = pytest.mark.parametrize("convex", CONVEX, ids=identify)


@pytest.fixture
def rng():
    return np.random.default_rng(20190102)


@convex_sets
def test_support_is_the_maximum_over_the_boundary(convex, rng):
    y = 10 * random_directions(rng, 20, convex.dimension)
    boundary = convex.boundary(100_000)
    sampled = (y @ boundary.T).max(axis=1)
    support = convex.support(y)
    assert (support >= sampled - 1e-12 * np.abs(support)).all()
    coarse = 1e-4 if convex.dimension < 3 else 2e-2
    np.testing.assert_allclose(support, sampled, rtol=coarse)
    point = convex.support_point(y)
    np.testing.assert_allclose((point * y).sum(1), support, rtol=1e-12)
    assert convex.contains(point, tolerance=1e-9).all()


@convex_sets
def test_rule_nine_for_linear_maps(convex, rng):
    """y ∈ N_C(A x) ⇔ Aᵀy ∈ N_{A⁻¹C}(x)."""
    p = convex.dimension
    matrix = random_matrix(rng, p)
    preimage = convex.preimage(matrix)
    y = random_directions(rng, CASES, p)
    point = convex.support_point(y)
    x = np.linalg.solve(matrix, point.T).T
    np.testing.assert_allclose(preimage.support(y @ matrix), convex.support(y), rtol=1e-9)
    gap = preimage.fenchel_gap(x, y @ matrix, tolerance=1e-7)
    np.testing.assert_allclose(gap, 0.0, atol=1e-9)
    other = rng.permutation(y)
    np.testing.assert_allclose(
        preimage.fenchel_gap(x, other @ matrix, tolerance=1e-7),
        convex.fenchel_gap(point, other, tolerance=1e-7),
        atol=1e-9,
    )
    for x_one, y_one in zip(x[:20], y[:20], strict=True):
        cone = preimage.normal_cone(x_one, tolerance=1e-7)
        assert cone.contains(matrix.T @ y_one, tolerance=1e-4)


@pytest.mark.parametrize("interval", LINE, ids=identify)
def test_sets_on_a_line_are_intervals(interval):
    low, high = -interval.support([-1.0]), interval.support([1.0])
    x = np.linspace(2.0 * low, 2.0 * high, 41)[:, None]
    expected = np.where(x > 0.0, x / high, x / low)[:, 0]
    np.testing.assert_allclose(interval.gauge(x), expected, rtol=1e-12)
    np.testing.assert_allclose(interval.project(x), np.clip(x, low, high), rtol=1e-12, atol=1e-15)
    assert interval.support_hessian([[-2.0], [3.0]]).tolist() == [[[0.0]], [[0.0]]]
    for end, normal in ((low, -1.0), (high, 1.0)):
        assert interval.normal_cone([end], tolerance=1e-9).generators.tolist() == [[normal]]
        tangents = interval.tangent_cone([end], tolerance=1e-9)
        assert tangents.contains([[-normal], [normal]]).tolist() == [True, False]
        outside = [1.01 * end]
        assert interval.normal_cone(outside).is_empty
        assert interval.tangent_cone(outside).is_empty
    assert interval.normal_cone([0.5 * low]).generators.shape == (0, 1)
    outer = asp.Interval(3.0 * low, 2.0 * high)
    assert interval.scale_inside(outer) == pytest.approx(2.0, rel=1e-12)
    assert interval.margin_inside(outer) == pytest.approx(1.0, rel=1e-12)


SMOOTH = [
    asp.Ellipse(3.0, 1.0, angle=0.4),
    asp.Superellipse(3.0, 1.0, 2.94),
    asp.CappedRectangle(2.0, 1.0, cap=0.7),
    asp.WedgeAsperity(0.5, beta=0.6),
    EGG,
    asp.Ellipse(1.0, 0.3) + EGG,
    asp.Ellipsoid([2.0, 1.0, 1.5]),
    asp.CoulombContensou(1.5),
]


@pytest.mark.parametrize("convex", SMOOTH, ids=identify)
def test_projection_agrees_with_scipy(convex):
    for z in ([4.0, 1.0, 2.0], [0.3, -2.0, 0.5], [-3.5, 0.2, -1.0]):
        z = np.array(z[: convex.dimension])
        found = minimize(
            lambda x, z=z: ((x - z) ** 2).sum(),
            z / convex.gauge(z),
            jac=lambda x, z=z: 2 * (x - z),
            constraints={
                "type": "ineq",
                "fun": lambda x: 1 - convex.gauge(x),
                "jac": lambda x: -convex.gauge_gradient(x),
            },
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 500},
        )
        np.testing.assert_allclose(convex.project(z), found.x, atol=1e-6)
